"""Memory and files of long runs: ten times the cycles, the same peak."""

import re
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

from endurance.subject import Trial, end, start_process

ALLOWED = 0.1  # part by which the longer run may take more
# Both runs write checkpoints and continue from stored states, whatever their length;
# their peak is printed, because ``getrusage`` would begin with the peak of the parent.
_PROGRAM = """
import re, sys
from presswear.results import folder
folder.INTERVAL = 1.0
from presswear.__main__ import main
code = main(sys.argv[1:])
print("peak", re.search(r"VmHWM:\\s*(\\d+)", open("/proc/self/status").read())[1])
sys.exit(code)
"""


def size_of(engine: str, cycles: int, out: Path) -> tuple[float, float]:
    """Run fast cycles of the press; return peak memory and size of arrays and checkpoints, MB.

    The size does not include the table that holds the numbers of each cycle.
    """
    line = f"run wear-times --engine {engine} --cycles {cycles} --wear-updates 0 --checkpoint 0.2"
    line += " --set=speed=60rad/s --set=integration_tolerance=1e-6 --set=tree_tolerance=1e-4"
    answer = end(start_process(*line.split(), "--out", str(out), program=_PROGRAM))
    assert answer.code == 0, answer.problem
    peak = re.search(r"^peak (\d+)$", answer.output, re.MULTILINE)
    assert peak is not None
    parts = [part for path in out.glob("*.npz") for part in ZipFile(path).infolist()]
    size = sum(part.compress_size for part in parts if part.filename != "cycles.npy")
    return int(peak[1]) / 1024.0, size / 1e6


@pytest.mark.endurance
@pytest.mark.skipif(
    sys.platform != "linux", reason="peak memory is read from Linux's /proc"
)
@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_ten_times_the_cycles(engine, trial: Trial, tmp_path, is_quick):
    cycles = 60 if is_quick else 200
    # The compiler takes more memory than a run: kernels are stored before.
    size_of(engine, 1, tmp_path / "compiled")
    short_memory, short_files = size_of(engine, cycles, tmp_path / "short")
    long_memory, long_files = size_of(engine, 10 * cycles, tmp_path / "long")
    memory_ratio = long_memory / short_memory
    files_ratio = long_files / short_files
    trial.note = (
        f"peak {short_memory:.0f} and {long_memory:.0f} MB ({memory_ratio:.3f}), "
        f"files {short_files:.2f} and {long_files:.2f} MB ({files_ratio:.3f})"
    )
    is_bounded = max(memory_ratio, files_ratio) <= 1.0 + ALLOWED
    trial.add("" if is_bounded else f"more than {ALLOWED:.0%} apart: {trial.note}")
    trial.check()
