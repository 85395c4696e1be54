"""Files that are there whole or not at all, and the digests that tell whether they still are."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from presswear.tools.errors import InputError

PART = ".part"
"""Ending of a file that is being written."""


def check_link(path: Path) -> None:
    """Raise InputError if a file or folder that is written into is a symbolic link."""
    if path.is_symlink():
        raise InputError(f"{path}: this is a link; nothing is written through it, so remove it")


def inside(folder: Path, *names: str) -> Path:
    """Return a folder inside another one; InputError where a link leads out of it."""
    for name in names:
        folder = folder / name
        check_link(folder)
    return folder


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file so that it is there whole or not at all, even when power fails.

    Raises
    ------
    OSError
        Naming the file: what was there before is untouched.
    InputError
        Where a link would lead the bytes elsewhere.  A link in place of the file is replaced.
    """
    part = path.with_name(path.name + PART)
    check_link(part)
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
    write_whole(path, lambda file: file.write(data))


def digest(data: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def read_checked(path: Path, expected: str | None = None) -> bytes:
    """Read a file; InputError names one that is missing or not what was written.

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
