"""What a cross-check keeps of a run, and the distance between two runs."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from presswear.engines.base import Run
from presswear.record.observe import SERIES_FIXED, SERIES_JOINT
from presswear.tools.errors import RunFailed

Array = NDArray[np.float64]

GRID = 2001
"""Common times at which series are compared."""


@dataclass(frozen=True)
class Touch:
    """A touch: joint, time, s, closing speed, m/s, and greatest force, N."""

    joint: int
    onset: float
    closing_speed: float
    peak_force: float


@dataclass(frozen=True)
class Trace:
    """What is compared of a run.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s.
    slider : ndarray, shape (n, 2)
        Position along the watched direction, m, and velocity, m/s.
    eccentricity : ndarray, shape (n, 2 joints)
        m.
    touches : tuple of Touch
        In the order of their times.
    """

    time: Array
    slider: Array
    eccentricity: Array
    touches: tuple[Touch, ...]

    def slider_at(self, time: Array) -> tuple[Array, Array]:
        """Position, m, and velocity, m/s, at other times of the run."""
        cubic = CubicHermiteSpline(self.time, self.slider[:, 0], self.slider[:, 1])
        return cubic(time), cubic.derivative()(time)


@dataclass(frozen=True)
class Difference:
    """How far a run's slider is from the reference over time, m."""

    label: str
    time: Array
    slider: Array


def touches_of(run: Run) -> tuple[Touch, ...]:
    """Recorded touches of all joints and those that still last, in order of time."""
    found = []
    book, rows = run.recorder.book, run.recorder.rows
    for k in range(book.memory.size):
        spans = [(row[0], row[1], row[2]) for row in run.recorder.episodes(k).tolist()]
        last = book.memory[k]
        if book.onset[k] > 0.0 and not last["started_closed"]:
            spans.append((float(last["touchdown_time"]), math.inf, float(book.onset[k])))
        force = rows[:, SERIES_FIXED + SERIES_JOINT * k + 3]
        for onset, end, closing in spans:
            within = slice(*np.searchsorted(rows[:, 0], [onset, end]))
            found.append(Touch(k, onset, closing, peak(rows[within, 0], force[within])))
    return tuple(sorted(found, key=lambda touch: touch.onset))


PEAK_REACH = 3
"""Samples on each side of the greatest that the curve through a peak takes in."""


def peak(time: Array, value: Array) -> float:
    """Greatest value of a sampled curve, by the polynomial through the samples around it."""
    if not value.size:
        return math.nan
    top = int(value.argmax())
    reach = min(PEAK_REACH, top, value.size - 1 - top)
    # Where samples nearly coincide, a polynomial through few of them is steadier.
    while reach > 1:
        near = time[top - reach : top + reach + 1]
        if np.diff(near).min() > 0.02 * (near[-1] - near[0]):
            break
        reach -= 1
    if reach == 0:
        return float(value[top])
    window = slice(top - reach, top + reach + 1)
    # In units of half the window: the powers stay well conditioned.
    x = 2.0 * (time[window] - time[top]) / (time[top + reach] - time[top - reach])
    curve = Polynomial(np.linalg.solve(np.vander(x, increasing=True), value[window]))
    turns = curve.deriv().roots()
    turns = turns[np.isreal(turns)].real
    inside = turns[(turns > x[reach - 1]) & (turns < x[reach + 1])]
    return float(max(value[top], *curve(inside)))


def trace_of(run: Run) -> Trace:
    """Copy what is compared of a run; RunFailed if it failed."""
    if run.status == "failed":
        raise RunFailed(run.message)
    rows = run.recorder.rows
    joints = run.recorder.book.memory.size
    columns = [SERIES_FIXED + SERIES_JOINT * k + axis for k in range(joints) for axis in range(2)]
    # The series holds displacements, and a disturbed start is displaced already.
    slider = rows[:, 1:3] + [float(run.recorder.book.record["start"][0]), 0.0]
    return Trace(rows[:, 0].copy(), slider, rows[:, columns], touches_of(run))


def common_times(one: Trace, other: Trace) -> Array:
    """Evenly spaced times that both runs cover, s."""
    return np.linspace(0.0, min(one.time[-1], other.time[-1]), GRID)


def slider_difference(label: str, one: Trace, other: Trace) -> Difference:
    """Distance of two sliders over time."""
    time = common_times(one, other)
    return Difference(label, time, np.abs(one.slider_at(time)[0] - other.slider_at(time)[0]))


def velocity_difference(reference: Trace, other: Trace, end: float) -> float:
    """Greatest difference of the slider's velocity up to a time, part of the run's greatest."""
    time = common_times(reference, other)
    time = time[time <= end]
    apart = other.slider_at(time)[1] - reference.slider_at(time)[1]
    return float(np.abs(apart).max() / np.abs(reference.slider[:, 1]).max())


def matched(
    reference: tuple[Touch, ...], other: tuple[Touch, ...]
) -> Iterator[tuple[Touch, Touch | None]]:
    """Each reference touch with the one of the same number in the same joint, if any."""
    queues = {k: iter([touch for touch in other if touch.joint == k]) for k in _joints(reference)}
    for touch in reference:
        yield touch, next(queues[touch.joint], None)


def _joints(touches: tuple[Touch, ...]) -> set[int]:
    return {touch.joint for touch in touches}


def touch_differences(reference: tuple[Touch, ...], other: tuple[Touch, ...]) -> Array:
    """Differences of matched touches, shape (n, 3): time, s, and relative speed and force.

    A touch that the other run lacks is infinitely far away.
    """
    rows = [
        [math.inf] * 3
        if twin is None
        else [
            abs(twin.onset - touch.onset),
            abs(twin.closing_speed / touch.closing_speed - 1.0),
            abs(twin.peak_force / touch.peak_force - 1.0),
        ]
        for touch, twin in matched(reference, other)
    ]
    return np.array(rows).reshape(-1, 3)


def parting_time(one: Trace, other: Trace, distance: float) -> float | None:
    """Time at which slider or eccentricities first differ by a distance, m; s."""
    time = common_times(one, other)
    apart = slider_difference("", one, other).slider
    for mine, theirs in zip(one.eccentricity.T, other.eccentricity.T, strict=True):
        between = np.interp(time, one.time, mine) - np.interp(time, other.time, theirs)
        apart = np.maximum(apart, np.abs(between))
    late = np.flatnonzero(apart >= distance)
    return float(time[late[0]]) if late.size else None
