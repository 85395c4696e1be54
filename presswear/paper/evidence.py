"""What our runs say about a quantity of the paper: its value, its interval, its scatter."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.ideal import ideal_slider
from presswear.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.paper.variants import cases, variant_key
from presswear.results import StoredResult
from presswear.sampling import (
    LEAST_SAMPLES,
    Interval,
    after_startup,
    basic_interval,
    differ,
    half_width,
    peak_of,
    pooled,
    resampled,
)

Array = NDArray[np.float64]

RANGE_DEPTH = 0.05
"""The worn range of a surface is where it is at least so deep, part of its deepest."""


@dataclass(frozen=True)
class Place:
    """What a quantity belongs to.

    Attributes
    ----------
    setting : str
        Key of SETTINGS.
    wears : int
        Wears before the stage; of wear depths the wears that are added up.
    joint : str
        Name of the joint, or nothing for the slider.
    """

    setting: str
    wears: int
    joint: str = ""


@dataclass(frozen=True)
class Measured:
    """A quantity as our runs have it, SI units and rad.

    Attributes
    ----------
    value : float
        Of a peak, the mean over cycles.
    low, high : float or None
        Ends of the 95 % interval; None where there are too few samples.
    draws : (float, float) or None
        Range that holds 95 % of single cycles, for what is read from one.
    samples : int
        Cycles.
    runs : int
    differ : bool
        Whether the runs differ by more than their cycles explain.
    """

    value: float
    low: float | None
    high: float | None
    draws: tuple[float, float] | None
    samples: int
    runs: int
    differ: bool = False


@dataclass(frozen=True)
class WearMap:
    """Depth of both surfaces of a joint together, pooled over the runs, m.

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


def _column(name: str) -> Callable[[StoredResult, int, str], Array]:
    """Samples from a column of the account's cycles."""

    def samples(result: StoredResult, stage: int, joint: str) -> Array:
        rows = result.stages[stage]["cycles"]
        if name in CYCLE_FIXED:
            return np.asarray(rows[:, CYCLE_FIXED.index(name)])
        base = len(CYCLE_FIXED) + len(CYCLE_JOINT) * result.scene.clearance_joints.index(joint)
        column = rows[:, base + CYCLE_JOINT.index(name)]
        # Contacts are counted through.
        return np.asarray(np.diff(column, prepend=0.0) if name == "contacts" else column)

    return samples


def _contact_rate(result: StoredResult, stage: int, joint: str) -> Array:
    """Contacts in a second, 1/s."""
    contacts = _column("contacts")(result, stage, joint)
    return np.asarray(contacts / result.scene.mechanism.period)


def _by_cycle(
    measure: Callable[[StoredResult, dict[str, Array], slice, str], float],
) -> Callable[[StoredResult, int, str], Array]:
    """Samples from the recorded series, one for each whole cycle in it."""

    def samples(result: StoredResult, stage: int, joint: str) -> Array:
        arrays = result.stages[stage]
        time, period = arrays["time"], result.scene.mechanism.period
        if time.size == 0:
            return np.zeros(0)
        ends = np.searchsorted(
            time, period * np.arange(round(float(time[-1]) / period) + 1), side="left"
        )
        return np.array(
            [
                measure(result, arrays, slice(int(first), int(last)), joint)
                for first, last in pairwise(ends)
            ]
        )

    return samples


def _mean_over_time(time: Array, values: Array) -> float:
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))


def _off_ideal(column: int) -> Callable[[StoredResult, dict[str, Array], slice, str], float]:
    """Root mean square distance of the slider from its ideal motion."""

    def measure(result: StoredResult, arrays: dict[str, Array], rows: slice, joint: str) -> float:
        time = arrays["time"][rows]
        off = arrays["slider"][rows, column] - ideal_slider(result.scene, time)[:, column]
        return math.sqrt(_mean_over_time(time, off**2))

    return measure


def _lag(result: StoredResult, arrays: dict[str, Array], rows: slice, joint: str) -> float:
    """Time by which the slider follows its ideal motion, by least squares, s."""
    time = arrays["time"][rows]
    ideal = ideal_slider(result.scene, time)
    off = arrays["slider"][rows, 0] - ideal[:, 0]
    # A constant offset is no lag.
    off = off - _mean_over_time(time, off)
    speed = ideal[:, 1]
    return -_mean_over_time(time, off * speed) / _mean_over_time(time, speed**2)


def _flight(result: StoredResult, arrays: dict[str, Array], rows: slice, joint: str) -> float:
    """Part of the time in which the pin touches nothing."""
    time = arrays["time"][rows]
    free = (arrays[f"{joint}_penetration"][rows] <= 0.0).astype(float)
    return _mean_over_time(time, free)


_CYCLES: Mapping[str, Callable[[StoredResult, int, str], Array]] = {
    "displacement": _column("displacement_max"),
    "velocity": _column("velocity_max"),
    "acceleration": _column("acceleration_max"),
    "force": _column("force_max"),
    "contact_rate": _contact_rate,
    "dose": _column("dose"),
    "displacement_off": _by_cycle(_off_ideal(0)),
    "velocity_off": _by_cycle(_off_ideal(1)),
    "lag": _by_cycle(_lag),
    "flight": _by_cycle(_flight),
}
"""Quantities of which every cycle is a sample."""


def _deepest(maps: Array) -> Array:
    return np.asarray(maps.max(axis=-1))


def _range(maps: Array) -> Array:
    """Angle over which a surface is worn, rad."""
    worn = maps >= RANGE_DEPTH * maps.max(axis=-1, keepdims=True)
    return np.asarray(2.0 * math.pi * worn.mean(axis=-1))


def _unevenness(maps: Array) -> Array:
    return np.asarray(maps.std(axis=-1))


def _mean_depth(maps: Array) -> Array:
    return np.asarray(maps.mean(axis=-1))


_MAPS: Mapping[str, Callable[[Array], Array]] = {
    "depth": _deepest,
    "range": _range,
    "unevenness": _unevenness,
    "mean_depth": _mean_depth,
}
"""Quantities of the wear map of both surfaces together, all wears so far added up."""

_LAST: Mapping[str, Callable[[Array], Array]] = {
    "added_depth": _deepest,
    "added_mean": _mean_depth,
    "contact_range": _range,
}
"""The same of the last wear alone."""

ANGLE = "angle"
"""Where a wear map is deepest."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """The finished runs of a study, by case and setting.

    Attributes
    ----------
    runs : mapping of (str, str) to tuple of StoredResult
        By start; a run without any stage is left out.
    """

    runs: Mapping[tuple[str, str], tuple[StoredResult, ...]]
    _known: dict[tuple[str, Place, str], Measured | None] = field(default_factory=dict)

    @staticmethod
    def of(results: Mapping[str, StoredResult]) -> "Evidence":
        """From the results by the keys of their variants."""
        runs = {
            (case.key, setting): tuple(
                results[key]
                for start in range(case.starts)
                if (key := variant_key(case.key, setting, start)) in results
            )
            for case in cases()
            for setting in case.settings
        }
        return Evidence({place: found for place, found in runs.items() if found})

    def at_stage(self, case: str, setting: str, stage: int) -> list[StoredResult]:
        """Runs that reached a stage and ran it to its end."""
        return [
            result
            for result in self.runs.get((case, setting), ())
            if stage < len(result.stages) and result.document["stages"][stage]["status"] != "failed"
        ]

    def measured(self, case: str, place: Place, quantity: str) -> Measured | None:
        """A quantity, pooled over the runs of a case; None where nothing says it."""
        key = (case, place, quantity)
        if key not in self._known:
            self._known[key] = self._measure(case, place, quantity)
        return self._known[key]

    def _measure(self, case: str, place: Place, quantity: str) -> Measured | None:
        if quantity in _CYCLES:
            return self._of_cycles(case, place, quantity)
        return self._of_maps(case, place, quantity)

    def _of_cycles(self, case: str, place: Place, quantity: str) -> Measured | None:
        found = self.at_stage(case, place.setting, place.wears)
        rows = [_CYCLES[quantity](result, place.wears, place.joint) for result in found]
        rows = [some for some in rows if some.size]
        if not rows:
            return None
        estimate, apart = pooled(rows)
        half = estimate.half_width
        samples = np.concatenate([after_startup(some) for some in rows])
        draws = None
        if samples.size >= LEAST_SAMPLES:
            low, high = np.quantile(samples, (0.025, 0.975))
            draws = (float(low), float(high))
        return Measured(
            estimate.mean,
            None if half is None else estimate.mean - half,
            None if half is None else estimate.mean + half,
            draws,
            estimate.cycles,
            len(rows),
            apart,
        )

    def _of_maps(self, case: str, place: Place, quantity: str) -> Measured | None:
        last = place.wears - 1
        found = self.at_stage(case, place.setting, last)
        if last < 0 or not found:
            return None
        stages = range(last, place.wears) if quantity in _LAST else range(place.wears)
        mean, draws, count = _drawn(found, place.joint, stages)
        dose = [_CYCLES["dose"](result, last, place.joint) for result in found]
        cycles = sum(after_startup(rows).size for rows in dose)
        apart = last > 0 and differ([after_startup(rows) for rows in dose])
        if quantity == ANGLE:
            interval = peak_of(mean, draws, count).angle
        else:
            functional = (_LAST if quantity in _LAST else _MAPS)[quantity]
            interval = basic_interval(float(functional(mean)), functional(draws), count)
            half = None
            if apart:
                own = [functional(_drawn([r], place.joint, stages)[0]) for r in found]
                half = half_width(np.array(own))
            if half is not None:
                interval = Interval(interval.value, interval.value - half, interval.value + half)
        return Measured(
            interval.value, interval.low, interval.high, None, cycles, len(found), apart
        )

    def wear_map(self, case: str, setting: str, joint: str, wears: int) -> WearMap | None:
        """Depth after some wears, bearing and pin together, with its pointwise interval."""
        found = self.at_stage(case, setting, wears - 1)
        if wears < 1 or not found:
            return None
        mean, draws, _ = _drawn(found, joint, range(wears))
        low, high = np.quantile(draws, (0.025, 0.975), axis=0)
        return WearMap(found[0].stages[0]["angle"], mean, low, high)

    def map_error(self, case: str, setting: str, joint: str, stage: int) -> float | None:
        """Standard error of the wear map of a stage, pooled over the runs, part of its rms."""
        found = self.at_stage(case, setting, stage)
        if not found:
            return None
        maps, weights = _batches(found, joint, stage)
        if len(maps) < LEAST_SAMPLES:
            return None
        share = weights / weights.sum()
        mean = share @ maps
        # Of a weighted mean of samples whose variance goes as one over the weight.
        variance = (share @ (maps - mean) ** 2) / (len(maps) - 1)
        return math.sqrt(float(variance.sum()) / float((mean**2).sum()))


def _drawn(found: Sequence[StoredResult], joint: str, stages: range) -> tuple[Array, Array, int]:
    """Mean of the wears after some stages added up, its draws, and their fewest samples."""
    pools = [_batches(found, joint, stage) for stage in stages]
    mean = sum((w @ m / w.sum() for m, w in pools), np.zeros(pools[0][0].shape[1]))
    draws = sum(
        (resampled(m, w, seed) for seed, (m, w) in enumerate(pools)), np.zeros((1, mean.size))
    )
    return mean, draws, min(len(m) for m, _ in pools)


def _batches(found: Sequence[StoredResult], joint: str, stage: int) -> tuple[Array, Array]:
    """Depth of one wear by batches of all runs, (n, m), and the cycles in each, (n,).

    Where a run has no batches, too few cycles, its wear is one.
    """
    maps, weights = [], []
    for result in found:
        arrays = result.stages[stage]
        cycles = len(arrays["cycles"])
        own = arrays[f"{joint}_wear_batches"].sum(axis=1)
        if not len(own):
            own = (arrays[f"{joint}_wear_bearing"] + arrays[f"{joint}_wear_pin"])[np.newaxis]
        maps.append(own)
        weights.append(np.full(len(own), cycles / len(own)))
    return np.concatenate(maps), np.concatenate(weights)
