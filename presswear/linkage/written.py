"""A linkage as plain data: as results store it, and as a person writes it in a file.

Stored numbers are SI; in a file each has its unit, as on the command line.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict
from itertools import chain, repeat
from typing import Any

from presswear.linkage.keys import (
    ANGLE,
    ANGLES,
    LENGTH,
    OWN,
    POINTS,
    TABLE_KEYS,
    TABLES,
    WHOLE,
    Columns,
    Inner,
    Kind,
    known_of,
)
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import (
    AnyLoad,
    Harmonics,
    Law,
    Load,
    Moment,
    OverPosition,
    OverTime,
)
from presswear.linkage.motions import Drive, Follow
from presswear.linkage.points import GROUND, Attachment, Probe
from presswear.tools.quantities import Quantity
from presswear.tools.user_function import UserFunction


def written(linkage: Linkage) -> dict[str, Any]:
    """A linkage without its clearance joints as plain data, SI; see ``read``."""

    def end(at: Attachment) -> Any:
        if at.body == GROUND:
            return [at.x, at.y]
        points = {"centre": (0.0, 0.0)} | dict(linkage.bodies[linkage.index(at.body)].points)
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

    def limit(drive: Drive) -> dict[str, Any]:
        return {} if drive.torque_limit is None else own(drive, "torque_limit")

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
            own(drive, "body", "speed", "angle", "frequency")
            | limit(drive)
            | motion(drive)
            | follow(drive)
            for drive in linkage.drives
        ],
        "springs": [
            own(spring, *TABLES["springs"])
            | dict(zip(("first", "second"), map(end, spring.ends), strict=True))
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
    name = {"name": load.name} if load.name else {}
    return {"point": end(load.point), "direction": load.direction, **name, **law}


def _law_written(law: Law, size: str, over: str) -> dict[str, Any]:
    """A law as plain data, with the keys for a constant and for a table over position."""
    if isinstance(law, Harmonics):
        pairs = [list(pair) for pair in law.harmonics]
        return {size: law.mean, "frequency": law.frequency, "harmonics": pairs}
    if isinstance(law, OverTime):
        period = {} if law.period is None else {"period": law.period}
        return {"over_time": [list(pair) for pair in law.table], **period}
    if isinstance(law, OverPosition):
        rest = {key: getattr(law, key) for key in TABLE_KEYS}
        return {over: [list(pair) for pair in law.table], **rest}
    if isinstance(law, UserFunction):
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

    lines += [line(key, data[key], WHOLE[key]) for key in WHOLE if key in data]
    for table in TABLES:
        for row in data[table]:
            known = known_of(table, row)
            lines += ["", f"[[mechanism.{table}]]"]
            shown = (key for key in known if key in row and row[key] not in ({}, []))
            lines += [line(key, row[key], known[key]) for key in shown]
    return "\n".join(lines) + "\n"


def _toml(value: Any, kind: Kind) -> str:
    """A value of a table as TOML."""
    if kind == OWN:
        return f"{{ name = {json.dumps(value['name'])}, source = {json.dumps(value['source'])} }}"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(kind, Quantity):
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
        return f"[{', '.join(_toml(own, LENGTH) for own in value)}]"
    inner = ANGLE if kind == ANGLES else LENGTH
    pairs = (
        f'"{key}" = {_toml(own, POINTS if isinstance(own, list) else inner)}'
        for key, own in value.items()
    )
    return f"{{ {', '.join(pairs)} }}"


def values_of(linkage: Linkage) -> Iterator[tuple[str, str, str]]:
    """Every value of a linkage: key, value with its unit, and what it means."""
    data = written(linkage)
    rows: list[tuple[str, Mapping[str, Any], Mapping[str, Kind]]] = [("", data, WHOLE)]
    for table in TABLES:
        rows += [(f"{table}[{k}].", row, known_of(table, row)) for k, row in enumerate(data[table])]
    for place, row, known in rows:
        for key, kind in known.items():
            if key in row and row[key] not in ({}, []):
                text = "" if isinstance(kind, str) else kind.text
                shown = _toml(row[key], kind).replace('"', "")
                if kind == OWN:
                    shown = str(UserFunction(**row[key]))
                yield f"{place}{key}", shown, text
