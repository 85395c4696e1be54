"""Contact of a pin with the worn surface of its bearing, and the record of any contact.

e = pin centre - bearing centre, n = e / |e|, phi its direction, t = n turned by +90
degrees. Round surfaces, and worn ones under ``radial`` contact, meet where e points;
worn ones on a ``foundation`` over all of the arc. Round surfaces stand in the written
equations.
"""

import math

import numpy as np

from presswear.physics.foundation import (
    Search,
    derivatives_at,
    greatest_overlap,
    integrate_overlap,
    node_of_peak,
)
from presswear.physics.friction_and_normal import elastic_of
from presswear.physics.overlap import Place, place_of
from presswear.physics.packed import JOINT
from presswear.physics.wall_wear import wall_profile
from presswear.physics.worn_map import BEARING, PIN, SURFACES, cell_of, profile
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, floats, inlined, lazily_compiled

# A pin in its bearing at one instant, open or closed
CONTACT = np.dtype(
    [
        # greatest overlap of the surfaces, m; below zero if open
        ("penetration", np.float64),
        ("is_flat", np.float64),  # 1 of a corner on a wall, with e across the wall
        ("rate", np.float64),  # at which it grows, m/s
        ("sliding", np.float64),  # v_t at the contact point, m/s
        *floats("eccentricity", "eccentricity_x", "eccentricity_y"),  # |e| and e, m
        *floats("velocity_x", "velocity_y"),  # rate of e, m/s
        ("turning", np.float64),  # rate of the direction of e, rad/s
        # direction in which the pin presses on the bearing
        *floats("normal_x", "normal_y"),
        # from the two centres to the contact point along the normal, m
        *floats("pin_arm", "bearing_arm"),
        ("approach", np.float64),  # speed on which the normal force works, m/s
        ("closing", np.float64),  # rate that damps the elastic force, m/s
        ("elastic", np.float64),  # force, N
        ("energy", np.float64),  # elastic, J
        # on a foundation the direction of the greatest overlap, rad; of a corner on a
        # wall with a map its place along the guide, m
        ("place", np.float64),
        # x axis of the map of a worn bearing
        *floats("map_x", "map_y"),
        # moment of the pressure on the worn pin about the contact point, N m; the moment on
        # the bearing is opposite
        ("couple", np.float64),
        # angles and rates of the bodies, rad and rad/s; levers from their mass centres to
        # the centres of bearing and pin, m
        *floats("bearing_angle", "bearing_spin", "bearing_lever_x", "bearing_lever_y"),
        *floats("pin_angle", "pin_spin", "pin_lever_x", "pin_lever_y"),
        *floats("normal", "tangential"),  # forces, N, zero while open
        ("film_loss", np.float64),  # power that an oil film and its asperities take, W
    ]
)

# Memory of a joint between accepted steps: its last state and its present contact
MEMORY = np.dtype(
    [
        ("time", np.float64),  # time of the last accepted state, s
        ("step", np.float64),  # length of the last accepted step, s
        ("penetration", np.float64),  # m
        ("earlier_penetration", np.float64),  # in the state before the last, m
        ("rate", np.float64),  # rate of the penetration, m/s
        ("acceleration", np.float64),  # second derivative of the penetration, m/s^2
        ("closing", np.float64),  # rate that enters the damping, m/s
        ("elastic", np.float64),  # elastic force, N
        ("energy", np.float64),  # elastic energy, J
        # maximum of the normal force inside the last step, N; 0: no maximum inside
        ("step_peak", np.float64),
        # speed of the contact over the wear maps, rad/s
        ("sweep", np.float64),
        # eccentricity in the last accepted state, m
        *floats("eccentricity_x", "eccentricity_y"),
        ("touchdown_time", np.float64),  # touchdown of the present contact, s
        ("separation_time", np.float64),  # separation after the previous contact, s
        ("started_closed", np.bool_),  # the run began inside the present contact
        ("steps", np.int64),  # accepted in the present contact
        ("longest_step", np.float64),  # for the expected duration of the contact, s
        ("peak_force", np.float64),  # largest normal force of the present contact, N
    ]
)


@inlined
def copy_contacts(target: Records, source: Records) -> None:
    """Copy the contacts of all joints."""
    for k in range(source.shape[0]):
        target[k] = source[k]


@compiled
def direction_of(contact: Records) -> float:
    """Return the direction phi of the eccentricity, rad."""
    return math.atan2(contact.eccentricity_y, contact.eccentricity_x)


@inlined
def note_radial(joint: Records, surfaces: Array, contact: Records) -> None:
    """Fill in the contact of the pin with the point of the worn surface that faces it.

    The rate of penetration follows the profile: delta_dot = e_dot . n minus the change
    of both depths under the moving contact.
    """
    eccentricity = contact.eccentricity
    # A pin exactly in the centre touches nothing: any direction serves.
    nx = contact.eccentricity_x / eccentricity if eccentricity > 0.0 else 1.0
    ny = contact.eccentricity_y / eccentricity if eccentricity > 0.0 else 0.0
    approach = contact.velocity_x * nx + contact.velocity_y * ny
    count = joint.surface_nodes
    turns = joint.map_turns
    turning = contact.turning
    direction = math.atan2(ny, nx)
    place = direction - turns * contact.bearing_angle
    bearing_depth, bearing_slope, _ = profile(surfaces, BEARING, count, place)
    place = direction - turns * contact.pin_angle
    pin_depth, pin_slope, _ = profile(surfaces, PIN, count, place)
    penetration = eccentricity - joint.clearance - bearing_depth - pin_depth
    rate = approach - bearing_slope * (turning - turns * contact.bearing_spin)
    rate -= pin_slope * (turning - turns * contact.pin_spin)
    # Half the penetration on either side, so that both arms end at one point.
    indentation = 0.5 * max(penetration, 0.0)
    contact.penetration = penetration
    contact.rate = contact.closing = rate
    contact.normal_x, contact.normal_y = nx, ny
    contact.pin_arm = joint.pin_radius - pin_depth - indentation
    contact.bearing_arm = joint.bearing_radius + bearing_depth + indentation
    contact.approach = approach
    contact.elastic, contact.energy = elastic_of(joint.normal, penetration)
    contact.place = contact.couple = 0.0


@lazily_compiled(None, JOINT, SURFACES, CONTACT, False)
def note_foundation(
    joint: Records, surfaces: Array, contact: Records, is_complete: bool
) -> None:
    """Fill in the contact of the pin with all of the worn arc, through an elastic foundation.

    Force and couples are the gradient of the elastic energy in e and in both bodies'
    angles, equations W4 and W5. The bearing's couple follows from the pin's: if both
    turn together, nothing changes. Damping multiplies all of them, with the rate at
    which they are worked against. Forces do not depend on the greatest overlap, which is
    filled in, with its rate and place and the energy, if ``is_complete``.
    """
    dx, dy = contact.eccentricity_x, contact.eccentricity_y
    c, s = contact.map_x, contact.map_y
    turns = joint.map_turns
    relative_angle = turns * (contact.bearing_angle - contact.pin_angle)
    place = place_of(
        joint, c * dx + s * dy, c * dy - s * dx, contact.eccentricity, relative_angle
    )
    search, arc = integrate_overlap(
        surfaces, joint, place, contact.place - turns * contact.bearing_angle
    )
    nx = ny = elastic = couple = approach = closing = 0.0
    size = math.sqrt(arc.x * arc.x + arc.y * arc.y)
    if size > 0.0:
        elastic = joint.foundation * size
        nx = (c * arc.x - s * arc.y) / size
        ny = (s * arc.x + c * arc.y) / size
        moment = elastic * (dx * ny - dy * nx)
        couple = (
            -joint.foundation * arc.pin_slope / place.width if turns > 0.0 else moment
        )
        on_bearing = moment - couple
        power = couple * contact.pin_spin + on_bearing * contact.bearing_spin
        approach = contact.velocity_x * nx + contact.velocity_y * ny - power / elastic
        # Maps fixed in direction store no energy when the bodies turn.
        closing = approach if turns > 0.0 else approach + power / elastic
    contact.normal_x, contact.normal_y = nx, ny
    contact.approach = approach
    contact.closing = closing
    contact.elastic = elastic
    contact.couple = couple
    if is_complete:
        contact.energy = 0.5 * joint.foundation * arc.square
        note_deepest(joint, surfaces, contact, place, search)
    # The contact point is halfway between the circles of both surfaces before wear.
    along = dx * contact.normal_x + dy * contact.normal_y
    contact.pin_arm = joint.pin_radius - 0.5 * max(along - joint.clearance, 0.0)
    contact.bearing_arm = contact.pin_arm + along


@inlined
def note_deepest(
    joint: Records, surfaces: Array, contact: Records, place: Place, search: Search
) -> None:
    """Fill in the greatest overlap of a pin on its foundation, its rate and its place.

    Without an arc of overlap the normal is that of the place where the pin comes
    nearest.
    """
    overlap, cell = greatest_overlap(surfaces, place, search)
    peak = node_of_peak(surfaces, place, cell)
    c, s = contact.map_x, contact.map_y
    nx = c * peak.nx - s * peak.ny
    ny = s * peak.nx + c * peak.ny
    pin_slope = peak.pin_slope / place.width
    # Where the overlap is greatest its derivative by the angle is zero.
    bearing_slope = (
        contact.eccentricity_y * nx - contact.eccentricity_x * ny - pin_slope
    )
    rate = contact.velocity_x * nx + contact.velocity_y * ny
    rate += joint.map_turns * (
        bearing_slope * contact.bearing_spin + pin_slope * contact.pin_spin
    )
    if contact.elastic == 0.0:
        overlap = min(overlap, 0.0)  # what has no arc is round-off
        contact.normal_x, contact.normal_y = nx, ny
        contact.approach = contact.closing = rate
    contact.penetration = overlap
    contact.rate = rate
    contact.place = joint.map_turns * contact.bearing_angle
    contact.place += (cell + 0.5) * place.width


@compiled
def end_acceleration(
    body: int, lever_x: float, lever_y: float, spin: float, a: Array
) -> tuple[float, float, float]:
    """Return the acceleration of a joint end, m/s^2, and of the angle of its body, rad/s^2."""
    if body < 0:
        return 0.0, 0.0, 0.0
    spin_t = a[body + 2]
    square = spin * spin
    ax = a[body] - spin_t * lever_y - square * lever_x
    return ax, a[body + 1] + spin_t * lever_x - square * lever_y, spin_t


@lazily_compiled(0, JOINT, SURFACES, CONTACT, 0, 0, 0, 0)
def deepest_acceleration(
    joint: Records,
    surfaces: Array,
    contact: Records,
    ax: float,
    ay: float,
    bearing_spin_t: float,
    pin_spin_t: float,
) -> float:
    """Return the second time derivative of the greatest overlap of a foundation, m/s^2.

    ``ax`` and ``ay`` are the acceleration of the eccentricity. The greatest overlap
    follows its place: p_tt - p_ts^2 / p_ss, in the frame of the bearing's map.
    """
    turns = joint.map_turns
    dx, dy = contact.eccentricity_x, contact.eccentricity_y
    zero = turns * contact.bearing_angle
    c, s = contact.map_x, contact.map_y
    relative_angle = turns * (contact.bearing_angle - contact.pin_angle)
    place = place_of(
        joint, c * dx + s * dy, c * dy - s * dx, contact.eccentricity, relative_angle
    )
    spin = turns * contact.bearing_spin
    spin_t = turns * bearing_spin_t
    turning = (spin - turns * contact.pin_spin) / place.width
    turning_t = (spin_t - turns * pin_spin_t) / place.width
    vx = c * contact.velocity_x + s * contact.velocity_y
    vy = c * contact.velocity_y - s * contact.velocity_x
    # Velocity and acceleration of the eccentricity in the turning frame
    ux = vx + spin * place.dy
    uy = vy - spin * place.dx
    bx = c * ax + s * ay + 2.0 * spin * vy + spin_t * place.dy - spin * spin * place.dx
    by = c * ay - s * ax - 2.0 * spin * vx - spin_t * place.dx - spin * spin * place.dy
    node, x = cell_of(contact.place - zero, joint.surface_nodes)
    node += joint.surface_nodes
    nx, ny, curvature, slope, slope_x, slope_t = derivatives_at(
        surfaces, place, node, x
    )
    second = bx * nx + by * ny - slope * turning_t - slope_t * turning * turning
    mixed = place.width * (uy * nx - ux * ny) - slope_x * turning
    return second - mixed * mixed / curvature if curvature < 0.0 else second


@compiled
def penetration_acceleration(
    joint: Records, surfaces: Array, contact: Records, a: Array
) -> float:
    """Return the second time derivative of the penetration, m/s^2, at accelerations of all bodies.

    A pin that runs over a bump is thrown off by the profile's curvature times the
    square of the turning.
    """
    c = contact
    eccentricity = c.eccentricity
    if eccentricity == 0.0:
        return 0.0
    pin_x, pin_y, pin_spin_t = end_acceleration(
        joint.pin_body, c.pin_lever_x, c.pin_lever_y, c.pin_spin, a
    )
    bearing_x, bearing_y, bearing_spin_t = end_acceleration(
        joint.bearing_body, c.bearing_lever_x, c.bearing_lever_y, c.bearing_spin, a
    )
    ex, ey = c.eccentricity_x, c.eccentricity_y
    vx, vy = c.velocity_x, c.velocity_y
    ax = pin_x - bearing_x
    ay = pin_y - bearing_y
    ends = (
        (BEARING, c.bearing_angle, c.bearing_spin, bearing_spin_t),
        (PIN, c.pin_angle, c.pin_spin, pin_spin_t),
    )
    count = joint.surface_nodes
    turns = joint.map_turns
    if joint.foundation > 0.0 and count > 0:
        return deepest_acceleration(
            joint, surfaces, c, ax, ay, bearing_spin_t, pin_spin_t
        )
    nx = ex / eccentricity
    ny = ey / eccentricity
    turning = (vy * nx - vx * ny) / eccentricity
    result = ax * nx + ay * ny + turning * turning * eccentricity
    if count > 0:
        approach = vx * nx + vy * ny
        turning_t = (ay * nx - ax * ny - 2.0 * approach * turning) / eccentricity
        direction = math.atan2(ny, nx)
        for row, angle, spin, spin_t in ends:
            _, slope, curvature = profile(
                surfaces, row, count, direction - turns * angle
            )
            sweep = turning - turns * spin
            result -= curvature * sweep * sweep
            result -= slope * (turning_t - turns * spin_t)
    return result


@lazily_compiled(0, JOINT, SURFACES, CONTACT, 1)
def corner_acceleration(
    joint: Records, surfaces: Array, contact: Records, a: Array
) -> float:
    """Return the second time derivative of the penetration of a corner, m/s^2.

    In the frame of a wall that turns there is the acceleration of Coriolis, too.
    """
    c = contact
    ax, ay, _ = end_acceleration(
        joint.pin_body, c.pin_lever_x, c.pin_lever_y, c.pin_spin, a
    )
    if joint.bearing_body >= 0:
        wall_x, wall_y, _ = end_acceleration(
            joint.bearing_body, c.bearing_lever_x, c.bearing_lever_y, c.bearing_spin, a
        )
        ax -= wall_x
        ay -= wall_y
    result = ax * c.normal_x + ay * c.normal_y + 2.0 * c.bearing_spin * c.sliding
    if joint.surface_bins > 0:
        _, _, curvature = wall_profile(joint, surfaces, c.place)
        result -= curvature * c.sliding * c.sliding
    return result


@inlined
def acceleration_in_gap(
    joint: Records, surfaces: Array, contact: Records, a: Array
) -> float:
    """Return the second time derivative of the penetration of a pin or of a corner, m/s^2."""
    if joint.is_flat:
        return corner_acceleration(joint, surfaces, contact, a)
    return penetration_acceleration(joint, surfaces, contact, a)
