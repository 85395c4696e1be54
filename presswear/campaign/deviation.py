"""How far a motion with clearance is from the ideal one, cycle by cycle of what was recorded."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan
from presswear.physics.ideal import IdealMotion
from presswear.record.recorder import Recorder
from presswear.scene.scene import Scene
from presswear.tools.workers import Report

Array = NDArray[np.float64]

COLUMNS = ("displacement_off", "velocity_off", "lag", "stroke")
"""Columns of ``deviation``: root mean square distances, m and m/s; delay, s; stroke, m."""


@dataclass(frozen=True)
class Deviation:
    """How far one run is from the ideal motion, as a job.

    Attributes
    ----------
    scene : Scene
    slider : ndarray, shape (3, n)
        Time, s, displacement, m, and velocity, m/s, as recorded.
    flight : ndarray, shape (joints, n)
        1 where a joint is out of contact, else 0.
    """

    scene: Scene
    slider: Array
    flight: Array

    @staticmethod
    def of(scene: Scene, recorder: Recorder) -> "Deviation":
        """Take what a run has recorded, of as many cycles as there are without work."""
        # A series may hold many more cycles than this takes.
        last = scene.run_up + (Plan.recorded_cycles + 1e-3) * scene.mechanism.period
        rows = slice(int(np.searchsorted(recorder.series("time"), last, side="right")))
        slider = [recorder.series(name)[rows] for name in ("time", "displacement", "velocity")]
        joints = range(recorder.book.memory.size)
        flight = [recorder.series("penetration", k)[rows] <= 0.0 for k in joints]
        return Deviation(scene, np.array(slider), np.array(flight, dtype=np.float64))

    def __call__(self, report: Report) -> Array:
        """Give a row for each cycle: COLUMNS, and of each joint the part of time out of contact."""
        time, moved, speed = self.slider
        found: list[list[float]] = []
        for rows in whole_cycles(time - self.scene.run_up, self.scene.mechanism.period):
            report(len(found))
            own = slider_deviation(self.scene, time[rows], moved[rows], speed[rows])
            found.append(own + [mean_over_time(time[rows], each[rows]) for each in self.flight])
        return np.array(found).reshape(len(found), len(COLUMNS) + len(self.flight))


def deviations(joints: Sequence[str], starts: Sequence[Array]) -> dict[str, Array]:
    """Arrays of a stage, a row for each recorded cycle of each start.

    Parameters
    ----------
    joints : sequence of str
        Names of the clearance joints.
    starts : sequence of ndarray
        What ``Deviation`` gave of each start.

    Returns
    -------
    dict
        ``deviation_start`` (n,): the start that a row is of; ``deviation`` (n, 4): see COLUMNS;
        ``J_flight`` (n,) of each clearance joint J: part of the time out of contact.
    """
    rows = np.concatenate(starts)
    flights = rows[:, len(COLUMNS) :].T
    return {
        "deviation_start": np.repeat(np.arange(float(len(starts))), list(map(len, starts))),
        "deviation": rows[:, : len(COLUMNS)].copy(),
        **{f"{name}_flight": own.copy() for name, own in zip(joints, flights, strict=True)},
    }


def whole_cycles(time: Array, period: float) -> list[slice]:
    """Rows of each whole cycle in a series.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.
    """
    if time.size == 0 or time[-1] < 0.0:
        return []
    # The last row of a series may lie a rounding before the end of its cycle.
    count = math.floor(float(time[-1]) / period + 1e-3)
    ends = np.searchsorted(time, period * np.arange(count + 1) - 1e-9 * period)
    ends[-1] = max(ends[-1], 1)
    return [slice(int(first), int(last)) for first, last in pairwise(ends) if last - first > 1]


def mean_over_time(time: Array, values: Array) -> float:
    """Mean of a sampled function by the trapezoidal rule."""
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))


def slider_deviation(scene: Scene, time: Array, moved: Array, speed: Array) -> list[float]:
    """One cycle's row of ``deviation``.

    The delay is the one by which the ideal motion fits best, a constant offset apart: by
    least squares, of first order in the delay.

    Parameters
    ----------
    moved, speed : ndarray, shape (n,)
        Displacement, m, and velocity, m/s.
    """
    ideal = scene.ideal_slider(time, IdealMotion.interpolated)
    off, faster = moved - ideal[:, 0], speed - ideal[:, 1]
    wanted = ideal[:, 1]
    centred = off - mean_over_time(time, off)
    way = mean_over_time(time, wanted**2)
    lag = -mean_over_time(time, centred * wanted) / way if way > 0.0 else 0.0
    return [
        math.sqrt(mean_over_time(time, off**2)),
        math.sqrt(mean_over_time(time, faster**2)),
        lag,
        float(np.ptp(moved)),
    ]
