"""Service lives of surfaces that wear by a law in closed form."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from refusals import refused
from rich.console import Console
from scipy import stats

from campaign.fake_engine import (
    RATE,
    REPRESENTED,
    SCENE,
    SHAPE,
    FakeEngine,
    Seen,
    Stops,
    Use,
    exponential,
)
from presswear.campaign import runs
from presswear.cli import run_observer
from presswear.cli.run_observer import RunObserver
from presswear.cli.terminal import progress_bar
from presswear.linkage.materials import Materials
from presswear.recording.observer import Observer, Progress
from presswear.results.export import life_table
from presswear.results.result import load, unfinished
from presswear.results.stage import StageResult
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.options import Life
from presswear.scene.scene import Scene
from presswear.show.report import render_report

pytestmark = pytest.mark.usefixtures("unwatched")
LIMIT = 0.1e-3
UNTIL = Life(until=f"A.depth > {LIMIT!r} m")
LIFE = replace(
    SCENE,
    conventions=CONVENTIONS["refined"],
    life=UNTIL,
    wear_updates=1,
)
"""Joints that wear by ``exponential`` in equal replicates: only the steps have an error."""


def interrupted_life(path: Path, use: Use, number: int, tolerance: float) -> Scene:
    """Interrupt a life in a refinement; return its scene."""
    scene = replace(LIFE, tolerance=tolerance)
    use(FakeEngine(exponential))
    with pytest.raises(KeyboardInterrupt):
        runs.run(scene, path, observers=[Stops(f"refinement {number}")], jobs=1)
    return scene


def test_a_finished_refinement_gives_a_preliminary_life(use, tmp_path):
    """It is stored with its state, and reported, while the next refinement runs."""
    path = tmp_path / "life"
    scene = interrupted_life(path, use, 2, 0.1)
    result = load(path)
    life = result.life
    assert (life.ended, result.stages, life.step) == ("preliminary", (), None)
    exact = REPRESENTED * math.log(1.0 + LIMIT / (RATE * REPRESENTED))
    assert life.strokes == pytest.approx(exact, rel=0.1)
    state = "refinement 1 is finished and has an error of"
    assert state in f"{life}"
    assert "an unknown error of the wear steps; refinement 2 runs next" in f"{life}"
    assert "a preliminary life and 0 of 2 stages are stored" in unfinished(result)
    assert state in render_report(result)
    with refused("its life is preliminary, without curves"):
        life_table(result)
    finished = runs.run(scene, path, jobs=1).life
    assert finished.ended == "limit"
    # The deviations have the weight of the refinement in each life.
    first = replace(finished.refinements[0], deviations=life.refinements[0].deviations)
    assert first == life.refinements[0]


def test_a_looser_tolerance_resumes_a_life(use, tmp_path):
    """Refinements that meet it already give the life at once; a tighter one is refused."""
    path = tmp_path / "life"
    scene = interrupted_life(path, use, 3, 2e-3)
    with refused(r"tolerance is 0\.002 there and 0\.001 here"):
        runs.run(replace(scene, tolerance=1e-3), path, jobs=1)
    words = Seen()
    result = runs.run(replace(scene, tolerance=0.3), path, observers=[words], jobs=1)
    assert not any("refinement" in progress.word for progress in words.progress)
    assert (result.status, result.scene.tolerance) == ("completed", 0.3)
    assert result.life.ended == "limit"
    assert len(result.life.refinements) == 2
    assert 2e-3 < result.life.error < 0.3


@pytest.fixture(params=["y", "n"])
def answers(request, use, monkeypatch):
    """Return the answer to the one question before a life."""
    left = [request.param]
    use(FakeEngine(exponential))
    monkeypatch.setattr(run_observer, "LONG_LIFE", 0.0)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("builtins.input", lambda question: left.pop())
    yield request.param
    assert not left


def test_a_long_life_is_announced_and_confirmed(answers, tmp_path):
    console = Console(file=StringIO(), force_terminal=True, width=200)
    bar = progress_bar(console)
    scene = replace(LIFE, tolerance=0.1)
    watched = Noted(bar, scene, False)
    if answers == "n":
        with pytest.raises(KeyboardInterrupt):
            runs.run(scene, tmp_path / "life", observers=[watched], jobs=1)
        assert watched.cycles > 0.0
        return
    seen = Seen()
    life = runs.run(scene, observers=[watched, seen], jobs=1).life
    assert life is not None
    wholes = [progress.whole for progress in seen.progress]
    assert wholes == sorted(wholes)
    ran = sum(each.cycles for each in life.refinements)
    assert 0.5 < watched.cycles / ran < 2.0
    assert "cycles of all replicates" in console.file.getvalue()  # type: ignore[attr-defined]


class Noted(RunObserver):
    """Keeps the announced cycles."""

    cycles = 0.0

    def on_life_start(self, cycles: float, seconds: float) -> None:
        self.cycles = cycles
        super().on_life_start(cycles, seconds)

    def on_stage(self, stage: StageResult) -> None:
        """Ignore stages, because the fake engine has no statistics of a solver."""


def quick(until: str = UNTIL.until, **settings: Any) -> Scene:
    return replace(
        LIFE, life=Life(until=until, quick="on"), **{"cycles": None} | settings
    )


def test_a_quick_life_takes_two_rates(use, tmp_path):
    """dh/dN = a + b h: up to half of the limit at the rate a, then at the rate a + b h."""
    use(FakeEngine(exponential))
    path = tmp_path / "life"
    result = runs.run(quick(), path, jobs=1)
    assert (result.status, len(result.stages)) == ("completed", 2)
    life = load(path).life
    assert life == result.life
    assert (life.ended, life.step, life.error, life.refinements) == (
        "quick",
        None,
        None,
        (),
    )
    half = 0.5 * LIMIT
    rate = RATE * SHAPE[0].max()
    first = half / rate
    second = half / (rate + half / REPRESENTED)
    assert life.strokes == pytest.approx(first + second, rel=0.02)
    by_joint = [rate for rate in life.wear_rates if rate.joint == "A"]
    assert [rate.surfaces for rate in by_joint] == ["new", "worn once"]
    assert by_joint[0].until == by_joint[1].since == pytest.approx(first, rel=0.02)
    growth = 1.0 + half / (rate * REPRESENTED)
    assert by_joint[1].rate / by_joint[0].rate == pytest.approx(growth, rel=0.02)
    low, high = stats.lognorm.ppf((0.025, 0.975), math.sqrt(math.log(1.0 + 0.5**2)))
    assert math.exp(life.scatter) == pytest.approx(math.sqrt(high / low), rel=1e-12)
    assert f"{life}".startswith("quick life: ")
    assert "This life is quick, without an interval" in render_report(result)
    with refused("its life is quick, without curves"):
        life_table(result)


def test_a_quick_life_runs_two_short_stages(use):
    use(FakeEngine(exponential))
    result = runs.run(quick(replicates=3), jobs=1)
    assert [stage.statistics.cycles for stage in result.stages] == [30, 30]


def test_an_interrupted_quick_life_resumes(use, tmp_path):
    class StopsInTheSecondStage(Observer):
        def on_progress(self, progress: Progress) -> None:
            if progress.stage == 1:
                raise KeyboardInterrupt

    use(FakeEngine(exponential))
    whole = runs.run(quick(), jobs=1).life
    path = tmp_path / "life"
    with pytest.raises(KeyboardInterrupt):
        runs.run(quick(), path, observers=[StopsInTheSecondStage()], jobs=1)
    assert load(path).life is None
    assert runs.run(quick(), path, jobs=1).life == whole


@pytest.mark.parametrize(
    ("until", "settings", "message"),
    [
        (
            "bdc_drift > 1 mm",
            {},
            "until: bdc_drift: allowed are depth, wear_volume and tilt with",
        ),
        (
            "depth > 0.1 mm",
            {"wear_updates": 2},
            "wear_updates = 2: allowed is 1 with life.quick",
        ),
        (
            "depth > 0.1 mm",
            {"bearings": Bearing(materials=Materials(running_in=30.0))},
            "running_in = 30: allowed is 1 with life.quick",
        ),
    ],
)
def test_a_quick_life_of_other_limits_is_refused(until, settings, message):
    with refused(message):
        quick(until, **settings)
