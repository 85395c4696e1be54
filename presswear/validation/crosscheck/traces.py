"""Traces that a cross-check keeps of runs, and the distance between two of them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from presswear.engines.base import Run
from presswear.linkage.linkage import Linkage
from presswear.physics.ideal import Motion
from presswear.validation.runs import contacts_of, finished

Array = NDArray[np.float64]

GRID = 2001
"""Common times at which series are compared."""
PEAK_REACH = 3
"""Samples on each side of the greatest that the curve through a peak takes in."""


@dataclass(frozen=True)
class Touchdown:
    """A touchdown, and the contact that it begins.

    Attributes
    ----------
    time : float
        s.
    closing_speed : float
        m/s.
    peak_force : float
        Greatest force of the contact, N.
    """

    joint: int
    time: float
    closing_speed: float
    peak_force: float


@dataclass(frozen=True)
class Trace:
    """The parts of a run that are compared.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s.
    slider : ndarray, shape (n, 2)
        Position along the watched direction, m, and velocity, m/s.
    eccentricity : ndarray, shape (n, 2 joints)
        m.
    touchdowns : tuple of Touchdown
        In the order of their times.
    """

    time: Array
    slider: Array
    eccentricity: Array
    touchdowns: tuple[Touchdown, ...]

    def slider_at(self, time: Array) -> tuple[Array, Array]:
        """Position, m, and velocity, m/s, at other times of the run."""
        cubic = CubicHermiteSpline(self.time, self.slider[:, 0], self.slider[:, 1])
        return cubic(time), cubic.derivative()(time)


@dataclass(frozen=True)
class Difference:
    """Distance of a run's slider from the reference over time, m."""

    label: str
    time: Array
    slider: Array


def slider_at_end(linkage: Linkage, run: Run) -> Array:
    """Position, m, and velocity, m/s, along the watched direction at the end of a run."""
    q, v = run.end.position[np.newaxis], run.end.velocity[np.newaxis]
    return Motion(np.array([run.time]), q, v, np.zeros_like(v)).watched(linkage)[0, :2]


def touchdowns_of(run: Run) -> tuple[Touchdown, ...]:
    """Touchdowns of all recorded contacts and of those that still last, in order of time."""
    found = []
    recorder = run.recorder
    time, book = recorder.series("time"), recorder.book
    for k, last in enumerate(book.memory):
        contacts, force = contacts_of(run, k), recorder.series("normal", k)
        columns = (contacts[name].tolist() for name in ("touchdown", "separation", "closing_speed"))
        spans = list(zip(*columns, strict=True))
        if book.onset[k] > 0.0 and not last["started_closed"]:
            spans.append((float(last["touchdown_time"]), math.inf, float(book.onset[k])))
        for begin, end, closing in spans:
            within = slice(*np.searchsorted(time, [begin, end]))
            found.append(Touchdown(k, begin, closing, peak(time[within], force[within])))
    return tuple(sorted(found, key=lambda touchdown: touchdown.time))


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
    """Copy the parts of a run that are compared; RunFailed if it failed."""
    recorder = finished(run).recorder
    # The series holds displacements, and a disturbed start is displaced already.
    position = recorder.series("displacement") + float(recorder.book.record["start"][0])
    eccentricity = [
        recorder.series(name, k)
        for k in range(recorder.book.memory.size)
        for name in ("eccentricity_x", "eccentricity_y")
    ]
    return Trace(
        recorder.series("time").copy(),
        np.column_stack([position, recorder.series("velocity")]),
        np.array(eccentricity).reshape(-1, position.size).T,
        touchdowns_of(run),
    )


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
    reference: tuple[Touchdown, ...], other: tuple[Touchdown, ...]
) -> Iterator[tuple[Touchdown, Touchdown | None]]:
    """Each reference touchdown with that of the same number in the same joint, if any."""
    joints = {touchdown.joint for touchdown in reference}
    queues = {k: iter([own for own in other if own.joint == k]) for k in joints}
    for touchdown in reference:
        yield touchdown, next(queues[touchdown.joint], None)


def touchdown_differences(reference: tuple[Touchdown, ...], other: tuple[Touchdown, ...]) -> Array:
    """Differences of matched touchdowns, shape (n, 3): time, s, and relative speed and force.

    A touchdown that the other run lacks is infinitely far away.
    """
    rows = [
        [math.inf] * 3
        if twin is None
        else [
            abs(twin.time - own.time),
            abs(twin.closing_speed / own.closing_speed - 1.0),
            abs(twin.peak_force / own.peak_force - 1.0),
        ]
        for own, twin in matched(reference, other)
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
