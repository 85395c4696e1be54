"""Sampled cycles of a stage: the recorded cycles after the start-up."""

import numpy as np

from presswear.recording import statistics
from presswear.recording.columns import (
    DRIVE_CYCLE_COUNT,
    DURATION,
    first_leader_column,
)
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

_MISSING = 0.02  # part of a cycle that may be missing in the series of a complete cycle
_ROUND_OFF = 0.01  # part of a cycle by which times of complete cycles may be shorter


def sampled_cycles(scene: Scene, stage: StageResult) -> Array:
    """Return the rows of the cycles after the start-up, of all replicates, as stored.

    The cycles of the second set of replicates are not used.
    """
    replicate = stage.arrays["cycle_start"]
    settling = stage.statistics.settling
    sampled = []
    for k in range(scene.replicate_count):
        rows = stage.arrays["cycles"][replicate == k]
        if settling:
            rows = rows[settling.skipped(k) :]
        sampled.append(statistics.after_startup(rows))
    return np.concatenate(sampled)


def drive_numbers(scene: Scene, stage: StageResult) -> Array:
    """Return the numbers of the drives in the sampled cycles.

    The shape is (cycles, drives, numbers of ``DRIVE_CYCLE``).
    """
    cycles = sampled_cycles(scene, stage)
    drives = len(scene.mechanism.linkage().drives)
    # The columns of the drives are the last ones of a row.
    numbers = cycles[:, -DRIVE_CYCLE_COUNT * drives :]
    return numbers.reshape(len(cycles), drives, DRIVE_CYCLE_COUNT)


def durations(scene: Scene, stage: StageResult) -> Array:
    """Return the durations of the sampled cycles with a motor, s, shape (cycles,)."""
    column = first_leader_column(len(stage.joint_names)) + DURATION
    return sampled_cycles(scene, stage)[:, column]


def has_motion(scene: Scene, stage: StageResult) -> bool:
    """Return whether a complete cycle of a motion with clearance was recorded."""
    if stage.failed or not stage.has_joint_series or stage.time.size < 2:
        return False
    start, end = sampled_span(scene, stage)
    return end - start > (1.0 - _ROUND_OFF) * scene.mechanism.period


def sampled_span(scene: Scene, stage: StageResult) -> tuple[float, float]:
    """Return start and end of the recorded complete cycles after the start-up, s.

    They are times as in ``StageResult.time``.
    """
    period = scene.mechanism.period
    run_up = scene.run_up
    complete = int((float(stage.time[-1]) - run_up) / period + _MISSING)
    first = max(min(STARTUP_CYCLES, complete - 1), 0)
    end = run_up + max(complete, first + 1) * period
    return run_up + first * period, min(end, float(stage.time[-1]))
