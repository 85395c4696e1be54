"""The ideal motion of a linkage, all its joints closed, over its cycle.

A linkage is followed around its cycle and kept as a table of instants.  Between them its motion
is predicted by the quintic polynomials through position, velocity and acceleration; where those
do not close to round-off, Newton's method makes them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import run_up_motion
from presswear.linkage.linkage import Linkage
from presswear.physics.assembly import ROUND_OFF, Levels, assembled, closed, stuck
from presswear.physics.rows import Rows
from presswear.tools.errors import AssemblyError

Array = NDArray[np.float64]

NEAREST_DEAD_POINT = 5e-3
"""Least measure of how far the joints are from a dead point; of two links in line it is some
half of the sine of the angle between them."""
_COARSE, _NODES = 36, 1440
"""Instants of a cycle at which it is followed, and at which its motion is kept."""
_JUMP = 0.05
"""Largest turn, rad, between where a body is expected and where it is found."""
_KINK = 0.05
"""Change of a speed over a short step, part of the greatest speed, that is a jump."""
_ANGLE_NOISE = 1e-9
"""Round-off of an angle near a place where its drive does not move its point, rad."""
_HALVINGS = 14
"""How often an interval is halved before the linkage is said to stop in it."""


@dataclass(frozen=True)
class Motion:
    """Coordinates of all bodies over time, shapes (n,) and (n, 3 bodies), SI and rad."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array

    def output(self, linkage: Linkage) -> Array:
        """Place, velocity and acceleration of what a linkage watches, shape (n, 3), m, s."""
        probe = linkage.output
        column = 3 * linkage.index(probe.body)
        own = slice(column, column + 3)
        q, v, a = (level[:, own] for level in (self.position, self.velocity, self.acceleration))
        cosine, sine = np.cos(q[:, 2] - probe.direction), np.sin(q[:, 2] - probe.direction)
        # The point relative to the mass centre, along the direction and across.
        along, across = probe.x * cosine - probe.y * sine, probe.x * sine + probe.y * cosine
        unit = np.array([math.cos(probe.direction), math.sin(probe.direction)])
        return np.column_stack(
            [
                q[:, :2] @ unit + along,
                v[:, :2] @ unit - v[:, 2] * across,
                a[:, :2] @ unit - a[:, 2] * across - v[:, 2] ** 2 * along,
            ]
        )


@dataclass(frozen=True, eq=False)
class IdealMotion:
    """The motion of a linkage with all its joints closed, over a cycle that repeats.

    A run-up goes before it.

    Attributes
    ----------
    period : float
        s.
    position, velocity, acceleration : ndarray, shape (nodes + 1, bodies, 3)
        At equal intervals over the cycle, both ends among them.
    """

    rows: Rows
    period: float
    position: Array
    velocity: Array
    acceleration: Array

    @property
    def times(self) -> Array:
        """Instants of the nodes, s."""
        return np.linspace(0.0, self.period, len(self.position))

    def at(self, time: Array) -> Motion:
        """Motion of every body at some instants, s, to round-off."""
        return self._moved(time, self._closed)

    def interpolated(self, time: Array) -> Motion:
        """Motion of every body at some instants, s, by the polynomials through the nodes.

        Where what drives it is smooth, positions are known to round-off, velocities to 1e-11 of
        the greatest and accelerations to 1e-8, in a tenth of the time.
        """
        return self._moved(time, lambda time, levels: levels)

    def _moved(self, time: Array, closer: Callable[[Array, Levels], Levels]) -> Motion:
        """Motion at some instants, made better by ``closer``."""
        now = np.atleast_1d(np.asarray(time, dtype=float))
        duration = 2.0 * self.rows.linkage.run_up * self.period
        time, rate, rise = run_up_motion(now, duration)
        cycle = np.floor(time / self.period)
        within = time - cycle * self.period
        nodes = len(self.position) - 1
        place = np.clip((within / self.period * nodes).astype(int), 0, nodes - 1)
        q, v, a = self._between(place, within * nodes / self.period - place)
        q = q + cycle[:, None, None] * (self.position[-1] - self.position[0])
        q, v, a = closer(time, Levels(q, v, a))
        if duration > 0.0:
            rate, rise = rate[:, np.newaxis, np.newaxis], rise[:, np.newaxis, np.newaxis]
            a = a * rate**2 + v * rise
            v = v * rate
        flat = (level.reshape(time.size, -1) for level in (q, v, a))
        return Motion(now, *flat)

    def _closed(self, time: Array, levels: Levels) -> Levels:
        """Close the linkage wherever round-off can be seen."""
        q, v, a = levels
        for some in np.array_split(np.arange(time.size), 1 + time.size // 2000):
            own = (time[some], q[some], v[some], a[some])
            off = [np.abs(level).max(axis=1) for level in self.rows.errors(*own)]
            scale = self.rows.size * np.array([1.0, 1.0 / self.period, 1.0 / self.period**2])
            far = [own > 1e2 * ROUND_OFF * unit for own, unit in zip(off, scale, strict=True)]
            rough = some[np.any(far, axis=0)]
            if rough.size:
                q[rough], v[rough], a[rough] = closed(self.rows, time[rough], q[rough])
        return levels

    def _ahead(self, nodes: int) -> Array:
        """Positions predicted at equal intervals of the cycle, shape (nodes + 1, bodies, 3)."""
        part = np.linspace(0.0, len(self.position) - 1, nodes + 1)
        place = np.minimum(part.astype(int), len(self.position) - 2)
        return self._between(place, part - place)[0]

    def _between(self, place: NDArray[np.int64], part: Array) -> Levels:
        """The quintic polynomials through two nodes, a part of the way from one to the next."""
        h = self.period / (len(self.position) - 1)
        x = part[:, None, None]
        q0, v0, a0 = (level[place] for level in (self.position, self.velocity, self.acceleration))
        q1, v1, a1 = (
            level[place + 1] for level in (self.position, self.velocity, self.acceleration)
        )
        c1, c2 = h * v0, 0.5 * h * h * a0
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
    """The motion of a linkage over a cycle.

    Parameters
    ----------
    period : float
        s.

    Raises
    ------
    AssemblyError
        Where it does not close, is at a dead point or does not come back.
    """
    begun = assembled(linkage)
    rows = Rows(linkage, begun)
    start = closed(rows, np.zeros(1), begun[np.newaxis])
    coarse = _followed(rows, start, np.linspace(0.0, period, _COARSE + 1))
    ahead = coarse._ahead(_NODES)
    times = np.linspace(0.0, period, _NODES + 1)
    try:
        motion = IdealMotion(rows, period, *closed(rows, times, ahead))
        is_near = _near(motion.position, ahead)
        is_near = is_near and not np.any(rows.side(motion.position) != rows.side(start.q))
    except AssemblyError:  # Newton's method strays from a place that is predicted badly.
        is_near = False
    if not is_near:
        motion = _followed(rows, start, times)
    _check(motion)
    return motion


def _near(found: Array, expected: Array) -> bool:
    return bool(np.abs(found - expected)[..., 2].max() < _JUMP)


def _followed(rows: Rows, start: Levels, times: Array) -> IdealMotion:
    """Follow a linkage from one instant to the next, in shorter steps where it turns fast.

    A step is halved where it fails, and doubled behind one that succeeds.
    """
    found = [start]
    side = rows.side(start.q)
    for before, time in pairwise(map(float, times)):
        levels, now, step = found[-1], before, time - before
        while now < time:
            ahead = levels.q + step * (levels.v + 0.5 * step * levels.a)
            there = min(now + step, time)
            try:
                reached = closed(rows, np.array([there]), ahead)
                is_near = bool(_near(reached.q, ahead) and rows.side(reached.q) == side)
                if rows.follows:
                    is_near = is_near and _is_smooth(levels, reached, there - now)
            except AssemblyError:
                is_near = False
            if is_near:
                levels, now, step = reached, there, 2.0 * step
            elif step < (time - before) / 2.0**_HALVINGS:
                raise stuck(rows, np.array([now]), levels.q)
            else:
                step *= 0.5
        found.append(levels)
    return IdealMotion(
        rows, float(times[-1]), *(np.concatenate(own) for own in zip(*found, strict=True))
    )


def _is_smooth(one: Levels, other: Levels, step: float) -> bool:
    """True where each of two states, a step apart, foretells the other.

    At a position in which a drive does not move its point two motions meet, and only one goes on
    at the same speed.
    """
    allowed = _KINK * abs(step) * float(np.abs(one.v[..., 2]).max()) + _ANGLE_NOISE
    ahead = one.q + step * (one.v + 0.5 * step * one.a)
    back = other.q - step * (other.v - 0.5 * step * other.a)
    off = np.maximum(np.abs(other.q - ahead), np.abs(one.q - back))
    return bool(off[..., 2].max() < allowed)


def _check(motion: IdealMotion) -> None:
    """Raise AssemblyError for a cycle that comes too near a dead point or does not come back."""
    rows = motion.rows
    scale = np.ones((rows.bodies, 3))
    scale[:, 2] = 1.0 / rows.sizes
    inverse = np.linalg.inv(rows.jacobian(motion.position) * scale.ravel())
    measure = 1.0 / np.sqrt((inverse**2).sum(axis=(1, 2)))
    worst = int(measure.argmin())
    # Where points follow curves, those of the joints are seen when the motion is found.
    if not (rows.follows or measure[worst] > NEAREST_DEAD_POINT):
        raise stuck(rows, motion.times[worst : worst + 1], motion.position[worst : worst + 1])
    turned = motion.position[-1] - motion.position[0]
    turned[:, 2] -= 2.0 * math.pi * np.round(turned[:, 2] / (2.0 * math.pi))
    off = np.abs(turned).max(axis=1)
    if off.max() > 1e-6:
        body = rows.linkage.bodies[int(off.argmax())].name
        raise AssemblyError(
            f"the linkage does not come back: after a cycle of {motion.period:.6g} s {body} is "
            "elsewhere; the speeds of the drives, or the cycle, do not fit"
        )
