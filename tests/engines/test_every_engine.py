"""What holds for a run of the press in every engine."""

import math
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from runs import run_scene

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Start
from presswear.engines.dae.march import march_controlled
from presswear.engines.exudyn_tree.kernels import accept_tree_step
from presswear.engines.settings import Engine, Purpose
from presswear.linkage.press import GEOMETRIES, Press
from presswear.recording.observe import record_step
from presswear.scene.catalog import (
    ideal,
    press_blanking,
    slider_crank,
    wear_times,
)
from presswear.tools.compile import Kernel

SCENE = wear_times()
NUMERICS = SCENE.numerics
EXUDYN = [
    engine.for_cycle(SCENE.mechanism.period)
    for engine in (NUMERICS.tree, NUMERICS.joints)
]


@pytest.mark.parametrize("engine", EXUDYN, ids=lambda engine: engine.word)
def test_a_state_that_is_not_finite_ends_the_run_as_failed(engine: Engine):
    """The in-house solver refuses such a start: its joints do not hold."""
    start = start_of(SCENE)
    fast = Start(start.position, np.where(np.arange(18) == 13, 1e200, start.velocity))
    run = engine.simulate(SCENE.linkage(), fast, Plan(0.05, 1))
    assert run.status == "failed"
    assert "t = " in run.message


@pytest.mark.parametrize(
    "engine", [*EXUDYN, NUMERICS.dae], ids=lambda engine: engine.word
)
def test_interrupts_in_callbacks_arrive_as_they_are(engine: Engine):
    def interrupt(part: float, recorder: object) -> None:
        raise KeyboardInterrupt

    plan = Plan(0.05, 1, report=interrupt)
    with pytest.raises(KeyboardInterrupt):
        engine.simulate(SCENE.linkage(), start_of(SCENE), plan)


@pytest.mark.parametrize("engine", ["dae", "exudyn-joints"])
def test_without_gravity_a_turned_slider_crank_moves_alike(engine):
    """Up to the end of the first contact, after a fiftieth of a turn."""
    paths = []
    settings = {"gravity": 0.0, "speed": "300 rpm", "purpose": "trajectory"}
    for angle in (0.0, -0.5 * math.pi, 2.5):
        scene = slider_crank(engine=engine, slide_angle=angle, **settings)
        ran = run_scene(scene, scene.solver, 0.02 * scene.mechanism.period)
        x, y = (ran.recorder.series(f"eccentricity_{axis}", 0) for axis in "xy")
        paths.append((x + 1j * y) * np.exp(-1j * angle))
    assert np.ptp(np.abs(paths[0])) > 1e-4
    for path in paths[1:]:
        np.testing.assert_allclose(path, paths[0], rtol=0.0, atol=1e-10)


@pytest.mark.parametrize(("purpose", "fewest"), [("wear", 8), ("forces", 15)])
@pytest.mark.parametrize(
    "engine", [NUMERICS.tree, NUMERICS.dae], ids=lambda engine: engine.word
)
def test_contacts_get_as_many_steps_as_the_purpose_needs(
    engine: Engine, purpose: Purpose, fewest
):
    """At a tolerance so coarse that nothing else limits the steps; damping prolongs a contact."""
    changes: Any = {engine.tolerance_name: 1e-3}
    coarse = replace(engine, **changes).resolved(purpose)
    run = coarse.simulate(SCENE.linkage(), start_of(SCENE), Plan(0.05, 1))
    steps = np.concatenate([run.recorder.stored_contacts(k)[:, 5] for k in range(2)])
    assert len(steps) == 10
    assert steps.min() >= fewest
    assert steps.max() <= 3.0 * fewest


@pytest.mark.parametrize("geometry", list(GEOMETRIES))
@pytest.mark.parametrize(
    ("engine", "least", "errors"),
    [
        (NUMERICS.joints, 1000, (1e-6, 1e-5, 1e-2)),
        (NUMERICS.dae, 400, (1e-10, 1e-9, 1e-8)),
    ],
    ids=lambda value: value.word if isinstance(value, Engine) else "",
)
def test_ideal_press_follows_the_closed_form(engine: Engine, least, errors, geometry):
    """Position, velocity and acceleration of the slider in every row, and all bodies at the end."""
    scene = replace(ideal(), mechanism=Press(geometry=GEOMETRIES[geometry]))
    period = scene.mechanism.period
    run = engine.for_cycle(period).simulate(
        scene.linkage(), start_of(scene), Plan(period, 1)
    )
    rows = run.recorder.rows
    assert len(rows) > least
    apart = np.abs(rows[:, 1:4] - scene.ideal_slider(rows[:, 0])).max(axis=0)
    assert np.all(apart < errors)
    closing = scene.ideal.at(np.array([run.time]))
    assert run.time == pytest.approx(period, abs=1e-9)
    assert np.abs(run.end.position - closing.position[0]).max() < errors[0]
    assert np.abs(run.end.velocity - closing.velocity[0]).max() < errors[1]


@pytest.mark.parametrize(
    ("engine", "run_loop"),
    [("dae", march_controlled), ("exudyn-tree", accept_tree_step)],
)
def test_only_equations_are_compiled_for_another_linkage(engine, run_loop):
    """The press has a load with a law and two joints with clearance, the other no load."""
    kernels = [cast(Kernel, kernel).from_python for kernel in (run_loop, record_step)]
    counts = []
    for scene in (press_blanking(engine=engine), slider_crank(engine=engine)):
        run_scene(scene, scene.solver, 1e-4)
        counts.append([len(kernel.overloads) for kernel in kernels])
    assert counts[0] == counts[1]
