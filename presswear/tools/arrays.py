"""Arrays by name: parts of a larger state, and files of their own."""

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.tools.errors import InputError
from presswear.tools.files import digest, read_checked, write_bytes

Array = NDArray[np.float64]

# Arrays of numbers or of records by name, from which a computation resumes. They may be views, so
# that they cost little: copy or write them before their owner changes.
State = Mapping[str, NDArray[Any]]


def named(prefix: str, state: State) -> dict[str, NDArray[Any]]:
    """Return a state as a part of a larger one, under a name."""
    return {f"{prefix}/{name}": array for name, array in state.items()}


def part(state: State, prefix: str) -> dict[str, NDArray[Any]]:
    """Return the part of a larger state that ``named`` put there; empty where there is none."""
    start = f"{prefix}/"
    return {name[len(start) :]: one for name, one in state.items() if name.startswith(start)}


def write_arrays(path: Path, arrays: State, pack: Callable[..., None] = np.savez_compressed) -> str:
    """Write arrays whole or not at all, by ``np.savez`` or alike; return the digest of the file."""
    packed = io.BytesIO()
    pack(packed, **arrays)
    write_bytes(path, packed.getvalue())
    return digest(packed.getvalue())


def read_arrays(file: Path, expected: str | None = None) -> dict[str, NDArray[Any]]:
    """Read arrays of numbers or of records, without executing anything.

    InputError for a file that is missing, damaged, holds anything else, or whose digest is not the
    expected one.
    """
    data = read_checked(file, expected)
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    # A damaged file shows as a dozen kinds of errors, none of them promised: of zipfile, zlib,
    # struct, tokenize, ast and numpy, which evaluates a header as a literal.
    except Exception as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def read_numbers(file: Path, expected: str | None = None) -> dict[str, Array]:
    """Read arrays as ``read_arrays`` does; raise InputError where one is not of real numbers."""
    arrays = read_arrays(file, expected)
    for name, values in arrays.items():
        if values.dtype.kind not in "fiu":
            raise InputError(f"{file}: {name} contains no real numbers but {values.dtype}")
    return {name: values.astype(np.float64, copy=False) for name, values in arrays.items()}
