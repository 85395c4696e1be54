"""Bodies whose motion drives and joints prescribe.

They form a tree on the frame whose coordinates are absolute angles and distances along
guides. Drives prescribe some of these coordinates. The others follow from the pins that
close the loops (``closed_loops``). No equation of motion is solved for them.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from presswear.linkage.drives import LinearDrive
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND
from presswear.linkage.topology import Branch, bodies_of_drive, chain_of
from presswear.physics.drive_motion import motions_of
from presswear.physics.rotation import arm, cos_sin
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, floats

# Part: a prescribed body with its coordinate; parents come before children
PART = np.dtype(
    [
        ("body", np.int64),  # index of its x in q
        ("is_guided", np.bool_),  # slides along a guide; else it turns about a hinge
        ("parent", np.int64),  # number of the parent; -1 for the frame
        ("before", np.int64),  # index in q of the x of the parent; -1 for the frame
        ("drive", np.int64),  # number of its drive in the linkage; -1 for none
        # angle of the driven body less the coordinate, rad
        ("driven_angle", np.float64),
        # -1 if the drive moves the guide of the part along the parent, else 1
        ("sense", np.float64),
        # Number of the part with the hinge that turns a guide; -1 if none does
        ("turning", np.int64),
        *floats("before_x", "before_y"),  # joint in the axes of the parent, m
        *floats("end_x", "end_y"),  # joint in the axes of the body, m
        *floats("cosine", "sine"),  # direction of the guide, axes of the parent
        ("angle", np.float64),  # angle of a sliding body in the axes of the parent, rad
        *floats("axis_x", "axis_y"),  # cosine and sine of this angle
        # A body with a hinge on the frame has the inertia about the hinge and mass 0.
        *floats("mass", "inertia"),
    ]
)

# Pin that closes a loop of prescribed bodies. Its two equations determine two coordinates
# that no drive prescribes.
CLOSING = np.dtype(
    [
        ("first", np.int64),  # number of the part; -1 for the frame
        ("second", np.int64),
        *floats("x1", "y1", "x2", "y2"),  # points in the axes of their bodies, m
    ]
)

# Rows of ``Prescribed.work``: coordinates, rates, accelerations, generalized forces,
# derivatives of the coordinates by that of a drive, right-hand side, and the row LAST.
# From HEAD on follow the derivatives of the closing equations by all coordinates, then
# those by the coordinates that are solved for.
COORDINATE, RATE, ACCELERATION, FORCE, RATIO, RIGHT, LAST, HEAD = range(8)
# Columns of the row LAST: time, s, and determinant of the last evaluation
TIME = 0
DETERMINANT = 1


class Prescribed(NamedTuple):
    """Prescribed bodies, parents before children."""

    parts: Records  # dtype PART
    closings: Records  # dtype CLOSING
    motions: Records  # motions of all drives
    # last motion, from which Newton's method starts, and working space, with the rows
    # COORDINATE to HEAD: (HEAD + 4 closings, max(parts, 2))
    work: Array


def pack_prescribed(linkage: Linkage, bodies: frozenset[str]) -> Prescribed:
    """Pack the bodies with prescribed motion for the kernels; see ``begin_motion``."""
    branches, pins = chain_of(linkage, bodies)
    parts = _pack_parts(linkage, branches)
    numbers = {branch.end.body: i for i, branch in enumerate(branches)} | {GROUND: -1}
    for number, drive in enumerate(linkage.drives):
        if not bodies_of_drive(linkage, drive) <= bodies:
            continue
        if isinstance(drive, LinearDrive):
            guides = [branch.joint for branch in branches]
            i = guides.index(linkage.guide_of(drive))
            parts[i]["drive"] = number
            parts[i]["sense"] = 1.0 if branches[i].end.body == drive.body else -1.0
        else:
            _add_drive(parts, numbers[drive.body], number)
    closings = np.zeros(len(pins), CLOSING)
    for closing, pin in zip(closings, pins, strict=True):
        closing["first"] = numbers[pin.first.body]
        closing["second"] = numbers[pin.second.body]
        closing["x1"] = pin.first.x
        closing["y1"] = pin.first.y
        closing["x2"] = pin.second.x
        closing["y2"] = pin.second.y
    work = np.zeros((HEAD + 4 * len(pins), max(len(parts), 2)))
    return Prescribed(parts, closings, motions_of(linkage), work)


def _add_drive(parts: Records, i: int, drive: int) -> None:
    """Give a drive to a part, or to the part whose hinge turns it through guides."""
    angle = 0.0
    while parts[i]["is_guided"] and parts[i]["turning"] >= 0:
        angle += parts[i]["angle"]
        i = parts[i]["parent"]
    parts[i]["drive"] = drive
    parts[i]["driven_angle"] = angle


def _pack_parts(linkage: Linkage, branches: Sequence[Branch]) -> Records:
    parts = np.zeros(len(branches), PART)
    for part, branch in zip(parts, branches, strict=True):
        joint, before, end, parent = branch
        body = linkage.bodies[linkage.index(end.body)]
        part["body"] = 3 * linkage.index(end.body)
        part["parent"] = parent
        part["drive"] = part["turning"] = -1
        part["sense"] = 1.0
        part["before"] = -1 if before.body == GROUND else 3 * linkage.index(before.body)
        part["before_x"] = before.x
        part["before_y"] = before.y
        part["end_x"] = end.x
        part["end_y"] = end.y
        part["mass"] = body.mass
        part["inertia"] = body.effective_inertia
        if isinstance(joint, Guide):
            part["is_guided"] = True
            part["cosine"] = math.cos(branch.slope)
            part["sine"] = math.sin(branch.slope)
            part["angle"] = branch.turn
            part["axis_x"] = math.cos(branch.turn)
            part["axis_y"] = math.sin(branch.turn)
            if parent >= 0:
                is_hinged = not parts[parent]["is_guided"]
                turning = parent if is_hinged else parts[parent]["turning"]
                part["turning"] = turning
        elif before.body == GROUND:
            part["inertia"] += body.mass * (end.x**2 + end.y**2)
            part["mass"] = 0.0
    return parts


def begin_motion(prescribed: Prescribed, t: float, q: Array) -> None:
    """Store the coordinates of all bodies at a time, s, from which the motion continues."""
    parts, _, _, work = prescribed
    coordinates = np.zeros(len(parts))
    for i, part in enumerate(parts):
        b = part["body"]
        coordinates[i] = q[b + 2]
        if part["is_guided"]:
            coordinates[i] = _distance(part, q)
    work[:] = 0.0
    work[LAST, TIME] = t
    work[COORDINATE, : len(parts)] = coordinates


def _distance(part: Records, q: Array) -> float:
    """Return the distance of a part along its guide in a position of all bodies, m."""

    b = part["body"]
    p = part["before"]
    turn = q[p + 2] if p >= 0 else 0.0
    x, y = _rotated(part["before_x"], part["before_y"], turn)
    end_x, end_y = _rotated(part["end_x"], part["end_y"], q[b + 2])
    if p >= 0:
        x += q[p]
        y += q[p + 1]
    cosine, sine = _rotated(part["cosine"], part["sine"], turn)
    return (q[b] + end_x - x) * cosine + (q[b + 1] + end_y - y) * sine


def _rotated(x: float, y: float, angle: float) -> tuple[float, float]:
    """Return a vector rotated by an angle, rad."""
    c = math.cos(angle)
    s = math.sin(angle)
    return c * x - s * y, s * x + c * y


@compiled
def place_parts(
    prescribed: Prescribed, q: Array, v: Array, a: Array, axes: Array
) -> None:
    """Fill q, v and a of prescribed bodies from their coordinates and derivatives.

    ``axes`` holds cosine and sine of the angle of each body, at the indices of its x
    and y.
    """
    parts = prescribed.parts
    work = prescribed.work
    for i in range(parts.shape[0]):
        part = parts[i]
        b = part.body
        x = work[COORDINATE, i]
        rate = work[RATE, i]
        acceleration = work[ACCELERATION, i]
        if part.is_guided and part.before >= 0:
            _slide(part, work[:, i], q, v, a, axes)
            continue
        if part.is_guided:
            q[b] = part.before_x + x * part.cosine
            q[b + 1] = part.before_y + x * part.sine
            q[b + 2] = part.angle
            v[b] = rate * part.cosine
            v[b + 1] = rate * part.sine
            v[b + 2] = 0.0
            a[b] = acceleration * part.cosine
            a[b + 1] = acceleration * part.sine
            a[b + 2] = 0.0
            axes[b] = part.axis_x
            axes[b + 1] = part.axis_y
            continue
        _place_hinge(part, q, v, a, axes)
        axes[b], axes[b + 1] = cos_sin(x)
        rx, ry = arm(part.end_x, part.end_y, axes, b)
        square = rate * rate
        q[b] -= rx
        q[b + 1] -= ry
        q[b + 2] = x
        v[b] += rate * ry
        v[b + 1] -= rate * rx
        v[b + 2] = rate
        a[b] += acceleration * ry + square * rx
        a[b + 1] += square * ry - acceleration * rx
        a[b + 2] = acceleration


@compiled
def _slide(
    part: Records, coordinate: Array, q: Array, v: Array, a: Array, axes: Array
) -> None:
    """Fill position, velocity, acceleration and axes of a body on a guide that moves."""
    b = part.body
    p = part.before
    x = coordinate[COORDINATE]
    rate = coordinate[RATE]
    acceleration = coordinate[ACCELERATION]
    omega = v[p + 2]
    alpha = a[p + 2]
    axes[b], axes[b + 1] = arm(part.axis_x, part.axis_y, axes, p)
    ux, uy = arm(part.cosine, part.sine, axes, p)
    start_x, start_y = arm(part.before_x, part.before_y, axes, p)
    end_x, end_y = arm(part.end_x, part.end_y, axes, b)
    rx = start_x + x * ux - end_x
    ry = start_y + x * uy - end_y
    coriolis = 2.0 * omega * rate
    square = omega * omega
    q[b] = q[p] + rx
    q[b + 1] = q[p + 1] + ry
    q[b + 2] = q[p + 2] + part.angle
    v[b] = v[p] - omega * ry + rate * ux
    v[b + 1] = v[p + 1] + omega * rx + rate * uy
    v[b + 2] = omega
    a[b] = a[p] - alpha * ry - square * rx + acceleration * ux - coriolis * uy
    a[b + 1] = a[p + 1] + alpha * rx - square * ry + acceleration * uy + coriolis * ux
    a[b + 2] = alpha


@compiled
def _place_hinge(part: Records, q: Array, v: Array, a: Array, axes: Array) -> None:
    """Fill position, velocity and acceleration of a hinge, in place of those of its body."""
    b = part.body
    p = part.before
    if p < 0:
        q[b] = part.before_x
        q[b + 1] = part.before_y
        v[b] = v[b + 1] = a[b] = a[b + 1] = 0.0
        return
    rx, ry = arm(part.before_x, part.before_y, axes, p)
    omega = v[p + 2]
    alpha = a[p + 2]
    q[b] = q[p] + rx
    q[b + 1] = q[p + 1] + ry
    v[b] = v[p] - omega * ry
    v[b + 1] = v[p + 1] + omega * rx
    a[b] = a[p] - alpha * ry - omega * omega * rx
    a[b + 1] = a[p + 1] + alpha * rx - omega * omega * ry


@compiled
def subtract_inertia(parts: Records, a: Array, force: Array) -> None:
    """Subtract the inertia of prescribed bodies from generalized forces."""
    for i in range(parts.shape[0]):
        part = parts[i]
        b = part.body
        force[b] -= part.mass * a[b]
        force[b + 1] -= part.mass * a[b + 1]
        force[b + 2] -= part.inertia * a[b + 2]
