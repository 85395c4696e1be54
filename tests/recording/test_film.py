"""Film of a run."""

import numpy as np
import pytest

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.recording.film import FILM_JOINT, FRAMES_PER_CYCLE
from presswear.scene.catalog import scene_named
from presswear.scene.scene import Scene
from presswear.scene.settings import changed

FORCES = [FILM_JOINT.index(name) for name in ("normal", "tangential", "penetration")]


def run_cycles(scene: Scene, cycles: int) -> Run:
    engine = scene.solver.for_cycle(scene.mechanism.period)
    plan = Plan(scene.mechanism.period, cycles)
    return engine.simulate(scene.linkage(), start_of(scene, 0), plan)


@pytest.fixture(scope="module", params=["exudyn-tree", "dae"])
def rattling(request):
    scene = changed(scene_named("wear-times"), {"engine": request.param})
    return run_cycles(scene, 1)


def test_frames_of_the_ideal_press_lie_on_its_closed_form():
    scene = scene_named("ideal")
    film = run_cycles(scene, 1).recorder.film
    error = film.position - scene.ideal.at(film.time).position
    assert len(film.time) > 0.9 * FRAMES_PER_CYCLE
    assert np.abs(error).max() < 2e-7
    assert film.joints.shape == (len(film.time), 0, len(FILM_JOINT))


def test_frames_are_evenly_spaced_states_of_the_run_with_all_peaks(rattling):
    recorder = rattling.recorder
    film = recorder.film
    # A frame is the first state in its interval: two frames may be close to each other,
    # three cannot.
    interval = film.time[-1] / FRAMES_PER_CYCLE
    steps = np.diff(film.time)
    assert film.time[0] == 0.0
    assert 0.0 < steps.min() < steps.max() < 3.0 * interval
    assert (film.time[2:] - film.time[:-2]).min() > 0.9 * interval
    common, frames, rows = np.intersect1d(
        film.time, recorder.series("time"), return_indices=True
    )
    assert len(common) > 50
    for k in range(2):
        names = ("normal", "tangential", "penetration")
        series = np.column_stack([recorder.series(name, k)[rows] for name in names])
        joint = film.joints[:, k]
        np.testing.assert_array_equal(joint[frames][:, FORCES], series)
        normal = joint[:, FILM_JOINT.index("normal")]
        peak = joint[:, FILM_JOINT.index("peak")]
        assert peak.max() == recorder.records.counters["peak_force"][k]
        assert normal.max() < peak.max()  # the peak lies between two frames
        assert (peak >= normal).all()
