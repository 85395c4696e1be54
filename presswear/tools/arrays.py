"""Arrays by name: a part of a larger state, and a file of their own."""

import io
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from presswear.tools.errors import InputError
from presswear.tools.files import digest, read_checked, write_bytes

Array = NDArray[np.float64]

State = Mapping[str, NDArray[Any]]
"""Arrays of numbers or of records by name: all that is needed to go on from somewhere.

They may be views of what is only ever added to, so that they cost little; whoever writes them
down does so, or copies them, before their owner is gone.
"""

MOST_BYTES = 2**30
"""Bytes that a packed file may unpack to; five recorded cycles take some 30 MB."""


def named(prefix: str, state: State) -> dict[str, NDArray[Any]]:
    """A state as a part of a larger one, under a name."""
    return {f"{prefix}/{name}": array for name, array in state.items()}


def part(state: State, prefix: str) -> dict[str, NDArray[Any]]:
    """The part of a larger state that ``named`` put there; empty where there is none."""
    start = f"{prefix}/"
    return {
        name.removeprefix(start): array for name, array in state.items() if name.startswith(start)
    }


def numbers(values: Mapping[str, float]) -> Array:
    """Numbers by name as one array, in the order of their names."""
    return np.array([values[name] for name in sorted(values)], dtype=np.float64)


def set_numbers(values: dict[str, float], stored: NDArray[Any]) -> None:
    """Set numbers by name as ``numbers`` stored them."""
    values.update(zip(sorted(values), map(float, stored), strict=True))


def write_arrays(path: Path, arrays: State, pack: Callable[..., None] = np.savez_compressed) -> str:
    """Write arrays as ``write_whole`` does; returns the file's digest.

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


def read_arrays(file: Path, expected: str | None = None) -> dict[str, NDArray[Any]]:
    """Read arrays of numbers or of records, and execute nothing.

    The file's own sizes are compared before memory is taken: a header may promise anything.

    Parameters
    ----------
    expected : str or None
        Digest of the file; None: unknown.

    Raises
    ------
    InputError
        Naming a file that is missing, damaged or holds anything else.
    """
    data = read_checked(file, expected)
    try:
        with ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            if sum(member.file_size for member in members) > max(MOST_BYTES, len(data)):
                raise ValueError(f"it unpacks to more than {MOST_BYTES} bytes")
            if len({member.filename for member in members}) < len(members):
                raise ValueError("a name is there twice")
            found = {}
            for member in members:
                if member.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
                    raise ValueError(f"{member.filename} is packed in an unknown way")
                with archive.open(member) as stream:
                    found[member.filename.removesuffix(".npy")] = _array(stream, member.file_size)
            return found
    # A damaged file, or one made to harm, shows as a dozen kinds of errors, none of them promised:
    # of zipfile, zlib, struct, tokenize, ast and numpy, which evaluates a header as a literal.
    except Exception as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def _array(stream: Any, size: int) -> NDArray[Any]:
    """One array in numpy's format whose header fits the size of the file."""
    version = npy.read_magic(stream)
    read = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}[version]
    shape, _, kind = read(stream)
    expected = math.prod(shape) * kind.itemsize
    if min(shape, default=0) < 0 or expected != size - stream.tell():
        raise ValueError(f"{shape} of {kind} are not the {size - stream.tell()} bytes there")
    stream.seek(0)
    values: NDArray[Any] = npy.read_array(stream, allow_pickle=False)
    return values


def read_numbers(file: Path, expected: str | None = None) -> dict[str, Array]:
    """Read arrays as ``read_arrays`` does; InputError where one is not of real numbers."""
    found = read_arrays(file, expected)
    for name, values in found.items():
        if values.dtype.kind not in "fiu":
            raise InputError(f"{file}: {name} holds no real numbers but {values.dtype}")
    return {name: values.astype(np.float64, copy=False) for name, values in found.items()}
