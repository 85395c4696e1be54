"""Bifurcation diagrams: a motion over a parameter, with increasing and decreasing values.

Each run continues from the end of the run at the previous value, so that hysteresis is
visible.
"""

import math
import re
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswear.analysis.lyapunov import largest_exponent
from presswear.analysis.periods import TOLERANCE, Periodicity, periodicity
from presswear.analysis.pins import (
    capped,
    capped_slides,
    eccentricities,
    move_pins,
    slides,
)
from presswear.engines.base import Plan, Start, with_velocity
from presswear.engines.settings import InHouse
from presswear.linkage.guide_corner import CORNERS
from presswear.linkage.linkage import Linkage
from presswear.recording.columns import (
    SECTION_JOINT_NAMES,
    SECTION_NAMES,
    Column,
    cycle_quantities,
    index_of,
)
from presswear.results.frames import frame
from presswear.results.provenance import provenance
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import setting_of
from presswear.scene.settings import changed
from presswear.scene.value_ranges import values_of
from presswear.tools.arguments import checked_arguments
from presswear.tools.arrays import read_arrays, write_arrays
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import only_writer
from presswear.tools.processes import Report, Workers, cores
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import plain, read_json, typed, write_json
from presswear.tools.units import UNITS

if TYPE_CHECKING:
    import pandas

# Rows of ``run_value`` in the order of the runs; their fields are attributes
Branch = np.recarray[Any, Any]
InitialState = Callable[[Scene], Start]

# The places of periodic pins differ by 6e-4 of the clearance from a tolerance of 1e-9.
ENGINE = InHouse("dopri5", 1e-6)
PHASES = (0.25, 0.5, 0.75, 1.0)  # phases of the stored states
DIRECTIONS = ("up", "down")
FILE = "diagram.json"
SCHEMA = 6
_NUMBER = re.compile(r"[-+]?\d*\.?\d+([eE][-+]?\d+)?(\s*pi\b)?")


@dataclass(frozen=True)
class Parameter:
    """Bifurcation parameter."""

    key: str  # setting as in ``--set``, such as ``speed`` or ``B.clearance``
    values: tuple[float, ...]  # increasing, SI
    unit: str
    shown: str = ""  # unit in which the user wrote the values; empty: none

    @property
    def factor_and_unit(self) -> tuple[float, str]:
        """Factor from SI to the unit in which the diagram is drawn, and that unit."""
        size = UNITS.get(self.unit, {}).get(self.shown)
        if size:
            return 1.0 / size, "µm" if self.shown == "um" else self.shown
        written = Quantity(self.unit).in_unit_of(self.values[-1])
        return 1.0 / written.size, written.unit

    @staticmethod
    def parse(text: str, scene: Scene) -> "Parameter":
        """Return the parameter from text such as ``speed=2pi:12pi:200 rad/s``."""
        key, _, values_text = map(str.strip, text.partition("="))
        if not values_text:
            raise InputError(f"over {text}: expected KEY=FIRST:LAST:COUNT UNIT")
        meaning = setting_of(scene, key).meaning
        if not isinstance(meaning, Quantity) or meaning.whole:
            raise InputError(
                f"over {text}: must be a quantity, not a count or a choice"
            )
        values = sorted(set(values_of(key, values_text, meaning)))
        if len(values) < 2:
            raise InputError(f"over {text}: needs at least two different values")
        for value in (values[0], values[-1]):
            # Raises if the scene does not allow the value.
            changed(scene, {key: value}).check()
        units = re.split("[:,]", _NUMBER.sub("", values_text))
        shown = next(filter(None, map(str.strip, reversed(units))), "")
        return Parameter(key, tuple(values), meaning.unit, shown)


@dataclass(frozen=True)
class Cycles:
    """Number of cycles at each value."""

    total: int
    stored: int  # last cycles, whose states are stored
    exponent: int  # further cycles for the exponent; 0: none

    @staticmethod
    def of(total: int, stored: int | None, exponent: int) -> "Cycles":
        """Return the numbers; by default 40 % of the cycles are stored."""
        return Cycles(total, stored or max(2 * total // 5, 2), exponent)

    def __post_init__(self) -> None:
        if not 2 <= self.stored < self.total:
            raise InputError(
                f"stored = {self.stored}: must be 2 to {self.total - 1} of {self.total} cycles"
            )


def continued(linkage: Linkage, previous: Linkage, end: Start, ideal: Start) -> Start:
    """Return the end of a run, after whole cycles, as the initial state of another linkage.

    Pins and slides keep their positions relative to the clearance, except that contacts open.
    Velocities are scaled with the speed of the first drive. Positions and velocities
    are then projected on the constraints and drives. Full turns of bodies are counted
    from ``ideal``, the initial state of the ideal linkage.
    """
    position = end.position.copy()
    turns = np.round((position[2::3] - ideal.position[2::3]) / (2.0 * math.pi))
    position[2::3] -= 2.0 * math.pi * turns
    clearance = np.array([joint.clearance for joint in linkage.clearances])
    previous_clearance = np.array([joint.clearance for joint in previous.clearances])
    ratio = (clearance / previous_clearance)[:, np.newaxis]
    pins = len(clearance) - len(linkage.corners)
    target = eccentricities(linkage, position) * ratio[:pins]
    # All corners of a slide have the clearance of its guide.
    places = slides(linkage, position) * ratio[pins :: len(CORNERS)]
    position = move_pins(
        linkage,
        position,
        capped(target, clearance[:pins]),
        capped_slides(linkage, places),
    )
    velocity = end.velocity * (linkage.drives[0].speed / previous.drives[0].speed)
    return with_velocity(linkage, position, velocity)


def quantities_of(scene: Scene) -> dict[str, Column]:
    """Return the numbers of each cycle by name, such as ``A.force_max``, in their order."""
    linkage = scene.linkage()
    return cycle_quantities(
        [joint.name for joint in linkage.clearances],
        [drive.body for drive in linkage.drives],
        linkage.leader is not None,
        [joint.name for joint in linkage.oiled_joints],
    )


def run_value(scene: Scene, start: Start, cycles: Cycles, ideal: Start) -> NDArray[Any]:
    """Return the row of one value on unworn surfaces, a record with these fields.

    ``pins``, shape (stored, phases, joints, 2): positions of the pins, m; ``numbers``,
    shape (stored, quantities): ``quantities_of`` the scene in each stored cycle, SI; ``exponent``,
    shape (2,): largest Lyapunov exponent and half width of its interval, 1/s; ``end``,
    shape (2, 3 bodies): positions and velocities at the end. Numbers that are not
    computed are NaN. If the run fails, all numbers are NaN and the end is ``ideal``.
    """
    linkage = scene.linkage()
    period = scene.mechanism.period
    joints = len(linkage.clearances)
    fields: list[Any] = [
        ("value", float),
        ("pins", float, (cycles.stored, len(PHASES), joints, 2)),
        ("numbers", float, (cycles.stored, len(quantities_of(scene)))),
        ("exponent", float, 2),
        ("end", float, (2, len(start.position))),
    ]
    row = np.full(1, math.nan, fields)
    plan = Plan(period, cycles.total, 1, sections=PHASES)
    run = ENGINE.simulate(linkage, start, plan)
    if run.status == "failed":
        row["end"] = ideal.position, ideal.velocity
        return row
    row["end"] = run.end.position, run.end.velocity
    columns = []
    for joint in range(joints):
        first = len(SECTION_NAMES) + len(SECTION_JOINT_NAMES) * joint
        for name in ("eccentricity_x", "eccentricity_y"):
            columns.append(first + SECTION_JOINT_NAMES.index(name))
    pins = run.recorder.sections[-cycles.stored :, :, columns]
    row["pins"] = pins.reshape(row["pins"].shape)
    row["numbers"] = run.recorder.cycles[-cycles.stored :]
    if cycles.exponent:
        end = continued(linkage, linkage, run.end, start)
        with suppress(RunFailed):
            exponent = largest_exponent(linkage, end, period, cycles.exponent)
            row["exponent"] = exponent.mean, exponent.half_width or math.nan
    return row


def run_branch(
    scene: Scene,
    key: str,
    values: tuple[float, ...],
    cycles: Cycles,
    initial_state: InitialState,
    file: Path,
    report: Report,
) -> None:
    """Run the values that the file of a branch lacks, in order; write the file after each."""
    rows = list(read_branch(file)) if file.exists() else []
    for k in range(len(rows), len(values)):
        report(k / len(values))
        scene_at_value = changed(scene, {key: values[k]})
        ideal = initial_state(scene_at_value)
        start = ideal
        if rows and not np.isnan(rows[-1]["pins"]).any():
            previous = changed(scene, {key: values[k - 1]}).linkage()
            end = Start(*rows[-1]["end"])
            start = continued(scene_at_value.linkage(), previous, end, ideal)
        row = run_value(scene_at_value, start, cycles, ideal)
        row["value"] = values[k]
        rows.append(row[0])
        write_arrays(file, {"rows": np.array(rows)}, np.savez)


def read_branch(file: Path) -> Branch:
    """Return a stored branch; raise InputError if the file holds something else."""
    rows = read_arrays(file).get("rows")
    if rows is None or rows.dtype.names is None:
        raise InputError(f"{file} is not a branch of a bifurcation diagram")
    return rows.view(np.recarray)


@dataclass(frozen=True)
class Diagram:
    """Bifurcation diagram, complete or in part."""

    scene: Scene
    parameter: Parameter
    cycles: Cycles
    branches: dict[str, Branch]  # by direction, "up" and "down"
    provenance: Mapping[str, Any]  # command, versions and date

    def periods(self, direction: str) -> list[Periodicity | None]:
        """Return the period of the pin positions at each value; None where a run failed."""
        periods: list[Periodicity | None] = []
        for row in self.branches[direction]:
            scene = changed(self.scene, {self.parameter.key: float(row.value)})
            scales = [scene.bearing(name).clearance for name in scene.clearance_joints]
            states = row.pins / np.array(scales)[:, np.newaxis]
            states = states.reshape(len(row.pins), -1)
            has_failed = np.isnan(states).any()
            scale = np.ones(states.shape[1])
            periods.append(None if has_failed else periodicity(states, scale))
        return periods

    @property
    def quantities(self) -> dict[str, Column]:
        """Numbers that are stored of each cycle, by name."""
        return quantities_of(self.scene)

    def numbers(self, name: str, direction: str) -> NDArray[Any]:
        """Return a quantity of a branch, SI, shape (values, stored cycles).

        ``name`` is one of ``quantities``, such as ``A.force_max``, and the direction is ``up``
        or ``down``. Numbers of a run that failed are NaN.
        """
        names = tuple(self.quantities)
        return self.branches[direction].numbers[:, :, index_of("quantity", name, names)]

    def table(self) -> dict[str, NDArray[Any]]:
        """Return columns with a row for each stored cycle of each value, up and then down.

        They are the parameter, ``is_decreasing``, ``cycle``, ``period``, ``exponent`` and
        ``exponent_half_width``, and the ``quantities``, with ``_`` in place of the dot; SI.
        """
        branches = [self._columns(direction) for direction in self.branches]
        table = {}
        for name in branches[0] if branches else ():
            values = np.concatenate([columns[name] for columns in branches])
            table[name.replace(".", "_")] = values
        return table

    def _columns(self, direction: str) -> dict[str, NDArray[Any]]:
        """Return the columns of ``table`` of one branch, with the names of quantities."""
        stored = self.cycles.stored
        branch = self.branches[direction]
        periods = []
        for motion in self.periods(direction):
            periods.append(float(motion.period or 0) if motion else math.nan)
        by_value = {
            self.parameter.key: branch.value,
            "is_decreasing": np.full(len(branch), float(direction == "down")),
            "period": np.array(periods),
            "exponent": branch.exponent[:, 0],
            "exponent_half_width": branch.exponent[:, 1],
        }
        columns = {name: np.repeat(values, stored) for name, values in by_value.items()}
        stored_cycles = np.arange(self.cycles.total - stored, self.cycles.total) + 1.0
        columns["cycle"] = np.tile(stored_cycles, len(branch))
        for name in self.quantities:
            columns[name] = self.numbers(name, direction).ravel()
        return columns

    def units(self) -> dict[str, str]:
        """Return the units of the columns of ``table``."""
        units = {self.parameter.key: self.parameter.unit}
        units |= dict.fromkeys(("is_decreasing", "cycle", "period"), "1")
        units |= dict.fromkeys(("exponent", "exponent_half_width"), "1/s")
        units |= {name: column.unit for name, column in self.quantities.items()}
        return {name.replace(".", "_"): unit for name, unit in units.items()}

    def to_pandas(self) -> "pandas.DataFrame":
        """Return ``table`` as a data frame, with units in ``attrs["units"]``; needs pandas."""
        return frame(self.table(), self.units())

    def summary(self) -> list[str]:
        """Return one sentence for each branch."""
        sentences = []
        for direction, branch in self.branches.items():
            periods = self.periods(direction)
            cycles = [motion.period for motion in periods if motion and motion.period]
            counts = Counter(cycles)
            listed = ", ".join(f"period {k} at {counts[k]}" for k in sorted(counts))
            sentence = (
                f"{direction}: the motion is periodic at {counts.total()} of {len(periods)} values "
                f"within {100.0 * TOLERANCE:g} % of the clearance in {self.cycles.stored} cycles"
            )
            if listed:
                sentence += f" ({listed})"
            if self.cycles.exponent:
                exponent, half_width = branch.exponent.T
                chaotic = np.count_nonzero(exponent - half_width > 0.0)
                sentence += (
                    f"; the confidence interval of the exponent is above 0 at {chaotic}"
                )
            failed = periods.count(None)
            if failed:
                sentence += f"; {failed} runs failed"
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
    ``initial_state`` returns the start of a scene, such as
    ``presswear.campaign.replicates.start_of``. ``on_progress`` gets the direction of a
    branch and its completed share.
    """
    if not scene.clearance_joints:
        raise InputError("a bifurcation diagram needs a joint with clearance")
    scene.check_trusted()
    scene.check()
    inputs = {"scene": scene.as_dict(), "parameter": parameter, "cycles": cycles}
    branches: dict[int, Any] = {}
    for k, values in enumerate((parameter.values, parameter.values[::-1])):
        file = folder / f"{DIRECTIONS[k]}.npz"
        arguments = scene, parameter.key, values, cycles, initial_state, file
        branches[k] = partial(run_branch, *arguments)
    with only_writer(folder, resume=True):
        _write_document(folder, inputs)
        count = min(jobs or cores(), len(branches))
        with Workers(count, (__name__,)) as workers:
            workers.run(
                branches,
                lambda key, outcome: {},
                lambda key, share, word, rows: on_progress(DIRECTIONS[key], share),
            )
    return load_diagram(folder)


def _write_document(folder: Path, inputs: Mapping[str, Any]) -> None:
    """Write the inputs of a diagram; raise InputError if the folder has other inputs."""
    if not (folder / FILE).exists():
        origin = {"schema": SCHEMA, "provenance": provenance()}
        write_json(folder / FILE, {**origin, **inputs})
        return
    stored = _document(folder)
    for name, value in plain(inputs).items():
        if stored[name] != value:
            raise InputError(f"{folder} holds a diagram with another {name}")


@checked_arguments
def load_diagram(folder: str | Path) -> Diagram:
    """Read the folder of a bifurcation diagram, complete or in part.

    Raises
    ------
    InputError
        If the folder holds no diagram, or a file in it was altered.
    """
    folder = Path(folder)
    stored = _document(folder)
    parameter = typed(stored["parameter"], Parameter, f"{folder / FILE}: parameter")
    cycles = typed(stored["cycles"], Cycles, f"{folder / FILE}: cycles")
    files = {direction: folder / f"{direction}.npz" for direction in DIRECTIONS}
    branches = {
        direction: read_branch(file)
        for direction, file in files.items()
        if file.exists()
    }
    scene = Scene.from_dict(stored["scene"])
    return Diagram(scene, parameter, cycles, branches, stored["provenance"])


def _document(folder: Path) -> dict[str, Any]:
    missing = f"{folder} holds no bifurcation diagram: it has no {FILE}"
    return read_json(folder / FILE, missing, SCHEMA)
