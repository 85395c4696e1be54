"""Progress and summaries on the terminal."""

import io
import os
import pty
import re
import subprocess
import sys
import termios
from argparse import Namespace
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from python_process import python
from rich.console import Console
from rich.progress import Progress as ProgressBar

from presswear.cli import run_observer
from presswear.cli import several_runs as several_runs_module
from presswear.cli.run_observer import RunObserver, step_text
from presswear.cli.several_runs import several_runs
from presswear.cli.terminal import (
    load_result,
    named_progress,
    print_lines,
    print_table,
    progress_bar,
)
from presswear.recording.observer import COMPILING, Progress
from presswear.recording.settling import Settling
from presswear.recording.statistics import Estimate
from presswear.results.stage import StageResult
from presswear.results.stage_statistics import JointStatistics, StageStatistics
from presswear.scene.catalog import wear_times

SCENE = replace(wear_times(), engine="dae", wear_updates=2)


class Clock:
    now = 100.0

    def perf_counter(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(run_observer, "clock", clock)
    return clock


def console_of(width: int, clock: Clock, is_terminal: bool = True) -> Console:
    look: dict[str, Any] = {
        "force_terminal": is_terminal,
        "legacy_windows": False,
        "record": True,
    }
    return Console(width=width, file=io.StringIO(), get_time=clock.perf_counter, **look)


def stage_of(statistics: StageStatistics, simulated: float, wall: float) -> StageResult:
    model: Any = {"model": "an open tree", "solver": "DOPRI5"}
    return StageResult(
        0, "completed", "", None, 1e6, (), simulated, wall, model, statistics
    )


def lines_of(bar: ProgressBar, width: int, clock: Clock) -> list[str]:
    console = console_of(width, clock)
    console.print(bar.make_tasks_table(bar.tasks))
    return console.export_text().splitlines()


@pytest.mark.parametrize("width", [48, 120])
def test_bar_and_remaining_time_fit_at_any_width(width, clock):
    bar = progress_bar(console_of(width, clock))
    long = "applying the seventh wear in 200 steps, cycle 151 of 163"
    tasks = [bar.add_task(words, total=1.0) for words in (long, long.upper(), "short")]
    for _ in range(4):
        clock.now += 10.0
        for task in tasks:
            bar.advance(task, 0.1)
    lines = lines_of(bar, width, clock)
    assert all(len(line) <= width for line in lines)
    # Nothing is cut, and 0.4 in 40 s leave a minute.
    text = " ".join(re.sub(r"[━╸╺]+ +40% +60 s left", "", " ".join(lines)).split())
    assert sorted(text.split()) == sorted(f"{long} {long.upper()} short".split())


def in_terminal(words: list[str], folder: Path) -> str:
    """Return what Python writes to a pseudo-terminal.

    It has 70 columns, because the time left of a short run is shorter than "12.7
    minutes left".
    """
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(theirs, (24, 70))
    streams: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), theirs)
    environment = {
        k: v for k, v in os.environ.items() if k not in ("COLUMNS", "NO_COLOR")
    }
    environment |= {"TERM": "xterm"}
    command = [sys.executable, *words]
    with subprocess.Popen(command, cwd=folder, env=environment, **streams) as process:
        os.close(theirs)
        output = b""
        with suppress(OSError):  # the other end is closed
            while part := os.read(ours, 65536):
                output += part
    os.close(ours)
    assert process.returncode == 0, output
    return output.decode()


def test_a_run_of_python_shows_its_progress_in_a_terminal_alone(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import presswear as pw\nfrom presswear.cli import run_observer\n"
        "run_observer.BAR_DELAY = 0.0\n"
        "if __name__ == '__main__':\n"
        "    pw.run(pw.scenes.ideal(cycles=2, engine='dae'), jobs=1)\n    print('end')\n"
    )
    assert "no wear: cycle " in in_terminal([f"{script}"], tmp_path)
    done = python(script, check=True)
    assert (done.stdout, done.stderr) == ("end\n", "")


def test_several_runs_are_counted_in_one_line(tmp_path, clock):
    console = console_of(80, clock)
    with several_runs(console, "improve", tmp_path, 2) as (show, _):
        show(
            "bush replaced_ A@2500000, B@4000000",
            0.5,
            "applying the first wear in 128 steps",
        )
        show("plain", 1.0, "completed")
    assert "finished plain: completed" in (text := console.export_text())
    assert "improve: 1 of 2 finished " in text.splitlines()[-1]


def test_time_left_of_several_runs_is_that_of_the_longest(tmp_path, clock, monkeypatch):
    """The short run has 100 s left at the mean speed, the long one 300 s."""
    monkeypatch.setattr(several_runs_module, "clock", clock)
    console = console_of(80, clock, is_terminal=False)
    with several_runs(console, "lives", tmp_path, 2) as (show, _):
        show("short", 0.0, "")
        show("long", 0.0, "")
        clock.now += 100.0
        show("short", 0.999, "cycle 5 of 5")
        clock.now += 100.0
        show("long", 0.4, "cycle 2 of 5")
    lines = [line for line in console.export_text().splitlines() if line]
    assert lines[-1].endswith("70 % 5 minutes left")


def test_steps_are_described():
    words = "cycle 3 of 5"
    assert step_text(SCENE, 0, "") == "no wear"
    assert step_text(SCENE, 0, words) == f"no wear: {words}"
    update = "first wear in 12 steps"
    assert step_text(SCENE, 0, update) == f"applying the {update}"
    assert step_text(SCENE, 1, words) == f"after the first wear: {words}"
    assert (
        step_text(SCENE, 0, "life, refinement 1, 2 strokes")
        == "life, refinement 1, 2 strokes"
    )


def test_compile_time_is_shown_and_not_counted(clock):
    stage = stage_of(StageStatistics(cycles=1), 2.0, 30.0)
    console = console_of(120, clock)
    bar = progress_bar(console)
    observer = RunObserver(bar, SCENE)
    for _ in range(3):
        observer.on_progress(Progress(0, 0.0, 0.0, COMPILING))
        clock.now += 8.0
        assert lines_of(bar, 80, clock)[0].startswith("compiling")
    observer.on_progress(Progress(0, 0.1, 0.1, ""))
    assert lines_of(bar, 80, clock)[0].startswith("no wear")
    observer.on_stage(stage)
    assert (
        "1 cycle of all replicates, 3.00 s per simulated second"
        in console.export_text()
    )
    observer.on_progress(Progress(0, 0.0, 0.0, COMPILING))
    clock.now += 8.0
    observer.on_progress(Progress(0, 0.2, 0.2, "first wear in 8 steps"))
    observer.on_stage(stage)
    assert "15.00 s per simulated second" in console.export_text()


def test_a_stage_says_whether_its_motion_has_settled(clock):
    """An interval of an irregular motion never stands alone, and neither does a stage in Python."""
    console = console_of(120, clock)
    settling = Settling(watched=22, starts=(None,) * 4, motions=())
    stage = stage_of(StageStatistics(cycles=88, settling=settling), 2.0, 30.0)
    RunObserver(progress_bar(console), SCENE).on_stage(stage)
    line = "motion: not settled, irregular in 4 runs of 22 strokes"
    assert line in console.export_text()
    assert line in f"{stage}"


def test_a_line_a_minute_shows_the_progress_without_a_terminal(clock):
    console = console_of(80, clock, is_terminal=False)
    observer = RunObserver(progress_bar(console), SCENE)
    for k in range(1, 13):
        clock.now += 10.5
        observer.on_progress(Progress(0, 0.04 * k, 0.04 * k, "cycle 2 of 5"))
    assert console.export_text().splitlines() == [
        "no wear: cycle 2 of 5, 24 % 3.33 minutes left",
        "no wear: cycle 2 of 5, 48 % 2.27 minutes left",
    ]


def test_time_left_of_a_resumed_run_is_by_its_latest_estimate(clock):
    """The quarter from the first report took 20 s; by the estimate a half is left."""
    bar = progress_bar(console_of(80, clock))
    observer = RunObserver(bar, SCENE)
    for whole, estimate in ((0.6, 0.25), (0.9, 0.5)):
        clock.now += 20.0
        observer.on_progress(Progress(0, whole, whole, "", estimate))
    assert lines_of(bar, 80, clock)[0].endswith("90% 40 s left")


def test_lines_of_a_stage_are_few_and_whole(clock):
    """Of many joints the three with the largest values, a line each, and what the bins change."""
    joints = {}
    some = Estimate(1.0)
    for k, name in enumerate("ABCDEFG"):
        force = Estimate.symmetric(1e3 * k, 20.0)
        volume = Estimate.symmetric(1e-9 * k, 1e-10)
        joints[name] = JointStatistics(
            1.0, force, 1, some, 0, None, 0.0, some, volume, None, None, (), {}
        )
    console = console_of(80, clock)
    stage = stage_of(StageStatistics(cycles=5, joints=joints), 1.0, 1.0)
    RunObserver(progress_bar(console), SCENE).on_stage(stage)
    lines = console.export_text().splitlines()
    assert len(lines) == 4
    assert all(len(line) <= 80 for line in lines)
    assert re.sub(r"\s", " ", lines[1]).endswith("F 5 000 ± 20, E 4 000 ± 20, 4 more")
    assert re.sub(r"\s", " ", lines[2]).endswith("F 5.00 ± 0.10, E 4.00 ± 0.10, 4 more")
    assert lines[3].strip() == "(bins of 1°; twice as many bins halve it)"


def test_a_signal_that_a_computation_swallows_stops_it_at_its_next_progress(
    monkeypatch,
):
    """Exudyn, and numba while it compiles, may drop KeyboardInterrupt."""
    with named_progress(Console(quiet=True), "benchmark") as report:
        report("first", 0.1)
        monkeypatch.setattr("presswear.tools.processes._received", [2])
        with pytest.raises(KeyboardInterrupt):
            report("second", 0.2)


def test_control_characters_are_escaped(clock):
    console = console_of(80, clock)
    print_lines(console, "a\x1b[2Jb")
    print_table(console, ["name"], [["c\x1b[2Jd"]])
    text = console.export_text(styles=True)
    assert r"a\x1b[2Jb" in text
    assert r"c\x1b[2Jd" in text


def test_names_are_no_markup(clock, monkeypatch):
    result: Any = Namespace(stages=["first"])
    monkeypatch.setattr("presswear.results.result.load", lambda _path: result)
    monkeypatch.setattr(
        "presswear.results.result.unfinished", lambda _: "the run in a[/red]b"
    )
    console = console_of(80, clock)
    assert load_result(Path(), console) is result
    assert "a[/red]b: only these are used" in console.export_text()
    bar = progress_bar(console)
    bar.add_task("a[/red]b")
    assert lines_of(bar, 80, clock)[0].startswith("a[/red]b")


def test_a_life_of_many_cycles_names_the_quick_one():
    """560 cycles are those to 0.05 mm in press-blanking."""
    assert "--quick" not in run_observer.least_needed(560.0)
    words = run_observer.least_needed(24_064.0)
    assert words.startswith("needs at least about 20\u202f000 cycles of all replicates")
    assert "`presswear life --quick` estimates the strokes to a depth" in words
