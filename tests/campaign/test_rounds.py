"""Rounds of an ensemble: no number depends on who runs them, and all of them resume."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from endurance.sameness import folder_differences

import presswear as pw
from presswear.campaign import runner
from presswear.campaign.campaign import run_stage
from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.replicates import RunState, WorkUnit
from presswear.campaign.runner import FEWEST
from presswear.campaign.runs import run, run_into, workers_of
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.folder import ResultFolder, read_stored
from presswear.scene.settings import changed
from presswear.tools.processes import Job, OnProgress, OnResult, Report, Workers

QUICK = {
    "engine": "dae",
    "integrator": "dopri5",
    "integration_tolerance": "1e-6",
    "speed": "60rad/s",
    "angles": "90",
    "wear_updates": 1,
    "cycles_per_update": 1e5,
}
# As many cycles as allowed, a wear update in one jump, and rounds after it, together
# and alone.
JUMP = changed(
    replace(pw.scenes.wear_times(), replicates=3, max_cycles=9, tolerance=1.0), QUICK
)
STEPS = replace(JUMP, extrapolation="steps", cycles=3, replicates=2)
UNTIL_KNOWN = replace(
    JUMP, wear_updates=0, replicates=4, max_cycles=200, tolerance=0.06
)
EIGHT = replace(UNTIL_KNOWN, cycles=8)
SCENES = {"jump": JUMP, "until known": UNTIL_KNOWN, "steps": STEPS}


def finished(scene: pw.Scene, jobs: int, path: Path) -> Path:
    assert run(scene, path, jobs=jobs).status == "completed"
    return path


@pytest.fixture
def each_is_checked(monkeypatch):
    """Check the time step of stages of few cycles as well, which are not watched for longer."""
    monkeypatch.setattr(runner, "STEP_CHECK_CYCLES", 1)
    monkeypatch.setattr(runner, "WATCHED_CYCLES", 1)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run of eight cycles that nothing has stopped."""
    return finished(EIGHT, 1, tmp_path_factory.mktemp("whole") / "run")


@pytest.mark.usefixtures("each_is_checked")
@pytest.mark.parametrize("name", sorted(SCENES))
def test_no_number_depends_on_the_processes(name, tmp_path):
    one, two = (finished(SCENES[name], jobs, tmp_path / f"{jobs}") for jobs in (1, 2))
    assert folder_differences(one, two) == []
    stages = pw.load(one).stages
    assert all(stage.statistics.load_distance_step_error for stage in stages)
    if name == "until known":
        # More than one round, or nothing was decided.
        assert stages[0].statistics.cycles > 4 * STARTUP_CYCLES + FEWEST
        assert stages[0].status == "enough"


class Reversed(Workers):
    """Runs the last job first."""

    def run(
        self, jobs: Mapping[int, Job], ended: OnResult, progress: OnProgress
    ) -> None:
        waiting = dict(jobs)
        while waiting:
            key = max(waiting)

            def report(
                done: float, word: str = "", rows: Any = None, key: int = key
            ) -> None:
                progress(key, done, word, rows)

            for other, job in ended(key, waiting.pop(key)(report)).items():
                waiting.pop(other, None)
                if job is not None:
                    waiting[other] = job


@pytest.mark.parametrize("workers", [Workers(), Workers(job_duration=0.0), Reversed()])
def test_failed_run_is_the_last(workers, monkeypatch):
    """Runs after it, in order, are left out, and those before it run on."""
    call = WorkUnit.__call__

    def failing(self: WorkUnit, report: Report) -> RunState:
        state = call(self, report)
        if self.part.replicate == 1 and state.cycles >= 2:
            return replace(state, status="failed")
        return state

    monkeypatch.setattr(WorkUnit, "__call__", failing)
    runs = run_stage(replace(UNTIL_KNOWN, cycles=3, replicates=3), workers=workers)[1]
    assert [run.status for run in runs.runs] == ["completed", "failed"]
    assert len(runs.recorders[0].cycles) == 3


class At(pw.engines.Observer):
    """Calls a function with each progress that fits."""

    def __init__(self, function: Any, part: float = 0.0, word: str = "") -> None:
        self.function = function
        self.part = part
        self.word = word

    def on_progress(self, progress: pw.engines.Progress) -> None:
        if progress.whole > self.part and progress.word.startswith(self.word):
            self.function()


def interrupt() -> None:
    raise KeyboardInterrupt


def kill_worker(pool: Workers) -> None:
    pool._workers[0].process.kill()


def test_run_of_a_killed_worker_resumes(whole, tmp_path):
    path = tmp_path / "killed"
    with workers_of(EIGHT, 2, interval=0.0) as workers:
        assert isinstance(workers, Workers)
        observers = [At(partial(kill_worker, workers), 0.3)]
        with pytest.raises(pw.RunFailed, match="memory ran out"):
            run_into(ResultFolder(path, EIGHT, 0.0), EIGHT, observers, workers)
    run_into(ResultFolder(path, EIGHT, resume=True), EIGHT)
    assert folder_differences(whole, path) == []


def test_interrupted_processes_resume_in_one(whole, tmp_path):
    """No cycle is lost that any of the three processes had finished."""
    path = tmp_path / "stopped"
    with (
        workers_of(EIGHT, 3, interval=0.0) as workers,
        pytest.raises(KeyboardInterrupt),
    ):
        run_into(ResultFolder(path, EIGHT), EIGHT, [At(interrupt, 0.6)], workers)
    with ResultFolder(path, EIGHT, resume=True) as folder:
        assert folder.resumed is not None
        running = Checkpoint.load(folder.resumed).running
    assert running.cycles / 32 > 0.6 - 3 / 32
    run_into(ResultFolder(path, EIGHT, resume=True), EIGHT)
    assert folder_differences(whole, path) == []


class Stored(pw.engines.Observer):
    """Keeps the words of the checkpoint that the folder holds after each notification."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.words = list[str]()

    def on_checkpoint(self, checkpoint: Checkpoint, is_stage: bool) -> None:
        stored = read_stored(self.path).checkpoint
        self.words.append(stored.words if stored else "")


@pytest.mark.parametrize(("interval", "is_each_due"), [(0.0, True), (1e6, False)])
def test_checkpoint_is_written_when_due(interval, is_each_due, tmp_path):
    """After every cycle without an interval, and after a stage in any case."""
    observer = Stored(tmp_path / "out")
    scene = replace(STEPS, replicates=1)
    run(scene, observer.path, jobs=1, observers=[observer], interval=interval)
    assert observer.words[0] == ("stage 0, cycle 1" if is_each_due else "")
    assert (len(set(observer.words)) > 6) == is_each_due
    assert "stage 1, cycle 0" in observer.words
    assert not list(observer.path.glob("checkpoint*"))


def test_resuming_on_another_machine_is_remarked(tmp_path):
    path = tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        run(STEPS, path, jobs=1, observers=[At(interrupt, 0.2)])
    stored = read_stored(path)
    stored.provenance["machine"] = "Plan 9, 1 core"
    stored.write(path)
    with ResultFolder(path, STEPS, resume=True) as folder:
        (remark,) = (
            line for line in folder.remarks if "last digits may differ" in line
        )
    assert "Plan 9, 1 core" in remark


class Kept(pw.engines.Observer):
    """Keeps the progress."""

    def __init__(self) -> None:
        self.progress: list[pw.engines.Progress] = []

    def on_progress(self, progress: pw.engines.Progress) -> None:
        self.progress.append(progress)


@pytest.mark.parametrize("jobs", [1, 2])
def test_progress_names_the_cycle_and_never_falls(jobs):
    observer = Kept()
    scene = replace(UNTIL_KNOWN, cycles=6, replicates=2)
    with workers_of(scene, jobs, [observer]) as workers:
        run_stage(scene, observers=[observer], workers=workers)
    progress = observer.progress
    assert any(" of 6" in each.word for each in progress)
    parts = [each.part for each in progress]
    assert parts == sorted(parts)
