"""Where numbers come from: versions, source and machine."""

import hashlib
import os
import platform
import subprocess
import time
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NotRequired, TypedDict

from presswear.tools.exudyn import wanted

PACKAGES = ("presswear", "exudyn", "numpy", "scipy", "numba", "matplotlib")
BINDING = ("python", "revision", "source")
"""Parts that must agree for a run to go on with the same numbers, beside the packages.

The same source may be installed in one place and checked out in another, where alone git knows
its revision: where the source is the same, so is the revision.
"""

_PACKAGE = Path(__file__).resolve().parents[1]


def source_revision() -> str:
    """Revision of the source when it runs from a checkout, else ``unknown``."""
    try:
        found = subprocess.run(
            ["git", "-C", str(_PACKAGE), "describe", "--always", "--dirty", "--abbrev=12"],
            capture_output=True,
            text=True,
            timeout=5,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return found.stdout.strip()


def source_digest() -> str:
    """Digest of the package's modules: tells two changes of one revision apart."""
    found = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        found.update(path.relative_to(_PACKAGE).as_posix().encode())
        found.update(path.read_bytes())
    return found.hexdigest()[:16]


def version_of(package: str) -> str:
    """Version of a package; of Exudyn also which of its modules, whose last digits differ."""
    return f"{version(package)}, {wanted()}" if package == "exudyn" else version(package)


class Provenance(TypedDict):
    """Versions, revision, machine and date, UTC; ``resumed`` for each time that a run went on."""

    python: str
    packages: dict[str, str]
    revision: str
    source: str
    machine: str
    started: str
    resumed: NotRequired[list[dict[str, str]]]


def provenance() -> Provenance:
    """Where numbers that are computed here and now come from."""
    return {
        "python": platform.python_version(),
        "packages": {name: version_of(name) for name in PACKAGES},
        "revision": source_revision(),
        "source": source_digest(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }


@cache
def program_digest() -> str:
    """Digest of all that must agree for two processes to give the same numbers.

    Source and versions, but for what draws the figures.
    """
    told = [platform.python_version(), source_digest(), *map(version_of, PACKAGES[:-1])]
    return hashlib.sha256("\n".join(told).encode()).hexdigest()[:16]


def provenance_differs(stored: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """Versions or sources that differ and so make other numbers, in words, or nothing."""
    pairs = {name: (stored[name], here[name]) for name in BINDING}
    if stored["source"] == here["source"]:
        del pairs["revision"]
    # What draws the figures changes no number.
    for name in PACKAGES[:-1]:
        pairs[name] = (stored["packages"].get(name), here["packages"][name])
    return ", ".join(
        f"{name} {there} there and {own} here"
        for name, (there, own) in pairs.items()
        if there != own
    )
