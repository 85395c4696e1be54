"""Constraint rows of a linkage at many instants, in numpy.

A scene finds its ideal motion without compiled code. ``physics.constraints`` packs the
rows for kernels.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import Drive, GearedDrive, LinearDrive, series
from presswear.linkage.joints import ends_of
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment, OutputPoint
from presswear.tools.arrays import Array

Group = tuple[NDArray[np.int64], NDArray[np.int64]]  # rows, and as many coordinates
ROUND_OFF = 4e-15  # error of a row that is round-off, part of the size of the linkage
# Least rows of a group that is solved at once: below, numpy takes longer than LAPACK;
# with hundreds of rows, LAPACK starts threads for each of thousands of small matrices.
_GROUP = 30


class _Row(NamedTuple):
    """Constraint row: a distance along a direction, or an angle, and its value."""

    name: str  # of the joint, guide or drive
    first: Attachment
    second: Attachment
    direction: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0  # 1: angle of the first body less that of the second
    target: float = 0.0  # value that is held, m or rad
    ratio: float = 1.0  # times which the angle of the second body is subtracted


class Rows:
    """The constraint rows of a linkage, evaluated at many instants.

    A row is the distance of two points along a direction, or the angle of a body, minus
    the value that is prescribed. The direction of a guide on a body turns with this
    body, whose angle is subtracted from that of the slide. Rows come in the order of
    ``physics.constraints``: two for each pin joint, two for each guide, a third for a
    guide with a spring, and one for each drive. If the point of a drive follows a curve,
    its row holds the point on the curve in place of the angle. The curve begins at
    ``start``, coordinates of the shape (bodies, 3). Other coordinates have the shape
    (n, bodies, 3). Times are those after a run-up.
    """

    def __init__(self, linkage: Linkage, start: Array | None = None) -> None:
        self.linkage = linkage
        self.bodies = len(linkage.bodies)
        frame = Attachment(GROUND, 0.0, 0.0)
        rows: list[_Row] = []
        for joint in linkage.revolutes:
            for axis in ((1.0, 0.0), (0.0, 1.0)):
                rows.append(_Row(joint.name, joint.first, joint.second, axis))
        turning = []  # rows whose direction turns with the second body
        for guide in linkage.guides:
            point, centre = ends_of(guide)
            across = -math.sin(guide.direction), math.cos(guide.direction)
            if guide.is_moving:
                turning.append(len(rows))
            rows.append(_Row(guide.name, centre, point, across))
            carrier = Attachment(guide.on, 0.0, 0.0)
            rows.append(_Row(guide.name, centre, carrier, turn=1.0, target=guide.angle))
            if guide.stiffness is not None:
                along = math.cos(guide.direction), math.sin(guide.direction)
                rows.append(_Row(guide.name, centre, point, along))
        self.following = []  # rows of drives whose points follow curves
        for drive in linkage.prescribed_drives:
            centre = Attachment(drive.body, 0.0, 0.0)
            if drive.follow is not None:
                self.following.append(len(rows))
                output = drive.follow.point
                assert isinstance(output, OutputPoint), "a linkage has found it"
                point = Attachment(output.body, output.x, output.y)
                along = math.cos(output.direction), math.sin(output.direction)
                rows.append(_Row(drive.name, point, frame, along))
            elif isinstance(drive, LinearDrive):
                guide = linkage.guide_of(drive)
                start_point, _ = ends_of(guide)
                along = math.cos(guide.direction), math.sin(guide.direction)
                if guide.is_moving:
                    turning.append(len(rows))
                rows.append(_Row(drive.name, centre, start_point, along))
            elif isinstance(drive, GearedDrive):
                rows.append(_row_of_gears(linkage, drive))
            else:
                rows.append(_Row(drive.name, centre, frame, turn=1.0))
        self.names = tuple(row.name for row in rows)  # joint, guide or drive
        self.normal = np.array([row.direction for row in rows]).reshape(-1, 2)
        self.turning = np.array(turning, np.int64)
        self.turn = np.array([row.turn for row in rows])
        self.target = np.array([row.target for row in rows])
        self.ratio = np.array([row.ratio for row in rows])
        indices = {body.name: i for i, body in enumerate(linkage.bodies)} | {GROUND: -1}
        # Bodies, -1 for the frame, places, m, and sign, of the first points and of the
        # second
        self.ends: list[tuple[NDArray[np.int64], Array, Array, float]] = []
        for ends, sign in (
            ([row.first for row in rows], 1.0),
            ([row.second for row in rows], -1.0),
        ):
            bodies = np.array([indices[end.body] for end in ends], dtype=np.int64)
            x, y = np.array([(end.x, end.y) for end in ends]).reshape(-1, 2).T
            self.ends.append((bodies, x, y, sign))
        pins = slice(0, 2 * len(linkage.revolutes), 2)
        # bodies of the pin joints
        self.joined = [body[pins] for body, _, _, _ in self.ends]
        sizes = np.zeros(self.bodies + 1)
        for body, x, y, _ in self.ends:
            np.maximum.at(sizes, body[pins], np.hypot(x, y)[pins])
        # Farthest joint of a body or point on the frame, m: the place of the linkage in
        # the drawing is part of its round-off, but not of the scale of its angles.
        points = [math.hypot(guide.x, guide.y) for guide in linkage.guides]
        self.size = max(float(sizes.max(initial=0.0)), *points, 0.0) or 1.0
        # farthest joint of a moving body, m
        self.arm = float(sizes[:-1].max(initial=0.0)) or 1.0
        self.scale = np.ones(3 * self.bodies)  # makes metres and radians comparable
        self.scale[2::3] = 1.0 / np.where(sizes[:-1] > 0.0, sizes[:-1], self.arm)
        if self.following:
            assert start is not None, "curves begin where the linkage starts"
            initial = self.errors(np.zeros(1), start[np.newaxis])[0][0]
            self.target[self.following] = initial[self.following]

    @property
    def repeated(self) -> int:
        """Number of rows beyond the coordinates: they repeat what other rows hold."""
        return max(len(self.names) - 3 * self.bodies, 0)

    def _moving(self, level: Array) -> Array:
        """Return a level with the frame, which is at rest, behind the bodies."""
        return np.concatenate([level, np.zeros((len(level), 1, 3))], axis=1)

    def _arms(self, q: Array) -> list[tuple[Array, Array]]:
        """Return x and y from the mass centres to both points, each (n, rows), m."""
        cosine, sine = np.cos(q[..., 2]), np.sin(q[..., 2])
        ends = [(cosine[:, body], sine[:, body], x, y) for body, x, y, _ in self.ends]
        return [(cos * x - sin * y, sin * x + cos * y) for cos, sin, x, y in ends]

    def _normals(self, q: Array) -> Array:
        """Return the directions of the rows, (rows, 2) or, if some turn, (n, rows, 2)."""
        if not self.turning.size:
            return self.normal
        normals = np.tile(self.normal, (len(q), 1, 1))
        angle = q[:, self.ends[1][0][self.turning], 2]
        cosine, sine = np.cos(angle), np.sin(angle)
        x, y = self.normal[self.turning].T
        normals[:, self.turning, 0] = cosine * x - sine * y
        normals[:, self.turning, 1] = sine * x + cosine * y
        return normals

    def _across(self, gap: Array, normals: Array) -> Array:
        """Return distances, (n, rows, 2), along the directions that turn, a right angle on."""
        x, y = normals[:, self.turning].transpose(2, 0, 1)
        return np.asarray(gap[:, self.turning, 1] * x - gap[:, self.turning, 0] * y)

    def _turning_part(
        self, moving: Sequence[Array], gaps: Sequence[Array], normals: Array
    ) -> Array:
        """Return what the turning of directions adds to the last derivative of rows, (n, rows).

        ``gaps`` are the distances of the points, (n, rows, 2), and their derivatives.
        """
        carrier = self.ends[1][0][self.turning]
        across = self._across(gaps[0], normals)
        if len(moving) == 1:
            return np.zeros_like(across)
        omega = moving[1][:, carrier, 2]
        if len(moving) == 2:
            return omega * across
        distance = (gaps[0] * normals)[:, self.turning].sum(axis=-1)
        sideways = 2.0 * omega * self._across(gaps[1], normals)
        return moving[2][:, carrier, 2] * across + sideways - omega**2 * distance

    def errors(self, time: Array, *levels: Array) -> list[Array]:
        """Return Phi and its derivatives in time, one for each level, each (n, rows).

        ``levels`` are coordinates, and their first and second derivatives.
        """
        prescribed = np.zeros((3, len(time), len(self.names)))
        drives = self.linkage.prescribed_drives
        for row, drive in enumerate(drives, -len(drives)):
            for level, value in zip(
                prescribed, motion_of_row(drive, time), strict=True
            ):
                level[:, row] = value
        prescribed[0] += self.target
        moving = [self._moving(level) for level in levels]
        arms = self._arms(moving[0])
        normals = self._normals(moving[0])
        first, second = (body for body, _, _, _ in self.ends)
        result: list[Array] = []
        gaps: list[Array] = []
        for order, level in enumerate(moving):
            gap: Any = 0.0
            for (body, _, _, sign), (x, y) in zip(self.ends, arms, strict=True):
                arm = np.stack([x, y], axis=-1)
                left = np.stack([-y, x], axis=-1)
                point = level[:, body, :2] + (
                    arm if order == 0 else level[:, body, 2:] * left
                )
                if order == 2:
                    point = point - moving[1][:, body, 2:] ** 2 * arm
                gap = gap + sign * point
            carried = self.ratio * level[:, second, 2]
            angle = self.turn * (level[:, first, 2] - carried)
            result.append((gap * normals).sum(axis=-1) + angle - prescribed[order])
            gaps.append(gap)
            if self.turning.size:
                turning_part = self._turning_part(moving[: order + 1], gaps, normals)
                result[-1][:, self.turning] += turning_part
        return result

    def _parts(self, q: Array) -> list[Array]:
        """Return the derivatives of the rows by x, y and angle of the bodies of both points.

        Each array has the shape (n, rows, 3).
        """
        derivatives = []
        moving = self._moving(q)
        arms = self._arms(moving)
        normals = self._normals(moving)
        for (_, _, _, sign), (x, y) in zip(self.ends, arms, strict=True):
            by_body = np.empty((*x.shape, 3))
            by_body[..., :2] = sign * normals
            by_body[..., 2] = sign * (x * normals[..., 1] - y * normals[..., 0])
            derivatives.append(by_body)
        derivatives[0][..., 2] += self.turn
        derivatives[1][..., 2] -= self.turn * self.ratio
        if self.turning.size:
            gap = np.zeros((len(q), len(self.names), 2))
            for (body, _, _, sign), arm in zip(self.ends, arms, strict=True):
                gap += sign * (moving[:, body, :2] + np.stack(arm, axis=-1))
            derivatives[1][:, self.turning, 2] += self._across(gap, normals)
        return derivatives

    def _block(self, parts: list[Array], group: Group) -> Array:
        """Return the derivatives of some rows by some coordinates, shape (n, rows, columns).

        ``parts`` are those of ``_parts``.
        """
        rows, columns = group
        # Column of each coordinate in the result. The last column collects the
        # derivatives by all other coordinates, and is left out.
        column_of = np.full(3 * (self.bodies + 1), columns.size)
        column_of[columns] = np.arange(columns.size)
        result = np.zeros((len(parts[0]), rows.size, columns.size + 1))
        row_index = np.arange(rows.size)[:, np.newaxis]
        for (body, _, _, _), by_body in zip(self.ends, parts, strict=True):
            column = column_of[3 * body[rows, np.newaxis] + np.arange(3)]
            result[:, row_index, column] += by_body[:, rows]
        return result[..., :-1]

    def jacobian(self, q: Array) -> Array:
        """Return the derivatives of the rows by the coordinates, shape (n, rows, 3 bodies)."""
        return self._block(
            self._parts(q), (np.arange(len(self.names)), np.arange(3 * self.bodies))
        )

    @cached_property
    def groups(self) -> list[Group]:
        """Rows and coordinates of groups that are solved one after the other.

        The rows of a group depend only on the coordinates of this group and of the
        groups before it. The groups are the irreducible blocks of the Jacobian, joined
        to at least ``_GROUP`` rows.
        """
        rows = np.arange(len(self.names))
        if rows.size <= _GROUP:
            return [(rows, rows)]
        # An element that is zero at these random angles is zero at all angles.
        angles = np.random.default_rng(0).uniform(0.3, 1.2, (1, self.bodies, 3))
        pattern = self.jacobian(angles)[0] != 0.0
        owner: dict[int, int] = {}  # row that determines a coordinate

        def owns(row: int, tried: set[int]) -> bool:
            for column in map(int, np.flatnonzero(pattern[row])):
                if column not in tried:
                    tried.add(column)
                    if column not in owner or owns(owner[column], tried):
                        owner[column] = row
                        return True
            return False

        if not all(owns(int(row), set()) for row in rows):
            return [(rows, rows)]  # the Jacobian is singular at all angles
        columns = np.array(sorted(owner, key=owner.__getitem__))
        # Element (i, j) is true if row i contains the coordinate that row j determines.
        needs = pattern[:, columns]
        # Also true if it does so through other rows.
        for _ in range(rows.size.bit_length()):
            needs = needs @ needs
        block = (needs & needs.T).argmax(axis=1)
        order = np.lexsort((block, needs.sum(axis=1)))
        cuts = [0]
        for start in map(int, np.flatnonzero(np.diff(block[order]))):
            if start + 1 - cuts[-1] >= _GROUP:
                cuts.append(start + 1)
        groups = (order[first:last] for first, last in pairwise([*cuts, rows.size]))
        return [(group, columns[group]) for group in groups]

    def solve(self, q: Array, right: Array) -> Array:
        """Solve the equations of the Jacobian, shape (n, rows), for coordinates like ``q``.

        If rows are repeated, it is the least-squares solution.
        """
        if self.repeated:
            inverse = np.linalg.pinv(self.jacobian(q) * self.scale)
            scaled = (inverse @ right[..., np.newaxis])[..., 0]
            return np.asarray((scaled * self.scale).reshape(q.shape))
        parts = self._parts(q)
        result = np.zeros((len(q), self.bodies + 1, 3))
        flat = result.reshape(len(q), -1)
        for rows, columns in self.groups:
            rest = right[:, rows]
            if columns.size < right.shape[1]:
                # Subtract the contributions of the groups before.
                for (body, _, _, _), by_body in zip(self.ends, parts, strict=True):
                    solved = result[:, body[rows]]
                    rest = rest - (by_body[:, rows] * solved).sum(axis=-1)
            block = self._block(parts, (rows, columns))
            flat[:, columns] = np.linalg.solve(block, rest[..., np.newaxis])[..., 0]
        return result[:, :-1]

    def forces(self, q: Array, right: Array) -> Array:
        """Return the forces of the rows that balance forces on the coordinates, (n, rows, k).

        ``right`` has the shape (n, 3 bodies, k), N and N m. If rows are repeated, the
        forces are not unique: those with the smallest norm are returned, in which a
        moment is divided by ``arm``.
        """
        transposed = self.jacobian(q).transpose(0, 2, 1)
        if not self.repeated:
            return np.asarray(np.linalg.solve(transposed, right))
        arms = np.where(self.turn == 0.0, 1.0, self.arm)[:, np.newaxis]
        return np.asarray(arms * (np.linalg.pinv(transposed * arms.T) @ right))

    def side(self, q: Array) -> Array:
        """Return the sign of the determinant of the Jacobian, which changes at dead points, (n,).

        It is 1 if a point follows a curve, because the drive may then pass a dead point.
        It is 1 if rows are repeated, because the determinant is then zero.
        """
        if self.following or self.repeated:
            return np.ones(len(q))
        parts = self._parts(q)
        signs = [
            np.linalg.slogdet(self._block(parts, group))[0] for group in self.groups
        ]
        return np.asarray(np.prod(signs, axis=0))

    def distance(self, q: Array) -> Array:
        """Return a distance from the nearest dead point, shape (n,), 0 at a dead point.

        It is one over the norm of the inverse, the largest of all groups. The norm of
        the inverse of the whole Jacobian would grow with the number of linkages in a
        chain.
        """
        if self.repeated:
            values = np.linalg.svd(self.jacobian(q) * self.scale, compute_uv=False)
            return np.asarray(1.0 / np.sqrt((values**-2.0).sum(axis=1)))
        parts = self._parts(q)
        norms = []
        for group in self.groups:
            inverse = np.linalg.inv(self._block(parts, group) * self.scale[group[1]])
            norms.append(np.linalg.norm(inverse, axis=(1, 2)))
        return np.asarray(1.0 / np.max(norms, axis=0))


def _row_of_gears(linkage: Linkage, gears: GearedDrive) -> _Row:
    """Return the row that couples the angles of two cranks."""
    leader = linkage.drives[linkage.number_of_drive(gears.leader)]
    return _Row(
        gears.name,
        Attachment(gears.body, 0.0, 0.0),
        Attachment(gears.leader, 0.0, 0.0),
        turn=1.0,
        target=gears.angle - gears.ratio * leader.angle,
        ratio=gears.ratio,
    )


def motion_of_row(drive: Drive, time: Array) -> tuple[Array, Array, Array]:
    """Return the angle of a drive, or the curve of its point, with two derivatives.

    The row of gears has no motion of its own.
    """
    if isinstance(drive, GearedDrive):
        still = np.zeros_like(time)
        return still, still, still
    if drive.follow is None:
        return drive.motion(time)
    return series(drive.follow, drive.base, time)
