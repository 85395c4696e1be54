"""Public names: those at the root, and those of its packages with a dot."""

import re
from operator import attrgetter
from typing import Any

import presswear as pw

DESCRIBED_IN_TEXT = {"scenes", "statistics"}
PACKAGES = {"engines", "linkage", "results", "statics"}
NAMES = sorted({*pw.__all__} - PACKAGES - DESCRIBED_IN_TEXT)
NAMES += [
    f"{one}.{name}" for one in sorted(PACKAGES) for name in getattr(pw, one).__all__
]
NAMES += ["statistics.Estimate"]
PUBLIC: dict[str, Any] = {name.split(".")[-1]: attrgetter(name)(pw) for name in NAMES}
"""Public classes and functions by their last name."""


def missing_names(text: str) -> list[str]:
    """Return the names in a text that begin with ``pw.`` and do not exist."""
    missing = []
    for name in re.findall(r"\bpw\.([A-Za-z_.]*[A-Za-z_])", text):
        try:
            attrgetter(name)(pw)
        except AttributeError:
            missing.append(name)
    return missing
