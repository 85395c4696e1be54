"""Keys of a linkage as plain data, and what stands behind each."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from presswear.linkage.elements import RUN_UP
from presswear.tools.quantities import Meaning

Data = Mapping[str, Any]


def _any(unit: str, text: str) -> Meaning:
    return Meaning(unit, -math.inf, math.inf, "", text)


def _above(unit: str, text: str) -> Meaning:
    return Meaning(unit, 0.0, math.inf, "", text, open_low=True)


TEXT, END, POINTS, ANGLES, YES, OWN = "text", "end", "points", "angles", "yes or no", "own"


@dataclass(frozen=True)
class Columns:
    """Rows of numbers, as many in each as there are meanings, or as often the last as needed."""

    meanings: tuple[Meaning, ...]
    widths: tuple[int, ...]
    text: str


@dataclass(frozen=True)
class Inner:
    """A table inside a table, or a list of them."""

    keys: "Mapping[str, Kind]"
    needed: tuple[str, ...]
    text: str
    is_list: bool = False


Kind = Meaning | Columns | Inner | str
"""What stands behind a key."""

LENGTH, ANGLE = _any("m", ""), _any("rad", "")


def _motion_of(unit: Meaning, whose: str) -> dict[str, Kind]:
    """Keys of a motion: angles of a drive, or lengths of a point that is followed."""
    rise: dict[str, Kind] = {"start": ANGLE, "end": ANGLE, "by": unit, "law": TEXT}
    return {
        "harmonics": Columns((unit,), (2,), f"cosine and sine of each harmonic of {whose}"),
        "table": Columns((ANGLE, unit), (2, 4), f"phase of the cycle, and {whose} there"),
        "rises": Inner(rise, ("start", "end", "by"), f"parts where {whose} rises", True),
    }


TABLES: Mapping[str, Mapping[str, Kind]] = {
    "bodies": {
        "name": TEXT,
        "length": _above("m", "of a bar: from its tail to its head, its mass centre halfway"),
        "mass": _above("kg", "mass"),
        "inertia": _above("kg m^2", "about the mass centre; of a bar m l^2 / 12 if not given"),
        "points": POINTS,
    },
    "pins": {"name": TEXT, "first": END, "second": END},
    "guides": {
        "name": TEXT,
        "body": TEXT,
        "x": _any("m", "a point of the line, to the right of the origin"),
        "y": _any("m", "a point of the line, above the origin"),
        "direction": _any("rad", "angle of the line"),
        "angle": _any("rad", "fixed angle of the body"),
    },
    "drives": {
        "body": TEXT,
        "speed": _any("rad/s", "mean speed, counterclockwise"),
        "angle": _any("rad", "angle of the body at the start"),
        "frequency": _any("rad/s", "frequency of what repeats; 0: the mean speed"),
        **_motion_of(ANGLE, "the angle"),
        "follow": Inner(
            {
                "point": END,
                "direction": _any("rad", "direction of the curve that a point follows"),
                **_motion_of(LENGTH, "the point"),
            },
            ("point",),
            "a point follows a curve, given from where it starts",
        ),
    },
    "springs": {
        "name": TEXT,
        "first": END,
        "second": END,
        "stiffness": _any("N/m", "stiffness"),
        "length": _any("m", "length without force"),
        "damping": _any("N s/m", "damping"),
    },
    "loads": {
        "body": TEXT,
        "x": _any("N", "force to the right, at the mass centre"),
        "y": _any("N", "force upwards"),
        "moment": _any("N m", "moment, counterclockwise"),
    },
}
"""Keys of each table of a linkage, and what stands there; see ``known_of`` for loads."""


def _law_keys(size: str, unit: str, over: str, place: str) -> dict[str, Kind]:
    """Keys of the laws of a force or a moment, whose units and names are given."""
    value = _any(unit, "")
    return {
        size: _any(unit, "size, or mean beside harmonics"),
        "harmonics": Columns((value,), (2,), "cosine and sine of each harmonic of the load"),
        "frequency": _any("rad/s", "frequency of the first harmonic"),
        "over_time": Columns((_any("s", ""), value), (2,), "time, and the size of the load then"),
        "period": _any("s", "after which the table repeats; 0: never; else after a cycle"),
        over: Columns((_any(place, ""), value), (2,), "position, and the size of the load there"),
        "sense": TEXT,
        "outside": TEXT,
        "zero": _any(place, "where the table has its zero"),
        "rise": _above(f"{place}/s", "speed from which a load in one sense is whole"),
        "release": YES,
        "repeats": _any(place, "after which the table repeats; 0: never"),
        "function": OWN,
    }


FORCE: Mapping[str, Kind] = {
    "point": END,
    "direction": _any("rad", "direction of the force"),
    **_law_keys("force", "N", "over_position", "m"),
}
MOMENT: Mapping[str, Kind] = {"body": TEXT, **_law_keys("moment", "N m", "over_angle", "rad")}
TABLE_KEYS = ("sense", "outside", "zero", "rise", "release", "repeats")
LAWS: Mapping[str, tuple[str, ...]] = {
    "over_time": ("period",),
    "over_position": TABLE_KEYS,
    "over_angle": TABLE_KEYS,
    "harmonics": ("force", "moment", "frequency"),
    "function": (),
}
"""Laws of loads by the key that tells them, and the keys that go with each."""


def known_of(table: str, row: Mapping[str, Any]) -> Mapping[str, Kind]:
    """Keys of a row of a table: loads are constant, or forces or moments with a law."""
    if table == "loads" and "point" in row:
        return FORCE
    if table == "loads" and not row.keys().isdisjoint(MOMENT.keys() - TABLES["loads"].keys()):
        return MOMENT
    return TABLES[table]


WHOLE: Mapping[str, Kind] = {
    "name": TEXT,
    "watch": END,
    "direction": _any("rad", "direction in which the point is watched"),
    "guess": ANGLES,
    "cycle": _above("s", "time after which the motion repeats"),
    "run_up": RUN_UP,
    "gravity": _any("m/s^2", "acceleration along -y"),
}
"""Keys of a linkage beside its tables."""

NEEDED = {
    "bodies": ("name", "mass"),
    "pins": ("name", "first", "second"),
    "guides": ("name", "body"),
    "drives": ("body",),
    "springs": ("name", "first", "second", "stiffness", "length"),
    "loads": ("body",),
}
