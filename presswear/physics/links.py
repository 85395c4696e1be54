"""Bodies that hang from each other in a tree, placed from the fewest coordinates.

Each body has one coordinate: its angle relative to the body it hangs from, or its way along a
guide; a body that nothing holds has three.  A branch that hangs from a prescribed body is
described in axes that translate with its hinge, so that the motion of the hinge enters as a
force -m a and is exact, whatever its law.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Guide
from presswear.linkage.linkage import Branch, Linkage
from presswear.tools.compile import Records, inlined

Array = NDArray[np.float64]

LINK = np.dtype(
    [
        ("body", np.int64),  # index of its x in q
        ("kind", np.int64),  # HINGED, GUIDED or LOOSE
        ("place", np.int64),  # of its coordinate, or the first of three, in those of the tree
        ("parent", np.int64),  # link it hangs from; -1 for the frame or a prescribed body
        ("before", np.int64),  # index in q of the body it hangs from; -1 for the frame
        ("before_x", np.float64),  # joint in the frame of the body before, m
        ("before_y", np.float64),
        ("own_x", np.float64),  # joint in the body's own frame, m
        ("own_y", np.float64),
        ("cosine", np.float64),  # of the guide's direction
        ("sine", np.float64),
        ("angle", np.float64),  # of a sliding body, rad
        ("axis_x", np.float64),  # cosine and sine of that
        ("axis_y", np.float64),
        ("mass", np.float64),
        ("inertia", np.float64),  # kg m^2
    ]
)
"""A body of a tree as the kernels see it; parents come before children."""

HINGED, GUIDED, LOOSE = 0, 1, 2
COORDINATES = (1, 1, 3)
"""Number of coordinates of each kind of link."""

CARRIED = 4
"""Transport velocity and acceleration of a branch: v_x, v_y, a_x, a_y of its hinge."""


@inlined
def arm(x: float, y: float, axes: Array, body: int) -> tuple[float, float]:
    """A vector of the frame of the body whose x is ``q[body]``, in global directions."""
    cosine = axes[body]
    sine = axes[body + 1]
    return cosine * x - sine * y, sine * x + cosine * y


@inlined
def place_links(links: Records, x: Array, u: Array, q: Array, v: Array, axes: Array) -> None:
    """Fill coordinates and rates of the bodies of a tree from those of the tree.

    Parameters
    ----------
    x, u : ndarray, shape (coordinates,)
        Angles relative to the parent, or ways along guides, rad or m, and rates; of a loose
        body x, y and angle.
    q, v : ndarray, shape (3 bodies,)
    axes : ndarray, shape (3 bodies,)
        Cosine and sine of each body's angle, in the places of its x and y.  Those of the
        prescribed bodies must be there already, like their coordinates and rates.
    """
    for i in range(links.shape[0]):
        link = links[i]
        b = link.body
        c = link.place
        if link.kind == GUIDED:
            q[b] = link.before_x + x[c] * link.cosine
            q[b + 1] = link.before_y + x[c] * link.sine
            q[b + 2] = link.angle
            v[b] = u[c] * link.cosine
            v[b + 1] = u[c] * link.sine
            v[b + 2] = 0.0
            axes[b] = link.axis_x
            axes[b + 1] = link.axis_y
            continue
        p = link.before
        jx, jy, jvx, jvy, angle, spin = link.before_x, link.before_y, 0.0, 0.0, 0.0, 0.0
        if p >= 0:
            rx, ry = arm(link.before_x, link.before_y, axes, p)
            jx = q[p] + rx
            jy = q[p + 1] + ry
            jvx = v[p] - v[p + 2] * ry
            jvy = v[p + 1] + v[p + 2] * rx
            if link.parent >= 0:
                angle = q[p + 2]
                spin = v[p + 2]
        elif link.kind == LOOSE:
            jx, jy, jvx, jvy = x[c], x[c + 1], u[c], u[c + 1]
            c += 2
        angle += x[c]
        spin += u[c]
        axes[b] = math.cos(angle)
        axes[b + 1] = math.sin(angle)
        rx, ry = arm(link.own_x, link.own_y, axes, b)
        q[b] = jx - rx
        q[b + 1] = jy - ry
        q[b + 2] = angle
        v[b] = jvx + spin * ry
        v[b + 1] = jvy - spin * rx
        v[b + 2] = spin


@inlined
def accelerate_links(links: Records, u_t: Array, v: Array, axes: Array, a: Array) -> None:
    """Fill the accelerations of a tree; those of prescribed bodies must be there already."""
    for i in range(links.shape[0]):
        link = links[i]
        b = link.body
        c = link.place
        if link.kind == GUIDED:
            a[b] = u_t[c] * link.cosine
            a[b + 1] = u_t[c] * link.sine
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
        a[b] = jax + spin_t * ry + square * rx
        a[b + 1] = jay - spin_t * rx + square * ry
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

    Parameters
    ----------
    force : ndarray, shape (3 bodies,)
        On the mass centres.  Passed down the branches: at the end each body holds what
        it and all that hangs from it bear, prescribed bodies included.
    out : ndarray, shape (coordinates,)
    """
    for i in range(links.shape[0] - 1, -1, -1):
        link = links[i]
        b = link.body
        c = link.place
        fx = force[b]
        fy = force[b + 1]
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
            sx = q[b] + rx - q[p]
            sy = q[b + 1] + ry - q[p + 1]
            force[p] += fx
            force[p + 1] += fy
            force[p + 2] += sx * fy - sy * fx
            if link.parent >= 0:
                force[p + 2] += moment


def pack_links(linkage: Linkage, branches: Sequence[Branch]) -> Records:
    """The bodies of a tree as records of LINK."""
    links = np.zeros(len(branches), LINK)
    place = 0
    for link, (joint, before, own, parent) in zip(links, branches, strict=True):
        link["body"] = 3 * linkage.index(own.body)
        link["kind"] = LOOSE if joint is None else HINGED
        link["parent"] = parent
        link["before"] = -1 if before.body == GROUND else 3 * linkage.index(before.body)
        link["before_x"], link["before_y"] = before.x, before.y
        link["own_x"], link["own_y"] = own.x, own.y
        body = linkage.bodies[linkage.index(own.body)]
        link["mass"], link["inertia"] = body.mass, body.effective_inertia
        if isinstance(joint, Guide):
            link["kind"] = GUIDED
            link["cosine"], link["sine"] = math.cos(joint.direction), math.sin(joint.direction)
            link["angle"] = joint.angle
            link["axis_x"], link["axis_y"] = math.cos(joint.angle), math.sin(joint.angle)
        link["place"] = place
        place += COORDINATES[link["kind"]]
    return links
