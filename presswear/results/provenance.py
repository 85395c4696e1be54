"""Provenance of a result: versions of program and packages, revision, machine and date."""

import hashlib
import os
import platform
import shlex
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path
from typing import NotRequired, TypedDict

from presswear.tools.exudyn import requested_module

PACKAGES = ("presswear", "exudyn", "numpy", "scipy", "numba", "matplotlib")
_SOURCE = Path(__file__).resolve().parents[1]


class Provenance(TypedDict):
    """Versions, revision, machine and date (UTC); ``resumed``: machine and date of each resume."""

    python: str
    packages: dict[str, str]
    revision: str
    source: str
    machine: str
    started: str
    command: NotRequired[str]  # command that started the run
    resumed: NotRequired[list[dict[str, str]]]


def revision_of(source: Path) -> str:
    """Return the revision of the repository that tracks the package in ``source``, or "unknown".

    An installed package may lie in the environment of another repository.
    """
    git = partial(
        subprocess.run,
        cwd=source,
        capture_output=True,
        text=True,
        timeout=5,
        check=True,
    )
    try:
        git(["git", "ls-files", "--error-unmatch", "__init__.py"])
        described = git(["git", "describe", "--always", "--dirty", "--abbrev=12"])
        return described.stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"


@cache
def _program() -> Provenance:
    """Return the provenance without date and command, which is constant in a process."""
    packages = {name: version(name) for name in PACKAGES}
    # Results of the two modules of Exudyn differ in their last digits.
    packages["exudyn"] += f", {requested_module()}"
    sha = hashlib.sha256()
    for path in sorted(_SOURCE.rglob("*.py")):
        sha.update(path.relative_to(_SOURCE).as_posix().encode())
        sha.update(path.read_bytes())
    return {
        "python": platform.python_version(),
        "packages": packages,
        "revision": revision_of(_SOURCE),
        "source": sha.hexdigest()[:16],  # distinguishes changes of one revision
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "started": "",
    }


def provenance() -> Provenance:
    """Return the provenance of numbers that this process computes now."""
    started = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
    return {**_program(), "started": started, "command": command_of(sys.argv)}


def command_of(arguments: Sequence[str]) -> str:
    """Return a process's arguments as a command line; empty without a script or in a notebook."""
    script = Path(arguments[0]).name if arguments else ""
    if not script or script.startswith(("ipykernel", "-")):
        return ""
    name = "presswear" if script == "__main__.py" else script
    return shlex.join([name, *arguments[1:]])


def versions_of(origin: Provenance) -> dict[str, str]:
    """Return the versions of the source and of all packages that numbers depend on, by name."""
    packages = dict(origin["packages"])
    packages.pop("matplotlib", None)  # draws figures only
    return {"python": origin["python"], "source": origin["source"], **packages}


@cache
def program_digest() -> str:
    """Return the digest of ``versions_of`` the program."""
    text = "\n".join(versions_of(provenance()).values())
    return hashlib.sha256(text.encode()).hexdigest()[:16]
