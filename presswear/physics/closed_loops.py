"""Motion of prescribed bodies in closed loops, and the torques of their drives.

Newton's method computes the coordinates that no drive prescribes, starting from the
last position. Linear equations give their rates and accelerations. The torques of the
drives follow from the forces on the bodies by virtual work. Each prescribed body is a
part: its coordinate is an angle, or the distance along its guide. Pins between two
parts close the loops.
"""

import math

import numpy as np

from presswear.physics.drive_motion import drive_motion
from presswear.physics.prescribed import (
    ACCELERATION,
    CLOSING,
    COORDINATE,
    DETERMINANT,
    FORCE,
    HEAD,
    LAST,
    PART,
    RATE,
    RATIO,
    RIGHT,
    TIME,
    Prescribed,
    place_parts,
)
from presswear.physics.rotation import arm
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

MOST_NEWTON = 30  # largest number of Newton steps; two are usual
# Largest sum of the Newton steps from the expected position, rad or m. After a larger
# change the links could be in the other configuration of the loop.
JUMP = 0.05
# Newton step after which loops count as closed, rad or m
CLOSED = 1e-12
# Parameters of kernels that few linkages need: parts, closings and working space
_LOOPS = np.zeros(0, PART), np.zeros(0, CLOSING), np.zeros((1, 1))


@compiled
def place_prescribed(
    prescribed: Prescribed, t: float, q: Array, v: Array, a: Array, axes: Array
) -> None:
    """Fill coordinates, rates and accelerations of the prescribed bodies at a time, s.

    They are NaN if the loops do not close near the expected position in the same
    configuration. ``axes`` are those of ``place_parts``.
    """
    parts = prescribed.parts
    work = prescribed.work
    closings = prescribed.closings
    motions = prescribed.motions
    h = t - work[LAST, TIME]
    work[LAST, TIME] = t
    for i in range(parts.shape[0]):
        if parts[i].drive >= 0:
            motion = motions[parts[i].drive]
            sense = parts[i].sense
            angle, rate, acceleration = drive_motion(motion, t)
            work[COORDINATE, i] = sense * (motion.angle + angle) - parts[i].driven_angle
            work[RATE, i] = sense * rate
            work[ACCELERATION, i] = sense * acceleration
        else:
            work[COORDINATE, i] += h * (work[RATE, i] + 0.5 * h * work[ACCELERATION, i])
    place_parts(prescribed, q, v, a, axes)
    if closings.shape[0] > 0 and not _close_loops(prescribed, q, v, a, axes):
        for i in range(parts.shape[0]):
            work[COORDINATE, i] = q[parts[i].body] = math.nan


@compiled
def _close_loops(
    prescribed: Prescribed, q: Array, v: Array, a: Array, axes: Array
) -> bool:
    """Compute the motion that closes the loops; return whether they can be closed."""
    parts = prescribed.parts
    closings = prescribed.closings
    work = prescribed.work
    before = work[LAST, DETERMINANT]
    last = math.inf
    moved = 0.0
    for _ in range(MOST_NEWTON):
        step = _newton_step(parts, closings, work, q, axes)
        # Near a dead point round-off keeps the steps above this limit. They are then
        # small and no longer decrease.
        is_closed = step <= CLOSED or (step < 1e3 * CLOSED and step >= 0.5 * last)
        last = step
        moved += step
        if not moved < JUMP:
            return False
        if is_closed:
            if before * work[LAST, DETERMINANT] < 0.0:
                return False
            _follow(parts, closings, work)
        place_parts(prescribed, q, v, a, axes)
        if is_closed:
            return True
    return False


@compiled
def _solve(parts: Records, closings: Records, work: Array, row: int) -> float:
    """Solve for the right-hand side and subtract the solution from a row of ``work``.

    Returns the largest absolute value of the solution, and stores the determinant.
    """
    count = 2 * closings.shape[0]
    matrix = work[HEAD + count :]
    right = work[RIGHT]
    column = 0
    for i in range(parts.shape[0]):
        if parts[i].drive < 0:
            for r in range(count):
                matrix[r, column] = work[HEAD + r, i]
            column += 1
    work[LAST, DETERMINANT] = _eliminate(matrix, right, count)
    greatest = 0.0
    for c in range(count - 1, -1, -1):
        for k in range(c + 1, count):
            right[c] -= matrix[c, k] * right[k]
        right[c] /= matrix[c, c]
        greatest = max(greatest, abs(right[c]))
    column = 0
    for i in range(parts.shape[0]):
        if parts[i].drive < 0:
            work[row, i] -= right[column]
            column += 1
    return greatest


@compiled
def _eliminate(matrix: Array, right: Array, count: int) -> float:
    """Bring equations into triangular form; return the determinant.

    The method is Gauss elimination with row pivoting.
    """
    determinant = 1.0
    for c in range(count):
        pivot = c
        for r in range(c + 1, count):
            if abs(matrix[r, c]) > abs(matrix[pivot, c]):
                pivot = r
        if pivot != c:
            determinant = -determinant
            right[c], right[pivot] = right[pivot], right[c]
            for k in range(c, count):
                matrix[c, k], matrix[pivot, k] = matrix[pivot, k], matrix[c, k]
        determinant *= matrix[c, c]
        for r in range(c + 1, count):
            factor = matrix[r, c] / matrix[c, c]
            right[r] -= factor * right[c]
            for k in range(c + 1, count):
                matrix[r, k] -= factor * matrix[c, k]
    return determinant


@inlined
def line_of(part: Records, axes: Array) -> tuple[float, float]:
    """Return the direction of the guide of a part."""
    if part.before < 0:
        return part.cosine, part.sine
    return arm(part.cosine, part.sine, axes, part.before)


@lazily_compiled(0, *_LOOPS, 1, 1)
def _newton_step(
    parts: Records, closings: Records, work: Array, q: Array, axes: Array
) -> float:
    """Make a Newton step towards closed loops; return its size, and store the Jacobian."""
    work[RIGHT] = 0.0
    work[HEAD : HEAD + 2 * closings.shape[0]] = 0.0
    for row in range(0, 2 * closings.shape[0], 2):
        pin = closings[row // 2]
        across = work[HEAD + row]
        up = work[HEAD + row + 1]
        ends = ((pin.first, pin.x1, pin.y1, 1.0), (pin.second, pin.x2, pin.y2, -1.0))
        for end, x, y, sign in ends:
            i = end
            px = x
            py = y
            if i >= 0:
                b = parts[i].body
                px, py = arm(x, y, axes, b)
                px += q[b]
                py += q[b + 1]
            work[RIGHT, row] += sign * px
            work[RIGHT, row + 1] += sign * py
            # Derivatives of the gap by the coordinates of all parts down to the frame
            while i >= 0:
                part = parts[i]
                if part.is_guided:
                    ux, uy = line_of(part, axes)
                    across[i] += sign * ux
                    up[i] += sign * uy
                    i = part.parent
                    continue
                hx, hy = arm(part.end_x, part.end_y, axes, part.body)
                hx += q[part.body]
                hy += q[part.body + 1]
                across[i] -= sign * (py - hy)
                up[i] += sign * (px - hx)
                px = hx
                py = hy
                i = part.parent
    return _solve(parts, closings, work, COORDINATE)


@lazily_compiled(None, *_LOOPS)
def _follow(parts: Records, closings: Records, work: Array) -> None:
    """Fill rates and accelerations of parts without a drive, with all loops closed."""
    right = work[RIGHT]
    for level in (RATE, ACCELERATION):
        for i in range(parts.shape[0]):
            if parts[i].drive < 0:
                work[level, i] = 0.0
        for c in range(closings.shape[0]):
            across = work[HEAD + 2 * c]
            up = work[HEAD + 2 * c + 1]
            gap_x = gap_y = 0.0
            for i in range(parts.shape[0]):
                gap_x += across[i] * work[level, i]
                gap_y += up[i] * work[level, i]
                if level == ACCELERATION:
                    square = work[RATE, i] * work[RATE, i]
                    if parts[i].is_guided:  # the acceleration of Coriolis
                        k = parts[i].turning
                        square = 2.0 * work[RATE, i] * work[RATE, k] if k >= 0 else 0.0
                    gap_x -= square * up[i]
                    gap_y += square * across[i]
            right[2 * c] = gap_x
            right[2 * c + 1] = gap_y
        _solve(parts, closings, work, level)


@compiled
def drive_torques(
    prescribed: Prescribed, q: Array, axes: Array, force: Array, torque: Array
) -> None:
    """Fill the torques, N m, with which drives balance the generalized forces on all parts.

    ``force`` includes the inertia forces. The force on each part is added to that on its
    parent. By virtual work, the torque of a drive is minus the sum over the parts of
    the force on the coordinate, times the derivative of this coordinate by the angle of
    the drive. Torques of drives of other bodies do not change.
    """
    parts = prescribed.parts
    work = prescribed.work
    for i in range(parts.shape[0] - 1, -1, -1):
        part = parts[i]
        b = part.body
        if part.is_guided:
            ux, uy = line_of(part, axes)
            work[FORCE, i] = force[b] * ux + force[b + 1] * uy
            p = part.before
            if p >= 0:
                moment = (q[b] - q[p]) * force[b + 1] - (q[b + 1] - q[p + 1]) * force[b]
                force[p] += force[b]
                force[p + 1] += force[b + 1]
                force[p + 2] += force[b + 2] + moment
            continue
        hx = part.before_x
        hy = part.before_y
        p = part.before
        if p >= 0:
            lx, ly = arm(hx, hy, axes, p)
            force[p] += force[b]
            force[p + 1] += force[b + 1]
            force[p + 2] += lx * force[b + 1] - ly * force[b]
            hx = q[p] + lx
            hy = q[p + 1] + ly
        moment = (q[b] - hx) * force[b + 1] - (q[b + 1] - hy) * force[b]
        work[FORCE, i] = force[b + 2] + moment
    for i in range(parts.shape[0]):
        if parts[i].drive >= 0:
            force_on_part = work[FORCE, i]
            if prescribed.closings.shape[0] > 0:
                force_on_part += _force_of_others(parts, prescribed.closings, work, i)
            torque[parts[i].drive] = -parts[i].sense * force_on_part


@lazily_compiled(0, *_LOOPS, np.int64(0))
def _force_of_others(parts: Records, closings: Records, work: Array, i: int) -> float:
    """Return the moment at the drive of part ``i`` of the forces on parts without a drive, N m."""
    for r in range(2 * closings.shape[0]):
        work[RIGHT, r] = work[HEAD + r, i]
    work[RATIO] = 0.0
    _solve(parts, closings, work, RATIO)
    moment = 0.0
    for k in range(parts.shape[0]):
        moment += work[FORCE, k] * work[RATIO, k]
    return moment
