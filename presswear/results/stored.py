"""Whether stored data are a result: all of it is looked at before any of it is used.

Files may be damaged, of another version or made by somebody else.  Nothing in them is
executed: JSON holds plain data, and arrays are read as numbers of a size that the file
itself has.
"""

import io
import math
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from presswear.linkage.surface import bin_centres
from presswear.tools.errors import InputError
from presswear.tools.files import read_checked
from presswear.tools.typed import LARGEST

Array = NDArray[np.float64]
Check = Callable[[Any], bool]

MOST_BYTES = 2**30
"""Bytes of all arrays of a stage; five recorded cycles take some 30 MB."""
LARGEST_ENTRY = 1e100
"""Of an array: a state that runs away is ended at 1e30."""
_MOST_HEADER = 512
_MOST_STAGES = 1000

_NOT_OURS = "allow_pickle.npy"
"""An option that numpy before 2.1 stored as an array, where it was given."""

SERIES = {"eccentricity": (2,), "penetration": (), "force": (2,), "sliding": ()}
"""Arrays of a joint with a row for each time, and the shape of a row."""
MAPS = ("depth_bearing", "depth_pin", "wear_bearing", "wear_pin")
"""Arrays of a joint with a value for each angle, none below zero."""


def is_number(value: Any) -> bool:
    """Whether it is a number that can be computed with; True and False are none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= LARGEST


def _is_number_or_none(value: Any) -> bool:
    return value is None or is_number(value)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < _MOST_STAGES


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_scalar(value: Any) -> bool:
    return _is_text(value) or _is_number_or_none(value)


def _all(check: Check) -> Check:
    """A check of every value of a mapping."""
    return lambda value: isinstance(value, dict) and all(map(check, value.values()))


def _each(check: Check) -> Check:
    """A check of every item of a list."""
    return lambda value: isinstance(value, list) and all(map(check, value))


def _with(checks: Mapping[str, Check], *optional: str) -> Check:
    """A check of a mapping with certain keys, some of which may be missing."""

    def check(value: Any) -> bool:
        if not isinstance(value, dict):
            return False
        return all(
            own(value[key]) if key in value else key in optional for key, own in checks.items()
        )

    return check


def _is_interval(value: Any) -> bool:
    return value is None or (_each(is_number)(value) and len(value) == 2)


def _are_numbers(value: Any) -> bool:
    """Statistics of the slider or a joint; their names say of what kind each is."""

    def one(key: str, item: Any) -> bool:
        if "_per_cycle" in key:
            return _all(_is_number_or_none)(item)
        return _is_interval(item) if "_interval" in key else _is_number_or_none(item)

    return isinstance(value, dict) and all(one(key, item) for key, item in value.items())


_STATISTICS: dict[str, Check] = {
    "cycles": lambda value: isinstance(value, int) and is_number(value) and value >= 0,
    "slider": _are_numbers,
    "joints": _all(_are_numbers),
    "energy_residual_J": _is_number_or_none,
    "energy_exchanged_J": _is_number_or_none,
}
_is_finding = _with(
    dict.fromkeys(("kind", "what", "joint", "remedy"), _is_text) | {"time_s": is_number}
)
"""Whether it is what ``watch.Finding.as_dict`` gives."""
_STAGE: dict[str, Check] = {
    "index": _is_count,
    "status": _is_text,
    "message": _is_text,
    "finding": lambda value: value is None or _is_finding(value),
    "wear_steps": lambda value: isinstance(value, list),
    "amplification": _is_number_or_none,
    "simulated_s": _is_number_or_none,
    "wall_s": _is_number_or_none,
    "diagnostics": _all(_is_scalar),
    "statistics": _with(_STATISTICS, "slider", "joints", "energy_residual_J", "energy_exchanged_J"),
}
_PROVENANCE: dict[str, Check] = {
    "packages": _all(_is_text),
    **dict.fromkeys(("python", "revision", "machine", "started"), _is_text),
}
is_provenance = _with(_PROVENANCE)
"""Whether it says where numbers come from, as ``results.provenance`` does."""
_is_checkpoint = _with(
    {
        "turn": lambda value: type(value) is int and value in (1, 2),
        "words": _is_text,
        "state": lambda value: isinstance(value, dict),
    }
)
"""Whether it says where a run stands that has not come to its end."""
_DOCUMENT: dict[str, Check] = {
    "scene": lambda value: isinstance(value, dict),
    "engine": _is_text,
    "provenance": is_provenance,
    "status": _is_text,
    "message": _is_text,
    "wall_s": _is_number_or_none,
    "files": _all(_is_text),
    "checkpoint": lambda value: value is None or _is_checkpoint(value),
}


def _wear_step(joints: tuple[str, ...]) -> Check:
    sides = _with({"bearing": is_number, "pin": is_number})
    numbers = ("represented_cycles", "cycles", "factor", "largest_change_of_clearance", "wall_s")
    checks: dict[str, Check] = dict.fromkeys(numbers, is_number)
    checks["deepest_m"] = _with(dict.fromkeys(joints, sides))
    checks["force_max_N"] = _with(dict.fromkeys(joints, is_number))
    return _with(checks)


def schema_of(document: Any, file: Path, newest: int) -> int:
    """The schema of a document, a whole number from 1; InputError where this is no such document.

    JSON's ``true`` equals 1 and ``2.0`` equals 2, but neither is a schema.
    """
    if not isinstance(document, dict):
        raise InputError(f"{file} is no document of ours: it holds no names and values")
    schema = document.get("schema")
    if type(schema) is not int or schema != newest:
        raise InputError(f"{file} has schema {_short(schema)}; this version reads {newest}")
    return schema


def _short(value: Any) -> str:
    """A value as a message shows it."""
    try:
        text = repr(value)
    except ValueError:  # a whole number of thousands of digits
        return "a huge number"
    return text if len(text) <= 60 else text[:57] + "..."


def check_document(document: Mapping[str, Any], file: Path) -> None:
    """InputError naming the first part of a result document that is missing or of a wrong kind.

    Wear steps are left for ``check_steps``, which needs the scene's joints.
    """
    _check_parts(document, _DOCUMENT, str(file))
    stages = document.get("stages")
    if not isinstance(stages, list) or len(stages) > _MOST_STAGES:
        raise InputError(f"{file}: 'stages' is missing or no list of stages")
    for place, stage in enumerate(stages):
        _check_parts(stage, _STAGE, f"{file}, stage at place {place}")
        # Stages follow each other: readers take the place for the number of wears.
        if stage["index"] != place:
            raise InputError(
                f"{file}, stage at place {place}: 'index' is {stage['index']}; {place} is expected"
            )


def _check_parts(owner: Any, checks: Mapping[str, Check], where: str) -> None:
    if not isinstance(owner, dict):
        raise InputError(f"{where}: names and values are expected")
    for key, check in checks.items():
        if key not in owner:
            raise InputError(f"{where}: {key!r} is missing")
        if not check(owner[key]):
            raise InputError(f"{where}: {key!r} is not what it should be: {_short(owner[key])}")


def check_stages(
    document: Mapping[str, Any], joints: tuple[str, ...], wears: int, file: Path
) -> None:
    """InputError where a checked document and its scene do not fit together.

    Parameters
    ----------
    joints : tuple of str
        With clearance.
    wears : int
        How often they are worn.
    """
    if len(document["stages"]) > wears + 1:
        raise InputError(
            f"{file}: {len(document['stages'])} stages, where the scene has wears = {wears}"
        )
    step = _each(_wear_step(joints))
    for stage in document["stages"]:
        where = f"{file}, stage {stage['index']}"
        if not step(stage["wear_steps"]):
            raise InputError(f"{where}: 'wear_steps' is not what it should be")
        found = stage["statistics"].get("joints", {})
        if found and set(found) != set(joints):
            raise InputError(
                f"{where}: statistics of joints {', '.join(found)}, where the scene has "
                f"clearance at {', '.join(joints) or 'none'}"
            )


def read_arrays(file: Path, expected: str | None = None) -> dict[str, Array]:
    """Arrays of real numbers by name; InputError when the file is missing or damaged.

    The file's own sizes are compared before memory is taken: a header may promise anything.

    Parameters
    ----------
    expected : str or None
        Digest of the file; None: unknown.
    """
    data = io.BytesIO(read_checked(file, expected))
    try:
        with ZipFile(data) as archive:
            members = archive.infolist()
            if sum(member.file_size for member in members) > MOST_BYTES:
                raise ValueError(f"it unpacks to more than {MOST_BYTES} bytes")
            if len({member.filename for member in members}) < len(members):
                raise ValueError("a name is there twice")
            found = {}
            for member in members:
                if member.filename == _NOT_OURS:
                    continue
                if member.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
                    raise ValueError(f"{member.filename} is packed in an unknown way")
                with archive.open(member) as stream:
                    name = member.filename.removesuffix(".npy")
                    found[name] = _array(stream, member.file_size, name)  # type: ignore[arg-type]
            return found
    except (
        OSError,
        ValueError,
        KeyError,
        EOFError,
        RuntimeError,  # an encrypted member
        NotImplementedError,
        MemoryError,
        BadZipFile,
        zlib.error,
    ) as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def _array(stream: BinaryIO, size: int, name: str) -> Array:
    """One array in numpy's format, of real numbers, whose header fits the size of the file."""
    version = npy.read_magic(stream)
    if version not in ((1, 0), (2, 0)):
        raise ValueError(f"{name} is in format {version}")
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    try:
        shape, by_columns, kind = read(stream, max_header_size=_MOST_HEADER)
    except Exception as error:  # numpy hands on whatever Python's parser raises
        raise ValueError(f"{name} has no header of numpy's: {error}") from None
    if kind.kind not in "fiu":
        raise ValueError(f"{name} holds no real numbers but {kind}")
    if any(length < 0 for length in shape):
        raise ValueError(f"{name} has the shape {shape}")
    expected = math.prod(shape) * kind.itemsize
    if expected != size - stream.tell():
        raise ValueError(f"{name} should take {expected} bytes and takes {size - stream.tell()}")
    values = np.frombuffer(stream.read(), kind).reshape(shape, order="F" if by_columns else "C")
    return values.astype(np.float64)


def check_arrays(
    arrays: Mapping[str, Array], joints: tuple[str, ...], angles: int, file: Path
) -> None:
    """InputError naming the first array of a stage that is missing, misshapen or not finite.

    Parameters
    ----------
    joints : tuple of str
        With clearance, in the scene.
    angles : int
        Bins of a wear map; without a wear account there is one.
    """

    def of(name: str, *shape: int | None) -> Array:
        """An array of a shape, whose lengths may be given or not."""
        if name not in arrays:
            raise InputError(f"{file}: the array {name} is missing")
        values = arrays[name]
        fits = values.ndim == len(shape) and all(
            want is None or have == want for have, want in zip(values.shape, shape, strict=False)
        )
        if not fits:
            wanted = ", ".join("n" if length is None else str(length) for length in shape)
            raise InputError(f"{file}: {name} has the shape {values.shape}; ({wanted}) is expected")
        return values

    for name, values in arrays.items():
        if not np.all(np.abs(values) <= LARGEST_ENTRY):
            raise InputError(
                f"{file}: {name} holds a value that is not finite, or beyond {LARGEST_ENTRY:g}"
            )
    time = of("time", None)
    rows = time.size
    if rows and (time[0] < 0.0 or np.any(np.diff(time) < 0.0)):
        raise InputError(f"{file}: time goes backwards")
    of("slider", rows, 3)
    bins = of("angle", None).size if joints else 0
    if joints and not (
        bins in (1, angles) and np.allclose(arrays["angle"], bin_centres(bins), 0.0, 1e-9)
    ):
        raise InputError(f"{file}: angle does not hold the middles of {angles} bins of a turn")
    for joint in joints:
        for name, row in SERIES.items():
            of(f"{joint}_{name}", rows, *row)
        for name in MAPS:
            if np.any(of(f"{joint}_{name}", bins) < 0.0):
                raise InputError(f"{file}: {joint}_{name} holds a depth below zero")
    _check_later(arrays, joints, rows, bins, of)


def _check_later(
    arrays: Mapping[str, Array],
    joints: tuple[str, ...],
    rows: int,
    bins: int,
    of: Callable[..., Array],
) -> None:
    """Arrays that results of older versions lack."""
    flat = "cycles" in arrays and arrays["cycles"].ndim == 1
    count = {
        name: len(arrays[name]) if name in arrays and arrays[name].ndim else 0
        for name in ("wear_batch_cycles", "cycles", "deviation")
    }
    shapes: dict[str, tuple[int | None, ...]] = {
        "drive_torque": (rows, None),
        "wear_batch_cycles": (None,),
        # Of a run that failed in its first cycle older versions stored an empty list.
        "cycles": (0,) if flat else (None, None),
        "cycle_start": (count["cycles"],),
        "deviation": (None, 4),
        "deviation_start": (count["deviation"],),
    }
    for joint in joints:
        shapes[f"{joint}_contacts"] = (None, 6)
        shapes[f"{joint}_wear_batches"] = (count["wear_batch_cycles"], 2, bins)
        shapes[f"{joint}_flight"] = (count["deviation"],)
    for name, shape in shapes.items():
        if name in arrays:
            of(name, *shape)
