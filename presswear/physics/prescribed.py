"""Bodies whose motion drives and joints prescribe, and the open tree that hangs from them.

Prescribed bodies form a tree on the frame whose coordinates are absolute angles and positions along
guides. Drives prescribe some of these coordinates. The others follow from the pins that close the
loops, by Newton's method from the last position; rates and accelerations by linear equations. No
equation of motion is solved for them. The torques of their drives follow from the forces on them
by virtual work.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from presswear.linkage.elements import GROUND
from presswear.linkage.linkage import Linkage, branches_of, chain_of, prescribed_of
from presswear.physics.drive_motion import MOTION, drive_motion, motions_of
from presswear.physics.tree import (
    COORDINATES,
    GUIDED,
    LINK,
    LOOSE,
    accelerate_links,
    arm,
    pack_links,
    place_links,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, floats, inlined, lazily_compiled

# A pin that closes a loop of prescribed bodies, two rows; as many of their angles are sought
CLOSING = np.dtype(
    [
        ("first", np.int64),  # part; -1 for the frame
        ("second", np.int64),
        *floats("x1", "y1", "x2", "y2"),  # points in their bodies' frames, m
    ]
)

PLACE, RATE, FASTER, BORNE, TURNS, RIGHT, LAST, HEAD = range(8)
# Rows of ``Prescribed.work``: coordinates, rates, accelerations, forces on them, their turns
# with a drive, a right-hand side, and one of the last evaluation's time, s, and determinant;
# then the closing rows by all coordinates, and those by the coordinates that are solved for
TIME, DETERMINANT = 0, 1

MOST_NEWTON = 30  # newton steps after which loops do not close; two are usual
# Newton's way from where bodies are expected to where links could be on other sides, rad or m
JUMP = 0.05
CLOSED = 1e-12  # newton step behind which the rows are those of the place found, rad or m


class Prescribed(NamedTuple):
    """Prescribed bodies, parents before children."""

    parts: Records  # of LINK; one hinged to the frame has its inertia about the hinge, and no mass
    closings: Records  # of CLOSING; None where several replicates run together
    motions: Records  # of all drives
    # Their last motion, from which the next is found, and working space, see PLACE and what
    # follows: (HEAD + 4 closings, parts or 2)
    work: Array


# Tells the types of what is prescribed
SOME = Prescribed(np.zeros(0, LINK), np.zeros(0, CLOSING), np.zeros(0, MOTION), np.zeros((0, 0)))


def begin_motion(prescribed: Prescribed, t: float, q: Array) -> None:
    """Note a state of all bodies from which the motion is to go on, and its time, s."""
    parts, _, _, work = prescribed
    b = parts["body"]
    along = (q[b] - parts["before_x"]) * parts["cosine"]
    along += (q[b + 1] - parts["before_y"]) * parts["sine"]
    work[:] = 0.0
    work[LAST, TIME] = t
    work[PLACE, : b.size] = np.where(parts["kind"] == GUIDED, along, q[b + 2])


@inlined
def place_prescribed(
    prescribed: Prescribed, t: float, q: Array, v: Array, a: Array, axes: Array
) -> None:
    """Fill coordinates, rates and accelerations of the prescribed bodies at a time, s.

    Not finite where their loops do not close near where they are expected, on the same side.
    ``axes`` are those of ``place_links``.
    """
    parts, closings, motions, work = prescribed
    ahead = t - work[LAST, TIME]
    work[LAST, TIME] = t
    for i in range(parts.shape[0]):
        if parts[i].drive >= 0:
            motion = motions[parts[i].drive]
            turned, work[RATE, i], work[FASTER, i] = drive_motion(motion, t)
            work[PLACE, i] = motion.angle + turned
        else:
            work[PLACE, i] += ahead * (work[RATE, i] + 0.5 * ahead * work[FASTER, i])
    place_links(parts, work[PLACE], work[RATE], q, v, axes)
    accelerate_links(parts, work[FASTER], v, axes, a)
    _close_loops(prescribed, closings, q, v, a, axes)


@inlined
def _close_loops(
    prescribed: Prescribed, closings: Records | None, q: Array, v: Array, a: Array, axes: Array
) -> None:
    """Find the place, rates and accelerations at which the loops of prescribed bodies close."""
    if closings is None:
        return
    if closings.shape[0] == 0:
        return
    parts, _, _, work = prescribed
    before, last, moved = work[LAST, DETERMINANT], math.inf, 0.0
    for _ in range(MOST_NEWTON):
        step = _newton_step(prescribed, q, axes)
        # Near a dead point round-off does not shrink to that.
        is_closed = step <= CLOSED or (step < 1e3 * CLOSED and step >= 0.5 * last)
        last = step
        moved += step
        if not moved < JUMP:
            break
        if is_closed:
            if before * work[LAST, DETERMINANT] < 0.0:
                break
            _follow(prescribed)
        place_links(parts, work[PLACE], work[RATE], q, v, axes)
        accelerate_links(parts, work[FASTER], v, axes, a)
        if is_closed:
            return
    for i in range(parts.shape[0]):
        work[PLACE, i] = q[parts[i].body] = math.nan


@lazily_compiled(0, SOME, np.int64(0))
def _solve(prescribed: Prescribed, row: int) -> float:
    """Solve for the right-hand side by Gauss elimination, and subtract it from a row of ``work``.

    Returns the greatest change; leaves the determinant.
    """
    parts, closings, _, work = prescribed
    count = 2 * closings.shape[0]
    matrix, right, target = work[HEAD + count :], work[RIGHT], work[row]
    column = 0
    for i in range(parts.shape[0]):
        if parts[i].drive < 0:
            for r in range(count):
                matrix[r, column] = work[HEAD + r, i]
            column += 1
    determinant = 1.0
    for c in range(count):
        best = c
        for r in range(c + 1, count):
            best = r if abs(matrix[r, c]) > abs(matrix[best, c]) else best
        if best != c:
            determinant = -determinant
            right[c], right[best] = right[best], right[c]
            for k in range(c, count):
                matrix[c, k], matrix[best, k] = matrix[best, k], matrix[c, k]
        determinant *= matrix[c, c]
        for r in range(c + 1, count):
            factor = matrix[r, c] / matrix[c, c]
            right[r] -= factor * right[c]
            for k in range(c + 1, count):
                matrix[r, k] -= factor * matrix[c, k]
    work[LAST, DETERMINANT] = determinant
    greatest = 0.0
    for c in range(count - 1, -1, -1):
        for k in range(c + 1, count):
            right[c] -= matrix[c, k] * right[k]
        right[c] /= matrix[c, c]
        greatest = max(greatest, abs(right[c]))
    column = 0
    for i in range(parts.shape[0]):
        if parts[i].drive < 0:
            target[i] -= right[column]
            column += 1
    return greatest


@lazily_compiled(0, SOME, 1, 1)
def _newton_step(prescribed: Prescribed, q: Array, axes: Array) -> float:
    """Make a step towards closed loops; returns its size, leaves the rows."""
    parts, closings, _, work = prescribed
    work[RIGHT] = 0.0
    work[HEAD : HEAD + 2 * closings.shape[0]] = 0.0
    for row in range(0, 2 * closings.shape[0], 2):
        pin = closings[row // 2]
        across, up = work[HEAD + row], work[HEAD + row + 1]
        ends = ((pin.first, pin.x1, pin.y1, 1.0), (pin.second, pin.x2, pin.y2, -1.0))
        for end, x, y, sign in ends:
            i, px, py = end, x, y
            if i >= 0:
                b = parts[i].body
                px, py = arm(x, y, axes, b)
                px += q[b]
                py += q[b + 1]
            work[RIGHT, row] += sign * px
            work[RIGHT, row + 1] += sign * py
            # The rows by the coordinates of all parts down to the frame
            while i >= 0:
                part = parts[i]
                if part.kind == GUIDED:
                    across[i] += sign * part.cosine
                    up[i] += sign * part.sine
                    break
                hx, hy = arm(part.own_x, part.own_y, axes, part.body)
                hx += q[part.body]
                hy += q[part.body + 1]
                across[i] -= sign * (py - hy)
                up[i] += sign * (px - hx)
                px, py = hx, hy
                i = part.below
    return _solve(prescribed, PLACE)


@lazily_compiled(None, SOME)
def _follow(prescribed: Prescribed) -> None:
    """Fill the rates and accelerations sought, in a place where all loops are closed."""
    parts, closings, _, work = prescribed
    right = work[RIGHT]
    for level in (RATE, FASTER):
        for i in range(parts.shape[0]):
            if parts[i].drive < 0:
                work[level, i] = 0.0
        for c in range(closings.shape[0]):
            across, up = work[HEAD + 2 * c], work[HEAD + 2 * c + 1]
            gap_x = gap_y = 0.0
            for i in range(parts.shape[0]):
                gap_x += across[i] * work[level, i]
                gap_y += up[i] * work[level, i]
                if level == FASTER and parts[i].kind != GUIDED:
                    square = work[RATE, i] * work[RATE, i]
                    gap_x -= square * up[i]
                    gap_y += square * across[i]
            right[2 * c], right[2 * c + 1] = gap_x, gap_y
        _solve(prescribed, level)


@inlined
def drive_torques(
    prescribed: Prescribed, q: Array, axes: Array, force: Array, torque: Array
) -> None:
    """Fill the torques, N m, that drives must give against the generalized forces on all parts.

    Those of inertia are among the forces, which are passed down to what the parts hang from. By
    virtual work: what a part bears about its hinge, times its turn with the drive. Torques of
    drives of other bodies stay.
    """
    parts, closings, _, work = prescribed
    borne = work[BORNE]
    for i in range(parts.shape[0] - 1, -1, -1):
        part = parts[i]
        b = part.body
        if part.kind == GUIDED:
            borne[i] = force[b] * part.cosine + force[b + 1] * part.sine
            continue
        hx, hy = part.before_x, part.before_y
        p = part.before
        if p >= 0:
            lx, ly = arm(hx, hy, axes, p)
            force[p] += force[b]
            force[p + 1] += force[b + 1]
            force[p + 2] += lx * force[b + 1] - ly * force[b]
            hx, hy = q[p] + lx, q[p + 1] + ly
        borne[i] = force[b + 2] + (q[b] - hx) * force[b + 1] - (q[b + 1] - hy) * force[b]
    for i in range(parts.shape[0]):
        if parts[i].drive < 0:
            continue
        torque[parts[i].drive] = -borne[i] - _turned_share(prescribed, closings, i)


@inlined
def _turned_share(prescribed: Prescribed, closings: Records | None, i: int) -> float:
    """Return the moment, N m, that part ``i`` bears of the parts without a drive that it turns."""
    share = 0.0
    if closings is not None:
        right, turns = prescribed.work[RIGHT], prescribed.work[TURNS]
        for r in range(2 * closings.shape[0]):
            right[r] = prescribed.work[HEAD + r, i]
        if closings.shape[0] > 0:
            turns[:] = 0.0
            _solve(prescribed, TURNS)
            for k in range(prescribed.parts.shape[0]):
                share += prescribed.work[BORNE, k] * turns[k]
    return share


@inlined
def forced_power(prescribed: Prescribed, v: Array, a: Array, force: Array) -> float:
    """Return the power, W, of the forces on prescribed bodies, less the power of their inertia."""
    power = 0.0
    parts = prescribed.parts
    for i in range(parts.shape[0]):
        part = parts[i]
        b = part.body
        for c in range(b, b + 3):
            power += force[c] * v[c]
        power -= part.inertia * a[b + 2] * v[b + 2]
        if part.mass > 0.0:
            power -= part.mass * (a[b] * v[b] + a[b + 1] * v[b + 1])
    return power


@inlined
def subtract_inertia(parts: Records, a: Array, force: Array) -> None:
    """Subtract the inertia of prescribed bodies, or of links, from generalized forces."""
    for i in range(parts.shape[0]):
        part = parts[i]
        b = part.body
        force[b] -= part.mass * a[b]
        force[b + 1] -= part.mass * a[b + 1]
        force[b + 2] -= part.inertia * a[b + 2]


def pack_prescribed(linkage: Linkage, bodies: frozenset[str]) -> Prescribed:
    """Return the bodies that drives hold without freedom, for the kernels; see ``begin_motion``."""
    branches, pins = chain_of(linkage, bodies)
    parts = pack_links(linkage, branches)
    parts["parent"] = -1  # coordinates are absolute angles, whatever a body hangs from
    places = {branch.end.body: i for i, branch in enumerate(branches)} | {GROUND: -1}
    for number, drive in enumerate(linkage.drives):
        if drive.body in bodies:
            parts[places[drive.body]]["drive"] = number
    for part, branch in zip(parts, branches, strict=True):
        if part["before"] < 0 and part["kind"] != GUIDED:
            part["inertia"] += part["mass"] * (branch.end.x**2 + branch.end.y**2)
            part["mass"] = 0.0
    closings = np.zeros(len(pins), CLOSING)
    for closing, pin in zip(closings, pins, strict=True):
        closing["first"], closing["second"] = places[pin.first.body], places[pin.second.body]
        closing["x1"], closing["y1"] = pin.first.x, pin.first.y
        closing["x2"], closing["y2"] = pin.second.x, pin.second.y
    work = np.zeros((HEAD + 4 * len(pins), max(len(parts), 2)))
    return Prescribed(parts, closings, motions_of(linkage), work)


@dataclass(frozen=True)
class Tree:
    """A linkage as an open tree that hangs from prescribed bodies and the frame."""

    links: Records
    names: tuple[str, ...]  # body of each link
    prescribed: Prescribed

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(COORDINATES[kind] for kind in self.links["kind"])

    def coordinates(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return the coordinates and rates of the tree in a state of all bodies, each (size,)."""
        x, u = np.zeros(self.size), np.zeros(self.size)
        for link in self.links:
            b, c = link["body"], link["place"]
            if link["kind"] == GUIDED:
                along = np.array([link["cosine"], link["sine"]])
                x[c] = along @ (q[b : b + 2] - [link["before_x"], link["before_y"]])
                u[c] = along @ v[b : b + 2]
                continue
            if link["kind"] == LOOSE:
                x[c : c + 2], u[c : c + 2] = q[b : b + 2], v[b : b + 2]
                c += 2
            x[c], u[c] = q[b + 2], v[b + 2]
            if link["parent"] >= 0:
                x[c] -= q[link["before"] + 2]
                u[c] -= v[link["before"] + 2]
        return x, u


def tree_of(linkage: Linkage) -> Tree | str:
    """Return a linkage as an open tree, or the reason why it is none."""
    branches = branches_of(linkage)
    if isinstance(branches, str):
        return branches
    return Tree(
        pack_links(linkage, branches),
        tuple(branch.end.body for branch in branches),
        pack_prescribed(linkage, prescribed_of(linkage)),
    )
