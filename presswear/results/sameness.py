"""Whether two result folders hold the same: everything but wall times and dates.

Arrays are compared bit for bit, numbers of ``result.json`` as they are stored.  Left out are
``wall_*`` and ``share_*`` (times that this machine took, and parts of them), ``started`` and
``resumed`` (dates), and the digests of what holds those.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from presswear.results.result import load, read_document
from presswear.tools.files import arrays_in, read_checked

_TIMES = ("wall_", "share_")
_DATES = ("started", "resumed", "digest", "files")


def without_times(document: Any) -> Any:
    """A stored document without wall times and dates."""
    if isinstance(document, Mapping):
        return {
            key: without_times(value)
            for key, value in document.items()
            if not key.startswith(_TIMES) and key not in _DATES
        }
    if isinstance(document, list):
        return [without_times(value) for value in document]
    return document


def folder_differences(first: Path, second: Path) -> list[str]:
    """What differs between two result folders, named; nothing where they are equal.

    Raises
    ------
    InputError
        Where a folder is not whole.
    """
    for path in (first, second):
        load(path)
    found = _apart("result.json", *(without_times(read_document(p)) for p in (first, second)))
    files = [set(read_document(path)["files"]) for path in (first, second)]
    found += [f"{name} is in one only" for name in sorted(files[0] ^ files[1])]
    for name in sorted(files[0] & files[1]):
        mine, theirs = (arrays_in(read_checked(p / name, None), p / name) for p in (first, second))
        for key in dict.fromkeys([*mine, *theirs]):
            if key not in mine or key not in theirs:
                found.append(f"{name}: {key} is in one only")
            elif (mine[key].dtype, mine[key].shape, mine[key].tobytes()) != (
                theirs[key].dtype,
                theirs[key].shape,
                theirs[key].tobytes(),
            ):
                found.append(f"{name}: {key} differs")
    return found


def _apart(where: str, one: Any, other: Any) -> list[str]:
    """Places at which two documents differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        return [
            place
            for key in dict.fromkeys([*one, *other])
            for place in _apart(f"{where}: {key}", one.get(key), other.get(key))
        ]
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = enumerate(zip(one, other, strict=True))
        return [place for k, pair in pairs for place in _apart(f"{where} {k}", *pair)]
    return [] if repr(one) == repr(other) else [f"{where}: {one!r} and {other!r}"]
