"""Arrays by name: parts of a larger state, and files of their own."""

import io
import sys
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.tools.errors import InputError, NotStored, shown
from presswear.tools.files import digest, read_checked, write_bytes

Array = NDArray[np.float64]
_MOST_BYTES = 2**26  # largest size of compressed arrays, unless their size is specified
# Largest ratio of unpacked to packed size of larger arrays; zeros have 1000
_MOST_RATIO = 100

# Arrays of numbers or of records by name, from which a computation resumes. They may be
# views, so that they cost little: copy or write them before their owner changes.
State = Mapping[str, NDArray[Any]]


def numbers_of(name: str, value: Any) -> NDArray[Any]:
    """Return an array, or the array of nested lists of numbers; InputError for anything else."""
    if isinstance(value, np.ndarray):
        array = value
    else:
        try:
            array = np.asarray(value, dtype=float)
        except (TypeError, ValueError, OverflowError):
            array = np.zeros(())
    if array.ndim == 0 or array.dtype.kind not in "fiub":
        raise InputError(
            f"{name} = {shown(value)}: an array or a list of numbers is expected"
        )
    return array


def named(prefix: str, state: State) -> dict[str, NDArray[Any]]:
    """Return a state as a part of a larger one, under a name."""
    return {f"{prefix}/{name}": array for name, array in state.items()}


def part(state: State, prefix: str) -> dict[str, NDArray[Any]]:
    """Return the part of a larger state that ``named`` added; empty if there is none."""
    start = f"{prefix}/"
    return {
        name.removeprefix(start): array
        for name, array in state.items()
        if name.startswith(start)
    }


def write_arrays(
    path: Path, arrays: State, pack: Callable[..., None] = np.savez_compressed
) -> str:
    """Write arrays whole or not at all, by ``np.savez`` or alike; return the digest of the file."""
    packed = io.BytesIO()
    pack(packed, **arrays)
    write_bytes(path, packed.getvalue())
    return digest(packed.getvalue())


class Arrays(dict[str, NDArray[Any]]):
    """Arrays by name, from a file; NotStored for a missing one."""

    def __init__(self, arrays: State, source: str) -> None:
        super().__init__(arrays)
        self.source = source

    def __missing__(self, name: str) -> NDArray[Any]:
        raise NotStored(f"{self.source}: the array {name} is missing")


def read_arrays(
    file: Path, expected: str | None = None, most: int | None = None
) -> Arrays:
    """Read arrays of numbers or of records, without executing anything.

    InputError for a file that is missing, damaged, holds anything else or more than
    ``most`` bytes, or whose digest is not the expected one. Without ``most`` they may
    have 64 MiB or, if they are not compressed, any size. With ``most`` they may have 64 MiB
    and 100 times the bytes of the file, because ``most`` may be as untrusted as the file.
    """
    data = read_checked(file, expected, most or sys.maxsize)
    try:
        allowed = max(len(data), _MOST_BYTES)
        if most:
            allowed = min(most, _MOST_BYTES + _MOST_RATIO * len(data))
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            _check_members(archive, allowed)
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            arrays = Arrays({name: stored[name] for name in stored.files}, f"{file}")
    # A damaged file causes undocumented errors of zipfile, zlib, struct, tokenize, ast and
    # numpy, which evaluates a header as a literal.
    except Exception as error:
        raise InputError(f"{file} cannot be read: {error}") from None
    for name, array in arrays.items():
        # numpy returns a file of another format as bytes.
        if not isinstance(array, np.ndarray):
            raise InputError(f"{file}: {name} is no array")
    return arrays


def _check_members(archive: zipfile.ZipFile, most: int) -> None:
    """Raise ValueError if the files in an archive have more bytes, or may have."""
    members = archive.infolist()
    for member in members:
        # The other methods decompress without a limit.
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError("it is not compressed by deflate")
    size = sum(member.file_size for member in members)
    if size > most:
        raise ValueError(
            f"its arrays have {size / 1e6:.3g} MB, expected are {most / 1e6:.3g} MB"
        )


def read_numbers(
    file: Path, expected: str | None = None, most: int | None = None
) -> Arrays:
    """Read arrays as ``read_arrays`` does; raise InputError where one is not of real numbers."""
    arrays = read_arrays(file, expected, most)
    for name, values in arrays.items():
        if values.dtype.kind not in "fiu":
            raise InputError(
                f"{file}: {name} contains no real numbers but {values.dtype}"
            )
        arrays[name] = values.astype(np.float64, copy=False)
    return arrays
