"""Wear over the contact arc that grows as a power of the pressure.

    dh = K_d p (p / p_ref)^(m - 1) ds,   p = F_n nu / (b R),

where nu is the overlap at an angle over the integral of the overlap, 1/rad. The engines
compute the integral D of F_n (F_n / (b R w p_ref))^(m - 1) ds over the sliding distance,
where w is the width of the arc of round surfaces. At the end of a step the depth of a bin of
width dtheta grows by

    K_d / (b R) D w^(m - 1) (integral of nu^m over the bin) / dtheta.

The width w cancels if it does not change within a step. If the arc widens within a
step, w makes the result accurate, because nu^m w^(m - 1) is nearly the same for narrow
and wide arcs.
"""

import math

import numpy as np

from presswear.physics.arc_shares import area_at, count_arcs, round_area
from presswear.physics.contact import CONTACT, direction_of
from presswear.physics.overlap import (
    Cubic,
    Place,
    node_at,
    overlap_between,
    place_of,
    value_at,
)
from presswear.physics.packed import JOINT
from presswear.physics.rotation import cos_sin
from presswear.physics.worn_map import ARC_END, ARC_START, SURFACES, bin_of
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

# Least overlap for which the pressure is computed, m. A smaller overlap is replaced by
# this one, of round surfaces.
LEAST_OVERLAP = 1e-9
# Gauss's rule with three points on -1 to 1: place of the outer points; weights of an outer
# point and of the middle one, with sum 1
GAUSS_POINT = math.sqrt(0.6)
GAUSS_WEIGHTS = 5 / 18, 8 / 18


@inlined
def arc_width(penetration: float, clearance: float) -> float:
    """Return the width of the contact arc of round surfaces at a small penetration, rad."""
    return 2.0 * math.sqrt(2.0 * max(penetration, LEAST_OVERLAP) / clearance)


@lazily_compiled(None, 2, JOINT, SURFACES, CONTACT, 0, 2)
def deposit_by_pressure(
    depth: Array,
    joint: Records,
    surfaces: Array,
    contact: Records,
    wear_integral: float,
    shares: Array,
) -> None:
    """Add the wear of an integral D, N m, to the bins in which the surfaces overlap.

    ``depth`` are the wear maps of bearing and pin, m, shape (2, n). ``shares`` is
    working space of the same shape; it is zero before and after the call.
    """
    zero = joint.map_turns * contact.bearing_angle
    relative_angle = joint.map_turns * (contact.bearing_angle - contact.pin_angle)
    bin_area = joint.width * joint.bearing_radius * 2.0 * math.pi / depth.shape[1]
    width = arc_width(contact.penetration, joint.clearance)
    power = joint.pressure_exponent
    overlap_integral = 0.0  # m rad
    if contact.penetration > LEAST_OVERLAP:
        if joint.surface_nodes == 0:
            overlap_integral = share_round(joint, contact, zero, relative_angle, shares)
        else:
            overlap_integral = share_worn(
                joint, surfaces, contact, zero, relative_angle, shares
            )
    scale = joint.wear_coefficient * wear_integral / bin_area
    normal = math.atan2(contact.normal_y, contact.normal_x) - zero
    for side in range(2):
        share = joint.bearing_share if side == 0 else 1.0 - joint.bearing_share
        if overlap_integral > 0.0:
            factor = share * scale * width ** (power - 1.0) / overlap_integral**power
            for k in range(depth.shape[1]):
                depth[side, k] += factor * shares[side, k]
                shares[side, k] = 0.0
        else:
            k = bin_of(normal + side * relative_angle, depth.shape[1])
            depth[side, k] += share * scale * narrow_share(power)


@compiled
def narrow_share(power: float) -> float:
    """Return w^(m - 1) times the integral of nu^m over an arc that is narrower than a bin.

    On such an arc nu is a parabola, so that the integral of (1 - x^2)^m from -1 to 1 is
    needed.
    """
    integral = math.sqrt(math.pi) * math.gamma(power + 1.0) / math.gamma(power + 1.5)
    return float(0.75**power * 2.0 ** (power - 1.0) * integral)


@compiled
def share_round(
    joint: Records,
    contact: Records,
    zero: float,
    relative_angle: float,
    shares: Array,
) -> float:
    """Add the integrals of overlap^m, m^m rad, to the bins; return that of the overlap, m rad."""
    eccentricity = contact.eccentricity
    clearance = joint.clearance
    if not eccentricity > clearance:
        return 0.0
    # Half of the arc: cos(half) = c / e, written without cancellation.
    half = 2.0 * math.asin(math.sqrt(0.5 * (eccentricity - clearance) / eccentricity))
    direction = direction_of(contact) - zero
    bins = shares.shape[1]
    width = 2.0 * math.pi / bins
    for side in range(2):
        centre = direction + side * relative_angle
        k = int(np.floor((centre - half) / width))
        low = -half
        while low < half:
            high = min(max((k + 1) * width - centre, low), half)
            integral = round_power(
                eccentricity, clearance, low, high, joint.pressure_exponent
            )
            shares[side, k % bins] += integral
            low = high
            k += 1
    return 2.0 * round_area(eccentricity, clearance, half)


@compiled
def round_power(
    eccentricity: float, clearance: float, low: float, high: float, power: float
) -> float:
    """Return the integral of overlap^m of round surfaces between two angles from e, rad."""
    middle = 0.5 * (low + high)
    half = 0.5 * (high - low)
    total = 0.0
    for i in range(-1, 2):
        half_sine = math.sin(0.5 * (middle + i * GAUSS_POINT * half))
        overlap = eccentricity - clearance - 2.0 * eccentricity * half_sine * half_sine
        total += GAUSS_WEIGHTS[1 - abs(i)] * max(overlap, 0.0) ** power
    return (high - low) * total


@compiled
def share_worn(
    joint: Records,
    surfaces: Array,
    contact: Records,
    zero: float,
    relative_angle: float,
    shares: Array,
) -> float:
    """Add the integrals of overlap^m, m^m rad, to the bins; return that of the overlap, m rad."""
    dx, dy = contact.eccentricity_x, contact.eccentricity_y
    c, s = cos_sin(zero)
    place = place_of(
        joint, c * dx + s * dy, c * dy - s * dx, contact.eccentricity, relative_angle
    )
    overlap = 0.0
    for i in range(count_arcs(surfaces, joint, place, contact.place - zero)):
        overlap += share_power(surfaces, joint, place, i, shares)
    return overlap * place.width


@compiled
def share_power(
    surfaces: Array, joint: Records, place: Place, arc: int, shares: Array
) -> float:
    """Add the integrals of overlap^m over an arc to the bins of both maps, shape (2, n).

    Return the integral of the overlap, m times cells.
    """
    start, end = surfaces[ARC_START, arc], surfaces[ARC_END, arc]
    ratio = shares.shape[1] / joint.surface_nodes
    pin_shift = 0.5 + place.lag + place.offset
    power = joint.pressure_exponent
    left = node_at(surfaces, place, int(start))
    total = 0.0
    for node in range(int(start), int(np.ceil(end))):
        right = node_at(surfaces, place, node + 1)
        p = overlap_between(left, right, place.width)
        low = max(start - node, 0.0)
        high = min(end - node, 1.0)
        total += max(area_at(p, high) - area_at(p, low), 0.0)
        for side in range(2):
            first = node + (0.5 if side == 0 else pin_shift)
            x = low
            k = int(np.floor((first + low) * ratio))
            while x < high:
                bin_end = min(max((k + 1) / ratio - first, x), high)
                integral = place.width * power_between(p, x, bin_end, power)
                shares[side, k % shares.shape[1]] += integral
                x = bin_end
                k += 1
        left = right
    return total


@compiled
def power_between(p: Cubic, low: float, high: float, power: float) -> float:
    """Return the integral of a power of a positive cubic between two positions in a cell."""
    middle = 0.5 * (low + high)
    half = 0.5 * (high - low)
    total = 0.0
    for i in range(-1, 2):
        overlap = value_at(p, middle + i * GAUSS_POINT * half)
        total += GAUSS_WEIGHTS[1 - abs(i)] * max(overlap, 0.0) ** power
    return (high - low) * total
