"""Open trees: linkages without a closed loop that has a freedom, in the fewest coordinates.

Each body has one coordinate: its angle relative to its parent, or its position along a guide; a
free body has three. A branch that hangs from a prescribed body is described in axes that translate
with its hinge, so that the motion of the hinge enters as a force -m a and is exact.
"""

import math
from collections.abc import Sequence

import numpy as np

from presswear.linkage.elements import GROUND, Guide
from presswear.linkage.linkage import Branch, Linkage
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, floats, inlined
from presswear.tools.lanes import rounded, where

# A body of a tree as the kernels see it; parents come before children
LINK = np.dtype(
    [
        ("body", np.int64),  # index of its x in q
        ("kind", np.int64),  # HINGED, GUIDED or LOOSE
        ("place", np.int64),  # of its coordinate, or the first of three, in those of the tree
        ("parent", np.int64),  # link it hangs from, on whose angle its coordinate counts; -1: none
        ("before", np.int64),  # index in q of the body it hangs from; -1 for the frame
        ("below", np.int64),  # link it hangs from; -1 for the frame or a prescribed body
        ("drive", np.int64),  # place of its drive among the linkage's; -1 for none
        *floats("before_x", "before_y"),  # joint in the frame of the body before, m
        *floats("own_x", "own_y"),  # joint in the body's own frame, m
        *floats("cosine", "sine"),  # of the guide's direction
        ("angle", np.float64),  # of a sliding body, rad
        *floats("axis_x", "axis_y"),  # cosine and sine of that
        *floats("mass", "inertia"),
    ]
)

HINGED, GUIDED, LOOSE = 0, 1, 2
COORDINATES = (1, 1, 3)  # number of coordinates of each kind of link

CARRIED = 4  # transport velocity and acceleration of a branch: v_x, v_y, a_x, a_y of its hinge


# Halves of pi / 2 whose products with whole numbers below a million are exact, and coefficients
# of minimax polynomials: fdlibm (Sun Microsystems, 1993), k_sin.c, k_cos.c and e_rem_pio2.c
_HALF_PI = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
S1, S2, S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
S4, S5, S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10
C1, C2, C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
C4, C5, C6 = -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11


@inlined
def cos_sin(x: float) -> tuple[float, float]:
    """Return cosine and sine to 2.3e-16, of up to a million turns."""
    turns = rounded(x * (2.0 / math.pi))
    r = ((x - turns * _HALF_PI[0]) - turns * _HALF_PI[1]) - turns * _HALF_PI[2]
    z = r * r
    sine = r + z * r * (S1 + z * (S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)))))
    half = 0.5 * z
    cosine = 1.0 - half
    rest = z * (z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6))))))
    cosine += (1.0 - cosine) - half + rest
    # Quarters of a turn, of which every second one swaps both.
    half_turns = rounded(0.5 * turns)
    is_odd = turns - 2.0 * half_turns
    swapped = is_odd != 0.0
    sign = 1.0 - 2.0 * abs(half_turns - 2.0 * rounded(0.5 * half_turns))
    # Behind half_turns half turns, is_odd quarters are left, one or minus one.
    c, s = where(swapped, -is_odd * sine, cosine), where(swapped, is_odd * cosine, sine)
    return sign * c, sign * s


@inlined
def arm(x: float, y: float, axes: Array, body: int) -> tuple[float, float]:
    """Return a vector of the frame of the body whose x is ``q[body]``, in global directions."""
    cosine, sine = axes[body], axes[body + 1]
    return cosine * x - sine * y, sine * x + cosine * y


@inlined
def place_links(links: Records, x: Array, u: Array, q: Array, v: Array, axes: Array) -> None:
    """Fill coordinates and rates of the bodies of a tree from those of the tree.

    ``x`` are angles relative to the parent, or ways along guides, rad or m; of a loose body x, y
    and angle. ``axes`` are cosine and sine of each body's angle, in the places of its x and y.
    Those of the prescribed bodies must be there already, like their coordinates and rates.
    """
    for i in range(links.shape[0]):
        link = links[i]
        b, c = link.body, link.place
        if link.kind == GUIDED:
            q[b] = link.before_x + x[c] * link.cosine
            q[b + 1] = link.before_y + x[c] * link.sine
            q[b + 2] = link.angle
            v[b], v[b + 1] = u[c] * link.cosine, u[c] * link.sine
            v[b + 2] = 0.0
            axes[b], axes[b + 1] = link.axis_x, link.axis_y
            continue
        p = link.before
        jx, jy, jvx, jvy, angle, spin = link.before_x, link.before_y, 0.0, 0.0, 0.0, 0.0
        if p >= 0:
            rx, ry = arm(link.before_x, link.before_y, axes, p)
            jx, jy = q[p] + rx, q[p + 1] + ry
            jvx, jvy = v[p] - v[p + 2] * ry, v[p + 1] + v[p + 2] * rx
            if link.parent >= 0:
                angle, spin = q[p + 2], v[p + 2]
        elif link.kind == LOOSE:
            jx, jy, jvx, jvy = x[c], x[c + 1], u[c], u[c + 1]
            c += 2
        angle += x[c]
        spin += u[c]
        axes[b], axes[b + 1] = cos_sin(angle)
        rx, ry = arm(link.own_x, link.own_y, axes, b)
        q[b], q[b + 1] = jx - rx, jy - ry
        q[b + 2] = angle
        v[b], v[b + 1] = jvx + spin * ry, jvy - spin * rx
        v[b + 2] = spin


@inlined
def accelerate_links(links: Records, u_t: Array, v: Array, axes: Array, a: Array) -> None:
    """Fill the accelerations of a tree; those of prescribed bodies must be there already."""
    for i in range(links.shape[0]):
        link = links[i]
        b, c = link.body, link.place
        if link.kind == GUIDED:
            a[b], a[b + 1] = u_t[c] * link.cosine, u_t[c] * link.sine
            a[b + 2] = 0.0
            continue
        p = link.before
        jax, jay, spin_t = 0.0, 0.0, 0.0
        if p >= 0:
            rx, ry = arm(link.before_x, link.before_y, axes, p)
            square = v[p + 2] * v[p + 2]
            jax = a[p] - a[p + 2] * ry - square * rx
            jay = a[p + 1] + a[p + 2] * rx - square * ry
            if link.parent >= 0:
                spin_t = a[p + 2]
        elif link.kind == LOOSE:
            jax, jay = u_t[c], u_t[c + 1]
            c += 2
        spin_t += u_t[c]
        rx, ry = arm(link.own_x, link.own_y, axes, b)
        square = v[b + 2] * v[b + 2]
        a[b], a[b + 1] = jax + spin_t * ry + square * rx, jay - spin_t * rx + square * ry
        a[b + 2] = spin_t


@inlined
def carry_branches(links: Records, v: Array, a: Array, axes: Array, carried: Array) -> None:
    """Fill velocity and acceleration of what each branch hangs from, shape (links, CARRIED)."""
    for i in range(links.shape[0]):
        link = links[i]
        p = link.before
        if link.parent >= 0 or p < 0:
            # Numba copies single numbers faster than short rows.
            for c in range(CARRIED):
                carried[i, c] = carried[link.parent, c] if link.parent >= 0 else 0.0
            continue
        rx, ry = arm(link.before_x, link.before_y, axes, p)
        spin = v[p + 2]
        carried[i, 0] = v[p] - spin * ry
        carried[i, 1] = v[p + 1] + spin * rx
        faster = a[p + 2]
        carried[i, 2] = a[p] - faster * ry - spin * spin * rx
        carried[i, 3] = a[p + 1] + faster * rx - spin * spin * ry


@inlined
def gather_forces(links: Records, q: Array, axes: Array, force: Array, out: Array) -> None:
    """Turn forces on the bodies into forces on the coordinates of the tree, J^T f.

    Forces on the mass centres are passed down the branches: at the end each body holds what it and
    all that hangs from it bear, prescribed bodies included.
    """
    for i in range(links.shape[0] - 1, -1, -1):
        link = links[i]
        b, c = link.body, link.place
        fx, fy = force[b], force[b + 1]
        if link.kind == GUIDED:
            out[c] = fx * link.cosine + fy * link.sine
            continue
        rx, ry = arm(link.own_x, link.own_y, axes, b)
        moment = force[b + 2] - rx * fy + ry * fx
        if link.kind == LOOSE:
            out[c], out[c + 1] = fx, fy
            c += 2
        out[c] = moment
        p = link.before
        if p >= 0:
            sx, sy = q[b] + rx - q[p], q[b + 1] + ry - q[p + 1]
            force[p] += fx
            force[p + 1] += fy
            force[p + 2] += sx * fy - sy * fx
            if link.parent >= 0:
                force[p + 2] += moment


def pack_links(linkage: Linkage, branches: Sequence[Branch]) -> Records:
    """Return the bodies of a tree as records of LINK."""
    links = np.zeros(len(branches), LINK)
    place = 0
    for link, (joint, before, child, parent) in zip(links, branches, strict=True):
        link["body"] = 3 * linkage.index(child.body)
        link["kind"] = LOOSE if joint is None else HINGED
        link["parent"], link["below"], link["drive"] = parent, parent, -1
        link["before"] = -1 if before.body == GROUND else 3 * linkage.index(before.body)
        link["before_x"], link["before_y"] = before.x, before.y
        link["own_x"], link["own_y"] = child.x, child.y
        body = linkage.bodies[linkage.index(child.body)]
        link["mass"], link["inertia"] = body.mass, body.effective_inertia
        if isinstance(joint, Guide):
            link["kind"] = GUIDED
            link["cosine"], link["sine"] = math.cos(joint.direction), math.sin(joint.direction)
            link["angle"] = joint.angle
            link["axis_x"], link["axis_y"] = math.cos(joint.angle), math.sin(joint.angle)
        link["place"] = place
        place += COORDINATES[link["kind"]]
    return links
