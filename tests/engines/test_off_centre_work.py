"""The press that cuts beside the middle: corners that chatter on their walls."""

import pytest
from marks import slow
from runs import residual

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.validation.cases import finished

SCENE = pw.scenes.press_off_centre(cycles=1)
ENGINES: list[Engine] = [
    InHouse(),
    ExudynTree(tree_tolerance=1e-7),
    ExudynJoints(steps_per_contact=100, free_steps=5000),
]
SHEET = SCENE.process
assert SHEET is not None
BEFORE_THE_WORK = 0.4  # of a turn; the punch touches the sheet later


def run_of(scene: pw.Scene, engine: Engine, turns: float) -> Run:
    """Run a part of the first turn, with its series."""
    engine = engine.for_cycle(scene.mechanism.period)
    plan = Plan(turns * scene.mechanism.period, 1, recorded_cycles=1)
    return finished(engine.simulate(scene.linkage(), start_of(scene), plan))


def assert_no_corner_is_lost(run: Run) -> None:
    """Assert that a corner that has passed its wall presses on it, in each recorded row."""
    for k in range(4):
        depth, normal = (
            run.recorder.series(one, k) for one in ("penetration", "normal")
        )
        assert normal[depth > 1e-12].min(initial=1.0) > 0.0


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
