"""Assembly and ideal motion of any linkage, by Newton's method on its constraint rows.

A linkage is put together once from a rough guess, followed over its cycle, and kept as a table
of instants.  Between them its motion is predicted by the quintic polynomials through position,
velocity and acceleration; where those do not close to round-off, Newton's method makes them.
All equations are those of ``physics.constraints``, here for many instants at once.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Attachment, Linkage, Probe
from presswear.linkage.mechanism import Mechanism
from presswear.linkage.motions import LEAST_PIECE, MOST_PIECES, Drive, run_up_motion, series
from presswear.tools.errors import AssemblyError

Array = NDArray[np.float64]

NEAREST_DEAD_POINT = 5e-3
"""Least measure of how far the joints are from a dead point; of two links in line it is some
half of the sine of the angle between them."""
ROUND_OFF = 4e-15
"""Error of a row that is round-off, part of the size of the linkage."""

FOLLOWED = 1e-9
"""How near a point keeps to the curve that it follows, part of its stroke."""
_PIECES = 32, 64, 128
"""Of the motion of a drive whose point follows a curve; at last as many as there may be."""
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
_STEPS = 40
"""Most Newton steps from a guess."""


@dataclass(frozen=True)
class Motion:
    """Coordinates of all bodies over time, shapes (n,) and (n, 3 bodies), SI and rad."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array

    def watched(self, linkage: Linkage) -> Array:
        """Place, velocity and acceleration of what a linkage watches, shape (n, 3), m, s."""
        probe = linkage.probe
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


class _Ends:
    """One end of each pin joint: its body's place and its coordinates in that body's frame, m."""

    def __init__(self, linkage: Linkage, ends: list[Attachment]) -> None:
        count = len(linkage.bodies)
        # The frame stands behind the bodies, at rest.
        self.body = np.array(
            [count if end.body == GROUND else linkage.index(end.body) for end in ends], dtype=int
        )
        self.x, self.y = (np.array([getattr(end, axis) for end in ends]) for axis in "xy")

    def lever(self, q: Array) -> Array:
        """From the mass centres to the ends in global directions, shape (n, joints, 2), m."""
        angle = q[:, self.body, 2]
        cosine, sine = np.cos(angle), np.sin(angle)
        return np.stack([cosine * self.x - sine * self.y, sine * self.x + cosine * self.y], axis=-1)


class Rows:
    """The constraint rows of a linkage, evaluated at many instants.

    Coordinates have the shape (n, bodies, 3).  Rows come in the order of
    ``physics.constraints``: two for each pin joint, two for each guide, one for each drive.  That
    of a drive whose point follows a curve holds the point on the curve, in place of the angle.
    Times are those behind a run-up.

    Attributes
    ----------
    names : tuple of str
        Joint, guide or drive behind each row.
    pairs : tuple of (int, int)
        Places of the two bodies of each pin joint; the frame's is behind the last body.
    sizes : ndarray, shape (bodies,)
        Greatest distance of a joint of each body from its mass centre, m.
    size : float
        The greatest of them, m.
    """

    def __init__(self, linkage: Linkage) -> None:
        self.linkage = linkage
        self.bodies = len(linkage.bodies)
        joints = linkage.revolutes
        self._first = _Ends(linkage, [joint.first for joint in joints])
        self._second = _Ends(linkage, [joint.second for joint in joints])
        guides, drives = linkage.guides, linkage.drives
        self._guided = np.array([linkage.index(guide.body) for guide in guides], dtype=int)
        self._on = np.array([[guide.x, guide.y] for guide in guides]).reshape(-1, 2)
        self._across = np.array(
            [[-math.sin(guide.direction), math.cos(guide.direction)] for guide in guides]
        ).reshape(-1, 2)
        self._held = np.array([guide.angle for guide in guides])
        self._driven = np.array([linkage.index(drive.body) for drive in drives], dtype=int)
        following = [k for k, drive in enumerate(drives) if drive.follow is not None]
        self._following = np.array(following, dtype=int)
        probes = [_probe(drives[k]) for k in following]
        self._points = _Ends(linkage, [Attachment(own.body, own.x, own.y) for own in probes])
        self._along = np.array(
            [[math.cos(own.direction), math.sin(own.direction)] for own in probes]
        ).reshape(-1, 2)
        self._begun = np.zeros(len(following))
        if following:
            start = assembled(_leading(linkage))[np.newaxis]
            self._begun = self.coordinates(start)[0]
        self.names = (
            *(joint.name for joint in joints for _ in range(2)),
            *(guide.name for guide in guides for _ in range(2)),
            *(drive.name for drive in drives),
        )
        sizes = np.zeros(self.bodies + 1)
        for end in (self._first, self._second):
            np.maximum.at(sizes, end.body, np.hypot(end.x, end.y))
        self.size = float(sizes.max(initial=0.0)) or 1.0
        self.pairs = tuple(zip(self._first.body, self._second.body, strict=True))
        self.sizes = np.where(sizes[:-1] > 0.0, sizes[:-1], self.size)

    def errors(self, time: Array, *given: Array) -> list[Array]:
        """Phi and as many of its derivatives in time as are asked for, each (n, rows).

        Parameters
        ----------
        given : ndarray, shape (n, bodies, 3)
            Coordinates, and their first and second derivatives.
        """
        count = len(time)
        still = np.zeros((count, 1, 3))
        levels = [np.concatenate([level, still], axis=1) for level in given]
        turned = np.array([_given(drive, time) for drive in self.linkage.drives])
        turned = turned.reshape(-1, 3, count)
        turned[self._following, 0] += self._begun[:, np.newaxis]
        found = []
        all_ends = (self._first, self._second, self._points)
        levers = [end.lever(levels[0]) for end in all_ends]
        for level, own in enumerate(levels):
            ends = []
            for end, lever in zip(all_ends, levers, strict=True):
                body = end.body
                left = np.stack([-lever[..., 1], lever[..., 0]], axis=-1)
                moved = own[:, body, :2]
                moved = moved + (lever if level == 0 else own[:, body, 2:] * left)
                if level == 2:
                    moved = moved - levels[1][:, body, 2:] ** 2 * lever
                ends.append(moved)
            driven = own[:, self._driven, 2]
            driven[:, self._following] = (ends[2] * self._along).sum(axis=-1)
            held = own[:, self._guided]
            off = held[..., :2] - (self._on if level == 0 else 0.0)
            tilted = held[..., 2] - (self._held if level == 0 else 0.0)
            guides = np.stack([(off * self._across).sum(axis=-1), tilted], axis=-1)
            found.append(
                np.concatenate(
                    [
                        (ends[0] - ends[1]).reshape(count, -1),
                        guides.reshape(count, -1),
                        driven - turned[:, level].T,
                    ],
                    axis=1,
                )
            )
        return found

    @property
    def follows(self) -> bool:
        """True where points follow curves."""
        return self._following.size > 0

    def coordinates(self, q: Array) -> Array:
        """Coordinates of the points that follow curves, along their directions, (n, points), m."""
        places = q[:, self._points.body, :2] + self._points.lever(q)
        return np.asarray((places * self._along).sum(axis=-1))

    def off_curves(self, time: Array, q: Array) -> Array:
        """How far points are from the curves that they follow, shape (n, points), m."""
        curves = [_given(self.linkage.drives[k], time)[0] for k in self._following]
        return self.coordinates(q) - self._begun - np.transpose(curves)

    def jacobian(self, q: Array) -> Array:
        """Derivatives of the rows by the coordinates, shape (n, rows, 3 bodies)."""
        count, joints = len(q), len(self._first.body)
        q = np.concatenate([q, np.zeros((count, 1, 3))], axis=1)
        found = np.zeros((count, len(self.names), self.bodies + 1, 3))
        rows = 2 * np.arange(joints)
        for end, sign in ((self._first, 1.0), (self._second, -1.0)):
            lever = end.lever(q)
            for axis in (0, 1):
                found[:, rows + axis, end.body, axis] += sign
            found[:, rows, end.body, 2] -= sign * lever[..., 1]
            found[:, rows + 1, end.body, 2] += sign * lever[..., 0]
        rows = 2 * (joints + np.arange(len(self._guided)))
        found[:, rows, self._guided, :2] = self._across
        found[:, rows + 1, self._guided, 2] = 1.0
        drives = len(self.names) - len(self._driven) + np.arange(len(self._driven))
        found[:, drives, self._driven, 2] = 1.0
        if self._following.size:
            following, body, along = drives[self._following], self._points.body, self._along
            lever = self._points.lever(q)
            found[:, following] = 0.0
            found[:, following, body, :2] = along
            found[:, following, body, 2] = lever[..., 0] * along[:, 1] - lever[..., 1] * along[:, 0]
        return found[:, :, : self.bodies].reshape(count, len(self.names), -1)

    def side(self, q: Array) -> Array:
        """On which side of its dead points the linkage is, shape (n,), 1 or -1.

        1 where points follow curves: a drive may pass a position in which it does not move its
        point, where the curve leads through it.
        """
        if self.follows:
            return np.ones(len(q))
        return np.asarray(np.linalg.slogdet(self.jacobian(q))[0])


def _probe(drive: Drive) -> Probe:
    """The point that follows a curve."""
    assert drive.follow is not None
    assert isinstance(drive.follow.point, Probe), "a linkage has found it"
    return drive.follow.point


def _given(drive: Drive, time: Array) -> tuple[Array, Array, Array]:
    """What is given of a drive, with two derivatives: an angle, or the way of what follows."""
    if drive.follow is None:
        return drive.motion(time)
    return series(drive.follow, drive.base, time)


def _leading(linkage: Linkage) -> Linkage:
    """A linkage at its start: what follows a curve stands where its drive has it."""
    if not _followers(linkage):
        return linkage
    return replace(linkage, drives=[replace(drive, follow=None) for drive in linkage.drives])


def _followers(linkage: Linkage) -> list[Drive]:
    return [drive for drive in linkage.drives if drive.follow is not None]


def check_freedoms(linkage: Linkage) -> None:
    """Raise AssemblyError unless joints, guides and drives hold each body just once."""
    rows = 2 * len(linkage.revolutes) + 2 * len(linkage.guides) + len(linkage.drives)
    free = 3 * len(linkage.bodies) - rows
    told = (
        f"{len(linkage.bodies)} bodies have {3 * len(linkage.bodies)} coordinates; joints, guides "
        f"and drives hold {rows}"
    )
    if free > 0:
        raise AssemblyError(f"the linkage is free to move: {told}; {free} drives are missing")
    if free < 0:
        raise AssemblyError(f"the linkage is overconstrained: {told}, {-free} too many")


def guessed(linkage: Linkage) -> Array:
    """Coordinates to start Newton's method from, shape (bodies, 3).

    Angles are those of the drives, of the guides, as guessed, or 0; each body hangs by the first
    joint that reaches it.
    """
    q = np.zeros((len(linkage.bodies), 3))
    angles = dict(linkage.guess)
    angles |= {guide.body: guide.angle for guide in linkage.guides}
    angles |= {drive.body: drive.angle for drive in linkage.drives}
    for place, body in enumerate(linkage.bodies):
        q[place, 2] = angles.get(body.name, 0.0)
    reached = {GROUND}

    def where(end: Attachment) -> Array:
        local = np.array([end.x, end.y])
        if end.body == GROUND:
            return local
        x, y, angle = q[linkage.index(end.body)]
        cosine, sine = math.cos(angle), math.sin(angle)
        turned = cosine * end.x - sine * end.y, sine * end.x + cosine * end.y
        return np.array([x + turned[0], y + turned[1]])

    waiting = [*linkage.revolutes]
    while waiting:
        hung = False
        for joint in tuple(waiting):
            known, loose = joint.first, joint.second
            if known.body not in reached:
                known, loose = loose, known
            if known.body in reached and loose.body not in reached:
                place = linkage.index(loose.body)
                q[place, :2] += where(known) - where(loose)
                reached.add(loose.body)
                hung = True
            if {known.body, loose.body} <= reached:
                waiting.remove(joint)
        if not hung:
            break
    for guide in linkage.guides:
        place = linkage.index(guide.body)
        along = np.array([math.cos(guide.direction), math.sin(guide.direction)])
        point = np.array([guide.x, guide.y])
        q[place, :2] = point + along * ((q[place, :2] - point) @ along)
    return q


@dataclass(frozen=True)
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
        """Motion of every body at some instants, s."""
        now = np.atleast_1d(np.asarray(time, dtype=float))
        duration = 2.0 * self.rows.linkage.run_up * self.period
        time, rate, rise = run_up_motion(now, duration)
        cycle = np.floor(time / self.period)
        within = time - cycle * self.period
        nodes = len(self.position) - 1
        place = np.clip((within / self.period * nodes).astype(int), 0, nodes - 1)
        q, v, a = self._between(place, within * nodes / self.period - place)
        q = q + cycle[:, None, None] * (self.position[-1] - self.position[0])
        for some in np.array_split(np.arange(time.size), 1 + time.size // 2000):
            own = (time[some], q[some], v[some], a[some])
            off = [np.abs(level).max(axis=1) for level in self.rows.errors(*own)]
            scale = self.rows.size * np.array([1.0, 1.0 / self.period, 1.0 / self.period**2])
            far = [own > 1e2 * ROUND_OFF * unit for own, unit in zip(off, scale, strict=True)]
            rough = some[np.any(far, axis=0)]
            if rough.size:
                q[rough], v[rough], a[rough] = closed(self.rows, time[rough], q[rough])
        if duration > 0.0:
            rate, rise = rate[:, np.newaxis, np.newaxis], rise[:, np.newaxis, np.newaxis]
            a = a * rate**2 + v * rise
            v = v * rate
        flat = (level.reshape(time.size, -1) for level in (q, v, a))
        return Motion(now, *flat)

    def _ahead(self, nodes: int) -> Array:
        """Positions predicted at equal intervals of the cycle, shape (nodes + 1, bodies, 3)."""
        part = np.linspace(0.0, len(self.position) - 1, nodes + 1)
        place = np.minimum(part.astype(int), len(self.position) - 2)
        return self._between(place, part - place)[0]

    def _between(self, place: NDArray[np.int64], part: Array) -> "_Levels":
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
        return _Levels(q, v, a)


class _Levels(NamedTuple):
    """Position, velocity and acceleration of all bodies, each (n, bodies, 3)."""

    q: Array
    v: Array
    a: Array


def closed(rows: Rows, time: Array, q: Array) -> _Levels:
    """Close a linkage at some instants from positions close by; position, velocity, acceleration.

    Raises
    ------
    AssemblyError
        Where it does not close; names the joint and the crank angle.
    """
    shape, zero = q.shape, np.zeros_like(q)
    least = math.inf
    for _ in range(_STEPS):
        (phi,) = rows.errors(time, q)
        error = float(np.abs(phi).max(initial=0.0))
        if not error < 1e3 * rows.size:
            break
        # Round-off does not shrink any more.
        if error <= ROUND_OFF * rows.size or (error < 1e-12 * rows.size and error >= 0.5 * least):
            break
        least = min(least, error)
        q = q - _solved(rows, time, q, phi).reshape(shape)
    else:
        error = math.inf
    if not error < 1e-9 * rows.size:
        raise _open(rows, time, q)
    v = -_solved(rows, time, q, rows.errors(time, q, zero)[1]).reshape(shape)
    a = -_solved(rows, time, q, rows.errors(time, q, v, zero)[2]).reshape(shape)
    return _Levels(q, v, a)


def _solved(rows: Rows, time: Array, q: Array, right: Array) -> Array:
    """Solve J x = right at each instant."""
    try:
        return np.asarray(np.linalg.solve(rows.jacobian(q), right[..., None])[..., 0])
    except np.linalg.LinAlgError:
        raise _stuck(rows, time, q) from None


def _open(rows: Rows, time: Array, q: Array) -> AssemblyError:
    """The error of a linkage that does not close: the joint that stays open, and where."""
    phi = np.abs(rows.errors(time, q)[0])
    phi = np.where(np.isfinite(phi), phi, math.inf)
    instant = int(phi.max(axis=1).argmax())
    return _refusal(rows, float(time[instant]), rows.names[int(phi[instant].argmax())])


def _stuck(rows: Rows, time: Array, q: Array) -> AssemblyError:
    """The error of a linkage that is held twice in some direction and not at all in another."""
    # Metres and radians are made comparable by the size of each body.
    scale = np.ones((rows.bodies, 3))
    scale[:, 2] = 1.0 / rows.sizes
    _, values, right = np.linalg.svd(rows.jacobian(q) * scale.ravel())
    worst = int(values[:, -1].argmin())
    # The motion that nothing holds: the joint whose bodies turn most against each other.
    free = np.append((right[worst, -1].reshape(-1, 3) * scale)[:, 2], 0.0)
    turning = {
        joint.name: abs(free[one] - free[other])
        for joint, (one, other) in zip(rows.linkage.revolutes, rows.pairs, strict=True)
    }
    # Of several that turn alike the last: it is farther from the drives.
    names = list(turning)[::-1] or [*rows.names]
    return _refusal(rows, float(time[worst]), max(names, key=lambda name: turning.get(name, 0.0)))


def _refusal(rows: Rows, time: float, joint: str) -> AssemblyError:
    where = ""
    for drive in [own for own in rows.linkage.drives if own.follow is None][:1]:
        turned = float(drive.motion(np.array([time]))[0][0]) - drive.angle
        where = f"at crank angle {math.degrees(abs(turned)):.1f} deg "
    for drive in _followers(rows.linkage):
        return AssemblyError(
            f"{drive.name} cannot make its point follow the curve: {where}({time:.6g} s after the "
            "start) the point is out of reach, or the drive at a dead point"
        )
    return AssemblyError(
        f"the linkage cannot be assembled over the cycle: {where}joint {joint} does not close or "
        "is at a dead point"
    )


def assembled(linkage: Linkage) -> Array:
    """Put a linkage together at its start, shape (bodies, 3).

    Raises
    ------
    AssemblyError
        Where it does not close, or closes more than a right angle from what was guessed.
    """
    linkage = _leading(linkage)
    check_freedoms(linkage)
    rows = Rows(linkage)
    start = np.zeros(1)
    q, guess = guessed(linkage)[np.newaxis], dict(linkage.guess)

    def error_of(q: Array) -> float:
        return float(np.linalg.norm(rows.errors(start, q)[0]))

    for _ in range(_STEPS):
        error = error_of(q)
        if error < 1e-9 * rows.size:
            break
        step = -_solved(rows, start, q, rows.errors(start, q)[0]).reshape(q.shape)
        # No body turns by more than half a radian at once: the guess says on which side it is.
        part = min(1.0, 0.5 / max(float(np.abs(step[..., 2]).max()), 1e-300))
        while part > 1e-3 and error_of(q + part * step) > error:
            part *= 0.5
        q = q + part * step
    q = closed(rows, start, q)[0]
    given = {drive.body for drive in linkage.drives} | {guide.body for guide in linkage.guides}
    for place, body in enumerate(linkage.bodies):
        if body.name not in given:
            turns = (q[0, place, 2] - guess.get(body.name, 0.0)) / (2.0 * math.pi)
            q[0, place, 2] -= 2.0 * math.pi * np.round(turns)
    for name, angle in guess.items():
        found = float(q[0, linkage.index(name), 2])
        if abs(found - angle) > 0.5 * math.pi and name not in given:
            raise AssemblyError(
                f"guess of {name} = {angle:.4g} rad: the linkage closes with it at {found:.4g} "
                "rad; a guess within a right angle of the place that is meant is needed"
            )
    return np.asarray(q[0])


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
    rows = Rows(linkage)
    start = closed(rows, np.zeros(1), assembled(linkage)[np.newaxis])
    coarse = _followed(rows, start, np.linspace(0.0, period, _COARSE + 1))
    ahead = coarse._ahead(_NODES)
    motion = IdealMotion(rows, period, *closed(rows, np.linspace(0.0, period, _NODES + 1), ahead))
    if not _near(motion.position, ahead) or np.any(
        rows.side(motion.position) != rows.side(start.q)
    ):
        motion = _followed(rows, start, motion.times)
    _check(motion)
    return motion


def motion_of(mechanism: Mechanism | Linkage) -> IdealMotion:
    """The ideal motion of a mechanism; AssemblyError where it has none."""
    return ideal_motion(followed(mechanism.linkage()), mechanism.period)


@lru_cache(maxsize=64)
def followed(linkage: Linkage) -> Linkage:
    """A linkage in which the motion is found of each drive whose point follows a curve.

    The linkage is followed around its cycle with the points on their curves; the angles of
    the drives become tables of degree 5, fine enough for ``FOLLOWED``.

    Raises
    ------
    AssemblyError
        Where a point cannot follow, or not by a drive with the mean speed that is given.
    """
    following = [k for k, drive in enumerate(linkage.drives) if drive.follow is not None]
    if not following:
        return linkage
    period = linkage.period
    inverse = ideal_motion(replace(linkage, run_up=0), period)
    base = 2.0 * math.pi / period
    columns = [linkage.index(linkage.drives[k].body) for k in following]
    turned = (inverse.position[-1] - inverse.position[0])[columns, 2]
    for k, turn in zip(following, turned, strict=True):
        drive, speed = linkage.drives[k], base * round(turn / (2.0 * math.pi))
        if abs(speed - drive.speed) > 1e-9 * max(base, abs(speed)):
            raise AssemblyError(
                f"speed of {drive.body} = {drive.speed:g} rad/s: to follow its curve it turns at "
                f"a mean speed of {speed:g} rad/s"
            )
    breaks = _breaks(linkage, period)
    curves = inverse.rows.coordinates(inverse.position)
    size = inverse.rows.size
    allowed = max(FOLLOWED * (np.ptp(curves, axis=0).max() or size), ROUND_OFF * size)
    off = math.inf
    for parts in (*_PIECES, MOST_PIECES - len(breaks)):
        counts = np.ceil(np.diff(breaks) / period * parts - 1e-9).astype(int)
        if np.maximum(counts, 1).sum() > MOST_PIECES:
            continue
        ends = [
            np.linspace(*pair, max(n, 1) + 1)
            for pair, n in zip(pairwise(breaks), counts, strict=True)
        ]
        nodes = np.concatenate([own[:-1] for own in ends])
        found = _through(linkage, inverse, nodes)
        length = np.diff(nodes, append=period)
        between = np.concatenate([nodes + part * length for part in (0.25, 0.5, 0.75)])
        near = inverse.at(between).position.reshape(between.size, -1, 3)
        reached = closed(Rows(found), between, near).q
        off = float(np.abs(inverse.rows.off_curves(between, reached)).max())
        if off <= allowed:
            return found
    name = linkage.drives[following[0]].name
    if math.isinf(off):
        raise AssemblyError(
            f"{name}: the curve has {len(breaks) - 1} pieces in the cycle of the linkage; allowed "
            f"are {MOST_PIECES}"
        )
    raise AssemblyError(
        f"{name}: with {MOST_PIECES} pieces its point is {off:.3g} m off the curve; allowed is "
        f"{allowed:.3g} m, {FOLLOWED:g} of its stroke"
    )


def _through(linkage: Linkage, inverse: IdealMotion, nodes: Array) -> Linkage:
    """The linkage with tables, in place of curves, through its motion at some instants, s."""
    motion, base = inverse.at(nodes), 2.0 * math.pi / inverse.period
    drives = list(linkage.drives)
    for k, drive in enumerate(linkage.drives):
        if drive.follow is not None:
            place = 3 * linkage.index(drive.body) + 2
            table = np.column_stack(
                [
                    base * nodes,
                    motion.position[:, place] - drive.speed * nodes,
                    (motion.velocity[:, place] - drive.speed) / base,
                    motion.acceleration[:, place] / base**2,
                ]
            )
            drives[k] = replace(drive, frequency=base, table=table.tolist(), follow=None)
    return replace(linkage, drives=drives)


def _breaks(linkage: Linkage, period: float) -> Array:
    """Times of a cycle at which a motion is not smooth, s, and the first of the next cycle."""
    found = [0.0]
    for drive in linkage.drives:
        law = drive.follow or drive
        starts = law.pieces.start
        for turn in range(round(period * drive.base / (2.0 * math.pi)) if starts.size else 0):
            found += ((starts + 2.0 * math.pi * turn) / drive.base).tolist()
    least = LEAST_PIECE * period
    apart = [time for before, time in pairwise([-period, *sorted(found)]) if time - before > least]
    return np.array([*(time for time in apart if period - time > least), period])


def _near(found: Array, expected: Array) -> bool:
    return bool(np.abs(found - expected)[..., 2].max() < _JUMP)


def _followed(rows: Rows, start: _Levels, times: Array) -> IdealMotion:
    """Follow a linkage from one instant to the next, in shorter steps where it turns fast."""
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
                levels, now = reached, there
            elif step < (time - before) / 2.0**_HALVINGS:
                raise _stuck(rows, np.array([now]), levels.q)
            else:
                step *= 0.5
        found.append(levels)
    return IdealMotion(
        rows, float(times[-1]), *(np.concatenate(own) for own in zip(*found, strict=True))
    )


def _is_smooth(one: _Levels, other: _Levels, step: float) -> bool:
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
        raise _stuck(rows, motion.times[worst : worst + 1], motion.position[worst : worst + 1])
    turned = motion.position[-1] - motion.position[0]
    turned[:, 2] -= 2.0 * math.pi * np.round(turned[:, 2] / (2.0 * math.pi))
    off = np.abs(turned).max(axis=1)
    if off.max() > 1e-6:
        body = rows.linkage.bodies[int(off.argmax())].name
        raise AssemblyError(
            f"the linkage does not come back: after a cycle of {motion.period:.6g} s {body} is "
            "elsewhere; the speeds of the drives, or the cycle, do not fit"
        )
