"""Memory and files of long runs: ten times the cycles, the same peak."""

import re
import sys
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZipFile

import pytest

from endurance.subject import end, start_process
from endurance.trial import Trial

ALLOWED = 0.1  # Part by which the longer run may take more
# Time between two checkpoints, s. Both runs write checkpoints and continue from stored states.
# With the default of 60 s only a run of more than 15 s does, and these take 45 MB at any number
# of cycles.
CHECKPOINT = 0.2
# Prints the peak of its memory; ``getrusage`` would begin with the peak of its parent. A
# checkpoint takes some 30 MB, whatever the number of cycles, and the shorter run would end before
# the first.
_PROGRAM = """
import re, sys
from presswear.results import folder
folder.INTERVAL, folder.MIN_WAIT = 1.0, 1.0  # both runs write checkpoints
from presswear.__main__ import main
code = main(sys.argv[1:])
print("peak", re.search(r"VmHWM:\\s*(\\d+)", open("/proc/self/status").read())[1])
sys.exit(code)
"""


@dataclass(frozen=True)
class Size:
    """Peak memory of a run, kB, and size of its stored arrays and checkpoints, bytes.

    The size does not include the table that holds the numbers of each cycle.
    """

    memory: int
    files: int


def file_size(path: Path) -> int:
    with ZipFile(path) as file:
        return sum(i.compress_size for i in file.infolist() if i.filename != "cycles.npy")


def size_of(engine: str, cycles: int, out: Path) -> Size:
    """Run so many fast cycles of the press in a process of its own."""
    line = ["run", "wear-times", "--engine", engine, "--cycles", f"{cycles}", "--wear-updates", "0"]
    line += ["--checkpoint", f"{CHECKPOINT}"]
    quick = ("speed=60rad/s", "integration_tolerance=1e-6", "tree_tolerance=1e-4")
    settings = [f"--set={one}" for one in quick]
    answer = end(start_process(*line, *settings, "--out", str(out), program=_PROGRAM))
    assert answer.code == 0, answer.problem
    results = re.search(r"^peak (\d+)$", answer.output, re.MULTILINE)
    assert results is not None
    return Size(int(results[1]), sum(map(file_size, out.glob("*.npz"))))


def compare(trial: Trial, engine: str, few: int, many: int, place: Path) -> None:
    """Try whether many cycles take no more memory and files than few, within ALLOWED."""
    trial.title = f"{many} cycles in the memory and files of {few}, {engine}"
    # Where nothing was compiled before, the compiler needs more than a run.
    size_of(engine, 1, place / "compiled")
    first, second = (size_of(engine, cycles, place / f"{cycles}") for cycles in (few, many))
    memory, files = second.memory / first.memory, second.files / first.files
    trial.note = (
        f"peak {first.memory / 1024:.0f} and {second.memory / 1024:.0f} MB ({memory:.3f}), "
        f"files {first.files / 1e6:.2f} and {second.files / 1e6:.2f} MB ({files:.3f})"
    )
    is_bounded = max(memory, files) <= 1.0 + ALLOWED
    trial.add("" if is_bounded else f"more than {ALLOWED:.0%} apart: {trial.note}")


@pytest.mark.endurance
@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is read from Linux's /proc")
@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_ten_times_the_cycles(engine: str, trial: Trial, tmp_path: Path, is_quick: bool) -> None:
    few, many = (60, 600) if is_quick else (200, 2000)
    compare(trial, engine, few, many, tmp_path)
    assert trial.passed, trial.first_miss
