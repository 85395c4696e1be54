"""Documents: plain data that JSON holds, sealed, read strictly and checked by data classes."""

import json
import math
import os
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from presswear.tools.errors import InputError
from presswear.tools.files import PART, digest, read_checked, write_bytes

T = TypeVar("T")

MOST_TEXT = 2**28
"""Bytes of a document; the largest studies have some millions."""
LARGEST = 1e300
"""Beyond this a number is damage: sums and units would overflow."""


def read_json(file: Path, missing: str, schema: int) -> dict[str, Any]:
    """Read a document; InputError says that it is missing, in given words, or what is wrong.

    Nothing is chosen between two values of one name, and every number can be computed with:
    files are written so.

    Parameters
    ----------
    schema : int
        The only one that is read.
    """
    return _document(_bytes(file, missing), file, schema)


def read_sealed(file: Path, missing: str, schema: int) -> dict[str, Any]:
    """Read a document as ``read_json`` does; InputError where it is not the one that was sealed."""
    # Read once: whoever is at work in the folder replaces it at any time.
    data = _bytes(file, missing)
    document = _document(data, file, schema)
    own = f'"digest": "{document.get("digest")}"'.encode()
    if digest(data.replace(own, _NO_DIGEST.encode())) != document.get("digest"):
        raise InputError(f"{file} is cut off or altered: its checksum does not fit")
    return document


def _bytes(file: Path, missing: str) -> bytes:
    if not file.is_file():
        raise InputError(missing)
    if file.stat().st_size > MOST_TEXT:
        raise InputError(f"{file} cannot be read: it has more than {MOST_TEXT} bytes")
    return read_checked(file)


def _document(data: bytes, file: Path, schema: int) -> dict[str, Any]:
    try:
        found = json.loads(
            data.decode(),
            object_pairs_hook=_named_once,
            parse_int=_whole,
            parse_float=_finite,
            parse_constant=_finite,
        )
    except (ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None
    if not isinstance(found, dict):
        raise InputError(f"{file} is no document of ours: it holds no names and values")
    # JSON's true equals 1 and 2.0 equals 2, but neither is a schema.
    if type(found.get("schema")) is not int or found["schema"] != schema:
        told = found.get("schema")
        raise InputError(f"{file} has schema {told!r}; this version reads {schema}")
    return found


def _named_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a name is there twice")
    return found


def _finite(text: str) -> float:
    value = float(text)
    if not abs(value) <= LARGEST:
        raise ValueError(f"{text[:40]} is no finite number up to {LARGEST:g}")
    return value


def _whole(text: str) -> int:
    _finite(text)
    return int(text)


_NO_DIGEST = '"digest": "' + 64 * "0" + '"'


def plain(value: Any) -> Any:
    """Data that JSON can hold: a number that is not finite becomes null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value


def write_json(file: Path, document: Mapping[str, Any]) -> None:
    """Write a document as ``write_whole`` does."""
    write_bytes(file, json.dumps(plain(document), indent=1, allow_nan=False).encode())


def write_shared_json(file: Path, document: Mapping[str, Any]) -> None:
    """Write a document that other processes may write at the same time: one of them stands."""
    own = file.with_name(f"{file.name}.{secrets.token_hex(4)}{PART}")
    write_json(own, document)
    os.replace(own, file)


def sealed_json(document: Mapping[str, Any]) -> bytes:
    """A document as JSON with the digest of this very text, in which its own place is zeros."""
    text = json.dumps(plain({**document, "digest": 64 * "0"}), indent=1, allow_nan=False)
    return text.replace(_NO_DIGEST, f'"digest": "{digest(text.encode())}"').encode()


def typed(data: Any, kind: type[T], place: str) -> T:
    """Plain data as the data class, or whatever else, whose annotations describe them.

    A whole number may stand for a ``float``, but neither True nor a text for a number; what no
    annotation names is left out.

    Parameters
    ----------
    place : str
        Where the data stand, for messages.

    Raises
    ------
    InputError
        AdvanceObserver the place of the first value that is missing or of a wrong kind.
    """
    # Imported where something is read: a run that begins anew reads nothing.
    import msgspec

    try:
        return msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        what, _, inner = str(error).partition(" - at `$")
        told = (place, inner.strip(".`"), what)
        raise InputError(": ".join(filter(None, told))) from None
