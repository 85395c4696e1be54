"""The press of 250 kN from its file: joints that bear a hundred times their links' weight."""

import math
from functools import cache
from pathlib import Path

import pytest

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynTree, InHouse
from presswear.scene.files import scene_from
from presswear.scene.settings import changed

FILE = Path(__file__).parents[2] / "scenarios" / "press-250kN.toml"
SCENE = scene_from(FILE)
ENGINES = "exudyn-tree", "dae"
STOP = {"process": "coining", "process.stiffness": "4e8 N/m", "process.height": "0.6 mm"}
"""A stop under the first stroke, within the horizon; a sheet comes with the second."""
UNTIL = 0.105
"""s; bottom dead centre, where the stop bears most."""


@cache
def stroke(engine: str) -> pw.Result:
    """Two strokes, one of them on the sheet."""
    return pw.run(changed(SCENE, {"cycles": "2"}), engine=engine)


def test_what_the_file_computes_from_other_values_follows_from_them() -> None:
    """K of Liu's cylinders, 60 strokes a minute, weights, and the pressure in the bushes."""
    own = SCENE.bearing("C")
    stiffness = math.pi * own.width / own.materials.compliance
    assert own.hertz("refined") == pytest.approx(
        stiffness / (2.0 * math.sqrt(2.0 * own.clearance)), rel=1e-3
    )
    assert SCENE.mechanism.period == pytest.approx(1.0)
    assert SCENE.stroke == pytest.approx(0.75 * pw.scenes.ideal().stroke, rel=1e-9)
    weight = 9.81 * sum(body.mass for body in SCENE.mechanism.linkage().bodies)
    assert 80.0 < 225e3 / weight < 250e3 / weight < 110.0
    assert 250e3 / (2.0 * own.bearing_radius * own.width) == pytest.approx(34.7e6, rel=1e-3)


@pytest.mark.parametrize("engine", ENGINES)
def test_energies_add_up_under_a_load_of_a_hundred_weights(engine: str) -> None:
    result = stroke(engine)
    assert (result.stages[0].statistics.energy_residual_fraction or 1.0) < 1e-6
    tonnage, process = result.tonnage(0), SCENE.process
    assert tonnage is not None
    assert tonnage.work is not None
    assert process is not None
    assert tonnage.work.mean == pytest.approx(process.work, rel=1e-7)


@pytest.mark.parametrize("engine", ENGINES)
def test_pins_bear_what_the_ideal_press_does(engine: str) -> None:
    """The rod to the slider bears the work, the crank half of it; both sink in deep."""
    result = stroke(engine)
    joints = result.stages[0].joints
    deep = {name: joint.penetration.max() for name, joint in joints.items()}
    assert 225e3 < joints["C"].force[:, 0].max() < 250e3
    assert 0.9 < deep["C"] / SCENE.bearing("C").clearance < 1.1
    assert 0.4 < deep["A"] / SCENE.bearing("A").clearance < 0.8
    assert str(result).count("too wide for a law of a small contact") == 2


def loaded(engine: Engine) -> Run:
    """The first stroke on a stop."""
    scene = changed(SCENE, STOP)
    plan = Plan(UNTIL, 1, recorded_cycles=1)
    return engine.simulate(scene.linkage(), start_of(scene), plan)


def test_both_engines_press_pins_as_deep_into_their_bearings() -> None:
    """Up to the greatest force, through the touches before it; rows of a series cut its top."""
    finest = ExudynTree(tree_tolerance=1e-11), InHouse(integration_tolerance=1e-12)
    one, other = (loaded(own) for own in finest)
    assert one.end.position == pytest.approx(other.end.position, abs=1e-9)
    for k, least in enumerate((100e3, 180e3)):
        deepest, peak = (
            [float(run.recorder.series(name, k).max()) for run in (one, other)]
            for name in ("penetration", "normal")
        )
        assert peak[0] > least
        assert peak[0] == pytest.approx(peak[1], rel=1e-3)
        assert deepest[0] == pytest.approx(deepest[1], rel=1e-3)
