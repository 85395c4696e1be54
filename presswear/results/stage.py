"""One stage of a result: what ran, what it observed, and the wear after it."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

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
)
from presswear.recording.soundness import Finding
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
    largest_change_of_clearance : float
        Largest change of a profile, part of its clearance.
    deepest_m : dict
        Deepest depth of all wears so far by joint, then ``bearing`` and ``pin``, m.
    force_max_N : dict
        Peak normal force of the run by joint, N.
    wall_s : float
        Wall time of the run, s.
    """

    cycles_per_update: float
    cycles: int
    factor: float
    largest_change_of_clearance: float
    deepest_m: Mapping[str, Mapping[str, float]]
    force_max_N: Mapping[str, float]  # noqa: N815 - N is the unit
    wall_s: float


@dataclass(frozen=True)
class JointResult:
    """One clearance joint in a stage.

    Attributes
    ----------
    name : str
    statistics : mapping
        Numbers of the joint over the stage, by name; SI units.
    arrays : mapping
        All its arrays under their names in the file, without the joint's.
    """

    name: str
    statistics: Mapping[str, Any]
    arrays: Mapping[str, Array]

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
    statistics : mapping
        Numbers of the stage by name; SI units.
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
    statistics: Mapping[str, Any]
    arrays: Mapping[str, Array] = field(default_factory=dict)
    joint_names: tuple[str, ...] = ()
    read_film: Callable[[], Film] | None = None

    @property
    def name(self) -> str:
        """Name of the stage: ``no wear``, or ``given surfaces``, ``first wear``, ..."""
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
        return int(self.statistics["cycles"])

    @property
    def bdc(self) -> Mapping[str, Any]:
        """Numbers of bottom dead centre, the watched coordinate's lowest place in a stroke.

        SI units, by name; none where nothing moves or no stroke is whole.
        """
        return self.statistics.get("bdc", {})

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
        told = self.statistics.get("joints", {})
        found = {}
        for k, name in enumerate(self.joint_names):
            own = {
                key.removeprefix(f"{name}_"): array
                for key, array in self.arrays.items()
                if key.startswith(f"{name}_")
            }
            first = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k
            own["cycles"] = self.arrays["cycles"][:, first : first + len(CYCLE_JOINT)]
            found[name] = JointResult(name, told.get(name, {}), own)
        return found

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
        told = {item.name: getattr(self, item.name) for item in fields(self)}
        for name in ("arrays", "joint_names", "read_film"):
            del told[name]
        told["finding"] = asdict(self.finding) if self.finding else None
        told["wear_steps"] = [asdict(step) for step in self.wear_steps]
        return told
