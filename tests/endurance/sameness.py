"""Whether two result folders hold the same: everything but wall times and dates.

Arrays are compared bit for bit, numbers of ``result.json`` as they are stored.  Left out are
``wall_*`` (times that this machine took), ``started`` and ``resumed`` (dates), and the digests of
what holds those.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from endurance.subject import check_result
from presswear.tools.errors import InputError

_TIMES = ("wall_",)
_DATES = ("started", "resumed", "digest", "files")


def _items(owner: Any, place: str = "") -> Iterator[tuple[str, str]]:
    """Numbers, texts and empty parts of a document as texts, by their places."""
    if not isinstance(owner, dict | list) or not owner:
        yield place, repr(owner)
        return
    for key, value in owner.items() if isinstance(owner, dict) else enumerate(owner):
        if not (str(key).startswith(_TIMES) or key in _DATES):
            yield from _items(value, f"{place}: {key}" if place else f"{key}")


def _contents(folder: Path) -> dict[str, dict[str, Any]]:
    """What each file of a result holds, by its name."""
    check_result(folder)
    document = json.loads((folder / "result.json").read_text())
    found: dict[str, dict[str, Any]] = {"result.json": dict(_items(document))}
    for name in document["files"]:
        with np.load(folder / name) as arrays:
            found[name] = {k: (own.dtype, own.shape, own.tobytes()) for k, own in arrays.items()}
    return found


def folder_differences(first: Path, second: Path) -> list[str]:
    """What differs between two result folders, or is wrong with one; nothing: they are equal."""
    try:
        one, other = _contents(first), _contents(second)
    except InputError as error:
        return [f"{error}"]
    found = [f"{name} is in one only" for name in sorted(one.keys() ^ other.keys())]
    for name in (name for name in one if name in other):
        mine, theirs = one[name], other[name]
        for key in dict.fromkeys([*mine, *theirs]):
            if key not in mine or key not in theirs:
                found.append(f"{name}: {key} is in one only")
            elif mine[key] != theirs[key]:
                are_texts = isinstance(mine[key], str)
                told = f": {mine[key]} and {theirs[key]}" if are_texts else " differs"
                found.append(f"{name}: {key}{told}")
    return found
