"""Poincaré sections, sections at touchdown, and the period of a motion."""

from dataclasses import dataclass

import numpy as np

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.sampled_cycles import sampled_span
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# Largest difference between states of a periodic motion, relative to a scale
TOLERANCE = 1e-2


@dataclass(frozen=True)
class Periodicity:
    """Period of a motion."""

    # smallest number of cycles after which every state returns; None: not periodic
    period: int | None
    # largest difference between states one period apart, relative to the scales; without
    # a period, that of the candidate for which it is smallest
    error: float
    cycles: int  # number of states
    tolerance: float  # relative to the scales

    def __str__(self) -> str:
        extent = f"within {100.0 * self.tolerance:g} % in {self.cycles} cycles"
        if self.period is None:
            return f"no period {extent}"
        return f"period {self.period} {extent}"


def periodicity(
    states: Array, scales: Array, tolerance: float = TOLERANCE
) -> Periodicity:
    """Return the period of a motion from its states at one phase of each cycle.

    Each state is compared with the state k cycles later. The largest k is half of the
    cycles, because an orbit must be observed twice.

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
    """Return the positions of a pin at one phase of each cycle after the start-up.

    Positions are in m, shape (cycles, 2); the phase is from 0 to 1. If sections were
    stored, the first Poincaré section of a cycle is used. Otherwise it is the end of
    each recorded cycle, with linear interpolation between rows.
    """
    if "sections" in stage.arrays:
        x = stage.section("eccentricity_x", joint)[:, 0]
        y = stage.section("eccentricity_y", joint)[:, 0]
        first = min(STARTUP_CYCLES, len(x) - 1)
        return np.transpose([x, y])[first:], scene.recording.phases[0]
    start, end = sampled_span(scene, stage)
    period = scene.mechanism.period
    ends = start + period * np.arange(int((end - start) / period + 1e-9) + 1)
    columns = stage.joints[joint].eccentricity.T
    positions = [np.interp(ends, stage.time, column) for column in columns]
    return np.transpose(positions), 1.0


def impacts_of(scene: Scene, stage: StageResult, joint: str) -> tuple[Array, Array]:
    """Return phase, 0 to 1, and closing speed, m/s, of sampled touchdowns, (n,) each."""
    start, end = sampled_span(scene, stage)
    pin = stage.joints[joint]
    touchdown = stage.nominal_of(pin.contact("touchdown"))
    is_sampled = (touchdown >= start) & (touchdown <= end)
    phase = (touchdown[is_sampled] - scene.run_up) / scene.mechanism.period % 1.0
    return phase, pin.contact("closing_speed")[is_sampled]


def period_of(scene: Scene, stage: StageResult) -> Periodicity:
    """Return the period of the positions of all pins relative to their clearances."""
    positions = []
    scales = []
    for joint in stage.joint_names:
        positions.append(section_of(scene, stage, joint)[0])
        scales.append(np.full(2, scene.bearing(joint).clearance))
    return periodicity(np.concatenate(positions, axis=1), np.concatenate(scales))
