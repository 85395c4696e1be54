"""One stage of a result: statistics, recorded arrays, and the wear after it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from presswear.engines.base import Status
from presswear.linkage.surface import SIDES, Surface
from presswear.recording.columns import (
    CYCLE_COUNT,
    FILM_CYCLE_COUNT,
    JOINT_CYCLE_COUNT,
    JOINT_SERIES,
    LEADER_CYCLE,
    SECTION_JOINT_NAMES,
    SECTION_NAMES,
    SERIES,
    cycle_column,
    first_film_column,
    first_leader_column,
    names_of,
)
from presswear.recording.film import Film
from presswear.recording.soundness import Finding
from presswear.results import frames
from presswear.results.joint_result import JointResult
from presswear.results.motions import state_of
from presswear.results.stage_statistics import (
    BottomStatistics,
    Joints,
    OutputStatistics,
    StageStatistics,
)
from presswear.scene.stage_names import stage_name
from presswear.tools.arrays import Array, Arrays
from presswear.tools.errors import InputError, printable, unknown
from presswear.tools.numbers import MM3_PER_MILLION, counted
from presswear.tools.serialize import NOT_STORED

if TYPE_CHECKING:
    import pandas
    import xarray

# Part of the length of a series by which round-off may move an instant behind its last row
_ROW_ROUNDING = 1e-9


def _between_rows(times: Array, rows: Array, values: Array) -> Array:
    """Return values at times, linear between rows; nan beyond the first and the last row."""
    margin = _ROW_ROUNDING * (rows[-1] - rows[0])
    is_beyond = (times < rows[0] - margin) | (times > rows[-1] + margin)
    return np.where(is_beyond, np.nan, np.interp(times, rows, values))


@dataclass(frozen=True)
class WearStep:
    """One step of a wear update."""

    cycles_per_update: float  # cycles that the step stands for
    cycles: int  # simulated cycles that it multiplies
    factor: float  # cycles that one cycle of a replicate stands for
    clearance_change: float  # largest change of a profile over its clearance
    max_depth: Mapping[str, Mapping[str, float]]  # by joint and side, after the step, m
    peak_force: Mapping[str, float]  # normal force by joint, N
    wall_s: float


@dataclass(frozen=True)
class StageResult:
    """Stage and the wear update after it.

    Attributes
    ----------
    index : int
        Number of wear updates before the stage.
    status : {"completed", "enough", "failed"}
        ``enough``: the wear maps reached the tolerance before all cycles had run.
    message : str
        Reason of a failure.
    cycles_per_update : float
        Cycles that the wear after the stage represents.
    wear_steps : tuple of WearStep
        Steps of the wear update after the stage; empty after the last stage.
    arrays : mapping
        Arrays by their names in ``stage-K.npz``.
    """

    index: int
    status: Status
    message: str
    finding: Finding | None  # cause that ended the stage, or the wear after it
    cycles_per_update: float
    wear_steps: tuple[WearStep, ...]
    simulated_s: float  # simulated time of all replicates, s
    wall_s: float
    diagnostics: Mapping[str, str | int | float | None]  # diagnostics of the solver
    statistics: StageStatistics
    arrays: Mapping[str, Array] = field(
        default_factory=dict, metadata=NOT_STORED, repr=False
    )
    # with clearance
    joint_names: tuple[str, ...] = field(default=(), metadata=NOT_STORED)
    read_film: Callable[[], Film] | None = field(
        default=None, metadata=NOT_STORED, repr=False
    )

    def __repr__(self) -> str:
        """Return the cycles, peak force and wear of each joint, and the kind of motion."""
        statistics = self.statistics
        cycles = counted(statistics.cycles, "cycle")
        lines = [f"{self.name}: {self.message or self.status}, {cycles}"]
        for name, joint in statistics.joints.items():
            volume = joint.wear_volume.scaled(MM3_PER_MILLION / self.cycles_per_update)
            force = f"mean peak force {joint.peak_force_per_cycle} N"
            worn = f", worn volume per million strokes {volume} mm³"
            lines.append(f"{name}: {force}{worn if volume.mean > 0.0 else ''}")
        for guide, walls in statistics.walls.items():
            for side, wall in walls.items():
                volume = wall.volume_per_cycle.scaled(MM3_PER_MILLION)
                worn = f"worn volume per million strokes {volume} mm³"
                lines.append(f"{side} wall of {guide}: {worn}")
        if statistics.settling is not None:
            lines.append(f"motion: {state_of(statistics.settling)}")
        lines.append("more: statistics, diagnostics, joints, arrays")
        return printable("\n".join(lines))

    @property
    def name(self) -> str:
        """Name of the stage: ``no wear``, or ``initial surfaces``, ``first wear``, ..."""
        return stage_name(self.index, self.is_worn)

    @property
    def is_worn(self) -> bool:
        """True if a surface in the stage is worn."""
        depths = [
            f"{name}_depth_{side}" for name, side in product(self.joint_names, SIDES)
        ]
        depths += [f"{guide}_wall_depth" for guide in self.statistics.walls]
        return any(np.any(self.arrays.get(name, 0.0)) for name in depths)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the recorded series over the time, s, in SI; needs pandas.

        The columns are those of ``presswear export`` of the output point and of each
        joint, such as ``A_normal_force``. ``attrs["units"]`` holds their units.
        """
        columns, units = self._columns()
        return frames.frame(columns, units, "time")

    def to_xarray(self) -> "xarray.Dataset":
        """Return the recorded series over the time, s, with their units; needs xarray."""
        columns, units = self._columns()
        return frames.data_set(columns, units, ["time"])

    def _columns(self) -> tuple[dict[str, Array], dict[str, str]]:
        """Return the recorded series of the output point and the joints, and their units."""
        columns = {column.table_name: getattr(self, column.name) for column in SERIES}
        units = {column.table_name: column.unit for column in SERIES}
        if not self.has_joint_series:
            return columns, units
        for name, joint in self.joints.items():
            for column in JOINT_SERIES:
                columns[f"{name}_{column.table_name}"] = joint.series(column.name)
                units[f"{name}_{column.table_name}"] = column.unit
        return columns, units

    @property
    def has_joint_series(self) -> bool:
        """True if series of the joints are stored."""
        return any(f"{name}_force" in self.arrays for name in self.joint_names)

    @property
    def surfaces(self) -> dict[str, tuple[Surface, Surface]]:
        """Surfaces in the stage, mean over the replicates.

        They are bearing and pin by joint, and the left and the right wall by guide.
        """
        surfaces = {
            name: (Surface(joint.depth("bearing")), Surface(joint.depth("pin")))
            for name, joint in self.joints.items()
            if "depth_bearing" in joint.arrays
        }
        for guide in self.statistics.walls:
            left, right = self.wall_depth(guide)[1]
            surfaces[guide] = Surface(left), Surface(right)
        return surfaces

    def wall_wear(self, guide: str) -> tuple[Array, Array]:
        """Return places along a guide and the mean depth that a cycle adds to its walls.

        Places are from the point of the guide, m, shape (bins,). Depths are of the left
        and the right wall, seen along the direction of the guide, m, shape (2, bins).
        InputError for a guide whose walls have no map.
        """
        return self._of_walls("wear", guide)

    def wall_depth(self, guide: str) -> tuple[Array, Array]:
        """Return places along a guide and the depth of its walls in the stage, m.

        The depth is the mean of the replicates; shapes as in ``wall_wear``.
        """
        return self._of_walls("depth", guide)

    def _of_walls(self, name: str, guide: str) -> tuple[Array, Array]:
        if f"{guide}_wall_{name}" not in self.arrays:
            walls = self.statistics.walls
            raise unknown("guide with wear of its walls", guide, walls)
        return self.arrays[f"{guide}_wall_place"], self.arrays[f"{guide}_wall_{name}"]

    @property
    def failed(self) -> bool:
        """True if the run of the stage failed; its numbers are then meaningless."""
        return self.status == "failed"

    @property
    def has_sound_cycles(self) -> bool:
        """True if the run did not fail and completed a cycle."""
        return not self.failed and bool(self.arrays["cycles"].size)

    @property
    def film(self) -> Film:
        """Film frames of the first replicate; raises InputError if missing or damaged."""
        if self.read_film is None:
            raise InputError(f"{self.name}: no film was stored")
        return self.read_film()

    @property
    def output(self) -> OutputStatistics:
        """Statistics of the output point; InputError if no cycle is complete."""
        if self.statistics.output is None:
            raise InputError(f"{self.name}: no cycle is complete")
        return self.statistics.output

    @property
    def bdc(self) -> BottomStatistics:
        """Statistics of bottom dead centre; InputError if there is no sampled stroke."""
        if self.statistics.bdc is None:
            raise InputError(f"{self.name}: there is no sampled stroke")
        return self.statistics.bdc

    @property
    def time(self) -> Array:
        """Times of the recorded series, shape (n,), s; with a motor the nominal times.

        The nominal time is that at which the ideal motion has the first driven body at
        its angle. Places in a cycle are functions of it.
        """
        return self.arrays["time"]

    @property
    def has_clock(self) -> bool:
        """True with a motor, whose cycles do not last equally long."""
        return "clock" in self.arrays

    @property
    def clock(self) -> Array:
        """Real times of the recorded series, shape (n,), s; for durations and integrals."""
        return self.arrays["clock"] if self.has_clock else self.time

    @property
    def nominal_rate(self) -> Array:
        """Speed of the first motor over its nominal speed at the rows of the series, (n,)."""
        if not self.has_clock:
            return np.ones(self.time.size)
        return self.arrays["nominal_rate"]

    def nominal_of(self, clock: Array) -> Array:
        """Return the nominal times of real times, s, linear between rows of the series.

        With a motor they are nan beyond the first and the last row.
        """
        return _between_rows(clock, self.clock, self.time) if self.has_clock else clock

    def clock_of(self, time: Array) -> Array:
        """Return the real times of nominal times, s, linear between rows of the series.

        With a motor they are nan beyond the first and the last row.
        """
        return _between_rows(time, self.time, self.clock) if self.has_clock else time

    @property
    def displacement(self) -> Array:
        """Displacement of the output point, shape (n,), m."""
        return self.arrays["slider"][:, 0]

    @property
    def velocity(self) -> Array:
        """Velocity of the output point, shape (n,), m/s."""
        return self.arrays["slider"][:, 1]

    @property
    def acceleration(self) -> Array:
        """Acceleration of the output point, shape (n,), m/s^2."""
        return self.arrays["slider"][:, 2]

    @property
    def joints(self) -> dict[str, JointResult]:
        """Joints with clearance by name."""
        joints = Joints[JointResult]()
        cycles = self.arrays["cycles"]
        oiled = [
            name for name, joint in self.statistics.joints.items() if joint.has_film
        ]
        first_film = first_film_column(len(self.joint_names), self.has_clock)
        for k, name in enumerate(self.joint_names):
            prefix = f"{name}_"
            first = CYCLE_COUNT + JOINT_CYCLE_COUNT * k
            columns = [*range(first, first + JOINT_CYCLE_COUNT)]
            if name in oiled:
                film = first_film + FILM_CYCLE_COUNT * oiled.index(name)
                columns += range(film, film + FILM_CYCLE_COUNT)
            parts = {
                key.removeprefix(prefix): array
                for key, array in self.arrays.items()
                if key.startswith(prefix)
            }
            source = getattr(self.arrays, "source", self.name)
            arrays = Arrays(parts, f"{source}, joint {name}")
            arrays["cycles"] = cycles[:, columns]
            joints[name] = JointResult(name, self.statistics.joints.get(name), arrays)
        return joints

    def section(self, name: str, joint: str = "") -> Array:
        """Return a quantity in the Poincaré sections of the first replicate; SI.

        Its name is of ``SECTION_NAMES``, or of ``SECTION_JOINT_NAMES`` for a joint. The
        result has the shape (cycles, sections).
        """
        if "sections" not in self.arrays:
            raise InputError(f"{self.name}: no sections were stored; use sections = 1")
        quantities = [*SECTION_NAMES]
        for prefix in self.joint_names:
            quantities += [f"{prefix}.{quantity}" for quantity in SECTION_JOINT_NAMES]
        column = f"{joint}.{name}" if joint else name
        if column not in quantities:
            raise unknown("quantity of a section", column, quantities)
        return self.arrays["sections"][:, :, quantities.index(column)]

    def each_cycle(self, name: str) -> Array:
        """Return a quantity of each cycle, shape (cycles,); SI.

        Its name is of ``CYCLE``, or of ``LEADER_CYCLE`` with a motor.
        """
        leader = names_of(LEADER_CYCLE)
        if name not in leader:
            return self.arrays["cycles"][:, cycle_column(name)]
        if not self.has_clock:
            raise InputError(
                f"{self.name}: {name} is stored with a motor alone; without a motor "
                "all cycles last equally long"
            )
        first = first_leader_column(len(self.joint_names))
        return self.arrays["cycles"][:, first + leader.index(name)]
