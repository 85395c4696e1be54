"""Exchange table: a run as CSV, NPZ or MAT, for export and for comparison.

One column per quantity, one row per time, SI units. Columns of a joint J or of a driven
body D are ``J_penetration`` or ``D_torque``; units of all names are in ``UNITS``. A
table needs ``time``, strictly increasing, and at least one other column; their order is
free. CSV: a header line with the names, values separated by commas, or by semicolons
where a table is read, lines that begin with ``#`` are comments. NPZ: one array of one
dimension per column, under its name. MAT, which is written only: one column vector per
column, and a structure with their units.
"""

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import chain, product
from pathlib import Path
from typing import BinaryIO

import numpy as np

from presswear.linkage.drives import linear_bodies
from presswear.recording.columns import (
    CYCLE,
    FILM_CYCLE,
    JOINT_CYCLE,
    JOINT_SERIES,
    LEADER_CYCLE,
    SERIES,
    names_of,
)
from presswear.results.drives import curves_of
from presswear.results.result import Result
from presswear.results.strokes import Strokes, height_of, process_force
from presswear.scene.options import LIFE_QUANTITIES
from presswear.tools.arrays import Array, read_numbers, write_arrays
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import (
    MOST_BYTES,
    check_ending,
    read_text,
    separator_of,
    write_bytes,
    write_whole,
)

Table = Mapping[str, Array]  # columns by name, all of one length

# torque, power: if stored
_DRIVE = {"angle": "rad", "speed": "rad/s", "torque": "N m", "power": "W"}
# Names of a drive along a guide
_LINEAR_DRIVE = {"angle": "distance", "speed": "velocity", "torque": "drive_force"}
_LINEAR_UNITS = {"distance": "m", "drive_force": "N"}
UNITS = {
    # First, because names of series end longer names, such as ``load_distance``.
    **{
        column.name: column.unit
        for column in (*CYCLE, *LEADER_CYCLE, *JOINT_CYCLE, *FILM_CYCLE)
    },
    **{column.table_name: column.unit for column in SERIES},
    "clock": "s",  # real time; with a motor ``time`` is the nominal time
    "height": "m",  # height of the output over the ideal bottom dead centre
    "process_force": "N",  # force on the work, if the scene has a process
    **{column.table_name: column.unit for column in JOINT_SERIES},
    **_DRIVE,
    **_LINEAR_UNITS,
    # stretch of an elastic frame, or between the centres of an elastic pin
    "stretch": "m",
    "strokes": "1",
    "replicate": "1",
    **{name: item.unit for name, item in LIFE_QUANTITIES.items()},
}
_INSTANTS = product(fields(Strokes), ("time", "height"))
_MOMENTS = [f"{instant.name}_{number}" for instant, number in _INSTANTS]
_ENDINGS = ".csv", ".npz"  # endings of tables that can be read
_WRITTEN = *_ENDINGS, ".mat"
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
    name = column.removesuffix("_low").removesuffix("_high")
    # Names of joints and bodies may hold underscores too.
    for quantity, unit in UNITS.items():
        if name == quantity or name.endswith(f"_{quantity}"):
            return unit
    raise unknown("column", column, UNITS)


def table_of(result: Result, stage: int) -> dict[str, Array]:
    """Return the recorded series of a stage; InputError if there is no such stage."""
    recorded = result.stage(stage)
    columns = {column.table_name: getattr(recorded, column.name) for column in SERIES}
    if recorded.has_clock:
        columns["clock"] = recorded.clock
    columns["height"] = height_of(result.scene, recorded)
    force = process_force(result.scene, recorded)
    if force is not None:
        columns["process_force"] = force
    if recorded.has_joint_series:
        for name, joint in recorded.joints.items():
            for column in JOINT_SERIES:
                columns[f"{name}_{column.table_name}"] = joint.series(column.name)
    linear = linear_bodies(result.scene.base_linkage.drives)
    for body, curve in curves_of(result.scene, recorded).items():
        for key in _DRIVE:
            label = _LINEAR_DRIVE.get(key, key) if body in linear else key
            values = getattr(curve, key)
            if values.size:
                columns[f"{body}_{label}"] = values
    linkage = result.scene.linkage()
    for k, guide in enumerate(linkage.elastic_guides):
        columns[f"{guide.name}_stretch"] = recorded.arrays["stretch"][:, k]
    for k, pin in enumerate(linkage.elastic_pins):
        columns[f"{pin.name}_stretch"] = recorded.arrays["pin_stretch"][:, k]
    return columns


def strokes_table(result: Result, stage: int) -> dict[str, Array]:
    """Return the instants of the recorded strokes of a stage on the work, one row per stroke.

    Missing instants are nan. InputError if there is no such stage, or no stroke on the
    work.
    """
    strokes = result.strokes(stage)
    fault = f"stage {stage} of {result.scene.name} has no strokes to write"
    if strokes is None:
        raise InputError(f"{fault}: the scene has no process")
    if not len(strokes.contact):
        raise InputError(f"{fault}: no stroke touches the work")
    columns = np.hstack([strokes.contact, strokes.fracture, strokes.separation])
    return dict(zip(_MOMENTS, columns.T, strict=True))


def cycles_table(result: Result, stage: int) -> dict[str, Array]:
    """Return the numbers of each cycle of all replicates, one row per cycle."""
    recorded = result.stage(stage)
    columns = {"replicate": recorded.arrays["cycle_start"].astype(float)}
    for name in names_of((*CYCLE, *(LEADER_CYCLE if recorded.has_clock else ()))):
        columns[name] = recorded.each_cycle(name)
    for joint in recorded.joints.values():
        for name in names_of(joint.cycle_columns):
            columns[f"{joint.name}_{name}"] = joint.each_cycle(name)
    return columns


def life_table(result: Result) -> dict[str, Array]:
    """Return the quantities of a service life over strokes; InputError without a life."""
    if result.life is None:
        raise InputError(
            f"{result.scene.name} has no life to write: its scene has no `life`"
        )
    if not result.life.curves:
        raise InputError(
            f"{result.scene.name}: its life is {result.life.ended}, without curves to write"
        )
    curves = dict(result.life.curves)
    columns = {"strokes": curves.pop("strokes")}
    for key, values in curves.items():
        name = key.replace(".", "_")
        mean, low, high = values.T
        columns |= {name: mean, f"{name}_low": low, f"{name}_high": high}
    return columns


def write_table(
    path: Path, table: Table, units: Mapping[str, str] | None = None
) -> None:
    """Write a table as ``.csv``, ``.npz`` or ``.mat``; refuses to overwrite.

    ``units`` are those of the columns, by default ``unit_of`` their names.
    """
    kind = check_ending(path, *_WRITTEN)
    if path.exists():
        raise InputError(f"{path} exists; name a new file")
    units = units or {name: unit_of(name) for name in table}
    if kind == ".npz":
        write_arrays(path, table)
        return
    if kind == ".mat":
        write_whole(path, lambda file: _write_matlab(file, table, units))
        return
    # The names come first: numpy.genfromtxt takes them from the first line.
    text = ",".join(f"{name} {units[name]}" for name in table)
    head = f"{','.join(table)}\n# units: {text}"
    rows = np.column_stack(list(table.values()))
    form = {"fmt": "%.17g", "delimiter": ",", "comments": "", "encoding": "utf-8"}
    write_whole(path, lambda file: np.savetxt(file, rows, header=head, **form))


def _write_matlab(file: BinaryIO, table: Table, units: Mapping[str, str]) -> None:
    """Write columns as variables of MATLAB, and a structure ``units`` of their units."""
    from scipy.io import savemat  # slow to import

    names = {name: re.sub(r"\W", "_", name) for name in table}
    columns = {names[name]: values for name, values in table.items()}
    unit_names = {names[name]: units[name] for name in table}
    savemat(
        file, {**columns, "units": unit_names}, oned_as="column", long_field_names=True
    )


def write_rows(path: Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Write a table for people as ``.csv``; the columns are those of all rows."""
    text = io.StringIO()
    columns = dict.fromkeys(chain.from_iterable(rows))
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_bytes(path, text.getvalue().encode())


def read_table(path: Path) -> dict[str, Array]:
    """Read and check a ``.csv`` or ``.npz`` table; InputError names file and error."""
    is_csv = check_ending(path, *_ENDINGS) == ".csv"
    table = _read_csv(path) if is_csv else read_numbers(path, most=MOST_BYTES)
    if "time" not in table or len(table) < 2:
        missing = "time" if "time" not in table else "any column besides time"
        raise InputError(
            f"{path} lacks {missing}; it has {', '.join(table) or 'no column'}"
        )
    time = table["time"]
    if time.size == 0:
        raise InputError(f"{path} has no rows")
    for name, values in table.items():
        if values.shape != (time.size,):
            raise InputError(
                f"{path}: {name} has {values.size} values, time has {time.size}"
            )
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            row = wrong[0]
            raise InputError(
                f"{path}: {name} = {values[row]} in row {row + 1}: must be finite"
            )
    late = np.flatnonzero(np.diff(time) <= 0.0)
    if late.size:
        raise InputError(
            f"{path}: time does not increase from row {late[0] + 1} to {late[0] + 2}"
        )
    return table


def _read_csv(path: Path) -> dict[str, Array]:
    stripped = (line.strip() for line in read_text(path).splitlines())
    lines = [line for line in stripped if line and not line.startswith("#")]
    header = "".join(lines[:1])
    separator = separator_of(header)
    names = [name.strip().strip('"') for name in header.split(separator)]
    rows = np.zeros((0, 0))
    try:
        if lines[1:]:
            rows = np.loadtxt(lines[1:], delimiter=separator, ndmin=2)
    except ValueError as error:
        # numpy counts such rows from 0
        text = re.sub(
            r"at row (\d+), column",
            lambda match: f"in row {int(match[1]) + 1}, column",
            str(error),
        )
        raise InputError(f"{path}: {text}") from None
    if len(set(names)) < len(names):
        raise InputError(f"{path}: a column is named twice in {', '.join(names)}")
    if len(rows) and rows.shape[1] != len(names):
        raise InputError(
            f"{path}: {rows.shape[1]} values in a row for {len(names)} columns"
        )
    return dict(zip(names, rows.reshape(-1, len(names)).T, strict=True))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def compare_tables(
    ours: Table, theirs: Table, until: float | None, tolerance: float
) -> list[ColumnDifference]:
    """Return differences column by column at the times of a table that lie within the run.

    The displacement of the run between rows is the cubic through displacements and
    velocities, the velocity its derivative; other columns are monotone cubics.
    ``until`` is the last time compared, s, None for the whole overlap. ``tolerance``
    bounds the rms difference relative to the rms of the column.
    """
    # slow to import
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

    # Other programs know the real time alone.
    time = ours.get("clock", ours["time"])
    if time.size < 2:
        raise InputError("the run contains no motion to compare with")
    for name in theirs:
        if name not in ours:
            raise unknown("column", name, ours)
    last = float(time[-1]) if until is None else min(until, float(time[-1]))
    common = (theirs["time"] >= time[0]) & (theirs["time"] <= last)
    if not common.any():
        table = f"{theirs['time'][0]:g} to {theirs['time'][-1]:g} s"
        raise InputError(
            f"no overlap: run from {time[0]:g} to {last:g} s, table from {table}"
        )
    cubic = CubicHermiteSpline(time, ours["displacement"], ours["velocity"])
    curves = {"displacement": cubic, "velocity": cubic.derivative()}
    differences = []
    for name, values in theirs.items():
        if name != "time":
            curve = curves.get(name) or PchipInterpolator(time, ours[name])
            expected = curve(theirs["time"][common])
            deviation = values[common] - expected
            difference = ColumnDifference(
                name,
                unit_of(name),
                greatest=float(np.abs(deviation).max()),
                rms=_rms(deviation),
                bound=tolerance * _rms(expected),
            )
            differences.append(difference)
    return differences
