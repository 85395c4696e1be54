"""How a pin meets its bearing: states of both ends in, contact out.

Round surfaces, and worn ones under ``radial`` contact, meet where the eccentricity
points; worn ones on a ``foundation`` over all of the arc.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.foundation import Bed, press
from presswear.physics.joint_data import Contact, Pose
from presswear.physics.laws import elastic_force
from presswear.physics.surface import BEARING, PIN, SLOPE, profile
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]


@compiled
def radial_contact(
    joint: Records,
    bearing: Pose,
    pin: Pose,
    bearing_depth: Array,
    bearing_slope: Array,
    pin_depth: Array,
    pin_slope: Array,
) -> Contact:
    """Contact of the pin with the point of the surface that faces it.

    The rate of penetration follows the worn profile: delta_dot = e_dot . n minus the
    change of both depths under the moving contact.
    """
    ex = pin.x - bearing.x
    ey = pin.y - bearing.y
    vx = pin.vx - bearing.vx
    vy = pin.vy - bearing.vy
    eccentricity = math.sqrt(ex * ex + ey * ey)
    if eccentricity > 0.0:
        nx = ex / eccentricity
        ny = ey / eccentricity
        turning = (ex * vy - ey * vx) / (eccentricity * eccentricity)
    else:
        # A pin exactly in the centre touches nothing: any direction serves.
        nx, ny, turning = 1.0, 0.0, 0.0
    penetration = eccentricity - joint.clearance
    approach = vx * nx + vy * ny
    rate = approach
    pin_radius = joint.pin_radius
    bearing_radius = joint.bearing_radius
    if bearing_depth.shape[0] > 0:
        turns = joint.map_turns
        direction = math.atan2(ny, nx)
        depth, slope = profile(bearing_depth, bearing_slope, direction - turns * bearing.angle)
        penetration -= depth
        bearing_radius += depth
        rate -= slope * (turning - turns * bearing.spin)
        depth, slope = profile(pin_depth, pin_slope, direction - turns * pin.angle)
        penetration -= depth
        pin_radius -= depth
        rate -= slope * (turning - turns * pin.spin)
    # Half the penetration on either side, so that both arms end at one point.
    indentation = 0.5 * max(penetration, 0.0)
    pin_arm = pin_radius - indentation
    bearing_arm = bearing_radius + indentation
    sliding = vy * nx - vx * ny + pin.spin * pin_arm - bearing.spin * bearing_arm
    elastic = elastic_force(penetration, joint.stiffness, joint.exponent)
    energy = elastic * penetration / (joint.exponent + 1.0)
    return Contact(
        penetration,
        rate,
        sliding,
        turning,
        nx,
        ny,
        eccentricity,
        ex,
        ey,
        pin_arm,
        bearing_arm,
        approach,
        elastic,
        rate,
        energy,
        0.0,
        0.0,
    )


@compiled
def bed_between(
    joint: Records, bearing: Pose, pin: Pose, surfaces: Array, ex: float, ey: float
) -> tuple[Bed, float, float, float]:
    """The foundation's bed, with the direction of e and those of the maps' zeros, rad."""
    direction = math.atan2(ey, ex)
    bearing_zero = joint.map_turns * bearing.angle
    pin_zero = joint.map_turns * pin.angle
    bed = press(
        surfaces,
        math.sqrt(ex * ex + ey * ey),
        joint.clearance,
        joint.least_depth,
        direction - bearing_zero,
        direction - pin_zero,
    )
    return bed, direction, bearing_zero, pin_zero


@compiled
def foundation_contact(joint: Records, bearing: Pose, pin: Pose, surfaces: Array) -> Contact:
    """Contact of the pin with all of the worn arc, through an elastic foundation.

    Force and couples are the gradient of the elastic energy in e and in both bodies'
    angles.  The pin's couple follows from the bearing's: turned together, nothing
    changes.  Damping multiplies all of them, with the rate at which they are worked
    against.
    """
    ex = pin.x - bearing.x
    ey = pin.y - bearing.y
    vx = pin.vx - bearing.vx
    vy = pin.vy - bearing.vy
    eccentricity = math.sqrt(ex * ex + ey * ey)
    turning = (ex * vy - ey * vx) / (eccentricity * eccentricity) if eccentricity > 0.0 else 0.0
    bed, direction, bearing_zero, pin_zero = bed_between(joint, bearing, pin, surfaces, ex, ey)
    turns = joint.map_turns
    place = direction + bed.place
    nx = math.cos(place)
    ny = math.sin(place)
    _, bearing_slope = profile(surfaces[BEARING], surfaces[BEARING + SLOPE], place - bearing_zero)
    pin_depth, pin_slope = profile(surfaces[PIN], surfaces[PIN + SLOPE], place - pin_zero)
    rate = vx * nx + vy * ny
    rate += turns * (bearing_slope * bearing.spin + pin_slope * pin.spin)
    elastic = 0.0
    closing = approach = rate
    couple = 0.0
    if bed.overlap > 0.0:
        size = math.sqrt(bed.along * bed.along + bed.across * bed.across)
        if size > 0.0:
            k = joint.foundation
            elastic = k * size
            cosine = math.cos(direction)
            sine = math.sin(direction)
            nx = (cosine * bed.along - sine * bed.across) / size
            ny = (sine * bed.along + cosine * bed.across) / size
            on_bearing = -k * turns * bed.slope
            couple = elastic * (ex * ny - ey * nx) - on_bearing
            turned = (couple * pin.spin + on_bearing * bearing.spin) / elastic
            approach = vx * nx + vy * ny - turned
            # Maps fixed in direction store no energy when the bodies turn.
            closing = approach if turns > 0.0 else approach + turned
    pin_arm = joint.pin_radius - pin_depth - 0.5 * max(bed.overlap, 0.0)
    bearing_arm = pin_arm + ex * nx + ey * ny
    sliding = vy * nx - vx * ny + pin.spin * pin_arm - bearing.spin * bearing_arm
    return Contact(
        bed.overlap,
        rate,
        sliding,
        turning,
        nx,
        ny,
        eccentricity,
        ex,
        ey,
        pin_arm,
        bearing_arm,
        approach,
        elastic,
        closing,
        0.5 * joint.foundation * bed.square,
        place,
        couple,
    )
