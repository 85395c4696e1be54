"""User friction laws with a state: Dahl's and LuGre's, against the built-in law and engines."""

from typing import Any

import pytest
from four_bar_linkage import FOUR_BAR
from runs import run_scene

from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.friction_law import FrictionLaw, has_state
from presswear.physics.interactions.friction import steady_friction
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction

LAWS = """
import math

def dahl(normal, state, stiffness: "100 1/m to 1e6 1/m" = 1e3, scale=1e-4):
    return -normal * stiffness * state

def dahl_rate(sliding, coefficient, state, closed, stiffness: "100 1/m to 1e6 1/m" = 1e3):
    return closed * (sliding - abs(sliding) * state * stiffness / coefficient)

def lugre(sliding, normal, coefficient, state, scale=1e-4):
    fading = 10.0 * math.exp(-(sliding / 1e-3) ** 2)
    rate = sliding - 1e3 * abs(sliding) * state / coefficient
    return -normal * (1e3 * state + fading * rate)

def lugre_rate(sliding, coefficient, state, closed):
    rate = sliding - 1e3 * abs(sliding) * state / coefficient
    return closed * rate - (1.0 - closed) * 100.0 * state

def pushes(normal, state):
    return normal * state

def pushes_rate(sliding, state):
    return sliding - state

def alone(normal, state):
    return -normal * state

def grows(normal, state):
    return -normal * state

def grows_rate(sliding, state):
    return sliding + state
"""


def law(name: str) -> UserFunction:
    return UserFunction(name, LAWS).trusted()


def scene_with(**settings: Any) -> Scene:
    return changed(
        Scene(mechanism=FOUR_BAR, joints="AB", wear_updates=0),
        {"clearance": 5e-4, "friction": 0.1, "restitution": 0.8, **settings},
    )


def loss_of(scene: Scene, engine: Engine) -> float:
    run = run_scene(scene, engine, 0.0114)
    return float(run.diagnostics["friction_loss_J"])


def test_lugre_as_a_user_law_is_the_built_in_one():
    """Same numbers of the bristles, 1000 1/m and 10 s/m; the loss over ten touchdowns."""
    engine = InHouse(integration_tolerance=1e-11)
    built_in = {
        "friction_law": "lugre",
        "bristle_stiffness": 1e3,
        "bristle_damping": 10.0,
    }
    expected = loss_of(scene_with(**built_in), engine)
    scene = scene_with(friction_law=law("lugre"))
    scene.check_user_laws()
    assert loss_of(scene, engine) == pytest.approx(expected, rel=1e-9)
    assert abs(loss_of(scene_with(), engine) / expected - 1.0) > 1e-3


@pytest.mark.parametrize(
    ("engine", "bound"),
    [
        (ExudynTree(tree_tolerance=1e-10), 1e-4),
        (ExudynJoints(steps_per_contact=400), 1e-3),
    ],
)
def test_engines_agree_on_a_user_state(engine: Engine, bound):
    scene = scene_with(friction_law=law("dahl"))
    expected = loss_of(scene, InHouse(integration_tolerance=1e-11))
    assert loss_of(scene, engine) == pytest.approx(expected, rel=bound)


def test_steady_sliding_has_coulombs_force():
    import numpy as np

    function = law("dahl")
    assert has_state(function)
    friction = FrictionLaw(0.1, user_law=function)
    speeds: Array = np.array([-1.0, 1e-3, 2.0])
    force = steady_friction(friction, speeds, np.full(3, 50.0))
    np.testing.assert_allclose(force, [5.0, -5.0, -5.0], rtol=1e-9)


@pytest.mark.parametrize(
    ("name", "settings", "words"),
    [
        ("alone", {}, "unknown function in friction_law 'alone_rate'"),
        ("grows", {}, "grows_rate must fall with the state"),
        ("pushes", {}, "pushes makes energy"),
        (
            "dahl",
            {"clearance": 0.0},
            "with clearance = 0 allowed is a law without a state",
        ),
    ],
)
def test_states_that_are_refused(name, settings, words):
    with pytest.raises(InputError, match=words):
        scene_with(friction_law=law(name), **settings).check_user_laws()
