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
    gap_of,
    placed,
    worn_joint,
)

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.points import Attachment
from presswear.physics.contact import direction_of
from presswear.tools.arrays import Array

EPS = float(np.finfo(float).eps)
NO_LOAD = (0.0,) * 6

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


@given(joints, st.floats(-4e-4, 1e-4), directions, angle_pairs)
def test_penetration_is_measured_from_the_worn_gap(
    joint: ClearanceJoint,
    penetration,
    direction,
    angles,
):
    contact = placed(joint, penetration, direction, angles=angles).contact()
    # Positions of order 1 m are rounded; a worn profile adds slope 1e-3 times that
    # angle.
    assert contact.penetration == pytest.approx(penetration, abs=8.0 * EPS)
    eccentricity = penetration + gap_of(joint, direction, *angles)
    assert contact.eccentricity == pytest.approx(eccentricity, abs=8.0 * EPS)
    assert math.cos(direction_of(contact) - direction) == pytest.approx(1.0, abs=1e-12)


@given(pairs(st.floats(-1e-4, 1e-4), 0.05, 0.3))
def test_rate_is_the_derivative_of_penetration(pair: Pair):
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
    """Return whether the contact is within ``span`` of the centre of a bin, rad."""
    width = 2.0 * math.pi / max(int(pair.packed.joints[0]["surface_bins"]), 1)
    angles = np.full(2, direction_of(pair.contact()))  # on the maps of bearing and pin
    if pair.joint.map_frame == "body":
        angles -= pair.q[2::3]
    positions = angles / width - 0.5
    return bool(np.any(np.abs(positions - np.round(positions)) * width <= span))


@given(pairs(st.floats(-5e-4, 1e-4), 0.1, 3.0), rates(1e2, 1e3))
def test_penetration_acceleration_is_a_derivative(pair: Pair, acceleration):
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
def test_centred_pin_touches_nothing(joint: ClearanceJoint):
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
    # An open joint with the closing speed of its last touchdown has no force either.
    assert placed(JOINT, -1e-9, 1.0, rates=v).load(0.7) == NO_LOAD
