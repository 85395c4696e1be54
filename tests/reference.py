"""Digests of what the program computes, compared bit for bit before and after a change.

    python tests/reference.py            compare with the stored digests
    python tests/reference.py --write    store new digests, after a change that says why
    python tests/reference.py tree dae   some of the cases, by parts of their names

Runs scenes through all engines by the command line and reads their folders as any
program can. The last digits belong to a processor, its mathematical library and the
versions stored with them.
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

STEPS = "--conventions refined --set extrapolation=steps --set replicates=2"
ONE = "--set replicates=1"
TORQUE = "--set drive_torque=on"
COMMANDS = {
    "tree unworn": "wear-times --engine exudyn-tree --wear-updates 0 --cycles 3",
    "tree worn paper": "wear-times --engine exudyn-tree --wear-updates 2 --cycles 4 "
    f"--conventions paper {ONE}",
    "tree worn refined": f"wear-times --engine exudyn-tree --wear-updates 1 --cycles 2 {STEPS}",
    "tree starts": "friction --engine exudyn-tree --wear-updates 1 --cycles 4 --set replicates=3 "
    + TORQUE,
    "tree until known": f"speed --engine exudyn-tree --wear-updates 1 --tolerance 0.3 {ONE}",
    "tree C": "clearance-c --wear-updates 1 --cycles 1 --conventions refined "
    f"--set extrapolation=single --set angles=36 {TORQUE} {ONE}",
    "tree loose rod": "slider-crank --set joints=AB --engine exudyn-tree --cycles 2",
    "tree slider-crank": "slider-crank --engine exudyn-tree --cycles 4",
    "joints ideal": f"ideal {TORQUE}",
    "joints A": f"clearance-a --wear-updates 1 --cycles 1 {TORQUE} {ONE}",
    "joints C": f"clearance-c --engine exudyn-joints --wear-updates 0 --cycles 1 {TORQUE}",
    "joints A and C": "speed-8pi --engine exudyn-joints --wear-updates 0 --cycles 1 "
    "--set replicates=2",
    "joints slider-crank": "slider-crank --engine exudyn-joints --cycles 2",
    "dae ideal": f"ideal --engine dae {TORQUE}",
    "dae unworn": "wear-times --engine dae --wear-updates 0 --cycles 4",
    "dae worn paper": "wear-times --engine dae --wear-updates 2 --cycles 6 "
    f"--conventions paper {ONE}",
    "dae worn refined": f"wear-times --engine dae --wear-updates 2 --cycles 3 {STEPS} "
    "--set integrator=dopri5",
    "dae starts": "friction-0.1 --engine dae --cycles 5 --set replicates=2",
    "dae C": "clearance-c --engine dae --cycles 2 --set projection=on",
    "dae slider-crank": "slider-crank --engine dae --cycles 5",
    "dae equal steps": "wear-times --engine dae --wear-updates 1 --cycles 2 "
    f"--set integrator=rk4 {ONE}",
}
RUNAWAY = "study runaway"


def digest(data: bytes) -> str:
    """Return enough of SHA-256 to distinguish two arrays."""
    return hashlib.sha256(data).hexdigest()[:16]


def digests_of(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield the name and digest of every array and every statistic of a result folder."""
    document = json.loads((folder / "result.json").read_text())
    yield "status", document["status"]
    for stage in document["stages"]:
        label = f"stage-{stage['index']}"
        parts: dict[str, list[bytes]] = {}
        for name, value in leaves(stage["statistics"]):
            parts.setdefault(f"{label} statistics", []).append(
                f"{name} {value!r}".encode()
            )
        yield f"{label} steps", str(stage["diagnostics"].get("steps"))
        residual = stage["diagnostics"].get("energy_residual_J")
        yield f"{label} energy residual", digest(repr(residual).encode())
        for kind in ("stage", "film"):
            with np.load(folder / f"{kind}-{stage['index']}.npz") as arrays:
                for name in sorted(arrays.files):
                    array = np.ascontiguousarray(arrays[name])
                    text = (
                        f"{name} {array.dtype}{array.shape}".encode() + array.tobytes()
                    )
                    # All arrays of a joint together, and all of a film.
                    group = name.partition("_")[0] if name[0].isupper() else name
                    place = f"{label} {group}" if kind == "stage" else f"{label} film"
                    parts.setdefault(place, []).append(text)
        for place, texts in parts.items():
            yield place, digest(b"".join(sorted(texts)))


def leaves(value: Any, where: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value of nested statistics with its place, without wall times."""
    if isinstance(value, dict):
        for key, item in value.items():
            if not key.startswith("wall_"):
                yield from leaves(item, f"{where} {key}")
    else:
        yield where, value


def computed(name: str, folder: Path) -> dict[str, str]:
    """Run one case and return its digests."""
    if name == RUNAWAY:
        script = runpy.run_path(str(FILE.parents[1] / "scenarios" / "runaway.py"))
        settings = {"engine": "dae", "cycles": 2, "wear_updates": 1, "replicates": 1}
        script["main"](str(folder), jobs=2, **settings)
    elif code := presswear(
        ["run", *COMMANDS[name].split(), "--no-report", "--out", str(folder)]
    ):
        return {"exit code": str(code)}
    if (folder / "result.json").exists():
        return dict(digests_of(folder))
    variants = sorted(document.parent for document in folder.rglob("result.json"))
    return {
        path.name: digest(repr(dict(digests_of(path))).encode()) for path in variants
    }


def machine() -> dict[str, str]:
    """Return the versions and the processor that the last digits depend on."""
    packages = {
        name: version(name)
        for name in ("exudyn", "numpy", "scipy", "numba", "llvmlite")
    }
    processor = platform.processor() or platform.machine()
    return {"python": platform.python_version(), "processor": processor, **packages}


def differences(stored: dict[str, str], results: dict[str, str]) -> list[str]:
    """Return the names whose digests differ or are missing on one side."""
    return [
        f"{name}: {stored.get(name, 'was not there')} -> {results.get(name, 'is gone')}"
        for name in dict.fromkeys([*stored, *results])
        if stored.get(name) != results.get(name)
    ]


def main() -> int:
    """Compare or store; return the number of cases that differ."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", help="parts of names; default: all")
    parser.add_argument(
        "--write", action="store_true", help="store the computed digests"
    )
    arguments = parser.parse_args()
    stored = (
        json.loads(FILE.read_text()) if FILE.exists() else {"machine": {}, "cases": {}}
    )
    if stored["machine"] not in ({}, machine()):
        print(f"stored on another machine: {stored['machine']}, here {machine()}")
    wrong = 0
    for name in (*COMMANDS, RUNAWAY):
        if arguments.cases and not any(part in name for part in arguments.cases):
            continue
        started = time.perf_counter()
        with tempfile.TemporaryDirectory() as temporary:
            results = computed(name, Path(temporary) / "run")
        changed = differences(stored["cases"].get(name, {}), results)
        wrong += bool(changed)
        seconds = time.perf_counter() - started
        print(
            f"{name}: {len(results)} digests, {len(changed)} differ ({seconds:.1f} s)",
            flush=True,
        )
        for line in changed[:20]:
            print(f"    {line}")
        stored["cases"][name] = results
    if arguments.write:
        stored["machine"] = machine()
        FILE.write_text(json.dumps(stored, indent=1) + "\n")
        return 0
    return wrong


if __name__ == "__main__":
    sys.exit(main())
