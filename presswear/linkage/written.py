"""A linkage as plain data: as results store it, and as a person writes it in a file.

Stored numbers are SI; in a file each has its unit, as on the command line.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from itertools import chain, repeat
from typing import Any

from presswear.linkage.elements import (
    GROUND,
    RUN_UP,
    Attachment,
    Bar,
    Body,
    Guide,
    Linkage,
    Pin,
    Probe,
)
from presswear.linkage.loads import (
    AnyLoad,
    Force,
    Harmonics,
    Law,
    Load,
    Moment,
    OverPosition,
    OverTime,
    Spring,
)
from presswear.linkage.motions import Drive, Follow, Rise
from presswear.tools.errors import InputError, unknown
from presswear.tools.own import OwnFunction
from presswear.tools.quantities import Meaning, parse_quantity

Data = Mapping[str, Any]


def _any(unit: str, text: str) -> Meaning:
    return Meaning(unit, -math.inf, math.inf, "", text)


def _above(unit: str, text: str) -> Meaning:
    return Meaning(unit, 0.0, math.inf, "", text, open_low=True)


_TEXT, _END, _POINTS, _ANGLES, _YES, _OWN = "text", "end", "points", "angles", "yes or no", "own"


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

_LENGTH, _ANGLE = _any("m", ""), _any("rad", "")


def _motion_of(unit: Meaning, whose: str) -> dict[str, Kind]:
    """Keys of a motion: angles of a drive, or lengths of a point that is followed."""
    rise: dict[str, Kind] = {"start": _ANGLE, "end": _ANGLE, "by": unit, "law": _TEXT}
    return {
        "harmonics": Columns((unit,), (2,), f"cosine and sine of each harmonic of {whose}"),
        "table": Columns((_ANGLE, unit), (2, 4), f"phase of the cycle, and {whose} there"),
        "rises": Inner(rise, ("start", "end", "by"), f"parts where {whose} rises", True),
    }


TABLES: Mapping[str, Mapping[str, Kind]] = {
    "bodies": {
        "name": _TEXT,
        "length": _above("m", "of a bar: from its tail to its head, its mass centre halfway"),
        "mass": _above("kg", "mass"),
        "inertia": _above("kg m^2", "about the mass centre; of a bar m l^2 / 12 if not given"),
        "points": _POINTS,
    },
    "pins": {"name": _TEXT, "first": _END, "second": _END},
    "guides": {
        "name": _TEXT,
        "body": _TEXT,
        "x": _any("m", "a point of the line, to the right of the origin"),
        "y": _any("m", "a point of the line, above the origin"),
        "direction": _any("rad", "angle of the line"),
        "angle": _any("rad", "fixed angle of the body"),
    },
    "drives": {
        "body": _TEXT,
        "speed": _any("rad/s", "mean speed, counterclockwise"),
        "angle": _any("rad", "angle of the body at the start"),
        "frequency": _any("rad/s", "frequency of what repeats; 0: the mean speed"),
        **_motion_of(_ANGLE, "the angle"),
        "follow": Inner(
            {
                "point": _END,
                "direction": _any("rad", "direction of the curve that a point follows"),
                **_motion_of(_LENGTH, "the point"),
            },
            ("point",),
            "a point follows a curve, given from where it starts",
        ),
    },
    "springs": {
        "name": _TEXT,
        "first": _END,
        "second": _END,
        "stiffness": _any("N/m", "stiffness"),
        "length": _any("m", "length without force"),
        "damping": _any("N s/m", "damping"),
    },
    "loads": {
        "body": _TEXT,
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
        "sense": _TEXT,
        "outside": _TEXT,
        "zero": _any(place, "where the table has its zero"),
        "rise": _above(f"{place}/s", "speed from which a load in one sense is whole"),
        "release": _YES,
        "repeats": _any(place, "after which the table repeats; 0: never"),
        "function": _OWN,
    }


_FORCE: Mapping[str, Kind] = {
    "point": _END,
    "direction": _any("rad", "direction of the force"),
    **_law_keys("force", "N", "over_position", "m"),
}
_MOMENT: Mapping[str, Kind] = {"body": _TEXT, **_law_keys("moment", "N m", "over_angle", "rad")}
_TABLE_KEYS = ("sense", "outside", "zero", "rise", "release", "repeats")
_LAWS: Mapping[str, tuple[str, ...]] = {
    "over_time": ("period",),
    "over_position": _TABLE_KEYS,
    "over_angle": _TABLE_KEYS,
    "harmonics": ("force", "moment", "frequency"),
    "function": (),
}
"""Laws of loads by the key that tells them, and the keys that go with each."""


def known_of(table: str, row: Mapping[str, Any]) -> Mapping[str, Kind]:
    """Keys of a row of a table: loads are constant, or forces or moments with a law."""
    if table == "loads" and "point" in row:
        return _FORCE
    if table == "loads" and not row.keys().isdisjoint(_MOMENT.keys() - TABLES["loads"].keys()):
        return _MOMENT
    return TABLES[table]


_WHOLE: Mapping[str, Kind] = {
    "name": _TEXT,
    "watch": _END,
    "direction": _any("rad", "direction in which the point is watched"),
    "guess": _ANGLES,
    "cycle": _above("s", "time after which the motion repeats"),
    "run_up": RUN_UP,
    "gravity": _any("m/s^2", "acceleration along -y"),
}
"""Keys of a linkage beside its tables."""

_NEEDED = {
    "bodies": ("name", "mass"),
    "pins": ("name", "first", "second"),
    "guides": ("name", "body"),
    "drives": ("body",),
    "springs": ("name", "first", "second", "stiffness", "length"),
    "loads": ("body",),
}


def written(linkage: Linkage) -> dict[str, Any]:
    """A linkage without its clearance joints as plain data, SI; see ``read``."""

    def end(at: Attachment) -> Any:
        if at.body == GROUND:
            return [at.x, at.y]
        points = dict(linkage.bodies[linkage.index(at.body)].points)
        names = [name for name, place in points.items() if place == (at.x, at.y)]
        if names:
            return f"{at.body}.{names[0]}"
        return {"body": at.body, "x": at.x, "y": at.y}

    def own(item: Any, *names: str) -> dict[str, Any]:
        return {name: getattr(item, name) for name in names}

    def motion(law: Drive | Follow) -> dict[str, Any]:
        return {
            "harmonics": [list(pair) for pair in law.harmonics],
            "table": [list(row) for row in law.table],
            "rises": [asdict(rise) for rise in law.rises],
        }

    def follow(drive: Drive) -> dict[str, Any]:
        if drive.follow is None:
            return {}
        probe = drive.follow.point
        assert isinstance(probe, Probe), "a linkage has found it"
        at = {"point": end(Attachment(probe.body, probe.x, probe.y)), "direction": probe.direction}
        return {"follow": at | motion(drive.follow)}

    watch = linkage.probe
    return {
        "name": linkage.name,
        "bodies": [
            own(body, "name", "mass", "inertia")
            | {"points": {name: list(place) for name, place in dict(body.points).items()}}
            for body in linkage.bodies
        ],
        "pins": [
            {"name": pin.name, "first": end(pin.first), "second": end(pin.second)}
            for pin in linkage.revolutes
        ],
        "guides": [own(guide, *TABLES["guides"]) for guide in linkage.guides],
        "drives": [
            own(drive, "body", "speed", "angle", "frequency") | motion(drive) | follow(drive)
            for drive in linkage.drives
        ],
        "springs": [
            own(spring, *TABLES["springs"])
            | {"first": end(spring.first), "second": end(spring.second)}
            for spring in linkage.springs
        ],
        "loads": [_load_written(load, end) for load in linkage.loads],
        "watch": end(Attachment(watch.body, watch.x, watch.y)),
        "direction": watch.direction,
        "guess": dict(linkage.guess),
        "gravity": linkage.gravity,
        "run_up": linkage.run_up,
        **({} if linkage.cycle is None else {"cycle": linkage.cycle}),
    }


def _load_written(load: AnyLoad, end: Callable[[Any], Any]) -> dict[str, Any]:
    """A load as plain data; ``end`` writes a point."""
    if isinstance(load, Load):
        return {name: getattr(load, name) for name in TABLES["loads"]}
    if isinstance(load, Moment):
        return {"body": load.body, **_law_written(load.law, "moment", "over_angle")}
    law = _law_written(load.law, "force", "over_position")
    return {"point": end(load.point), "direction": load.direction, **law}


def _law_written(law: Law, size: str, over: str) -> dict[str, Any]:
    """A law as plain data, with the keys for a constant and for a table over position."""
    if isinstance(law, Harmonics):
        pairs = [list(pair) for pair in law.harmonics]
        return {size: law.mean, "frequency": law.frequency, "harmonics": pairs}
    if isinstance(law, OverTime):
        period = {} if law.period is None else {"period": law.period}
        return {"over_time": [list(pair) for pair in law.table], **period}
    if isinstance(law, OverPosition):
        rest = {key: getattr(law, key) for key in _TABLE_KEYS}
        return {over: [list(pair) for pair in law.table], **rest}
    if isinstance(law, OwnFunction):
        return {"function": {"name": law.name, "source": law.source}}
    return {size: law}


def toml_of(linkage: Linkage) -> str:
    """A linkage as the tables of a TOML file, each number with its unit and each key explained."""
    data, lines, told = written(linkage), ["[mechanism]"], set()

    def line(key: str, value: Any, kind: Kind) -> str:
        text = "" if isinstance(kind, str) or kind.text in told else f"  # {kind.text}"
        if not isinstance(kind, str):
            told.add(kind.text)
        return f"{key} = {_toml(value, kind)}{text}"

    lines += [line(key, data[key], _WHOLE[key]) for key in _WHOLE if key in data]
    for table in TABLES:
        for row in data[table]:
            known = known_of(table, row)
            lines += ["", f"[[mechanism.{table}]]"]
            shown = (key for key in known if key in row and row[key] not in ({}, []))
            lines += [line(key, row[key], known[key]) for key in shown]
    return "\n".join(lines) + "\n"


def _toml(value: Any, kind: Kind) -> str:
    """A value of a table as TOML."""
    if kind == _OWN:
        return f"{{ name = {json.dumps(value['name'])}, source = {json.dumps(value['source'])} }}"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(kind, Meaning):
        return f'"{value!r} {kind.unit}"' if kind.unit else f"{value!r}"
    if isinstance(kind, Columns):
        last = kind.meanings[-1]
        rows = (", ".join(map(_toml, row, chain(kind.meanings, repeat(last)))) for row in value)
        return f"[{', '.join(f'[{row}]' for row in rows)}]"
    if isinstance(kind, Inner):
        if isinstance(value, list):
            return f"[{', '.join(_toml(own, kind) for own in value)}]"
        shown = (key for key in kind.keys if key in value and value[key] not in ({}, []))
        pairs = (f"{key} = {_toml(value[key], kind.keys[key])}" for key in shown)
        return f"{{ {', '.join(pairs)} }}"
    if isinstance(value, list):
        return f"[{', '.join(_toml(own, _LENGTH) for own in value)}]"
    inner = _ANGLE if kind == _ANGLES else _LENGTH
    pairs = (
        f'"{key}" = {_toml(own, _POINTS if isinstance(own, list) else inner)}'
        for key, own in value.items()
    )
    return f"{{ {', '.join(pairs)} }}"


def values_of(linkage: Linkage) -> Iterator[tuple[str, str, str]]:
    """Every value of a linkage: key, value with its unit, and what it means."""
    data = written(linkage)
    rows: list[tuple[str, Mapping[str, Any], Mapping[str, Kind]]] = [("", data, _WHOLE)]
    for table in TABLES:
        rows += [(f"{table}[{k}].", row, known_of(table, row)) for k, row in enumerate(data[table])]
    for place, row, known in rows:
        for key, kind in known.items():
            if key in row and row[key] not in ({}, []):
                text = "" if isinstance(kind, str) else kind.text
                shown = _toml(row[key], kind).replace('"', "")
                if kind == _OWN:
                    shown = str(OwnFunction(**row[key]))
                yield f"{place}{key}", shown, text


def read(data: Data, place: str, *, units: bool = False) -> Linkage:
    """A linkage from plain data.

    Parameters
    ----------
    place : str
        Where the data stand, for messages.
    units : bool
        Whether numbers need their units.

    Raises
    ------
    InputError
        Naming the table, the key and the value that does not fit.
    """
    reader = _Reader(units)
    tables: dict[str, list[dict[str, Any]]] = {}
    for table in TABLES:
        rows = data.get(table, [])
        if not isinstance(rows, list):
            raise InputError(f"{place}: {table} = {rows!r}: a list of tables is expected")
        tables[table] = [
            reader.table_row(table, row, f"{place}: {table}[{k}]") for k, row in enumerate(rows)
        ]
    for key in data:
        if key not in TABLES and key not in _WHOLE:
            raise unknown(f"key of {place}", key, (*TABLES, *_WHOLE))
    whole = reader.row({k: v for k, v in data.items() if k in _WHOLE}, _WHOLE, place, ())
    watch, direction = whole.pop("watch", None), whole.pop("direction", None)
    if not tables["bodies"]:
        raise InputError(f"{place}: bodies: at least one is needed")
    try:
        linkage = Linkage(
            bodies=tuple(_body(row) for row in tables["bodies"]),
            joints=(
                *(Pin(**row) for row in tables["pins"]),
                *(Guide(**row) for row in tables["guides"]),
            ),
            drives=tuple(_drive(row) for row in tables["drives"]),
            loads=tuple(_load(row, f"loads[{k}]") for k, row in enumerate(tables["loads"])),
            **whole,
        )
        for row in tables["springs"]:
            for key in ("first", "second"):
                row[key] = linkage.point(row[key], f"spring {row['name']}")
        changes: dict[str, Any] = {"springs": tuple(Spring(**row) for row in tables["springs"])}
        if watch is not None:
            changes["watch"] = linkage.watching(linkage.point(watch, "watch"), direction)
        return replace(linkage, **changes)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def _load(row: dict[str, Any], place: str) -> AnyLoad:
    """A load of any kind; InputError names the place and what does not fit."""
    known = known_of("loads", row)
    if known is TABLES["loads"]:
        return Load(**row)
    laws = [key for key in _LAWS if key in row]
    if not laws and "frequency" in row:
        laws = ["harmonics"]
    if len(laws) > 1 or not (laws or "force" in row):
        given = " and ".join(laws) or "none"
        names = ", ".join(key for key in _LAWS if key in known)
        raise InputError(f"{place}: one law is expected, of {names}; {given} is given")
    where = {key: row.pop(key) for key in ("point", "direction", "body") if key in row}
    law = laws[0] if laws else "force"
    for key in row:
        if key != law and key not in _LAWS.get(law, ()):
            raise InputError(f"{place}.{key}: it means nothing beside {law}")
    try:
        own = _law_of(law, row)
        if "point" in where:
            return Force(where["point"], where.get("direction", 0.0), own)
        return Moment(where["body"], own)
    except InputError as error:
        told = str(error).replace("over_position", law) if law == "over_angle" else str(error)
        raise InputError(f"{place}.{told}") from None


def _law_of(key: str, row: dict[str, Any]) -> Any:
    """The law of a load, told by a key."""
    if key == "over_time":
        return OverTime(row.pop(key), **row)
    if key in ("over_position", "over_angle"):
        return OverPosition(row.pop(key), **row)
    if key == "harmonics":
        size = "force" if "force" in row else "moment"
        return Harmonics(row.get(size, 0.0), row.get("frequency", 0.0), row.get(key, ()))
    return row[key]


def _body(row: dict[str, Any]) -> Body:
    """A body, or a bar where a length is given."""
    points = row.pop("points", {})
    if "length" in row:
        found = Bar(**row)
        return Body(found.name, found.mass, found.inertia, {**dict(found.points), **points})
    if "inertia" not in row:
        raise InputError(f"inertia of {row['name']}: it is needed where no length is given")
    return Body(points=points, **row)


def _drive(row: dict[str, Any]) -> Drive:
    """A drive with its rises and the curve that it follows."""

    def motion(own: dict[str, Any]) -> dict[str, Any]:
        return own | {"rises": tuple(Rise(**rise) for rise in own.get("rises", ()))}

    try:
        follow = row.get("follow")
        found = motion(row) | {"follow": None if follow is None else Follow(**motion(follow))}
    except InputError as error:
        raise InputError(f"drive of {row['body']}: {error}") from None
    return Drive(**found)


@dataclass(frozen=True)
class _Reader:
    """Reads values of tables; numbers need their units where a person writes them."""

    units: bool

    def table_row(self, table: str, row: Any, place: str) -> dict[str, Any]:
        """The values of a row of one of TABLES."""
        known = known_of(table, row) if isinstance(row, Mapping) else TABLES[table]
        needed = ("point",) if known is _FORCE else _NEEDED[table]
        return self.row(row, known, place, needed)

    def row(
        self, row: Any, known: Mapping[str, Kind], place: str, needed: tuple[str, ...]
    ) -> dict[str, Any]:
        """The values of a table by key."""
        if not isinstance(row, Mapping):
            raise InputError(f"{place} = {row!r}: a table is expected")
        for key in row:
            if key not in known:
                raise unknown(f"key of {place}", key, known)
        for key in needed:
            if key not in row:
                raise InputError(f"{place}: {key} is missing")
        readers: dict[str, Callable[[str, Any], Any]] = {
            _TEXT: self._text,
            _END: self._end,
            _POINTS: self._points,
            _ANGLES: self._angles,
            _YES: self._yes,
            _OWN: OwnFunction.of,
        }
        found: dict[str, Any] = {}
        for key, value in row.items():
            kind, own = known[key], f"{place}.{key}"
            if isinstance(kind, str):
                found[key] = readers[kind](own, value)
            elif isinstance(kind, Columns):
                found[key] = self._rows(own, value, kind)
            elif isinstance(kind, Inner):
                found[key] = self._inner(own, value, kind)
            else:
                found[key] = self._number(own, value, kind)
        return found

    def _text(self, place: str, value: Any) -> str:
        if not isinstance(value, str) or not value or not value.isprintable():
            raise InputError(f"{place} = {value!r}: a text is expected")
        return value

    def _number(self, place: str, value: Any, meaning: Meaning) -> float | int:
        if isinstance(value, str):
            return parse_quantity(place, value, meaning)
        if self.units and not meaning.whole:
            # A zero is a zero in any unit.
            if value == 0 and isinstance(value, (int, float)) and not isinstance(value, bool):
                return 0.0
            return parse_quantity(place, str(value), meaning)
        meaning.check(place, value)
        return int(value) if meaning.whole else float(value)

    def _yes(self, place: str, value: Any) -> bool:
        if not isinstance(value, bool):
            raise InputError(f"{place} = {value!r}: true or false is expected")
        return value

    def _pair(self, place: str, value: Any) -> tuple[float, float]:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise InputError(f"{place} = {value!r}: two lengths, x and y, are expected")
        x, y = (self._number(place, own, _LENGTH) for own in value)
        return x, y

    def _rows(self, place: str, value: Any, kind: Columns) -> list[tuple[float, ...]]:
        if not isinstance(value, list):
            raise InputError(f"{place} = {value!r}: a list of rows is expected: {kind.text}")
        found = []
        for k, row in enumerate(value):
            if not isinstance(row, list) or len(row) not in kind.widths:
                widths = " or ".join(map(str, kind.widths))
                raise InputError(
                    f"{place}[{k}] = {row!r}: {widths} values are expected: {kind.text}"
                )
            meanings = chain(kind.meanings, repeat(kind.meanings[-1]))
            pairs = zip(row, meanings, strict=False)
            found.append(tuple(self._number(f"{place}[{k}]", *pair) for pair in pairs))
        return found

    def _inner(self, place: str, value: Any, kind: Inner) -> Any:
        if not kind.is_list:
            return self.row(value, kind.keys, place, kind.needed)
        if not isinstance(value, list):
            raise InputError(f"{place} = {value!r}: a list of tables is expected")
        return [
            self.row(own, kind.keys, f"{place}[{k}]", kind.needed) for k, own in enumerate(value)
        ]

    def _end(self, place: str, value: Any) -> Any:
        if isinstance(value, str):
            return value
        if isinstance(value, Mapping):
            own = self.row(value, {"body": _TEXT, "x": _LENGTH, "y": _LENGTH}, place, ("body",))
            return Attachment(own["body"], own.get("x", 0.0), own.get("y", 0.0))
        return self._pair(place, value)

    def _points(self, place: str, value: Any) -> dict[str, tuple[float, float]]:
        if not isinstance(value, Mapping):
            raise InputError(f"{place} = {value!r}: a table of points is expected")
        return {name: self._pair(f"{place}.{name}", own) for name, own in value.items()}

    def _angles(self, place: str, value: Any) -> dict[str, float]:
        if not isinstance(value, Mapping):
            raise InputError(f"{place} = {value!r}: a table of angles by body is expected")
        return {name: self._number(f"{place}.{name}", own, _ANGLE) for name, own in value.items()}
