"""Statistics of a stage: peaks, means over cycles with their intervals, and wear.

The largest value of a run is one sample of a chaotic motion; means over cycles stand beside it.
The start-up cycles are left out, where enough more ran.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import bin_centres
from presswear.physics.wear import worn_volume
from presswear.recording.recorder import Recorder
from presswear.recording.statistics import (
    Estimate,
    after_startup,
    half_width,
    map_errors,
    peak_of,
    pooled,
    resampled,
    widened,
)
from presswear.results.stage import JointStatistics, OutputStatistics, StageStatistics, WearPeak

Array = NDArray[np.float64]
Recorders = Sequence[Recorder]


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
) -> JointStatistics:
    """Return the statistics of one clearance joint; see ``stage_statistics``."""
    wear = wear.at(k, joint.bins)
    added, maps, weights, coarser = wear.added, wear.maps, wear.weights, wear.coarser
    mean, volume = mean_of(recorders, alone), worn_volume(joint, added)
    force = [recorder.each_cycle("force_max", k) for recorder in recorders]
    tallies = np.array([recorder.book.tally[k] for recorder in recorders])
    contacts = int(tallies["contacts"].sum())
    time = sum(recorder.last_time for recorder in recorders)
    half = None
    if len(maps) > 1:
        volumes = np.array([worn_volume(joint, depth) for depth in maps])
        off = volume - float(np.average(volumes, weights=weights))
        half = math.hypot(half_width(volumes) or 0.0, off)
    error = float(map_errors(maps[:, np.newaxis], weights)[0])
    return JointStatistics(
        peak_force=float(max(after_startup(peaks).max() for peaks in force)),
        peak_force_per_cycle=mean(lambda run: run.each_cycle("force_max", k)),
        contacts=contacts,
        contacts_per_cycle=mean(lambda run: run.each_cycle("contacts", k)),
        unresolved_contacts=int(tallies["unresolved"].sum()),
        min_steps_per_contact=int(tallies["fewest_steps"].min()) if contacts else None,
        contact_time_fraction=float(tallies["closed_time"].sum()) / time,
        load_distance_per_cycle=mean(lambda run: run.each_cycle("load_distance", k)),
        wear_volume=Estimate.symmetric(volume, half, len(maps)),
        wear_volume_step_error=(
            None if coarser is None else abs(worn_volume(joint, coarser) - volume)
        ),
        wear_map_error=error if math.isfinite(error) else None,
        wear_depth_max_by_replicate=tuple(wear.by_start.max(axis=(1, 2)).tolist()),
        wear_peaks={} if wear.is_frozen else _wear_peaks(joint, wear),
    )


def _wear_peaks(joint: ClearanceJoint, wear: Wear) -> dict[str, WearPeak]:
    """Return the deepest places of the wear map of one joint by side."""
    sides: dict[str, list[int]] = {"bearing": [0], "pin": [1]}
    if joint.map_frame == "fixed":
        sides["both"] = [0, 1]
    angles = bin_centres(wear.added.shape[1])
    peaks = {}
    for name, rows in sides.items():
        depth = wear.added[rows].sum(axis=0)
        deepest = float(depth.max())
        error = None
        if wear.coarser is not None:
            error = abs(float(deepest - wear.coarser[rows].sum(axis=0).max()))
        estimates = Estimate(deepest), Estimate(float(angles[int(depth.argmax())]))
        if len(wear.maps):
            drawn = wear.maps[:, rows].sum(axis=1)
            draws = resampled(drawn, wear.weights)
            centre = np.average(drawn, axis=0, weights=wear.weights)
            peak = peak_of(depth, draws, len(wear.maps), centre)
            estimates = widened(peak.depth, error or 0.0), peak.angle
        peaks[name] = WearPeak(*estimates, error)
    return peaks


def mean_of(
    recorders: Recorders, alone: Recorders
) -> Callable[[Callable[[Recorder], Array]], Estimate]:
    """Return a function that estimates the mean of a quantity that recorders have of each cycle.

    Parameters
    ----------
    recorders, alone : sequence of Recorder
        As in ``stage_statistics``.
    """

    def mean(each: Callable[[Recorder], Array]) -> Estimate:
        return pooled([each(run) for run in recorders], [each(run) for run in alone])[0]

    return mean


def stage_statistics(
    linkage: Linkage, recorders: Recorders, wear: Wear, alone: Recorders = ()
) -> StageStatistics:
    """Return the statistics of one stage that its recorders and its wear give.

    Parameters
    ----------
    recorders : sequence of Recorder
        One for each replicate.
    alone : sequence of Recorder
        One for each replicate on surfaces of its own, where the runs are the samples, not their
        cycles; they may be the same.
    """
    ran, alone = ([run for run in runs if len(run.cycles)] for runs in (recorders, alone))
    if not ran:
        return StageStatistics(cycles=0)
    mean = mean_of(ran, alone)
    displacement, slowest, fastest, acceleration = (
        [after_startup(recorder.each_cycle(name)) for recorder in ran]
        for name in ("displacement_max", "velocity_min", "velocity_max", "acceleration_max")
    )
    return StageStatistics(
        cycles=sum(len(run.cycles) for run in ran),
        energy_made_per_cycle=mean(lambda run: run.each_cycle("contact_made")),
        drive_work_per_cycle=mean(lambda run: run.each_cycle("drive_work")),
        output=OutputStatistics(
            displacement_max=float(max(values.max() for values in displacement)),
            velocity_min=float(min(values.min() for values in slowest)),
            velocity_max=float(max(values.max() for values in fastest)),
            acceleration_max=float(max(values.max() for values in acceleration)),
            displacement_max_per_cycle=mean(lambda run: run.each_cycle("displacement_max")),
            velocity_max_per_cycle=mean(lambda run: run.each_cycle("velocity_max")),
            acceleration_max_per_cycle=mean(lambda run: run.each_cycle("acceleration_max")),
        ),
        joints={
            joint.name: joint_statistics(joint, k, ran, alone, wear)
            for k, joint in enumerate(linkage.clearances)
        },
    )
