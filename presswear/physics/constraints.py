"""Constraint equations of a planar linkage: Phi(q, t) = 0 and its derivatives.

Equations 14 to 16 of the paper for any linkage: two rows for a revolute joint or a
guide, one for a drive.  The Jacobian is kept by rows (compressed); its pattern is
fixed, only the entries that depend on the angles change.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage
from presswear.physics.motion import drive_motion, motions_of
from presswear.tools.compile import Records, compiled, inlined

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

REVOLUTE, GUIDE, DRIVE = 0, 1, 2

CONSTRAINT = np.dtype(
    [
        ("kind", np.int64),
        ("row", np.int64),  # first row
        ("first", np.int64),  # index of the body's x in q, -1 for the frame
        ("second", np.int64),
        ("x1", np.float64),  # points in their bodies' frames, m
        ("y1", np.float64),
        ("x2", np.float64),
        ("y2", np.float64),
        ("angle", np.float64),  # of the body on a guide, rad
        ("drive", np.int64),  # its place among the motions
        ("normal_x", np.float64),  # of a guide
        ("normal_y", np.float64),
    ]
)
"""A constraint as the kernels see it."""


@inlined
def lever(body: int, x: float, y: float, q: Array) -> tuple[float, float]:
    """A point of a body relative to its mass centre, in global directions, m."""
    if body < 0:
        return x, y
    cosine = math.cos(q[body + 2])
    sine = math.sin(q[body + 2])
    return cosine * x - sine * y, sine * x + cosine * y


@compiled
def constraint_rows(
    constraints: Records,
    motions: Records,
    row_start: Indices,
    t: float,
    q: Array,
    v: Array,
    phi: Array,
    phi_t: Array,
    gamma: Array,
    jacobian: Array,
) -> None:
    """Fill Phi, dPhi/dt, gamma (equation 16) and the changing entries of the Jacobian.

    Parameters
    ----------
    motions : records of MOTION
        Of the drives.
    row_start : ndarray, shape (rows + 1,)
        Where each row's entries begin in ``jacobian``.
    phi, phi_t, gamma : ndarray, shape (rows,)
    jacobian : ndarray, shape (entries,)
    """
    for i in range(constraints.shape[0]):
        c = constraints[i]
        row = c.row
        if c.kind == REVOLUTE:
            x1, y1 = lever(c.first, c.x1, c.y1, q)
            x2, y2 = lever(c.second, c.x2, c.y2, q)
            px, py, vx, vy, gx, gy = x1 - x2, y1 - y2, 0.0, 0.0, 0.0, 0.0
            entry_x = row_start[row] + 1
            entry_y = row_start[row + 1] + 1
            if c.first >= 0:
                spin = v[c.first + 2]
                px += q[c.first]
                py += q[c.first + 1]
                vx += v[c.first] - spin * y1
                vy += v[c.first + 1] + spin * x1
                gx += spin * spin * x1
                gy += spin * spin * y1
                jacobian[entry_x] = -y1
                jacobian[entry_y] = x1
                entry_x += 2
                entry_y += 2
            if c.second >= 0:
                spin = v[c.second + 2]
                px -= q[c.second]
                py -= q[c.second + 1]
                vx -= v[c.second] - spin * y2
                vy -= v[c.second + 1] + spin * x2
                gx -= spin * spin * x2
                gy -= spin * spin * y2
                jacobian[entry_x] = y2
                jacobian[entry_y] = -x2
            phi[row], phi[row + 1] = px, py
            phi_t[row], phi_t[row + 1] = vx, vy
            gamma[row], gamma[row + 1] = gx, gy
        elif c.kind == GUIDE:
            phi[row] = (q[c.first] - c.x1) * c.normal_x + (q[c.first + 1] - c.y1) * c.normal_y
            phi_t[row] = v[c.first] * c.normal_x + v[c.first + 1] * c.normal_y
            phi[row + 1] = q[c.first + 2] - c.angle
            phi_t[row + 1] = v[c.first + 2]
            gamma[row] = gamma[row + 1] = 0.0
        else:
            drive = motions[c.drive]
            turned, speed, faster = drive_motion(drive, t)
            phi[row] = q[c.first + 2] - drive.angle - turned
            phi_t[row] = v[c.first + 2] - speed
            gamma[row] = faster


@dataclass(frozen=True)
class Constraints:
    """The constraints of a linkage, packed.

    Attributes
    ----------
    records : record array of CONSTRAINT
    motions : record array of MOTION
    names : tuple of str
        Name of the joint behind each row.
    row_start : ndarray, shape (rows + 1,)
    column : ndarray, shape (entries,)
        Coordinate of each entry of the Jacobian.
    constant : ndarray, shape (entries,)
        The Jacobian with its constant entries set.
    """

    records: Records
    motions: Records
    names: tuple[str, ...]
    row_start: Indices
    column: Indices
    constant: Array

    @property
    def rows(self) -> int:
        """Number of constraint equations."""
        return len(self.names)

    def evaluate(self, t: float, q: Array, v: Array) -> tuple[Array, Array, Array, Array]:
        """Phi, dPhi/dt and gamma, each (rows,), and the dense Jacobian (rows, len(q))."""
        phi, phi_t, gamma = np.zeros((3, self.rows))
        entries = self.constant.copy()
        constraint_rows(
            self.records,
            self.motions,
            self.row_start,
            t,
            np.asarray(q),
            np.asarray(v),
            phi,
            phi_t,
            gamma,
            entries,
        )
        dense = np.zeros((self.rows, q.size))
        for row in range(self.rows):
            part = slice(self.row_start[row], self.row_start[row + 1])
            dense[row, self.column[part]] = entries[part]
        return phi, phi_t, gamma, dense


def constraints_of(linkage: Linkage) -> Constraints:
    """Pack the ideal joints, guides and drives of a linkage."""
    records = np.zeros(
        len(linkage.revolutes) + len(linkage.guides) + len(linkage.drives), CONSTRAINT
    )
    rows: list[list[tuple[int, float]]] = []
    names: list[str] = []
    place = iter(records)

    def offset(point: Attachment) -> int:
        return -1 if point.body == GROUND else 3 * linkage.index(point.body)

    for joint in linkage.revolutes:
        record = next(place)
        record["kind"], record["row"] = REVOLUTE, len(rows)
        record["first"], record["second"] = offset(joint.first), offset(joint.second)
        record["x1"], record["y1"] = joint.first.x, joint.first.y
        record["x2"], record["y2"] = joint.second.x, joint.second.y
        for axis in (0, 1):
            entries: list[tuple[int, float]] = []
            for body, sign in ((record["first"], 1.0), (record["second"], -1.0)):
                if body >= 0:
                    entries += [(int(body) + axis, sign), (int(body) + 2, 0.0)]
            rows.append(entries)
        names += [joint.name, joint.name]
    for guide in linkage.guides:
        record = next(place)
        record["kind"], record["row"] = GUIDE, len(rows)
        record["first"] = body = 3 * linkage.index(guide.body)
        record["x1"], record["y1"], record["angle"] = guide.x, guide.y, guide.angle
        normal = -math.sin(guide.direction), math.cos(guide.direction)
        record["normal_x"], record["normal_y"] = normal
        rows.append([(body, normal[0]), (body + 1, normal[1])])
        rows.append([(body + 2, 1.0)])
        names += [guide.name, guide.name]
    for index, drive in enumerate(linkage.drives):
        record = next(place)
        record["kind"], record["row"] = DRIVE, len(rows)
        record["first"] = body = 3 * linkage.index(drive.body)
        record["drive"] = index
        rows.append([(body + 2, 1.0)])
        names.append(drive.name)
    sizes = [len(entries) for entries in rows]
    flat = [entry for entries in rows for entry in entries]
    return Constraints(
        records=records,
        motions=motions_of(linkage),
        names=tuple(names),
        row_start=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        column=np.array([column for column, _ in flat], dtype=np.int64),
        constant=np.array([value for _, value in flat], dtype=float),
    )
