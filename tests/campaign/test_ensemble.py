"""Several replicates: they diverge, are pooled and end early together."""
# mypy: disable-error-code="operator"

import gc
import math
from dataclasses import replace
from statistics import median

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from presswear.campaign import replicates, runner
from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import SPREAD, StepCheck, start_of
from presswear.campaign.runner import FEWEST, WATCHED_CYCLES
from presswear.campaign.runs import run
from presswear.campaign.stage_arrays import COLUMNS, deviation
from presswear.campaign.stage_wear import StageWear, wear_peaks_of
from presswear.campaign.wear_update import initial_depth
from presswear.linkage.surface import SIDES
from presswear.physics.constraints import constraints_of
from presswear.recording.statistics import STARTUP_CYCLES, map_batches
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed

QUICK = changed(
    replace(wear_times(), wear_updates=0),
    {"engine": "dae", "integrator": "dopri5", "integration_tolerance": "1e-6"},
)


@pytest.fixture(scope="module")
def two():
    return run_stage(replace(QUICK, replicates=2, cycles=6))


def test_replicates_start_close_together_and_diverge(two):
    linkage = QUICK.linkage()
    replicates = [
        start_of(changed(QUICK, {"seed": seed}), k) for seed in "012" for k in range(4)
    ]
    away = [
        np.abs(start.position - replicates[0].position).max() for start in replicates
    ]
    assert away[0] == 0.0
    apart = np.diff(np.sort(away))
    assert max(away) < SPREAD * 0.8e-3
    assert apart.min() > 0.01 * SPREAD * 0.8e-3
    for start in replicates:
        phi, phi_t, _, _ = constraints_of(linkage).evaluate(
            0.0, start.position, start.velocity
        )
        assert np.abs(phi).max() < 1e-15
        assert np.abs(phi_t).max() < 1e-14
    one, other = (recorder.each_cycle("force_max", 0) for recorder in two[1].recorders)
    assert one.shape == other.shape
    # The last cycles have nothing in common.
    assert np.abs(one - other)[3:].max() > 1e-3 * one.max() > 0.0


def test_statistics_are_of_all_replicates(two):
    recorders = two[1].recorders
    peaks = [own.each_cycle("force_max", 0)[STARTUP_CYCLES:] for own in recorders]
    force = two[0].statistics.joints["A"]
    assert two[0].statistics.cycles == 12
    assert force.peak_force == max(own.max() for own in peaks)
    expected = np.concatenate(peaks)
    assert force.peak_force_per_cycle.mean == pytest.approx(expected.mean())
    assert force.peak_force_per_cycle.samples == 8
    assert force.contacts == sum(
        own.each_cycle("contacts", 0).sum() for own in recorders
    )
    joint = two[0].joints["A"]
    batches = joint.arrays["wear_batches"]
    assert len(batches) == 8
    added = np.stack([joint.wear(side) for side in SIDES])
    # Smoothing moves depth over angle only.
    assert batches.mean(axis=0).sum(axis=-1) == pytest.approx(
        added.sum(axis=-1), rel=1e-12
    )
    depth = force.wear_peaks["both"].depth
    assert depth.low < depth.mean < depth.high


def test_few_raw_maps_have_students_interval_at_the_deepest_place():
    """A bootstrap of four maps held in 45 of 60 campaigns with the paper's conventions."""
    (joint, *_) = QUICK.linkage().clearances
    random = np.random.default_rng(3)
    groove = np.exp(-((np.arange(joint.bins) - 90.0) ** 2) / 200.0)
    maps = 1e-5 * (groove + 0.1 * random.random((4, 1, 2, joint.bins)))
    wear = StageWear(
        maps.mean(axis=0), maps, np.ones(4), (1,) * 4, None, maps, False, False, None
    )
    depth = wear_peaks_of(joint, wear.of_joint(0, joint.bins))["bearing"].depth
    samples = maps[:, 0, 0, int(wear.added_depth[0, 0].argmax())]
    mean = samples.mean()
    error = stats.sem(samples)
    half = stats.t.interval(0.95, 3, mean, error)[1] - mean
    expected = mean, mean * math.exp(-half / mean), mean * math.exp(half / mean)
    assert (depth.mean, depth.low, depth.high) == pytest.approx(expected)


def test_stage_ends_when_all_replicates_together_know_the_maps(monkeypatch):
    monkeypatch.setattr(runner, "WATCHED_CYCLES", 1)
    scene = replace(QUICK, replicates=3, cycles=None, tolerance=0.12)
    ensemble = run_stage(scene)[1]
    maps, weights = map_batches(ensemble.maps)
    assert (len(ensemble.runs), ensemble.status) == (3, "enough")
    assert weights.sum() >= FEWEST
    mean = np.average(maps, axis=0, weights=weights)
    noise = maps.var(axis=0, ddof=1) / len(maps)
    error = np.sqrt(noise.sum(axis=(1, 2)) / (mean**2).sum(axis=(1, 2)))
    assert error.max() <= 0.12
    assert max(len(recorder.cycles) for recorder in ensemble.recorders) < 20
    ensemble = run_stage(replace(scene, tolerance=1e-3, max_cycles=13))[1]
    assert [len(recorder.cycles) for recorder in ensemble.recorders] == [4, 4, 4]
    assert ensemble.status == "completed"


def test_a_stage_watches_whether_the_motion_settles():
    """The maps are known after 9 cycles, but the motion of a press is to be seen for 50."""
    scene = replace(QUICK, replicates=2, cycles=None, tolerance=1.0)
    known = run_stage(scene)[1]
    assert [len(recorder.cycles) for recorder in known.recorders] == [
        WATCHED_CYCLES
    ] * 2


def delayed(scene: Scene, delay: float) -> NDArray[np.float64]:
    """Return the deviation of a run whose recorded slider follows the ideal one late."""
    ensemble = run_stage(replace(scene, cycles=2))[1]
    rows = ensemble.recorders[0].rows
    rows[:, 1:4] = scene.ideal_slider(rows[:, 0] - delay)
    return deviation(scene, ensemble.recorders[0])


def test_late_slider_lags_by_its_delay():
    late = 1e-4
    found = delayed(QUICK, late)
    assert found[:, COLUMNS.index("lag")] == pytest.approx(late, rel=2e-3)
    exact = delayed(QUICK, 0.0)
    assert np.abs(exact[:, :3]).max() < 1e-12
    ideal_stroke = np.ptp(
        QUICK.ideal_slider(np.linspace(0.0, QUICK.mechanism.period, 4001))[:, 0]
    )
    assert exact[:, COLUMNS.index("stroke")] == pytest.approx(ideal_stroke, rel=1e-5)


def tolerance_scene(engine: str, tolerance: float) -> Scene:
    key = {"dae": "integration_tolerance", "exudyn-tree": "tree_tolerance"}[engine]
    return changed(
        replace(wear_times(), wear_updates=0), {"engine": engine, key: str(tolerance)}
    )


def step_errors(scene: Scene, start: int = -1) -> dict[str, float]:
    return StepCheck(scene, initial_depth(scene)[0], start)(lambda *_: None)


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_pieces_with_equal_steps_are_equal(monkeypatch, engine):
    """Bit for bit, because each starts in a state of the run itself."""
    monkeypatch.setattr(replicates, "REFINEMENT", 1.0)
    scene = tolerance_scene(engine, 1e-5)
    assert step_errors(scene) == {
        "load_distance_step_error": 0.0,
        "peak_force_step_error": 0.0,
    }


def test_step_error_falls_with_the_tolerance():
    # The median, because chaos magnifies a small error in some pieces.
    coarse, fine = (
        median(
            step_errors(scene, start)["load_distance_step_error"]
            for start in range(-3, 0)
        )
        for scene in (tolerance_scene("dae", 1e-5), tolerance_scene("dae", 1e-9))
    )
    assert coarse > 10.0 * fine > 0.0


def test_fixed_steps_and_closed_joints_have_no_step_error():
    scene = changed(wear_times(), {"engine": "dae", "integrator": "rk4"})
    assert step_errors(scene) == {}
    scene = replace(wear_times(), joints="none", wear_updates=0)
    assert step_errors(scene) == {}


@pytest.fixture
def checked_cycles(monkeypatch):
    """Return the cycles from which on a stage has its time step checked."""
    monkeypatch.setattr(runner, "STEP_CHECK_CYCLES", 10)
    return 10


def test_stage_of_many_cycles_has_a_step_error_below_its_wear_error(checked_cycles):
    many, few = (
        run(replace(tolerance_scene("dae", 1e-5), replicates=1, cycles=cycles))
        .stages[0]
        .statistics
        for cycles in (checked_cycles, checked_cycles - 1)
    )
    assert 0.0 < many.load_distance_step_error < many.wear_error
    assert few.load_distance_step_error is None


def test_states_of_a_run_do_not_wait_for_garbage_collection(checked_cycles):
    """Otherwise each row of a sweep would add its states to the memory of a worker."""

    def count() -> int:
        return sum(type(item) is replicates.RunState for item in gc.get_objects())

    gc.collect()
    gc.disable()
    try:
        before = count()
        run(replace(QUICK, replicates=1, cycles=checked_cycles))
        assert count() == before
    finally:
        gc.enable()
