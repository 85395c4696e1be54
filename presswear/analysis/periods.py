"""Poincaré sections, sections at touchdown, and the period of a motion."""

from dataclasses import dataclass

import numpy as np

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.sampled_cycles import sampled_span
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# relative to a scale: largest difference of states of a periodic motion
TOLERANCE = 1e-2


@dataclass(frozen=True)
class Periodicity:
    """Period of a motion."""

    # smallest number of cycles after which every state returns; None: none
    period: int | None
    # largest difference one period apart, over the scales; smallest of all candidates
    error: float
    cycles: int  # number of states
    tolerance: float  # relative to the scales

    def __str__(self) -> str:
        extent = f"within {100.0 * self.tolerance:g} % in {self.cycles} cycles"
        return (
            f"no period {extent}"
            if self.period is None
            else f"period {self.period} {extent}"
        )


def periodicity(
    states: Array, scales: Array, tolerance: float = TOLERANCE
) -> Periodicity:
    """Return the period of a motion from its states at one phase of each cycle.

    Each state is compared with the state k cycles later, for k up to half of the
    cycles, so that every state of the orbit is seen twice.

    Parameters
    ----------
    states : ndarray, shape (cycles, d)
        Without the states of the start-up.
    scales : ndarray, shape (d,)
        Size of each component, in the unit of the component.
    tolerance : float
        Largest difference of a periodic motion, relative to the scales.
    """
    scaled = states / scales
    smallest = np.inf
    for period in range(1, len(scaled) // 2 + 1):
        error = float(np.abs(scaled[period:] - scaled[:-period]).max())
        if error <= tolerance:
            return Periodicity(period, error, len(scaled), tolerance)
        smallest = min(smallest, error)
    return Periodicity(None, smallest, len(scaled), tolerance)


def section_of(scene: Scene, stage: StageResult, joint: str) -> tuple[Array, float]:
    """Return the positions of a pin once a cycle after the start-up, m, and the phase, 0 to 1.

    They are of the first Poincaré section of every cycle, if sections were stored, else
    of the ends of the recorded cycles, linear between rows.
    """
    if "sections" in stage.arrays:
        both = [stage.section(f"eccentricity_{axis}", joint)[:, 0] for axis in "xy"]
        rows = np.transpose(both)[min(STARTUP_CYCLES, len(both[0]) - 1) :]
        return rows, scene.recording.phases[0]
    start, end = sampled_span(scene, stage)
    period = scene.mechanism.period
    ends = start + period * np.arange(int((end - start) / period + 1e-9) + 1)
    columns = stage.joints[joint].eccentricity.T
    return np.transpose(
        [np.interp(ends, stage.time, column) for column in columns]
    ), 1.0


def impacts_of(scene: Scene, stage: StageResult, joint: str) -> tuple[Array, Array]:
    """Return phase, 0 to 1, and closing speed, m/s, of sampled touchdowns, (n,) each."""
    start, end = sampled_span(scene, stage)
    item = stage.joints[joint]
    instant = stage.nominal_of(item.contact("touchdown"))
    inside = (instant >= start) & (instant <= end)
    phase = (instant[inside] - scene.run_up) / scene.mechanism.period % 1.0
    return phase, item.contact("closing_speed")[inside]


def period_of(scene: Scene, stage: StageResult) -> Periodicity:
    """Return the period of the positions of all pins relative to their clearances."""
    places = [section_of(scene, stage, joint)[0] for joint in stage.joint_names]
    scales = [np.full(2, scene.bearing(joint).clearance) for joint in stage.joint_names]
    return periodicity(np.concatenate(places, axis=1), np.concatenate(scales))
