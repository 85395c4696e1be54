"""Fresh installations: every Python found, newest and lowest dependencies, one table.

    python tests/installs.py [--tests] [PYTHON ...]

Builds the source archive and the wheel, the wheel once more from the source archive, and compares
what is in them. Installs the wheel into a new environment for each Python named or found on PATH,
with the newest dependencies, and for the oldest of them also with the lowest that pyproject.toml
allows. In each it runs a short scene and the published references; with --tests the tests as well.
Statistics must agree to nine digits, more than are printed anywhere. Exit code 1 on any failure.
Some minutes for each environment.
"""

import argparse
import hashlib
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
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
NAMES = ("python3.11", "python3.12", "python3.13", "python3.14")
SCENE = ("run", "wear-times", "--cycles", "2", "--wear-updates", "1", "--out", "out")
FAILED = "FAILED"
DIGITS = 1e-9  # relative difference allowed between two environments
PATIENCE = 3600.0  # wall time of a command, s


def run(*command: str | Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder, its output captured."""
    return subprocess.run(
        list(map(str, command)),
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )


def must(*command: str | Path, folder: Path) -> str:
    """Return the output of a command; end the script where it fails."""
    done = run(*command, folder=folder)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{done.stdout}{done.stderr}")
    return done.stdout


def environment(python: str, folder: Path) -> Path:
    """Make a new environment and return the folder of its commands."""
    must(python, "-m", "venv", folder, folder=ROOT)
    return folder / "bin"


def contents(wheel: Path) -> dict[str, str]:
    """Return the digest of each file of a wheel, but its list of digests."""
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if not name.endswith("RECORD")]
        return {name: hashlib.sha256(archive.read(name)).hexdigest() for name in names}


def build(folder: Path) -> Path:
    """Return the wheel, after source archive and wheels were compared."""
    commands = environment(sys.executable, folder / "build")
    must(commands / "pip", "install", "--quiet", "build", folder=ROOT)
    source = folder / "source"  # without what git does not track
    tracked = must("git", "ls-files", "-z", folder=ROOT).split("\0")
    for name in filter(None, tracked):
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, source / name)
    make = commands / "python", "-m", "build"
    must(*make, "--outdir", folder / "both", folder=source)
    must(*make, "--wheel", "--outdir", folder / "direct", folder=source)
    (archive,) = (folder / "both").glob("*.tar.gz")
    from_archive = "wheel", "--quiet", "--no-deps", "--wheel-dir", folder / "again", archive
    must(commands / "pip", *from_archive, folder=folder)
    wheels = [next((folder / name).glob("*.whl")) for name in ("both", "again", "direct")]
    first, *others = map(contents, wheels)
    if any(each != first for each in others):
        sys.exit("the wheels from the folder and from the source archive differ")
    needed = {name for name in tracked if name.startswith("presswear/")}
    if missing := needed - first.keys():
        sys.exit(f"the wheel lacks {', '.join(sorted(missing))}")
    print(f"wheel: {len(needed)} files of the package, the same from the source archive")
    return wheels[0]


def lowest() -> list[str]:
    """Return the lowest versions that pyproject.toml allows, each with its newest fixes."""
    extra = PROJECT["optional-dependencies"]["test"]
    return [re.sub(r">=(.*)", r"==\1.*", one) for one in (*PROJECT["dependencies"], *extra)]


def install_and_run(
    python: str, pins: list[str], wheel: Path, folder: Path, tests: bool
) -> tuple[dict[str, str], dict[str, float]]:
    """Return the cells of the table by column, and the statistics of the scene by place."""
    commands = environment(python, folder / "environment")
    must(commands / "pip", "install", "--quiet", f"{wheel}[test]", *pins, folder=folder)
    jobs: dict[str, tuple[str | Path, ...]] = {
        "scene": (commands / "presswear", *SCENE),
        "verify": (commands / "presswear", "verify"),
    }
    if tests:
        # From a folder without the package, which `python -m` would find before the installed one.
        words = ("-q", "-p", "no:cacheprovider", "-c", ROOT / "pyproject.toml", ROOT / "tests")
        jobs["tests"] = (commands / "pytest", *words)
    ended = {}
    for name, command in jobs.items():
        done = run(*command, folder=folder)
        ended[name] = (done.stdout.strip().splitlines() or [""])[-1].strip("= ")
        if done.returncode:
            ended[name] = FAILED
            print(done.stdout[-3000:], done.stderr[-3000:], sep="\n")
    numbers: dict[str, float] = {}
    packages = ""
    if ended["scene"] != FAILED:
        document = json.loads((folder / "out" / "result.json").read_text())
        numbers = dict(leaves([stage["statistics"] for stage in document["stages"]], ""))
        versions = document["provenance"]["packages"]
        packages = " ".join(f"{name} {versions[name]}" for name in ("numpy", "scipy", "numba"))
        ended["scene"] = "completed"
    cells = {
        "python": must(commands / "python", "--version", folder=folder).split()[1],
        "dependencies": "lowest" if pins else "newest",
        "packages": packages,
        "scene": ended["scene"],
        "verify": ended["verify"].partition(" within")[0],
        "tests": ended.get("tests", "-").partition(" in ")[0],
    }
    return cells, numbers


def leaves(owner: Any, place: str) -> Iterator[tuple[str, float]]:
    """Yield the numbers in nested data with their places."""
    if isinstance(owner, dict | list):
        for key, value in owner.items() if isinstance(owner, dict) else enumerate(owner):
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
    parser.add_argument("pythons", nargs="*", metavar="PYTHON", help="default: all on PATH")
    parser.add_argument("--tests", action="store_true", help="run the tests as well")
    arguments = parser.parse_args()
    pythons = arguments.pythons or [name for name in NAMES if shutil.which(name)]
    if not pythons:
        parser.error("no Python was found on PATH; name one")
    rows: list[tuple[dict[str, str], dict[str, float]]] = []
    with tempfile.TemporaryDirectory() as name:
        wheel = build(Path(name))
        for python, pins in [(pythons[0], lowest()), *((python, []) for python in pythons)]:
            print(f"{python}, {'lowest' if pins else 'newest'} dependencies ...", flush=True)
            with tempfile.TemporaryDirectory(dir=name) as folder:
                rows.append(install_and_run(python, pins, wheel, Path(folder), arguments.tests))
    differences = [difference(numbers, rows[0][1]) for _, numbers in rows]
    cells = [
        row | {"difference": f"{d:.0e}"} for (row, _), d in zip(rows, differences, strict=True)
    ]
    lines = [list(cells[0]), *(list(row.values()) for row in cells)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for line in lines:
        print("  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)))
    largest = max(differences)
    is_equal = largest <= DIGITS
    print(f"statistics {'agree' if is_equal else 'DIFFER'}: {largest:.0e}, allowed {DIGITS:g}")
    return 0 if is_equal and all(FAILED not in row.values() for row in cells) else 1


if __name__ == "__main__":
    sys.exit(main())
