"""Files that are there whole or not at all, and the digests that tell whether they still are."""

import hashlib
import io
import json
import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from presswear.tools.errors import InputError

PART = ".part"
"""Ending of a file that is being written."""


def write_whole(path: Path, write: Callable[[BinaryIO], None]) -> None:
    """Write a file so that it is there whole or not at all, even when power fails.

    Raises
    ------
    OSError
        Naming the file: what was there before is untouched.
    """
    part = path.with_name(path.name + PART)
    try:
        try:
            with part.open("wb") as file:
                write(file)
                file.flush()
                os.fsync(file.fileno())
            os.replace(part, path)
            _sync_folder(path.parent)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        if error.errno is None:
            raise
        # A full disk is reported without a name, others under that of the part.
        raise OSError(error.errno, error.strerror, str(path)) from None


def _sync_folder(folder: Path) -> None:
    """Have the folder's entry of a renamed file on the disk, where the system can say so."""
    if os.name != "posix":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_bytes(path: Path, data: bytes) -> None:
    """Write bytes as ``write_whole`` does."""

    def write(file: BinaryIO) -> None:
        file.write(data)

    write_whole(path, write)


def write_arrays(
    path: Path,
    arrays: Mapping[str, NDArray[Any]],
    pack: Callable[..., None] = np.savez_compressed,
) -> str:
    """Write arrays by name as ``write_whole`` does; returns the file's digest.

    Parameters
    ----------
    pack : callable
        ``np.savez_compressed`` or ``np.savez``; without options, which numpy 2.0 stores as if
        they were arrays.
    """
    packed = io.BytesIO()
    pack(packed, **arrays)
    write_bytes(path, packed.getvalue())
    return digest(packed.getvalue())


def digest(data: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def read_checked(path: Path, expected: str | None) -> bytes:
    """What a file holds; InputError names one that is missing or not what was written.

    Parameters
    ----------
    expected : str or None
        Its digest; None: unknown.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path} is missing") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    if expected is not None and digest(data) != expected:
        raise InputError(f"{path} is cut off or altered: its checksum is not the stored one")
    return data


def arrays_in(data: bytes, path: Path) -> dict[str, NDArray[Any]]:
    """Arrays by name from what a file holds; InputError where it is damaged."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            return dict(stored)
    except (OSError, ValueError, KeyError, EOFError, TypeError, BadZipFile) as error:
        raise InputError(f"{path} cannot be read: {error}") from None


MOST_TEXT = 2**28
"""Bytes of a JSON file; the largest studies have some millions."""


def read_json(file: Path, missing: str) -> Any:
    """What a JSON file holds; InputError says that it is missing, in given words, or damaged.

    Nothing is chosen between two values of one name, and no number is infinite: files are
    written without either.
    """
    if not file.is_file():
        raise InputError(missing)
    try:
        if file.stat().st_size > MOST_TEXT:
            raise ValueError(f"it has more than {MOST_TEXT} bytes")
        return json.loads(
            file.read_text(encoding="utf-8"),
            object_pairs_hook=_named_once,
            parse_float=_finite,
            parse_constant=_finite,
        )
    # A whole number of some thousand digits is a ValueError like any damage.
    except (OSError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def _named_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a name is there twice")
    return found


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is no finite number")
    return value


_NO_DIGEST = '"digest": "' + 64 * "0" + '"'


def sealed_json(document: Mapping[str, Any]) -> bytes:
    """A document as JSON with the digest of this very text, in which its own place is zeros."""
    text = json.dumps({**document, "digest": 64 * "0"}, indent=1, allow_nan=False)
    return text.replace(_NO_DIGEST, f'"digest": "{digest(text.encode())}"').encode()


def check_seal(data: bytes, document: Mapping[str, Any], path: Path) -> None:
    """InputError where the text of a document is not the one that was sealed."""
    own = f'"digest": "{document.get("digest")}"'.encode()
    if digest(data.replace(own, _NO_DIGEST.encode())) != document.get("digest"):
        raise InputError(f"{path} is cut off or altered: its checksum does not fit")
