"""Constraint rows of a linkage at many instants, in numpy.

A scene finds its ideal motion without compiled code. ``physics.constraints`` packs the
rows for kernels.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import Drive, GearedDrive, series
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND
from presswear.physics.constraint_list import rows_of
from presswear.physics.row_groups import MIN_GROUP, Group, row_groups
from presswear.tools.arrays import Array

ROUND_OFF = 4e-15  # error of a row that is round-off, part of the size of the linkage


class Ends(NamedTuple):
    """First points, or second points, of all rows, in the frames of their bodies."""

    body: NDArray[np.int64]  # index of the body, -1 for the frame, (rows,)
    x: Array  # m, (rows,)
    y: Array  # m, (rows,)
    sign: float  # 1 of first points, -1 of second points


class Rows:
    """The constraint rows of a linkage, evaluated at many instants.

    A row is the distance of two points along a direction, or the angle of a body, minus
    the value that is prescribed. The direction of a guide on a body turns with this
    body, whose angle is subtracted from that of the slide. Rows come in the order of
    ``constraint_list.rows_of``. If the point of a drive follows a curve, its row holds
    the point on the curve in place of the angle. The curve begins at ``start``,
    coordinates of the shape (bodies, 3). Other coordinates have the shape (n, bodies,
    3). Times are those after a run-up.
    """

    def __init__(self, linkage: Linkage, start: Array | None = None) -> None:
        self.linkage = linkage
        self.bodies = len(linkage.bodies)
        rows = rows_of(linkage)
        self.names = tuple(row.name for row in rows)  # joint, guide or drive
        self.normal = np.array([row.direction for row in rows]).reshape(-1, 2)
        self.turn = np.array([row.turn for row in rows])
        self.target = np.array([row.target for row in rows])
        self.ratio = np.array([row.ratio for row in rows])
        # Rows whose direction turns with the second body
        self.turning = np.flatnonzero([row.is_turning for row in rows])
        # Rows of drives whose points follow curves
        self.following = np.flatnonzero([row.is_following for row in rows]).tolist()
        indices = {body.name: i for i, body in enumerate(linkage.bodies)} | {GROUND: -1}
        self.ends: list[Ends] = []
        for points, sign in (
            ([row.first for row in rows], 1.0),
            ([row.second for row in rows], -1.0),
        ):
            bodies = np.array([indices[point.body] for point in points], np.int64)
            x = np.array([point.x for point in points])
            y = np.array([point.y for point in points])
            self.ends.append(Ends(bodies, x, y, sign))
        self._set_sizes()
        if self.following:
            assert start is not None, "curves begin where the linkage starts"
            initial = self.errors(np.zeros(1), start[np.newaxis])[0][0]
            self.target[self.following] = initial[self.following]

    def _set_sizes(self) -> None:
        """Set the pin joints and the sizes to which errors and angles are compared."""
        pins = slice(0, 2 * len(self.linkage.revolutes), 2)
        # Bodies of the pin joints
        self.joined = [end.body[pins] for end in self.ends]
        # Farthest joint of each body, m; the last is that of the frame
        sizes = np.zeros(self.bodies + 1)
        for end in self.ends:
            np.maximum.at(sizes, end.body[pins], np.hypot(end.x, end.y)[pins])
        # Farthest joint of a body or point on the frame, m: the place of the linkage in
        # the drawing is part of its round-off, but not of the scale of its angles.
        points = [math.hypot(guide.x, guide.y) for guide in self.linkage.guides]
        self.size = max(float(sizes.max(initial=0.0)), *points, 0.0) or 1.0
        # Farthest joint of a moving body, m
        self.arm = float(sizes[:-1].max(initial=0.0)) or 1.0
        self.scale = np.ones(3 * self.bodies)  # makes metres and radians comparable
        self.scale[2::3] = 1.0 / np.where(sizes[:-1] > 0.0, sizes[:-1], self.arm)

    @property
    def repeated(self) -> int:
        """Number of rows beyond the coordinates: they repeat what other rows hold."""
        return max(len(self.names) - 3 * self.bodies, 0)

    def _with_frame(self, level: Array) -> Array:
        """Return a level with the frame, which is at rest, behind the bodies."""
        return np.concatenate([level, np.zeros((len(level), 1, 3))], axis=1)

    def _arms(self, q: Array) -> list[Array]:
        """Return the vectors from the mass centres to both points, each (n, rows, 2), m."""
        cosine = np.cos(q[..., 2])
        sine = np.sin(q[..., 2])
        arms = []
        for end in self.ends:
            c = cosine[:, end.body]
            s = sine[:, end.body]
            arms.append(np.stack([c * end.x - s * end.y, s * end.x + c * end.y], -1))
        return arms

    def _normals(self, q: Array) -> Array:
        """Return the directions of the rows, (rows, 2) or, if some turn, (n, rows, 2)."""
        if not self.turning.size:
            return self.normal
        normals = np.tile(self.normal, (len(q), 1, 1))
        angle = q[:, self.ends[1].body[self.turning], 2]
        cosine = np.cos(angle)
        sine = np.sin(angle)
        x, y = self.normal[self.turning].T
        normals[:, self.turning, 0] = cosine * x - sine * y
        normals[:, self.turning, 1] = sine * x + cosine * y
        return normals

    def _gaps(self, moving: Sequence[Array]) -> list[Array]:
        """Return the vectors between both points and their derivatives, each (n, rows, 2).

        ``moving`` are coordinates, rates and accelerations with the frame.
        """
        arms = self._arms(moving[0])
        gaps = []
        for order, level in enumerate(moving):
            gap = np.zeros((len(level), len(self.names), 2))
            for end, arm in zip(self.ends, arms, strict=True):
                body = level[:, end.body]
                if order == 0:
                    point = body[..., :2] + arm
                else:
                    normal = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
                    point = body[..., :2] + body[..., 2:] * normal
                if order == 2:
                    point = point - moving[1][:, end.body, 2:] ** 2 * arm
                gap += end.sign * point
            gaps.append(gap)
        return gaps

    def _across(self, gap: Array, normals: Array) -> Array:
        """Return distances, (n, rows, 2), along the directions that turn, a right angle on."""
        x, y = normals[:, self.turning].transpose(2, 0, 1)
        return np.asarray(gap[:, self.turning, 1] * x - gap[:, self.turning, 0] * y)

    def _turning_part(
        self, moving: Sequence[Array], gaps: Sequence[Array], normals: Array
    ) -> Array:
        """Return the part of the turning of directions in the last derivative, (n, rows).

        ``gaps`` are those of ``_gaps``.
        """
        carrier = self.ends[1].body[self.turning]
        across = self._across(gaps[0], normals)
        if len(moving) == 1:
            return np.zeros_like(across)
        omega = moving[1][:, carrier, 2]
        if len(moving) == 2:
            return omega * across
        alpha = moving[2][:, carrier, 2]
        distance = (gaps[0] * normals)[:, self.turning].sum(axis=-1)
        coriolis = 2.0 * omega * self._across(gaps[1], normals)
        return alpha * across + coriolis - omega**2 * distance

    def _prescribed(self, time: Array) -> Array:
        """Return the values of the rows and their two derivatives in time, (3, n, rows)."""
        prescribed = np.zeros((3, len(time), len(self.names)))
        drives = self.linkage.prescribed_drives
        # The rows of the drives are the last ones.
        for row, drive in enumerate(drives, -len(drives)):
            prescribed[:, :, row] = motion_of_row(drive, time)
        prescribed[0] += self.target
        return prescribed

    def errors(self, time: Array, *levels: Array) -> list[Array]:
        """Return Phi and its derivatives in time, one for each level, each (n, rows).

        ``levels`` are coordinates, and their first and second derivatives.
        """
        prescribed = self._prescribed(time)
        moving = [self._with_frame(level) for level in levels]
        normals = self._normals(moving[0])
        gaps = self._gaps(moving)
        first, second = (end.body for end in self.ends)
        errors = []
        for order, level in enumerate(moving):
            distance = (gaps[order] * normals).sum(axis=-1)
            relative = level[:, first, 2] - self.ratio * level[:, second, 2]
            error = distance + self.turn * relative - prescribed[order]
            if self.turning.size:
                turning_part = self._turning_part(moving[: order + 1], gaps, normals)
                error[:, self.turning] += turning_part
            errors.append(error)
        return errors

    def _derivatives(self, q: Array) -> list[Array]:
        """Return the derivatives of the rows by x, y and angle of the bodies of both points.

        Each array has the shape (n, rows, 3).
        """
        derivatives = []
        moving = self._with_frame(q)
        normals = self._normals(moving)
        for end, arm in zip(self.ends, self._arms(moving), strict=True):
            moment = arm[..., 0] * normals[..., 1] - arm[..., 1] * normals[..., 0]
            derivative = np.empty((*moment.shape, 3))
            derivative[..., :2] = end.sign * normals
            derivative[..., 2] = end.sign * moment
            derivatives.append(derivative)
        derivatives[0][..., 2] += self.turn
        derivatives[1][..., 2] -= self.turn * self.ratio
        if self.turning.size:
            (gap,) = self._gaps([moving])
            derivatives[1][:, self.turning, 2] += self._across(gap, normals)
        return derivatives

    def _block(self, derivatives: list[Array], group: Group) -> Array:
        """Return the derivatives of some rows by some coordinates, shape (n, rows, columns).

        ``derivatives`` are those of ``_derivatives``.
        """
        rows, columns = group
        # Column of each coordinate in the result. The last column collects the
        # derivatives by all other coordinates, and is left out.
        column_of = np.full(3 * (self.bodies + 1), columns.size)
        column_of[columns] = np.arange(columns.size)
        result = np.zeros((len(derivatives[0]), rows.size, columns.size + 1))
        row_index = np.arange(rows.size)[:, np.newaxis]
        for end, derivative in zip(self.ends, derivatives, strict=True):
            column = column_of[3 * end.body[rows, np.newaxis] + np.arange(3)]
            result[:, row_index, column] += derivative[:, rows]
        return result[..., :-1]

    def jacobian(self, q: Array) -> Array:
        """Return the derivatives of the rows by the coordinates, shape (n, rows, 3 bodies)."""
        everything = np.arange(len(self.names)), np.arange(3 * self.bodies)
        return self._block(self._derivatives(q), everything)

    @cached_property
    def groups(self) -> list[Group]:
        """Rows and coordinates of groups that are solved one after the other."""
        rows = np.arange(len(self.names))
        if rows.size <= MIN_GROUP:
            return [(rows, rows)]
        # An element that is zero at these random angles is zero at all angles.
        angles = np.random.default_rng(0).uniform(0.3, 1.2, (1, self.bodies, 3))
        return row_groups(self.jacobian(angles)[0] != 0.0)

    def solve(self, q: Array, right: Array) -> Array:
        """Solve the equations of the Jacobian, shape (n, rows), for coordinates like ``q``.

        If rows are repeated, it is the least-squares solution.
        """
        if self.repeated:
            orthogonal, triangle = np.linalg.qr(self.jacobian(q) * self.scale)
            projected = orthogonal.transpose(0, 2, 1) @ right[..., np.newaxis]
            scaled = np.linalg.solve(triangle, projected)[..., 0]
            return np.asarray((scaled * self.scale).reshape(q.shape))
        derivatives = self._derivatives(q)
        result = np.zeros((len(q), self.bodies + 1, 3))
        flat = result.reshape(len(q), -1)
        for rows, columns in self.groups:
            remaining = right[:, rows]
            if columns.size < right.shape[1]:
                # Subtract the contributions of the groups before.
                for end, derivative in zip(self.ends, derivatives, strict=True):
                    solved = result[:, end.body[rows]]
                    remaining = remaining - (derivative[:, rows] * solved).sum(axis=-1)
            block = self._block(derivatives, (rows, columns))
            flat[:, columns] = np.linalg.solve(block, remaining[..., np.newaxis])[
                ..., 0
            ]
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
        derivatives = self._derivatives(q)
        signs = [
            np.linalg.slogdet(self._block(derivatives, group))[0]
            for group in self.groups
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
        derivatives = self._derivatives(q)
        norms = []
        for group in self.groups:
            inverse = np.linalg.inv(
                self._block(derivatives, group) * self.scale[group[1]]
            )
            norms.append(np.linalg.norm(inverse, axis=(1, 2)))
        return np.asarray(1.0 / np.max(norms, axis=0))


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
