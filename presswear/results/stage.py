"""One stage of a result: statistics, recorded arrays, and the wear after it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from presswear.engines.base import Status
from presswear.linkage.surface import SIDES, Surface, bin_centres
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.columns import (
    CYCLE_COUNT,
    FILM_CYCLE,
    FILM_CYCLE_COUNT,
    JOINT_ARRAYS,
    JOINT_CYCLE,
    JOINT_CYCLE_COUNT,
    JOINT_SERIES,
    LEADER_CYCLE,
    SECTION_JOINT_NAMES,
    SECTION_NAMES,
    Column,
    cycle_column,
    first_film_column,
    first_leader_column,
    index_of,
    names_of,
)
from presswear.recording.film import Film
from presswear.recording.settling import Settling
from presswear.recording.soundness import Finding
from presswear.recording.statistics import Estimate
from presswear.results.motions import state_of
from presswear.scene.stage_names import stage_name
from presswear.tools.arrays import Array, Arrays
from presswear.tools.errors import InputError, NotStored, printable, unknown
from presswear.tools.numbers import counted
from presswear.tools.serialize import NOT_STORED

T = TypeVar("T")
LEAST_LOAD_DISTANCE = 1e-15  # N m in a cycle; an oiled press may have 1e-40

# of the length of a series: an instant may lie so far behind its last row by round-off
_ROW_ROUNDING = 1e-9


class Joints(dict[str, T]):
    """Values by the name of a joint with clearance; InputError lists them for an unknown name."""

    def __missing__(self, name: str) -> T:
        raise unknown("joint with clearance", name, self)


def _between_rows(times: Array, rows: Array, values: Array) -> Array:
    """Return values at times, linear between rows; nan beyond the first and the last row."""
    margin = _ROW_ROUNDING * (rows[-1] - rows[0])
    is_beyond = (times < rows[0] - margin) | (times > rows[-1] + margin)
    return np.where(is_beyond, np.nan, np.interp(times, rows, values))


@dataclass(frozen=True)
class OutputStatistics:
    """Motion of the output point over the sampled cycles; ``_per_cycle``: mean of the largest."""

    displacement_max: float  # m
    velocity_min: float  # m/s
    velocity_max: float
    acceleration_max: float  # m/s^2
    displacement_max_per_cycle: Estimate
    velocity_max_per_cycle: Estimate
    acceleration_max_per_cycle: Estimate


@dataclass(frozen=True)
class BottomStatistics:
    """Accuracy and repeatability at bottom dead centre over the sampled strokes; m and s."""

    strokes: int  # of all replicates
    ideal_height: float
    ideal_time: float  # in the cycle
    ideal_dwell: float  # time for which the ideal motion stays at bottom dead centre
    height: Estimate
    error: Estimate  # height over the ideal bottom dead centre
    range_of_all: float  # highest less lowest bottom dead centre
    range: Estimate | None  # mean range of ``range_strokes`` successive strokes
    range_strokes: int
    standard_deviation: Estimate | None  # of the height from stroke to stroke
    # Behind the ideal motion; None if the ideal motion dwells or has several equal
    # bottoms
    delay: Estimate | None = None
    delay_angle: Estimate | None = None  # rad
    delay_standard_deviation: Estimate | None = None
    # Times in the cycle of bottoms of an ideal stroke that differ by less than the
    # scatter, or of which different strokes reach different ones; empty: one bottom
    equal_bottoms: tuple[float, ...] = ()


@dataclass(frozen=True)
class WearPeak:
    """Deepest place of the wear map that one wear update adds."""

    depth: Estimate  # m
    angle: Estimate  # rad; the ends of its interval may lie below 0 or above 2 pi
    # error of the depth by the wear step, m; in the interval
    step_error: float | None = None


@dataclass(frozen=True)
class Bumps:
    """Bumps on worn surfaces that a wear update in one jump made from a map of few cycles."""

    height: float  # rms noise of bearing and pin together, m
    penetration: float  # median in contact, m

    @property
    def are_high(self) -> bool:
        """True if bumps are higher than the penetration, so that each breaks the contact."""
        return self.height > self.penetration


@dataclass(frozen=True)
class JointStatistics:
    """Forces, contacts and wear of a clearance joint in a stage, of all replicates; SI units."""

    peak_force: float  # largest normal force of the sampled cycles, N
    peak_force_per_cycle: Estimate  # mean of the largest in each cycle
    contacts: int
    contacts_per_cycle: Estimate
    unresolved_contacts: int  # with too few steps
    min_steps_per_contact: int | None  # None: no contact
    contact_time_fraction: float  # of the cycles in the means
    # integral of normal force times sliding speed, N m
    load_distance_per_cycle: Estimate
    wear_volume: Estimate  # that one wear update takes off bearing and pin, m^3
    wear_volume_step_error: float | None  # by the wear step, m^3; not in the interval
    # standard error of the wear map over its root mean square
    wear_map_error: float | None
    # deepest place of one wear update, m
    wear_depth_max_by_replicate: tuple[float, ...]
    wear_peaks: Mapping[str, WearPeak]
    """By ``bearing``, ``pin`` and, if the maps do not turn, ``both``; empty if noise hides them."""
    bumps: Bumps | None = None  # None: no jump before, one replicate, or no contact
    # over cycles, of the columns of ``JOINT_CYCLE``, and of ``FILM_CYCLE`` with a film in the
    # run, that declare a mean, by name; SI
    means: Mapping[str, Estimate] = field(default_factory=dict)

    @property
    def has_film(self) -> bool:
        """True if an oil film acted in the run."""
        return FILM_CYCLE[0].name in self.means

    @property
    def is_unworn(self) -> bool:
        """True if next to nothing rubs, as asperities under a thick oil film."""
        return self.load_distance_per_cycle.mean < LEAST_LOAD_DISTANCE


@dataclass(frozen=True)
class WallStatistics:
    """Wear rate of a wall of a guide with clearance in a stage; SI units.

    All wear is at the wall, over its width, by the constant coefficient.
    """

    volume_per_cycle: Estimate  # m^3
    depth_per_cycle: Estimate  # in the deepest bin along the wall, m
    place: float  # of this bin along the guide, from its point, m


@dataclass(frozen=True)
class StageStatistics:
    """Statistics of a stage; SI units. If they are not finite, only the cycles are stored."""

    cycles: int  # of all replicates
    energy_made_per_cycle: Estimate | None = None  # by the contacts, J
    # of all drives, less what it stores, J
    drive_work_per_cycle: Estimate | None = None
    output: OutputStatistics | None = None
    bdc: BottomStatistics | None = None  # None: nothing moves, or no stroke is complete
    joints: Mapping[str, JointStatistics] = field(default_factory=dict)
    wear_error: float | None = None  # relative
    # fraction by which finer time steps change it
    load_distance_step_error: float | None = None
    peak_force_step_error: float | None = None
    energy_residual: float = 0.0  # residual of the energy balance, J
    energy_exchanged: float = 0.0  # by the drives, J
    # made by contacts over dissipated by contacts and friction
    energy_made_fraction: float = 0.0
    # motions that the replicates came to; None: no clearance
    settling: Settling | None = None
    # over cycles, of the columns of ``CYCLE`` that declare a mean, by name; SI
    means: Mapping[str, Estimate] = field(default_factory=dict)
    # by guide with clearance, then by wall, ``left`` or ``right``
    walls: Mapping[str, Mapping[str, WallStatistics]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "joints", Joints(self.joints))

    @property
    def high_bumps(self) -> dict[str, Bumps]:
        """Joints whose bumps are higher than the penetration; with one, peaks have no interval."""
        bumps = {name: joint.bumps for name, joint in self.joints.items()}
        return {
            name: one for name, one in bumps.items() if one is not None and one.are_high
        }

    @property
    def energy_residual_fraction(self) -> float | None:
        """Absolute residual over the energy that drives exchanged; None if they exchanged none."""
        if not self.energy_exchanged:
            return None
        return abs(self.energy_residual) / self.energy_exchanged


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
class JointResult:
    """Clearance joint in a stage."""

    name: str
    # None if the stage failed before a cycle was complete
    stored: JointStatistics | None
    # By their names in the file, without the name of the joint
    arrays: Mapping[str, Array] = field(repr=False)

    @property
    def statistics(self) -> JointStatistics:
        """Statistics of the joint; raises InputError if no cycle is complete."""
        if self.stored is None:
            raise InputError(f"joint {self.name}: no cycle of the stage is complete")
        return self.stored

    def _series(self, name: str) -> Array:
        if name not in self.arrays:
            has_series = any(one in self.arrays for one in JOINT_ARRAYS)
            advice = "run the scene again" if has_series else "use series = all"
            raise NotStored(f"joint {self.name}: its {name} was not stored; {advice}")
        return self.arrays[name]

    def series(self, name: str) -> Array:
        """Return a recorded series by a name of ``columns.JOINT_SERIES``, shape (n,); SI."""
        for array, names in JOINT_ARRAYS.items():
            if name in names:
                values = self._series(array)
                return values if len(names) == 1 else values[:, names.index(name)]
        raise unknown("series of a joint", name, names_of(JOINT_SERIES))

    @property
    def eccentricity(self) -> Array:
        """Pin centre minus bearing centre, shape (n, 2), m."""
        return self._series("eccentricity")

    @property
    def penetration(self) -> Array:
        """Penetration of the pin, shape (n,), m; negative while open."""
        return self._series("penetration")

    @property
    def force(self) -> Array:
        """Normal and tangential force, shape (n, 2), N."""
        return self._series("force")

    @property
    def sliding(self) -> Array:
        """Sliding speed at the contact, shape (n,), m/s."""
        return self._series("sliding")

    @property
    def angle(self) -> Array:
        """Angles of the bins of the wear maps, shape (bins,), rad."""
        return bin_centres(self.arrays["depth_bearing"].size)

    def contact(self, name: str) -> Array:
        """Return a quantity of each recorded contact, by a name of ``CONTACT_COLUMNS``; SI."""
        place = index_of("quantity of a contact", name, CONTACT_COLUMNS)
        return self.arrays["contacts"][:, place]

    def each_cycle(self, name: str) -> Array:
        """Return a quantity of each cycle, shape (cycles,); SI.

        Its name is of ``JOINT_CYCLE``, or of ``FILM_CYCLE`` with an oil film in the run.
        """
        columns: tuple[Column, ...] = JOINT_CYCLE
        if self.arrays["cycles"].shape[1] > JOINT_CYCLE_COUNT:
            columns += FILM_CYCLE
        place = index_of("quantity of a joint's cycle", name, names_of(columns))
        return self.arrays["cycles"][:, place]

    def depth(self, side: str) -> Array:
        """Return the wear depth of ``bearing`` or ``pin`` in the stage, shape (bins,), m."""
        return self._of_side("depth", side)

    def wear(self, side: str) -> Array:
        """Return the depth that the next wear update adds to a side, shape (bins,), m."""
        return self._of_side("wear", side)

    def _of_side(self, name: str, side: str) -> Array:
        if side not in SIDES:
            raise unknown("side of a joint", side, SIDES)
        return self.arrays[f"{name}_{side}"]


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
    simulated_s: float  # of all replicates
    wall_s: float
    diagnostics: Mapping[str, str | int | float | None]  # of the solver
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
            volume = joint.wear_volume.scaled(1e15 / self.cycles_per_update)
            force = f"mean peak force {joint.peak_force_per_cycle} N"
            worn = f", worn volume per million strokes {volume} mm³"
            lines.append(f"{name}: {force}{worn if volume.mean > 0.0 else ''}")
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
        names = [f"{name}_depth_{side}" for name in self.joint_names for side in SIDES]
        names += [f"{guide}_wall_depth" for guide in self.statistics.walls]
        return any(bool(np.any(self.arrays.get(name, 0.0))) for name in names)

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
        oiled = [name for name, one in self.statistics.joints.items() if one.has_film]
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
            quantities += [f"{prefix}.{each}" for each in SECTION_JOINT_NAMES]
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
