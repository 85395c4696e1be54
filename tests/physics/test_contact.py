"""One clearance joint: kinematics, forces, momentum and degenerate positions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from two_bodies import (
    JOINT,
    Pair,
    force_of,
    gap_of,
    normal_law,
    placed,
    turned,
    worn_joint,
)

from presswear.linkage.elements import GROUND, Attachment, ClearanceJoint
from presswear.linkage.laws import FrictionLaw
from presswear.physics.contact import direction_of
from presswear.physics.friction_and_normal import (
    ONSET_SPEED_FLOOR,
    friction_force,
    friction_record,
)
from presswear.tools.arrays import Array

EPS = float(np.finfo(float).eps)
NO_LOAD = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

joints = st.sampled_from([JOINT, worn_joint("fixed"), worn_joint("body")])
directions = st.floats(-math.pi, math.pi)
angle_pairs = st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))


def rates(speed: float, spin: float) -> st.SearchStrategy[Array]:
    """Rates of both bodies up to a speed, m/s, and a spin, rad/s."""
    translation = st.floats(-speed, speed)
    rotation = st.floats(-spin, spin)
    body = translation, translation, rotation
    return st.tuples(*body, *body).map(np.array)


def pairs(
    penetrations: st.SearchStrategy[float], speed: float = 3.0, spin: float = 300.0
) -> st.SearchStrategy[Pair]:
    """Bodies anywhere, moving, with the pin at one of the penetrations, m."""
    return st.builds(
        lambda joint, penetration, direction, angles, v: placed(
            joint, penetration, direction, angles=angles, rates=v
        ),
        joints,
        penetrations,
        directions,
        angle_pairs,
        rates(speed, spin),
    )


def _arms(pair: Pair) -> Array:
    """The common point from both mass centres, (2, 2), from the bearing's side, without kernels."""
    joint = pair.joint
    q = pair.q
    bearing = q[:2] + turned(q[2], joint.bearing.x, joint.bearing.y)
    e = q[3:5] + turned(q[5], joint.pin.x, joint.pin.y) - bearing
    direction = math.atan2(e[1], e[0])
    length = float(np.hypot(*e))
    angle = np.array([direction - (joint.map_frame == "body") * q[2]])
    indentation = 0.5 * max(length - gap_of(joint, direction, q[2], q[5]), 0.0)
    reach = joint.bearing_radius + float(joint.bearing_surface(angle)[0]) + indentation
    return np.asarray(bearing + reach * e / length - q.reshape(2, 3)[:, :2])


@given(pairs(st.floats(1e-9, 1e-4)))
def test_force_acts_at_one_point_and_has_the_laws_parts(pair: Pair) -> None:
    """Linear and angular momentum stay to round-off."""
    contact = pair.contact()
    load = pair.load(0.5)
    law = normal_law(1.25e10, 1.5, pair.joint.normal.damping)
    assert load.normal == force_of(law, contact.penetration, contact.rate, 0.5)
    friction = friction_force(
        contact.sliding, load.normal, friction_record(FrictionLaw(0.1))
    )
    assert load.tangential == friction
    n = np.array([contact.normal_x, contact.normal_y])
    t = np.array([-n[1], n[0]])
    force = np.array([load.x, load.y])
    scale = 8.0 * EPS * max(load.normal, 1e-300)
    assert abs(pair.moment_of(load)) <= 16.0 * EPS * math.hypot(load.x, load.y)
    # The bearing pushes the pin back, friction along t.
    assert force @ n == pytest.approx(-load.normal, abs=scale)
    assert force @ t == pytest.approx(load.tangential, abs=scale)
    on_bearing, on_pin = _arms(pair)
    moment = on_pin[0] * load.y - on_pin[1] * load.x
    assert load.pin_moment == pytest.approx(moment, abs=20.0 * scale)
    moment = on_bearing[1] * load.x - on_bearing[0] * load.y
    assert load.bearing_moment == pytest.approx(moment, abs=20.0 * scale)


@given(joints, st.floats(-4e-4, 1e-4), directions, angle_pairs)
def test_penetration_is_measured_from_the_worn_gap(
    joint: ClearanceJoint,
    penetration: float,
    direction: float,
    angles: tuple[float, float],
) -> None:
    contact = placed(joint, penetration, direction, angles=angles).contact()
    # Positions of order 1 m are rounded; a worn profile adds slope 1e-3 times that
    # angle.
    assert contact.penetration == pytest.approx(penetration, abs=8.0 * EPS)
    eccentricity = penetration + gap_of(joint, direction, *angles)
    assert contact.eccentricity == pytest.approx(eccentricity, abs=8.0 * EPS)
    assert math.cos(direction_of(contact) - direction) == pytest.approx(1.0, abs=1e-12)


@given(pairs(st.floats(0.0, 1e-4)))
def test_sliding_is_that_of_the_material_points(pair: Pair) -> None:
    contact = pair.contact()
    velocity = [
        pair.v[body : body + 2] + pair.v[body + 2] * np.array([-arm[1], arm[0]])
        for body, arm in zip((0, 3), _arms(pair), strict=True)
    ]
    x, y = velocity[1] - velocity[0]
    nx = contact.normal_x
    ny = contact.normal_y
    # Speeds up to 300 rad/s times 0.2 m.
    assert contact.sliding == pytest.approx(y * nx - x * ny, abs=1e-12)
    if pair.joint is JOINT:
        assert contact.rate == pytest.approx(x * nx + y * ny, abs=1e-12)


@given(pairs(st.floats(-1e-4, 1e-4), 0.05, 0.3))
def test_rate_is_the_derivative_of_penetration(pair: Pair) -> None:
    step = 1e-7
    ahead = pair.after(step).contact().penetration
    behind = pair.after(-step).contact().penetration
    # Positions rounded to 1e-16 m over 2e-7 s; curvature of the worn profile (at most
    # 12 depth / width^2 = 0.02 m) times (250 rad/s)^2 times the step where a knot is
    # crossed.
    contact = pair.contact()
    turning = abs(contact.turning) + 0.3
    curvature = 0.0 if pair.joint is JOINT else 0.02 * turning**2 * step
    tolerance = 1e-8 + curvature + 1e-3 * (turning * step) ** 2 * turning
    assert contact.rate == pytest.approx((ahead - behind) / (2.0 * step), abs=tolerance)


def _knot_is_near(pair: Pair, span: float) -> bool:
    """Whether the contact crosses the centre of a bin within so many radians."""
    width = 2.0 * math.pi / max(int(pair.packed.joints[0]["surface_bins"]), 1)
    places = (
        direction_of(pair.contact()) - (pair.joint.map_frame == "body") * pair.q[2::3]
    )
    positions = places / width - 0.5
    return bool(np.any(np.abs(positions - np.round(positions)) * width <= span))


@given(pairs(st.floats(-5e-4, 1e-4), 0.1, 3.0), rates(1e2, 1e3))
def test_penetration_acceleration_is_a_derivative(
    pair: Pair, acceleration: Array
) -> None:
    eccentricity = pair.contact().eccentricity
    # Centres move at up to 1.5 m/s against each other: a small part of the time in
    # which the pin would cross the joint.
    speed = 1.5
    step = 2e-5 * eccentricity / speed
    assume(pair.joint is JOINT or not _knot_is_near(pair, 4e-5))
    ahead = pair.after(step, acceleration).contact().rate
    behind = pair.after(-step, acceleration).contact().rate
    centripetal = speed**2 / eccentricity
    # Truncation is (2e-5)^2 of it but for a small factor; positions rounded to 2e-16 m
    # turn the normal by 2e-16 / e, and worn slopes (to 1e-3 m/rad) with it.
    noise = 8e-16 / eccentricity * speed / step * (1.0 + 1e-2 * speed / eccentricity)
    expected = pytest.approx(
        (ahead - behind) / (2.0 * step), abs=1e-8 * (centripetal + 2e3) + noise
    )
    assert pair.penetration_acceleration(acceleration) == expected


@pytest.mark.parametrize("joint", [JOINT, worn_joint("fixed"), worn_joint("body")])
def test_centred_pin_touches_nothing(joint: ClearanceJoint) -> None:
    bearing, pin = (Attachment(body, 0.0, 0.0) for body in ("bearing", "pin"))
    q = np.array([0.3, 0.2, 0.7, 0.3, 0.2, -0.4])
    v = np.array([0.1, 0.2, 30.0, -0.3, 0.1, -20.0])
    pair = Pair(replace(joint, bearing=bearing, pin=pin), q, v)
    contact = pair.contact()
    assert contact.eccentricity == 0.0
    assert contact.penetration <= -joint.clearance
    assert all(math.isfinite(value) for value in contact)
    assert pair.load(0.0) == NO_LOAD
    assert math.isfinite(pair.penetration_acceleration(np.ones(6)))
    # Nor has an open joint that still has the speed of its last touchdown.
    assert placed(JOINT, -1e-9, 1.0, rates=v).load(0.7) == NO_LOAD


def test_first_step_of_a_contact_uses_its_own_rate() -> None:
    pair = placed(JOINT, 1e-6, 0.0, rates=np.array([0.0, 0.0, 0.0, 0.4, 0.0, 0.0]))
    assert pair.contact().rate == pytest.approx(0.4, rel=1e-12)
    elastic = 1.25e10 * 1e-6**1.5
    assert pair.load(0.0).normal == pytest.approx(elastic * 1.1425, rel=1e-8)
    assert pair.load(0.8).normal == pytest.approx(
        elastic * (1.0 + 0.1425 * 0.5), rel=1e-8
    )
    slow = pair.after(0.0)
    slow.v[3] = 1e-9
    floored = elastic * (1.0 + 0.1425 * 1e-9 / ONSET_SPEED_FLOOR)
    assert slow.load(0.0).normal == pytest.approx(floored, rel=1e-8)


@given(st.floats(-1e-4, 1e-4), directions, rates(1.0, 30.0))
def test_a_bearing_on_the_frame_is_at_rest(
    penetration: float, direction: float, v: Array
) -> None:
    fixed = replace(JOINT, bearing=Attachment(GROUND, 0.3, -0.2))
    free = placed(
        replace(JOINT, bearing=Attachment("bearing", 0.0, 0.0)), penetration, direction
    )
    free.q[2] = 0.0
    free.v[3:] = v[3:]
    alone = Pair(fixed, free.q[3:], free.v[3:])
    assert alone.contact() == free.contact()
    a = 100.0 * v[:3]
    whole = free.penetration_acceleration(np.concatenate([np.zeros(3), a]))
    assert alone.penetration_acceleration(a) == whole
