"""Accuracy and repeatability at bottom dead centre, ready for ``result.json``.

The words are those of GB/T 29548-2024: accuracy is the height of bottom dead centre against the
ideal, repeatability how that scatters from stroke to stroke.
"""

import math
from collections.abc import Sequence
from typing import Any

from presswear.campaign.statistics import ends, mean_of
from presswear.physics.bottom import DWELL, bottom_of, dwell_of
from presswear.recording.recorder import Recorder
from presswear.recording.sampling import Interval, after_startup, mean_range, spread
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

SHARP = 0.01
"""Part of the scatter of bottom dead centre over which its instant is sharp."""
STILL = 1e-9
"""Part of the stroke by which an ideal slider moves that stands."""


def bottom_statistics(
    scene: Scene, recorders: Sequence[Recorder], alone: Sequence[Recorder] = ()
) -> dict[str, Any]:
    """Numbers of bottom dead centre over the settled strokes; none where there is no stroke.

    Of a servo that dwells there the ideal has no instant to be later than: no delay is told where
    the ideal motion stays within ``SHARP`` of the scatter for longer than ``DWELL``.

    Parameters
    ----------
    recorders, alone : sequence of Recorder
        As in ``stage_statistics``.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return {}
    ran, alone = (
        [own for own in some if len(own.cycles) > ideal.first] for some in (recorders, alone)
    )
    if not ran:
        return {}
    turn = 2.0 * math.pi / ideal.period

    def heights(own: Recorder) -> Array:
        return own.each_cycle("bottom_height")

    def delays(own: Recorder) -> Array:
        return ideal.delay(own.each_cycle("bottom_time"))

    mean = mean_of(ran, alone)
    settled = [after_startup(heights(own)) for own in ran]
    strokes = sum(own.size for own in settled)
    height = mean(heights)
    span, count = mean_range(list(map(heights, ran)))
    found: dict[str, Any] = {
        "strokes": strokes,
        "ideal_height_m": ideal.height,
        "ideal_time_s": ideal.time,
        "height_per_cycle_m": height,
        "error_per_cycle_m": {**height, "mean": height["mean"] - ideal.height},
        "range_of_all_m": max(map(float, (own.max() for own in settled)))
        - min(map(float, (own.min() for own in settled))),
        "range_strokes": count,
    }
    scatter = spread(list(map(heights, ran)))
    near = max(0.0 if scatter is None else SHARP * scatter.value, STILL * ideal.stroke)
    found["ideal_dwell_s"] = dwell_of(scene.ideal, near)
    told: dict[str, tuple[Interval | None, str]] = {
        "range": (span, "m"),
        "standard_deviation": (scatter, "m"),
    }
    if found["ideal_dwell_s"] < DWELL * ideal.period:
        found["delay_per_cycle_s"] = mean(delays)
        found["delay_per_cycle_rad"] = mean(lambda own: turn * delays(own))
        told["delay_standard_deviation"] = spread(list(map(delays, ran))), "s"
    for name, (interval, unit) in told.items():
        found[f"{name}_{unit}"] = None if interval is None else interval.value
        found[f"{name}_interval_{unit}"] = None if interval is None else ends(interval)
    return found
