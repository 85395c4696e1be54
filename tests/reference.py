"""Digests of what the program computes, to be compared bit for bit before and after a change.

    python tests/reference.py              compare with what is stored
    python tests/reference.py --write      store anew, after a change that says why
    python tests/reference.py tree dae     some of the cases, by parts of their names

Runs scenes through all engines by the command line and reads their folders as any program
could, so that nothing inside the package has to stay what it is.  The last digits belong to a
processor, its mathematical library and the versions that are stored beside them.
"""

import argparse
import hashlib
import json
import platform
import runpy
import sys
import tempfile
import time
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from presswear.__main__ import main as presswear

FILE = Path(__file__).with_suffix(".json")

TREE, JOINTS, DAE = "exudyn-tree", "exudyn-joints", "dae"
STEPS = ("--conventions", "refined", "--set", "extrapolation=steps", "--set", "replicates=2")
ONE = ("--set", "replicates=1")
RUNAWAY = ("scenarios/runaway.py",)
CASES: dict[str, tuple[str, ...]] = {
    "tree unworn": ("wear-times", "--engine", TREE, "--wear-updates", "0", "--cycles", "3"),
    "tree worn paper": (
        "wear-times",
        "--engine",
        TREE,
        "--wear-updates",
        "2",
        "--cycles",
        "4",
        *ONE,
    ),
    "tree worn refined": (
        "wear-times",
        "--engine",
        TREE,
        "--wear-updates",
        "1",
        "--cycles",
        "2",
        *STEPS,
    ),
    "tree starts": (
        *("friction", "--engine", TREE, "--wear-updates", "1", "--cycles", "4"),
        *("--set", "replicates=3", "--set", "drive_torque=on"),
    ),
    "tree until known": (
        "speed",
        "--engine",
        TREE,
        "--wear-updates",
        "1",
        "--tolerance",
        "0.3",
        *ONE,
    ),
    "tree C": (
        *("clearance-c", "--wear-updates", "1", "--cycles", "1", "--conventions", "refined"),
        *("--set", "extrapolation=single", "--set", "angles=36", "--set", "drive_torque=on", *ONE),
    ),
    "tree loose rod": ("slider-crank", "--set", "joints=AB", "--engine", TREE, "--cycles", "2"),
    "tree slider-crank": ("slider-crank", "--engine", TREE, "--cycles", "4"),
    "joints ideal": ("ideal", "--set", "drive_torque=on"),
    "joints A": (
        *("clearance-a", "--wear-updates", "1", "--cycles", "1", "--set", "drive_torque=on", *ONE),
    ),
    "joints C": (
        *("clearance-c", "--engine", JOINTS, "--wear-updates", "0", "--cycles", "1"),
        *("--set", "drive_torque=on"),
    ),
    "joints A and C": (
        *("speed-8pi", "--engine", JOINTS, "--wear-updates", "0", "--cycles", "1"),
        *("--set", "replicates=2"),
    ),
    "joints slider-crank": ("slider-crank", "--engine", JOINTS, "--cycles", "2"),
    "dae ideal": ("ideal", "--engine", DAE, "--set", "drive_torque=on"),
    "dae unworn": ("wear-times", "--engine", DAE, "--wear-updates", "0", "--cycles", "4"),
    "dae worn paper": ("wear-times", "--engine", DAE, "--wear-updates", "2", "--cycles", "6", *ONE),
    "dae worn refined": (
        *("wear-times", "--engine", DAE, "--wear-updates", "2", "--cycles", "3", *STEPS),
        *("--set", "integrator=dopri5"),
    ),
    "dae starts": ("friction-0.1", "--engine", DAE, "--cycles", "5", "--set", "replicates=2"),
    "dae C": ("clearance-c", "--engine", DAE, "--cycles", "2", "--set", "projection=on"),
    "dae slider-crank": ("slider-crank", "--engine", DAE, "--cycles", "5"),
    "dae equal steps": (
        *("wear-times", "--engine", DAE, "--wear-updates", "1", "--cycles", "2"),
        *("--set", "integrator=rk4", *ONE),
    ),
    "study runaway": RUNAWAY,
}

_OF_A_MACHINE = ("wall_",)


def digest(data: bytes) -> str:
    """Enough of SHA-256 to tell two arrays apart."""
    return hashlib.sha256(data).hexdigest()[:16]


def told(folder: Path) -> Iterator[tuple[str, str]]:
    """Name and digest of every array and every statistic of a result folder."""
    document = json.loads((folder / "result.json").read_text())
    yield "status", document["status"]
    for stage in document["stages"]:
        own = f"stage-{stage['index']}"
        parts: dict[str, list[bytes]] = {}
        for name, value in leaves(stage["statistics"]):
            parts.setdefault(f"{own} statistics", []).append(f"{name} {value!r}".encode())
        yield f"{own} steps", str(stage["diagnostics"].get("steps"))
        residual = stage["diagnostics"].get("energy_residual_J")
        yield f"{own} energy residual", digest(repr(residual).encode())
        for kind in ("stage", "film"):
            with np.load(folder / f"{kind}-{stage['index']}.npz") as arrays:
                for name in sorted(arrays.files):
                    array = np.ascontiguousarray(arrays[name])
                    text = f"{name} {array.dtype}{array.shape}".encode() + array.tobytes()
                    # All of a joint together, and all of a film.
                    group = name.partition("_")[0] if name[0].isupper() else name
                    place = f"{own} {group}" if kind == "stage" else f"{own} film"
                    parts.setdefault(place, []).append(text)
        for place, texts in parts.items():
            yield place, digest(b"".join(sorted(texts)))


def leaves(value: Any, where: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of nested statistics with its place; none that depends on the machine."""
    if isinstance(value, dict):
        for key, item in value.items():
            if not key.startswith(_OF_A_MACHINE):
                yield from leaves(item, f"{where} {key}")
    else:
        yield where, value


def computed(case: tuple[str, ...], folder: Path) -> dict[str, str]:
    """Run one case and tell all that it gave."""
    if case == RUNAWAY:
        script = runpy.run_path(str(FILE.parents[1] / "scenarios" / "runaway.py"))
        settings = {"engine": DAE, "cycles": 2, "wear_updates": 1, "replicates": 1}
        script["main"](str(folder), jobs=2, **settings)
    elif code := presswear(["run", *case, "--out", str(folder)]):
        return {"exit code": str(code)}
    if (folder / "result.json").exists():
        return dict(told(folder))
    variants = sorted(document.parent for document in folder.rglob("result.json"))
    return {path.name: digest(repr(dict(told(path))).encode()) for path in variants}


def machine() -> dict[str, str]:
    """What the last digits depend on beside the program."""
    packages = {name: version(name) for name in ("exudyn", "numpy", "scipy", "numba", "llvmlite")}
    processor = platform.processor() or platform.machine()
    return {"python": platform.python_version(), "processor": processor, **packages}


def differences(stored: dict[str, str], found: dict[str, str]) -> list[str]:
    """Names whose digests differ, or that one side lacks."""
    return [
        f"{name}: {stored.get(name, 'was not there')} -> {found.get(name, 'is gone')}"
        for name in dict.fromkeys([*stored, *found])
        if stored.get(name) != found.get(name)
    ]


def main() -> int:
    """Compare or store; returns how many cases differ."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", help="parts of names; default: all")
    parser.add_argument("--write", action="store_true", help="store what is computed")
    arguments = parser.parse_args()
    stored = json.loads(FILE.read_text()) if FILE.exists() else {"machine": {}, "cases": {}}
    if stored["machine"] not in ({}, machine()):
        print(f"stored on another machine: {stored['machine']}, here {machine()}")
    wrong = 0
    for name, case in CASES.items():
        if arguments.cases and not any(part in name for part in arguments.cases):
            continue
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as temporary:
            found = computed(case, Path(temporary) / "run")
        apart = differences(stored["cases"].get(name, {}), found)
        wrong += bool(apart)
        took = time.perf_counter() - began
        print(f"{name}: {len(found)} digests, {len(apart)} differ ({took:.1f} s)", flush=True)
        for line in apart[:20]:
            print(f"    {line}")
        stored["cases"][name] = found
    if arguments.write:
        stored["machine"] = machine()
        FILE.write_text(json.dumps(stored, indent=1) + "\n")
    return wrong


if __name__ == "__main__":
    sys.exit(main())
