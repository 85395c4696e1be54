"""What holds for a run of the press with clearance in every engine."""

import numpy as np
import pytest
from listeners import Interrupts

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Start
from presswear.engines.settings import Engine
from presswear.scene.catalog import wear_times

SCENE = wear_times()
NUMERICS = SCENE.numerics
EXUDYN = [engine.over(SCENE.mechanism.period) for engine in (NUMERICS.tree, NUMERICS.joints)]


@pytest.mark.parametrize("engine", EXUDYN, ids=lambda engine: engine.word)
def test_a_state_that_is_not_finite_ends_the_run_as_failed(engine: Engine) -> None:
    """The in-house solver refuses such a start: its joints do not hold."""
    start = start_of(SCENE)
    fast = Start(start.position, np.where(np.arange(18) == 13, 1e200, start.velocity))
    run = engine.simulate(SCENE.linkage(), fast, Plan(0.05, 1))
    assert run.status == "failed"
    assert "t = " in run.message


@pytest.mark.parametrize("engine", [*EXUDYN, NUMERICS.dae], ids=lambda engine: engine.word)
def test_interrupts_in_callbacks_arrive_as_they_are(engine: Engine) -> None:
    plan = Plan(0.05, 1, trackers=(Interrupts(),))
    with pytest.raises(KeyboardInterrupt):
        engine.simulate(SCENE.linkage(), start_of(SCENE), plan)
