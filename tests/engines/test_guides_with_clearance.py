"""Guides with clearance: a slide that tilts between two walls, in every engine.

Reference values of the slider-crank are those of an independent simulator with located
events.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from marks import slow
from runs import touches

import presswear as pw
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.ideal import ideal_motion
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.validation.cases import finished

FINE = InHouse(integrator="dop853", integration_tolerance=1e-12)
# Engines, and the tolerances of positions at the end, m and rad
ENGINES: list[tuple[Engine, float]] = [
    (FINE, 1e-9),
    (ExudynTree(tree_tolerance=1e-10), 1e-7),
    (ExudynJoints(steps_per_contact=400, free_steps=20_000), 1e-5),
]
TOUCHDOWN = 2.515372103938e-3  # of both corners of a face, s
CLOSING_SPEED = 1.154321026  # at this touchdown, m/s
DURATION = 6e-3  # s
# Position of the slide across its guide, m, and tilt, rad, after this duration
ACROSS = 5.199181686e-4
TILT = -6.072076429e-4
# Slide of a press, m
LENGTH = 0.4
WIDTH = 0.3
CLEARANCE = 0.05e-3
MASS = 300.0  # kg


def slider_crank() -> pw.Scene:
    """Horizontal slider-crank at 150 rad/s, with 1 mm between slide and walls."""
    bodies = [
        pw.Bar("crank", 0.153, 0.038),
        pw.Bar("rod", 0.306, 0.038, 5.9e-4),
        pw.Body("slide", 0.076, 2.7e-6),
    ]
    joints = [
        pw.Pin("O", (0.0, 0.0), "crank.tail"),
        pw.Pin("A", "crank.head", "rod.tail"),
        pw.Pin("B", "rod.head", "slide"),
        pw.Guide("guide", "slide", length=0.1, width=0.05),
    ]
    linkage = pw.assemble(bodies, joints, [pw.Drive("crank", 150.0)], "slide")
    bearing = pw.Bearing(
        clearance=1e-3, contact_stiffness=1e10, restitution=0.9, friction=0.01
    )
    return pw.Scene(linkage, bearings={"guide": bearing}, cycles=1)


def run_from_start(engine: Engine, linkage: Linkage, duration: float) -> Run:
    """Run a linkage from its ideal motion at the start."""
    ideal = linkage.ideal
    motion = ideal_motion(ideal, ideal.period).at(np.zeros(1))
    start = Start(motion.position[0], motion.velocity[0])
    return finished(
        engine.for_cycle(ideal.period).simulate(linkage, start, Plan(duration, 1))
    )


@pytest.mark.parametrize(
    ("engine", "within"), [ENGINES[0], slow(*ENGINES[1]), ENGINES[2]]
)
def test_two_corners_of_a_face_touch_at_the_same_instant(engine: Engine, within):
    run = run_from_start(engine, slider_crank().linkage(), DURATION)
    for k in range(2):
        contacts = run.recorder.stored_contacts(k)
        assert len(contacts) == 2
        first = dict(zip(CONTACT_COLUMNS, contacts[0], strict=True))
        assert first["touchdown"] == pytest.approx(TOUCHDOWN, abs=within * 1e-2)
        assert first["closing_speed"] == pytest.approx(CLOSING_SPEED, rel=within)
    across, tilt = run.end.position[7:9]
    assert across == pytest.approx(ACROSS, abs=within)
    assert tilt == pytest.approx(TILT, abs=within)


def block(x: float = 0.0, **bearing: Any) -> tuple[Linkage, Start]:
    """Return a slide in an upright guide of a press, and a start in the middle at rest."""
    guide = pw.Guide(
        "guide", "slide", x, 0.0, 0.5 * math.pi, length=LENGTH, width=WIDTH
    )
    slide = pw.Body("slide", MASS)
    linkage = pw.assemble([slide], [guide], output="slide", gravity=0.0, cycle=0.1)
    bearings = {"guide": pw.Bearing(clearance=CLEARANCE, **bearing)}
    return pw.Scene(linkage, bearings=bearings).linkage(), Start(
        np.array([x, 0.0, 0.0]), np.zeros(3)
    )


def test_a_slide_has_the_inertia_of_a_block():
    linkage, _ = block()
    inertia = MASS * (LENGTH**2 + WIDTH**2) / 12.0
    assert linkage.bodies[0].inertia == pytest.approx(inertia)
    assert linkage.ideal.bodies[0] == linkage.bodies[0]
    assert [joint.name for joint in linkage.ideal.joints] == ["guide"]


def test_energy_is_conserved_without_friction_and_damping():
    """A slide that rattles between the walls, with restitution 1, over 200 passages."""
    linkage, rest = block(restitution=1.0, friction=0.0, contact_stiffness=1e9)
    start = replace(rest, velocity=np.array([0.1, 0.0, 0.3]))
    run = FINE.for_cycle(0.1).simulate(linkage, start, Plan(1.2, 1))
    mass = np.array([MASS, MASS, linkage.bodies[0].inertia])
    contacts = touches(run)
    assert contacts > 200
    before = 0.5 * float(mass @ start.velocity**2)
    after = 0.5 * float(mass @ run.end.velocity**2)
    stored = run.recorder.records.memory["energy"].sum()
    assert after + stored == pytest.approx(before, rel=1e-8)


def test_a_corner_is_located_by_few_trials():
    """Newton's method locates a touchdown with two more trials of its step."""
    x = 0.3  # of the guide, so that the position has a usual round-off
    linkage, rest = block(x, restitution=1.0, friction=0.0, contact_stiffness=1e9)
    start = replace(rest, velocity=np.array([0.005, 0.0, 0.015]))
    engine = InHouse("dopri5", integration_tolerance=1e-7).for_cycle(0.1)
    counts: dict[str, Any] = engine.simulate(linkage, start, Plan(8.0, 1)).diagnostics
    # A trial of dopri5 has six evaluations, and there is one after each event.
    trials = (counts["evaluations"] - counts["events"]) / 6
    more_trials = trials - counts["steps"] - counts["steps_sent_back"]
    assert counts["events"] > 200
    assert more_trials < 2.0 * counts["events"]


SLIDE = pw.SliderCrank(guide_length=0.06, guide_width=0.04)


@pytest.mark.parametrize(
    ("mechanism", "bearing", "fault"),
    [
        (pw.SliderCrank(), {}, "length of guide: a guide with clearance needs it"),
        (SLIDE, {"clearance": 0.0}, "guide.clearance = 0 m: a guide without clearance"),
        (
            SLIDE,
            {"clearance": 0.021, "bearing_radius": 0.1},
            "clearance of guide = 21 mm: allowed is up to half the width",
        ),
        (
            pw.SliderCrank(guide_length=0.03, guide_width=0.04),
            {"clearance": 0.006, "bearing_radius": 0.1},
            "clearance of guide = 6 mm: allowed is below 5 mm, with which a slide of 30 mm by 40",
        ),
        (SLIDE, {"elasticity": "liu"}, "guide.elasticity = liu: in a guide allowed is"),
    ],
)
def test_a_guide_that_cannot_have_clearance(mechanism: pw.SliderCrank, bearing, fault):
    with pytest.raises(pw.InputError, match=fault):
        pw.Scene(mechanism, bearings={"guide": pw.Bearing(**bearing)})


def test_a_guide_of_a_driven_body():
    guide = pw.Guide("G", "b", length=0.1, width=0.1)
    linkage = pw.assemble([pw.Body("b", 1.0, 1.0)], [guide], [pw.Drive("b", 1.0)])
    with pytest.raises(pw.InputError, match="bearings of G: b has a drive"):
        pw.Scene(linkage, bearings={"G": pw.Bearing(clearance=1e-4)})
