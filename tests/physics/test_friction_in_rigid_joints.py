"""Rigid joints with friction in the ideal motion: closed forms, power balance."""

import math
from dataclasses import replace

import numpy as np
import pytest

import presswear as pw
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.friction_settings import LuGreSettings
from presswear.linkage.linkage import Linkage
from presswear.linkage.normal_law import NormalLaw
from presswear.physics.curve_following import motion_of
from presswear.physics.inverse_dynamics import (
    constraint_forces,
    friction_corners,
    needed_torques,
)
from presswear.tools.errors import RunFailed

RADIUS = 0.01


def bushings(
    linkage: Linkage, names: str, law: FrictionLaw, radius: float = RADIUS
) -> list[ClearanceJoint]:
    size = radius, 1e-4, 0.02
    return [
        ClearanceJoint(pin.name, pin.first, pin.second, *size, NormalLaw(1e10), law)
        for pin in linkage.revolutes
        if pin.name in names
    ]


def bar(speed: float) -> Linkage:
    """A bar of 2 kg on a pin of the frame, its mass centre 0.2 m away."""
    return pw.assemble(
        [pw.Bar("crank", length=0.4, mass=2.0)],
        [pw.Pin("O", (0.0, 0.0), "crank.tail")],
        [pw.Drive("crank", speed=speed, angle=0.3)],
    )


def slider_crank(speed: float = 10.0) -> Linkage:
    return pw.SliderCrank(speed=speed).linkage()


@pytest.mark.parametrize(
    ("speed", "part"), [(5.0, 1.0), (-5.0, 1.0), (0.055, 0.5), (0.0085, 0.0)]
)
@pytest.mark.parametrize("is_swapped", [False, True])
def test_a_pin_under_a_known_force_takes_mu_f_r(speed, part, is_swapped):
    """Weight and centripetal force; against the motion, pin and bearing in either place.

    ``part`` is that of the ramp between sliding speeds of 0.1 and 1 mm/s.
    """
    linkage = bar(speed)
    law = FrictionLaw(0.1)
    (bushing,) = bushings(linkage, "O", law)
    if is_swapped:
        bushing = replace(bushing, bearing=bushing.pin, pin=bushing.bearing)
    time = np.linspace(0.0, linkage.period, 50)
    angle = 0.3 + speed * time
    turning = 2.0 * speed**2 * 0.2
    force = np.hypot(-turning * np.cos(angle), 2.0 * 9.81 - turning * np.sin(angle))
    weight = 2.0 * 9.81 * 0.2 * np.cos(angle)
    torque = needed_torques(linkage, motion_of(linkage), time, [bushing])[:, 0]
    expected = weight + math.copysign(part * 0.1 * RADIUS, speed) * force
    np.testing.assert_allclose(torque, expected, rtol=0.0, atol=1e-12)


def test_bristles_are_those_of_steady_sliding():
    linkage = bar(0.1)
    settings = LuGreSettings(static_friction=0.15, stribeck_speed=1e-3)
    law = FrictionLaw(0.1, name="lugre", settings=settings)
    found = constraint_forces(
        linkage, motion_of(linkage), np.zeros(1), bushings(linkage, "O", law)
    )
    held = constraint_forces(linkage, motion_of(linkage), np.zeros(1))
    coefficient = 0.1 + 0.05 * math.exp(-1.0)
    size = math.hypot(held[0, 0], held[0, 1])
    assert found[0, -1] - held[0, -1] == pytest.approx(
        coefficient * RADIUS * size, rel=1e-12
    )


def test_friction_that_blocks_the_motion_is_said():
    """A bearing as large as the crank, with a coefficient above one."""
    linkage = slider_crank()
    joints = bushings(linkage, "OAB", FrictionLaw(2.0), radius=0.3)
    time = np.linspace(0.0, linkage.period, 50)
    with pytest.raises(
        RunFailed, match="friction blocks the motion of rigid joints at t = "
    ):
        constraint_forces(linkage, motion_of(linkage), time, joints)


def test_friction_has_corners_where_joints_turn_back():
    """The rod turns back twice in a cycle: four corners of the ramp each time."""
    linkage = slider_crank()
    joints = bushings(linkage, "B", FrictionLaw(0.1))
    time = np.linspace(0.0, linkage.period, 1000)
    corners = friction_corners(linkage, motion_of(linkage), time, joints)
    assert corners.size == 8
