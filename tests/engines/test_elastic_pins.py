"""Elastic pins: closed forms of a mass on one, the rigid limit, statics, bad input."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from marks import slow
from runs import energy_residual, momenta, residual, run_scene, simulated, step_response

import presswear as pw
from presswear.engines.base import Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import Surface
from presswear.physics.statics import equilibrium
from presswear.scene.differences import changes_from
from presswear.scene.pin_joints import clearance_joint, normal_law_of
from presswear.scene.setting_list import used_settings_of

MASS = 2.0
STIFFNESS = 8e4
RATIO = 0.05
OMEGA = math.sqrt(STIFFNESS / MASS)
ENGINES: list[Engine] = [
    InHouse(integration_tolerance=1e-10),
    ExudynTree(tree_tolerance=1e-10),
    ExudynJoints(),
]


def hung(ratio: float = RATIO, gravity: float = 9.81) -> Linkage:
    """A block that hangs by an elastic pin through its mass centre."""
    block = pw.Body("block", MASS, 1e-2)
    pin = pw.Pin("P", (0.0, 0.0), "block.centre", STIFFNESS, ratio)
    return pw.assemble([block], [pin], output="block", gravity=gravity, cycle=0.1)


def sprung() -> Linkage:
    """A block on a tilted guide with a spring, away from the origin."""
    guide = pw.Guide("G", "block", 0.3, 0.2, 0.6, stiffness=STIFFNESS, damping=RATIO)
    block = pw.Body("block", MASS, 1e-2)
    return pw.assemble([block], [guide], output="block", gravity=0.0, cycle=0.1)


@pytest.mark.parametrize(
    ("linkage", "rest", "direction", "spin"),
    [
        (hung(gravity=0.0), (0.0, 0.0, 0.3), 0.0, 2.0),
        (sprung(), (0.3, 0.2, 0.0), 0.6, 0.0),
    ],
    ids=["pin", "guide"],
)
@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.word)
def test_a_block_rings_as_a_damped_oscillator(
    engine: Engine, linkage: Linkage, rest, direction, spin
):
    """On an elastic pin or guide, displaced along a direction and let go without weight."""
    along = np.array([math.cos(direction), math.sin(direction), 0.0])
    duration = 0.05
    start = Start(rest + 1e-3 * along, np.array([0.0, 0.0, spin]))
    run = simulated(engine, linkage, start, duration)
    exact = 1e-3 * step_response(OMEGA, RATIO, duration)
    is_implicit = isinstance(engine, ExudynJoints)
    place = float(along @ (run.end.position - rest))
    assert place == pytest.approx(exact, abs=2e-7 if is_implicit else 1e-11)
    # The forces of a pin act through the middle of e, half a stretch from the mass centre.
    assert run.end.velocity[2] == pytest.approx(spin, abs=1e-2)
    stored = 0.5 * STIFFNESS * 1e-6
    assert energy_residual(run) < (1e-3 if is_implicit else 1e-8) * stored


def test_the_energy_of_a_block_that_orbits_its_pin_balances():
    """Its stretch turns, and the damper takes less than D |e'|^2 from a body that turns, too."""
    linkage = hung(gravity=0.0)
    duration = 0.05
    orbit = np.array([0.0, 1e-3 * OMEGA, 20.0])
    start = Start(np.array([1e-3, 0.0, 0.0]), orbit)
    run = simulated(InHouse(integration_tolerance=1e-12), linkage, start, duration)
    stored = 0.5 * STIFFNESS * 1e-6
    assert energy_residual(run) < 1e-9 * stored


def test_momentum_of_two_blocks_stays():
    """Linear and angular, where neither block is held."""
    blocks = [
        pw.Body("one", 1.0, 1e-2),
        pw.Body("two", 3.0, 2e-2, {"tip": (0.1, 0.02)}),
    ]
    pin = pw.Pin("P", "one.centre", "two.tip", STIFFNESS, RATIO)
    linkage = pw.assemble(blocks, [pin], output="one", gravity=0.0, cycle=0.1)
    start = Start(
        np.array([0.0, 0.0, 0.0, -0.1, 0.01, 0.0]),
        np.array([1.0, 0.2, 3, 0.0, 0.5, -1]),
    )
    run = simulated(ENGINES[0], linkage, start, 0.05)

    before, after = (momenta(linkage, state) for state in (start, run.end))
    np.testing.assert_allclose(after, before, rtol=1e-9)


def test_a_block_hangs_lower_by_its_weight_over_the_stiffness():
    linkage = hung().changed(drives=[pw.Drive("block", 0.0)])
    drop = equilibrium(linkage.released, 0.0).position[1]
    assert drop == pytest.approx(-MASS * 9.81 / STIFFNESS, rel=1e-12)


def test_a_joint_with_stiffness_has_no_clearance():
    stiff = [replace(pin, stiffness=1e7) for pin in FOUR_BAR.revolutes]
    with pytest.raises(pw.InputError, match="B"):
        pw.Scene(
            FOUR_BAR.changed(joints=stiff), bearings={"B": pw.Bearing(clearance=1e-4)}
        )
    with pytest.raises(pw.InputError, match="stiffness of B = 10 N/m: allowed is 1000"):
        pw.Pin("B", (0.0, 0.0), "a.tail", 10.0)


def scene_of(**values: Any) -> pw.Scene:
    bearing = pw.Bearing(clearance=0.0, friction=0.1, **values)
    return pw.Scene(FOUR_BAR, bearings={"B": bearing}, purpose="trajectory")


@pytest.mark.parametrize("engine", [*ENGINES[:2], slow(ENGINES[2])])
def test_friction_of_a_stiff_pin_is_that_of_a_rigid_joint(engine: Engine):
    """Also in the tree, which has no force of a rigid joint."""
    rigid = run_scene(scene_of(), ENGINES[0], 0.05)
    elastic = run_scene(scene_of(stiffness=1e8, damping_ratio=1.0), engine, 0.05)
    losses = [float(run.diagnostics["friction_loss_J"]) for run in (rigid, elastic)]
    assert losses[0] > 1e-4
    assert losses[1] == pytest.approx(losses[0], rel=2e-3)
    assert residual(elastic) < (1e-4 if isinstance(engine, ExudynJoints) else 1e-8)


def test_bearings_make_joints_elastic():
    scene = scene_of(stiffness="10 MN/m", damping_ratio=0.1, parallel_rods=2)
    (pin,) = scene.linkage().elastic_pins
    assert (pin.name, pin.stiffness, pin.damping_ratio) == ("B", 2e7, 0.1)
    assert pw.Scene.from_dict(scene.as_dict()) == scene
    assert scene.clearance_joints == ()
    assert [bushing.name for bushing in scene.linkage().bushings] == ["B"]


def test_a_stiffness_is_set_by_joint():
    """The stiffness without a joint is the reading of K."""
    scene = pw.changed(pw.Scene(), {"E.stiffness": "3GN/m", "stiffness": "paper"})
    assert scene.clearance_joints == ("A", "C")
    assert [pin.stiffness for pin in scene.linkage().elastic_pins] == [3e9]
    assert scene.conventions.stiffness == "paper"
    values = {setting.key: setting.value for setting in used_settings_of(scene)}
    assert (values["E.stiffness"], values["stiffness"]) == (3e9, "paper")
    changes = {change.key for change in changes_from(pw.Scene(), scene)}
    assert changes == {"stiffness", "joints", "E.clearance", "E.stiffness"}
    with pytest.raises(pw.InputError, match=r"A\.clearance = 0\.3 mm: with stiffness"):
        pw.changed(pw.Scene(), {"A.stiffness": "3GN/m"})
    with pytest.raises(pw.InputError, match="name the joint, for example E"):
        pw.changed(pw.Scene(), {"damping_ratio": 0.1})


def test_parallel_rods_are_one_with_their_widths_and_stiffness():
    one = pw.Bearing(contact_stiffness=4e10)
    four = pw.Bearing(contact_stiffness=1e10, parallel_rods=4)
    conventions = pw.Scene().conventions
    assert normal_law_of(four, conventions) == normal_law_of(one, conventions)
    joint = clearance_joint(
        four, FOUR_BAR.revolutes[0], conventions, (Surface(), Surface())
    )
    assert joint.width == 4.0 * one.width
