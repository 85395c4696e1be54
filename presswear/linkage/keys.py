"""Keys of a linkage as plain data, and what stands behind each."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from presswear.linkage.elements import BAR, Body, Guide
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force, Harmonics, Load, OverPosition, OverTime, Spring
from presswear.linkage.motions import Drive, Follow
from presswear.linkage.points import ANGLE as ANGLE
from presswear.linkage.points import LENGTH as LENGTH
from presswear.tools.quantities import Quantity, meaning_of
from presswear.tools.serialize import LARGEST

Data = Mapping[str, Any]


def _own(owner: type, *names: str, unit: str = "") -> dict[str, Quantity]:
    """Meanings of fields of a data class, by their names; in a unit of their own."""
    found = {item.name: meaning_of(item) for item in fields(owner)}
    meant = {name: found[name] for name in names}
    return {
        name: replace(own, unit=unit or own.unit)
        for name, own in meant.items()
        if isinstance(own, Quantity)
    }


def _any(unit: str, text: str) -> Quantity:
    return Quantity(unit, -LARGEST, LARGEST, "", text)


TEXT, END, POINTS, ANGLES, YES, OWN = "text", "end", "points", "angles", "yes or no", "own"


@dataclass(frozen=True)
class Columns:
    """Rows of numbers, as many in each as there are meanings, or as often the last as needed."""

    meanings: tuple[Quantity, ...]
    widths: tuple[int, ...]
    text: str


@dataclass(frozen=True)
class Inner:
    """A table inside a table, or a list of them."""

    keys: "Mapping[str, Kind]"
    needed: tuple[str, ...]
    text: str
    is_list: bool = False


Kind = Quantity | Columns | Inner | str
"""What stands behind a key."""


def _motion_of(unit: Quantity, whose: str) -> dict[str, Kind]:
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
        "length": BAR,
        **_own(Body, "mass", "inertia"),
        "points": POINTS,
    },
    "pins": {"name": TEXT, "first": END, "second": END},
    "guides": {
        "name": TEXT,
        "body": TEXT,
        **_own(Guide, "x", "y", "direction", "angle"),
    },
    "drives": {
        "body": TEXT,
        **_own(Drive, "speed", "angle", "frequency", "torque_limit"),
        **_motion_of(ANGLE, "the angle"),
        "follow": Inner(
            {
                "point": END,
                **_own(Follow, "direction"),
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
        **_own(Spring, "stiffness", "length", "damping"),
    },
    "loads": {
        "body": TEXT,
        **_own(Load, "x", "y", "moment"),
    },
}
"""Keys of each table of a linkage, and what stands there; see ``known_of`` for loads."""


def _law_keys(size: str, unit: str, over: str, place: str) -> dict[str, Kind]:
    """Keys of the laws of a force or a moment, whose units and names are given."""
    value = _any(unit, "")
    return {
        size: _any(unit, "size, or mean beside harmonics"),
        "harmonics": Columns((value,), (2,), "cosine and sine of each harmonic of the load"),
        **_own(Harmonics, "frequency"),
        "over_time": Columns((_any("s", ""), value), (2,), "time, and the size of the load then"),
        **_own(OverTime, "period"),
        over: Columns((_any(place, ""), value), (2,), "position, and the size of the load there"),
        "sense": TEXT,
        "outside": TEXT,
        **_own(OverPosition, "zero", "repeats", unit=place),
        **_own(OverPosition, "rise", unit=f"{place}/s"),
        **_own(OverPosition, "unloading", unit=f"{unit}/{place}"),
        "release": YES,
        "function": OWN,
    }


FORCE: Mapping[str, Kind] = {
    "point": END,
    **_own(Force, "direction"),
    "name": TEXT,
    **_law_keys("force", "N", "over_position", "m"),
}
MOMENT: Mapping[str, Kind] = {"body": TEXT, **_law_keys("moment", "N m", "over_angle", "rad")}
TABLE_KEYS = ("sense", "outside", "zero", "rise", "release", "repeats", "unloading")
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
    "direction": replace(ANGLE, text="direction in which the point is watched"),
    "guess": ANGLES,
    **_own(Linkage, "cycle", "run_up", "gravity"),
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
