"""The constraint rows of a linkage, for many instants at once.

All equations are those of ``physics.constraints``.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import Drive, series
from presswear.linkage.elements import GROUND, Attachment, OutputPoint
from presswear.linkage.linkage import Linkage

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
        self._points = _Ends(linkage, [Attachment(own.body, own.x, own.y) for own in probes])
        self._along = np.array(
            [[math.cos(own.direction), math.sin(own.direction)] for own in probes]
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
        turned = np.array([given_of(drive, time) for drive in self.linkage.drives])
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
        curves = [given_of(self.linkage.drives[k], time)[0] for k in self._following]
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


def _probe(drive: Drive) -> OutputPoint:
    """The point that follows a curve."""
    assert drive.follow is not None
    assert isinstance(drive.follow.point, OutputPoint), "a linkage has found it"
    return drive.follow.point


def given_of(drive: Drive, time: Array) -> tuple[Array, Array, Array]:
    """What is given of a drive, with two derivatives: an angle, or the way of what follows."""
    if drive.follow is None:
        return drive.motion(time)
    return series(drive.follow, drive.base, time)
