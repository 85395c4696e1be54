"""Statistics of a stage: output point, bottom dead centre, joints, walls."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from presswear.recording.columns import FILM_CYCLE
from presswear.recording.settling import Settling
from presswear.recording.statistics import Estimate
from presswear.tools.errors import unknown

T = TypeVar("T")
LEAST_LOAD_DISTANCE = 1e-15  # N m in a cycle; an oiled press may have 1e-40


class Joints(dict[str, T]):
    """Values by the name of a joint with clearance; InputError lists them for an unknown name."""

    def __missing__(self, name: str) -> T:
        raise unknown("joint with clearance", name, self)


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

    strokes: int  # total over all replicates
    ideal_height: float
    ideal_time: float  # in the cycle
    ideal_dwell: float  # time for which the ideal motion stays at bottom dead centre
    height: Estimate
    error: Estimate  # height over the ideal bottom dead centre
    range_of_all: float  # highest less lowest bottom dead centre
    range: Estimate | None  # mean range of ``range_strokes`` successive strokes
    range_strokes: int
    standard_deviation: Estimate | None  # scatter of the height from stroke to stroke
    # Behind the ideal motion; None if the ideal motion dwells or has several equal
    # bottoms
    delay: Estimate | None = None
    delay_angle: Estimate | None = None  # rad
    delay_standard_deviation: Estimate | None = None
    # Times in the cycle of the bottoms of an ideal stroke with several bottoms: their
    # heights differ by less than the scatter, or strokes are lowest at different ones.
    # Empty if there is one bottom
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
    contact_time_fraction: float  # fraction of the time of the cycles in the means
    # integral of normal force times sliding speed, N m
    load_distance_per_cycle: Estimate
    # volume that one wear update takes off bearing and pin, m^3
    wear_volume: Estimate
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
    place: float  # place of this bin along the guide, from the point of the guide, m


@dataclass(frozen=True)
class StageStatistics:
    """Statistics of a stage; SI units. If they are not finite, only the cycles are stored."""

    cycles: int  # total over all replicates
    energy_made_per_cycle: Estimate | None = None  # by the contacts, J
    # work of all drives, less the energy that is stored, J
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
        high = {}
        for name, joint in self.joints.items():
            if joint.bumps is not None and joint.bumps.are_high:
                high[name] = joint.bumps
        return high

    @property
    def energy_residual_fraction(self) -> float | None:
        """Absolute residual over the energy that drives exchanged; None if they exchanged none."""
        if not self.energy_exchanged:
            return None
        return abs(self.energy_residual) / self.energy_exchanged
