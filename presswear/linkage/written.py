"""A linkage as plain data: as results store it, and as a person writes it in a file.

Stored numbers are SI; in a file each has its unit, as on the command line.
"""

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
    Load,
    Pin,
    Probe,
    Spring,
)
from presswear.linkage.motions import Drive, Follow, Rise
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Meaning, parse_quantity

Data = Mapping[str, Any]


def _any(unit: str, text: str) -> Meaning:
    return Meaning(unit, -math.inf, math.inf, "", text)


def _above(unit: str, text: str) -> Meaning:
    return Meaning(unit, 0.0, math.inf, "", text, open_low=True)


_TEXT, _END, _POINTS, _ANGLES = "text", "end", "points", "angles"


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
"""Keys of each table of a linkage, and what stands there."""

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
        "loads": [own(load, *TABLES["loads"]) for load in linkage.loads],
        "watch": end(Attachment(watch.body, watch.x, watch.y)),
        "direction": watch.direction,
        "guess": dict(linkage.guess),
        "gravity": linkage.gravity,
        "run_up": linkage.run_up,
        **({} if linkage.cycle is None else {"cycle": linkage.cycle}),
    }


def toml_of(linkage: Linkage) -> str:
    """A linkage as the tables of a TOML file, each number with its unit and each key explained."""
    data, lines, told = written(linkage), ["[mechanism]"], set()

    def line(key: str, value: Any, kind: Kind) -> str:
        text = "" if isinstance(kind, str) or kind.text in told else f"  # {kind.text}"
        if not isinstance(kind, str):
            told.add(kind.text)
        return f"{key} = {_toml(value, kind)}{text}"

    lines += [line(key, data[key], _WHOLE[key]) for key in _WHOLE if key in data]
    for table, known in TABLES.items():
        for row in data[table]:
            lines += ["", f"[[mechanism.{table}]]"]
            shown = (key for key in known if key in row and row[key] not in ({}, []))
            lines += [line(key, row[key], known[key]) for key in shown]
    return "\n".join(lines) + "\n"


def _toml(value: Any, kind: Kind) -> str:
    """A value of a table as TOML."""
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
    for table, known in TABLES.items():
        rows += [(f"{table}[{k}].", row, known) for k, row in enumerate(data[table])]
    for place, row, known in rows:
        for key, kind in known.items():
            if key in row and row[key] not in ({}, []):
                text = "" if isinstance(kind, str) else kind.text
                yield f"{place}{key}", _toml(row[key], kind).replace('"', ""), text


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
            reader.row(row, TABLES[table], f"{place}: {table}[{k}]", _NEEDED[table])
            for k, row in enumerate(rows)
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
            loads=tuple(Load(**row) for row in tables["loads"]),
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
        }
        found = {}
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
