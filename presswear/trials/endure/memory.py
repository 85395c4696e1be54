"""Memory and files of long runs: ten times the cycles, the same peak."""

import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from presswear.trials.endure.subject import Progress
from presswear.trials.endure.trial import Trial

ALLOWED = 0.1
"""Part by which the longer run may take more."""
_PROGRAM = """
import resource, sys
from presswear.__main__ import main
code = main(sys.argv[1:])
print("peak", resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
sys.exit(code)
"""


@dataclass(frozen=True)
class Size:
    """Peak memory of a run, kB, and size of its stored arrays and checkpoints, bytes."""

    memory: int
    files: int


def size_of(engine: str, cycles: int) -> Size:
    """Run so many fast cycles of the press in a process of its own."""
    with tempfile.TemporaryDirectory() as place:
        out = Path(place) / "out"
        command = ["run", "wear-times", "--engine", engine, "--cycles", str(cycles), "--wears", "0"]
        quick = ["--set", "speed=60rad/s", "--set", "integration_tolerance=1e-6"]
        quick += ["--set", "tree_tolerance=1e-4"]
        done = subprocess.run(
            [sys.executable, "-c", _PROGRAM, *command, *quick, "--out", str(out)],
            capture_output=True,
            text=True,
            check=False,
        )
        found = re.search(r"^peak (\d+)$", done.stdout, re.MULTILINE)
        if done.returncode != 0 or found is None:
            raise RuntimeError(done.stderr.strip() or done.stdout.strip())
        return Size(int(found[1]), sum(file.stat().st_size for file in out.glob("*.npz")))


def bounded(engine: str, few: int, many: int, progress: Progress) -> Trial:
    """Whether many cycles take no more memory and files than few, within ALLOWED."""
    what = f"{many} cycles in the memory and files of {few}, {engine}"
    if sys.platform == "win32":
        return Trial(what, 0, 0, "not tried: this system does not tell")
    progress(what, 0.0)
    size_of(engine, 1)  # where nothing was compiled before, the compiler needs more than a run
    first = size_of(engine, few)
    progress(what, few / many)
    second = size_of(engine, many)
    memory, files = second.memory / first.memory, second.files / first.files
    survived = max(memory, files) <= 1.0 + ALLOWED
    note = (
        f"peak {first.memory / 1024:.0f} and {second.memory / 1024:.0f} MB ({memory:.3f}), "
        f"files {first.files / 1e6:.2f} and {second.files / 1e6:.2f} MB ({files:.3f})"
    )
    return Trial(what, 1, int(survived), note)
