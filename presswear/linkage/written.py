"""A linkage as plain data: as results store it, and as a person writes it in a file.

Stored numbers are SI; in a file each has its unit, as on the command line.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from presswear.linkage.elements import (
    GROUND,
    Attachment,
    Bar,
    Body,
    Guide,
    Linkage,
    Load,
    Pin,
    Spring,
)
from presswear.linkage.motions import Drive
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Meaning, parse_quantity

Data = Mapping[str, Any]


def _any(unit: str, text: str) -> Meaning:
    return Meaning(unit, -math.inf, math.inf, "", text)


def _above(unit: str, text: str) -> Meaning:
    return Meaning(unit, 0.0, math.inf, "", text, open_low=True)


_TEXT, _END, _POINTS, _ANGLES, _PAIRS = "text", "end", "points", "angles", "pairs"

TABLES: Mapping[str, Mapping[str, Meaning | str]] = {
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
        "frequency": _any("rad/s", "frequency of the first harmonic; 0: the mean speed"),
        "harmonics": _PAIRS,
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

_WHOLE: Mapping[str, Meaning | str] = {
    "name": _TEXT,
    "watch": _END,
    "direction": _any("rad", "direction in which the point is watched"),
    "guess": _ANGLES,
    "cycle": _above("s", "time after which the motion repeats"),
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

_TURNS = "angles of cosine and sine"
_LENGTH, _ANGLE = _any("m", ""), _any("rad", "")


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
            own(drive, *TABLES["drives"]) | {"harmonics": [list(pair) for pair in drive.harmonics]}
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
        **({} if linkage.cycle is None else {"cycle": linkage.cycle}),
    }


def toml_of(linkage: Linkage) -> str:
    """A linkage as the tables of a TOML file, each number with its unit and each key explained."""
    data, lines, told = written(linkage), ["[mechanism]"], set()

    def line(key: str, value: Any, meaning: Meaning | str) -> str:
        text = "" if isinstance(meaning, str) or meaning.text in told else f"  # {meaning.text}"
        if not isinstance(meaning, str):
            told.add(meaning.text)
        return f"{key} = {_toml(value, meaning)}{text}"

    lines += [line(key, data[key], _WHOLE[key]) for key in _WHOLE if key in data]
    for table, known in TABLES.items():
        for row in data[table]:
            lines += ["", f"[[mechanism.{table}]]"]
            shown = (key for key in known if key in row and row[key] not in ({}, []))
            lines += [line(key, row[key], known[key]) for key in shown]
    return "\n".join(lines) + "\n"


def _toml(value: Any, meaning: Meaning | str) -> str:
    """A value of a table as TOML."""
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(meaning, Meaning):
        return f'"{value!r} {meaning.unit}"'
    if isinstance(value, list):
        kinds: Mapping[Any, Meaning | str] = {_PAIRS: _TURNS, _TURNS: _ANGLE}
        inside = kinds.get(meaning, _LENGTH)
        return f"[{', '.join(_toml(own, inside) for own in value)}]"
    inner = _ANGLE if meaning == _ANGLES else _LENGTH
    pairs = (
        f'"{key}" = {_toml(own, _POINTS if isinstance(own, list) else inner)}'
        for key, own in value.items()
    )
    return f"{{ {', '.join(pairs)} }}"


def values_of(linkage: Linkage) -> Iterator[tuple[str, str, str]]:
    """Every value of a linkage: key, value with its unit, and what it means."""
    data = written(linkage)
    rows = [("", data, _WHOLE)]
    for table, known in TABLES.items():
        rows += [(f"{table}[{k}].", row, known) for k, row in enumerate(data[table])]
    for place, row, known in rows:
        for key, meaning in known.items():
            if key in row and row[key] not in ({}, []):
                text = meaning.text if isinstance(meaning, Meaning) else ""
                yield f"{place}{key}", _toml(row[key], meaning).replace('"', ""), text


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
            drives=tuple(Drive(**row) for row in tables["drives"]),
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


@dataclass(frozen=True)
class _Reader:
    """Reads values of tables; numbers need their units where a person writes them."""

    units: bool

    def row(
        self, row: Any, known: Mapping[str, Meaning | str], place: str, needed: tuple[str, ...]
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
            _PAIRS: self._pairs,
        }
        found = {}
        for key, value in row.items():
            meaning = known[key]
            if isinstance(meaning, str):
                found[key] = readers[meaning](f"{place}.{key}", value)
            else:
                found[key] = self._number(f"{place}.{key}", value, meaning)
        return found

    def _text(self, place: str, value: Any) -> str:
        if not isinstance(value, str) or not value or not value.isprintable():
            raise InputError(f"{place} = {value!r}: a text is expected")
        return value

    def _number(self, place: str, value: Any, meaning: Meaning) -> float:
        if isinstance(value, str):
            return parse_quantity(place, value, meaning)
        if self.units:
            # A zero is a zero in any unit.
            if value == 0 and isinstance(value, (int, float)) and not isinstance(value, bool):
                return 0.0
            return parse_quantity(place, str(value), meaning)
        meaning.check(place, value)
        return float(value)

    def _pair(
        self, place: str, value: Any, what: str = "lengths, x and y", meaning: Meaning = _LENGTH
    ) -> tuple[float, float]:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise InputError(f"{place} = {value!r}: two {what}, are expected")
        x, y = (self._number(place, own, meaning) for own in value)
        return x, y

    def _pairs(self, place: str, value: Any) -> list[tuple[float, float]]:
        if not isinstance(value, list):
            raise InputError(f"{place} = {value!r}: a list of pairs of angles is expected")
        what = "angles, of cosine and sine"
        return [self._pair(f"{place}[{k}]", own, what, _ANGLE) for k, own in enumerate(value)]

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
