"""Key numbers of the drives: torque and power, compared with rigid joints."""

from collections.abc import Mapping

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


def drive_numbers(scene: Scene, stages: list[StageResult]) -> list[KeyNumber]:
    """Return the peak torque and power, each of the drive where it is largest.

    If torques were not stored, they are those of rigid joints.
    """
    if scene.has_untrusted_loads or not scene.mechanism.linkage().drives:
        return []
    drives = drives_of(scene, stages[-1])
    ideal = ideal_drives(scene)
    rubbing = rubbing_drives(scene)
    new = drives_of(scene, stages[0]) if len(stages) > 1 else {}
    rigid = {RUBBING: rubbing, IDEAL: ideal} if rubbing else {IDEAL: ideal}
    if scene.base_linkage.has_motors:
        rigid = {
            f"{words}, at the nominal speed": duty for words, duty in rigid.items()
        }
    duties = {body: drive.duty for body, drive in drives.items()} or rubbing or ideal
    static = static_torques(scene)
    result = []
    linear = linear_bodies(scene.base_linkage.drives)
    cranks = [body for body in duties if body not in linear]
    motor_cranks = _turned_by_flywheels(scene)
    for name, words, unit, bodies in (
        ("torque", "torque", "N m", cranks),
        ("torque", "force", "N", linear),
        ("power", "power", "W", duties),
    ):
        if not bodies:
            continue
        peaks = {}
        for body, drive in drives.items():
            peak = getattr(drive, f"peak_{name}")
            if body in bodies and peak is not None:
                peaks[body] = peak
        if not peaks:
            peaks = _peaks_of({body: duties[body] for body in bodies}, name)
        body = key_of_greatest(peaks)
        if name == "torque":
            typical = f"rms {numbers.quantity_text(duties[body].torque.rms, unit)}."
        else:
            typical = _mean_power(
                scene, [duty.power.mean for duty in duties.values()], peaks[body]
            )
        has_motor = bool(drives) and body in motor_cranks
        text = f"Largest in a stroke at {body}; {typical}"
        if has_motor and words == "torque":
            text = f"Largest in a stroke of the motor, reduced to {body}; {typical} "
            text += BEHIND_FLYWHEEL
        title = f"Peak {'motor' if has_motor else 'drive'} {words}"
        compared = tuple(
            (label, _peak_text({one: duty[one] for one in bodies}, name, unit, body))
            for label, duty in rigid.items()
        )
        if name == "torque" and static:
            loads = {body: static[body] for body in bodies}
            compared += ((STATIC, _static_text(loads, unit)),)
        if not drives:
            text += f" Computed with {RUBBING if rubbing else IDEAL}; drive_torque = on includes "
            text += "clearance and friction."
            peak = exact(title, peaks[body].mean, unit, text)
            result.append(peak._replace(compared=compared))
            continue
        before = getattr(new[body], f"peak_{name}") if body in new else None
        if before is not None:
            text += f" Before the wear: {numbers.quantity_text(before.mean, unit)}."
        result.append(
            measured(title, peaks[body], unit, text)._replace(compared=compared)
        )
    return result


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
