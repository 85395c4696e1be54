"""Guides with clearance: a slide that tilts between two walls, in every engine.

Reference values of the slider-crank are those of an independent simulator with located
events.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from runs import residual

import presswear as pw
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.ideal import ideal_motion

FINE = InHouse(integrator="dop853", integration_tolerance=1e-12)
ENGINES: list[tuple[Engine, float]] = [
    (FINE, 1e-9),
    (ExudynTree(tree_tolerance=1e-10), 1e-7),
    (ExudynJoints(steps_per_contact=400, free_steps=20_000), 1e-5),
]
# when both corners of a face touch, s, how fast, m/s, and where the slide is at 6 ms
TOUCH = 2.515372103938e-3
SPEED = 1.154321026
ACROSS = 5.199181686e-4
TILT = -6.072076429e-4
L, W, C = 0.4, 0.3, 0.05e-3  # of the slide of a press, m


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
    run = engine.for_cycle(ideal.period).simulate(linkage, start, Plan(duration, 1))
    assert run.status == "completed", run.message
    return run


@pytest.mark.parametrize(("engine", "within"), ENGINES)
def test_two_corners_of_a_face_touch_at_the_same_instant(
    engine: Engine, within: float
) -> None:
    run = run_from_start(engine, slider_crank().linkage(), 6e-3)
    front, back = (run.recorder.stored_contacts(k) for k in range(2))
    for corner in (front, back):
        assert corner[0, 0] == pytest.approx(TOUCH, abs=within * 1e-2)
        assert corner[0, 2] == pytest.approx(SPEED, rel=max(within, 1e-9))
    across, tilt = run.end.position[7:9]
    assert across == pytest.approx(ACROSS, abs=within)
    assert tilt == pytest.approx(TILT, abs=within)
    assert len(front) == len(back) == 2


def block(mass: float = 300.0, **bearing: Any) -> tuple[Linkage, Start]:
    """Return a slide in an upright guide of a press, and a start in the middle at rest."""
    guide = pw.Guide("guide", "slide", direction=0.5 * math.pi, length=L, width=W)
    slide = pw.Body("slide", mass)
    linkage = pw.assemble([slide], [guide], output="slide", gravity=0.0, cycle=0.1)
    scene = pw.Scene(linkage, bearings={"guide": pw.Bearing(clearance=C, **bearing)})
    return scene.linkage(), Start(np.zeros(3), np.zeros(3))


def penetrations(linkage: Linkage, position: np.ndarray) -> np.ndarray:
    """Penetration of each corner of a slide that is placed in its guide, m, by geometry."""
    x, _, angle = position
    depths = []
    for corner in linkage.corners:
        c = math.cos(angle)
        s = math.sin(angle)
        place = x + c * corner.pin.x - s * corner.pin.y
        # Left of an upright guide lies at negative x.
        depths.append(-corner.side * place - (0.5 * W + C))
    return np.array(depths)


def test_the_greatest_tilt_in_two_opposite_corners() -> None:
    linkage, _ = block()
    tilt = 2.500234445e-4
    assert 0.5 * W * (1.0 - math.cos(tilt)) == pytest.approx(
        0.5 * L * math.sin(tilt) - C, abs=1e-13
    )
    depths = penetrations(linkage, np.array([0.0, 0.0, tilt]))
    assert sorted(np.abs(depths) < 1e-13) == [False, False, True, True]


def test_a_slide_has_the_inertia_of_a_block() -> None:
    linkage, _ = block()
    assert linkage.bodies[0].inertia == pytest.approx(300.0 * (L**2 + W**2) / 12.0)
    assert linkage.ideal.bodies[0] == linkage.bodies[0]
    assert [joint.name for joint in linkage.ideal.joints] == ["guide"]


def test_energy_is_conserved_without_friction_and_damping() -> None:
    """A slide that rattles between the walls, with restitution 1, over 200 passages."""
    linkage, rest = block(restitution=1.0, friction=0.0, contact_stiffness=1e9)
    start = replace(rest, velocity=np.array([0.1, 0.0, 0.3]))
    run = FINE.for_cycle(0.1).simulate(linkage, start, Plan(1.2, 1))
    mass = np.array([300.0, 300.0, linkage.bodies[0].inertia])
    contacts = sum(len(run.recorder.stored_contacts(k)) for k in range(4))
    assert contacts > 200
    before, after = (
        0.5 * float(mass @ one**2) for one in (start.velocity, run.end.velocity)
    )
    stored = run.recorder.records.memory["energy"].sum()
    assert after + stored == pytest.approx(before, rel=1e-8)


def test_a_corner_is_located_by_few_trials() -> None:
    """Two further trials of a step find its event: Newton's method stops at round-off."""
    guide = pw.Guide("guide", "slide", 0.3, 0.0, 0.5 * math.pi, length=L, width=W)
    slide = pw.Body("slide", 300.0)
    linkage = pw.assemble([slide], [guide], output="slide", gravity=0.0, cycle=0.1)
    bearing = pw.Bearing(
        clearance=C, restitution=1.0, friction=0.0, contact_stiffness=1e9
    )
    linkage = pw.Scene(linkage, bearings={"guide": bearing}).linkage()
    start = Start(np.array([0.3, 0.0, 0.0]), np.array([0.005, 0.0, 0.015]))
    engine = InHouse("dopri5", integration_tolerance=1e-7).for_cycle(0.1)
    counts: dict[str, Any] = engine.simulate(linkage, start, Plan(8.0, 1)).diagnostics
    # A trial has six evaluations, and there is one behind each event.
    trials = (counts["evaluations"] - counts["events"]) / 6
    further = trials - counts["steps"] - counts["steps_sent_back"]
    assert counts["events"] > 200
    assert further < 2.0 * counts["events"]


@pytest.mark.slow
def test_energy_is_conserved_over_200_turns_of_a_crank() -> None:
    scene = slider_crank()
    bearing = replace(scene.bearings, restitution=1.0, friction=0.0)
    linkage = replace(scene, bearings=bearing).linkage()
    run = run_from_start(FINE, linkage, 200.0 * linkage.ideal.period)
    assert residual(run) < 1e-9


def punch(time: float) -> float:
    """Force of a press on its slide, N."""
    return -1e5


def test_corner_forces_beside_the_middle() -> None:
    """A force of 100 kN, 60 mm beside the middle, is held by a spring under the slide."""
    guide = pw.Guide("guide", "slide", direction=0.5 * math.pi, length=L, width=W)
    slide = pw.Body("slide", 300.0, points={"beside": (0.06, 0.0)})
    linkage = pw.assemble(
        [slide],
        [guide],
        output="slide",
        gravity=0.0,
        cycle=0.1,
        springs=[pw.Spring("rod", (0.0, -1.0), "slide", 1e9, damping=1e6, length=1.0)],
        loads=[pw.Force("slide.beside", 0.5 * math.pi, punch)],
    )
    bearing = pw.Bearing(
        clearance=C,
        contact_stiffness=5e11,
        normal_law="kelvin-voigt",
        viscous_damping=1e7,
        friction=0.0,
    )
    linkage = pw.Scene(linkage, bearings={"guide": bearing}).linkage()
    start = Start(np.zeros(3), np.zeros(3))
    engine = InHouse(integration_tolerance=1e-9)
    run = engine.for_cycle(0.1).simulate(linkage, start, Plan(0.3, 1))
    assert run.status == "completed", run.message
    tilt = abs(run.end.position[2])
    assert tilt == pytest.approx(2.983078e-4, rel=5e-5)  # with N = 15 kN
    lever = L * math.cos(tilt) - W * math.sin(tilt)
    forces = sorted(run.recorder.records.contacts["normal"])
    assert forces[:2] == [0.0, 0.0]
    assert forces[2:] == pytest.approx([6e3 * math.cos(tilt) / lever] * 2, rel=1e-6)
    depth = (forces[3] / 5e11) ** (2.0 / 3.0)
    reach = 0.5 * L * math.sin(tilt) - 0.5 * W * (1.0 - math.cos(tilt))
    assert reach == pytest.approx(C + depth, abs=1e-12)


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
def test_a_guide_that_cannot_have_clearance(
    mechanism: pw.SliderCrank, bearing: dict[str, Any], fault: str
) -> None:
    with pytest.raises(pw.InputError, match=fault):
        pw.Scene(mechanism, bearings={"guide": pw.Bearing(**bearing)})


def test_a_guide_of_a_driven_body() -> None:
    guide = pw.Guide("G", "b", length=0.1, width=0.1)
    linkage = pw.assemble([pw.Body("b", 1.0, 1.0)], [guide], [pw.Drive("b", 1.0)])
    with pytest.raises(pw.InputError, match="bearings of G: b has a drive"):
        pw.Scene(linkage, bearings={"G": pw.Bearing(clearance=1e-4)})
