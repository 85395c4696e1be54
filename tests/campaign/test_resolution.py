"""Check of the time step within a stage."""

from dataclasses import replace
from statistics import median

import pytest

from presswear.campaign import replicates
from presswear.campaign.campaign import run
from presswear.campaign.replicates import StepCheck
from presswear.campaign.wear_update import initial_depth
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed


def scene_of(engine: str, tolerance: float) -> Scene:
    key = {"dae": "integration_tolerance", "exudyn-tree": "tree_tolerance"}[engine]
    return changed(replace(wear_times(), wear_updates=0), {"engine": engine, key: str(tolerance)})


def step_errors(scene: Scene, start: int = -1) -> dict[str, float]:
    return StepCheck(scene, initial_depth(scene)[0], start)(lambda *_: None)


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_pieces_with_equal_steps_are_equal(monkeypatch: pytest.MonkeyPatch, engine: str) -> None:
    """Bit for bit, because each starts in a state of the run itself."""
    monkeypatch.setattr(replicates, "REFINEMENT", 1.0)
    scene = scene_of(engine, 1e-5)
    assert step_errors(scene) == {
        "load_distance_step_error": 0.0,
        "peak_force_step_error": 0.0,
    }


def test_step_error_falls_with_the_tolerance() -> None:
    # The median, because chaos magnifies a small error in some pieces.
    coarse, fine = (
        median(step_errors(scene, start)["load_distance_step_error"] for start in (-1, -2, -3))
        for scene in (scene_of("exudyn-tree", 3e-5), scene_of("exudyn-tree", 1e-8))
    )
    assert coarse > 10.0 * fine > 0.0


def test_fixed_steps_and_closed_joints_have_no_step_error() -> None:
    scene = changed(wear_times(), {"engine": "dae", "integrator": "rk4"})
    assert step_errors(scene) == {}
    scene = replace(wear_times(), joints="none", wear_updates=0)
    assert step_errors(scene) == {}


def test_stage_of_many_cycles_has_a_step_error_below_its_wear_error() -> None:
    many, few = (
        run(replace(scene_of("dae", 1e-5), replicates=1, cycles=cycles)).stages[0].statistics
        for cycles in (replicates.STEP_CHECK_CYCLES, replicates.STEP_CHECK_CYCLES - 1)
    )
    assert many.load_distance_step_error is not None
    assert many.wear_error is not None
    assert 0.0 < many.load_distance_step_error < many.wear_error
    assert few.load_distance_step_error is None
