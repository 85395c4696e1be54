"""A linkage from plain data: from a result, or from a file, where each number has its unit."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import chain, repeat
from pathlib import Path
from typing import Any

from presswear.linkage.elements import Bar, Body, Guide, Pin
from presswear.linkage.keys import (
    ANGLE,
    ANGLES,
    END,
    FORCE,
    LAWS,
    LENGTH,
    NEEDED,
    OWN,
    POINTS,
    TABLES,
    TEXT,
    WHOLE,
    YES,
    Columns,
    Data,
    Inner,
    Kind,
    known_of,
)
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import (
    LOAD_PARAMETERS,
    AnyLoad,
    Force,
    Harmonics,
    Load,
    Moment,
    OverPosition,
    OverTime,
    Spring,
)
from presswear.linkage.motions import Drive, Follow
from presswear.linkage.pieces import Rise
from presswear.linkage.points import Attachment
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, parse_quantity
from presswear.tools.user_function import UserFunction


def read(data: Data, place: str, *, units: bool = False, folder: Path | None = None) -> Linkage:
    """A linkage from plain data.

    Parameters
    ----------
    place : str
        Where the data stand, for messages.
    units : bool
        Whether numbers need their units.
    folder : Path or None
        Where files with functions of one's own stand; None: where the program was called.

    Raises
    ------
    InputError
        Naming the table, the key and the value that does not fit.
    """
    reader = _Reader(units, folder or Path())
    tables: dict[str, list[dict[str, Any]]] = {}
    for table in TABLES:
        rows = data.get(table, [])
        if not isinstance(rows, list):
            raise InputError(f"{place}: {table} = {rows!r}: a list of tables is expected")
        tables[table] = [
            reader.table_row(table, row, f"{place}: {table}[{k}]") for k, row in enumerate(rows)
        ]
    for key in data:
        if key not in TABLES and key not in WHOLE:
            raise unknown(f"key of {place}", key, (*TABLES, *WHOLE))
    whole = reader.row({k: v for k, v in data.items() if k in WHOLE}, WHOLE, place, ())
    watch, direction = whole.pop("watch", None), whole.pop("direction", None)
    try:
        linkage = Linkage(
            bodies=tuple(_body(row) for row in tables["bodies"]),
            joints=(
                *(Pin(**row) for row in tables["pins"]),
                *(Guide(**row) for row in tables["guides"]),
            ),
            drives=tuple(_drive(row) for row in tables["drives"]),
            springs=tuple(Spring(**row) for row in tables["springs"]),
            loads=tuple(_load(row, f"loads[{k}]") for k, row in enumerate(tables["loads"])),
            **whole,
        )
        if watch is None:
            return linkage
        probe = linkage.watching(linkage.point(watch, "watch"), direction)
        return replace(linkage, watch=probe)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def _load(row: dict[str, Any], place: str) -> AnyLoad:
    """A load of any kind; InputError names the place and what does not fit."""
    known = known_of("loads", row)
    if known is TABLES["loads"]:
        return Load(**row)
    laws = [key for key in LAWS if key in row]
    if not laws and "frequency" in row:
        laws = ["harmonics"]
    if len(laws) > 1 or not (laws or "force" in row):
        given = " and ".join(laws) or "none"
        names = ", ".join(key for key in LAWS if key in known)
        raise InputError(f"{place}: one law is expected, of {names}; {given} is given")
    where = {key: row.pop(key) for key in ("point", "direction", "body", "name") if key in row}
    law = laws[0] if laws else "force"
    for key in row:
        if key != law and key not in LAWS.get(law, ()):
            raise InputError(f"{place}.{key}: it means nothing beside {law}")
    try:
        own = _law_of(law, row)
        if "point" in where:
            return Force(where["point"], where.get("direction", 0.0), own, where.get("name", ""))
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
    folder: Path

    def _own(self, place: str, value: Any) -> UserFunction:
        if not self.units:
            if isinstance(value, str):
                raise InputError(f"{place} = {value!r}: a stored law is source code, not a file")
            return UserFunction.read(place, value, LOAD_PARAMETERS)
        # The user wrote this file, with the source code that stands in it.
        given = f"{self.folder / value}" if isinstance(value, str) else value
        return UserFunction.read(place, given, LOAD_PARAMETERS).trusted()

    def table_row(self, table: str, row: Any, place: str) -> dict[str, Any]:
        """The values of a row of one of TABLES."""
        known = known_of(table, row) if isinstance(row, Mapping) else TABLES[table]
        needed = ("point",) if known is FORCE else NEEDED[table]
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
            TEXT: self._text,
            END: self._end,
            POINTS: self._points,
            ANGLES: self._angles,
            YES: self._yes,
            OWN: self._own,
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

    def _number(self, place: str, value: Any, meaning: Quantity) -> float | int:
        if isinstance(value, str):
            return parse_quantity(place, value, meaning)
        if self.units and not meaning.whole:
            # A zero is a zero in any unit.
            if value == 0 and isinstance(value, (int, float)) and not isinstance(value, bool):
                meaning.check(place, 0.0)
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
        x, y = (self._number(place, own, LENGTH) for own in value)
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
            own = self.row(value, {"body": TEXT, "x": LENGTH, "y": LENGTH}, place, ("body",))
            return Attachment(own["body"], own.get("x", 0.0), own.get("y", 0.0))
        return self._pair(place, value)

    def _points(self, place: str, value: Any) -> dict[str, tuple[float, float]]:
        if not isinstance(value, Mapping):
            raise InputError(f"{place} = {value!r}: a table of points is expected")
        return {name: self._pair(f"{place}.{name}", own) for name, own in value.items()}

    def _angles(self, place: str, value: Any) -> dict[str, float]:
        if not isinstance(value, Mapping):
            raise InputError(f"{place} = {value!r}: a table of angles by body is expected")
        return {name: self._number(f"{place}.{name}", own, ANGLE) for name, own in value.items()}
