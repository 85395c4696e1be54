"""Constraint equations of a planar linkage, Phi(q, t) = 0, and their multipliers.

Equations 14 to 16 of the paper for any linkage: two rows for a revolute joint or a
guide, three for a guide with a spring, one for a drive. With the diagonal mass matrix M
equation 18 reduces to S lambda = r with S = Phi_q M^-1 Phi_q^T. The multipliers lambda
also project a state on the constraints.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from presswear.linkage.drives import GearedDrive
from presswear.linkage.linkage import Linkage
from presswear.physics.constraint_rows import Rows
from presswear.physics.drive_motion import drive_motion, motions_of
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, copy_to, floats, inlined

# Constraint row for the kernels: the distance of two points along a direction, or the
# angle of a body relative to another body, minus the prescribed value
CONSTRAINT = np.dtype(
    [
        ("first", np.int64),  # index of the body's x in q, -1 for the frame
        ("second", np.int64),
        *floats("x1", "y1", "x2", "y2"),  # points in their bodies' frames, m
        *floats("normal_x", "normal_y"),  # unit vector of the direction; 0 for an angle
        ("rotates", np.bool_),  # the direction turns with the second body
        ("is_angle", np.bool_),  # the row is angle of first - ratio * angle of second
        ("ratio", np.float64),  # factor of the angle of the second body
        ("geared", np.bool_),  # the drive has no motion of its own
        ("target", np.float64),  # value of the row, m or rad, before that of a drive
        ("drive", np.int64),  # index of its motion in ``motions``; -1 for none
    ]
)


class ConstraintSystem(NamedTuple):
    """Constraints that hold a linkage, with the working space to solve for their multipliers."""

    records: Records
    motions: Records
    inverse_mass: Array  # (3 bodies,)
    phi: Array  # Phi, (rows,)
    phi_t: Array  # dPhi/dt, (rows,)
    gamma: Array  # right-hand side of Phi_q a = gamma, equation 16, (rows,)
    right: Array  # right-hand side for the multipliers, overwritten by the solution, (rows,)
    multipliers: Array  # (rows,)
    jacobian: Array  # (rows, 3 bodies)
    matrix: Array  # S, then its factors, (rows, rows)


@inlined
def lever(body: int, x: float, y: float, q: Array) -> tuple[float, float]:
    """Return a point of a body relative to its mass centre, in global directions, m."""
    if body < 0:
        return x, y
    cosine = math.cos(q[body + 2])
    sine = math.sin(q[body + 2])
    return cosine * x - sine * y, sine * x + cosine * y


@compiled
def evaluate_constraints(
    constraints: ConstraintSystem, t: float, q: Array, v: Array
) -> None:
    """Evaluate Phi, dPhi/dt, gamma (equation 16) and the Jacobian in the working space."""
    phi = constraints.phi
    phi_t = constraints.phi_t
    gamma = constraints.gamma
    for row in range(constraints.records.shape[0]):
        c = constraints.records[row]
        evaluate_distance(constraints, row, q, v)
        if c.is_angle:
            evaluate_angle(constraints, row, q, v)
        if c.drive >= 0 and not c.geared:
            motion = constraints.motions[c.drive]
            angle, speed, acceleration = drive_motion(motion, t)
            phi[row] -= motion.angle
            phi[row] -= angle
            phi_t[row] -= speed
            gamma[row] += acceleration


@inlined
def evaluate_distance(
    constraints: ConstraintSystem, row: int, q: Array, v: Array
) -> None:
    """Evaluate a row as the distance of two points along a direction, (nx, ny)."""
    jacobian = constraints.jacobian
    c = constraints.records[row]
    nx = c.normal_x
    ny = c.normal_y
    if c.rotates:
        nx, ny = lever(c.second, c.normal_x, c.normal_y, q)
    gap_x = gap_y = rate_x = rate_y = centripetal_x = centripetal_y = 0.0
    for b, x, y, sign in ((c.first, c.x1, c.y1, 1.0), (c.second, c.x2, c.y2, -1.0)):
        px, py = lever(b, x, y, q)
        if b >= 0:
            spin = v[b + 2]
            rate_x += sign * (v[b] - spin * py)
            rate_y += sign * (v[b + 1] + spin * px)
            centripetal_x += sign * (spin * spin * px)
            centripetal_y += sign * (spin * spin * py)
            jacobian[row, b] = sign * nx
            jacobian[row, b + 1] = sign * ny
            jacobian[row, b + 2] = sign * (px * ny - py * nx)
            px += q[b]
            py += q[b + 1]
        gap_x += sign * px
        gap_y += sign * py
    phi = gap_x * nx + gap_y * ny
    constraints.phi[row] = phi
    constraints.phi_t[row] = rate_x * nx + rate_y * ny
    constraints.gamma[row] = centripetal_x * nx + centripetal_y * ny
    if c.rotates:
        spin = v[c.second + 2]
        tangential_gap = gap_y * nx - gap_x * ny
        tangential_rate = rate_y * nx - rate_x * ny
        constraints.phi_t[row] += spin * tangential_gap
        jacobian[row, c.second + 2] += tangential_gap
        # Turning of the direction: centripetal and Coriolis terms
        constraints.gamma[row] += spin * (spin * phi - 2.0 * tangential_rate)


@inlined
def evaluate_angle(constraints: ConstraintSystem, row: int, q: Array, v: Array) -> None:
    """Evaluate a row with ``is_angle``, without the motion of a drive."""
    phi = constraints.phi
    phi_t = constraints.phi_t
    jacobian = constraints.jacobian
    c = constraints.records[row]
    phi[row] = q[c.first + 2] - c.target
    phi_t[row] = v[c.first + 2]
    jacobian[row, c.first + 2] = 1.0
    if c.second >= 0:
        phi[row] -= c.ratio * q[c.second + 2]
        phi_t[row] -= c.ratio * v[c.second + 2]
        jacobian[row, c.second + 2] = -c.ratio


@compiled
def factor(constraints: ConstraintSystem) -> None:
    """Factor S = L D L^T in place: L below the diagonal of ``matrix``, D on it."""
    matrix = constraints.matrix
    jacobian = constraints.jacobian
    for i in range(matrix.shape[0]):
        for j in range(i + 1):
            total = 0.0
            for c in range(jacobian.shape[1]):
                total += jacobian[i, c] * jacobian[j, c] * constraints.inverse_mass[c]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k] * matrix[k, k]
            matrix[i, j] = total / matrix[j, j] if j < i else total


@compiled
def substitute(constraints: ConstraintSystem) -> None:
    """Solve for the multipliers with the factors of S; overwrites ``right``."""
    matrix = constraints.matrix
    right = constraints.right
    rows = right.shape[0]
    for i in range(rows):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
    for i in range(rows - 1, -1, -1):
        value = right[i] / matrix[i, i]
        for k in range(i + 1, rows):
            value -= matrix[k, i] * constraints.multipliers[k]
        constraints.multipliers[i] = value


@compiled
def solve(constraints: ConstraintSystem) -> None:
    """Solve for the multipliers by S = L D L^T; overwrites ``right``."""
    factor(constraints)
    substitute(constraints)


@compiled
def multipliers_of(
    constraints: ConstraintSystem, alpha: float, beta: float, force: Array
) -> None:
    """Solve equation 18 for the multipliers under generalized forces, after ``factor``.

    ``alpha`` and ``beta`` are the parameters of Baumgarte's stabilization, 1/s.
    """
    damping = 2.0 * alpha
    stiffness = beta * beta
    for row in range(constraints.phi.shape[0]):
        right = (
            damping * constraints.phi_t[row]
            + stiffness * constraints.phi[row]
            - constraints.gamma[row]
        )
        for c in range(force.shape[0]):
            right += (
                constraints.jacobian[row, c] * constraints.inverse_mass[c] * force[c]
            )
        constraints.right[row] = right
    substitute(constraints)


@compiled
def move(constraints: ConstraintSystem, level: Array) -> None:
    """Correct positions, velocities or accelerations, ``level``, by the error in ``right``."""
    solve(constraints)
    for row in range(constraints.phi.shape[0]):
        for c in range(level.shape[0]):
            level[c] -= (
                constraints.inverse_mass[c]
                * constraints.jacobian[row, c]
                * constraints.multipliers[row]
            )


@compiled
def project(constraints: ConstraintSystem, t: float, q: Array, v: Array) -> None:
    """Move a state onto the constraints: q by one Newton step, v exactly.

    Both use the metric of the mass matrix, so that the change of kinetic energy is of
    second order in the violation.
    """
    evaluate_constraints(constraints, t, q, v)
    copy_to(constraints.right, constraints.phi)
    move(constraints, q)
    evaluate_constraints(constraints, t, q, v)
    copy_to(constraints.right, constraints.phi_t)
    move(constraints, v)


@compiled
def project_acceleration(
    constraints: ConstraintSystem, t: float, q: Array, v: Array, a: Array
) -> None:
    """Move accelerations onto the constraints, which changes ``multipliers``.

    The multipliers are then those of the correction.
    """
    evaluate_constraints(constraints, t, q, v)
    for row in range(constraints.phi.shape[0]):
        constraints.right[row] = -constraints.gamma[row]
        for c in range(a.shape[0]):
            constraints.right[row] += constraints.jacobian[row, c] * a[c]
    move(constraints, a)


@dataclass(frozen=True)
class Constraints:
    """Constraints of a linkage as records of CONSTRAINT and MOTION.

    ``names`` holds the joint, guide or drive of each row.
    """

    records: Records
    motions: Records
    names: tuple[str, ...]

    @property
    def rows(self) -> int:
        """Number of constraint equations."""
        return len(self.names)

    def system(self, mass: Array) -> ConstraintSystem:
        """Return the constraints for the kernels; ``mass`` is the diagonal, shape (3 bodies,)."""
        rows = self.rows
        return ConstraintSystem(
            records=self.records,
            motions=self.motions,
            inverse_mass=1.0 / mass,
            phi=np.zeros(rows),
            phi_t=np.zeros(rows),
            gamma=np.zeros(rows),
            right=np.zeros(rows),
            multipliers=np.zeros(rows),
            jacobian=np.zeros((rows, mass.size)),
            matrix=np.zeros((rows, rows)),
        )

    def evaluate(
        self, t: float, q: Array, v: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return Phi, dPhi/dt and gamma, each (rows,), and the Jacobian (rows, 3 bodies)."""
        system = self.system(np.ones(q.size))
        evaluate_constraints(system, t, np.asarray(q), np.asarray(v))
        return system.phi, system.phi_t, system.gamma, system.jacobian


def constraints_of(linkage: Linkage) -> Constraints:
    """Pack the ideal joints, guides and drives of a linkage."""
    rows = Rows(linkage)
    records = np.zeros(len(rows.names), CONSTRAINT)
    first, second = rows.ends
    records["first"] = np.where(first.body < 0, -1, 3 * first.body)
    records["second"] = np.where(second.body < 0, -1, 3 * second.body)
    records["x1"] = first.x
    records["y1"] = first.y
    records["x2"] = second.x
    records["y2"] = second.y
    records["normal_x"] = rows.normal[:, 0]
    records["normal_y"] = rows.normal[:, 1]
    records["rotates"][rows.turning] = True
    records["is_angle"] = rows.turn
    records["target"] = rows.target
    records["ratio"] = rows.ratio
    records["drive"] = -1
    drives = [k for k, drive in enumerate(linkage.drives) if linkage.prescribes(drive)]
    first_of_drives = len(records) - len(drives)
    records["drive"][first_of_drives:] = drives
    for row, k in enumerate(drives, first_of_drives):
        records["geared"][row] = isinstance(linkage.drives[k], GearedDrive)
    return Constraints(records, motions_of(linkage), rows.names)
