"""Quantities of the paper from the results of our runs, each with its interval."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

import presswear as pw
from presswear.linkage.surface import SIDES
from presswear.paper.printed import Place
from presswear.paper.settings import TABLES, run_name
from presswear.show.page import Row
from presswear.tools.arrays import Array

Ends = tuple[float, float]

# depth from which a place counts as worn, relative to the deepest of its surface
MIN_DEPTH = 0.05
MIN_SAMPLES = 3  # cycles for a range of single cycles
# columns of `deviation`
DEVIATIONS = ("displacement_off", "velocity_off", "lag", "stroke")

QUANTITIES = {
    name: Row(label, path, unit, digits=digits)
    for name, (label, path, unit, digits) in TABLES["quantities"].items()
}
# Quantities of the last wear update; the other quantities add up all wear updates
OF_ONE_WEAR = ("added_depth", "added_mean", "contact_range")


def _range_of(maps: Array) -> Any:
    """Return the angle over which maps, (..., surfaces, m), are worn, mean of surfaces, rad."""
    is_worn = maps >= MIN_DEPTH * maps.max(axis=-1, keepdims=True)
    return 2.0 * math.pi * is_worn.mean(axis=(-2, -1))


# Functionals of wear maps, shape (..., surfaces, m). Maps over directions in space are
# the sum of both surfaces, so that ``surfaces`` is 1. It is 2 for maps on the bodies.
_FUNCTIONALS: dict[str, Callable[[Array], Any]] = {
    "deepest": lambda maps: maps.max(axis=-1).sum(axis=-1),
    "mean": lambda maps: maps.mean(axis=-1).sum(axis=-1),
    "deviation": lambda maps: maps.std(axis=-1).sum(axis=-1),
    "range": _range_of,
}
OF_MAPS = {
    name for name, row in QUANTITIES.items() if row.path in (*_FUNCTIONALS, "angle")
}


@dataclass(frozen=True)
class Measured:
    """Quantity from our runs; SI units and rad."""

    estimate: pw.statistics.Estimate  # for a peak, the mean over cycles
    single_cycles: Ends | None = None  # range that holds 95 % of the single cycles
    # range of the first cycles, which are not among the samples
    first_cycles: Ends | None = None
    replicates: int = 0
    # True if replicates differ by more than the scatter of their cycles explains
    differ: bool = False
    freedom: float = math.inf  # degrees of freedom of the interval


class WearMap(NamedTuple):
    """Depth of both surfaces of a joint, m, with its pointwise 95 % interval, shape (m,)."""

    angle: Array  # rad
    mean: Array  # depth of the bearing alone where maps turn with the bodies
    low: Array
    high: Array


def cycles_by_replicate(result: pw.Result, place: Place, quantity: str) -> list[Array]:
    """Return the values of every cycle for each replicate; the runs on common surfaces first."""
    stage = result.stages[place.wear_updates]
    name = QUANTITIES[quantity].path
    replicate = stage.arrays["cycle_start"]
    if name in DEVIATIONS:
        values = stage.arrays["deviation"][:, DEVIATIONS.index(name)]
        replicate = stage.arrays["deviation_start"]
    elif name == "flight":
        values = stage.joints[place.joint].arrays[name]
        replicate = stage.arrays["deviation_start"]
    elif place.joint:
        values = stage.joints[place.joint].each_cycle(name)
    else:
        values = stage.each_cycle(name)
    if quantity == "contact_rate":
        values = values / result.scene.mechanism.period
    return [values[replicate == index] for index in np.unique(replicate)]


@dataclass(frozen=True, eq=False)
class Evidence:
    """Results of the study by the names of their folders."""

    results: Mapping[str, pw.Result]

    def run_at(
        self, case: str, setting: str, stage: int, joint: str = ""
    ) -> pw.Result | None:
        """Return the run of a case if it completed a stage, with clearance at the joint."""
        result = self.results.get(run_name(case, setting))
        if result is None or not 0 <= stage < len(result.stages):
            return None
        has_joint = not joint or joint in result.scene.clearance_joints
        if result.stages[stage].failed or not has_joint:
            return None
        return result

    def worn_run(self, case: str, place: Place) -> pw.Result | None:
        """Return the run of a case if it completed the stage before the last wear update."""
        return self.run_at(case, place.setting, place.wear_updates - 1, place.joint)

    def measured(self, case: str, place: Place, quantity: str) -> Measured | None:
        """Return a quantity under a case from all its replicates; None if it was not computed."""
        if quantity in OF_MAPS:
            stages = _stages_added(place, quantity)
            return _from_maps(self, case, place, stages)[quantity]
        result = self.run_at(case, place.setting, place.wear_updates, place.joint)
        if result is None:
            return None
        by_replicate = cycles_by_replicate(result, place, quantity)
        count = result.scene.replicate_count
        # After a wear update each replicate also runs on its surfaces, which gives the
        # interval.
        on_common_surfaces = by_replicate[:count]
        on_its_surfaces = by_replicate[-count:] if place.wear_updates > 0 else ()
        estimate, differ = pw.statistics.pooled(on_common_surfaces, on_its_surfaces)
        first = [float(rows[0]) for rows in on_common_surfaces]
        series = [pw.statistics.after_startup(rows) for rows in on_common_surfaces]
        samples = np.concatenate(series)
        single_cycles = None
        if samples.size >= MIN_SAMPLES:
            low, high = np.quantile(samples, (0.025, 0.975)).tolist()
            single_cycles = low, high
        independent = float(len(series))
        if not differ:
            independent = samples.size / pw.statistics.inefficiency(series)
        return Measured(
            estimate,
            single_cycles=single_cycles,
            first_cycles=(min(first), max(first)),
            replicates=len(series),
            differ=differ,
            freedom=max(independent - 1.0, 1.0),
        )

    def estimate(
        self, case: str, place: Place, quantity: str
    ) -> pw.statistics.Estimate | None:
        """Return the estimate of a quantity under a case; None if it was not computed."""
        measured = self.measured(case, place, quantity)
        return None if measured is None else measured.estimate

    def wear_map(self, case: str, place: Place) -> WearMap | None:
        """Return the depth after some wear updates, bearing and pin together."""
        result = self.worn_run(case, place)
        if result is None:
            return None
        stages = range(place.wear_updates)
        means, centres, draws, count = _wear_draws(result, place.joint, stages)
        mean = means[0]
        centre = centres[0]
        low, high = pw.statistics.pointwise_interval(centre, draws[:, 0], count)
        below = np.hypot(low - centre, mean - centre)
        above = np.hypot(high - centre, mean - centre)
        angle = result.stages[0].joints[place.joint].angle
        return WearMap(angle, mean, np.maximum(mean - below, 0.0), mean + above)


def _stages_added(place: Place, quantity: str) -> range:
    """Return the stages whose wear is added up for a quantity of maps."""
    first = place.wear_updates - 1 if quantity in OF_ONE_WEAR else 0
    return range(first, place.wear_updates)


@cache
def _from_maps(
    evidence: Evidence, case: str, place: Place, stages: range
) -> dict[str, Measured | None]:
    """Return all quantities of the wear of some stages at once, because resampling is slow."""
    names = [name for name in OF_MAPS if _stages_added(place, name) == stages]
    result = evidence.worn_run(case, place)
    if result is None:
        return dict.fromkeys(names)
    # The wear after the last stage is extrapolated in one step, also in a scene that wears
    # in several steps.
    is_after_last = place.wear_updates > result.scene.wear_updates
    if result.scene.wears_in_steps and is_after_last:
        return dict.fromkeys(names)
    mean, centre, draws, count = _wear_draws(result, place.joint, stages)
    last = Place(place.setting, place.wear_updates - 1, place.joint)
    by_replicate = cycles_by_replicate(result, last, "load_distance")
    rows = by_replicate[: result.scene.replicate_count]
    cycles = sum(pw.statistics.after_startup(row).size for row in rows)

    def measured(name: str) -> Measured | None:
        if name == "angle":
            if len(mean) > 1:
                return None  # maps on two bodies have no common angle
            estimate = pw.statistics.peak_of(mean[0], draws[:, 0], count)[1]
        else:
            functional = _FUNCTIONALS[QUANTITIES[name].path]
            value = float(functional(centre))
            interval = pw.statistics.basic_interval(value, functional(draws), count)
            estimate = pw.statistics.about(float(functional(mean)), interval)
        freedom = max(count - 1.0, 1.0)
        estimate = replace(estimate, samples=cycles)
        return Measured(estimate, replicates=len(rows), freedom=freedom)

    return {name: measured(name) for name in names}


def _wear_draws(
    result: pw.Result, joint: str, stages: range
) -> tuple[Array, Array, Array, int]:
    """Return the wear of some stages together, m, as mean, centre, draws and a count.

    The mean is the wear itself. The centre is the mean of the maps from which the
    bootstrap draws are taken. Both have the shape (surfaces, m), the draws the shape
    (draws, surfaces, m). The count is the smallest number of maps of a stage.
    """
    has_maps_on_bodies = result.scene.conventions.map_frame == "body"
    means = []
    centres = []
    draws = []
    counts = []
    for seed, stage in enumerate(stages):
        arrays = result.stages[stage].arrays
        maps = arrays[f"{joint}_wear_batches"]
        weights = arrays["wear_batch_cycles"]
        wear = np.stack([arrays[f"{joint}_wear_{side}"] for side in SIDES])
        if not len(maps):
            # There are too few cycles for batches.
            maps = wear[np.newaxis]
            weights = np.ones(1)
        if not has_maps_on_bodies:
            wear = wear.sum(axis=0, keepdims=True)
            maps = maps.sum(axis=1, keepdims=True)
        flat = pw.statistics.resampled(maps.reshape(len(maps), -1), weights, seed)
        means.append(wear)
        centres.append(np.tensordot(weights / weights.sum(), maps, 1))
        draws.append(flat.reshape(-1, *wear.shape))
        counts.append(len(maps))
    mean, centre, draw = (np.sum(maps, axis=0) for maps in (means, centres, draws))
    return mean, centre, draw, min(counts)
