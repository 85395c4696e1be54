"""Archard wear: area, slip, where the depth goes and how much volume it is."""

import math
from dataclasses import replace
from decimal import Decimal, localcontext
from typing import Literal

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from two_bodies import JOINT, Pair, placed, worn_joint
from worn_depths import fine_overlaps

from presswear.linkage.clearance_joint import ClearanceJoint, MapFrame, SurfaceContact
from presswear.linkage.surface import Surface
from presswear.linkage.wear_law import WearLaw
from presswear.physics.contact import direction_of
from presswear.physics.foundation import integrate_overlap
from presswear.physics.overlap import place_of
from presswear.physics.wear import (
    contact_area,
    deposit_in_bins,
    deposit_over_arc,
    largest_play,
    spread_evenly,
    worn_volume,
)
from presswear.physics.worn_map import bin_of
from presswear.tools.arrays import Array

Footprint = Literal["bin", "arc"]

COEFFICIENT = 1.2e-15
TURN = 2.0 * math.pi
SLIDING = np.array([0.1, -0.2, 3.0, 0.2, 0.1, -7.0])


def _law(wear_distribution: Footprint, share: float = 0.5) -> WearLaw:
    return WearLaw(COEFFICIENT, "sliding", wear_distribution, share)


def _deposited(pair: Pair, count: int, load_distance: float) -> Array:
    """Depths that a load distance adds to empty maps of bearing and pin, shape (2, count)."""
    contact = pair.contact()
    packed = pair.packed.joints[0]
    depth, shares = np.zeros((2, 2, count))
    if packed["over_arc"]:
        deposit_over_arc(
            depth, packed, pair.packed.surfaces[0], contact, load_distance, shares
        )
        assert not shares.any()
    else:
        work, pressure = pair.wear_rates()
        deposit_in_bins(depth, packed, contact, pressure / work * load_distance, 0.0)
    return depth


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [
        (2.2, 2.7, {2: 1.0}),
        (1.5, 4.0, {1: 0.2, 2: 0.4, 3: 0.4}),
        (4.0, 1.5, {1: 0.2, 2: 0.4, 3: 0.4}),  # backwards
        (-0.5, 0.5, {15: 0.5, 0: 0.5}),  # over the seam
        (3.0, 40.0, {8: 1.0}),  # more than a turn: where it ends
    ],
)
def test_a_load_distance_is_spread_over_the_bins_that_are_crossed(start, end, expected):
    """Angles in bins of a map of sixteen."""
    depth = np.zeros(16)
    width = TURN / 16
    spread_evenly(depth, width * start, width * end, 3.0)
    wanted = np.zeros(16)
    for k, part in expected.items():
        wanted[k] = 3.0 * part
    assert depth == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def _area_as_printed(
    e: Decimal, bearing: Decimal, pin: Decimal, width: Decimal
) -> Decimal:
    """Equations 25 to 27 to fifty digits: A = 2 b R_i sin(pi - beta)."""
    with localcontext() as context:
        context.prec = 50
        cosine = (e**2 + pin**2 - bearing**2) / (2 * e * pin)
        return 2 * width * bearing * (1 - cosine**2).sqrt()


@given(
    st.floats(1e-14, 1e-4),
    st.floats(5e-5, 1e-3),
    st.floats(0.005, 0.03),
    st.floats(0.001, 0.1),
)
def test_area_is_equations_25_to_27(penetration, clearance, radius, width):
    bearing = Decimal(radius)
    pin = Decimal(radius) - Decimal(clearance)
    e = bearing - pin + Decimal(penetration)
    # The kernel gets e and R_j as rounded numbers; nothing cancels after that.
    area = contact_area(penetration, float(e), radius, float(pin), width)
    printed = _area_as_printed(e, bearing, pin, Decimal(width))
    assert area == pytest.approx(float(printed), rel=1e-14)


@pytest.mark.parametrize("worn", [False, True])
@pytest.mark.parametrize("frame", ["fixed", "body"])
@pytest.mark.parametrize("count", [16, 360, 997])
def test_one_bin_gets_all_of_equation_29(frame: MapFrame, worn, count):
    joint = worn_joint(frame)
    if not worn:
        joint = replace(joint, bearing_surface=Surface(), pin_surface=Surface())
    joint = replace(joint, wear=_law("bin", 0.3))
    direction = 2.5
    angles = (0.4, -2.1)
    load_distance = 7.0
    pair = placed(joint, 2e-6, direction, angles=angles, rates=SLIDING)
    places = direction - (frame == "body") * np.array(angles)
    bearing = Decimal(joint.bearing_radius) + Decimal(
        float(joint.bearing_surface(places)[0])
    )
    pin = Decimal(joint.pin_radius) - Decimal(float(joint.pin_surface(places)[1]))
    # The same penetration as the kernel saw: the position carries round-off of 1e-16 m.
    e = bearing - pin + Decimal(pair.contact().penetration)
    area = float(_area_as_printed(e, bearing, pin, Decimal(joint.width)))
    expected = np.zeros((2, count))
    bins = (places % TURN * count / TURN).astype(int)
    expected[(0, 1), bins] = COEFFICIENT * load_distance / area * np.array([0.3, 0.7])
    assert_allclose(_deposited(pair, count, load_distance), expected, rtol=1e-12)


WORN = replace(worn_joint("body", 360, 2e-6), contact="foundation")
FOUNDATION = replace(worn_joint("body"), contact="foundation")
STEEP = worn_joint("body", 360, 3e-3)


@given(
    st.sampled_from([JOINT, worn_joint("fixed"), STEEP, FOUNDATION, WORN]),
    st.integers(16, 5000),
    st.floats(-14.0, -4.0).map(lambda x: 10.0**x),
    st.floats(-math.pi, math.pi),
    st.floats(0.0, 1.0),
    st.floats(1e-12, 1e6),
)
@example(JOINT, 16, 1e-14, 0.0, 0.5, 1.0)
@example(JOINT, 5000, 1e-4, math.pi, 1.0, 1.0)
@example(worn_joint("fixed"), 360, 1e-16, 0.1, 0.5, 1.0)
def test_volume_identity(
    joint: ClearanceJoint,
    count,
    penetration,
    direction,
    share,
    load_distance,
):
    wearing = replace(joint, wear=_law("arc", share))
    depth = _deposited(placed(wearing, penetration, direction), count, load_distance)
    assert depth.min() >= 0.0
    # Sum over bins of depth times bin area is K_d times force times slip, at any bin
    # count.
    volume = COEFFICIENT * load_distance
    assert worn_volume(wearing, depth) == pytest.approx(volume, rel=1e-12)
    for side, part in zip(depth, (share, 1.0 - share), strict=True):
        assert worn_volume(wearing, side[np.newaxis]) == pytest.approx(
            part * volume, rel=1e-12
        )


@pytest.mark.parametrize("contact", ["radial", "foundation"])
@pytest.mark.parametrize("frame", ["fixed", "body"])
@pytest.mark.parametrize("deepest", [0.0, 2e-6, 5e-5], ids=["round", "worn", "rough"])
@pytest.mark.parametrize("count", [360, 97])
def test_bins_hold_the_integral_of_the_overlap(
    contact: SurfaceContact, frame: MapFrame, deepest, count
):
    """All of its patches, each where its map lives, at any number of bins."""
    joint = replace(
        worn_joint(frame, 360, deepest), contact=contact, wear=_law("arc", 0.4)
    )
    for direction, angles in ((1.1, (0.4, -2.1)), (-3.1, (5.0, 9.0))):
        pair = placed(joint, 3e-6, direction, angles=angles)
        depth = _deposited(pair, count, 1.0)
        parts = depth / depth.sum(axis=1, keepdims=True)
        exact = np.sum(fine_overlaps(pair, count), axis=2)
        exact /= exact.sum(axis=1, keepdims=True)
        # The grid has kinks of the pressure inside a step of a four hundredth bin.
        assert_allclose(parts, exact, rtol=0.0, atol=2e-5 * parts.max())


@pytest.mark.parametrize("joint", [JOINT, WORN], ids=["round", "worn"])
@pytest.mark.parametrize("direction", [0.0, 2.0, -3.1])
def test_bins_beyond_the_arc_are_not_visited(joint: ClearanceJoint, direction):
    """A step costs as much as the few bins in contact, however many a map has."""
    pair = placed(replace(joint, wear=_law("arc")), 3e-6, direction, angles=(0.4, -2.1))
    contact = pair.contact()
    packed = pair.packed.joints[0]
    depth, shares = np.zeros((2, 2, 720))
    bins = np.arange(720)
    for side, body in enumerate((0, 3)):
        nearest = bin_of(direction_of(contact) - pair.q[body + 2], 720)
        away = abs((bins - nearest + 360) % 720 - 360)
        shares[side, away > 40] = math.nan  # 20 degrees; the arc has 5 on each side
    visited = ~np.isnan(shares)
    deposit_over_arc(depth, packed, pair.packed.surfaces[0], contact, 1.0, shares)
    assert worn_volume(pair.joint, depth) == pytest.approx(COEFFICIENT, rel=1e-12)
    assert_array_equal(np.isnan(shares), ~visited)
    assert not shares[visited].any()


@given(st.floats(-1e-6, 0.0), st.integers(16, 5000))
@pytest.mark.parametrize("joint", [JOINT, WORN], ids=["round", "worn"])
def test_wear_of_a_step_that_ends_open_is_not_lost(joint: ClearanceJoint, gap, count):
    pair = placed(replace(joint, wear=_law("arc")), gap, 1.0)
    depth = _deposited(pair, count, 2.0)
    assert worn_volume(joint, depth) == pytest.approx(COEFFICIENT * 2.0, rel=1e-12)
    contact = pair.contact()
    if contact.penetration <= 0.0:
        place = math.atan2(contact.normal_y, contact.normal_x) - contact.bearing_angle
        assert depth[0, bin_of(place, count)] == depth[0].sum()


@pytest.mark.parametrize("eccentricity", [8e16, 1e300, math.inf, math.nan])
def test_a_state_far_off_is_no_endless_arc(eccentricity):
    """Error control looks at such states before it shortens a step."""
    pair = placed(WORN, 0.0, 0.0)
    joint = pair.packed.joints[0]
    surfaces = pair.packed.surfaces[0]
    for angle in 0.0, 4.1e17, math.nan:
        for dx, dy in (eccentricity, 0.0), (0.6 * eccentricity, -0.8 * eccentricity):
            place = place_of(joint, dx, dy, eccentricity, angle)
            integrate_overlap(surfaces, joint, place, angle)


@pytest.mark.parametrize("count", [360, 97])
def test_play_is_what_a_dial_gauge_measures(count):
    """Across a lens of two circles, over a groove that the pin bridges, and all around."""
    c = JOINT.clearance
    angle = (np.arange(count) + 0.5) * TURN / count
    assert largest_play(JOINT, np.zeros((2, count))) == pytest.approx(2.0 * c, rel=1e-3)
    e = 1.7 * c
    lens = np.maximum(e * np.cos(angle - angle[count // 3]) - c, 0.0)
    worn = np.stack([lens, np.zeros(count)])
    assert largest_play(JOINT, worn) == pytest.approx(c + e, rel=1e-3)
    # The same lens on the pin faces that of the bearing, whose edges it meets.
    both = np.stack([lens, np.roll(lens, 11)])
    assert largest_play(JOINT, both) == pytest.approx(c + e, rel=3e-2)
    smaller = np.stack([lens, np.full(count, 0.2 * c)])
    assert largest_play(JOINT, smaller) == pytest.approx(1.4 * c + e, rel=2e-2)
    groove = np.zeros((2, count))
    groove[0, 40] = 0.5 * c
    assert largest_play(JOINT, groove) == pytest.approx(2.0 * c, rel=5e-3)
    even = np.full((2, count), 0.2 * c)
    assert largest_play(JOINT, even) == pytest.approx(2.8 * c, rel=1e-3)
