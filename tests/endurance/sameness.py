"""Comparison of two result folders: equal except for wall times and dates.

Arrays are compared bit for bit, and numbers of ``result.json`` as stored. Fields
``wall_*`` (times), ``started`` and ``resumed`` (dates), and digests of files that hold
these are skipped; so is the revision, which git does not always tell in time on a busy
machine.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from presswear.results.result import load
from presswear.tools.errors import InputError

SKIPPED = ("started", "resumed", "revision", "digest", "files")


def _items(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if not isinstance(value, dict | list) or not value:
        yield path, repr(value)
        return
    for key, item in value.items() if isinstance(value, dict) else enumerate(value):
        if not (str(key).startswith("wall_") or key in SKIPPED):
            yield from _items(item, f"{path}: {key}" if path else f"{key}")


def _contents(folder: Path) -> dict[str, dict[str, Any]]:
    load(folder)
    document = json.loads((folder / "result.json").read_text())
    contents: dict[str, dict[str, Any]] = {"result.json": dict(_items(document))}
    for name in document["files"]:
        with np.load(folder / name) as arrays:
            contents[name] = {
                k: (a.dtype, a.shape, a.tobytes()) for k, a in arrays.items()
            }
    return contents


def folder_differences(first: Path, second: Path) -> list[str]:
    """Return the differences of two result folders; empty if they are equal."""
    try:
        left = _contents(first)
        right = _contents(second)
    except InputError as error:
        return [f"{error}"]
    differences = [
        f"{name} is in one only" for name in sorted(left.keys() ^ right.keys())
    ]
    for name in sorted(left.keys() & right.keys()):
        for key in dict.fromkeys([*left[name], *right[name]]):
            if key not in left[name] or key not in right[name]:
                differences.append(f"{name}: {key} is in one only")
            elif left[name][key] != right[name][key]:
                a = left[name][key]
                b = right[name][key]
                values = f": {a} and {b}" if isinstance(a, str) else " differs"
                differences.append(f"{name}: {key}{values}")
    return differences
