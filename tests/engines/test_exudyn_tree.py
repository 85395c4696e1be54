"""The open tree in Exudyn against the in-house solver, closed forms and conservation."""

from dataclasses import replace

import numpy as np
import pytest
from runs import run_scene

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, recorder_of
from presswear.engines.exudyn_tree import engine
from presswear.engines.settings import FINEST, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.linkage.wear_law import Slip
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError

END = 0.05
TIGHT = 1e-10


def accuracy(tolerance: float) -> ExudynTree:
    return ExudynTree(tolerance, 1e-3)


def both(
    scene: Scene, linkage: Linkage, tolerance: float, end: float = END
) -> tuple[Run, Run]:
    """The same linkage from the same start: tree, then in-house at a tight tolerance."""
    plan = Plan(end, 1)
    start = start_of(scene)
    return (
        accuracy(tolerance).simulate(linkage, start, plan),
        InHouse(integration_tolerance=1e-12, coordinates="all").simulate(
            linkage, start, plan
        ),
    )


@pytest.mark.parametrize(
    ("tolerance", "remedy"),
    [
        (1e-6, "set a smaller tree_tolerance, for example 1e-07"),
        (FINEST, "engine = dae may help"),
    ],
)
def test_advice_is_a_tolerance_that_is_allowed(tolerance, remedy):
    scene = wear_times()
    plan = Plan(END, 1)
    linkage = scene.linkage()
    start = start_of(scene)
    recorder = recorder_of(linkage, start, plan)
    running = engine.prepare(
        linkage, start, accuracy(tolerance).resolved(), plan, recorder
    )
    assert running.remedy == remedy


@pytest.mark.parametrize(("slip", "error"), [("sliding", 2e-6), ("angle", 1e-3)])
def test_wear_and_peaks_agree(slip: Slip, error):
    """By angle, slip has a kink wherever the pin turns back, which costs both engines digits."""
    scene = wear_times()
    scene = replace(scene, conventions=replace(scene.conventions, slip=slip))
    ours, reference = both(scene, scene.linkage(), TIGHT)
    # A peak is that of the accepted states.
    for name, allowed in {
        "load_distance": error,
        "force_max": 0.01,
        "contacts": 0.0,
    }.items():
        for k in range(2):
            mine, expected = (
                run.recorder.each_cycle(name, k)[0] for run in (ours, reference)
            )
            assert mine == pytest.approx(expected, rel=allowed, abs=0.0), name


def test_every_touch_is_landed_on_and_resolved():
    run = run_scene(wear_times(), accuracy(1e-7))
    counters = run.recorder.records.counters
    assert counters["contacts"].sum() > 15
    assert counters["fewest_steps"].min() >= 20
    for k, fewest in enumerate(counters["fewest_steps"]):
        assert run.recorder.stored_contacts(k)[:, 5].min() == fewest
    assert float(run.diagnostics["deepest_touch_m"]) < 1e-9


def test_a_linkage_with_a_loop_is_refused_by_name():
    scene = replace(wear_times(), joints="A")
    with pytest.raises(InputError, match=r"joint \w+ closes a loop"):
        accuracy(1e-8).simulate(scene.linkage(), start_of(scene), Plan(END, 1))


def test_a_step_that_is_sent_back_for_ever_ends_the_run(
    monkeypatch,
):
    """Exudyn itself repeats one at the shortest step without end."""
    # Seven calls make a step: one that is sent back once counts as one sent back for
    # ever.
    monkeypatch.setattr(engine, "MOST_CALLS", 10)
    scene = wear_times()
    run = accuracy(1e-8).simulate(scene.linkage(), start_of(scene), Plan(END, 1))
    assert run.status == "failed"
    assert run.message.startswith(
        "the solver found no solution at the shortest step (t = 0.0"
    )
    assert 0.0 < run.time < END
    assert np.all(np.isfinite(run.end.position))


def test_cycles_cost_no_steps_but_the_cuts_at_their_ends():
    """Each begins with the step that the one before would have taken next."""
    scene = wear_times()
    # Before the first touch: behind it round-off makes some steps more or less.
    whole, cut = (
        accuracy(1e-11).simulate(scene.linkage(), start_of(scene), Plan(0.008 / n, n))
        for n in (1, 4)
    )
    assert whole.diagnostics["events"] == cut.diagnostics["events"] == 0
    assert 0 <= int(cut.diagnostics["steps"]) - int(whole.diagnostics["steps"]) <= 3
    assert cut.end.position == pytest.approx(whole.end.position, abs=1e-11)
