"""Fresh installations: every Python found, newest and lowest dependencies, one table.

    python tests/installs.py [--tests] [PYTHON ...]

Builds the source archive and the wheel, the wheel once more from the source archive, and
compares what is in them.  Installs the wheel into a new environment for each Python given or
found on PATH, with the newest dependencies, and for the oldest of them also with the lowest that
pyproject.toml allows.  In each it runs a short scene and the published references; with --tests
the tests as well.  Statistics must agree to nine digits, more than are printed anywhere:
scipy's quantiles differ in the eleventh.  Exit code 1 on any failure.  Some minutes for each
environment.
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
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
NAMES = ("python3.11", "python3.12", "python3.13", "python3.14")
SCENE = ("run", "wear-times", "--cycles", "2", "--wear-updates", "1", "--out", "out")
FAILED = "FAILED"
DIGITS = 1e-9
"""Relative difference allowed between two environments."""
PATIENCE = 3600.0
"""Wall time of a command, s."""


@dataclass(frozen=True)
class Row:
    """What came of one environment.

    Attributes
    ----------
    cells : dict of str to str
        Of the table, by column.
    numbers : dict
        Statistics of the scene by their place in its result.
    """

    cells: dict[str, str]
    numbers: dict[str, float]


def run(*command: str | Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """A command in a folder, its output kept."""
    return subprocess.run(
        list(map(str, command)),
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )


def must(*command: str | Path, folder: Path) -> str:
    """Output of a command; ends the script where it fails."""
    found = run(*command, folder=folder)
    if found.returncode:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{found.stdout}{found.stderr}")
    return found.stdout


def environment(python: str, folder: Path) -> Path:
    """A new environment; gives the folder of its commands."""
    must(python, "-m", "venv", folder, folder=ROOT)
    return folder / "bin"


def contents(wheel: Path) -> dict[str, str]:
    """Digest of each file of a wheel, but its list of digests."""
    with zipfile.ZipFile(wheel) as archive:
        return {
            name: hashlib.sha256(archive.read(name)).hexdigest()
            for name in archive.namelist()
            if not name.endswith("RECORD")
        }


def build(folder: Path) -> Path:
    """The wheel, after source archive and wheels were compared."""
    commands = environment(sys.executable, folder / "build")
    must(commands / "pip", "install", "--quiet", "build", folder=ROOT)
    copy = folder / "source"
    # A copy: nothing is left behind, and what git does not know is not built.
    tracked = must("git", "ls-files", "-z", folder=ROOT).split("\0")
    for name in filter(None, tracked):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, copy / name)
    own = folder / "own"
    must(commands / "python", "-m", "build", "--outdir", own, folder=copy)
    (wheel,), (source,) = own.glob("*.whl"), own.glob("*.tar.gz")
    again = folder / "again"
    must(
        *(commands / "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", again, source),
        folder=folder,
    )
    direct = folder / "direct"
    must(commands / "python", "-m", "build", "--wheel", "--outdir", direct, folder=copy)
    wheels = [contents(one) for one in (wheel, *again.glob("*.whl"), *direct.glob("*.whl"))]
    if wheels[0] != wheels[1] or wheels[0] != wheels[2]:
        sys.exit("the wheels from the folder and from the source archive differ")
    needed = {name for name in tracked if name.startswith("presswear/")}
    if missing := needed - wheels[0].keys():
        sys.exit(f"the wheel lacks {', '.join(sorted(missing))}")
    print(f"wheel: {len(needed)} files of the package, the same from the source archive")
    return wheel


def lowest() -> list[str]:
    """The lowest versions that pyproject.toml allows, each with its newest fixes."""
    extra = PROJECT["optional-dependencies"]["test"]
    return [re.sub(r">=(.*)", r"==\1.*", one) for one in (*PROJECT["dependencies"], *extra)]


def tried(python: str, pins: list[str], wheel: Path, folder: Path, tests: bool) -> Row:
    """Install into a new environment and run."""
    commands = environment(python, folder / "environment")
    must(commands / "pip", "install", "--quiet", f"{wheel}[test]", *pins, folder=folder)
    ran = {
        "scene": run(commands / "presswear", *SCENE, folder=folder),
        "verify": run(commands / "presswear", "verify", folder=folder),
    }
    if tests:
        # From a folder without the package, which `python -m` would find before the installed one.
        words = ("-q", "-p", "no:cacheprovider", "-c", ROOT / "pyproject.toml", ROOT / "tests")
        ran["tests"] = run(commands / "pytest", *words, folder=folder)
    ended = {}
    for what, found in ran.items():
        ended[what] = (found.stdout.strip().splitlines() or [""])[-1].strip("= ")
        if found.returncode:
            ended[what] = FAILED
            print(found.stdout[-3000:], found.stderr[-3000:], sep="\n")
    numbers: dict[str, float] = {}
    packages = ""
    if ended["scene"] != FAILED:
        document = json.loads((folder / "out" / "result.json").read_text())
        numbers = dict(leaves([stage["statistics"] for stage in document["stages"]], ""))
        told = document["provenance"]["packages"]
        packages = " ".join(f"{name} {told[name]}" for name in ("numpy", "scipy", "numba"))
        ended["scene"] = "ran"
    cells = {
        "python": must(commands / "python", "--version", folder=folder).split()[1],
        "dependencies": "lowest" if pins else "newest",
        "packages": packages,
        "scene": ended["scene"],
        "verify": ended["verify"].partition(" within")[0],
        "tests": ended.get("tests", "-").partition(" in ")[0],
    }
    return Row(cells, numbers)


def leaves(owner: Any, place: str) -> Iterator[tuple[str, float]]:
    """Numbers in nested data, by their places."""
    if isinstance(owner, dict | list):
        for key, value in owner.items() if isinstance(owner, dict) else enumerate(owner):
            yield from leaves(value, f"{place}/{key}")
    elif owner is not None:
        yield place, float(owner)


def difference(here: dict[str, float], there: dict[str, float]) -> float:
    """Largest relative difference; infinite where one lacks what the other has."""
    if here.keys() != there.keys() or not here:
        return math.inf
    return max(
        abs(value - there[place]) / max(abs(value), abs(there[place]), 1e-300)
        for place, value in here.items()
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
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        wheel = build(folder)
        wanted = [(pythons[0], lowest()), *((python, []) for python in pythons)]
        rows = []
        for place, (python, pins) in enumerate(wanted):
            own = folder / f"run-{place}"
            own.mkdir()
            print(f"{python}, {'lowest' if pins else 'newest'} dependencies ...", flush=True)
            rows.append(tried(python, pins, wheel, own, arguments.tests))
            # Environments are large.
            shutil.rmtree(own)
    apart = [difference(row.numbers, rows[0].numbers) for row in rows]
    cells = [{**r.cells, "difference": f"{one:.0e}"} for r, one in zip(rows, apart, strict=True)]
    lines = [list(cells[0]), *(list(row.values()) for row in cells)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for line in lines:
        print("  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)))
    agree = max(apart) <= DIGITS
    print(f"statistics {'agree' if agree else 'DIFFER'}: {max(apart):.0e}, allowed {DIGITS:g}")
    failed = any(FAILED in row.cells.values() for row in rows)
    return 1 if failed or not agree else 0


if __name__ == "__main__":
    sys.exit(main())
