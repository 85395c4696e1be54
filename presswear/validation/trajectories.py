"""Trajectories of runs, and the distances between two of them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from presswear.engines.base import Run
from presswear.tools.arrays import Array
from presswear.validation.cases import contacts_of, finished

GRID = 2001  # common times at which series are compared


@dataclass(frozen=True)
class Touchdown:
    """Start of a contact: its time, s, closing speed, m/s, and the peak force of the contact, N."""

    joint: int
    time: float
    closing_speed: float
    peak_force: float


@dataclass(frozen=True)
class Trajectory:
    """Recorded series that are compared."""

    time: Array  # s, shape (n,)
    slider: Array  # position along the recorded direction, m, and velocity, m/s; shape (n, 2)
    eccentricity: Array  # m, shape (n, 2 joints)
    touchdowns: tuple[Touchdown, ...]  # in the order of their times

    def slider_at(self, time: Array) -> tuple[Array, Array]:
        """Return position, m, and velocity, m/s, at specified times."""
        cubic = CubicHermiteSpline(self.time, self.slider[:, 0], self.slider[:, 1])
        return cubic(time), cubic.derivative()(time)


@dataclass(frozen=True)
class Difference:
    """Distance of the slider from the reference over time, m."""

    label: str
    time: Array
    slider: Array


def touchdowns_of(run: Run) -> tuple[Touchdown, ...]:
    """Return the touchdowns of all recorded contacts, and of those that last to the end."""
    touchdowns, records = [], run.recorder.records
    for k, last in enumerate(records.memory):
        columns = ("touchdown", "closing_speed", "peak_force")
        contacts = contacts_of(run, k)
        rows = np.column_stack([contacts[name] for name in columns]).tolist()
        if records.onset[k] > 0.0 and not last["started_closed"]:
            rows.append(map(float, (last["touchdown_time"], records.onset[k], last["peak_force"])))
        touchdowns += [Touchdown(k, *row) for row in rows]
    return tuple(sorted(touchdowns, key=lambda touchdown: touchdown.time))


def trajectory_of(run: Run) -> Trajectory:
    """Copy the series that are compared; RunFailed if the run failed."""
    recorder = finished(run).recorder
    # The series holds displacements, and a disturbed initial state is displaced already.
    position = recorder.series("displacement") + float(recorder.records.output["start"][0])
    eccentricity = [
        recorder.series(name, k)
        for k in range(recorder.records.memory.size)
        for name in ("eccentricity_x", "eccentricity_y")
    ]
    return Trajectory(
        recorder.series("time").copy(),
        np.column_stack([position, recorder.series("velocity")]),
        np.array(eccentricity).reshape(-1, position.size).T,
        touchdowns_of(run),
    )


def common_times(one: Trajectory, two: Trajectory) -> Array:
    """Return evenly spaced times in both trajectories, s."""
    return np.linspace(0.0, min(one.time[-1], two.time[-1]), GRID)


def slider_difference(label: str, one: Trajectory, two: Trajectory) -> Difference:
    """Return the distance of two sliders over time."""
    time = common_times(one, two)
    return Difference(label, time, np.abs(one.slider_at(time)[0] - two.slider_at(time)[0]))


def velocity_difference(reference: Trajectory, compared: Trajectory, end: float) -> float:
    """Return the largest difference of slider velocity up to a time, s, relative to the largest."""
    time = common_times(reference, compared)
    time = time[time <= end]
    difference = compared.slider_at(time)[1] - reference.slider_at(time)[1]
    return float(np.abs(difference).max() / np.abs(reference.slider[:, 1]).max())


def matched(
    reference: tuple[Touchdown, ...], compared: tuple[Touchdown, ...]
) -> Iterator[tuple[Touchdown, Touchdown | None]]:
    """Yield each reference touchdown with that of the same number in the same joint, if any."""
    joints = {touchdown.joint for touchdown in reference}
    queues = {k: iter([each for each in compared if each.joint == k]) for k in joints}
    for touchdown in reference:
        yield touchdown, next(queues[touchdown.joint], None)


def touchdown_differences(
    reference: tuple[Touchdown, ...], compared: tuple[Touchdown, ...]
) -> Array:
    """Return the differences of matched touchdowns, shape (n, 3).

    They are time, s, and relative closing speed and peak force; infinite for a touchdown that the
    compared run lacks.
    """
    rows = [
        [math.inf] * 3
        if twin is None
        else [
            abs(twin.time - each.time),
            abs(twin.closing_speed / each.closing_speed - 1.0),
            abs(twin.peak_force / each.peak_force - 1.0),
        ]
        for each, twin in matched(reference, compared)
    ]
    return np.array(rows).reshape(-1, 3)


def divergence_time(one: Trajectory, two: Trajectory, distance: float) -> float | None:
    """Return the time, s, at which slider or eccentricities first differ by a distance, m."""
    time = common_times(one, two)
    largest = slider_difference("", one, two).slider
    for first, second in zip(one.eccentricity.T, two.eccentricity.T, strict=True):
        between = np.interp(time, one.time, first) - np.interp(time, two.time, second)
        largest = np.maximum(largest, np.abs(between))
    late = np.flatnonzero(largest >= distance)
    return float(time[late[0]]) if late.size else None
