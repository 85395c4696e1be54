"""One clearance joint: momentum, kinematics and degenerate positions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from two_bodies import JOINT, Pair, gap_of, placed, waves, worn_joint

from presswear.linkage.elements import GROUND, Attachment, ClearanceJoint
from presswear.linkage.laws import FrictionLaw
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.contact import direction_of, joint_end
from presswear.physics.laws import FRICTION, ONSET_SPEED_FLOOR, friction_force, normal_force
from presswear.physics.surface import CUBE, LEAST, PIN, ROWS, SLOPE, SQUARE

Array = NDArray[np.float64]

EPS = float(np.finfo(float).eps)
NO_CENTRE = Attachment("pin", 0.0, 0.0)

joints = st.sampled_from([JOINT, worn_joint("fixed"), worn_joint("body")])
directions = st.floats(-math.pi, math.pi)
penetrations = st.floats(1e-9, 1e-4)


def _rates(speed: float, spin: float) -> st.SearchStrategy[Array]:
    translation = st.floats(-speed, speed)
    rotation = st.floats(-spin, spin)
    return st.tuples(translation, translation, rotation, translation, translation, rotation).map(
        np.array
    )


angle_pairs = st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))


def _contact_point(pair: Pair) -> Array:
    """The common point, from the bearing's side and without the kernel."""
    joint = pair.joint
    bearing = joint_end(0, joint.bearing.x, joint.bearing.y, pair.q, pair.v)
    pin = joint_end(3, joint.pin.x, joint.pin.y, pair.q, pair.v)
    e = np.array([pin.x - bearing.x, pin.y - bearing.y])
    n = e / np.hypot(*e)
    turns = float(joint.map_frame == "body")
    own = np.array([math.atan2(e[1], e[0]) - turns * pair.q[2]])
    gap = gap_of(joint, math.atan2(e[1], e[0]), pair.q[2], pair.q[5])
    indentation = 0.5 * max(float(np.hypot(*e)) - gap, 0.0)
    reach = joint.bearing_radius + float(joint.bearing_surface(own)[0]) + indentation
    return np.asarray(np.array([bearing.x, bearing.y]) + reach * n)


@given(joints, penetrations, directions, angle_pairs, _rates(3.0, 300.0), st.floats(1e-3, 3.0))
def test_momentum_is_exact(
    joint: ClearanceJoint,
    penetration: float,
    direction: float,
    angles: tuple[float, float],
    rates: Array,
    onset: float,
) -> None:
    pair = placed(joint, penetration, direction, angles=angles, rates=rates)
    load = pair.load(onset)
    q = pair.q
    moment_of_pin_force = q[3] * load.y - q[4] * load.x
    moment_of_bearing_force = -(q[0] * load.y - q[1] * load.x)
    total = moment_of_pin_force + moment_of_bearing_force + load.pin_moment + load.bearing_moment
    force = math.hypot(load.x, load.y)
    # Points within 1 m of the origin, a handful of operations.
    assert abs(total) <= 16.0 * EPS * force
    assert force == pytest.approx(math.hypot(load.normal, load.tangential), rel=1e-14)


@given(joints, penetrations, directions, angle_pairs, _rates(3.0, 300.0))
def test_force_acts_at_one_point_and_has_the_laws_parts(
    joint: ClearanceJoint,
    penetration: float,
    direction: float,
    angles: tuple[float, float],
    rates: Array,
) -> None:
    pair = placed(joint, penetration, direction, angles=angles, rates=rates)
    contact = pair.contact()
    load = pair.load(0.5)
    assert load.normal == normal_force(
        contact.penetration, contact.rate, 0.5, 1.25e10, 1.5, joint.normal.damping
    )
    assert load.tangential == friction_force(
        contact.sliding, load.normal, np.array([(0.1, 1e-4, 1e-3)], FRICTION)[0]
    )
    n = np.array([contact.normal_x, contact.normal_y])
    t = np.array([-n[1], n[0]])
    force = np.array([load.x, load.y])
    scale = 8.0 * EPS * max(load.normal, 1e-300)
    # The bearing pushes the pin back, friction along t.
    assert force @ n == pytest.approx(-load.normal, abs=scale)
    assert force @ t == pytest.approx(load.tangential, abs=scale)
    arm = _contact_point(pair) - pair.q[3:5]
    assert load.pin_moment == pytest.approx(arm[0] * load.y - arm[1] * load.x, abs=20.0 * scale)
    arm = _contact_point(pair) - pair.q[0:2]
    assert load.bearing_moment == pytest.approx(arm[1] * load.x - arm[0] * load.y, abs=20.0 * scale)


@given(joints, st.floats(-4e-4, 1e-4), directions, angle_pairs)
def test_penetration_is_measured_from_the_worn_gap(
    joint: ClearanceJoint, penetration: float, direction: float, angles: tuple[float, float]
) -> None:
    pair = placed(joint, penetration, direction, angles=angles)
    contact = pair.contact()
    # Positions of order 1 m are rounded; a worn profile adds slope 1e-3 times that angle.
    assert contact.penetration == pytest.approx(penetration, abs=8.0 * EPS)
    assert contact.eccentricity == pytest.approx(
        penetration + gap_of(joint, direction, *angles), abs=8.0 * EPS
    )
    assert math.cos(direction_of(contact) - direction) == pytest.approx(1.0, abs=1e-12)


@given(joints, st.floats(0.0, 1e-4), directions, angle_pairs, _rates(3.0, 300.0))
def test_sliding_is_that_of_the_material_points(
    joint: ClearanceJoint,
    penetration: float,
    direction: float,
    angles: tuple[float, float],
    rates: Array,
) -> None:
    pair = placed(joint, penetration, direction, angles=angles, rates=rates)
    contact = pair.contact()
    point = _contact_point(pair)

    def velocity(body: int) -> Array:
        arm = point - pair.q[body : body + 2]
        return np.asarray(rates[body : body + 2] + rates[body + 2] * np.array([-arm[1], arm[0]]))

    t = np.array([-contact.normal_y, contact.normal_x])
    # Speeds up to 300 rad/s times 0.2 m.
    assert contact.sliding == pytest.approx((velocity(3) - velocity(0)) @ t, abs=1e-12)
    if joint is JOINT:
        n = np.array([contact.normal_x, contact.normal_y])
        assert contact.rate == pytest.approx((velocity(3) - velocity(0)) @ n, abs=1e-12)


@given(joints, st.floats(-1e-4, 1e-4), directions, angle_pairs, _rates(0.05, 0.3))
def test_rate_is_the_derivative_of_penetration(
    joint: ClearanceJoint,
    penetration: float,
    direction: float,
    angles: tuple[float, float],
    rates: Array,
) -> None:
    pair = placed(joint, penetration, direction, angles=angles, rates=rates)
    step = 1e-7
    ahead = pair.after(step).contact().penetration
    behind = pair.after(-step).contact().penetration
    # Positions rounded to 1e-16 m over 2e-7 s; curvature of the worn profile (at most
    # 12 depth / width^2 = 0.02 m) times (250 rad/s)^2 times the step where a knot is crossed.
    contact = pair.contact()
    turning = abs(contact.turning) + 0.3
    curvature = 0.0 if joint is JOINT else 0.02 * turning**2 * step
    tolerance = 1e-8 + curvature + 1e-3 * (turning * step) ** 2 * turning
    assert contact.rate == pytest.approx((ahead - behind) / (2.0 * step), abs=tolerance)


@pytest.mark.parametrize("frame", ["fixed", "body"])
def test_wear_maps_follow_their_frame(frame: str) -> None:
    joint = worn_joint("body" if frame == "body" else "fixed")
    here = placed(joint, 0.0, 0.7, angles=(0.0, 0.0))
    # Both bodies turned about the pin's and the bearing's centres: only the maps may notice.
    bearing_turned = placed(replace(joint, clearance=1e-3), 0.0, 0.7, angles=(0.9, 0.0))
    gap = bearing_turned.contact().eccentricity - 1e-3
    own = joint.bearing_surface(np.array([0.7 - (0.9 if frame == "body" else 0.0)]))[0]
    other = joint.pin_surface(np.array([0.7]))[0]
    assert gap == pytest.approx(own + other, abs=8.0 * EPS)
    assert here.contact().penetration == pytest.approx(0.0, abs=8.0 * EPS)


def test_spinning_under_a_fixed_contact_moves_only_turning_maps() -> None:
    for frame, moves in (("fixed", False), ("body", True)):
        joint = worn_joint("body" if frame == "body" else "fixed")
        rates = np.zeros(6)
        rates[5] = 40.0
        # The pin's body spins about the pin's own centre.
        pair = placed(replace(joint, pin=NO_CENTRE), 1e-6, 0.3, rates=rates)
        assert (pair.contact().rate != 0.0) == moves


def _knot_is_near(pair: Pair, span: float) -> bool:
    """Whether the contact crosses the centre of a bin within so many radians."""
    count = pair.packed.surfaces.shape[2]
    turns = float(pair.joint.map_frame == "body")
    positions = [
        (direction_of(pair.contact()) - turns * pair.q[body + 2]) * count / (2.0 * math.pi) - 0.5
        for body in (0, 3)
    ]
    width = 2.0 * math.pi / max(count, 1)
    return any(abs(x - round(x)) * width <= span for x in positions)


@given(
    joints,
    directions,
    st.floats(-5e-4, 1e-4),
    angle_pairs,
    _rates(0.1, 3.0),
    _rates(1e2, 1e3),
)
def test_penetration_acceleration_is_the_derivative_of_the_rate(
    joint: ClearanceJoint,
    direction: float,
    penetration: float,
    angles: tuple[float, float],
    rates: Array,
    acceleration: Array,
) -> None:
    pair = placed(joint, penetration, direction, angles=angles, rates=rates)
    formula = pair.penetration_acceleration(acceleration)
    eccentricity = pair.contact().eccentricity
    # Centres move at up to 1.5 m/s against each other: a small part of the time in which
    # the pin would cross the joint.
    speed = 1.5
    step = 2e-5 * eccentricity / speed
    assume(joint is JOINT or not _knot_is_near(pair, 4e-5))
    ahead = pair.after(step, acceleration).contact().rate
    behind = pair.after(-step, acceleration).contact().rate
    centripetal = speed**2 / eccentricity
    # Truncation is (2e-5)^2 of it but for a small factor; positions rounded to 2e-16 m turn
    # the normal by 2e-16 / e, and worn slopes (to 1e-3 m/rad) with it.
    noise = 8e-16 / eccentricity * speed / step * (1.0 + 1e-2 * speed / eccentricity)
    assert formula == pytest.approx(
        (ahead - behind) / (2.0 * step), abs=1e-8 * (centripetal + 2e3) + noise
    )


@pytest.mark.parametrize("joint", [JOINT, worn_joint("fixed"), worn_joint("body")])
def test_centred_pin_touches_nothing(joint: ClearanceJoint) -> None:
    centred = replace(
        joint, bearing=Attachment("bearing", 0.0, 0.0), pin=Attachment("pin", 0.0, 0.0)
    )
    q = np.array([0.3, 0.2, 0.7, 0.3, 0.2, -0.4])
    v = np.array([0.1, 0.2, 30.0, -0.3, 0.1, -20.0])
    pair = Pair(centred, q, v)
    contact = pair.contact()
    assert contact.eccentricity == 0.0
    assert contact.penetration <= -joint.clearance
    assert all(math.isfinite(value) for value in contact)
    assert pair.load(0.0) == (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    pull = pair.penetration_acceleration(np.ones(6))
    assert math.isfinite(pull)


def test_open_joint_has_no_force_even_with_a_latched_speed() -> None:
    pair = placed(JOINT, -1e-9, 1.0, rates=np.array([0.0, 0.0, 5.0, 1.0, -2.0, 9.0]))
    assert pair.load(0.7) == (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_first_step_of_a_touch_uses_its_own_rate() -> None:
    pair = placed(JOINT, 1e-6, 0.0, rates=np.array([0.0, 0.0, 0.0, 0.4, 0.0, 0.0]))
    assert pair.contact().rate == pytest.approx(0.4, rel=1e-12)
    elastic = 1.25e10 * 1e-6**1.5
    assert pair.load(0.0).normal == pytest.approx(elastic * 1.1425, rel=1e-8)
    assert pair.load(0.8).normal == pytest.approx(elastic * (1.0 + 0.1425 * 0.5), rel=1e-8)
    slow = pair.after(0.0)
    slow.v[3] = 1e-9
    floored = elastic * (1.0 + 0.1425 * 1e-9 / ONSET_SPEED_FLOOR)
    assert slow.load(0.0).normal == pytest.approx(floored, rel=1e-8)


def test_without_friction_the_force_is_central() -> None:
    smooth = replace(JOINT, friction=FrictionLaw())
    load = placed(smooth, 1e-5, 0.5, rates=np.array([0.1, 0.0, 50.0, 0.0, 0.3, -40.0])).load(90.0)
    assert load.normal > 0.0
    assert load.tangential == 0.0
    assert math.atan2(-load.y, -load.x) == pytest.approx(0.5, abs=1e-11)


def test_joint_end_on_the_frame() -> None:
    end = joint_end(-1, 0.3, -0.4, np.full(3, 7.0), np.full(3, 9.0))
    assert end == (0.3, -0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_joint_end_on_a_body() -> None:
    q = np.array([9.0, 9.0, 9.0, 1.0, 2.0, 0.5 * math.pi])
    v = np.array([9.0, 9.0, 9.0, 0.1, 0.2, 3.0])
    end = joint_end(3, 0.5, 0.25, q, v)
    expected = (0.75, 2.5, 0.1 - 3.0 * 0.5, 0.2 - 3.0 * 0.25, -0.25, 0.5, 0.5 * math.pi, 3.0)
    assert tuple(end) == pytest.approx(expected, rel=1e-14)


@given(st.floats(-1e-4, 1e-4), directions, _rates(1.0, 30.0))
def test_a_bearing_on_the_frame_is_a_bearing_on_a_body_at_rest(
    penetration: float, direction: float, rates: Array
) -> None:
    fixed = replace(JOINT, bearing=Attachment(GROUND, 0.3, -0.2))
    free = placed(replace(JOINT, bearing=Attachment("bearing", 0.0, 0.0)), penetration, direction)
    free.q[2] = 0.0
    free.v[3:] = rates[3:]
    alone = Pair(fixed, free.q[3:], free.v[3:])
    assert alone.contact() == free.contact()
    acceleration = np.concatenate([np.zeros(3), rates[:3] * 100.0])
    assert alone.penetration_acceleration(acceleration[3:]) == free.penetration_acceleration(
        acceleration
    )


def test_packed_joint_holds_every_value() -> None:
    joint = worn_joint("body")
    record = placed(joint, 0.0, 0.0).packed.joints[0]
    assert (record["bearing_body"], record["pin_body"]) == (0, 3)
    assert (record["bearing_x"], record["bearing_y"]) == (0.17, -0.03)
    assert (record["pin_x"], record["pin_y"]) == (-0.11, 0.05)
    assert record["pin_radius"] == record["bearing_radius"] - record["clearance"]
    assert record["map_turns"] == 1.0
    assert placed(JOINT, 0.0, 0.0).packed.joints[0]["map_turns"] == 1.0
    fixed = replace(JOINT, map_frame="fixed")
    assert placed(fixed, 0.0, 0.0).packed.joints[0]["map_turns"] == 0.0


def test_unworn_surfaces_pack_to_nothing() -> None:
    assert placed(JOINT, 0.0, 0.0).packed.surfaces.shape == (1, ROWS, 0)
    flat = replace(JOINT, bearing_surface=Surface(np.zeros(16)))
    assert placed(flat, 0.0, 0.0).packed.surfaces.shape == (1, ROWS, 0)


def test_one_worn_surface_packs_beside_an_unworn_one() -> None:
    surface = waves(20, 1e-5, 3)
    packed = placed(replace(JOINT, pin_surface=surface), 0.0, 0.0).packed.surfaces
    assert packed.shape == (1, ROWS, 20)
    assert not packed[0, :PIN].any()
    np.testing.assert_array_equal(packed[0, PIN], surface.depth)
    np.testing.assert_array_equal(packed[0, PIN + SLOPE], surface.slope)
    # The cubic behind each centre, read a third of a bin on.
    x = 2.0 * math.pi / 20 / 3.0
    rows = packed[0, PIN:]
    cubic = rows[0] + x * (rows[SLOPE] + x * (rows[SQUARE] + x * rows[CUBE]))
    assert cubic == pytest.approx(surface(bin_centres(20) + x), rel=1e-13)
    assert np.all(rows[LEAST] <= cubic)
