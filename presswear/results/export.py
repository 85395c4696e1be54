"""Exchange table: a run as CSV or NPZ, for export and for comparison.

One column per quantity, one row per time, SI units:

====================  =======  ====================================================
column                unit     meaning
====================  =======  ====================================================
time                  s        strictly increasing, from the start of the run
displacement          m        of the slider, from where it starts
velocity              m/s      of the slider
acceleration          m/s^2    of the slider
J_eccentricity_x, _y  m        pin centre minus bearing centre of joint J, global
J_penetration         m        of the pin into the bearing, negative while open
J_normal_force        N        between pin and bearing, 0 while open
J_tangential_force    N        friction, with the sign of the contact model
J_sliding             m/s      tangential speed at the contact
height                m        of the output over the ideal bottom dead centre
process_force         N        of the work, where the scene has a process
D_angle               rad      of the driven body D
D_torque              N m      of its drive, where torques are stored
D_power               W        of its drive, where torques are stored
====================  =======  ====================================================

J is the name of a clearance joint, such as A or C, and D that of a driven body.  A table needs
``time`` and at least one other column; their order is free.  CSV: a header line with the names,
values separated by commas, lines that begin with ``#`` are comments.  NPZ: one
array of one dimension per column, under its name.
"""

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
UNITS = {**_SERIES, "height": "m", "process_force": "N"}
JOINT_UNITS = {
    "eccentricity_x": "m",
    "eccentricity_y": "m",
    "penetration": "m",
    "normal_force": "N",
    "tangential_force": "N",
    "sliding": "m/s",
}
DRIVE_UNITS = {"angle": "rad", "torque": "N m", "power": "W"}
MOMENT_UNITS = {
    f"{moment.name}_{number}": unit
    for moment in fields(Strokes)
    for number, unit in (("time", "s"), ("height", "m"))
}
_ENDS = ("", "_low", "_high")
LIFE_UNITS = {"strokes": "1"} | {
    name + end: item.unit for name, item in FOLLOWED.items() for end in _ENDS if not item.of_joint
}
LIFE_JOINT_UNITS = {
    name + end: item.unit for name, item in FOLLOWED.items() for end in _ENDS if item.of_joint
}
TOLERANCE = 1e-3  # root mean square difference, of the root mean square of the column


@dataclass(frozen=True)
class ColumnDifference:
    """Difference between a column of a table and the run.

    Attributes
    ----------
    greatest, rms : float
        Largest and root mean square difference, in the unit of the column.
    bound : float
        Largest ``rms`` that is allowed.
    """

    column: str
    unit: str
    greatest: float
    rms: float
    bound: float

    @property
    def passed(self) -> bool:
        """True if the difference is within the bound."""
        return self.rms <= self.bound


def unit_of(column: str) -> str:
    """Return the unit of a column; InputError for an unknown name."""
    units = UNITS | MOMENT_UNITS | LIFE_UNITS
    if column in units:
        return units[column]
    # Names of joints and bodies may hold underscores too.
    of_parts = DRIVE_UNITS | LIFE_JOINT_UNITS | JOINT_UNITS
    for quantity in sorted(of_parts, key=len, reverse=True):
        if column.removesuffix(f"_{quantity}") not in ("", column):
            return of_parts[quantity]
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
        columns |= {
            f"{name}_{quantity}": value for quantity, value in zip(JOINT_UNITS, values, strict=True)
        }
    for body, curve in curves_of(result.scene, item).items():
        columns |= {
            f"{body}_{quantity}": values
            for quantity in DRIVE_UNITS
            if (values := getattr(curve, quantity)).size
        }
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
        columns |= dict(zip((name, f"{name}_low", f"{name}_high"), values.T, strict=True))
    return columns


def check_table(table: Table, source: str) -> None:
    """Raise InputError naming the source if a table cannot be compared."""
    for name in table:
        try:
            unit_of(name)
        except InputError as error:
            raise InputError(f"{source}: {error}") from None
    if "time" not in table or len(table) < 2:
        missing = "time" if "time" not in table else "any column beside time"
        raise InputError(f"{source} lacks {missing}; it has {', '.join(table) or 'no column'}")
    rows = table["time"].size
    if rows == 0:
        raise InputError(f"{source} has no rows")
    for name, values in table.items():
        if values.size != rows:
            raise InputError(f"{source}: {name} has {values.size} values, time has {rows}")
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            raise InputError(
                f"{source}: {name} is {values[wrong[0]]} in row {wrong[0] + 1}; "
                "a finite number is expected"
            )
    late = np.flatnonzero(np.diff(table["time"]) <= 0.0)
    if late.size:
        raise InputError(
            f"{source}: time does not increase from row {late[0] + 1} to row {late[0] + 2}"
        )


def write_table(path: Path, table: Table) -> None:
    """Write a table as ``.csv`` or ``.npz``; refuses to overwrite."""
    kind = _suffix(path)
    check_name(path)
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
    """Read and check a ``.csv`` or ``.npz`` table; InputError names place and error."""
    kind = _suffix(path)
    check_name(path)
    table = _from_npz(path) if kind == ".npz" else _from_csv(path)
    check_table(table, str(path))
    return table


def _suffix(path: Path) -> str:
    kind = path.suffix.lower()
    if kind not in (".csv", ".npz"):
        raise InputError(f"{path}: a name that ends in .csv or .npz is expected")
    return kind


def _from_npz(path: Path) -> dict[str, Array]:
    arrays = read_numbers(path)
    for name, values in arrays.items():
        if values.ndim != 1:
            raise InputError(f"{path}: {name} is no array of real numbers with one dimension")
    return arrays


def _from_csv(path: Path) -> dict[str, Array]:
    """Return the columns of a text; numpy's readers do not name the place of an error."""
    try:
        lines = read_checked(path).decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no text: {error}") from None
    rows = [
        (number, [word.strip() for word in line.split(",")])
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    names = [word.strip('"') for word in rows[0][1]] if rows else []
    if len(set(names)) < len(names):
        raise InputError(f"{path}: a column is named twice in {', '.join(names)}")
    columns = np.empty((len(names), max(len(rows) - 1, 0)))
    for row, (number, words) in enumerate(rows[1:]):
        place = f"{path}, line {number}"
        if len(words) != len(names):
            raise InputError(f"{place}: {len(words)} values for {len(names)} columns")
        for name, column, word in zip(names, columns, words, strict=True):
            try:
                column[row] = float(word)
            except ValueError:
                raise InputError(f"{place}: {name} is {word!r}; a number is expected") from None
    return dict(zip(names, columns, strict=True))


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
        if name == "time":
            continue
        mine = _interpolated(ours, name, wanted)
        off = values[common] - mine
        differences.append(
            ColumnDifference(
                name,
                unit_of(name),
                float(np.abs(off).max()),
                _rms(off),
                tolerance * _rms(mine),
            )
        )
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
