"""The named scene press-hybrid: a motor with a flywheel, and a servo that follows it."""

import pytest
from marks import slow

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse

SCENE = pw.scenes.press_hybrid(wear_updates=0, cycles=3, replicates=1)
UNTIL = 0.04
"""s; both pins fall on their bearings and rebound, before chaos separates engines."""


def run_of(engine: Engine) -> Run:
    """Run the first part of a cycle."""
    engine = engine.for_cycle(SCENE.mechanism.period)
    return engine.simulate(SCENE.linkage(), start_of(SCENE), Plan(UNTIL, 1))


@pytest.mark.parametrize(
    ("engine", "error"),
    [
        (ExudynTree(tree_tolerance=1e-10), 1e-9),
        slow(ExudynJoints(), 1e-6),
    ],
)
def test_every_engine_moves_both_free_cranks_alike(engine: Engine, error):
    expected = run_of(InHouse(integration_tolerance=1e-12))
    assert expected.recorder.series("normal", 0).max() > 0.0
    assert run_of(engine).end.position == pytest.approx(
        expected.end.position, abs=error
    )
