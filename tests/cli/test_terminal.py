"""What a terminal shows while something runs, at any width."""

import io
import re
from collections.abc import Callable
from dataclasses import replace

import pytest
from rich.console import Console
from rich.progress import Progress as Bar

from presswear.cli import running, terminal
from presswear.cli.running import Terminal, step_of
from presswear.cli.terminal import Foretold, progress_bar
from presswear.linkage.linkage import Linkage
from presswear.recording.observer import Progress
from presswear.results.stage import StageResult, StageStatistics
from presswear.scene.catalog import wear_times

SCENE = replace(wear_times(), engine="dae", wear_updates=2)


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now

    perf_counter = __call__


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    found = Clock()
    monkeypatch.setattr(terminal, "clock", found)
    monkeypatch.setattr(running, "clock", found)
    return found


def console_of(width: int, clock: Callable[[], float]) -> Console:
    return Console(
        width=width,
        force_terminal=True,
        file=io.StringIO(),
        record=True,
        get_time=clock,
        legacy_windows=False,
    )


def shown(bar: Bar, width: int, clock: Callable[[], float]) -> list[str]:
    """The lines of a progress bar, without colours, as they stand in a terminal."""
    console = Console(width=width, file=io.StringIO(), record=True, get_time=clock)
    console.print(bar.make_tasks_table(bar.tasks))
    return console.export_text().splitlines()


@pytest.mark.parametrize("width", [40, 41, 48, 60, 69, 70, 80, 120, 200])
def test_bar_and_time_left_are_there_at_any_width(width: int, clock: Clock) -> None:
    bar = progress_bar(console_of(width, clock))
    long = "applying the first wear in 200 steps, cycles 151 to 163 of 4 starts"
    tasks = [bar.add_task(words, total=1.0) for words in (long, long.upper(), "short")]
    for _ in range(4):
        clock.now += 10.0
        for task in tasks:
            bar.advance(task, 0.1)
    lines = shown(bar, width, clock)
    assert len(lines) == len(tasks)
    for line, first in zip(lines, ("appl", "APPL", "short"), strict=True):
        # 0.4 in 40 s: a minute is left.
        assert re.match(rf"{first}.*? [━╸]{{3,}}[━╸╺ ]{{4,}} 40% .*left 0:01:00 *$", line), line
        assert len(line) <= width
        assert ("0:00:40" in line) == (width >= 70)


def progress(stage: int, whole: float, word: str) -> Progress:
    linkage: Linkage = SCENE.linkage()
    return Progress(stage, whole, whole, word, linkage)


def test_a_step_is_named_in_plain_words() -> None:
    words = "cycles 3 to 5 of 4 starts"
    assert step_of(SCENE, 0, "") == "no wear"
    assert step_of(SCENE, 0, words) == f"no wear: {words}"
    assert step_of(SCENE, 0, f"first wear in 12 steps, {words}") == (
        f"applying the first wear in 12 steps, {words}"
    )
    assert step_of(SCENE, 1, words) == f"after the first wear: {words}"
    assert step_of(SCENE, 1, "second wear in 3 steps") == "applying the second wear in 3 steps"
    assert step_of(SCENE, 0, f"life, pass 1, {words}") == f"life, pass 1, {words}"


def test_compiling_is_said_and_is_no_speed(clock: Clock) -> None:
    diagnostics: dict[str, str | int | float | None] = {
        "model": "an open tree",
        "solver": "DOPRI5",
        "steps": 10,
        "wall_prepare_s": 0.0,
    }
    stage = StageResult(
        0, "completed", "", None, 1.0, (), 2.0, 30.0, diagnostics, StageStatistics(cycles=1)
    )
    console = console_of(120, clock)
    bar = progress_bar(console)
    told = Terminal(bar, SCENE)
    for _ in range(3):
        told.on_compile()
        clock.now += 8.0
        assert shown(bar, 80, clock)[0].startswith("compiling")
    told.on_progress(progress(0, 0.1, ""))
    assert shown(bar, 80, clock)[0].startswith("no wear")
    told.on_stage(stage)
    assert "3.00 s per simulated second" in console.export_text()
    told.on_stage(stage)
    assert "15.00 s per simulated second" in console.export_text()
    told.on_compile()
    clock.now += 8.0
    told.on_progress(progress(0, 0.2, "first wear in 8 steps"))
    told.on_stage(stage)
    assert "15.00 s per simulated second" in console.export_text()


def test_how_long_it_takes_is_said_once_it_shows(clock: Clock) -> None:
    said: list[str] = []
    told = Foretold(said.append, "it")
    told.hear(0.0)
    clock.now += 1000.0
    told.wait()  # for the compiler
    told.hear(0.1)  # as of a run that is gone on with
    clock.now += 4.0
    told.hear(0.12)
    assert not said
    clock.now += 5.0
    for _ in range(2):
        told.hear(0.13)  # 0.03 in 9 s, so that 0.9 takes 270 s
        assert said == ["it takes about 4.5 minutes"]
    quick = Foretold(said.append, "it")
    quick.hear(0.0)
    clock.now += 6.0
    quick.hear(0.5)
    assert len(said) == 1


def test_each_stage_says_how_long_it_takes(clock: Clock) -> None:
    """Of the whole nothing is known before: worn surfaces take longer."""
    console = console_of(100, clock)
    told = Terminal(progress_bar(console), SCENE)
    for stage, part in ((0, 0.1), (0, 0.2), (1, 0.5), (1, 0.6), (2, 0.0), (2, 0.1)):
        told.on_progress(progress(stage, part, ""))
        clock.now += 20.0
    lines = [line.rstrip() for line in console.export_text().splitlines()]
    assert lines == [
        "stage 0, no wear, takes about 3 minutes; 2 more on worn surfaces follow",
        "stage 1, after the first wear, takes about 1.67 minutes; 1 more on worn surfaces follows",
        "stage 2, after the second wear, takes about 3.33 minutes",
    ]
