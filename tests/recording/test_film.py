"""Film of a run."""

import numpy as np
import pytest

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.recording import film as film_module
from presswear.recording.film import FILM_JOINT, FRAMES_PER_CYCLE, Film
from presswear.scene.catalog import scene_named
from presswear.scene.scene import Scene
from presswear.scene.settings import changed


def ran(scene: Scene, cycles: int) -> Run:
    accuracy = scene.solver.for_cycle(scene.mechanism.period)
    plan = Plan(scene.mechanism.period, cycles)
    return accuracy.simulate(scene.linkage(), start_of(scene, 0), plan)


@pytest.fixture(scope="module", params=["exudyn-tree", "dae"])
def rattling(request: pytest.FixtureRequest) -> Run:
    return ran(changed(scene_named("wear-times"), {"engine": request.param}), 1)


def test_frames_of_the_ideal_press_lie_on_its_closed_form() -> None:
    scene = scene_named("ideal")
    run = ran(scene, 1)
    film = run.recorder.film
    exact = scene.ideal.at(film.time)
    apart = np.abs(film.position - exact.position)
    assert len(film.time) > 0.9 * FRAMES_PER_CYCLE
    assert apart.max() < 2e-7
    assert film.joints.shape == (len(film.time), 0, len(FILM_JOINT))


def test_frames_are_evenly_spaced_states_of_the_run_with_all_peaks(
    rattling: Run,
) -> None:
    recorder = rattling.recorder
    film = recorder.film
    rows = recorder.rows
    # One in each interval, so at least half of one apart on the average of two.
    interval = film.time[-1] / FRAMES_PER_CYCLE
    assert film.time[0] == 0.0
    assert 0.0 < np.diff(film.time).min() < np.diff(film.time).max() < 3.0 * interval
    assert (film.time[2:] - film.time[:-2]).min() > 0.9 * interval
    common, ours, theirs = np.intersect1d(film.time, rows[:, 0], return_indices=True)
    assert len(common) > 50
    for k in range(2):
        columns = film.joints[:, k]
        # Normal and tangential force and penetration are those of the series.
        series = rows[theirs, 4 + 6 * k :][:, [3, 4, 2]]
        assert np.array_equal(columns[ours][:, [0, 1, 4]], series)
        assert columns[:, 5].max() == recorder.records.counters["peak_force"][k]
        assert columns[:, 0].max() < columns[:, 5].max()  # frames alone miss it
        assert (columns[:, 5] >= columns[:, 0]).all()


def test_a_film_ends_and_its_last_frame_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(film_module, "FILM_CYCLES", 1)
    recorder = ran(changed(scene_named("wear-times"), {"engine": "dae"}), 2).recorder
    period = scene_named("wear-times").mechanism.period
    assert len(recorder.film.time) == FRAMES_PER_CYCLE
    # Steps are longer than an interval at times, so a film lasts a little longer.
    assert recorder.film.time[-1] < 1.3 * period
    last = Film.of(recorder.last_frames(60), 2)
    assert last.time == pytest.approx([2.0 * period], abs=0.01 * period)
