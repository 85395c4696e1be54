"""Equations of the press with both joints open, written by hand without any part of the package.

Coordinates are the absolute angles of plate 4 and rod 3, the height of slider 6 and the
angle of rod 5. Crank 7 and the pin of crank 2 are driven. Two pairs of equations,
coupled by the contact at C only, are solved by Cramer's rule. Kernels take and return
scalars, which stay in registers.

The closing speed at a touchdown is stored between steps: over a short step its square
is linear in the penetration.
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.engines.base import Start
from presswear.linkage.linkage import Linkage
from presswear.linkage.press import CRANK_2_START, CRANK_7_START, Press
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled

Two = tuple[float, float]
Four = tuple[float, float, float, float]

SIZE = 8  # coordinates, rad and m, and their rates
OPEN = -1.0  # closing speed of a joint without contact
MIN_CLOSING = 1e-6  # m/s, in the damping term

_CONTACT = (
    "bearing_radius",
    "clearance",
    "stiffness",
    "damping",
    "friction",
    "lower",
    "upper",
    "width",
    "wear_coefficient",
    "bearing_share",
)
_GIVEN = (  # fields of ``Press``
    "speed",
    "gravity",
    "length_2",
    "length_3",
    "length_5",
    "length_7",
    *(f"mass_{k}" for k in range(2, 8)),
)
_PRESS = (
    *_GIVEN,
    "o2_x",
    "o2_y",
    "plate_inertia",
    "rod_3_inertia",
    "rod_5_inertia",
    "centre_x",
    "centre_y",
    "b_x",
    "b_y",
    "c_x",
    "c_y",
    "start_2",
    "start_7",
)
CONTACT = np.dtype([(name, np.float64) for name in _CONTACT])
# SI; lengths from D in the frame of the plate, inertias about the hinges
PRESS = np.dtype(
    [*((name, np.float64) for name in _PRESS), ("a", CONTACT), ("c", CONTACT)]
)


class Push(NamedTuple):
    """Force on a bearing, N, its point, m, penetration, m, its rate, m/s, and its accounts.

    The load is the normal force times the slip of equation 24 of the paper, W; the
    pressure load is the mean pressure of equations 25 to 28 times this slip, W/m^2.
    Losses are powers, W.
    """

    x: float
    y: float
    at_x: float
    at_y: float
    depth: float
    rate: float
    load: float
    pressure_load: float
    contact_loss: float
    friction_loss: float
    normal: float  # N
    tangential: float  # N, on the pin along the direction of positive sliding
    sliding: float  # m/s
    turning: float  # of the eccentricity, rad/s
    ex: float  # eccentricity, m
    ey: float


class Levers(NamedTuple):
    """Vectors from D to the centre and to B of the plate, and from B to A, m."""

    gx: float
    gy: float
    bx: float
    by: float
    rx: float
    ry: float


class Cranks(NamedTuple):
    """Positions, m, and velocities, m/s, of D and of the pin at A."""

    x: float
    y: float
    vx: float
    vy: float
    pin_x: float
    pin_y: float
    pin_vx: float
    pin_vy: float


def parameters(scene: Scene) -> Records:
    """Return the parameters of a scene with round surfaces as one record of PRESS."""
    press = scene.mechanism
    linkage = scene.linkage()
    assert isinstance(press, Press)
    corner = press.plate_corners()
    start = corner["D"].x, corner["D"].y
    record = np.zeros(1, PRESS)
    for name in _GIVEN:
        record[name] = getattr(press, name)
    record["o2_x"] = press.geometry.hx
    record["o2_y"] = press.geometry.hy
    record["centre_x"] = -start[0]
    record["centre_y"] = -start[1]
    for name in ("b", "c"):
        end = corner[name.upper()]
        record[f"{name}_x"] = end.x - start[0]
        record[f"{name}_y"] = end.y - start[1]
    record["plate_inertia"] = (
        press.inertia_4
        + press.mass_4 * math.hypot(*start) ** 2
        + press.mass_3 * press.geometry.side_bd**2
    )
    record["rod_3_inertia"] = (
        press.inertia_3 + press.mass_3 * (0.5 * press.length_3) ** 2
    )
    record["rod_5_inertia"] = (
        press.inertia_5 + press.mass_5 * (0.5 * press.length_5) ** 2
    )
    record["start_2"] = CRANK_2_START
    record["start_7"] = CRANK_7_START
    for joint in linkage.clearances:
        normal = joint.normal
        friction = joint.friction
        record[joint.name.lower()] = (
            joint.bearing_radius,
            joint.clearance,
            normal.stiffness,
            normal.damping,
            friction.coefficient,
            friction.lower,
            friction.upper,
            joint.width,
            *(
                (joint.wear.coefficient, joint.wear.bearing_share)
                if joint.wear
                else (0.0, 0.5)
            ),
        )
    return record


@compiled
def cranks(press: Records, t: float) -> Cranks:
    """Return the motion of the cranks at a time, s."""
    p = press[0]
    seven = p.start_7 + p.speed * t
    two = p.start_2 - p.speed * t
    x = p.length_7 * math.cos(seven)
    y = p.length_7 * math.sin(seven)
    back_x = -p.length_2 * math.cos(two)
    back_y = -p.length_2 * math.sin(two)
    w = p.speed
    return Cranks(
        x,
        y,
        -w * y,
        w * x,
        p.o2_x + back_x,
        p.o2_y + back_y,
        w * back_y,
        -w * back_x,
    )


@compiled
def push(
    joint: Records,
    onset: float,
    pin: Two,
    eccentricity: Two,
    velocity: Two,
    spins: Two,
) -> Push:
    """Return the contact force.

    ``onset`` is the stored closing speed, m/s, ``pin`` the centre of the pin, m,
    ``eccentricity`` its place in the bearing, m, and ``velocity`` the rate of this
    place, m/s. ``spins`` are the angular velocities of pin and bearing, rad/s.
    """
    pin_x, pin_y = pin
    ex, ey = eccentricity
    vx, vy = velocity
    pin_spin, bearing_spin = spins
    distance = math.sqrt(ex * ex + ey * ey)
    depth = distance - joint.clearance
    if distance == 0.0:
        return no_push(pin_x, pin_y, depth, 0.0, ex, ey)
    nx = ex / distance
    ny = ey / distance
    rate = vx * nx + vy * ny
    if depth <= 0.0:
        return no_push(pin_x, pin_y, depth, rate, ex, ey)
    closing = max(onset if onset >= 0.0 else rate, MIN_CLOSING)
    elastic = joint.stiffness * depth * math.sqrt(depth)
    normal = max(elastic * (1.0 + joint.damping * rate / closing), 0.0)
    pin_radius = joint.bearing_radius - joint.clearance
    arm = pin_radius - 0.5 * depth
    across = vy * nx - vx * ny
    sliding = across + pin_spin * arm - bearing_spin * (arm + distance)
    ramp = min(
        max((abs(sliding) - joint.lower) / (joint.upper - joint.lower), 0.0), 1.0
    )
    along = math.copysign(joint.friction * ramp * normal, sliding)
    turning = across / distance
    load = normal * (pin_radius + depth) * abs(turning)
    # Half the chord over the bearing radius, from the penetration without cancellation.
    above = (
        depth
        * (distance + pin_radius + joint.bearing_radius)
        / (2.0 * distance * pin_radius)
    )
    area = 2.0 * joint.width * joint.bearing_radius * math.sqrt(above * (2.0 - above))
    return Push(
        normal * nx - along * ny,
        normal * ny + along * nx,
        pin_x + arm * nx,
        pin_y + arm * ny,
        depth,
        rate,
        load,
        load / area,
        (normal - elastic) * rate,
        along * sliding,
        normal,
        -along,
        sliding,
        turning,
        ex,
        ey,
    )


@compiled
def no_push(
    x: float, y: float, depth: float, rate: float, ex: float, ey: float
) -> Push:
    """Return the forces, all zero, of a joint without contact."""
    return Push(
        0.0, 0.0, x, y, depth, rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, ex, ey
    )


@compiled
def accelerations(
    press: Records, at: Cranks, onset: Array, x: Four, u: Four
) -> tuple[Four, Four, Push, Push, Levers]:
    """Return accelerations, generalized contact forces, both contact forces, and levers."""
    plate, rod_3, slider, rod_5 = x
    plate_t, rod_3_t, slider_t, rod_5_t = u
    p = press[0]
    cosine = math.cos(plate)
    sine = math.sin(plate)
    gx = cosine * p.centre_x - sine * p.centre_y
    gy = sine * p.centre_x + cosine * p.centre_y
    bx = cosine * p.b_x - sine * p.b_y
    by = sine * p.b_x + cosine * p.b_y
    cx = cosine * p.c_x - sine * p.c_y
    cy = sine * p.c_x + cosine * p.c_y
    rx = p.length_3 * math.cos(rod_3)
    ry = p.length_3 * math.sin(rod_3)
    sx = p.length_5 * math.cos(rod_5)
    sy = p.length_5 * math.sin(rod_5)
    one = push(
        p.a,
        onset[0],
        (at.pin_x, at.pin_y),
        (at.pin_x - at.x - bx - rx, at.pin_y - at.y - by - ry),
        (
            at.pin_vx - at.vx + plate_t * by + rod_3_t * ry,
            at.pin_vy - at.vy - plate_t * bx - rod_3_t * rx,
        ),
        (-p.speed, rod_3_t),
    )
    two = push(
        p.c,
        onset[1],
        (at.x + cx, at.y + cy),
        (at.x + cx - p.o2_x - sx, at.y + cy - slider - sy),
        (
            at.vx - plate_t * cy + rod_5_t * sy,
            at.vy + plate_t * cx - slider_t - rod_5_t * sx,
        ),
        (plate_t, rod_5_t),
    )
    # Pin A pushes rod 3; pin C, on the plate, pushes rod 5 and is pushed back.
    force_1 = (
        bx * one.y - by * one.x - (two.at_x - at.x) * two.y + (two.at_y - at.y) * two.x
    )
    force_2 = (one.at_x - at.x - bx) * one.y - (one.at_y - at.y - by) * one.x
    force_4 = (two.at_x - p.o2_x) * two.y - (two.at_y - slider) * two.x
    # All that hangs from D feels its acceleration, -w^2 D, and gravity.
    square = p.speed * p.speed
    ax = square * at.x
    ay = square * at.y - p.gravity
    hx = 0.5 * rx
    hy = 0.5 * ry
    mx = p.mass_4 * gx + p.mass_3 * bx
    my = p.mass_4 * gy + p.mass_3 * by
    m12 = p.mass_3 * (bx * hx + by * hy)
    turn = p.mass_3 * (bx * hy - by * hx)
    right_1 = force_1 + mx * ay - my * ax + rod_3_t * rod_3_t * turn
    right_2 = force_2 + p.mass_3 * (hx * ay - hy * ax) - plate_t * plate_t * turn
    inverse_12 = 1.0 / (p.plate_inertia * p.rod_3_inertia - m12 * m12)
    m34 = 0.5 * p.mass_5 * sx
    both = p.mass_5 + p.mass_6
    right_3 = two.y - both * p.gravity + 0.5 * p.mass_5 * sy * rod_5_t * rod_5_t
    right_4 = force_4 - m34 * p.gravity
    inverse_34 = 1.0 / (both * p.rod_5_inertia - m34 * m34)
    return (
        (
            inverse_12 * (p.rod_3_inertia * right_1 - m12 * right_2),
            inverse_12 * (p.plate_inertia * right_2 - m12 * right_1),
            inverse_34 * (p.rod_5_inertia * right_3 - m34 * right_4),
            inverse_34 * (both * right_4 - m34 * right_3),
        ),
        (force_1, force_2, two.y, force_4),
        one,
        two,
        Levers(gx, gy, bx, by, rx, ry),
    )


def state_of(linkage: Linkage, start: Start) -> Array:
    """Return the coordinates and rates of a state of the linkage, shape (SIZE,)."""
    coordinates = (("plate 4", 2), ("rod 3", 2), ("slider 6", 1), ("rod 5", 2))
    places = [3 * linkage.index(name) + part for name, part in coordinates]
    return np.concatenate([start.position[places], start.velocity[places]])
