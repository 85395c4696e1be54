"""Trials as files: data classes as plain data and back, and documents of them."""

import json
import platform
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from presswear.results.result import plain
from presswear.tools.files import write_bytes


def as_plain(owner: Any) -> Any:
    """A data class, and those inside it, as plain data.

    It is its fields; before them its ``word``, where it has one, and behind them the properties
    that its ``DERIVED`` names, for other programs.  One that has ``as_dict`` says itself what it
    is.
    """
    if hasattr(owner, "as_dict"):
        return owner.as_dict()
    if is_dataclass(owner):
        word = ("word",) if hasattr(owner, "word") else ()
        names = (*word, *(item.name for item in fields(owner)), *getattr(owner, "DERIVED", ()))
        return {name: as_plain(getattr(owner, name)) for name in names}
    if isinstance(owner, Mapping):
        return {name: as_plain(value) for name, value in owner.items()}
    if isinstance(owner, list | tuple):
        return [as_plain(value) for value in owner]
    return owner


def restored(kind: Any, data: Any) -> Any:
    """Make a value of an annotated kind from what ``as_plain`` gave.

    Whether the leaves are of their kinds is left to ``presswear.tools.typed``.

    Raises
    ------
    LookupError, TypeError, ValueError, AttributeError
        For data of another shape.
    """
    origin, inner = get_origin(kind), get_args(kind)
    if data is None or kind is Any:
        return data
    if origin in (Union, UnionType):
        words = {getattr(one, "word", None): one for one in inner}
        return restored(words[data["word"]] if None not in words else inner[0], data)
    if hasattr(kind, "from_dict"):
        return kind.from_dict(data)
    if isinstance(kind, type) and is_dataclass(kind):
        kinds = get_type_hints(kind)
        return kind(**{f.name: restored(kinds[f.name], data[f.name]) for f in fields(kind)})
    if origin is tuple:
        each = inner[:1] * len(data) if inner[-1] is Ellipsis else inner
        return tuple(restored(one, value) for one, value in zip(each, data, strict=True))
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {name: restored(inner[1], value) for name, value in data.items()}
    return data


def write_document(folder: Path, name: str, schema: int, owner: Any) -> None:
    """Write something as a JSON file into a folder, which is made where needed."""
    folder.mkdir(parents=True, exist_ok=True)
    document = plain({"schema": schema, **as_plain(owner)})
    text = json.dumps(document, indent=1, allow_nan=False)
    write_bytes(folder / name, text.encode())


def processor_name() -> str:
    """Name that the operating system gives to the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"
