"""Accelerations of a tree under forces: the articulated bodies of Featherstone in the plane.

From the leaves inwards each link's inertia and force as its parent feels them, through a joint
that gives way; then outwards the accelerations (Rigid Body Dynamics Algorithms, 2008, 7.3).
"""

import numpy as np
from numpy.typing import NDArray

from presswear.physics.links import GUIDED, LOOSE, arm
from presswear.tools.compile import Records, compiled, inlined

Array = NDArray[np.float64]

ARTICULATED = np.dtype(
    [
        *((name, np.float64) for name in ("xx", "xy", "yy", "xt", "yt", "tt")),  # its inertia
        *((name, np.float64) for name in ("fx", "fy", "ft")),  # force and moment on it
        *((name, np.float64) for name in ("sx", "sy", "st")),  # its motion with its coordinate
        *((name, np.float64) for name in ("ux", "uy", "ut")),  # inertia times that motion
        *((name, np.float64) for name in ("cx", "cy")),  # acceleration that no coordinate gives
        *((name, np.float64) for name in ("dx", "dy")),  # from the parent's mass centre to its own
        ("mobility", np.float64),  # of its coordinate
        ("force", np.float64),  # on its coordinate
    ]
)
"""A link with all that hangs from it, about its mass centre; SI units, global directions."""


@inlined
def articulate(
    links: Records, v: Array, axes: Array, carried: Array, force: Array, bodies: Records
) -> None:
    """Fill the articulated bodies of a tree, from the leaves inwards.

    Parameters
    ----------
    carried : ndarray, shape (links, CARRIED)
        See ``carry_branches``.
    force : ndarray, shape (3 bodies,)
        On the mass centres.
    bodies : records of ARTICULATED, shape (links,)
    """
    for i in range(links.shape[0]):
        link, own = links[i], bodies[i]
        b = link.body
        own.xx = own.yy = link.mass
        own.tt = link.inertia
        own.xy = own.xt = own.yt = 0.0
        own.fx, own.fy, own.ft = force[b], force[b + 1], force[b + 2]
    for i in range(links.shape[0] - 1, -1, -1):
        link, own = links[i], bodies[i]
        if link.kind == LOOSE:
            continue
        b = link.body
        if link.kind == GUIDED:
            rx, ry, square = 0.0, 0.0, 0.0
            own.sx, own.sy, own.st = link.cosine, link.sine, 0.0
        else:
            rx, ry = arm(link.own_x, link.own_y, axes, b)
            square = v[b + 2] * v[b + 2]
            own.sx, own.sy, own.st = ry, -rx, 1.0
        own.ux = own.xx * own.sx + own.xy * own.sy + own.xt * own.st
        own.uy = own.xy * own.sx + own.yy * own.sy + own.yt * own.st
        own.ut = own.xt * own.sx + own.yt * own.sy + own.tt * own.st
        own.mobility = 1.0 / (own.sx * own.ux + own.sy * own.uy + own.st * own.ut)
        own.force = own.sx * own.fx + own.sy * own.fy + own.st * own.ft
        if link.parent < 0:
            own.cx, own.cy = carried[i, 2] + square * rx, carried[i, 3] + square * ry
            continue
        p = link.before
        px, py = arm(link.before_x, link.before_y, axes, p)
        before = v[p + 2] * v[p + 2]
        own.cx, own.cy = square * rx - before * px, square * ry - before * py
        own.dx, own.dy = px - rx, py - ry
        _add_to_parent(own, bodies[link.parent])


@inlined
def _add_to_parent(own: Records, parent: Records) -> None:
    """Add to a link what it feels of one that hangs from it."""
    # Along its coordinate it gives way.
    part = own.mobility
    xx = own.xx - part * own.ux * own.ux
    xy = own.xy - part * own.ux * own.uy
    yy = own.yy - part * own.uy * own.uy
    xt = own.xt - part * own.ux * own.ut
    yt = own.yt - part * own.uy * own.ut
    tt = own.tt - part * own.ut * own.ut
    part *= own.force
    fx = own.fx - part * own.ux - xx * own.cx - xy * own.cy
    fy = own.fy - part * own.uy - xy * own.cx - yy * own.cy
    ft = own.ft - part * own.ut - xt * own.cx - yt * own.cy
    turned_x = own.dx * xy - own.dy * xx
    turned_y = own.dx * yy - own.dy * xy
    parent.xx += xx
    parent.xy += xy
    parent.yy += yy
    parent.xt += turned_x + xt
    parent.yt += turned_y + yt
    parent.tt += own.dx * (turned_y + 2.0 * yt) - own.dy * (turned_x + 2.0 * xt) + tt
    parent.fx += fx
    parent.fy += fy
    parent.ft += own.dx * fy - own.dy * fx + ft


@inlined
def release(links: Records, bodies: Records, u_t: Array, a: Array) -> None:
    """Fill the accelerations of a tree whose articulated bodies are known, outwards.

    Parameters
    ----------
    u_t : ndarray, shape (coordinates,)
    a : ndarray, shape (3 bodies,)
        Those of the bodies of the tree.
    """
    for i in range(links.shape[0]):
        link, own = links[i], bodies[i]
        b, c = link.body, link.place
        if link.kind == LOOSE:
            _let_go(own, a[b : b + 3])
            u_t[c], u_t[c + 1], u_t[c + 2] = a[b], a[b + 1], a[b + 2]
            continue
        ax, ay, at = own.cx, own.cy, 0.0
        if link.parent >= 0:
            p = link.before
            at = a[p + 2]
            ax += a[p] - at * own.dy
            ay += a[p + 1] + at * own.dx
        own_t = own.mobility * (own.force - own.ux * ax - own.uy * ay - own.ut * at)
        u_t[c] = own_t
        a[b] = ax + own.sx * own_t
        a[b + 1] = ay + own.sy * own_t
        a[b + 2] = at + own.st * own_t


@compiled
def _let_go(own: Records, a: Array) -> None:
    """Fill the acceleration of a body that nothing holds: its inertia's three equations."""
    xx, xy, yy, xt, yt, tt = own.xx, own.xy, own.yy, own.xt, own.yt, own.tt
    fx, fy, ft = own.fx, own.fy, own.ft
    # Without its turn first: what hangs from it never makes these two equations singular.
    part = 1.0 / (xx * yy - xy * xy)
    free_x, free_y = part * (yy * fx - xy * fy), part * (xx * fy - xy * fx)
    turn_x, turn_y = part * (yy * xt - xy * yt), part * (xx * yt - xy * xt)
    turn = (ft - xt * free_x - yt * free_y) / (tt - xt * turn_x - yt * turn_y)
    a[0], a[1], a[2] = free_x - turn * turn_x, free_y - turn * turn_y, turn
