"""Key numbers of the drives: torque and power, compared with rigid joints."""

from collections.abc import Collection, Mapping
from typing import NamedTuple

from presswear.linkage.drives import linear_bodies
from presswear.recording.statistics.estimate import Estimate, key_of_greatest
from presswear.results.drive_duty import DriveDuty
from presswear.results.drives import drives_of
from presswear.results.rigid_joints import (
    ideal_drives,
    rubbing_drives,
    static_torques,
)
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.show.key_number import exact, measured
from presswear.show.page import KeyNumber
from presswear.tools import numbers

# Linkages to which a run is compared
RUBBING = "rigid joints with friction"
IDEAL = "rigid joints without friction"
STATIC = "the work alone, static"
BEHIND_FLYWHEEL = (
    "The flywheel gives the rest: gear and crank bear the torques of rigid joints."
)


class _Quantity(NamedTuple):
    """Quantity of the drives with a key number."""

    name: str  # torque or power: a field of DriveDuty
    word: str  # torque, force or power in titles
    unit: str
    bodies: Collection[str]  # bodies whose drives have the quantity


def drive_numbers(scene: Scene, stages: list[StageResult]) -> list[KeyNumber]:
    """Return the peak torque and power, each of the drive where it is largest.

    If torques were not stored, they are those of rigid joints.
    """
    if scene.has_untrusted_loads or not scene.mechanism.linkage().drives:
        return []
    comparison = _Comparison(scene, stages)
    linear = linear_bodies(scene.base_linkage.drives)
    rotating = [body for body in comparison.duties if body not in linear]
    quantities = (
        _Quantity("torque", "torque", "N m", rotating),
        _Quantity("torque", "force", "N", linear),
        _Quantity("power", "power", "W", comparison.duties),
    )
    return [comparison.number(quantity) for quantity in quantities if quantity.bodies]


class _Comparison:
    """Drives of a run, and those of linkages with rigid joints to which they are compared.

    Attributes
    ----------
    drives : dict of str to DriveResult
        Drives of the last stage by body; empty if torques were not stored.
    new_drives : dict of str to DriveResult
        Drives before the wear by body; empty with one stage.
    rigid : dict of str to dict
        Duties of the drives by body, by the name of the linkage.
    duties : mapping of str to DriveDuty
        Duties of the drives by body.
    """

    def __init__(self, scene: Scene, stages: list[StageResult]) -> None:
        self.scene = scene
        self.drives = drives_of(scene, stages[-1])
        self.new_drives = drives_of(scene, stages[0]) if len(stages) > 1 else {}
        self.motor_bodies = _turned_by_flywheels(scene)
        self.static = static_torques(scene)
        ideal = ideal_drives(scene)
        rubbing = rubbing_drives(scene)
        self.model = RUBBING if rubbing else IDEAL
        rigid = {RUBBING: rubbing, IDEAL: ideal} if rubbing else {IDEAL: ideal}
        speed = ", at the nominal speed" if scene.base_linkage.has_motors else ""
        self.rigid = {f"{name}{speed}": duties for name, duties in rigid.items()}
        duties = {body: drive.duty for body, drive in self.drives.items()}
        self.duties: Mapping[str, DriveDuty] = duties or rubbing or ideal

    def number(self, quantity: _Quantity) -> KeyNumber:
        """Return the key number of a quantity."""
        peaks = self._peaks(quantity)
        body = key_of_greatest(peaks)
        kind = "motor" if self._has_motor(body) else "drive"
        title = f"Peak {kind} {quantity.word}"
        text = self._text(quantity, body, peaks[body])
        if self.drives:
            number = measured(title, peaks[body], quantity.unit, text)
        else:
            number = exact(title, peaks[body].mean, quantity.unit, text)
        return number._replace(compared=self._compared(quantity, body))

    def _peaks(self, quantity: _Quantity) -> dict[str, Estimate]:
        """Return the peaks of a quantity by body."""
        peaks = {}
        for body, drive in self.drives.items():
            peak = getattr(drive, f"peak_{quantity.name}")
            if body in quantity.bodies and peak is not None:
                peaks[body] = peak
        if peaks:
            return peaks
        duties = {body: self.duties[body] for body in quantity.bodies}
        return _peaks_of(duties, quantity.name)

    def _has_motor(self, body: str) -> bool:
        """Return whether the torque of a body is that of a motor with a flywheel."""
        return bool(self.drives) and body in self.motor_bodies

    def _text(self, quantity: _Quantity, body: str, peak: Estimate) -> str:
        """Return the text on the largest peak, which is that of a body."""
        if quantity.name == "torque":
            rms = self.duties[body].torque.rms
            typical = f"rms {numbers.quantity_text(rms, quantity.unit)}."
        else:
            means = [duty.power.mean for duty in self.duties.values()]
            typical = _mean_power(self.scene, means, peak)
        text = f"Largest in a stroke at {body}; {typical}"
        if self._has_motor(body) and quantity.word == "torque":
            text = f"Largest in a stroke of the motor, reduced to {body}; {typical} "
            text += BEHIND_FLYWHEEL
        if not self.drives:
            return (
                f"{text} Computed with {self.model}; drive_torque = on includes clearance "
                "and friction."
            )
        new_peak = None
        if body in self.new_drives:
            new_peak = getattr(self.new_drives[body], f"peak_{quantity.name}")
        if new_peak is not None:
            before = numbers.quantity_text(new_peak.mean, quantity.unit)
            text += f" Before the wear: {before}."
        return text

    def _compared(self, quantity: _Quantity, body: str) -> tuple[tuple[str, str], ...]:
        """Return the names of the linkages with rigid joints, and their peaks as texts.

        ``body`` is that of the largest peak of the run.
        """
        unit = quantity.unit
        compared = []
        for label, duties in self.rigid.items():
            of_quantity = {driven: duties[driven] for driven in quantity.bodies}
            text = _peak_text(of_quantity, quantity.name, unit, body)
            compared.append((label, text))
        if quantity.name == "torque" and self.static:
            torques = {driven: self.static[driven] for driven in quantity.bodies}
            compared.append((STATIC, _static_text(torques, unit)))
        return tuple(compared)


def _turned_by_flywheels(scene: Scene) -> list[str]:
    """Return the bodies that a motor with a flywheel turns; a servo gives its torque itself."""
    motors = {drive.body: drive.motor for drive in scene.base_linkage.drives}
    return [
        body
        for body, motor in motors.items()
        if motor is not None and not motor.is_servo and motor.reflected_inertia > 0.0
    ]


def _peaks_of(duties: Mapping[str, DriveDuty], name: str) -> dict[str, Estimate]:
    """Return the peak torques or powers of drives by body; ``name`` is torque or power."""
    peaks = {}
    for body, duty in duties.items():
        peaks[body] = Estimate(abs(getattr(duty, name).peak))
    return peaks


def _peak_text(duties: Mapping[str, DriveDuty], name: str, unit: str, at: str) -> str:
    """Return the greatest peak of the drives as a text, with its drive unless it is ``at``."""
    peaks = _peaks_of(duties, name)
    body = key_of_greatest(peaks)
    text = numbers.quantity_text(peaks[body].mean, unit)
    return text if body == at else f"{text} at {body}"


def _static_text(torques: Mapping[str, float], unit: str) -> str:
    """Return static torques or forces as a text, each with its drive if there are several."""
    texts = {body: numbers.quantity_text(size, unit) for body, size in torques.items()}
    if len(texts) == 1:
        return next(iter(texts.values()))
    return ", ".join(f"{text} at {body}" for body, text in texts.items())


def _mean_power(scene: Scene, means: list[float], peak: Estimate) -> str:
    """Return a text on the mean power of all drives together.

    One drive may brake while another one drives.
    """
    total = sum(means)
    if abs(total) < 1e-9 * peak.mean:
        total = 0.0  # round-off of a cycle without net work
    together = " of all drives together" if len(means) > 1 else ""
    text = f"mean{together} {numbers.quantity_text(total, 'W')}."
    is_even = not any(drive.repeats for drive in scene.mechanism.linkage().drives)
    if total > 0.0 and is_even and not _turned_by_flywheels(scene):
        text += " A motor with a flywheel delivers this mean."
    return text
