"""Quantities of the paper as our runs have them: value, interval, scatter of single cycles."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.deviation import COLUMNS
from presswear.paper.printed import Place
from presswear.paper.variants import variant_key
from presswear.recording.statistics import (
    LEAST_SAMPLES,
    about,
    after_startup,
    basic_interval,
    map_errors,
    peak_of,
    pointwise_interval,
    pooled,
    resampled,
)
from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult

Array = NDArray[np.float64]
Ends = tuple[float, float]

RANGE_DEPTH = 0.05
"""Depth from which on a place is worn, part of the deepest of its surface."""


@dataclass(frozen=True)
class Measured:
    """A quantity as our runs have it, or a ratio or difference of some, SI units and rad.

    Attributes
    ----------
    value : float
        For a peak, the mean over cycles.
    ends : (float, float) or None
        Its 95 % interval; None where there are too few samples.
    draws : (float, float) or None
        Range that holds 95 % of single cycles, for what is read from one.
    first : (float, float) or None
        Range of the first cycles of all starts, which are not among the samples.
    samples, starts : int
        Cycles and starts that it is from.
    differ : bool
        True where the starts differ by more than their cycles explain.
    """

    value: float
    ends: Ends | None
    draws: Ends | None = None
    first: Ends | None = None
    samples: int = 0
    replicates: int = 0
    differ: bool = False


@dataclass(frozen=True)
class WearMap:
    """Depth of both surfaces of a joint together, pooled over the starts, m.

    Maps that turn with their bodies have no common angle: the bearing's stands alone.

    Attributes
    ----------
    angle : ndarray, shape (m,)
        rad.
    mean, low, high : ndarray, shape (m,)
        With the ends of the pointwise 95 % interval.
    """

    angle: Array
    mean: Array
    low: Array
    high: Array


CYCLES: Mapping[str, str] = {
    "displacement": "displacement_max",
    "velocity": "velocity_max",
    "acceleration": "acceleration_max",
    "force": "force_max",
    "contact_rate": "contacts",
    "load_distance": "load_distance",
    "flight": "flight",
    **{name: name for name in COLUMNS},
}
"""Quantities of which every cycle is a sample, and what a stage keeps of its cycles for them."""


def each_cycle(stage: StageResult, joint: str, name: str) -> Array:
    """Values of all cycles of a stage, of a joint or, without one, of the slider."""
    return stage.joints[joint].each_cycle(name) if joint else stage.each_cycle(name)


def _samples(result: Result, place: Place, quantity: str) -> list[Array]:
    """One number a cycle, by start, and behind the starts of the first set those of the other."""
    stage, name = result.stages[place.wear_updates], CYCLES[quantity]
    if name in COLUMNS:
        values = stage.arrays["deviation"][:, COLUMNS.index(name)]
    elif name == "flight":
        values = stage.joints[place.joint].arrays[name]
    else:
        values = each_cycle(stage, place.joint, name)
    is_recorded = name in (*COLUMNS, "flight")
    start = stage.arrays["deviation_start" if is_recorded else "cycle_start"]
    rows = [values[start == index] for index in np.unique(start)]
    if quantity == "contact_rate":
        rows = [own / result.scene.mechanism.period for own in rows]
    return rows


# A map is given as its surfaces, shape (..., surfaces, m): one, both added up, where angles are
# directions in space; two where they are on the bodies.


_Functional = Callable[[Array], Array]


def _summed(of_surface: Callable[..., Array]) -> _Functional:
    """Add up what surfaces have over their angles."""
    return lambda maps: np.asarray(of_surface(maps, axis=-1).sum(axis=-1))


def _range(maps: Array) -> Array:
    """Angle over which a surface is worn, rad."""
    worn = maps >= RANGE_DEPTH * maps.max(axis=-1, keepdims=True)
    return np.asarray(2.0 * math.pi * worn.mean(axis=(-2, -1)))


_MAPS: Mapping[str, _Functional] = {
    "depth": _summed(np.max),
    "range": _range,
    "unevenness": _summed(np.std),
    "mean_depth": _summed(np.mean),
    "added_depth": _summed(np.max),
    "added_mean": _summed(np.mean),
    "contact_range": _range,
}
"""Quantities of the wear map of both surfaces together, but the angle of its deepest place."""

_LAST = ("added_depth", "added_mean", "contact_range")
"""Quantities of the last wear alone; for the others all wears so far are added up."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """The results of a study, by the keys of its variants."""

    results: Mapping[str, Result]
    _known: dict[tuple[str, Place, str], Measured | None] = field(default_factory=dict)

    def at_stage(self, case: str, setting: str, stage: int, joint: str = "") -> Result | None:
        """The run of a case, where it ran a stage to its end with clearance at a joint, if any."""
        result = self.results.get(variant_key(case, setting))
        if result is None or not 0 <= stage < len(result.stages) or result.stages[stage].failed:
            return None
        # A person may have closed a joint in all runs.
        return result if not joint or joint in result.scene.clearance_joints else None

    def worn_at(self, case: str, place: Place) -> Result | None:
        """The run of a case whose stage gave a place its last wear."""
        return self.at_stage(case, place.setting, place.wear_updates - 1, place.joint)

    def measured(self, case: str, place: Place, quantity: str) -> Measured | None:
        """A quantity under a case, pooled over its starts; None where nothing says it."""
        key = (case, place, quantity)
        if key not in self._known:
            is_of_cycles = quantity in CYCLES
            stage = place.wear_updates if is_of_cycles else place.wear_updates - 1
            result = self.at_stage(case, place.setting, stage, place.joint)
            if result is None:
                self._known[key] = None
            elif is_of_cycles:
                self._known[key] = _of_cycles(result, place, quantity)
            else:
                found = _of_maps(result, place, _added(place, quantity))
                self._known.update({(case, place, name): own for name, own in found.items()})
        return self._known[key]

    def wear_map(self, case: str, place: Place) -> WearMap | None:
        """Depth after some wears, bearing and pin together, with its pointwise interval."""
        result = self.worn_at(case, place)
        if result is None:
            return None
        wear = _drawn(result, place.joint, range(place.wear_updates))
        mean, centre = wear.mean[0], wear.centre[0]
        low, high = pointwise_interval(centre, wear.draws[:, 0], wear.count)
        low, high = (
            mean + side * np.hypot(end - centre, mean - centre)
            for side, end in ((-1.0, low), (1.0, high))
        )
        return WearMap(result.stages[0].joints[place.joint].angle, mean, np.maximum(low, 0.0), high)

    def map_error(self, case: str, place: Place) -> float | None:
        """Standard error of the map of the last wear at a place, part of its rms."""
        result = self.worn_at(case, place)
        if result is None:
            return None
        arrays = result.stages[place.wear_updates - 1].arrays
        maps = arrays[f"{place.joint}_wear_batches"][:, np.newaxis]
        error = float(map_errors(maps, arrays["wear_batch_cycles"])[0])
        return error if math.isfinite(error) else None


def _of_cycles(result: Result, place: Place, quantity: str) -> Measured | None:
    rows = _samples(result, place, quantity)
    if not rows:
        return None
    draws_of = result.scene.draws
    # Behind a wear each start runs on surfaces of its own.
    alone = rows[-draws_of:] if place.wear_updates > 0 else ()
    rows = rows[:draws_of]
    estimate, apart = pooled(rows, alone)
    mean, half = estimate.mean, estimate.half_width
    samples = np.concatenate([after_startup(own) for own in rows])
    draws = None
    if samples.size >= LEAST_SAMPLES:
        low, high = np.quantile(samples, (0.025, 0.975))
        draws = (float(low), float(high))
    begun = [float(own[0]) for own in rows]
    return Measured(
        mean,
        None if half is None else (mean - half, mean + half),
        draws,
        (min(begun), max(begun)),
        estimate.samples,
        len(rows),
        apart,
    )


def _added(place: Place, quantity: str) -> range:
    """The stages whose wears are added up for a quantity of maps."""
    return range(place.wear_updates - 1 if quantity in _LAST else 0, place.wear_updates)


def _of_maps(result: Result, place: Place, stages: range) -> dict[str, Measured | None]:
    """All quantities for which the wears of some stages are added up: to draw them is dear."""
    names = [own for own in (*_MAPS, "angle") if _added(place, own) == stages]
    # The wear that the last stage would cause is a single jump, no measure of one in steps.
    if result.scene.wears_in_steps and place.wear_updates > result.scene.wear_updates:
        return dict.fromkeys(names)
    wear = _drawn(result, place.joint, stages)
    rows = _samples(
        result, Place(place.setting, place.wear_updates - 1, place.joint), "load_distance"
    )
    rows = rows[: result.scene.draws]
    cycles = sum(after_startup(own).size for own in rows)

    def measured(quantity: str) -> Measured | None:
        if quantity in _MAPS:
            functional = _MAPS[quantity]
            centre = float(functional(wear.centre))
            interval = basic_interval(centre, functional(wear.draws), wear.count)
            found = about(float(functional(wear.mean)), interval)
        elif len(wear.mean) == 1:
            found = peak_of(wear.mean[0], wear.draws[:, 0], wear.count).angle
        else:
            return None
        ends = None if found.low is None or found.high is None else (found.low, found.high)
        return Measured(found.mean, ends, samples=cycles, replicates=len(rows))

    return {name: measured(name) for name in names}


@dataclass(frozen=True)
class _Drawn:
    """The wears after some stages added up, m; see the quantities of maps.

    Attributes
    ----------
    mean : ndarray, shape (surfaces, m)
    centre : ndarray, shape (surfaces, m)
        Mean of the maps that the draws are from.
    draws : ndarray, shape (RESAMPLES, surfaces, m)
    count : int
        Fewest maps that they are from.
    """

    mean: Array
    centre: Array
    draws: Array
    count: int


def _drawn(result: Result, joint: str, stages: range) -> _Drawn:
    """Add up the wears after some stages."""
    turns = result.scene.conventions.map_frame == "body"
    pools, wear_updates = [], []
    for stage in stages:
        arrays = result.stages[stage].arrays
        maps, weights = arrays[f"{joint}_wear_batches"], arrays["wear_batch_cycles"]
        wear = np.stack([arrays[f"{joint}_wear_{side}"] for side in SIDES])
        if not len(maps):
            # Too few cycles for batches: the wear is one.
            maps, weights = wear[np.newaxis], np.ones(1)
        wear_updates.append(wear if turns else wear.sum(axis=0, keepdims=True))
        pools.append((maps if turns else maps.sum(axis=1, keepdims=True), weights))
    shape = pools[0][0].shape[1:]
    centre = sum((np.tensordot(w / w.sum(), m, 1) for m, w in pools), np.zeros(shape))
    draws = sum(
        (resampled(m.reshape(len(m), -1), w, seed) for seed, (m, w) in enumerate(pools)),
        np.zeros((1, centre.size)),
    )
    mean = np.sum(wear_updates, axis=0)
    return _Drawn(mean, centre, draws.reshape(-1, *shape), min(len(m) for m, _ in pools))
