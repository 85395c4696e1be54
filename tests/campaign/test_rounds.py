"""Rounds of an ensemble: how far they go, and that no number depends on who runs them."""

import os
import signal
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from endurance.sameness import folder_differences

from presswear.campaign import ensemble
from presswear.campaign.campaign import Checkpoint, run, run_into, run_stage, workers_of
from presswear.campaign.ensemble import (
    FEWEST,
    Ensemble,
)
from presswear.campaign.replicates import RunState, StepCheck, WorkUnit
from presswear.recording.observer import Observer, Progress
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.folder import ResultFolder
from presswear.results.result import load
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene, stage_name
from presswear.scene.settings import changed
from presswear.tools.errors import RunFailed
from presswear.tools.processes import Array, InProcess, Job, OnProgress, OnResult, Pool, Report

QUICK = {
    "engine": "dae",
    "integrator": "dopri5",
    "integration_tolerance": "1e-6",
    "speed": "60rad/s",
    "angles": "90",
}
JUMP = changed(
    replace(
        wear_times(),
        wear_updates=1,
        replicates=3,
        cycles_per_update=1e5,
        max_cycles=9,
        tolerance=1.0,
    ),
    QUICK,
)
"""All the cycles that may be, a wear in a jump, and rounds behind it, together and alone."""
UNTIL_KNOWN = changed(replace(wear_times(), wear_updates=0, replicates=4, tolerance=0.06), QUICK)
STEPS = replace(JUMP, extrapolation="steps", cycles=3, replicates=2)

SCENES = {"jump": JUMP, "until known": UNTIL_KNOWN, "steps": STEPS}


def finished(scene: Scene, jobs: int, path: Path) -> Path:
    assert run(scene, path, jobs=jobs).status == "completed"
    return path


@pytest.fixture
def each_is_examined(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stages of few cycles tell what finer steps would change as well."""
    monkeypatch.setattr(ensemble, "STEP_CHECK_CYCLES", 1)


@pytest.mark.usefixtures("each_is_examined")
@pytest.mark.parametrize("name", sorted(SCENES))
def test_no_number_depends_on_the_processes(name: str, tmp_path: Path) -> None:
    scene = SCENES[name]
    one, three = (finished(scene, jobs, tmp_path / f"{jobs}") for jobs in (1, 3))
    assert folder_differences(one, three) == []
    assert all(stage.statistics.load_distance_step_error for stage in load(one).stages)
    if name == "until known":
        (only,) = load(one).stages
        # More than one round, or nothing was decided.
        assert only.statistics.cycles > 4 * STARTUP_CYCLES + FEWEST
        assert only.status == "enough"


class Reversed(InProcess):
    """Does the last job first, so that all come to their ends in another order."""

    def run(self, jobs: Mapping[int, Job], ended: OnResult, told: OnProgress) -> None:
        waiting = dict(jobs)
        while waiting:
            key = max(waiting)

            def report(
                done: float, word: str = "", rows: Array | None = None, key: int = key
            ) -> None:
                told(key, done, word, rows)

            following = ended(key, waiting.pop(key)(report))
            for other, job in following.items():
                waiting.pop(other, None)
                if job is not None:
                    waiting[other] = job


def told(ran: Ensemble) -> list[bytes]:
    return [array.tobytes() for own in ran.recorders for _, array in sorted(own.save().items())]


def test_no_number_depends_on_the_order() -> None:
    first = run_stage(UNTIL_KNOWN, 0)[1]
    # And on how often a run is handed over: here after each cycle.
    second = run_stage(UNTIL_KNOWN, 0, workers=Reversed(lasts=0.0))[1]
    assert told(first) == told(second)


@pytest.mark.parametrize("workers", [InProcess(), InProcess(lasts=0.0), Reversed()])
def test_a_failed_run_is_the_last(workers: InProcess, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever ran behind it, in order, is left out, and those before it run on."""
    call = WorkUnit.__call__

    def failing(self: WorkUnit, report: Report) -> RunState:
        reached = call(self, report)
        if self.replicate == 1 and reached.cycles >= 2:
            return replace(reached, status="failed")
        return reached

    monkeypatch.setattr(WorkUnit, "__call__", failing)
    ran = run_stage(replace(UNTIL_KNOWN, cycles=3, replicates=3), 0, workers=workers)[1]
    assert [run.status for run in ran.runs] == ["completed", "failed"]
    assert len(ran.recorders[0].cycles) == 3


class Kills(Observer):
    """Kill a worker process after a few cycles."""

    def __init__(self, pool: Pool) -> None:
        self.pool = pool

    def on_progress(self, progress: Progress) -> None:
        if progress.part > 0.3:
            assert self.pool._executor is not None
            with suppress(ProcessLookupError):  # killed by the report before
                os.kill(next(iter(self.pool._executor._processes)), signal.SIGKILL)


def test_a_run_whose_worker_was_killed_is_resumed(tmp_path: Path) -> None:
    scene = replace(UNTIL_KNOWN, cycles=8)
    whole, path = finished(scene, 1, tmp_path / "whole"), tmp_path / "killed"
    with workers_of(scene, 2, interval=0.0) as workers:
        assert isinstance(workers, Pool)
        with pytest.raises(RunFailed, match="memory ran out"):
            run_into(ResultFolder(path, scene, 0.0), scene, [Kills(workers)], workers)
    run_into(ResultFolder(path, scene, resume=True), scene)
    assert folder_differences(whole, path) == []


class Stops(Observer):
    """Interrupts once so much of the whole is done."""

    def __init__(self, part: float) -> None:
        self.part = part

    def on_progress(self, progress: Progress) -> None:
        if progress.whole > self.part:
            raise KeyboardInterrupt


@pytest.mark.parametrize(("part", "jobs"), [(0.2, 2), (0.6, 3)])
def test_what_is_stopped_in_many_goes_on_in_one(part: float, jobs: int, tmp_path: Path) -> None:
    """No cycle is lost that any of the processes had finished."""
    scene = replace(UNTIL_KNOWN, cycles=8)
    path = tmp_path / "stopped"
    with (
        workers_of(scene, jobs) as workers,
        pytest.raises(KeyboardInterrupt),
    ):
        run_into(ResultFolder(path, scene), scene, [Stops(part)], workers)
    with ResultFolder(path, scene, resume=True) as folder:
        assert folder.resumed is not None
        at = Checkpoint.load(folder.resumed)
    begun = [own.cycles for own in at.running.runs if own is not None]
    assert sum(begun) / 32 > part - jobs / 32
    run_into(ResultFolder(path, scene, resume=True), scene)
    assert folder_differences(finished(scene, 1, tmp_path / "whole"), path) == []


class StopsInWear(Observer):
    """Interrupts the wear behind the first stage."""

    def on_progress(self, progress: Progress) -> None:
        if progress.word.startswith(stage_name(1)):
            raise KeyboardInterrupt


@pytest.mark.usefixtures("each_is_examined")
def test_a_wear_that_is_gone_on_with_examines_its_stage_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, path = finished(STEPS, 1, tmp_path / "whole"), tmp_path / "stopped"
    worn: list[float] = []
    call = StepCheck.__call__

    def noting(self: StepCheck, report: Report) -> dict[str, float]:
        worn.append(float(self.depth.max()))
        return call(self, report)

    monkeypatch.setattr(StepCheck, "__call__", noting)
    with pytest.raises(KeyboardInterrupt):
        run_into(ResultFolder(path, STEPS), STEPS, [StopsInWear()])
    run_into(ResultFolder(path, STEPS, resume=True), STEPS)
    assert folder_differences(whole, path) == []
    first, second = worn
    assert second > first == 0.0


class Watches(Observer):
    """Wants frames, as a window does."""

    frames = 60

    def __init__(self) -> None:
        self.told: list[Progress] = []

    def on_progress(self, progress: Progress) -> None:
        self.told.append(progress)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_window_is_shown_frames_wherever_a_run_is(jobs: int) -> None:
    watching = Watches()
    scene = replace(UNTIL_KNOWN, cycles=6, replicates=2)
    with workers_of(scene, jobs, [watching]) as workers:
        run_stage(scene, 0, observers=[watching], workers=workers)
    films = [progress.film for progress in watching.told if progress.film is not None]
    assert films
    bodies = len(watching.told[0].linkage.bodies)
    for film in films:
        assert film.position.shape[1] == 3 * bodies
        assert 0 < len(film.time) <= 60
        assert film.joints.shape[1:] == (2, 6)
        assert np.isfinite(film.position).all()
    assert any("of 2 starts" in progress.word for progress in watching.told)
    parts = [progress.part for progress in watching.told]
    assert parts == sorted(parts)
