"""Rows as files: claims, resuming, killed sweeps and executors."""
# mypy: disable-error-code="union-attr"

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from python_process import python
from refusals import refused

import presswear as pw
from presswear.sweeps import runner
from presswear.sweeps.response_readers import Response
from presswear.sweeps.responses import request
from presswear.sweeps.sweep import load_sweep
from presswear.tools.errors import InputError, RunFailed

SCENE = pw.scenes.slider_crank(engine="dae", cycles=1, wear_updates=0, replicates=1)
REQUESTED = request(SCENE, ["bdc_error"])
NAMES = {f"{k}": lambda: SCENE for k in range(4)}


class Counting(runner.SerialExecutor):
    """Executor that stores a made-up outcome, and interrupts the sweep after ``limit`` rows."""

    def __init__(self, limit: int = 100) -> None:
        self.count = 0
        self.limit = limit

    def submit(
        self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any
    ) -> Future[Any]:
        if self.count == self.limit:
            raise KeyboardInterrupt
        self.count += 1
        values = {"bdc_error": Response(1.5, None, True)}
        future: Future[Any] = Future()
        future.set_result(runner.Outcome(values, "", 2.0))
        return future


def rows_in(folder: Path) -> dict[str, int]:
    """Times at which the rows of a folder were written, ns, by their names."""
    times = {}
    for file in (folder / "rows").glob("*.json"):
        times[file.stem] = file.stat().st_mtime_ns
    return times


def test_stored_rows_do_not_run_again(tmp_path):
    first = Counting(3)
    second = Counting()
    with pytest.raises(KeyboardInterrupt):
        runner.run_rows(tmp_path, NAMES, REQUESTED, first, 1)
    stored = rows_in(tmp_path)
    assert len(stored) == 3  # no claim is left
    reports: list[runner.Progress] = []
    runner.run_rows(tmp_path, NAMES, REQUESTED, second, 1, on_progress=reports.append)
    assert second.count == 1
    assert stored.items() <= rows_in(tmp_path).items()
    assert reports[0] == runner.Progress(4, 3, 0, 1, 2.0)
    assert reports[-1].done == 4
    outcome = runner.read_row(tmp_path, "0")
    assert outcome.values["bdc_error"] == Response(1.5, None, True)


def test_empty_and_damaged_rows_run_again(tmp_path):
    runner.run_rows(tmp_path, NAMES, REQUESTED, Counting(), 1)
    for name, text in (("0", ""), ("1", '{"values": {'), ("2", '{"seconds": "x"}')):
        (tmp_path / "rows" / f"{name}.json").write_text(text)
        assert runner.read_row(tmp_path, name) is None
    again = Counting()
    runner.run_rows(tmp_path, NAMES, REQUESTED, again, 1)
    assert again.count == 3


def test_a_failed_row_is_stored_and_a_failed_executor_is_not(tmp_path):
    def impossible() -> pw.Scene:
        raise InputError("no such linkage")

    executor = Counting()
    runner.run_rows(
        tmp_path, {"a": impossible, "b": lambda: SCENE}, REQUESTED, executor, 1
    )
    assert executor.count == 1
    outcome = runner.read_row(tmp_path, "a")
    assert outcome.error == "no such linkage"

    broken = Counting()
    future = Future[Any]()
    future.set_exception(MemoryError())
    broken.submit = lambda *args, **kwargs: future  # type: ignore[method-assign]
    with pytest.raises(RunFailed, match="the executor failed"):
        runner.run_rows(tmp_path, NAMES, REQUESTED, broken, 1)
    assert set(rows_in(tmp_path)) == {"a", "b"}


def test_another_program_is_refused():
    with refused("another program"):
        runner.run_row(SCENE, REQUESTED, None, "this")


SWEEP = (
    "sweep slider-crank --engine dae --cycles 3 --set wear_updates=0 --set replicates=1 "
    "--vary clearance=0.1mm:0.5mm:8 --response bdc_error"
)


def command_line(words: str) -> list[str]:
    return [sys.executable, "-m", "presswear", *words.split()]


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_sweep_loses_only_the_running_rows(number, tmp_path, command):
    folder = tmp_path / "sweep"
    line = command_line(f"{SWEEP} --out {folder} --jobs 2")
    with subprocess.Popen(
        line, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as process:
        deadline = time.monotonic() + 120.0
        while not any(file.stat().st_size for file in folder.glob("rows/*.json")):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.02)
        os.kill(process.pid, number)
        process.wait(30.0)
        errors = process.stderr.read().decode()
    if number != signal.SIGKILL:
        assert "all finished runs are stored; continue with" in errors
    times = rows_in(folder)
    stored = {name: times[name] for name in times if runner.read_row(folder, name)}
    assert stored
    command(f"sweep slider-crank --resume --out {folder} --jobs 1")
    assert stored.items() <= rows_in(folder).items()
    assert np.isfinite(load_sweep(folder).table.values).all()
    assert json.loads((folder / "sweep.json").read_text())["schema"] == 2


def test_parts_that_start_together_share_a_folder(tmp_path):
    folder = tmp_path / "sweep"
    line = f"{SWEEP} --out {folder} --jobs 1 --shard"
    parts = [subprocess.Popen(command_line(f"{line} {k}/2")) for k in (1, 2)]
    assert [part.wait() for part in parts] == [0, 0]
    assert np.isfinite(load_sweep(folder).table.values).all()


NOTEBOOK = """
import sys
import presswear as pw

def peak(result):
    return result.stages[-1].joints["B"].force.max()

def wrong(result):
    raise KeyError("no such number")

scene = pw.scenes.slider_crank(engine="dae", cycles=1, wear_updates=0, replicates=1)
vary = {"clearance": ["0.4 mm", "0.5 mm"]}
sweep = pw.sweep(scene, vary, sys.argv[1] + "/good", [peak, "B.force_max"], jobs=2)
assert (sweep.table.values > 0.0).all(), sweep.table
again = pw.sweep(scene, vary, sys.argv[1] + "/bad", [wrong], jobs=2)
print(again.table.errors)
"""


def test_functions_of_a_notebook_are_responses(tmp_path):
    """They run in the parent, because workers cannot import the main module of a notebook."""
    program = python("-c", NOTEBOOK, tmp_path, timeout=600)
    assert program.returncode == 0, program.stderr
    assert program.stdout.count("KeyError: 'no such number'") == 2
    assert not list((tmp_path / "good" / "runs").iterdir())  # keep = responses
