"""Linkages that the program was not written for: engines agree, and the energy adds up."""

import math
from dataclasses import replace

import numpy as np
import pytest

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import ExudynTree, InHouse
from presswear.linkage.elements import Bar, Body, Guide, Linkage, Pin
from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.motions import Drive
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.trials.runs import contacts_of

TOGGLE = Linkage(
    bodies=[
        Bar("crank", 0.04, 0.3),
        Bar("rod", 0.20, 0.4),
        Bar("upper", 0.15, 0.5),
        Bar("lower", 0.15, 0.5),
        Body("slider", 1.0, 1e-3),
    ],
    joints=[
        Pin("O", (0.22, 0.13), "crank.tail"),
        Pin("A", "crank.head", "rod.head"),
        Pin("K", "rod.tail", "upper.head"),
        Pin("L", "lower.tail", "upper.head"),
        Pin("P", (0.0, 0.28), "upper.tail"),
        Pin("S", "lower.head", "slider.centre"),
        Guide("guide", "slider", direction=0.5 * math.pi),
    ],
    drives=[Drive("crank", 20.0, 0.3)],
    guess={"rod": 0.0, "upper": -1.35, "lower": -1.8},
    watch="slider.centre",
    name="toggle press",
)
WATT = Linkage(
    bodies=[
        Bar("crank", 0.05, 0.3),
        Bar("coupler", 0.20, 0.5),
        Body("rocker", 0.6, 2e-3, {"p": (-0.04, 0.0), "b": (0.08, 0.0), "c": (0.05, 0.06)}),
        Bar("link", 0.18, 0.4),
        Bar("output", 0.14, 0.4),
    ],
    joints=[
        Pin("O", (0.0, 0.0), "crank.tail"),
        Pin("A", "crank.head", "coupler.tail"),
        Pin("B", "coupler.head", "rocker.b"),
        Pin("P", (0.18, 0.0), "rocker.p"),
        Pin("C", "link.tail", "rocker.c"),
        Pin("D", "link.head", "output.head"),
        Pin("Q", (0.34, -0.02), "output.tail"),
    ],
    drives=[Drive("crank", 25.0)],
    guess={"coupler": 0.6, "rocker": 1.4, "link": -0.2, "output": 1.2},
    watch="output.head",
    name="Watt's six-bar",
)
SCENES = {
    "four-bar": (FOUR_BAR, "B", {"clearance": 0.3e-3}),
    "toggle": (TOGGLE, "KL", {"clearance": 0.2e-3, "K.friction": 0.05, "L.clearance": 0.3e-3}),
    "six-bar": (WATT, "BC", {"clearance": 0.3e-3, "C.clearance": 0.15e-3}),
}
TOUCHES = 10


def scene_of(name: str) -> Scene:
    linkage, joints, settings = SCENES[name]
    return changed(Scene(mechanism=linkage, joints=joints, wears=0), settings)


def run_until(scene: Scene, engine: ExudynTree | InHouse, duration: float) -> Run:
    plan = Plan(duration, 1, recorded_cycles=1)
    run = engine.over(scene.mechanism.period).simulate(scene.linkage(), start_of(scene), plan)
    assert run.status == "completed", run.message
    return run


def touchdowns(run: Run, joints: int) -> list[float]:
    return sorted(time for k in range(joints) for time in contacts_of(run, k)["touchdown"].tolist())


@pytest.mark.parametrize("name", SCENES)
def test_engines_agree_over_ten_touches_and_keep_the_energy(name: str) -> None:
    """Exudyn's tree beside Lagrange multipliers, both fine: 1e-8 m, 1e-7 of the exchange."""
    scene = scene_of(name)
    joints = len(scene.clearance_joints)
    fine = InHouse(integration_tolerance=1e-12)
    whole = run_until(scene, fine, 0.5 * scene.mechanism.period)
    times = touchdowns(whole, joints)
    assert len(times) > TOUCHES
    duration = 0.5 * (times[TOUCHES - 1] + times[TOUCHES])
    runs = [run_until(scene, own, duration) for own in (fine, ExudynTree(tree_tolerance=1e-11))]
    one, other = (np.array(touchdowns(run, joints))[: TOUCHES - 1] for run in runs)
    np.testing.assert_allclose(one, other, atol=1e-9)
    places = [run.end.position for run in runs]
    assert np.abs(places[0] - places[1]).max() < 1e-8
    for run in runs:
        residual = abs(float(run.diagnostics["energy_residual_J"]))
        assert residual < 1e-7 * float(run.diagnostics["drive_exchange_J"])


def test_clearance_on_the_frame_runs_in_every_engine() -> None:
    """The rocker's pivot on the frame is loose: its bearing stands still."""
    scene = replace(scene_of("four-bar"), joints="BP")
    words = ("exudyn-joints", "dae", "exudyn-tree")
    engines = [replace(scene, engine=word).solver for word in words]
    ends = []
    for engine in engines:
        plan = Plan(0.02, 1, recorded_cycles=1)
        run = engine.over(scene.mechanism.period).simulate(scene.linkage(), start_of(scene), plan)
        assert run.status == "completed", run.message
        ends.append(run.end.position)
    assert np.abs(ends[0] - ends[1]).max() < 1e-5
    assert np.abs(ends[1] - ends[2]).max() < 1e-5
