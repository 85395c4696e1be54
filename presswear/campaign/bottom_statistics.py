"""Accuracy and repeatability of the strokes of a stage at bottom dead centre."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswear.campaign.cycle_means import CycleMeans, Recorders
from presswear.physics.dead_centre import DWELL, Bottom, bottom_of, dwell_of
from presswear.recording.statistics import (
    Estimate,
    after_startup,
    mean_range,
    pooled,
    spread,
)
from presswear.results.stage_statistics import BottomStatistics
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# Tolerance of the dwell of the ideal motion at bottom dead centre, relative to the scatter
DWELL_SHARE = 0.01
# Round-off of the position of an ideal slider at rest, relative to the stroke
ROUND_OFF = 1e-9


def bottom_statistics(
    scene: Scene, recorders: Recorders, alone: Recorders = ()
) -> BottomStatistics | None:
    """Return accuracy and repeatability at bottom dead centre after GB/T 29548-2024.

    ``recorders`` and ``alone`` are as in ``CycleMeans``. None if there is no sampled
    stroke. The delay is None if the ideal motion, such as the motion of a servo, stays
    within ``DWELL_SHARE`` of the scatter for longer than ``DWELL``, because it then has no
    instant of bottom dead centre. It is also None if the ideal stroke has several equal
    bottoms.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return None
    finished = [run for run in recorders if len(run.cycles) > ideal.first]
    alone = [run for run in alone if len(run.cycles) > ideal.first]
    if not finished:
        return None
    heights = [run.each_cycle("bottom_height") for run in finished]
    sampled_heights = _after_startup(heights)
    height = CycleMeans(finished, alone).mean("bottom_height")
    scatter = spread(heights)
    mean_of_ranges, range_strokes = mean_range(heights)
    scatter_size = 0.0 if scatter is None else scatter.mean
    round_off = ROUND_OFF * ideal.stroke
    dwell = dwell_of(scene.ideal, max(DWELL_SHARE * scatter_size, round_off))
    delays = [ideal.delay(run.each_cycle("bottom_time")) for run in finished]
    alone_delays = [ideal.delay(run.each_cycle("bottom_time")) for run in alone]
    all_delays = _after_startup([*delays, *alone_delays])
    equal = equal_bottoms(ideal, all_delays, max(scatter_size, round_off))
    statistics = BottomStatistics(
        strokes=sampled_heights.size,
        ideal_height=ideal.height,
        ideal_time=ideal.time,
        ideal_dwell=dwell,
        height=height,
        error=Estimate.symmetric(
            height.mean - ideal.height, height.half_width, height.samples
        ),
        range_of_all=float(np.ptp(sampled_heights)),
        range=mean_of_ranges,
        range_strokes=range_strokes,
        standard_deviation=scatter,
        equal_bottoms=equal,
    )
    if dwell >= DWELL * ideal.period or equal:
        return statistics
    delay, _ = pooled(delays, alone_delays)
    return replace(
        statistics,
        delay=delay,
        delay_angle=delay.scaled(2.0 * math.pi / ideal.period),
        delay_standard_deviation=spread(delays),
    )


def _after_startup(runs: Sequence[Array]) -> Array:
    """Return the values of the cycles of all runs after the start-up."""
    return np.concatenate([after_startup(values) for values in runs])


def equal_bottoms(ideal: Bottom, delay: Array, resolution: float) -> tuple[float, ...]:
    """Return the times in the cycle, s, of bottoms of an ideal stroke that count as equal.

    They are the minima within ``resolution``, m, of the lowest one, and the minima that
    are nearest to a stroke with one of the delays, s. Empty if there is only one.
    """
    times, heights = np.array(ideal.minima).reshape(-1, 2).T
    if times.size < 2:
        return ()
    nearest = np.abs(delay[:, np.newaxis] - (times - ideal.time)).argmin(axis=1)
    is_equal = heights - ideal.height < resolution
    is_equal[nearest] = True
    if is_equal.sum() < 2:
        return ()
    return tuple((times[is_equal] % ideal.period).tolist())
