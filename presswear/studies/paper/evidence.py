"""What our runs say about a quantity of the paper: its value, its interval, its scatter."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.deviation import COLUMNS
from presswear.record.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.record.sampling import (
    LEAST_SAMPLES,
    after_startup,
    basic_interval,
    map_errors,
    peak_of,
    pointwise_interval,
    pooled,
    resampled,
)
from presswear.results.result import Result
from presswear.studies.paper.variants import cases, variant_key

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
    first : (float, float) or None
        Range of the first cycles of all starts, which are not among the samples.
    samples : int
        Cycles.
    starts : int
    differ : bool
        Whether the starts differ by more than their cycles explain.
    """

    value: float
    low: float | None
    high: float | None
    draws: tuple[float, float] | None
    first: tuple[float, float] | None
    samples: int
    starts: int
    differ: bool = False


@dataclass(frozen=True)
class WearMap:
    """Depth of both surfaces of a joint together, pooled over the starts, m.

    Of maps that turn with their bodies, which have no common angle, the bearing's alone.

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


Sampler = Callable[[Result, int, str], list[Array]]
"""Result, stage and joint -> one number a cycle, by start."""


def _column(name: str) -> Sampler:
    """Samples from a column of the account's cycles."""

    def samples(result: Result, stage: int, joint: str) -> list[Array]:
        arrays = result.stages[stage].arrays
        column = CYCLE_FIXED.index(name) if name in CYCLE_FIXED else len(CYCLE_FIXED)
        if name in CYCLE_JOINT:
            column += len(CYCLE_JOINT) * result.scene.clearance_joints.index(joint)
            column += CYCLE_JOINT.index(name)
        return by_start(arrays["cycles"][:, column], arrays["cycle_start"])

    return samples


def by_start(values: Array, start: Array) -> list[Array]:
    """Values apart by the start that they are of."""
    return [values[start == index] for index in np.unique(start)]


def _contact_rate(result: Result, stage: int, joint: str) -> list[Array]:
    """Contacts in a second, 1/s; they are stored counted through."""
    period = result.scene.mechanism.period
    counted = _column("contacts")(result, stage, joint)
    return [np.asarray(np.diff(own, prepend=0.0) / period) for own in counted]


def _deviation(name: str) -> Sampler:
    """Samples from the recorded cycles."""

    def samples(result: Result, stage: int, joint: str) -> list[Array]:
        arrays = result.stages[stage].arrays
        values = arrays["deviation"][:, COLUMNS.index(name)]
        return by_start(values, arrays["deviation_start"])

    return samples


def _flight(result: Result, stage: int, joint: str) -> list[Array]:
    """Part of the time in which the pin touches nothing."""
    arrays = result.stages[stage].arrays
    return by_start(arrays[f"{joint}_flight"], arrays["deviation_start"])


_CYCLES: Mapping[str, Sampler] = {
    "displacement": _column("displacement_max"),
    "velocity": _column("velocity_max"),
    "acceleration": _column("acceleration_max"),
    "force": _column("force_max"),
    "contact_rate": _contact_rate,
    "dose": _column("dose"),
    **{name: _deviation(name) for name in COLUMNS},
    "flight": _flight,
}
"""Quantities of which every cycle is a sample."""


# A map is given as its surfaces, shape (..., surfaces, m): one, both added up, where angles are
# directions in space; two where they are on the bodies.


def _deepest(maps: Array) -> Array:
    return np.asarray(maps.max(axis=-1).sum(axis=-1))


def _range(maps: Array) -> Array:
    """Angle over which a surface is worn, rad."""
    worn = maps >= RANGE_DEPTH * maps.max(axis=-1, keepdims=True)
    return np.asarray(2.0 * math.pi * worn.mean(axis=(-2, -1)))


def _unevenness(maps: Array) -> Array:
    return np.asarray(maps.std(axis=-1).sum(axis=-1))


def _mean_depth(maps: Array) -> Array:
    return np.asarray(maps.mean(axis=-1).sum(axis=-1))


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
    """The finished runs of a study, by case and setting."""

    runs: Mapping[tuple[str, str], Result]
    _known: dict[tuple[str, Place, str], Measured | None] = field(default_factory=dict)

    @staticmethod
    def of(results: Mapping[str, Result]) -> "Evidence":
        """From the results by the keys of their variants."""
        return Evidence(
            {
                (case.key, setting): results[key]
                for case in cases()
                for setting in case.settings
                if (key := variant_key(case.key, setting)) in results
            }
        )

    def at_stage(self, case: str, setting: str, stage: int) -> Result | None:
        """The run of a case, where it reached a stage and ran it to its end."""
        result = self.runs.get((case, setting))
        if result is None or not 0 <= stage < len(result.stages):
            return None
        return None if result.stages[stage].status == "failed" else result

    def measured(self, case: str, place: Place, quantity: str) -> Measured | None:
        """A quantity under a case, pooled over its starts; None where nothing says it."""
        key = (case, place, quantity)
        result = self.runs.get((case, place.setting))
        if place.joint and result and place.joint not in result.scene.clearance_joints:
            return None
        if key not in self._known:
            measure = self._of_cycles if quantity in _CYCLES else self._of_maps
            self._known[key] = measure(case, place, quantity)
        return self._known[key]

    def _of_cycles(self, case: str, place: Place, quantity: str) -> Measured | None:
        result = self.at_stage(case, place.setting, place.wears)
        if result is None:
            return None
        rows = [r for r in _CYCLES[quantity](result, place.wears, place.joint) if r.size]
        if not rows:
            return None
        estimate, apart = pooled(rows)
        half = estimate.half_width
        samples = np.concatenate([after_startup(own) for own in rows])
        draws = None
        if samples.size >= LEAST_SAMPLES:
            low, high = np.quantile(samples, (0.025, 0.975))
            draws = (float(low), float(high))
        return Measured(
            estimate.mean,
            None if half is None else estimate.mean - half,
            None if half is None else estimate.mean + half,
            draws,
            (float(min(own[0] for own in rows)), float(max(own[0] for own in rows))),
            estimate.cycles,
            len(rows),
            apart,
        )

    def _of_maps(self, case: str, place: Place, quantity: str) -> Measured | None:
        last = place.wears - 1
        result = self.at_stage(case, place.setting, last)
        # The wear that the last stage would cause is a single jump, no measure of one in steps.
        if result is None or (result.scene.wears_in_steps and place.wears > result.scene.wears):
            return None
        stages = range(last, place.wears) if quantity in _LAST else range(place.wears)
        mean, draws, count = _drawn(result, place.joint, stages)
        dose = _CYCLES["dose"](result, last, place.joint)
        cycles = sum(after_startup(rows).size for rows in dose)
        if quantity == ANGLE:
            if len(mean) > 1:
                return None
            interval = peak_of(mean[0], draws[:, 0], count).angle
        else:
            functional = (_LAST if quantity in _LAST else _MAPS)[quantity]
            interval = basic_interval(float(functional(mean)), functional(draws), count)
        return Measured(interval.value, interval.low, interval.high, None, None, cycles, len(dose))

    def wear_map(self, case: str, setting: str, joint: str, wears: int) -> WearMap | None:
        """Depth after some wears, bearing and pin together, with its pointwise interval."""
        result = self.at_stage(case, setting, wears - 1)
        if result is None or joint not in result.scene.clearance_joints:
            return None
        mean, draws, count = _drawn(result, joint, range(wears))
        low, high = pointwise_interval(mean[0], draws[:, 0], count)
        return WearMap(result.stages[0].arrays["angle"], mean[0], np.maximum(low, 0.0), high)

    def map_error(self, case: str, setting: str, joint: str, stage: int) -> float | None:
        """Standard error of the wear map of a stage, part of its rms."""
        result = self.at_stage(case, setting, stage)
        if result is None or joint not in result.scene.clearance_joints:
            return None
        arrays = result.stages[stage].arrays
        maps = arrays[f"{joint}_wear_batches"][:, np.newaxis]
        error = float(map_errors(maps, arrays["wear_batch_cycles"])[0])
        return error if math.isfinite(error) else None


def _drawn(result: Result, joint: str, stages: range) -> tuple[Array, Array, int]:
    """Mean of the wears after some stages added up, its draws, and their fewest samples.

    Returns
    -------
    mean : ndarray, shape (surfaces, m)
        m; see the quantities of maps.
    draws : ndarray, shape (RESAMPLES, surfaces, m)
    count : int
    """
    turns = result.scene.conventions.map_frame == "body"
    pools = []
    for stage in stages:
        maps, weights = _batches(result.stages[stage].arrays, joint)
        pools.append((maps if turns else maps.sum(axis=1, keepdims=True), weights))
    shape = pools[0][0].shape[1:]
    mean = sum((np.tensordot(w / w.sum(), m, 1) for m, w in pools), np.zeros(shape))
    draws = sum(
        (resampled(m.reshape(len(m), -1), w, seed) for seed, (m, w) in enumerate(pools)),
        np.zeros((1, mean.size)),
    )
    return mean, draws.reshape(-1, *shape), min(len(m) for m, _ in pools)


def _batches(arrays: Mapping[str, Array], joint: str) -> tuple[Array, Array]:
    """Depth of one wear by batches, (n, 2, m), and the cycles in each, (n,).

    Where there are no batches, of too few cycles, the wear is one.
    """
    own = arrays[f"{joint}_wear_batches"]
    if len(own):
        return own, arrays["wear_batch_cycles"]
    whole = np.stack([arrays[f"{joint}_wear_bearing"], arrays[f"{joint}_wear_pin"]])
    return whole[np.newaxis], np.ones(1)
