"""One stage of a result: what ran, what it observed, and the wear after it."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Status
from presswear.linkage.surface import SIDES as SIDES
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.film import Film
from presswear.recording.observe import (
    CYCLE_DRIVE,
    CYCLE_FIXED,
    CYCLE_JOINT,
    SECTION_JOINT_NAMES,
    SECTION_NAMES,
    cycle_columns,
)
from presswear.recording.soundness import Finding
from presswear.recording.statistics import Estimate
from presswear.scene.scene import stage_name
from presswear.tools.errors import InputError

Array = NDArray[np.float64]

JOINT_SERIES = ("eccentricity", "penetration", "force", "sliding")
"""Arrays of a joint with a row at each of the times of a stage."""


def angle_names(bins: Mapping[str, int]) -> dict[str, str]:
    """Names of the arrays that hold the angles of wear maps, by joint.

    ``angle`` where all have as many bins, else ``J_angle`` for joint J.

    Parameters
    ----------
    bins : mapping of str to int
        Of the maps of each joint.
    """
    are_alike = len(set(bins.values())) == 1
    return {name: "angle" if are_alike else f"{name}_angle" for name in bins}


@final
@dataclass(frozen=True)
class OutputStatistics:
    """Motion of the output point over the settled cycles of a stage.

    Attributes
    ----------
    displacement_max : float
        m.
    velocity_min, velocity_max : float
        m/s.
    acceleration_max : float
        m/s^2.
    displacement_max_per_cycle, velocity_max_per_cycle, acceleration_max_per_cycle : Estimate
        Mean over cycles of the largest value in each, m, m/s and m/s^2.
    """

    displacement_max: float
    velocity_min: float
    velocity_max: float
    acceleration_max: float
    displacement_max_per_cycle: Estimate
    velocity_max_per_cycle: Estimate
    acceleration_max_per_cycle: Estimate


@final
@dataclass(frozen=True)
class BottomStatistics:
    """Accuracy and repeatability at bottom dead centre over the settled strokes of a stage.

    Attributes
    ----------
    strokes : int
        Settled strokes of all replicates.
    ideal_height : float
        Bottom dead centre of the ideal motion, m.
    ideal_time : float
        Instant of it in the cycle, s.
    ideal_dwell : float
        Time for which the ideal motion stays there, s.
    height, error : Estimate
        Mean bottom dead centre, and its height over the ideal one, m.
    range_of_all : float
        Difference between the highest and the lowest bottom dead centre, m.
    range : Estimate or None
        Mean range of ``range_strokes`` successive strokes, m.
    range_strokes : int
    standard_deviation : Estimate or None
        Of the height from stroke to stroke, m.
    delay, delay_angle : Estimate or None
        Mean delay behind the ideal motion, s and rad; None where the ideal motion dwells.
    delay_standard_deviation : Estimate or None
        s.
    """

    strokes: int
    ideal_height: float
    ideal_time: float
    ideal_dwell: float
    height: Estimate
    error: Estimate
    range_of_all: float
    range: Estimate | None
    range_strokes: int
    standard_deviation: Estimate | None
    delay: Estimate | None = None
    delay_angle: Estimate | None = None
    delay_standard_deviation: Estimate | None = None


@final
@dataclass(frozen=True)
class WearPeak:
    """Deepest place of the wear map that one wear update adds.

    Attributes
    ----------
    depth : Estimate
        m.
    angle : Estimate
        rad; the ends of its interval may lie below 0 or above 2 pi.
    step_error : float or None
        Error of the depth by the step of the wear, m; part of the interval.
    """

    depth: Estimate
    angle: Estimate
    step_error: float | None = None


@final
@dataclass(frozen=True)
class JointStatistics:
    """Forces, contacts and wear of a clearance joint in a stage.

    Attributes
    ----------
    peak_force : float
        Largest normal force of the settled cycles, N.
    peak_force_per_cycle : Estimate
        Mean over cycles of the largest normal force in each, N.
    contacts, unresolved_contacts : int
        Contacts of all replicates, and those with too few steps.
    contacts_per_cycle : Estimate
    min_steps_per_contact : int or None
        None: no contact.
    contact_time_fraction : float
        Fraction of the time in contact.
    load_distance_per_cycle : Estimate
        Integral of normal force times sliding speed over a cycle, N m.
    wear_volume : Estimate
        Volume that one wear update takes off bearing and pin, m^3.
    wear_volume_step_error : float or None
        Error of it by the step of the wear, m^3; not part of the interval.
    wear_map_error : float or None
        Standard error of the wear map as a fraction of its root mean square.
    wear_depth_max_by_replicate : tuple of float
        Deepest place of one wear update in each replicate, m.
    wear_peaks : mapping of str to WearPeak
        By ``bearing``, ``pin`` and, where the maps do not turn, ``both``; empty where the noise
        of few cycles hides the deepest places.
    """

    peak_force: float
    peak_force_per_cycle: Estimate
    contacts: int
    contacts_per_cycle: Estimate
    unresolved_contacts: int
    min_steps_per_contact: int | None
    contact_time_fraction: float
    load_distance_per_cycle: Estimate
    wear_volume: Estimate
    wear_volume_step_error: float | None
    wear_map_error: float | None
    wear_depth_max_by_replicate: tuple[float, ...]
    wear_peaks: Mapping[str, WearPeak]


@final
@dataclass(frozen=True)
class StageStatistics:
    """Statistics of a stage; SI units.

    Of a stage whose numbers are not finite only the cycles are stored.

    Attributes
    ----------
    cycles : int
        Cycles of all replicates.
    energy_made_per_cycle, drive_work_per_cycle : Estimate or None
        Energy that the contacts made, and work of all drives, J.
    output : OutputStatistics or None
    bdc : BottomStatistics or None
        None where nothing moves or no stroke is whole.
    joints : mapping of str to JointStatistics
    wear_error : float or None
        Relative error of the wear.
    load_distance_step_error, peak_force_step_error : float or None
        Fraction by which finer time steps change them.
    energy_residual, energy_exchanged : float
        Energy that does not add up, and energy that the drives exchanged, J.
    energy_made_fraction : float
        Energy made by the contacts as a fraction of what contacts and friction dissipated.
    """

    cycles: int
    energy_made_per_cycle: Estimate | None = None
    drive_work_per_cycle: Estimate | None = None
    output: OutputStatistics | None = None
    bdc: BottomStatistics | None = None
    joints: Mapping[str, JointStatistics] = field(default_factory=dict)
    wear_error: float | None = None
    load_distance_step_error: float | None = None
    peak_force_step_error: float | None = None
    energy_residual: float = 0.0
    energy_exchanged: float = 0.0
    energy_made_fraction: float = 0.0


@dataclass(frozen=True)
class WearStep:
    """One step of a wear; its fields are the names in ``result.json``.

    Attributes
    ----------
    represented_cycles : float
        Cycles that the step stands for.
    cycles : int
        Cycles of the run that it multiplies.
    factor : float
        Their quotient.
    clearance_change : float
        Largest change of a profile, part of its clearance.
    max_depth : dict
        Deepest depth of all wears so far by joint, then ``bearing`` and ``pin``, m.
    peak_force : dict
        Peak normal force of the run by joint, N.
    wall_s : float
        Wall time of the run, s.
    """

    cycles_per_update: float
    cycles: int
    factor: float
    clearance_change: float
    max_depth: Mapping[str, Mapping[str, float]]
    peak_force: Mapping[str, float]
    wall_s: float


@dataclass(frozen=True)
class JointResult:
    """One clearance joint in a stage.

    Attributes
    ----------
    name : str
    stored : JointStatistics or None
        None where the stage failed before a cycle was complete.
    arrays : mapping
        All its arrays under their names in the file, without the joint's.
    """

    name: str
    stored: JointStatistics | None
    arrays: Mapping[str, Array]

    @property
    def statistics(self) -> JointStatistics:
        """Its statistics; InputError where the stage failed before a cycle was complete."""
        if self.stored is None:
            raise InputError(f"joint {self.name}: no cycle of the stage is complete")
        return self.stored

    @property
    def eccentricity(self) -> Array:
        """Pin centre less bearing centre, shape (n, 2), m."""
        return self._series("eccentricity")

    @property
    def penetration(self) -> Array:
        """Penetration of the pin, shape (n,), m; below zero while open."""
        return self._series("penetration")

    @property
    def force(self) -> Array:
        """Normal and tangential force, shape (n, 2), N."""
        return self._series("force")

    @property
    def sliding(self) -> Array:
        """Sliding speed at the contact, shape (n,), m/s."""
        return self._series("sliding")

    def _series(self, name: str) -> Array:
        if name not in self.arrays:
            raise InputError(f"joint {self.name}: its {name} was not kept; --set series=all does")
        return self.arrays[name]

    def contact(self, name: str) -> Array:
        """A number of each recorded contact, by a name of ``CONTACT_COLUMNS``, shape (k,); SI."""
        return self.arrays["contacts"][:, CONTACT_COLUMNS.index(name)]

    def each_cycle(self, name: str) -> Array:
        """A number of each cycle, by its name in ``CYCLE_JOINT``, shape (cycles,); SI units."""
        return self.arrays["cycles"][:, CYCLE_JOINT.index(name)]

    @property
    def angle(self) -> Array:
        """Angles of its wear maps, shape (m,), rad."""
        return bin_centres(self.arrays["depth_bearing"].size)

    def depth(self, side: str) -> Array:
        """Depth that the stage ran on, bearing or pin, shape (m,), m."""
        return self.arrays[f"depth_{side}"]

    def wear(self, side: str) -> Array:
        """Depth that the wear after the stage adds, bearing or pin, shape (m,), m."""
        return self.arrays[f"wear_{side}"]


@dataclass(frozen=True)
class StageResult:
    """One run of the outer loop, and the wear after it; the same in memory and on disk.

    Its fields are the names in ``result.json``, but for arrays, film and joints.

    Attributes
    ----------
    index : int
        0 unworn, 1 after the first wear, and so on.
    status : {"completed", "enough", "failed"}
        ``completed``, ``enough`` where its wear maps were known early, or ``failed``.
    message : str
        Why it failed, or nothing.
    finding : Finding or None
        Cause that ended the stage, or the wear after it; None where nothing did.
    amplification : float
        Multiplier of the depth of the cycles that the stage ran.
    wear_steps : tuple of WearStep
        How the wear after it was applied; empty after the last stage.
    simulated_s, wall_s : float
        Simulated time of all its starts, and the wall time that took, s.
    diagnostics : mapping
        Numbers and words of the solver, by name.
    statistics : StageStatistics
    arrays : mapping
        Arrays by their names in ``stage-K.npz``.
    joint_names : tuple of str
        Joints with clearance.
    read_film : callable
        Gives its film.
    """

    index: int
    status: Status
    message: str
    finding: Finding | None
    amplification: float
    wear_steps: tuple[WearStep, ...]
    simulated_s: float
    wall_s: float
    diagnostics: Mapping[str, str | int | float | None]
    statistics: StageStatistics
    arrays: Mapping[str, Array] = field(default_factory=dict)
    joint_names: tuple[str, ...] = ()
    read_film: Callable[[], Film] | None = None

    @property
    def name(self) -> str:
        """Name of the stage: ``no wear``, or ``initial surfaces``, ``first wear``, ..."""
        return stage_name(self.index, self.is_worn)

    @property
    def is_worn(self) -> bool:
        """True where any surface that it ran on had lost material."""
        return any(
            bool(np.any(self.arrays.get(f"{name}_depth_{side}", 0.0)))
            for name in self.joint_names
            for side in SIDES
        )

    @property
    def has_joint_series(self) -> bool:
        """True where series of its joints were kept."""
        return any(f"{name}_force" in self.arrays for name in self.joint_names)

    @property
    def surfaces(self) -> dict[str, tuple[Surface, Surface]]:
        """Bearing and pin by joint that it ran on, as a scene may begin on them.

        They are the mean of its starts, where each had surfaces of its own.
        """
        return {
            name: (
                Surface(self.arrays[f"{name}_depth_bearing"]),
                Surface(self.arrays[f"{name}_depth_pin"]),
            )
            for name in self.joint_names
        }

    @property
    def failed(self) -> bool:
        """True where the run of the stage failed, so that its numbers are worth nothing."""
        return self.status == "failed"

    @property
    def film(self) -> Film:
        """Frames of its first start; InputError where they are missing or damaged."""
        if self.read_film is None:
            raise InputError(f"{self.name}: no film was kept")
        return self.read_film()

    @property
    def cycles(self) -> int:
        """Cycles that ran, of all starts."""
        return self.statistics.cycles

    @property
    def output(self) -> OutputStatistics:
        """Statistics of the output point; InputError where no cycle is complete."""
        if self.statistics.output is None:
            raise InputError(f"{self.name}: no cycle is complete")
        return self.statistics.output

    @property
    def bdc(self) -> BottomStatistics:
        """Statistics of bottom dead centre; InputError where there is no settled stroke."""
        if self.statistics.bdc is None:
            raise InputError(f"{self.name}: there is no settled stroke")
        return self.statistics.bdc

    @property
    def time(self) -> Array:
        """Times of the recorded series, shape (n,), s."""
        return self.arrays["time"]

    @property
    def displacement(self) -> Array:
        """Displacement of what the scene watches, shape (n,), m."""
        return self.arrays["slider"][:, 0]

    @property
    def velocity(self) -> Array:
        """Velocity of what the scene watches, shape (n,), m/s."""
        return self.arrays["slider"][:, 1]

    @property
    def acceleration(self) -> Array:
        """Acceleration of what the scene watches, shape (n,), m/s^2."""
        return self.arrays["slider"][:, 2]

    @property
    def joints(self) -> dict[str, JointResult]:
        """Joints with clearance by name."""
        joints = {}
        for k, name in enumerate(self.joint_names):
            arrays = {
                key.removeprefix(f"{name}_"): array
                for key, array in self.arrays.items()
                if key.startswith(f"{name}_")
            }
            first = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k
            arrays["cycles"] = self.arrays["cycles"][:, first : first + len(CYCLE_JOINT)]
            joints[name] = JointResult(name, self.statistics.joints.get(name), arrays)
        return joints

    def section(self, name: str, joint: str = "") -> Array:
        """A number in the Poincare sections of the first start, shape (cycles, sections); SI.

        Parameters
        ----------
        name : str
            Of ``SECTION_NAMES``, or of ``SECTION_JOINT_NAMES`` where a joint is given.

        Raises
        ------
        InputError
            Where no sections were kept.
        """
        if "sections" not in self.arrays:
            raise InputError(f"{self.name}: no sections were kept; --set sections=1 keeps some")
        if not joint:
            return self.arrays["sections"][:, :, SECTION_NAMES.index(name)]
        first = len(SECTION_NAMES) + len(SECTION_JOINT_NAMES) * self.joint_names.index(joint)
        return self.arrays["sections"][:, :, first + SECTION_JOINT_NAMES.index(name)]

    def each_cycle(self, name: str) -> Array:
        """A number of each cycle, by its name in ``CYCLE_FIXED``, shape (cycles,); SI units."""
        return self.arrays["cycles"][:, CYCLE_FIXED.index(name)]

    @property
    def drive_cycles(self) -> Array:
        """Numbers of the drives in each cycle, shape (cycles, drives, columns CYCLE_DRIVE); SI."""
        first = len(CYCLE_FIXED) + len(CYCLE_JOINT) * len(self.joint_names)
        rows = self.arrays["cycles"][:, first:]
        return rows.reshape(len(rows), -1, len(CYCLE_DRIVE))

    def as_dict(self) -> dict[str, Any]:
        """Give everything but its arrays, film and joints, as ``result.json`` holds it."""
        plain = {item.name: getattr(self, item.name) for item in fields(self)}
        for name in ("arrays", "joint_names", "read_film"):
            del plain[name]
        plain["finding"] = asdict(self.finding) if self.finding else None
        plain["statistics"] = asdict(self.statistics)
        plain["wear_steps"] = [asdict(step) for step in self.wear_steps]
        return plain


MAX_ENTRY = 1e100  # of an array: a state that diverges is ended at 1e30
_SHAPES = {
    "time": "rows",
    "slider": "rows 3",
    "wear_batch_cycles": "batches",
    "cycle_start": "cycles",
    "deviation": "recorded 4",
    "deviation_start": "recorded",
}  # lengths of one name are the same throughout
_SERIES_SHAPES = dict(zip(JOINT_SERIES, ("rows 2", "rows", "rows 2", "rows"), strict=True))
_DEPTHS = ("depth_bearing", "depth_pin", "wear_bearing", "wear_pin")  # not negative
_MAP_SHAPES = dict.fromkeys(_DEPTHS, "bins") | {"wear_batches": "batches 2 bins"}


def check_arrays(
    arrays: Mapping[str, Array], joints: Mapping[str, int], drives: int, file: Path
) -> None:
    """Raise InputError naming the first array of a stage that is missing, misshapen or not finite.

    Parameters
    ----------
    joints : mapping of str to int
        Bins of the wear maps of the joints with clearance, by name.
    drives : int
        Number of drives.
    """
    for name, values in arrays.items():
        if not np.all(np.abs(values) <= MAX_ENTRY):
            raise InputError(
                f"{file}: {name} holds a value that is not finite, or beyond {MAX_ENTRY:g}"
            )
    shapes = {**_SHAPES, "cycles": f"cycles {cycle_columns(len(joints), drives)}"}
    if "drive_torque" in arrays:
        shapes["drive_torque"] = f"rows {drives}"
    if "sections" in arrays:
        width = len(SECTION_NAMES) + len(SECTION_JOINT_NAMES) * len(joints)
        shapes["sections"] = f"cycles_of_first sections {width}"
    for k, (joint, angle) in enumerate(angle_names(joints).items()):
        series = {f"{joint}_{name}": shape for name, shape in _SERIES_SHAPES.items()}
        shapes |= series if arrays.keys() & series.keys() else {}
        shapes[f"{joint}_flight"] = "recorded"
        bins = f"{joints[joint]}"
        shapes |= {f"{joint}_{name}": s.replace("bins", bins) for name, s in _MAP_SHAPES.items()}
        shapes[angle] = bins
        shapes[f"{joint}_contacts"] = f"contacts_{k} {len(CONTACT_COLUMNS)}"
    lengths: dict[str, int] = {}
    for name, shape in shapes.items():
        if name not in arrays:
            raise InputError(f"{file}: the array {name} is missing")
        values, words = arrays[name], shape.split()
        if values.ndim == len(words):
            for length, word in zip(values.shape, words, strict=True):
                lengths.setdefault(word, int(word) if word.isdigit() else length)
        wanted = tuple(lengths.get(word, word) for word in words)
        if values.shape != wanted:
            text = ", ".join(map(str, wanted))
            raise InputError(f"{file}: {name} has the shape {values.shape}; ({text}) is expected")
        if name == "time" and values.size and (values[0] < 0.0 or np.any(np.diff(values) < 0.0)):
            raise InputError(f"{file}: time goes backwards")
        if name.endswith("angle") and not np.allclose(values, bin_centres(values.size), 0.0, 1e-9):
            raise InputError(
                f"{file}: {name} does not hold the middles of {values.size} bins of a turn"
            )
        if name.endswith(_DEPTHS) and np.any(values < 0.0):
            raise InputError(f"{file}: {name} holds a depth below zero")
