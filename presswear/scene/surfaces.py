"""Surfaces that a scene begins on: those of another run, or measured ones."""

import math
from collections.abc import Callable, Mapping
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from presswear.linkage.surface import SIDES, Surface, bin_centres
from presswear.scene.bearing import MIN_ANGLES, Bearing
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import read_checked
from presswear.tools.folders import check_file
from presswear.tools.quantities import Quantity, parse_quantity

Surfaces = Mapping[str, tuple[Any, Any]]
"""Bearing and pin by joint; see ``Scene.surfaces`` for what stands for a side."""

TABLE = ".csv"
"""Ending of a table of measured profiles."""
_HEADER = "joint,side,angle (deg),depth (um)"
_COLUMNS = {
    "joint": None,
    "side": None,
    "angle": Quantity("rad", -math.inf, math.inf, "", ""),
    "depth": Quantity("m", -math.inf, math.inf, "", ""),
}
_TURN = 2.0 * math.pi


def settled(
    surfaces: Surfaces, joints: tuple[str, ...], bearing: Callable[[str], Bearing]
) -> dict[str, tuple[Surface, Surface]]:
    """Surfaces on the bins of a scene's maps, without joints that are round.

    Parameters
    ----------
    surfaces : mapping
        As a person gave them, or as they were stored.
    joints : tuple of str
        Those with clearance.
    bearing : callable
        Gives the bearing of a joint.

    Raises
    ------
    InputError
        Naming joint, side and angle of what does not fit.
    """
    if not isinstance(surfaces, Mapping):
        raise InputError(f"surfaces = {surfaces!r}: bearing and pin by joint are expected")
    found = {}
    for name, pair in surfaces.items():
        if not joints:
            raise InputError(f"surfaces of {name}: no joint of the scene has clearance")
        if name not in joints:
            raise unknown("joint in surfaces", name, joints)
        sides = tuple(pair) if isinstance(pair, tuple | list) else ()
        if len(sides) != len(SIDES):
            raise InputError(f"surfaces of {name}: a pair, bearing and pin, is expected")
        own = bearing(name)
        first, second = (
            _surface(f"{side} at {name}", given, own)
            for side, given in zip(SIDES, sides, strict=True)
        )
        if first.is_worn or second.is_worn:
            found[name] = first, second
    return found


def _surface(where: str, given: Any, bearing: Bearing) -> Surface:
    """One side on the bins of its joint; empty where it is round."""
    if given is None:
        return Surface()
    if isinstance(given, Mapping):  # as stored
        given = given.get("depth")
    try:
        values = np.array(given.depth if isinstance(given, Surface) else given)
    except ValueError:
        values = np.array(None)  # rows of several lengths
    if values.shape == (0,):
        return Surface()
    if values.ndim == 1:
        values = np.column_stack([bin_centres(values.size), values])
    is_number = values.dtype.kind in "fiu"
    if not (is_number and values.ndim == 2 and values.shape[1] == 2 and np.isfinite(values).all()):
        raise InputError(f"{where}: finite depths, or rows of angle and depth, are expected")
    angle, depth = values[np.argsort(values[:, 0] % _TURN, kind="stable")].T
    if not depth.any():
        return Surface()
    angle = angle % _TURN
    _check_depths(where, angle, depth, bearing.clearance)
    _check_angles(where, angle)
    bins = bin_centres(bearing.angles)
    if angle.size == bins.size and np.allclose(angle, bins, 0.0, 1e-9):
        return Surface(depth)
    return Surface(_rebinned(angle, depth, bins.size))


def _check_depths(where: str, angle: Array, depth: Array, clearance: float) -> None:
    wrong = np.flatnonzero((depth < 0.0) | (depth > clearance))
    if wrong.size:
        k = wrong[0]
        raise InputError(
            f"{where}: depth {depth[k]:g} m at {math.degrees(angle[k]):g} deg: allowed is 0 to "
            f"{clearance:g} m, the clearance"
        )


def _check_angles(where: str, angle: Array) -> None:
    """InputError unless angles in [0, 2 pi), in order, are apart and leave no gap."""
    widest = _TURN / MIN_ANGLES
    gaps = np.diff(angle, append=angle[0] + _TURN)
    k = int(gaps.argmin())
    if gaps[k] < 1e-9:
        twice = math.degrees(angle[k])
        raise InputError(f"{where}: the angle {twice:g} deg is there twice; a turn has it once")
    wide = np.flatnonzero(gaps > widest * (1.0 + 1e-6))
    if wide.size:
        k = int(wide[0])
        begin, end = (math.degrees(own) for own in (angle[k], angle[k] + gaps[k]))
        raise InputError(
            f"{where}: {angle.size} angles, none between {begin:g} and {end:g} deg; a whole turn "
            f"in steps of at most {math.degrees(widest):g} deg is expected"
        )


def _rebinned(angle: Array, depth: Array, bins: int) -> Array:
    """Mean depth, m, of equal bins of a turn, by the monotone cubic through points of it.

    It is the curve that the program runs on (``Surface``), and its integral, the worn volume,
    stays what it is; of equally spaced points that is their sum.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        In [0, 2 pi), in order, rad.
    """
    from scipy.interpolate import PchipInterpolator  # slow to import

    # Neighbours beyond both ends: the curve is closed.
    around = np.concatenate([angle[-3:] - _TURN, angle, angle[:3] + _TURN])
    with np.errstate(over="ignore"):  # of slopes next to nothing
        area = PchipInterpolator(around, np.concatenate([depth[-3:], depth, depth[:3]]))
    edges = np.linspace(0.0, _TURN, bins + 1)
    mean = np.diff(area.antiderivative()(edges)) * bins / _TURN
    return np.maximum(mean, 0.0)


def read_profiles(file: Path) -> dict[str, tuple[Array, Array]]:
    """Profiles measured on bearings and pins, rows of angle, rad, and depth, m, by joint.

    The table is text with commas: a header such as ``joint,side,angle (deg),depth (um)``, the
    columns in any order, then a row for each place; lines that begin with ``#`` are comments.  A
    side that has no row is round.

    Raises
    ------
    InputError
        Naming the file and the line of what cannot be read.
    """
    check_file(file)
    try:
        lines = read_checked(file).decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError(f"{file} is no text: {error}") from None
    told = [
        (number, [word.strip().strip('"') for word in line.split(",")])
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(told) < 2:
        raise InputError(f"{file}: it has no rows; a header such as {_HEADER} is expected")
    (_, header), *rows = told
    try:
        sizes = dict(map(_column, header))
        if len(sizes) < len(header):
            raise InputError(f"a column is there twice; a header such as {_HEADER} is expected")
        for name in _COLUMNS:
            if name not in sizes:
                raise InputError(f"it has no column {name}; a header such as {_HEADER} is expected")
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    points: dict[str, tuple[list[Any], list[Any]]] = {}
    for number, words in rows:
        try:
            if len(words) != len(header):
                raise InputError(f"{len(words)} values for {len(header)} columns")
            row = dict(zip(sizes, words, strict=True))
            if row["side"] not in SIDES:
                raise unknown("side", row["side"], SIDES)
            place = [_number(name, row[name]) * sizes[name] for name in ("angle", "depth")]
        except InputError as error:
            raise InputError(f"{file}, line {number}: {error}") from None
        points.setdefault(row["joint"], ([], []))[SIDES.index(row["side"])].append(place)
    return {name: (np.array(first), np.array(second)) for name, (first, second) in points.items()}


def _column(word: str) -> tuple[str, float]:
    """Name of a column, and the size of its unit where it has one."""
    name = "".join(takewhile(str.isalpha, word))
    unit = word[len(name) :].strip(" ()[]")
    if name not in _COLUMNS:
        raise unknown("column", word, _COLUMNS)
    meaning = _COLUMNS[name]
    if meaning is None:
        return name, 1.0
    if not unit:
        raise InputError(f"{name} has no unit; a header such as {_HEADER} is expected")
    return name, parse_quantity(name, f"1 {unit}", meaning)


def _number(name: str, word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name} is {word!r}; a finite number is expected")
    return value
