"""Exchange table: a run as CSV or NPZ, for export and for comparison.

One column per quantity, one row per time, SI units. Columns of a joint J or of a driven body D are
``J_penetration`` or ``D_torque``; units and meaning of all names are below. A table needs ``time``,
strictly increasing, and at least one other column; their order is free. CSV: a header line with the
names, values separated by commas, lines that begin with ``#`` are comments. NPZ: one array of one
dimension per column, under its name.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from presswear.results.press_analysis import Strokes, curves_of, height_of, process_force
from presswear.results.result import Result
from presswear.scene.options import FOLLOWED
from presswear.tools.arrays import read_numbers, write_arrays
from presswear.tools.errors import InputError
from presswear.tools.files import check_name, read_checked, write_whole

Array = NDArray[np.float64]
Table = Mapping[str, Array]  # columns by name, all of one length

_SERIES = {"time": "s", "displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}
UNITS = {
    **_SERIES,  # of the output, from its start
    "height": "m",  # of the output over the ideal bottom dead centre
    "process_force": "N",  # of the work, if the scene has a process
}
JOINT_UNITS = {
    "eccentricity_x": "m",  # pin centre minus bearing centre, global
    "eccentricity_y": "m",
    "penetration": "m",  # of the pin into the bearing, negative while open
    "normal_force": "N",  # 0 while open
    "tangential_force": "N",  # friction, with the sign of the contact model
    "sliding": "m/s",  # tangential speed at the contact
}
DRIVE_UNITS = {"angle": "rad", "torque": "N m", "power": "W"}  # torque, power: if stored
MOMENT_UNITS = {
    f"{moment.name}_{number}": unit
    for moment in fields(Strokes)
    for number, unit in (("time", "s"), ("height", "m"))
}
_ENDS = ("", "_low", "_high")
_LIFE = {(item.of_joint, name + end): item.unit for name, item in FOLLOWED.items() for end in _ENDS}
_ALL_UNITS = {"strokes": "1", **UNITS, **MOMENT_UNITS}
_ALL_UNITS |= {name: unit for (of_joint, name), unit in _LIFE.items() if not of_joint}
_PART_UNITS = {**DRIVE_UNITS, **JOINT_UNITS}
_PART_UNITS |= {name: unit for (of_joint, name), unit in _LIFE.items() if of_joint}
TOLERANCE = 1e-3  # root mean square difference, of the root mean square of the column


@dataclass(frozen=True)
class ColumnDifference:
    """Difference between a column of a table and the run, in the unit of the column."""

    column: str
    unit: str
    greatest: float
    rms: float
    bound: float  # largest ``rms`` that is allowed

    @property
    def passed(self) -> bool:
        """True if the difference is within the bound."""
        return self.rms <= self.bound


def unit_of(column: str) -> str:
    """Return the unit of a column; InputError for an unknown name."""
    if column in _ALL_UNITS:
        return _ALL_UNITS[column]
    # Names of joints and bodies may hold underscores too.
    for quantity in sorted(_PART_UNITS, key=len, reverse=True):
        if column.removesuffix(f"_{quantity}") not in ("", column):
            return _PART_UNITS[quantity]
    names = [*UNITS, *(f"J_{n}" for n in JOINT_UNITS), *(f"D_{n}" for n in DRIVE_UNITS)]
    raise InputError(
        f"unknown column {column!r}; known are {', '.join(names)}, J a joint such as A, D a "
        "driven body"
    )


def table_of(result: Result, stage: int) -> dict[str, Array]:
    """Return the recorded series of a stage; InputError if there is no such stage."""
    item = result.stage(stage)
    columns = {name: getattr(item, name) for name in _SERIES}
    columns["height"] = height_of(result.scene, item)
    force = process_force(result.scene, item)
    if force is not None:
        columns["process_force"] = force
    for name, joint in item.joints.items() if item.has_joint_series else ():
        values = (*joint.eccentricity.T, joint.penetration, *joint.force.T, joint.sliding)
        columns |= {f"{name}_{key}": row for key, row in zip(JOINT_UNITS, values, strict=True)}
    for body, curve in curves_of(result.scene, item).items():
        series = {f"{body}_{key}": getattr(curve, key) for key in DRIVE_UNITS}
        columns |= {name: values for name, values in series.items() if values.size}
    return columns


def strokes_table(result: Result, stage: int) -> dict[str, Array]:
    """Return the instants of the recorded strokes of a stage on the work, one row per stroke.

    Missing instants are nan. InputError if there is no such stage, or no stroke on the work.
    """
    strokes = result.strokes(stage)
    if strokes is None or not len(strokes.contact):
        why = "the scene has no process" if strokes is None else "no stroke touches the work"
        raise InputError(f"stage {stage} of {result.scene.name} has no strokes to write: {why}")
    columns = np.hstack([getattr(strokes, moment.name) for moment in fields(Strokes)])
    return dict(zip(MOMENT_UNITS, columns.T, strict=True))


def life_table(result: Result) -> dict[str, Array]:
    """Return the quantities of a service life over strokes; InputError without a life."""
    if result.life is None:
        raise InputError(f"{result.scene.name} has no life to write: it was worn until no limit")
    curves = dict(result.life.curves)
    columns = {"strokes": curves.pop("strokes")}
    for key, values in curves.items():
        name = key.replace(".", "_")
        columns |= {f"{name}{end}": row for end, row in zip(_ENDS, values.T, strict=True)}
    return columns


def write_table(path: Path, table: Table) -> None:
    """Write a table as ``.csv`` or ``.npz``; refuses to overwrite."""
    kind = _suffix(path)
    if path.exists():
        raise InputError(f"{path} exists; name a new file")
    if not path.parent.is_dir():
        raise InputError(f"{path.parent} is no folder")
    if kind == ".npz":
        write_arrays(path, table)
        return

    def write(file: BinaryIO) -> None:
        # The names come first: numpy.genfromtxt takes them from the first line.
        units = ",".join(f"{name} {unit_of(name)}" for name in table)
        file.write(f"{','.join(table)}\n# units: {units}\n".encode())
        np.savetxt(file, np.column_stack(list(table.values())), fmt="%.17g", delimiter=",")

    write_whole(path, write)


def read_table(path: Path) -> dict[str, Array]:
    """Read and check a ``.csv`` or ``.npz`` table; InputError names file and error."""
    table = read_numbers(path) if _suffix(path) == ".npz" else _from_csv(path)
    try:
        for name in table:
            unit_of(name)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    if "time" not in table or len(table) < 2:
        missing = "time" if "time" not in table else "any column beside time"
        raise InputError(f"{path} lacks {missing}; it has {', '.join(table) or 'no column'}")
    time = table["time"]
    if time.size == 0:
        raise InputError(f"{path} has no rows")
    for name, values in table.items():
        if values.shape != (time.size,):
            raise InputError(f"{path}: {name} has {values.size} values, time has {time.size}")
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            raise InputError(
                f"{path}: {name} is {values[wrong[0]]} in row {wrong[0] + 1}; a finite number is "
                "expected"
            )
    late = np.flatnonzero(np.diff(time) <= 0.0)
    if late.size:
        raise InputError(f"{path}: time does not increase from row {late[0] + 1} to {late[0] + 2}")
    return table


def _suffix(path: Path) -> str:
    check_name(path)
    kind = path.suffix.lower()
    if kind not in (".csv", ".npz"):
        raise InputError(f"{path}: a name that ends in .csv or .npz is expected")
    return kind


def _from_csv(path: Path) -> dict[str, Array]:
    try:
        lines = read_checked(path).decode("utf-8-sig").splitlines()
        lines = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
        header = lines[0].split(",") if lines else []
        names = [name.strip().strip('"') for name in header]
        if len(set(names)) < len(names):
            raise InputError(f"{path}: a column is named twice in {', '.join(names)}")
        empty = np.empty((0, len(names)))
        rows = np.loadtxt(lines[1:], delimiter=",", ndmin=2) if len(lines) > 1 else empty
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no text: {error}") from None
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        text = f"{error}"
        if place := re.search(r"at row (\d+), column", text):  # numpy counts such rows from 0
            text = text.replace(place[0], f"in row {int(place[1]) + 1}, column")
        raise InputError(f"{path}: {text}") from None
    if rows.shape[1] != len(names):
        raise InputError(f"{path}: {rows.shape[1]} values in a row for {len(names)} columns")
    return dict(zip(names, rows.T, strict=True))


def compare_tables(
    ours: Table, theirs: Table, until: float | None, tolerance: float
) -> list[ColumnDifference]:
    """Return differences column by column at the times of a table that lie within the run.

    The displacement of the run between rows is the cubic through displacements and velocities, the
    velocity its derivative; other columns are monotone cubics.

    Parameters
    ----------
    until : float or None
        Last time compared, s; None: the whole overlap.
    tolerance : float
        Bound of the rms difference relative to the rms of the column.
    """
    time = ours["time"]
    if time.size < 2:
        raise InputError("the run holds no motion to compare with")
    unknown = [name for name in theirs if name not in ours]
    if unknown:
        raise InputError(f"column {unknown[0]!r} is not in the run; it has {', '.join(ours)}")
    last = float(time[-1]) if until is None else min(until, float(time[-1]))
    common = (theirs["time"] >= time[0]) & (theirs["time"] <= last)
    if not common.any():
        raise InputError(
            f"no overlap: the run is compared from {time[0]:g} to {last:g} s, the table goes "
            f"from {theirs['time'][0]:g} to {theirs['time'][-1]:g} s"
        )
    wanted = theirs["time"][common]
    differences = []
    for name, values in theirs.items():
        if name != "time":
            mine = _interpolated(ours, name, wanted)
            off = values[common] - mine
            greatest, bound = float(np.abs(off).max()), tolerance * _rms(mine)
            differences.append(ColumnDifference(name, unit_of(name), greatest, _rms(off), bound))
    return differences


def _interpolated(ours: Table, name: str, wanted: Array) -> Array:
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator  # slow to import

    time = ours["time"]
    if name in ("displacement", "velocity"):
        cubic = CubicHermiteSpline(time, ours["displacement"], ours["velocity"])
        return np.asarray((cubic if name == "displacement" else cubic.derivative())(wanted))
    return np.asarray(PchipInterpolator(time, ours[name])(wanted))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
