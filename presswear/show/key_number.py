"""Key number of an estimate: value, interval, and a note if it has too few samples."""

import math
from collections.abc import Sequence

from presswear.recording.settling import REPEATED
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.show.page import NOTHING, KeyNumber
from presswear.tools import numbers

ENOUGH = 20  # sampled strokes from which the intervals of peak forces are trusted
UNKNOWN = "interval unknown"
SCATTERS = "scatters too much"  # note of a number of enough strokes without an interval


def enough_cycles(scene: Scene) -> int:
    """Return the least number of cycles that a report recommends.

    All replicates together then have enough strokes for the intervals of peak forces,
    and each one has enough to show whether its motion settles.
    """
    strokes = math.ceil(ENOUGH / scene.replicate_count)
    return STARTUP_CYCLES + max(strokes, REPEATED)


def fewest_strokes(stages: Sequence[StageResult]) -> int:
    """Return the least number of strokes behind a peak force, or ENOUGH if it is larger."""
    fewest = ENOUGH
    for stage in stages:
        for joint in stage.statistics.joints.values():
            fewest = min(fewest, joint.peak_force_per_cycle.samples)
    return fewest


def measured(
    name: str,
    estimate: Estimate | None,
    unit: str,
    meaning: str,
    strokes: int | None = None,
) -> KeyNumber:
    """Return a key number of an estimate in SI, with a note if the estimate is uncertain.

    ``strokes`` is the number of strokes of the estimate (default: its samples).
    """
    if strokes is None:
        strokes = estimate.samples if estimate else 0
    note = f"from {numbers.counted(strokes, 'stroke')}" if strokes < ENOUGH else ""
    if estimate is None:
        return KeyNumber(name, NOTHING, "", meaning, note=note)
    low = estimate.low
    mean = estimate.mean
    high = estimate.high
    factor, shown = numbers.unit_scale(unit, abs(mean))
    if low is None or high is None or not estimate.has_interval:
        value = f"{numbers.readable(factor * mean, 2)} {shown}"
        note = f"{note}, too few" if note else SCATTERS
        single = estimate.without_interval
        return KeyNumber(name, value, UNKNOWN, meaning, note=note, estimate=single)
    digits = 3 if high - low < 0.2 * abs(mean) else 2
    value = f"{numbers.readable(factor * mean, digits)} {shown}".rstrip()
    low_text = numbers.readable(factor * low, digits)
    high_text = numbers.readable(factor * high, digits)
    interval = ""
    if low_text != high_text:
        interval = f"{low_text} to {high_text} {shown}".rstrip()
    return KeyNumber(name, value, interval, meaning, note=note, estimate=estimate)


def exact(name: str, number: float, unit: str, meaning: str) -> KeyNumber:
    """Return a key number of a number without an error, in SI, that all stages share."""
    value = numbers.quantity_text(number, unit)
    estimate = Estimate(number, number, number)
    return KeyNumber(name, value, "", meaning, estimate=estimate, depends_on_wear=False)
