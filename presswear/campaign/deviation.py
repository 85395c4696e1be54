"""How far a motion with clearance is from the ideal one, cycle by cycle of what was recorded."""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import Ensemble
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

COLUMNS = ("displacement_off", "velocity_off", "lag", "stroke")
"""Columns of ``deviation``: root mean square distances, m and m/s; delay, s; stroke, m."""


def deviations(scene: Scene, ensemble: Ensemble) -> dict[str, Array]:
    """Arrays of a stage, a row for each recorded cycle of each start.

    Returns
    -------
    dict
        ``deviation_start`` (n,): the start that a row is of; ``deviation`` (n, 4): see COLUMNS;
        ``J_flight`` (n,) of each clearance joint J: part of the time out of contact.
    """
    period = scene.mechanism.period
    starts: list[int] = []
    slider: list[list[float]] = []
    flight: dict[str, list[float]] = {joint.name: [] for joint in ensemble.linkage.clearances}
    for index, recorder in enumerate(ensemble.recorders):
        time = recorder.series("time")
        moved, speed = recorder.series("displacement"), recorder.series("velocity")
        for rows in whole_cycles(time - scene.run_up, period):
            starts.append(index)
            slider.append(slider_deviation(scene, time[rows], moved[rows], speed[rows]))
            for k, own in enumerate(flight.values()):
                is_open = recorder.series("penetration", k)[rows] <= 0.0
                own.append(mean_over_time(time[rows], is_open.astype(float)))
    return {
        "deviation_start": np.array(starts, dtype=np.float64),
        "deviation": np.array(slider).reshape(-1, len(COLUMNS)),
        **{f"{name}_flight": np.array(own) for name, own in flight.items()},
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
    ideal = scene.ideal_slider(time)
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
