"""Random scenes in both engines."""

import math
from dataclasses import replace

import pytest

from presswear.linkage.press import Press
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Numerics
from presswear.trials.endure.scenes import Ended, coarser, ended, random_scenes, valid_scenes
from presswear.trials.endure.trials import SCENE_STEPS, SEED


def test_random_scenes_run_in_both_engines() -> None:
    found = valid_scenes(8, seed=1, most=SCENE_STEPS)
    assert found.tried == 8
    assert found.survived == 8, found.note


@pytest.mark.slow
def test_many_random_scenes_run_in_both_engines() -> None:
    """All but some in a hundred do; those end with a message, none with false numbers."""
    found = valid_scenes(300, SEED, most=SCENE_STEPS)
    stopped = int(found.note.partition(" ended with a message")[0])
    assert found.survived + stopped == found.tried == 300, found.note
    assert stopped <= 0.05 * found.tried, found.note


def test_scenes_are_those_of_their_seed_and_differ() -> None:
    one, same, other = ([s for s, _ in random_scenes(6, seed)] for seed in (1, 1, 2))
    assert one == same
    assert one != other
    assert len({scene.joints for scene in one}) > 1
    assert {isinstance(scene.mechanism, Press) for scene in one + other} == {True, False}


def test_a_run_that_needs_more_steps_runs_in_part() -> None:
    scene = replace(wear_times(), wears=0, engine="dae")
    whole, part = ended(scene), ended(scene, 3000)
    assert whole.part == 1.0
    assert 0.0 < part.part < 1.0
    assert whole.passed
    assert part.passed


def test_what_fails_or_loses_energy_does_not_pass() -> None:
    scene = wear_times()
    assert not Ended(scene, 1.0, math.nan, 1.0, "").passed
    assert not Ended(scene, 1.0, 2e-6, 1e-6, "").passed
    assert not Ended(scene, 1.0, 0.0, 1e-6, "it stopped").passed
    assert Ended(scene, 1.0, 1e-6, 1e-6, "").passed
    stopped = replace(
        scene, wears=0, engine="dae", numerics=Numerics().having(integrator="rk4", equal_step=1e-2)
    )
    assert "no longer finite" in ended(stopped).failure


def test_coarser_settings_may_miss_more() -> None:
    scene = replace(wear_times(), engine="dae")
    assert coarser(scene) == 1.0
    for tolerance, factor in ((1e-12, 1.0), (1e-7, 100.0)):
        numerics = Numerics().having(integration_tolerance=tolerance)
        assert coarser(replace(scene, numerics=numerics)) == pytest.approx(factor)
    joints = replace(
        scene, engine="exudyn-joints", numerics=Numerics().having(steps_per_contact=20)
    )
    assert coarser(joints) == pytest.approx(100.0)
