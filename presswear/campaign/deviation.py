"""How far a motion with clearance is from the ideal one, cycle by cycle of what was recorded."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan
from presswear.physics.ideal import IdealMotion
from presswear.recording.recorder import Recorder
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

COLUMNS = ("displacement_off", "velocity_off", "lag", "stroke")
"""Columns of ``deviation``: root mean square distances, m and m/s; delay, s; stroke, m."""


def deviation(scene: Scene, recorder: Recorder) -> Array:
    """How far one run is from the ideal motion, cycle by cycle.

    Of as many cycles as are recorded of a scene without work.

    Returns
    -------
    ndarray, shape (cycles, 4 + joints)
        COLUMNS, and of each clearance joint the part of the time out of contact.
    """
    # A series may hold many more cycles than this takes.
    last = scene.run_up + (Plan.recorded_cycles + 1e-3) * scene.mechanism.period
    taken = slice(int(np.searchsorted(recorder.series("time"), last, side="right")))
    names = ("time", "displacement", "velocity")
    time, moved, speed = (recorder.series(name)[taken] for name in names)
    joints = range(recorder.book.memory.size)
    flights = [(recorder.series("penetration", k)[taken] <= 0.0).astype(np.float64) for k in joints]
    found = [
        slider_deviation(scene, time[rows], moved[rows], speed[rows])
        + [mean_over_time(time[rows], flight[rows]) for flight in flights]
        for rows in whole_cycles(time - scene.run_up, scene.mechanism.period)
    ]
    return np.array(found).reshape(len(found), len(COLUMNS) + len(flights))


def deviations(
    scene: Scene, joints: Sequence[str], recorders: Sequence[Recorder]
) -> dict[str, Array]:
    """Arrays of a stage, a row for each recorded cycle of each start.

    Parameters
    ----------
    joints : sequence of str
        Names of the clearance joints.
    recorders : sequence of Recorder
        Of the starts.

    Returns
    -------
    dict
        ``deviation_start`` (n,): the start that a row is of; ``deviation`` (n, 4): see COLUMNS;
        ``J_flight`` (n,) of each clearance joint J: part of the time out of contact.
    """
    replicates = [deviation(scene, recorder) for recorder in recorders]
    rows = np.concatenate(replicates)
    flights = rows[:, len(COLUMNS) :].T
    return {
        "deviation_start": np.repeat(np.arange(float(len(replicates))), list(map(len, replicates))),
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
