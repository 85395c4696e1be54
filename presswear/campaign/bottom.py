"""Accuracy and repeatability at bottom dead centre.

The words are those of GB/T 29548-2024: accuracy is the height of bottom dead centre against the
ideal, repeatability how that scatters from stroke to stroke.
"""

import math
from collections.abc import Sequence

from presswear.campaign.statistics import mean_of
from presswear.physics.bottom import DWELL, bottom_of, dwell_of
from presswear.recording.recorder import Recorder
from presswear.recording.statistics import Estimate, after_startup, mean_range, spread
from presswear.results.stage import BottomStatistics
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

SHARP = 0.01
"""Part of the scatter of bottom dead centre over which its instant is sharp."""
STILL = 1e-9
"""Part of the stroke by which an ideal slider moves that stands."""


def bottom_statistics(
    scene: Scene, recorders: Sequence[Recorder], alone: Sequence[Recorder] = ()
) -> BottomStatistics | None:
    """Return the statistics of bottom dead centre; None where there is no settled stroke.

    Of a servo that dwells there the ideal has no instant to be later than: no delay is told where
    the ideal motion stays within ``SHARP`` of the scatter for longer than ``DWELL``.

    Parameters
    ----------
    recorders, alone : sequence of Recorder
        As in ``stage_statistics``.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return None
    ran, alone = (
        [own for own in some if len(own.cycles) > ideal.first] for some in (recorders, alone)
    )
    if not ran:
        return None
    turn = 2.0 * math.pi / ideal.period

    def heights(own: Recorder) -> Array:
        return own.each_cycle("bottom_height")

    def delays(own: Recorder) -> Array:
        return ideal.delay(own.each_cycle("bottom_time"))

    mean = mean_of(ran, alone)
    settled = [after_startup(heights(own)) for own in ran]
    height = mean(heights)
    span, count = mean_range(list(map(heights, ran)))
    scatter = spread(list(map(heights, ran)))
    near = max(0.0 if scatter is None else SHARP * scatter.mean, STILL * ideal.stroke)
    dwell = dwell_of(scene.ideal, near)
    delay: dict[str, Estimate | None] = {}
    if dwell < DWELL * ideal.period:
        delay = {
            "delay": mean(delays),
            "delay_angle": mean(lambda run: turn * delays(run)),
            "delay_standard_deviation": spread(list(map(delays, ran))),
        }
    return BottomStatistics(
        strokes=sum(run.size for run in settled),
        ideal_height=ideal.height,
        ideal_time=ideal.time,
        ideal_dwell=dwell,
        height=height,
        error=Estimate.symmetric(height.mean - ideal.height, height.half_width, height.samples),
        range_of_all=float(max(run.max() for run in settled) - min(run.min() for run in settled)),
        range=span,
        range_strokes=count,
        standard_deviation=scatter,
        **delay,
    )
