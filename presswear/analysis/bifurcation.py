"""Bifurcation diagrams: a motion over a parameter, with increasing and decreasing values.

Each run continues from the end of the run at the previous value, so that hysteresis is visible.
"""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.analysis.contact_modes import resonance_frequency
from presswear.analysis.lyapunov import largest_exponent
from presswear.analysis.periods import TOLERANCE, Periodicity, periodicity
from presswear.analysis.spectra import power_spectrum
from presswear.engines.base import Plan, Start
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.packed import pack
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.observe import SECTION_JOINT_NAMES, SECTION_NAMES
from presswear.scene.scene import Scene
from presswear.scene.settings import changed, setting_of, values_of
from presswear.tools.arrays import read_numbers, write_arrays
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import FolderLock
from presswear.tools.processes import Job, Report, cores, workers_for
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import plain, read_json, typed, write_json

Array = NDArray[np.float64]
InitialState = Callable[[Scene], Start]

ENGINE = InHouse("dopri5", 1e-6)  # periodic pins within 6e-4 of the clearance of those at 1e-9
PHASES = (0.25, 0.5, 0.75, 1.0)  # phases of the stored states
CONTACT_GAP = 1e-4  # gap over clearance of a pin in contact when the parameter changes
NEWTON_STEPS = 8  # Newton steps that move pins; three suffice
MAX_ORDER = 1000  # contacts of slow cranks ring at some hundreds of the crank frequency
SETTLING_CYCLES = 1  # before a spectrum: contacts begin anew
DIRECTIONS = ("up", "down")
FILE = "diagram.json"
SCHEMA = 3


@dataclass(frozen=True)
class Parameter:
    """Bifurcation parameter.

    Attributes
    ----------
    key : str
        Name of the setting as in ``--set``, such as ``speed`` or ``B.clearance``.
    values : tuple of float
        Increasing, SI.
    unit : str
    """

    key: str
    values: tuple[float, ...]
    unit: str

    @staticmethod
    def parse(text: str, scene: Scene) -> "Parameter":
        """Return the parameter from text such as ``speed=2pi:12pi:200 rad/s``.

        Raises
        ------
        InputError
            If the text is incomplete, the name or unit unknown, or a value out of range.
        """
        key, equals, values_text = (part.strip() for part in text.partition("="))
        if not (equals and values_text):
            raise InputError(f"--over {text}: expected KEY=FIRST:LAST:COUNT UNIT")
        meaning = setting_of(scene, key).meaning
        if not isinstance(meaning, Quantity) or meaning.whole:
            raise InputError(f"--over {text}: must be a quantity, not a count or a choice")
        values = sorted(set(values_of(key, values_text, meaning)))
        if len(values) < 2:
            raise InputError(f"--over {text}: needs at least two different values")
        for value in (values[0], values[-1]):
            changed(scene, {key: value}).check()  # raises if the scene does not allow the value
        return Parameter(key, tuple(values), meaning.unit)


@dataclass(frozen=True)
class Cycles:
    """Number of cycles at each value.

    Attributes
    ----------
    total : int
    stored : int
        Last cycles, whose states are stored.
    exponent, orders : int
        Further cycles for the exponent and for the order analysis; 0 to omit it.
    """

    total: int
    stored: int
    exponent: int
    orders: int

    def __post_init__(self) -> None:
        if not 2 <= self.stored < self.total:
            raise InputError(
                f"stored = {self.stored}: must be 2 to {self.total - 1} of {self.total} cycles"
            )


@dataclass(frozen=True)
class Branch:
    """Results at the values of the parameter, in the order in which they were computed.

    Attributes
    ----------
    value : ndarray, shape (n,)
        SI.
    sections : ndarray, shape (n, stored, phases, columns)
        See ``Recorder.sections``; NaN where a run failed.
    force : ndarray, shape (n, stored, joints)
        Peak normal force in each cycle, N.
    exponent : ndarray, shape (n, 2)
        Largest Lyapunov exponent and half width of its interval, 1/s; NaN if not available.
    amplitude : ndarray, shape (n, 1 + joints, MAX_ORDER)
        Amplitudes within half an order of 1, 2, ...: acceleration of the output point, m/s^2, and
        normal force of each joint, N. No orders if they were not requested.
    resonance : ndarray, shape (n, joints)
        Order of the contact resonance of each joint; NaN if there is none.
    end : ndarray, shape (n, 2, 3 bodies)
        Positions and velocities at the end of each run.
    """

    value: Array
    sections: Array
    force: Array
    exponent: Array
    amplitude: Array
    resonance: Array
    end: Array

    def eccentricity(self, joint: int) -> Array:
        """Return the positions of the pin of a joint, m, shape (n, stored, phases, 2)."""
        first = len(SECTION_NAMES) + len(SECTION_JOINT_NAMES) * joint
        columns = [first + SECTION_JOINT_NAMES.index(f"eccentricity_{axis}") for axis in "xy"]
        return self.sections[..., columns]


def continued(linkage: Linkage, previous: Linkage, end: Start, ideal: Start) -> Start:
    """Return the end of a run, after whole cycles, as the initial state of another linkage.

    Pins keep their positions relative to the clearance, except that contacts open. Velocities are
    scaled with the speed of the first drive. Positions and velocities are then projected on the
    constraints and drives.

    Parameters
    ----------
    linkage, previous : Linkage
        New linkage and linkage of the run.
    ideal : Start
        Initial state of the ideal linkage; full turns of bodies are counted from it.
    """
    ratios = [
        new.clearance / old.clearance
        for new, old in zip(linkage.clearances, previous.clearances, strict=True)
    ]
    constraints = constraints_of(linkage)
    position = end.position.copy()
    turns = np.round((position[2::3] - ideal.position[2::3]) / (2.0 * math.pi))
    position[2::3] -= 2.0 * math.pi * turns
    pins = _pin_positions(linkage)
    target = pins(position).reshape(-1, 2) * np.array(ratios)[:, None]
    # A pin that starts in contact at rest would latch a closing speed near zero, for which the
    # damping is unbounded. All pins therefore start with a gap.
    clearance = np.array([joint.clearance for joint in linkage.clearances])
    excess = np.hypot(*target.T) / ((1.0 - CONTACT_GAP) * clearance)
    target = (target / np.maximum(excess, 1.0)[:, None]).ravel()
    rest = np.zeros_like(position)
    for _ in range(NEWTON_STEPS):
        phi, _, _, jacobian = constraints.evaluate(0.0, position, rest)
        residual = np.concatenate([phi, pins(position) - target])
        slopes = np.concatenate([jacobian, _central_differences(pins, position)])
        position -= np.linalg.lstsq(slopes, residual, rcond=None)[0]
    velocity = end.velocity * (linkage.drives[0].speed / previous.drives[0].speed)
    _, error, _, jacobian = constraints.evaluate(0.0, position, velocity)
    return Start(position, velocity - np.linalg.pinv(jacobian) @ error)


def _pin_positions(linkage: Linkage) -> Callable[[Array], Array]:
    """Return the function from positions of bodies to pin eccentricities, shape (2 joints,)."""
    packed, contacts = pack(linkage, False), np.zeros(len(linkage.clearances), CONTACT)

    def pins(position: Array) -> Array:
        note_contacts(packed, contacts, position, np.zeros_like(position))
        return np.column_stack([contacts["eccentricity_x"], contacts["eccentricity_y"]]).ravel()

    return pins


def _central_differences(function: Callable[[Array], Array], x: Array, step: float = 1e-6) -> Array:
    shifts = step * np.eye(x.size)
    columns = [(function(x + shift) - function(x - shift)) / (2.0 * step) for shift in shifts]
    return np.transpose(columns)


def run_value(scene: Scene, start: Start, cycles: Cycles, ideal: Start) -> dict[str, Array]:
    """Return the arrays of a ``Branch`` at one value, without the first axis.

    The surfaces are unworn. If the run fails, all numbers are NaN and the end is ``ideal``.
    """
    linkage, period = scene.linkage(), scene.mechanism.period
    plan = Plan(period, cycles.total, 1, sections=PHASES, torques=False)
    run = ENGINE.simulate(linkage, start, plan)
    joints, stored = len(linkage.clearances), cycles.stored
    exponent = np.full(2, math.nan)
    amplitude = np.full((1 + joints, MAX_ORDER if cycles.orders else 0), math.nan)
    resonance = np.full(joints, math.nan)
    if run.status == "failed":
        sections = np.full((stored, *run.recorder.sections.shape[1:]), math.nan)
        force, last = np.full((stored, joints), math.nan), ideal
    else:
        sections, last = run.recorder.sections[-stored:], run.end
        peaks = [run.recorder.each_cycle("force_max", k) for k in range(joints)]
        force = np.transpose(peaks)[-stored:]
        further = continued(linkage, linkage, run.end, start)
        if cycles.exponent:
            try:
                result = largest_exponent(linkage, further, period, cycles.exponent)
                exponent[:] = result.value, (result.half_width or math.nan)
            except RunFailed:
                pass  # the exponent stays NaN
        if cycles.orders:
            amplitude, resonance = order_amplitudes(linkage, further, period, cycles.orders, ENGINE)
    return {
        "sections": sections,
        "force": force,
        "exponent": exponent,
        "amplitude": amplitude,
        "resonance": resonance,
        "end": np.array([last.position, last.velocity]),
    }


def order_amplitudes(
    linkage: Linkage, start: Start, period: float, cycles: int, engine: InHouse
) -> tuple[Array, Array]:
    """Return amplitudes at the orders of the crank and the orders of contact resonance.

    Parameters
    ----------
    period : float
        Duration of a cycle, s.
    cycles : int
        Cycles of the spectra.

    Returns
    -------
    amplitude : ndarray, shape (1 + joints, MAX_ORDER)
    resonance : ndarray, shape (joints,)
        See ``Branch``; all NaN if the run fails.
    """
    joints, length = len(linkage.clearances), SETTLING_CYCLES + cycles
    amplitude = np.full((1 + joints, MAX_ORDER), math.nan)
    resonance = np.full(joints, math.nan)
    run = engine.simulate(linkage, start, Plan(period, length, length, torques=False))
    if run.status == "failed":
        return amplitude, resonance
    recorder = run.recorder
    time = recorder.series("time")
    rows = time >= SETTLING_CYCLES * period
    series = [recorder.series("acceleration")]
    series += [recorder.series("normal", k) for k in range(joints)]
    for k, values in enumerate(series):
        spectrum = power_spectrum(time[rows], values[rows], period, (MAX_ORDER + 1) / period)
        amplitude[k] = [spectrum.amplitude(order) for order in range(1, MAX_ORDER + 1)]
    touchdown, separation, closing = map(
        CONTACT_COLUMNS.index, ("touchdown", "separation", "closing_speed")
    )
    for k in range(joints):
        contacts = recorder.stored_contacts(k)
        duration = contacts[:, separation] - contacts[:, touchdown]
        frequency = resonance_frequency(duration, contacts[:, closing])
        resonance[k] = math.nan if frequency is None else frequency * period
    return amplitude, resonance


@dataclass(frozen=True)
class BranchJob:
    """Computation of one branch; its file is rewritten after each value and resumed from.

    Attributes
    ----------
    values : tuple of float
        In the order of the runs, SI.
    """

    scene: Scene
    parameter: Parameter
    values: tuple[float, ...]
    cycles: Cycles
    initial_state: InitialState
    file: Path

    def __call__(self, report: Report) -> None:
        """Run the remaining values."""
        rows: dict[str, list[Array]] = {}
        if self.file.exists():
            rows = {name: list(array) for name, array in vars(read_branch(self.file)).items()}
        previous: Linkage | None = None
        if rows:
            previous = self._scene(float(rows["value"][-1])).linkage()
        for k in range(len(rows.get("value", ())), len(self.values)):
            report(k / len(self.values))
            scene = self._scene(self.values[k])
            linkage = scene.linkage()
            ideal = start = self.initial_state(scene)
            if previous is not None and not np.isnan(rows["force"][-1]).any():
                start = continued(linkage, previous, Start(*rows["end"][-1]), start)
            row = {
                "value": np.array(self.values[k]),
                **run_value(scene, start, self.cycles, ideal),
            }
            for name, array in row.items():
                rows.setdefault(name, []).append(array)
            write_arrays(self.file, {name: np.array(each) for name, each in rows.items()}, np.savez)
            previous = linkage

    def _scene(self, value: float) -> Scene:
        return changed(self.scene, {self.parameter.key: value})


def read_branch(file: Path) -> Branch:
    """Return a stored branch; raises InputError if the file holds something else."""
    try:
        return Branch(**read_numbers(file))
    except TypeError:
        raise InputError(f"{file} is not a branch of a bifurcation diagram") from None


@dataclass(frozen=True)
class Diagram:
    """Bifurcation diagram, complete or in part.

    Attributes
    ----------
    scene : Scene
    parameter : Parameter
    cycles : Cycles
    branches : dict
        ``Branch`` by direction, "up" and "down".
    """

    scene: Scene
    parameter: Parameter
    cycles: Cycles
    branches: dict[str, Branch]

    def periods(self, direction: str) -> list[Periodicity | None]:
        """Return the period of the pin positions at each value; None where a run failed."""
        branch, names = self.branches[direction], self.scene.clearance_joints
        pins = [branch.eccentricity(j) for j in range(len(names))]
        periods: list[Periodicity | None] = []
        for k, value in enumerate(branch.value):
            states = np.concatenate([pin[k].reshape(len(pin[k]), -1) for pin in pins], axis=1)
            clearances = [
                value
                if self.parameter.key in ("clearance", f"{name}.clearance")
                else self.scene.bearing(name).clearance
                for name in names
            ]
            scales = np.repeat(clearances, 2 * len(PHASES))
            periods.append(None if np.isnan(states).any() else periodicity(states, scales))
        return periods

    def summary(self) -> list[str]:
        """Return one sentence for each branch."""
        sentences = []
        for direction, branch in self.branches.items():
            periods = self.periods(direction)
            counts = Counter(each.period for each in periods if each is not None and each.period)
            listed = ", ".join(f"period {k} at {counts[k]}" for k in sorted(counts))
            sentence = (
                f"{direction}: the motion is periodic at {counts.total()} of {len(periods)} values "
                f"within {100.0 * TOLERANCE:g} % of the clearance in {self.cycles.stored} cycles"
            )
            sentence += f" ({listed})" if listed else ""
            if self.cycles.exponent:
                chaotic = int(np.sum(branch.exponent[:, 0] - branch.exponent[:, 1] > 0.0))
                sentence += f"; the confidence interval of the exponent is above 0 at {chaotic}"
            failed = periods.count(None)
            sentence += f"; {failed} runs failed" if failed else ""
            sentences.append(f"{sentence}.")
        return sentences


def compute(
    scene: Scene,
    parameter: Parameter,
    cycles: Cycles,
    folder: Path,
    initial_state: InitialState,
    jobs: int | None = None,
    on_progress: Callable[[str, float], None] = lambda direction, share: None,
) -> Diagram:
    """Compute a diagram in a folder, or resume the diagram that the folder holds.

    Each branch is a chain of runs, so that at most two processes are used.

    Parameters
    ----------
    initial_state : callable
        Initial state of a scene, such as ``presswear.campaign.replicates.start_of``.
    jobs : int or None
        Processes; None for as many as there are cores.
    on_progress : callable
        Receives the direction of a branch and its completed share.

    Raises
    ------
    InputError
        If the folder holds another diagram or the scene has no clearance.
    """
    if not scene.clearance_joints:
        raise InputError("a bifurcation diagram needs a joint with clearance")
    scene.check_trusted()
    scene.check()
    document = {
        "schema": SCHEMA,
        "scene": scene.as_dict(),
        "parameter": asdict(parameter),
        "cycles": asdict(cycles),
    }
    lock = FolderLock(folder)
    try:
        if (folder / FILE).exists():
            stored = _document(folder)
            for name, value in plain(document).items():
                if stored[name] != value:
                    raise InputError(f"{folder} holds a diagram with another {name}")
        else:
            write_json(folder / FILE, document)
        values = (parameter.values, parameter.values[::-1])
        work: dict[int, Job] = {
            k: BranchJob(scene, parameter, each, cycles, initial_state, folder / f"{direction}.npz")
            for k, (direction, each) in enumerate(zip(DIRECTIONS, values, strict=True))
        }
        with workers_for(min(jobs or cores(), len(work)), (__name__,)) as workers:
            workers.run(
                work,
                lambda key, outcome: {},
                lambda key, done, word, rows: on_progress(DIRECTIONS[key], done),
            )
    finally:
        lock.release()
    return load(folder)


def load(folder: Path) -> Diagram:
    """Return a stored diagram; raises InputError if there is none or its file was altered."""
    stored = _document(folder)
    files = {direction: folder / f"{direction}.npz" for direction in DIRECTIONS}
    return Diagram(
        Scene.from_dict(stored["scene"]),
        typed(stored["parameter"], Parameter, f"{folder / FILE}: parameter"),
        typed(stored["cycles"], Cycles, f"{folder / FILE}: cycles"),
        {direction: read_branch(file) for direction, file in files.items() if file.exists()},
    )


def _document(folder: Path) -> dict[str, Any]:
    missing = f"{folder} holds no bifurcation diagram: it has no {FILE}"
    return read_json(folder / FILE, missing, SCHEMA)
