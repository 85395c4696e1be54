"""Archard wear of a clearance joint: dh = K_d p ds.

Two accounts (see ``WearLaw``).  ``bin`` is the paper's: the mean pressure over
the contact chord (equations 25 to 28), all of it into the one bin of the contact,
which makes worn volume and depth depend on the width of the bins.  ``arc`` spreads
the depth over the contact arc in proportion to the pressure of a linear elastic
foundation, and the worn volume is K_d times the integral of F_n ds to round-off.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.physics.contact import direction_of
from presswear.physics.surface import BEARING, PIN, SLOPE, bin_of, profile
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]

SLIGHTEST_PENETRATION = 1e-15
"""Penetration below which a contact arc is a point, m."""

ARC_SAMPLES = 16
"""Points of the pressure distribution on each half of a round joint's contact arc, at least."""

BIN_SAMPLES = 4
"""Points of the pressure distribution in one bin of the map, at least."""


@compiled
def slip_speed(by_angle: bool, pin_radius: float, contact: Records) -> float:
    """Rate of slip ds/dt, m/s: (R_j + delta) |phi_dot| (equation 24) or |v_t|."""
    if by_angle:
        return (pin_radius + contact.penetration) * abs(contact.turning)
    return abs(contact.sliding)


@compiled
def contact_area(
    penetration: float,
    eccentricity: float,
    bearing_radius: float,
    pin_radius: float,
    width: float,
) -> float:
    """Contact area A = 2 b R_i sin(pi - beta), m^2 (equations 25 to 27).

    cos beta + 1 is formed from the penetration itself; equation 25 as printed loses
    ten digits to cancellation.
    """
    above = (
        penetration
        * (eccentricity + pin_radius + bearing_radius)
        / (2.0 * eccentricity * pin_radius)
    )
    # A pin worn to less than half the bearing would meet it over more than a half turn.
    sine: float = 1.0 if above >= 1.0 else math.sqrt(above * (2.0 - above))
    return 2.0 * width * bearing_radius * sine


@compiled
def dose_rates(joint: Records, contact: Records, normal: float) -> tuple[float, float]:
    """Rates of the two doses of wear: F_n ds/dt, W, and p ds/dt, W/m^2, with p = F_n / A.

    Zero where no account is kept.
    """
    if normal <= 0.0 or joint.wear_coefficient == 0.0:
        return 0.0, 0.0
    work = normal * slip_speed(joint.slip_by_angle, joint.pin_radius, contact)
    indentation = 0.5 * contact.penetration
    area = contact_area(
        contact.penetration,
        contact.eccentricity,
        contact.bearing_arm - indentation,
        contact.pin_arm + indentation,
        joint.width,
    )
    return work, work / area


@compiled
def deposit_in_bin(
    depth: Array,
    joint: Records,
    contact: Records,
    pressure_dose: float,
) -> None:
    """Add the wear of a dose p ds, N/m, to the bins of the contact.

    Parameters
    ----------
    depth : ndarray, shape (2, m)
        Depth of bearing and pin, m.
    """
    added = joint.wear_coefficient * pressure_dose
    count = depth.shape[1]
    turns = joint.map_turns
    bearing_bin = bin_of(direction_of(contact) - turns * contact.bearing_angle, count)
    pin_bin = bin_of(direction_of(contact) - turns * contact.pin_angle, count)
    depth[0, bearing_bin] += joint.bearing_share * added
    depth[1, pin_bin] += (1.0 - joint.bearing_share) * added


@compiled
def deposit_over_arc(
    depth: Array,
    joint: Records,
    surfaces: Array,
    contact: Records,
    dose: float,
    pressure: Array,
) -> None:
    """Add the wear of a dose F_n ds, N m, over the contact arc.

    The overlap e . n(theta) - c - h_bearing - h_pin is followed outwards from the
    direction of contact until it ends; on a foundation as far as there can be another
    patch.  ``pressure`` is working space.
    """
    count = depth.shape[1]
    worn = surfaces.shape[1] > 0
    turns = joint.map_turns
    direction = direction_of(contact)
    bearing_zero = turns * contact.bearing_angle
    pin_zero = turns * contact.pin_angle
    # A step that ends with the separation leaves its wear where the pin last was.
    penetration = max(contact.penetration, SLIGHTEST_PENETRATION)
    half_arc = math.sqrt(2.0 * penetration / contact.eccentricity)
    step = min(half_arc / ARC_SAMPLES, 2.0 * math.pi / count / BIN_SAMPLES)
    # A groove that fits the pin may hold it over much more than the round arc.
    reach = math.pi
    has_patches = joint.foundation > 0.0
    if has_patches:
        above = contact.eccentricity - joint.clearance - joint.least_depth
        sine = math.sqrt(min(max(0.5 * above / contact.eccentricity, 0.0), 1.0))
        reach = 2.0 * math.asin(sine) + step
    most = min(int(reach / step) + 1, pressure.shape[0] // 2 - 1)
    used = 0
    total = 0.0
    for side in (-1.0, 1.0):
        for i in range(most):
            offset = side * (i + 0.5) * step
            angle = direction + offset
            # cos(x) - 1 without cancellation
            half = math.sin(0.5 * offset)
            overlap = contact.eccentricity * (1.0 - 2.0 * half * half) - joint.clearance
            if worn:
                overlap -= profile(
                    surfaces[BEARING], surfaces[BEARING + SLOPE], angle - bearing_zero
                )[0]
                overlap -= profile(surfaces[PIN], surfaces[PIN + SLOPE], angle - pin_zero)[0]
            if overlap <= 0.0:
                if not has_patches:
                    break
                overlap = 0.0
            pressure[used] = overlap
            used += 1
            total += overlap
        if side < 0.0:
            left = used
    bin_width = 2.0 * math.pi / count
    if total == 0.0:
        # An overlap so slight that round-off hides it: all of it at the contact.
        pressure[0], total, used, left = 1.0, 1.0, 1, 0
        direction = math.atan2(contact.normal_y, contact.normal_x)
    scale = joint.wear_coefficient * dose / (joint.width * joint.bearing_radius * bin_width * total)
    for i in range(used):
        offset = -(i + 0.5) * step if i < left else (i - left + 0.5) * step
        angle = direction + offset
        added = scale * pressure[i]
        depth[0, bin_of(angle - bearing_zero, count)] += joint.bearing_share * added
        depth[1, bin_of(angle - pin_zero, count)] += (1.0 - joint.bearing_share) * added


def worn_volume(joint: ClearanceJoint, depth: Array) -> float:
    """Volume lost by both surfaces, m^3: the integral of depth times b R over angle.

    Parameters
    ----------
    depth : ndarray, shape (2, m)
        Depth added to the bearing and to the pin, m.
    """
    bin_area = joint.width * joint.bearing_radius * 2.0 * math.pi / depth.shape[1]
    return float(depth.sum()) * bin_area
