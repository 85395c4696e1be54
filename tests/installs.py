"""Fresh installations: every Python found, newest and lowest dependencies, one table.

    python tests/installs.py [--tests] [PYTHON ...]

Builds the source archive and from it the wheel, and installs the wheel into a new
environment for each Python named or found on PATH, with the newest dependencies, and
for the oldest of them also with the lowest that pyproject.toml allows. In each it runs
a short scene and the published references; with --tests the tests as well. Statistics
must agree to nine digits, more than are printed anywhere. Exit code 1 on any failure.
Some minutes for each environment.
"""

import argparse
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())[
    "project"
]
PYTHONS = ("python3.11", "python3.12", "python3.13", "python3.14")
SCENE = ["run", "wear-times", "--cycles", "2", "--wear-updates", "1", "--out", "out"]
DIGITS = 1e-9  # relative difference allowed between two environments
PATIENCE = 3600.0  # wall time of a command, s


def run(*command: str | Path, folder: Path = ROOT) -> tuple[str, bool]:
    """Return the last line that a command prints in a folder, and whether it succeeded."""
    words = list(map(str, command))
    done = subprocess.run(
        words, cwd=folder, capture_output=True, text=True, timeout=PATIENCE
    )
    if done.returncode:
        print(*words, done.stdout[-3000:], done.stderr[-3000:], sep="\n")
    return (done.stdout.strip().splitlines() or [""])[-1].strip(
        "= "
    ), done.returncode == 0


def must(*command: str | Path) -> str:
    """Return the last line that a command prints; end the script where it fails."""
    text, succeeded = run(*command)
    return text if succeeded else sys.exit(1)


def build(folder: Path) -> Path:
    """Return the wheel, with all files of the package that git tracks."""
    must(sys.executable, "-m", "venv", folder / "build")
    must(folder / "build" / "bin" / "pip", "install", "--quiet", "build")
    source = folder / "source"
    must("git", "clone", "--quiet", ROOT, source)
    must(folder / "build" / "bin" / "python", "-m", "build", "--outdir", folder, source)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        files = {
            file.relative_to(source).as_posix()
            for file in source.glob("presswear/**/*.*")
        }
        if missing := files - set(archive.namelist()):
            sys.exit(f"the wheel lacks {', '.join(sorted(missing))}")
    return wheel


def install_and_run(
    python: str, pins: list[str], wheel: Path, folder: Path, tests: bool
) -> tuple[dict[str, str], dict[str, float]]:
    """Return the cells of the table by column, and the statistics of the scene by place."""
    must(python, "-m", "venv", folder / "environment")
    commands = folder / "environment" / "bin"
    must(commands / "pip", "install", "--quiet", f"{wheel}[test]", *pins)
    jobs: dict[str, tuple[str | Path, ...]] = {
        "scene": (commands / "presswear", *SCENE),
        "verify": (commands / "presswear", "verify"),
    }
    if tests:
        # From a folder without the package, which `python -m` would find before the
        # installed one.
        words = (
            "-q",
            "-p",
            "no:cacheprovider",
            "-c",
            ROOT / "pyproject.toml",
            ROOT / "tests",
        )
        jobs["tests"] = (commands / "pytest", *words)
    cells = {"python": must(commands / "python", "--version").split()[1]}
    cells |= {"dependencies": "lowest" if pins else "newest", "packages": ""}
    numbers: dict[str, float] = {}
    for name, command in jobs.items():
        text, succeeded = run(*command, folder=folder)
        cells[name] = (
            text.partition(" in ")[0].partition(" within")[0] if succeeded else "FAILED"
        )
    if cells["scene"] != "FAILED":
        document = json.loads((folder / "out" / "result.json").read_text())
        numbers = dict(
            leaves([stage["statistics"] for stage in document["stages"]], "")
        )
        versions = document["provenance"]["packages"]
        cells["scene"] = "completed"
        cells["packages"] = " ".join(
            f"{n} {versions[n]}" for n in ("numpy", "scipy", "numba")
        )
    return cells, numbers


def leaves(owner: Any, place: str) -> Iterator[tuple[str, float]]:
    """Yield the numbers in nested data with their places."""
    if isinstance(owner, dict | list):
        for key, value in (
            owner.items() if isinstance(owner, dict) else enumerate(owner)
        ):
            yield from leaves(value, f"{place}/{key}")
    elif owner is not None:
        yield place, float(owner)


def difference(first: dict[str, float], second: dict[str, float]) -> float:
    """Return the largest relative difference; infinite where the names differ."""
    if first.keys() != second.keys() or not first:
        return math.inf
    return max(
        abs(value - second[place]) / max(abs(value), abs(second[place]), 1e-300)
        for place, value in first.items()
    )


def main() -> int:
    """Build, install, run, print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "pythons", nargs="*", metavar="PYTHON", help="default: all on PATH"
    )
    parser.add_argument("--tests", action="store_true", help="run the tests as well")
    arguments = parser.parse_args()
    pythons = arguments.pythons or list(filter(shutil.which, PYTHONS))
    # The lowest versions that pyproject.toml allows, each with its newest fixes.
    needed = (*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["test"])
    lowest = [re.sub(r">=(.*)", r"==\1.*", requirement) for requirement in needed]
    rows: list[tuple[dict[str, str], dict[str, float]]] = []
    with tempfile.TemporaryDirectory() as name:
        wheel = build(Path(name))
        for python, pins in [
            (pythons[0], lowest),
            *((python, []) for python in pythons),
        ]:
            print(
                f"{python}, {'lowest' if pins else 'newest'} dependencies ...",
                flush=True,
            )
            with tempfile.TemporaryDirectory(dir=name) as folder:
                rows.append(
                    install_and_run(python, pins, wheel, Path(folder), arguments.tests)
                )
    largest = 0.0
    for k, (cells, numbers) in enumerate(rows):
        apart = difference(numbers, rows[0][1])
        largest = max(largest, apart)
        if k == 0:
            print(" | ".join([*cells, "difference"]))
        print(" | ".join([*cells.values(), f"{apart:.0e}"]))
    is_equal = largest <= DIGITS
    print(
        f"statistics {'agree' if is_equal else 'DIFFER'}: {largest:.0e}, allowed {DIGITS:g}"
    )
    return (
        0
        if is_equal and all("FAILED" not in cells.values() for cells, _ in rows)
        else 1
    )


if __name__ == "__main__":
    sys.exit(main())
