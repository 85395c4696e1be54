"""Numbers of a stage, ready for ``result.json``.

Peaks of a whole run are one draw of a chaotic motion; beside them stand means over cycles
and the intervals of ``sampling``.  Cycles at the start are in none of them, where enough
others ran.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import bin_centres
from presswear.physics.wear import worn_volume
from presswear.recording.recorder import Recorder
from presswear.recording.sampling import (
    Interval,
    after_startup,
    half_width,
    map_errors,
    peak_of,
    pooled,
    resampled,
    widened,
)

Array = NDArray[np.float64]
Recorders = Sequence[Recorder]


def ends(interval: Interval, factor: float = 1.0) -> list[float] | None:
    """Both ends of an interval in another unit; None where it has none."""
    if interval.low is None or interval.high is None:
        return None
    return [factor * interval.low, factor * interval.high]


@dataclass(frozen=True)
class Wear:
    """The depth that one wear adds, and how well it is known.

    Attributes
    ----------
    added : ndarray, shape (joints, 2, m)
        Of bearing and pin, m.
    maps : ndarray, shape (n, joints, 2, m)
        Draws of it, by batches of cycles or by starts, m; none: no intervals.
    weights : ndarray, shape (n,)
        Cycles in each.
    coarser : ndarray or None
        The same in half as many steps; its difference is the error of the step.
    by_start : ndarray, shape (starts, joints, 2, m)
        The same by each start alone, m.
    is_frozen : bool
        True where a wear that goes cycle by cycle would answer to surfaces that stood still
        here: the noise of few cycles hides its deepest places.
    """

    added: Array
    maps: Array
    weights: Array
    coarser: Array | None
    by_start: Array
    is_frozen: bool

    def at(self, k: int, bins: int) -> "Wear":
        """The same of joint ``k`` alone, with its own bins: arrays without the axis of joints."""
        return replace(
            self,
            added=self.added[k, :, :bins],
            maps=self.maps[:, k, :, :bins],
            coarser=None if self.coarser is None else self.coarser[k, :, :bins],
            by_start=self.by_start[:, k, :, :bins],
        )


def joint_statistics(
    joint: ClearanceJoint, k: int, recorders: Recorders, alone: Recorders, wear: Wear
) -> dict[str, Any]:
    """Numbers of one clearance joint; see ``stage_statistics``."""
    wear = wear.at(k, joint.bins)
    added, maps, weights = wear.added, wear.maps, wear.weights
    mean, volume = mean_of(recorders, alone), worn_volume(joint, added)
    force = [recorder.each_cycle("force_max", k) for recorder in recorders]
    tallies = np.array([recorder.book.tally[k] for recorder in recorders])
    contacts = int(tallies["contacts"].sum())
    fewest = int(tallies["fewest_steps"].min()) if contacts else None
    time = sum(recorder.last_time for recorder in recorders)
    numbers: dict[str, Any] = {
        "force_max_N": float(max(after_startup(own).max() for own in force)),
        "force_max_per_cycle_N": mean(lambda own: own.each_cycle("force_max", k)),
        "contacts": contacts,
        "contacts_per_cycle": mean(lambda own: own.each_cycle("contacts", k)),
        "unresolved_contacts": int(tallies["unresolved"].sum()),
        "fewest_steps_in_a_contact": fewest,
        "part_of_time_in_contact": float(tallies["closed_time"].sum()) / time,
        "dose_per_cycle_Nm": mean(lambda own: own.each_cycle("load_distance", k)),
        "wear_volume_m3": volume,
        "wear_volume_half_width_m3": None,
        "wear_map_error": float(map_errors(maps[:, np.newaxis], weights)[0]),
    }
    if len(maps) > 1:
        volumes = np.array([worn_volume(joint, own) for own in maps])
        off = volume - float(np.average(volumes, weights=weights))
        numbers["wear_volume_half_width_m3"] = math.hypot(half_width(volumes) or 0.0, off)
    each = wear.by_start.max(axis=(1, 2))
    numbers["wear_depth_max_by_start_m"] = [float(depth) for depth in each]
    if wear.coarser is not None:
        numbers["wear_volume_step_m3"] = abs(worn_volume(joint, wear.coarser) - volume)
    if wear.is_frozen:
        return numbers
    sides: dict[str, list[int]] = {"bearing": [0], "pin": [1]}
    if joint.map_frame == "fixed":
        sides["both"] = [0, 1]
    degrees = np.degrees(bin_centres(added.shape[1]))
    for name, some in sides.items():
        depth = added[some].sum(axis=0)
        numbers[f"wear_depth_max_{name}_m"] = float(depth.max())
        numbers[f"wear_depth_max_{name}_deg"] = float(degrees[int(depth.argmax())])
        step = 0.0
        if wear.coarser is not None:
            step = abs(float(depth.max() - wear.coarser[some].sum(axis=0).max()))
            numbers[f"wear_depth_max_{name}_step_m"] = step
        if len(maps):
            drawn = maps[:, some].sum(axis=1)
            draws = resampled(drawn, weights)
            peak = peak_of(depth, draws, len(maps), np.average(drawn, axis=0, weights=weights))
            numbers[f"wear_depth_max_{name}_interval_m"] = ends(widened(peak.depth, step))
            numbers[f"wear_depth_max_{name}_interval_deg"] = ends(peak.angle, np.degrees(1.0))
    return numbers


def mean_of(recorders: Recorders, alone: Recorders) -> Callable[..., dict[str, Any]]:
    """What gives the mean of something that recorders have of each cycle, with its interval.

    Parameters
    ----------
    recorders, alone : sequence of Recorder
        As in ``stage_statistics``.
    """

    def mean(each: Callable[[Recorder], Array]) -> dict[str, Any]:
        return asdict(pooled([each(own) for own in recorders], [each(own) for own in alone])[0])

    return mean


def stage_statistics(
    linkage: Linkage, recorders: Recorders, wear: Wear, alone: Recorders = ()
) -> dict[str, Any]:
    """Numbers of one stage.

    Parameters
    ----------
    recorders : sequence of Recorder
        Of each start.
    alone : sequence of Recorder
        Of each start on surfaces of its own, where the runs are the samples, not their cycles;
        they may be the same.
    """
    ran, alone = ([own for own in some if len(own.cycles)] for some in (recorders, alone))
    if not ran:
        return {"cycles": 0}
    mean = mean_of(ran, alone)
    displacement, slowest, fastest, acceleration = (
        [recorder.each_cycle(name) for recorder in ran]
        for name in ("displacement_max", "velocity_min", "velocity_max", "acceleration_max")
    )
    return {
        "cycles": sum(len(own) for own in displacement),
        "energy_made_per_cycle_J": mean(lambda own: own.each_cycle("contact_made")),
        "drive_work_per_cycle_J": mean(lambda own: own.each_cycle("drive_work")),
        "slider": {
            "displacement_max_m": float(max(after_startup(own).max() for own in displacement)),
            "velocity_min_m_s": float(min(after_startup(own).min() for own in slowest)),
            "velocity_max_m_s": float(max(after_startup(own).max() for own in fastest)),
            "acceleration_max_m_s2": float(max(after_startup(own).max() for own in acceleration)),
            "displacement_max_per_cycle_m": mean(lambda own: own.each_cycle("displacement_max")),
            "velocity_max_per_cycle_m_s": mean(lambda own: own.each_cycle("velocity_max")),
            "acceleration_max_per_cycle_m_s2": mean(lambda own: own.each_cycle("acceleration_max")),
        },
        "joints": {
            joint.name: joint_statistics(joint, k, ran, alone, wear)
            for k, joint in enumerate(linkage.clearances)
        },
    }
