"""Public names of presswear, and of its packages with a dot."""

import re
from operator import attrgetter
from typing import Any

import presswear as pw

DESCRIBED_IN_TEXT = {"scenes", "statistics"}
PACKAGES = {"engines", "linkage", "results", "statics"}
NAMES = sorted({*pw.__all__} - PACKAGES - DESCRIBED_IN_TEXT)
for package in sorted(PACKAGES):
    NAMES += [f"{package}.{name}" for name in getattr(pw, package).__all__]
NAMES += ["statistics.Estimate"]
# Public classes and functions by their name without the package
PUBLIC: dict[str, Any] = {name.split(".")[-1]: attrgetter(name)(pw) for name in NAMES}


def missing_names(text: str) -> list[str]:
    """Return the names in a text that begin with ``pw.`` and do not exist."""
    missing = []
    for name in re.findall(r"\bpw\.([A-Za-z_.]*[A-Za-z_])", text):
        try:
            attrgetter(name)(pw)
        except AttributeError:
            missing.append(name)
    return missing
