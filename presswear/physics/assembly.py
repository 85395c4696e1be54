"""Constraint rows at many instants, and assembly of any linkage by Newton's method on them.

A scene finds its ideal motion without compiled code; ``physics.constraints`` packs the
rows for kernels.
"""

import math
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import Drive, series
from presswear.linkage.elements import GROUND, Attachment, OutputPoint
from presswear.linkage.linkage import Linkage
from presswear.tools.arrays import Array
from presswear.tools.errors import AssemblyError

Group = tuple[NDArray[np.int64], NDArray[np.int64]]  # rows, and as many coordinates

ROUND_OFF = 4e-15  # error of a row that is round-off, part of the size of the linkage
# Least rows of a group that is solved at once: below, numpy takes longer than LAPACK;
# with hundreds of rows, LAPACK starts threads for each of thousands of small matrices.
_GROUP = 30
_STEPS = 40  # most Newton steps from a guess


class Levels(NamedTuple):
    """Position, velocity and acceleration of all bodies, each (n, bodies, 3)."""

    q: Array
    v: Array
    a: Array


class Rows:
    """The constraint rows of a linkage, evaluated at many instants.

    A row is the distance of two points along a direction, or the angle of a body, less
    what it should be. Rows come in the order of ``physics.constraints``: two for each
    pin joint, two for each guide, a third for one with a spring, one for each drive.
    That of a drive whose point
    follows a curve holds the point on the curve, in place of the angle; the curve
    begins at ``start``, coordinates of the shape (bodies, 3). Other coordinates have
    the shape (n, bodies, 3); times are those behind a run-up.
    """

    def __init__(self, linkage: Linkage, start: Array | None = None) -> None:
        self.linkage = linkage
        self.bodies = len(linkage.bodies)
        frame = Attachment(GROUND, 0.0, 0.0)
        # Name, both points, direction, share of the first body's angle, value that is
        # to be held
        rows: list[
            tuple[str, Attachment, Attachment, tuple[float, float], float, float]
        ] = []
        for joint in linkage.revolutes:
            for axis in ((1.0, 0.0), (0.0, 1.0)):
                rows.append((joint.name, joint.first, joint.second, axis, 0.0, 0.0))
        for guide in linkage.guides:
            centre = Attachment(guide.body, 0.0, 0.0)
            point = Attachment(GROUND, guide.x, guide.y)
            across = -math.sin(guide.direction), math.cos(guide.direction)
            rows.append((guide.name, centre, point, across, 0.0, 0.0))
            rows.append((guide.name, centre, frame, (0.0, 0.0), 1.0, guide.angle))
            if guide.stiffness is not None:
                along = math.cos(guide.direction), math.sin(guide.direction)
                rows.append((guide.name, centre, point, along, 0.0, 0.0))
        self.following = []  # rows of drives whose points follow curves
        for drive in linkage.prescribed_drives:
            point, along, turn = Attachment(drive.body, 0.0, 0.0), (0.0, 0.0), 1.0
            if drive.follow is not None:
                self.following.append(len(rows))
                output = drive.follow.point
                assert isinstance(output, OutputPoint), "a linkage has found it"
                point = Attachment(output.body, output.x, output.y)
                turn = 0.0
                along = math.cos(output.direction), math.sin(output.direction)
            rows.append((drive.name, point, frame, along, turn, 0.0))
        self.names = tuple(row[0] for row in rows)  # joint, guide or drive
        self.normal = np.array([row[3] for row in rows]).reshape(-1, 2)
        self.turn, self.target = np.array([row[4:] for row in rows]).reshape(-1, 2).T
        indices = {body.name: i for i, body in enumerate(linkage.bodies)} | {GROUND: -1}
        # Bodies, -1 for the frame, places, m, and sign, of the first points and of the
        # second
        self.ends: list[tuple[NDArray[np.int64], Array, Array, float]] = []
        for ends, sign in (
            ([row[1] for row in rows], 1.0),
            ([row[2] for row in rows], -1.0),
        ):
            bodies = np.array([indices[end.body] for end in ends], dtype=np.int64)
            x, y = np.array([(end.x, end.y) for end in ends]).reshape(-1, 2).T
            self.ends.append((bodies, x, y, sign))
        pins = slice(0, 2 * len(linkage.revolutes), 2)
        self.joined = [
            body[pins] for body, _, _, _ in self.ends
        ]  # bodies of the pin joints
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
        result = []
        for order, level in enumerate(moving):
            gap: Array | float = 0.0
            for (body, _, _, sign), (x, y) in zip(self.ends, arms, strict=True):
                arm = np.stack([x, y], axis=-1)
                left = np.stack([-y, x], axis=-1)
                point = level[:, body, :2] + (
                    arm if order == 0 else level[:, body, 2:] * left
                )
                if order == 2:
                    point = point - moving[1][:, body, 2:] ** 2 * arm
                gap = gap + sign * point
            angle = self.turn * level[:, self.ends[0][0], 2]
            result.append((gap * self.normal).sum(axis=-1) + angle - prescribed[order])
        return result

    def _parts(self, q: Array) -> list[Array]:
        """Return the derivatives of the rows by x, y and angle of the bodies of both points.

        Each array has the shape (n, rows, 3).
        """
        derivatives = []
        arms = self._arms(self._moving(q))
        for (_, _, _, sign), (x, y) in zip(self.ends, arms, strict=True):
            by_body = np.empty((*x.shape, 3))
            by_body[..., :2] = sign * self.normal
            by_body[..., 2] = sign * (x * self.normal[:, 1] - y * self.normal[:, 0])
            derivatives.append(by_body)
        derivatives[0][..., 2] += self.turn
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


def motion_of_row(drive: Drive, time: Array) -> tuple[Array, Array, Array]:
    """Return the angle of a drive, or the curve of its point, with two derivatives."""
    if drive.follow is None:
        return drive.motion(time)
    return series(drive.follow, drive.base, time)


def _guessed(linkage: Linkage) -> Array:
    """Return the coordinates to start Newton's method from, shape (bodies, 3).

    The angle of a body is that of its drive, of its guide, of the guess of the user, or
    0. Its position is that at which the first joint to a body with known position
    closes.
    """
    q = np.zeros((len(linkage.bodies) + 1, 3))  # the frame last
    indices = {body.name: i for i, body in enumerate(linkage.bodies)} | {GROUND: -1}
    angles = dict(linkage.guess)
    angles |= {guide.body: guide.angle for guide in linkage.guides}
    angles |= {drive.body: drive.angle for drive in linkage.drives}
    q[:-1, 2] = [angles.get(body.name, 0.0) for body in linkage.bodies]

    def place(end: Attachment) -> Array:
        x, y, angle = q[indices[end.body]]
        cosine, sine = math.cos(angle), math.sin(angle)
        across = cosine * end.x - sine * end.y
        up = sine * end.x + cosine * end.y
        return np.array([x + across, y + up])

    reached = {GROUND}
    for _ in linkage.bodies:
        for joint in linkage.revolutes:
            placed = joint.first
            loose = joint.second
            if placed.body not in reached:
                placed, loose = loose, placed
            if placed.body in reached and loose.body not in reached:
                q[indices[loose.body], :2] += place(placed) - place(loose)
                reached.add(loose.body)
    for guide in linkage.guides:
        along = np.array([math.cos(guide.direction), math.sin(guide.direction)])
        point = np.array([guide.x, guide.y])
        body = indices[guide.body]
        q[body, :2] = point + along * ((q[body, :2] - point) @ along)
    return q[:-1]


def _free_coordinates(linkage: Linkage) -> int:
    """Return the coordinates less the constraint rows; below zero where rows are repeated."""
    constrained = sum(joint.rows for joint in linkage.joints) + len(
        linkage.prescribed_drives
    )
    return 3 * len(linkage.bodies) - constrained


def _count(linkage: Linkage) -> str:
    """Return the numbers of coordinates and of constraint rows in words."""
    coordinates = 3 * len(linkage.bodies)
    constrained = coordinates - _free_coordinates(linkage)
    return (
        f"{len(linkage.bodies)} bodies have {coordinates} coordinates; pins and guides (2 each) "
        f"and drives (1 each) hold {constrained}"
    )


def _closed(rows: Rows, time: Array, q: Array) -> Levels:
    """Close a linkage at an instant from guessed positions, by damped steps at first."""

    def error_of(q: Array) -> float:
        return float(np.linalg.norm(rows.errors(time, q)[0]))

    for _ in range(_STEPS):
        error = error_of(q)
        if error < 1e-9 * rows.size:
            break
        step = -_solved(rows, time, q, rows.errors(time, q)[0])
        # No body turns by more than half a radian at once: the guess says on which side
        # it is.
        part = min(1.0, 0.5 / max(float(np.abs(step[..., 2]).max()), 1e-300))
        while part > 1e-3 and error_of(q + part * step) > error:
            part *= 0.5
        q = q + part * step
    return close(rows, time, q)


def assembled(linkage: Linkage) -> Array:
    """Return the coordinates of a linkage at its start, shape (bodies, 3).

    Raises
    ------
    AssemblyError
        Unless joints, guides and drives hold each body; where it does not close, also
        where rows that repeat others do not fit them, or closes more than a right angle
        from what was guessed.
    """
    # What follows a curve stands where its drive has it.
    linkage = linkage.changed(
        drives=[replace(drive, follow=None) for drive in linkage.drives]
    )
    if (free := _free_coordinates(linkage)) > 0:
        held_bodies = [
            end.body for one in linkage.revolutes for end in (one.first, one.second)
        ]
        held_bodies += [guide.body for guide in linkage.guides]
        single = [one.name for one in linkage.bodies if held_bodies.count(one.name) < 2]
        hint = "".join(
            f"; body {name} can move freely, "
            f"{'only one joint holds' if name in held_bodies else 'no joint holds'} it"
            for name in single
        )
        raise AssemblyError(
            f"the linkage is free to move: {_count(linkage)}{hint}; add joints, guides or drives "
            f"that hold {free} more"
        )
    rows = Rows(linkage)
    start = np.zeros(1)
    q = _guessed(linkage)[np.newaxis]
    guess = dict(linkage.guess)
    prescribed = {drive.body for drive in linkage.drives} | {
        guide.body for guide in linkage.guides
    }
    try:
        q = _closed(rows, start, q).q[0]
    except AssemblyError as error:
        bodies = {body.name for body in linkage.bodies} - prescribed - guess.keys()
        hint = f"; guess has no angle of {', '.join(sorted(bodies))}" if bodies else ""
        for guide in linkage.guides:
            where = f"({1e3 * guide.x:.6g}, {1e3 * guide.y:.6g}) mm"
            hint += f"; the line of {guide.name} goes through {where}"
        raise AssemblyError(f"{error}{hint}") from None
    for place, body in enumerate(linkage.bodies):
        if body.name not in prescribed:
            turns = (q[place, 2] - guess.get(body.name, 0.0)) / (2.0 * math.pi)
            q[place, 2] -= 2.0 * math.pi * np.round(turns)
    for name, angle in guess.items():
        result = float(q[linkage.index(name), 2])
        if abs(result - angle) > 0.5 * math.pi and name not in prescribed:
            raise AssemblyError(
                f"guess of {name} = {math.degrees(angle):.4g} deg: the linkage closes with it at "
                f"{math.degrees(result):.4g} deg; a guess within a right angle of the place that "
                "is meant is needed"
            )
    return q


def close(rows: Rows, time: Array, q: Array) -> Levels:
    """Close a linkage at some instants from positions close by.

    AssemblyError where it does not close names the joint and the crank angle.
    """
    zero = np.zeros_like(q)
    least = math.inf
    for _ in range(_STEPS):
        (phi,) = rows.errors(time, q)
        error = float(np.abs(phi).max(initial=0.0))
        if not error < 1e3 * rows.size:
            break
        # Round-off does not shrink any more.
        if error <= ROUND_OFF * rows.size or (
            error < 1e-12 * rows.size and error >= 0.5 * least
        ):
            break
        least = min(least, error)
        q = q - _solved(rows, time, q, phi)
    else:
        error = math.inf
    if not error < 1e-9 * rows.size:
        phi = np.abs(rows.errors(time, q)[0])
        phi = np.where(np.isfinite(phi), phi, math.inf)
        instant = int(phi.max(axis=1).argmax())
        row = int(phi[instant].argmax())
        if rows.repeated and phi[instant, row] < rows.size:
            raise _misfit(
                rows, float(time[instant]), rows.names[row], float(phi[instant, row])
            )
        raise _refusal(rows, float(time[instant]), rows.names[row])
    v = -_solved(rows, time, q, rows.errors(time, q, zero)[1])
    a = -_solved(rows, time, q, rows.errors(time, q, v, zero)[2])
    return Levels(q, v, a)


def _solved(rows: Rows, time: Array, q: Array, right: Array) -> Array:
    try:
        return rows.solve(q, right)
    except np.linalg.LinAlgError:
        raise stuck(rows, time, q) from None


def stuck(rows: Rows, time: Array, q: Array) -> AssemblyError:
    """Return the error of a linkage at a dead point."""
    _, values, right = np.linalg.svd(rows.jacobian(q) * rows.scale)
    worst = int(values[:, -1].argmin())
    # The motion that nothing holds: the joint whose bodies turn most against each
    # other, and of several that turn alike the last, which is farther from the drives.
    free = np.append((right[worst, -1] * rows.scale)[2::3], 0.0)
    turning = np.abs(free[rows.joined[0]] - free[rows.joined[1]])
    last = turning.size - 1 - int(turning[::-1].argmax()) if turning.size else 0
    return _refusal(rows, float(time[worst]), rows.names[2 * last])


def _misfit(rows: Rows, time: float, name: str, distance: float) -> AssemblyError:
    return AssemblyError(
        f"the linkage is overconstrained: {_count(rows.linkage)}, {rows.repeated} too many, and "
        f"they do not fit each other: {_crank_angle(rows, time)}{name} is off by {distance:.3g} m "
        "or rad; allowed are 1e-9 of the size of the linkage, or clearance in one of the joints"
    )


def _crank_angle(rows: Rows, time: float) -> str:
    """Return the angle of the first drive that turns a body, as the beginning of a message."""
    for drive in rows.linkage.drives:
        if drive.follow is None:
            angle = float(drive.motion(np.array([time]))[0][0]) - drive.angle
            return f"at crank angle {math.degrees(abs(angle)):.1f} deg "
    return ""


def _refusal(rows: Rows, time: float, joint: str) -> AssemblyError:
    where = _crank_angle(rows, time)
    refused = next(
        (one.name for one in rows.linkage.drives if one.follow is not None), None
    )
    if refused is not None:
        return AssemblyError(
            f"{refused} cannot make its point follow the curve: {where}({time:.6g} s after the "
            "start) the point is out of reach, or the drive at a dead point"
        )
    return AssemblyError(
        f"the linkage cannot be assembled over the cycle: {where}joint {joint} does not close or "
        "is at a dead point"
    )
