"""Readings of worn joints at inspections, in a file or from a script."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from presswear.scene.files import read_table
from presswear.scene.options import LIFE_QUANTITIES
from presswear.tools.arguments import checked_arguments
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import read_checked, write_bytes
from presswear.tools.quantities import Quantity, parse_quantity
from presswear.tools.type_check import check_type

FILE = "readings.csv"  # file in the folder of a result
HEADER = "joint,strokes,diametral_clearance (mm),error (mm)"
# quantities of a joint that are read, by the name of the column
QUANTITIES = {
    "depth": "depth",
    "wear_volume": "wear_volume",
    "clearance": "radial_clearance",
    "radial_clearance": "radial_clearance",
    "diametral_clearance": "diametral_clearance",
}
_STROKES = Quantity("", 0.0, 1e15)


@dataclass(frozen=True)
class Reading:
    """Reading of a worn joint at an inspection; numbers in SI, or texts with units."""

    joint: str
    strokes: float  # number of strokes since new
    quantity: str  # depth, wear_volume, radial_clearance or diametral_clearance
    value: float
    error: float | None = None  # standard deviation; None: unknown

    def __post_init__(self) -> None:
        check_type("joint", self.joint, str)
        check_type("quantity", self.quantity, str)
        if self.quantity not in QUANTITIES.values():
            raise unknown("quantity of a reading", self.quantity, QUANTITIES.values())
        value = Quantity(LIFE_QUANTITIES[self.quantity].unit)
        meanings = {"strokes": _STROKES, "value": value}
        if self.error is not None:
            meanings["error"] = replace(value, low=0.0, open_low=True)
        for name, meaning in meanings.items():
            number = meaning.convert(f"{name} of {self.joint}", getattr(self, name))
            object.__setattr__(self, name, float(number))

    @property
    def key(self) -> str:
        """Key of the quantity among the curves of a life, such as ``A.depth``."""
        return f"{self.joint}.{self.quantity}"


@checked_arguments
def read_readings(file: str | Path) -> tuple[Reading, ...]:
    """Return the readings of a table.

    Parameters
    ----------
    file : str or Path
        Text with commas or semicolons: a header such as ``joint,strokes,
        diametral_clearance (mm),error (mm)``, then a row for each reading. One column
        is named depth, wear_volume, clearance, radial_clearance or
        diametral_clearance. The error is the standard deviation of a reading; its
        column may be absent, or empty in all rows of a joint.

    Raises
    ------
    InputError
        With the file and the line.
    """
    names, rows = read_table(Path(file), HEADER)
    column = next((name for name in names if name in QUANTITIES), "")
    needed = ["joint", "strokes", column]
    if not column or sorted(names) not in (sorted(needed), sorted([*needed, "error"])):
        columns = f"{file}: columns {', '.join(names)}"
        kinds = ", ".join(QUANTITIES)
        raise InputError(
            f"{columns}: a header as {HEADER} is expected, with one of {kinds}"
        )
    readings = []
    for number, row in rows:
        try:
            readings.append(_reading(row, column))
        except InputError as error:
            raise InputError(f"{file}, line {number}: {error}") from None
    return tuple(readings)


def _reading(row: dict[str, str], column: str) -> Reading:
    quantity = QUANTITIES[column]
    meaning = Quantity(LIFE_QUANTITIES[quantity].unit)
    strokes = parse_quantity("strokes", row["strokes"], _STROKES)
    value = parse_quantity(column, row[column], meaning)
    text = row.get("error", "")
    error = float(parse_quantity("error", text, meaning)) if text else None
    return Reading(row["joint"], float(strokes), quantity, float(value), error)


def store_readings(folder: Path, file: Path) -> None:
    """Copy the table of readings into the folder of a result, for its report."""
    write_bytes(folder / FILE, read_checked(file))


def check_readings(readings: Sequence[Reading], joints: Sequence[str]) -> None:
    """Raise InputError unless the readings of each joint can be evaluated together."""
    if not readings:
        raise InputError("readings: there are none")
    for name in dict.fromkeys(reading.joint for reading in readings):
        if name not in joints:
            raise unknown("joint with clearance in the readings", name, joints)
        group = [reading for reading in readings if reading.joint == name]
        if len({reading.quantity for reading in group}) > 1:
            raise InputError(f"readings of {name}: one quantity is allowed for a joint")
        with_error = sum(reading.error is not None for reading in group)
        if 0 < with_error < len(group):
            fault = (
                f"{with_error} of {len(group)} have an error; all or none are allowed"
            )
            raise InputError(f"readings of {name}: {fault}")
        worn = sum(reading.strokes > 0.0 for reading in group)
        if not worn:
            raise InputError(f"readings of {name}: one after some strokes is needed")
        if not with_error and worn < 3:
            fault = f"{worn} without an error; add the column error, or give 3 or more"
            raise InputError(f"readings of {name}: {fault}")
