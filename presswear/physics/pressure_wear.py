"""Wear over the contact arc that grows as a power of the pressure.

    dh = K_d p (p / p_ref)^(m - 1) ds,   p = F_n nu / (b R),

with the share nu of an angle in the integral of the overlap, 1/rad. The engines
integrate the dose D of F_n ds (F_n / (b R w p_ref))^(m - 1) over time, with the width w
of the arc of round surfaces. At the end of a step a bin of width dtheta gets

    K_d / (b R) D w^(m - 1) (integral of nu^m over the bin) / dtheta.

The width cancels, so that it matters only where the arc widens within a step: there
narrow arcs differ from wide ones in scale, and nu^m w^(m - 1) hardly changes.
"""

import math

import numpy as np

from presswear.physics.contact import CONTACT, direction_of
from presswear.physics.foundation import (
    ARC_END,
    ARC_START,
    SURFACES,
    Cubic,
    Place,
    area_at,
    bin_of,
    count_arcs,
    node_at,
    overlap_between,
    place_of,
    round_area,
    value_at,
)
from presswear.physics.packed import JOINT
from presswear.physics.rotation import cos_sin
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

# m: where surfaces overlap less, the pressure is that of round ones with this overlap.
LEAST_OVERLAP = 1e-9
GAUSS_PLACE = math.sqrt(0.6)  # of Gauss's rule with three points
GAUSS_WEIGHTS = 5 / 18, 8 / 18  # of both outer points and of the middle


@inlined
def arc_width(penetration: float, clearance: float) -> float:
    """Return the width of the contact arc of round surfaces, rad, of a small penetration."""
    return 2.0 * math.sqrt(2.0 * max(penetration, LEAST_OVERLAP) / clearance)


@lazily_compiled(None, 2, JOINT, SURFACES, CONTACT, 0, 2)
def deposit_by_pressure(
    depth: Array,
    joint: Records,
    surfaces: Array,
    contact: Records,
    dose: float,
    shares: Array,
) -> None:
    """Add the wear of a dose, N m, wherever the surfaces overlap.

    ``depth`` and ``shares``, a working space that is zero and left so, have the shape
    (2, n).
    """
    zero = joint.map_turns * contact.bearing_angle
    relative_angle = joint.map_turns * (contact.bearing_angle - contact.pin_angle)
    bin_area = joint.width * joint.bearing_radius * 2.0 * math.pi / depth.shape[1]
    width = arc_width(contact.penetration, joint.clearance)
    power = joint.pressure_exponent
    overlap = 0.0  # its integral, m rad
    if contact.penetration > LEAST_OVERLAP:
        if joint.surface_nodes == 0:
            overlap = share_round(joint, contact, zero, relative_angle, shares)
        else:
            overlap = share_worn(joint, surfaces, contact, zero, relative_angle, shares)
    scale = joint.wear_coefficient * dose / bin_area
    normal = math.atan2(contact.normal_y, contact.normal_x) - zero
    for side in range(2):
        part = joint.bearing_share if side == 0 else 1.0 - joint.bearing_share
        if overlap > 0.0:
            factor = part * scale * width ** (power - 1.0) / overlap**power
            for k in range(depth.shape[1]):
                depth[side, k] += factor * shares[side, k]
                shares[side, k] = 0.0
        else:
            place = bin_of(normal + side * relative_angle, depth.shape[1])
            depth[side, place] += part * scale * narrow_share(power)


@compiled
def narrow_share(power: float) -> float:
    """Return w^(m - 1) times the integral of nu^m over an arc that is narrower than a bin.

    There nu is a parabola, and its integral that of (1 - x^2)^m from -1 to 1.
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
    eccentricity, clearance = contact.eccentricity, joint.clearance
    if not eccentricity > clearance:
        return 0.0
    half = 2.0 * math.asin(
        math.sqrt(0.5 * (eccentricity - clearance) / eccentricity)
    )  # cos(half) = c / e
    direction = direction_of(contact) - zero
    bins = shares.shape[1]
    width = 2.0 * math.pi / bins
    for side in range(2):
        place = direction + side * relative_angle
        k = int(np.floor((place - half) / width))
        low = -half
        while low < half:
            high = min(max((k + 1) * width - place, low), half)
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
    middle, reach = 0.5 * (low + high), 0.5 * (high - low)
    total = 0.0
    for i in range(-1, 2):
        half_sine = math.sin(0.5 * (middle + i * GAUSS_PLACE * reach))
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
                following = min(max((k + 1) / ratio - first, x), high)
                integral = place.width * power_between(p, x, following, power)
                shares[side, k % shares.shape[1]] += integral
                x = following
                k += 1
        left = right
    return total


@compiled
def power_between(p: Cubic, low: float, high: float, power: float) -> float:
    """Return the integral of a positive polynomial to a power between two places of a cell."""
    middle, reach = 0.5 * (low + high), 0.5 * (high - low)
    total = 0.0
    for i in range(-1, 2):
        overlap = value_at(p, middle + i * GAUSS_PLACE * reach)
        total += GAUSS_WEIGHTS[1 - abs(i)] * max(overlap, 0.0) ** power
    return (high - low) * total
