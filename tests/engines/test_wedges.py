"""Loops of guides alone, as of a wedge: closed forms and messages."""

import math
from dataclasses import replace

import numpy as np
import pytest
from slotted import SPEED, loose_scene

from presswear.linkage.bodies import Bar, Body
from presswear.linkage.drives import Drive, LinearDrive
from presswear.linkage.joints import Guide, Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.physics.ideal import ideal_motion
from presswear.physics.inverse_dynamics import needed_torques
from presswear.tools.errors import InputError

SLOPE = 0.3  # of the face of the wedge, rad
WEDGE, SLIDE = 4.0, 9.0  # masses, kg
STROKE = 0.05  # amplitude of the wedge, m

BODIES = [Body("wedge", WEDGE), Body("slide", SLIDE)]
GUIDES = [
    Guide("level", "wedge"),
    Guide("upright", "slide", direction=0.5 * math.pi),
    Guide("face", "slide", y=0.1, direction=SLOPE, on="wedge"),
]
ALONG = LinearDrive("wedge", along="level", frequency=SPEED, harmonics=[(0.0, STROKE)])


def wedge() -> Linkage:
    """Return a wedge that a cylinder moves, a slide on it, and a driven arm on the slide."""
    return assemble(
        bodies=[*BODIES, Bar("arm", 0.2, 1.0)],
        joints=[*GUIDES, Pin("E", "slide", "arm.tail")],
        drives=[ALONG, Drive("arm", 2.0 * SPEED)],
        output="slide",
        name="wedge",
    )


def turning_wedge() -> Linkage:
    """Return a wedge and a slide in guides on a crank that turns."""
    return assemble(
        bodies=[
            Bar("crank", 0.5, 3.0),
            *(Body(body.name, body.mass, 0.01) for body in BODIES),
        ],
        joints=[
            Pin("O", (0.0, 0.0), "crank.tail"),
            Guide("level", "wedge", y=0.02, direction=0.1, on="crank"),
            Guide("upright", "slide", direction=0.5 * math.pi, on="crank"),
            GUIDES[2],
        ],
        drives=[Drive("crank", SPEED), ALONG],
        output="slide",
        name="turning wedge",
    )


def test_wedge_lifts_its_slide():
    """The slide sinks by x tan a; the force is (m_w + m_s tan^2 a) x'' - m_s g tan a."""
    linkage = assemble(bodies=BODIES, joints=GUIDES, drives=[ALONG], output="slide")
    ideal = ideal_motion(linkage, linkage.period)
    time = np.linspace(0.0, linkage.period, 37)
    place = STROKE * np.sin(SPEED * time)
    tangent = math.tan(SLOPE)
    height = ideal.at(time).output(linkage)[:, 0]
    np.testing.assert_allclose(height, 0.1 - place * tangent, atol=1e-14)
    force = needed_torques(linkage, ideal, time)[:, 0]
    inertia = -(WEDGE + SLIDE * tangent**2) * SPEED**2 * place
    weight = SLIDE * linkage.gravity * tangent
    np.testing.assert_allclose(force, inertia - weight, atol=1e-8)


def test_angles_that_do_not_fit_are_refused():
    level = Guide("level", "wedge", angle=0.05)
    upright = Guide("upright", "slide", direction=0.5 * math.pi, angle=0.2)
    face = Guide("face", "slide", direction=SLOPE, angle=0.1, on="wedge")
    others = level, upright, *wedge().revolutes
    message = (
        r"guide face: angle = 5\.72958 deg: other guides hold slide at 8\.59437 deg on "
        r"wedge; allowed is 8\.59437 deg"
    )
    with pytest.raises(InputError, match=message):
        wedge().changed(joints=[*others, face])
    fitting = replace(face, angle=0.15)
    assert len(wedge().changed(joints=[*others, fitting]).guides) == 3


def test_clearance_in_a_loop_of_guides_is_refused():
    upright = Guide("upright", "slide", direction=0.5 * math.pi, length=0.2, width=0.1)
    linkage = wedge()
    joints = [GUIDES[0], upright, GUIDES[2], *linkage.revolutes]
    with pytest.raises(InputError, match="bearings of upright: guides alone close"):
        loose_scene(linkage.changed(joints=joints), joints="upright")
