"""Ideal motion of a linkage: all its joints are closed, over a cycle.

A linkage is followed around its cycle and stored as a table of instants. Between them
quintic polynomials through position, velocity and acceleration predict the motion. If
these positions are not closed to round-off, Newton's method closes them.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.points import Attachment
from presswear.physics.assembly import Levels, assembled, close, stuck
from presswear.physics.constraint_rows import ROUND_OFF, Rows
from presswear.tools.arrays import Array
from presswear.tools.errors import AssemblyError

# Least ``Rows.distance`` from a dead point; for two links nearly in line this distance is
# about half of the sine of the angle between them
NEAREST_DEAD_POINT = 5e-3
_COARSE = 36  # steps in which a cycle is followed first
_NODES = 1440  # steps of the stored motion
_BATCH = 2000  # instants that are closed at once, which bounds the working space
_JUMP = 0.05  # largest difference of a predicted and a computed angle, rad
# Change of a speed over a short step, relative to the greatest speed, that is a jump
_KINK = 0.05
# Round-off of an angle near a place where its drive does not move its point, rad
_ANGLE_NOISE = 1e-9
# Number of halvings of an interval after which the linkage counts as stuck in it
_HALVINGS = 14


@dataclass(frozen=True)
class Motion:
    """Coordinates of all bodies, or of the body of the output point alone, SI and rad.

    Shapes are (n,) and (n, 3 bodies).
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array

    def output(self, linkage: Linkage) -> Array:
        """Return position, velocity and acceleration of the output point, shape (n, 3), m, s."""
        return self.of_point(
            linkage, linkage.output.attachment, linkage.output.direction
        )

    def of_point(self, linkage: Linkage, point: Attachment, direction: float) -> Array:
        """Return position, velocity and acceleration of a point along a direction, rad.

        Shape (n, 3), m, s.
        """
        column = 3 * linkage.index(point.body) if self.position.shape[1] > 3 else 0
        of_body = slice(column, column + 3)
        q = self.position[:, of_body]
        v = self.velocity[:, of_body]
        a = self.acceleration[:, of_body]
        cosine = np.cos(q[:, 2] - direction)
        sine = np.sin(q[:, 2] - direction)
        # The point relative to the mass centre, along the direction and across.
        along = point.x * cosine - point.y * sine
        across = point.x * sine + point.y * cosine
        unit = np.array([math.cos(direction), math.sin(direction)])
        acceleration = a[:, :2] @ unit - a[:, 2] * across - v[:, 2] ** 2 * along
        place = q[:, :2] @ unit + along
        speed = v[:, :2] @ unit - v[:, 2] * across
        return np.column_stack([place, speed, acceleration])


@dataclass(frozen=True, eq=False)
class IdealMotion:
    """The motion of a linkage with all its joints closed, over a cycle that repeats.

    Levels have the shape (nodes + 1, bodies, 3): at equal intervals over the cycle,
    both ends among them. A run-up goes before it.
    """

    rows: Rows
    period: float  # s
    position: Array
    velocity: Array
    acceleration: Array

    @property
    def times(self) -> Array:
        """Instants of the nodes, s."""
        return np.linspace(0.0, self.period, len(self.position))

    def at(self, time: Array, closed: bool = True) -> Motion:
        """Return the motion of every body at some instants, s, to round-off.

        With ``closed`` false it is the motion of the body of the output alone, by the
        polynomials between the nodes, in a thirtieth of the time. Under smooth drives
        positions are then exact to round-off, velocities to 1e-11 of the greatest velocity
        and accelerations to 1e-8 of the greatest acceleration.
        """
        now = np.atleast_1d(np.asarray(time, dtype=float))
        linkage = self.rows.linkage
        bodies = slice(None)
        if not closed:
            index = linkage.index(linkage.output.body)
            bodies = slice(index, index + 1)
        run_up = 0.0
        if linkage.leader is None:
            run_up = 2.0 * linkage.run_up * self.period
        if run_up == 0.0:
            q, v, a = self._in_cycles(now, bodies)
        else:
            from presswear.physics.drive_motion import run_up_motion  # slow import

            motion = np.array([run_up_motion(run_up, t) for t in now])
            after, rate, rise = motion.T[..., np.newaxis, np.newaxis]
            q, v, a = self._in_cycles(after.ravel(), bodies)
            a = a * rate**2 + v * rise
            v = v * rate
        return Motion(now, *(level.reshape(now.size, -1) for level in (q, v, a)))

    def _in_cycles(self, time: Array, bodies: slice) -> Levels:
        """Return the motion at times after the run-up, s; that of all bodies is closed."""
        nodes = len(self.position) - 1
        cycle = np.floor(time / self.period)
        place = (time - cycle * self.period) * nodes / self.period
        node = np.clip(place.astype(int), 0, nodes - 1)
        levels = self.between(node, place - node, bodies)
        turns = self.position[-1, bodies] - self.position[0, bodies]
        levels = levels._replace(q=levels.q + cycle[:, None, None] * turns)
        if bodies == slice(None):
            for batch in np.array_split(np.arange(time.size), 1 + time.size // _BATCH):
                self._close(time, levels, batch)
        return levels

    def _close(self, time: Array, levels: Levels, batch: NDArray[np.int64]) -> None:
        """Close the linkage at those instants of a batch at which errors exceed round-off."""
        scale = self.rows.size / self.period ** np.arange(3.0)[:, np.newaxis]
        errors = self.rows.errors(time[batch], *(level[batch] for level in levels))
        largest = np.array([np.abs(error).max(axis=1) for error in errors])
        rough = batch[(largest > 1e2 * ROUND_OFF * scale).any(axis=0)]
        if rough.size:
            closed = close(self.rows, time[rough], levels.q[rough])
            for level, closed_level in zip(levels, closed, strict=True):
                level[rough] = closed_level

    def between(
        self, node: NDArray[np.int64], fraction: Array, bodies: slice = slice(None)
    ) -> Levels:
        """Return the quintic polynomials from nodes to the next ones, at fractions of a step."""
        h = self.period / (len(self.position) - 1)
        x = fraction[:, None, None]
        q0 = self.position[:, bodies][node]
        v0 = self.velocity[:, bodies][node]
        a0 = self.acceleration[:, bodies][node]
        q1 = self.position[:, bodies][node + 1]
        v1 = self.velocity[:, bodies][node + 1]
        a1 = self.acceleration[:, bodies][node + 1]
        c1 = h * v0
        c2 = 0.5 * h * h * a0
        d0 = q1 - q0 - c1 - c2
        d1 = h * (v1 - v0) - 2.0 * c2
        d2 = h * h * (a1 - a0)
        c3 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2
        c4 = -15.0 * d0 + 7.0 * d1 - d2
        c5 = 6.0 * d0 - 3.0 * d1 + 0.5 * d2
        q = q0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5))))
        v = (c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) / h
        a = (2.0 * c2 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))) / h**2
        return Levels(q, v, a)


@lru_cache(maxsize=256)
def ideal_motion(linkage: Linkage, period: float) -> IdealMotion:
    """Return the motion of a linkage over a cycle, s.

    Raises
    ------
    AssemblyError
        If a loop does not close, at a dead point, or if the linkage does not return to
        its initial position.
    """
    initial = assembled(linkage)
    rows = Rows(linkage, initial)
    start = close(rows, np.zeros(1), initial[np.newaxis])
    coarse = _follow_cycle(rows, start, np.linspace(0.0, period, _COARSE + 1))
    times = np.linspace(0.0, period, _NODES + 1)
    coarse_position = np.linspace(0.0, _COARSE, _NODES + 1)
    node = np.minimum(coarse_position.astype(int), _COARSE - 1)
    predicted = coarse.between(node, coarse_position - node).q
    try:
        motion = IdealMotion(rows, period, *close(rows, times, predicted))
        has_turned = np.any(rows.side(motion.position) != rows.side(start.q))
        is_near = _is_near(motion.position, predicted) and not has_turned
    except AssemblyError:  # Newton's method diverges from a poor prediction.
        is_near = False
    if not is_near:
        motion = _follow_cycle(rows, start, times)
    q = motion.position
    distance = rows.distance(q)
    worst = int(distance.argmin())
    # If points follow curves, ``_follow_cycle`` has already checked for dead points.
    if not (rows.following or distance[worst] > NEAREST_DEAD_POINT):
        raise stuck(rows, times[worst : worst + 1], q[worst : worst + 1])
    change = q[-1] - q[0]
    change[:, 2] -= 2.0 * math.pi * np.round(change[:, 2] / (2.0 * math.pi))
    off = np.abs(change).max(axis=1)
    if off.max() > 1e-6:
        raise AssemblyError(
            f"the linkage does not come back: after a cycle of {period:.6g} s "
            f"{linkage.bodies[int(off.argmax())].name} is elsewhere; the speeds of the drives, or "
            "the cycle, do not fit"
        )
    return motion


def _is_near(result: Array, expected: Array) -> bool:
    """Return whether all angles are near the expected ones."""
    return bool(np.abs(result - expected)[..., 2].max() < _JUMP)


def _predict_each_other(start: Levels, end: Levels, h: float) -> bool:
    """Return whether the angles at both ends of a step, s, are predicted from the other end."""
    allowed = _KINK * h * float(np.abs(start.v[..., 2]).max()) + _ANGLE_NOISE
    backward = end.q - h * (end.v - 0.5 * h * end.a)
    forward = start.q + h * (start.v + 0.5 * h * start.a)
    error = np.maximum(np.abs(end.q - forward), np.abs(start.q - backward))
    return bool(error[..., 2].max() < allowed)


def _follow_cycle(rows: Rows, start: Levels, times: Array) -> IdealMotion:
    """Compute the motion from one instant to the next, with a step that is adapted.

    The step is halved after a failure and doubled after a success. If points follow
    curves, each of the two states of a step must predict the other one. Two motions
    meet at a position in which the drive does not move its point, and only one of them
    continues at the same speed.
    """
    result = [start]
    side = rows.side(start.q)
    for before, time in pairwise(map(float, times)):
        levels = result[-1]
        now = before
        step = time - before
        while now < time:
            predicted = levels.q + step * (levels.v + 0.5 * step * levels.a)
            end = min(now + step, time)
            try:
                reached = close(rows, np.array([end]), predicted)
                is_same_side = rows.side(reached.q) == side
                is_near = bool(_is_near(reached.q, predicted) and is_same_side)
                if rows.following:
                    is_near = is_near and _predict_each_other(
                        levels, reached, end - now
                    )
            except AssemblyError:
                is_near = False
            if is_near:
                levels = reached
                now = end
                step = 2.0 * step
            elif step < (time - before) / 2.0**_HALVINGS:
                raise stuck(rows, np.array([now]), levels.q)
            else:
                step *= 0.5
        result.append(levels)
    return IdealMotion(
        rows, float(times[-1]), *map(np.concatenate, zip(*result, strict=True))
    )
