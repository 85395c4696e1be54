"""The press that cuts beside the middle: corners that chatter on their walls."""

import numpy as np
import pytest
from marks import slow
from runs import residual

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.scene.settings import changed

SCENE = pw.scenes.press_off_centre(cycles=1)
FINE = InHouse(integrator="dop853", integration_tolerance=1e-12)
ENGINES: list[Engine] = [
    InHouse(),
    ExudynTree(tree_tolerance=1e-7),
    ExudynJoints(steps_per_contact=100, free_steps=5000),
]
SHEET = SCENE.process
assert SHEET is not None
BEFORE_THE_WORK = 0.4  # of a turn; the punch touches the sheet later
DEEPEST = 1e-8  # m: the rod presses a corner in by 50 N at 9 GN/m


def run_of(scene: pw.Scene, engine: Engine, turns: float) -> Run:
    """Run a part of the first turn, with its series."""
    engine = engine.for_cycle(scene.mechanism.period)
    plan = Plan(turns * scene.mechanism.period, 1, recorded_cycles=1)
    run = engine.simulate(scene.linkage(), start_of(scene), plan)
    assert run.status == "completed", run.message
    return run


def assert_no_corner_is_lost(run: Run) -> None:
    """Assert that a corner that has passed its wall presses on it, in each recorded row."""
    for k in range(4):
        depth, normal = (
            run.recorder.series(one, k) for one in ("penetration", "normal")
        )
        assert normal[depth > 1e-12].min(initial=1.0) > 0.0


def test_the_slide_has_the_inertia_of_a_block():
    slider = SCENE.linkage().bodies[-1]
    assert slider.inertia == pytest.approx(300.0 * (0.4**2 + 0.3**2) / 12.0)
    press = pw.Press(guide_length=0.1, guide_width=0.05)
    scene = pw.Scene(press, joints="guide")
    (slider,) = (b for b in scene.linkage().bodies if b.name == "slider 6")
    assert slider.inertia == pytest.approx(0.0288 * (0.1**2 + 0.05**2) / 12.0)


@pytest.mark.parametrize("engine", [*ENGINES[:2], slow(ENGINES[2])])
def test_corners_chatter_before_the_work_and_none_is_lost(engine: Engine):
    run = run_of(SCENE, engine, BEFORE_THE_WORK)
    touches = [run.recorder.stored_contacts(k)[:, 0] for k in range(4)]
    assert sum(map(len, touches)) > 40
    # Both corners of the right face touch first, at the same instant.
    assert touches[2][0] == pytest.approx(touches[3][0], abs=1e-8)
    assert_no_corner_is_lost(run)
    assert residual(run) < 1e-6


def test_the_ledger_closes_over_the_work():
    assert SHEET is not None
    run = run_of(SCENE, InHouse(), 1.0)
    assert float(run.diagnostics["load_work_J"]) == pytest.approx(-SHEET.work, rel=1e-6)
    assert_no_corner_is_lost(run)
    assert residual(run) < 1e-6


@pytest.mark.slow
def test_a_vertical_and_a_horizontal_guide_are_equal():
    """Without gravity, over eight touches; the direction to the slide is right, not down."""
    turned = {"gravity": "0 m/s^2", "process": "none"}
    upright = run_of(changed(SCENE, turned), InHouse(), 0.2)
    flat = run_of(changed(SCENE, {**turned, "slide_angle": "0 deg"}), InHouse(), 0.2)
    places = [run.end.position.reshape(-1, 3) for run in (upright, flat)]
    assert places[1][:, 0] == pytest.approx(-places[0][:, 1], abs=1e-12)
    assert places[1][:, 1] == pytest.approx(places[0][:, 0], abs=1e-12)
    assert places[1][2, 2] == pytest.approx(places[0][2, 2], abs=1e-11)
    # The guide leads upwards and to the right: its left wall is on the other side.
    touches = [
        [run.recorder.stored_contacts(k)[:, 0] for k in corners]
        for run, corners in ((upright, (2, 3, 0, 1)), (flat, (1, 0, 3, 2)))
    ]
    assert sum(map(len, touches[0])) == 8
    for one, other in zip(*touches, strict=True):
        assert one == pytest.approx(other, abs=1e-9)


@pytest.mark.parametrize("clearance", [1e-5, 1e-7])
def test_a_guide_with_a_vanishing_clearance_is_ideal(clearance):
    """The slide leaves its ideal place by less than the clearance and its contacts."""
    small = {"clearance": f"{clearance} m", "restitution": "0.1", "process": "none"}
    scene = changed(SCENE, small)
    run = run_of(scene, InHouse(), BEFORE_THE_WORK)
    ideal = scene.ideal.at(np.array([BEFORE_THE_WORK])).position[0]
    off = (run.end.position - ideal).reshape(-1, 3)
    assert sum(len(run.recorder.stored_contacts(k)) for k in range(4)) > 40
    assert np.abs(off[:, :2]).max() < clearance + DEEPEST
    assert abs(off[2, 2]) < 2.0 * (clearance + DEEPEST) / 0.4
