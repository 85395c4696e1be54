"""Constraint rows at many instants, and assembly of any linkage by Newton's method on them."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import Drive, series
from presswear.linkage.elements import GROUND, Attachment, OutputPoint
from presswear.linkage.linkage import Linkage
from presswear.tools.errors import AssemblyError

Array = NDArray[np.float64]


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
        """Return the vectors from the mass centres to the ends, shape (n, joints, 2), m."""
        angle = q[:, self.body, 2]
        cosine, sine = np.cos(angle), np.sin(angle)
        return np.stack([cosine * self.x - sine * self.y, sine * self.x + cosine * self.y], axis=-1)


class Rows:
    """The constraint rows of a linkage, evaluated at many instants.

    Coordinates have the shape (n, bodies, 3). Rows come in the order of
    ``physics.constraints``: two for each pin joint, two for each guide, one for each drive. That
    of a drive whose point follows a curve holds the point on the curve, in place of the angle.
    Times are those behind a run-up.

    Parameters
    ----------
    start : ndarray, shape (bodies, 3)
        Where the bodies are at the start; needed where points follow curves, which begin there.

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

    def __init__(self, linkage: Linkage, start: Array | None = None) -> None:
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
        self._points = _Ends(linkage, [Attachment(item.body, item.x, item.y) for item in probes])
        self._along = np.array(
            [[math.cos(item.direction), math.sin(item.direction)] for item in probes]
        ).reshape(-1, 2)
        self._begun = np.zeros(len(following))
        if following:
            assert start is not None, "curves begin where the linkage starts"
            self._begun = self.coordinates(start[np.newaxis])[0]
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

    def errors(self, time: Array, *prescribed: Array) -> list[Array]:
        """Return the Phi and its derivatives in time, one for each level, each (n, rows).

        Parameters
        ----------
        given : ndarray, shape (n, bodies, 3)
            Coordinates, and their first and second derivatives.
        """
        count = len(time)
        still = np.zeros((count, 1, 3))
        levels = [np.concatenate([level, still], axis=1) for level in prescribed]
        turned = np.array([given_of(drive, time) for drive in self.linkage.drives])
        turned = turned.reshape(-1, 3, count)
        turned[self._following, 0] += self._begun[:, np.newaxis]
        result = []
        all_ends = (self._first, self._second, self._points)
        levers = [end.lever(levels[0]) for end in all_ends]
        for level, item in enumerate(levels):
            ends = []
            for end, lever in zip(all_ends, levers, strict=True):
                body = end.body
                left = np.stack([-lever[..., 1], lever[..., 0]], axis=-1)
                moved = item[:, body, :2]
                moved = moved + (lever if level == 0 else item[:, body, 2:] * left)
                if level == 2:
                    moved = moved - levels[1][:, body, 2:] ** 2 * lever
                ends.append(moved)
            driven = item[:, self._driven, 2]
            driven[:, self._following] = (ends[2] * self._along).sum(axis=-1)
            held = item[:, self._guided]
            off = held[..., :2] - (self._on if level == 0 else 0.0)
            tilted = held[..., 2] - (self._held if level == 0 else 0.0)
            guides = np.stack([(off * self._across).sum(axis=-1), tilted], axis=-1)
            result.append(
                np.concatenate(
                    [
                        (ends[0] - ends[1]).reshape(count, -1),
                        guides.reshape(count, -1),
                        driven - turned[:, level].T,
                    ],
                    axis=1,
                )
            )
        return result

    @property
    def follows(self) -> bool:
        """True where points follow curves."""
        return self._following.size > 0

    def coordinates(self, q: Array) -> Array:
        """Return the coordinates of the points that follow curves, shape (n, points), m."""
        places = q[:, self._points.body, :2] + self._points.lever(q)
        return np.asarray((places * self._along).sum(axis=-1))

    def off_curves(self, time: Array, q: Array) -> Array:
        """Return the distances of points from the curves that they follow, shape (n, points), m."""
        curves = [given_of(self.linkage.drives[k], time)[0] for k in self._following]
        return self.coordinates(q) - self._begun - np.transpose(curves)

    def jacobian(self, q: Array) -> Array:
        """Return the derivatives of the rows by the coordinates, shape (n, rows, 3 bodies)."""
        count, joints = len(q), len(self._first.body)
        q = np.concatenate([q, np.zeros((count, 1, 3))], axis=1)
        result = np.zeros((count, len(self.names), self.bodies + 1, 3))
        rows = 2 * np.arange(joints)
        for end, sign in ((self._first, 1.0), (self._second, -1.0)):
            lever = end.lever(q)
            for axis in (0, 1):
                result[:, rows + axis, end.body, axis] += sign
            result[:, rows, end.body, 2] -= sign * lever[..., 1]
            result[:, rows + 1, end.body, 2] += sign * lever[..., 0]
        rows = 2 * (joints + np.arange(len(self._guided)))
        result[:, rows, self._guided, :2] = self._across
        result[:, rows + 1, self._guided, 2] = 1.0
        drives = len(self.names) - len(self._driven) + np.arange(len(self._driven))
        result[:, drives, self._driven, 2] = 1.0
        if self._following.size:
            following, body, along = drives[self._following], self._points.body, self._along
            lever = self._points.lever(q)
            result[:, following] = 0.0
            result[:, following, body, :2] = along
            result[:, following, body, 2] = (
                lever[..., 0] * along[:, 1] - lever[..., 1] * along[:, 0]
            )
        return result[:, :, : self.bodies].reshape(count, len(self.names), -1)

    def side(self, q: Array) -> Array:
        """Return the sign of the Jacobian's determinant, shape (n,): it changes at dead points.

        1 where points follow curves: a drive may pass a position in which it does not move its
        point, where the curve leads through it.
        """
        if self.follows:
            return np.ones(len(q))
        return np.asarray(np.linalg.slogdet(self.jacobian(q))[0])


def _probe(drive: Drive) -> OutputPoint:
    assert drive.follow is not None
    assert isinstance(drive.follow.point, OutputPoint), "a linkage has found it"
    return drive.follow.point


def given_of(drive: Drive, time: Array) -> tuple[Array, Array, Array]:
    """Return the angle of a drive, or the curve of its point, with two derivatives."""
    if drive.follow is None:
        return drive.motion(time)
    return series(drive.follow, drive.base, time)


ROUND_OFF = 4e-15  # error of a row that is round-off, part of the size of the linkage
_STEPS = 40  # most Newton steps from a guess


class Levels(NamedTuple):
    """Position, velocity and acceleration of all bodies, each (n, bodies, 3)."""

    q: Array
    v: Array
    a: Array


def check_freedoms(linkage: Linkage) -> None:
    """Raise AssemblyError unless joints, guides and drives hold each body just once."""
    rows = 2 * len(linkage.revolutes) + 2 * len(linkage.guides) + len(linkage.drives)
    free = 3 * len(linkage.bodies) - rows
    counts = (
        f"{len(linkage.bodies)} bodies have {3 * len(linkage.bodies)} coordinates; joints, guides "
        f"and drives hold {rows}"
    )
    if free > 0:
        raise AssemblyError(f"the linkage is free to move: {counts}; {free} drives are missing")
    if free < 0:
        raise AssemblyError(f"the linkage is overconstrained: {counts}, {-free} too many")


def guessed(linkage: Linkage) -> Array:
    """Return the coordinates to start Newton's method from, shape (bodies, 3).

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
            placed, loose = joint.first, joint.second
            if placed.body not in reached:
                placed, loose = loose, placed
            if placed.body in reached and loose.body not in reached:
                place = linkage.index(loose.body)
                q[place, :2] += where(placed) - where(loose)
                reached.add(loose.body)
                hung = True
            if {placed.body, loose.body} <= reached:
                waiting.remove(joint)
        if not hung:
            break
    for guide in linkage.guides:
        place = linkage.index(guide.body)
        along = np.array([math.cos(guide.direction), math.sin(guide.direction)])
        point = np.array([guide.x, guide.y])
        q[place, :2] = point + along * ((q[place, :2] - point) @ along)
    return q


def assembled(linkage: Linkage) -> Array:
    """Put a linkage together at its start, shape (bodies, 3).

    Raises
    ------
    AssemblyError
        Where it does not close, or closes more than a right angle from what was guessed.
    """
    # What follows a curve stands where its drive has it.
    linkage = linkage.changed(drives=[replace(drive, follow=None) for drive in linkage.drives])
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
    prescribed = {drive.body for drive in linkage.drives} | {guide.body for guide in linkage.guides}
    for place, body in enumerate(linkage.bodies):
        if body.name not in prescribed:
            turns = (q[0, place, 2] - guess.get(body.name, 0.0)) / (2.0 * math.pi)
            q[0, place, 2] -= 2.0 * math.pi * np.round(turns)
    for name, angle in guess.items():
        result = float(q[0, linkage.index(name), 2])
        if abs(result - angle) > 0.5 * math.pi and name not in prescribed:
            raise AssemblyError(
                f"guess of {name} = {angle:.4g} rad: the linkage closes with it at {result:.4g} "
                "rad; a guess within a right angle of the place that is meant is needed"
            )
    return np.asarray(q[0])


def closed(rows: Rows, time: Array, q: Array) -> Levels:
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
    return Levels(q, v, a)


def _solved(rows: Rows, time: Array, q: Array, right: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(rows.jacobian(q), right[..., None])[..., 0])
    except np.linalg.LinAlgError:
        raise stuck(rows, time, q) from None


def _open(rows: Rows, time: Array, q: Array) -> AssemblyError:
    phi = np.abs(rows.errors(time, q)[0])
    phi = np.where(np.isfinite(phi), phi, math.inf)
    instant = int(phi.max(axis=1).argmax())
    return _refusal(rows, float(time[instant]), rows.names[int(phi[instant].argmax())])


def stuck(rows: Rows, time: Array, q: Array) -> AssemblyError:
    """Return the error of a linkage at a dead point."""
    # Metres and radians are made comparable by the size of each body.
    scale = np.ones((rows.bodies, 3))
    scale[:, 2] = 1.0 / rows.sizes
    _, values, right = np.linalg.svd(rows.jacobian(q) * scale.ravel())
    worst = int(values[:, -1].argmin())
    # The motion that nothing holds: the joint whose bodies turn most against each other.
    free = np.append((right[worst, -1].reshape(-1, 3) * scale)[:, 2], 0.0)
    turning = {
        joint.name: abs(free[first] - free[second])
        for joint, (first, second) in zip(rows.linkage.revolutes, rows.pairs, strict=True)
    }
    # Of several that turn alike the last: it is farther from the drives.
    names = list(turning)[::-1] or [*rows.names]
    return _refusal(rows, float(time[worst]), max(names, key=lambda name: turning.get(name, 0.0)))


def _refusal(rows: Rows, time: float, joint: str) -> AssemblyError:
    where = ""
    for drive in [item for item in rows.linkage.drives if item.follow is None][:1]:
        turned = float(drive.motion(np.array([time]))[0][0]) - drive.angle
        where = f"at crank angle {math.degrees(abs(turned)):.1f} deg "
    for drive in [item for item in rows.linkage.drives if item.follow is not None]:
        return AssemblyError(
            f"{drive.name} cannot make its point follow the curve: {where}({time:.6g} s after the "
            "start) the point is out of reach, or the drive at a dead point"
        )
    return AssemblyError(
        f"the linkage cannot be assembled over the cycle: {where}joint {joint} does not close or "
        "is at a dead point"
    )
