"""Archard wear of a clearance joint: dh = K_d p ds.

There are two distributions (see ``WearLaw``). ``bin`` is that of the paper: the mean
pressure over the contact chord (equations 25 to 28) wears the one bin of the contact.
Worn volume and depth then depend on the width of the bins. ``arc`` distributes the
depth over the contact arc in proportion to the pressure of a linear elastic foundation.
The worn volume is then K_d times the integral of F_n ds, to round-off.
"""

import math
from collections.abc import Sequence

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.physics.arc_shares import count_arcs, deposit_round, share_arc
from presswear.physics.contact import CONTACT, direction_of
from presswear.physics.overlap import place_of
from presswear.physics.packed import JOINT
from presswear.physics.worn_map import ARC_END, ARC_START, SURFACES, bin_of
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

ARC_MARGIN = 1e-9  # rad, round-off of the ends of an arc


@inlined
def contact_area(
    penetration: float,
    eccentricity: float,
    bearing_radius: float,
    pin_radius: float,
    width: float,
) -> float:
    """Return the contact area A = 2 b R_i sin(pi - beta), m^2 (equations 25 to 27 as printed).

    beta is an angle at the centre of the pin, so that half the chord is R_j sin(beta):
    the printed area is too large by R_i / R_j. 1 + cos(beta) is computed from the
    penetration, because equation 25 as printed loses ten digits to cancellation.
    """
    total = eccentricity + pin_radius + bearing_radius
    one_plus_cosine = penetration * total / (2.0 * eccentricity * pin_radius)
    # The contact is at most half a turn wide, also of a very worn pin.
    sine = 1.0
    if one_plus_cosine < 1.0:
        sine = math.sqrt(one_plus_cosine * (2.0 - one_plus_cosine))
    return 2.0 * width * bearing_radius * sine


@compiled
def deposit_in_bins(
    depth: Array, joint: Records, contact: Records, pressure_distance: float, h: float
) -> None:
    """Add the wear of an integral p ds, N/m, to the depths of both surfaces, shape (2, m).

    It is distributed over the bins that the contact crosses in a step of length ``h``, s.
    """
    depth_sum = joint.wear_coefficient * pressure_distance
    turns = joint.map_turns
    direction = direction_of(contact)
    ends = (
        (contact.bearing_angle, contact.bearing_spin, joint.bearing_share),
        (contact.pin_angle, contact.pin_spin, 1.0 - joint.bearing_share),
    )
    for side, (angle, spin, share) in enumerate(ends):
        place = direction - turns * angle
        # angle of the map over which the contact has moved
        swept = h * (contact.turning - turns * spin)
        spread_evenly(depth[side], place - swept, place, share * depth_sum)


@compiled
def spread_evenly(depth: Array, start: float, end: float, depth_sum: float) -> None:
    """Add a sum of depths to the bins of a map, shape (m,), between two angles, rad."""
    count = depth.shape[0]
    low = min(start, end) * count / (2.0 * math.pi)
    high = max(start, end) * count / (2.0 * math.pi)
    first = math.floor(low)
    last = math.floor(high)
    if first == last or not high - low < count:
        depth[bin_of(end, count)] += depth_sum
        return
    for k in range(first, last + 1):
        covered = min(high, k + 1.0) - max(low, float(k))
        depth[k % count] += depth_sum * covered / (high - low)


@lazily_compiled((0.0, 0.0), 2, JOINT, SURFACES, CONTACT, 0, 2)
def deposit_over_arc(
    depth: Array,
    joint: Records,
    surfaces: Array,
    contact: Records,
    load_distance: float,
    shares: Array,
) -> tuple[float, float]:
    """Add the wear of a load distance F_n ds, N m, to the bins in which the surfaces overlap.

    Return start and end of the arc in which they lie, in the map of the bearing, rad.
    ``depth`` are the wear maps of bearing and pin, m, shape (2, n). ``shares`` is
    working space of the same shape; it is zero before and after the call.
    """
    zero = joint.map_turns * contact.bearing_angle
    relative_angle = joint.map_turns * (contact.bearing_angle - contact.pin_angle)
    bin_area = joint.width * joint.bearing_radius * 2.0 * math.pi / depth.shape[1]
    depth_sum = joint.wear_coefficient * load_distance / bin_area
    # The film of an oiled joint, and its contact, have the shape of new surfaces.
    if joint.surface_nodes == 0 or joint.always_closed:
        return deposit_round_arc(depth, joint, contact, zero, relative_angle, depth_sum)
    return deposit_worn_arc(
        depth, joint, surfaces, contact, zero, relative_angle, depth_sum, shares
    )


@compiled
def deposit_round_arc(
    depth: Array,
    joint: Records,
    contact: Records,
    zero: float,
    relative_angle: float,
    depth_sum: float,
) -> tuple[float, float]:
    """Add a sum of depths, m, to both maps, shape (2, n), over the arc of round surfaces.

    Return the arc in the map of the bearing, rad.
    """
    eccentricity = contact.eccentricity
    clearance = joint.clearance
    direction = direction_of(contact) - zero
    half = 0.0
    if eccentricity > clearance:
        # Half of the arc: cos(half) = c / e, written without cancellation.
        sine_square = 0.5 * (eccentricity - clearance) / eccentricity
        half = 2.0 * math.asin(math.sqrt(sine_square))
    for side in range(2):
        share = joint.bearing_share if side == 0 else 1.0 - joint.bearing_share
        centre = direction + side * relative_angle
        deposit_round(
            eccentricity, clearance, centre, half, share * depth_sum, depth[side]
        )
    return direction - half - ARC_MARGIN, direction + half + ARC_MARGIN


@lazily_compiled((0.0, 0.0), 2, JOINT, SURFACES, CONTACT, 0, 0, 0, 2)
def deposit_worn_arc(
    depth: Array,
    joint: Records,
    surfaces: Array,
    contact: Records,
    zero: float,
    relative_angle: float,
    depth_sum: float,
    shares: Array,
) -> tuple[float, float]:
    """Add a sum of depths, m, to both maps, shape (2, n), over the arcs of worn surfaces.

    Return the arc that holds them in the map of the bearing, rad.
    """
    start, end = share_worn_arc(joint, surfaces, contact, zero, relative_angle, shares)
    bins = depth.shape[1]
    for side in range(2):
        share = joint.bearing_share if side == 0 else 1.0 - joint.bearing_share
        first = bin_of(start + side * relative_angle, bins)
        count = bins_in(end - start, bins)
        total = 0.0
        k = first
        for _ in range(count):
            total += shares[side, k]
            k = k + 1 if k + 1 < bins else 0
        if total == 0.0:
            # After a separation, or with an overlap below round-off, all wear is added
            # to the bin in the direction of the contact.
            normal = math.atan2(contact.normal_y, contact.normal_x) - zero
            k = bin_of(normal + side * relative_angle, bins)
            depth[side, k] += share * depth_sum
            end = start + 2.0 * math.pi  # the bin may be anywhere
            continue
        scale = share * depth_sum / total
        k = first
        for _ in range(count):
            depth[side, k] += scale * shares[side, k]
            shares[side, k] = 0.0
            k = k + 1 if k + 1 < bins else 0
    return start, end


@inlined
def bins_in(arc: float, count: int) -> int:
    """Return the largest number of bins of a map that an arc, rad, touches."""
    return min(int(arc * count / (2.0 * math.pi)) + 2, count)


@compiled
def share_worn_arc(
    joint: Records,
    surfaces: Array,
    contact: Records,
    zero: float,
    relative_angle: float,
    shares: Array,
) -> tuple[float, float]:
    """Add the integrals of the overlap to the bins of both maps; return the arc, rad."""
    dx, dy = contact.eccentricity_x, contact.eccentricity_y
    c, s = contact.map_x, contact.map_y
    place = place_of(
        joint, c * dx + s * dy, c * dy - s * dx, contact.eccentricity, relative_angle
    )
    arcs = count_arcs(surfaces, joint, place, contact.place - zero)
    for i in range(arcs):
        share_arc(surfaces, joint, place, i, shares)
    start = surfaces[ARC_START, 0]
    end = surfaces[ARC_END, max(arcs - 1, 0)]
    width = place.width
    return (start + 0.5) * width - ARC_MARGIN, (end + 0.5) * width + ARC_MARGIN


def map_shape(joints: Sequence[ClearanceJoint]) -> tuple[int, int, int]:
    """Return the shape (joints, 2, m) of the wear maps; a joint uses its first ``bins``."""
    return len(joints), 2, max((joint.bins for joint in joints), default=1)


def worn_volume(joint: ClearanceJoint, depth: Array) -> float:
    """Return the volume lost by both surfaces, m^3: the integral of depth over their area.

    ``depth`` is the added depth of bearing and pin, m, shape (2, m). A corner has the
    volume of its wall.
    """
    bin_area = joint.map_area / depth.shape[1]
    return float(depth.sum()) * bin_area


def largest_play(joint: ClearanceJoint, depth: Array) -> float:
    """Return the largest displacement of the pin of a worn joint across its bearing, m.

    It is twice the clearance of a new joint. A pin moves until it touches the bearing at
    any angle, so that it does not enter narrow grooves. The deepest points of both
    surfaces face each other, as under load, and the surfaces are rigid.

    Parameters
    ----------
    joint : ClearanceJoint
    depth : ndarray, shape (2, bins)
        Worn depth of bearing and pin, m.
    """
    bearing, pin = depth
    bins = bearing.size
    turned_pin = np.roll(pin, int(np.argmax(bearing)) - int(np.argmax(pin)))
    gap = joint.clearance + bearing + turned_pin
    quarter = (bins - 1) // 4
    offset = np.arange(-quarter, quarter + 1)
    cosine = np.cos(2.0 * math.pi / bins * offset)
    contact_bin = (np.arange(bins)[:, np.newaxis] + offset) % bins
    displacement = (gap[contact_bin] / cosine).min(axis=1)  # in each direction
    half = bins // 2
    # With an odd number of bins the opposite direction is between two of them.
    opposite = 0.5 * (np.roll(displacement, -half) + np.roll(displacement, half - bins))
    return float((displacement + opposite).max())
