"""Documents: sealed, read strictly, and checked by data classes."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from presswear.tools.documents import read_json, read_sealed, sealed_json, typed, write_json
from presswear.tools.errors import InputError


def test_every_altered_byte_of_a_sealed_document_is_found(tmp_path: Path) -> None:
    file = tmp_path / "some.json"
    document = {"schema": 3, "text": 'no "digest": here', "value": [1.5, None, True]}
    data = sealed_json(document)
    file.write_bytes(data)
    found = read_sealed(file, "", 3)
    assert {key: found[key] for key in document} == document
    for place in range(len(data)):
        file.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
        with pytest.raises(InputError, match=r"some\.json (cannot|is cut off|has schema)"):
            read_sealed(file, "", 3)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (b"", "cannot be read"),
        (b"{", "cannot be read"),
        (b"[1]", "it holds no names and values"),
        (b"\x00\xff", "cannot be read"),
        ("{}".encode("utf-16"), "cannot be read"),
        (b'{"a": 1, "a": 1}', "a name is there twice"),
        (b'{"a": NaN}', "NaN is no finite number"),
        (b'{"a": -Infinity}', "-Infinity is no finite number"),
        (b'{"a": 1e301}', "1e301 is no finite number up to"),
        (b'{"a": -' + b"9" * 5000 + b"}", "-9999999999999999999"),
        (b"[" * 100_000, "cannot be read"),
    ],
)
def test_no_damaged_json_is_read(text: bytes, says: str, tmp_path: Path) -> None:
    for nothing in (tmp_path, tmp_path / "none"):
        with pytest.raises(InputError, match="it is missing"):
            read_json(nothing, "it is missing", 1)
    file = tmp_path / "some.json"
    file.write_bytes(text)
    with pytest.raises(InputError, match=says) as refused:
        read_json(file, "", 1)
    assert "some.json" in str(refused.value)
    assert len(str(refused.value)) < 300


def test_plain_data_can_be_stored_and_read(tmp_path: Path) -> None:
    file = tmp_path / "some.json"
    data: dict[Any, Any] = {
        1: (math.nan, -math.inf, 0.1, 1e-300, True, None),
        "text": {"µ": 10**20},
    }
    write_json(file, {"schema": 1, **data, "numpy": list(np.arange(2)), "float": np.float32(0.5)})
    assert read_json(file, "", 1) == {
        "schema": 1,
        "1": [None, None, 0.1, 1e-300, True, None],
        "text": {"µ": 10**20},
        "numpy": [0, 1],
        "float": 0.5,
    }


@pytest.mark.parametrize("schema", [True, 2.0, 1, 3, "2", None, [2], 10**30])
def test_another_schema_is_refused(schema: Any, tmp_path: Path) -> None:
    file = tmp_path / "some.json"
    write_json(file, {"schema": schema})
    with pytest.raises(InputError, match=r"some\.json has schema .*; this version reads 2"):
        read_json(file, "", 2)


@dataclass(frozen=True)
class _Part:
    value: float | None


@dataclass(frozen=True)
class _Whole:
    name: str
    count: int
    part: _Part
    parts: tuple[_Part, ...]
    pair: tuple[float, float]
    by_name: Mapping[str, float]
    word: Literal["x", "y"]
    anything: Any
    more: dict[str, str] = field(default_factory=dict)


SOUND: dict[str, Any] = {
    "name": "a",
    "count": 1,
    "part": {"value": 1},
    "parts": [{"value": None}, {"value": 2.5}],
    "pair": [0, 1.0],
    "by_name": {"a": 1e300},
    "word": "y",
    "anything": {"b": [True]},
}


def test_plain_data_become_what_their_class_says() -> None:
    part = _Part(1.0)
    assert typed({**SOUND, "unknown": 1}, _Whole, "") == _Whole(
        "a", 1, part, (_Part(None), _Part(2.5)), (0.0, 1.0), {"a": 1e300}, "y", {"b": [True]}
    )


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"name": 1}, "name: Expected `str`, got `int`"),
        ({"name": None}, "name: "),
        ({"count": True}, "count: "),
        ({"count": 1.0}, "count: "),
        ({"count": "1"}, "count: "),
        ({"part": 3}, "part: "),
        ({"part": {}}, "part: Object missing required field `value`"),
        ({"part": {"value": "1"}}, "part.value: Expected `float | null`, got `str`"),
        ({"parts": {}}, "parts: "),
        ({"parts": [{"value": 1}, {"value": False}]}, "parts[1].value: "),
        ({"pair": [0.0]}, "pair: "),
        ({"pair": [0.0, "1"]}, "pair[1]: "),
        ({"by_name": {"a": None}}, "by_name[...]: "),
        ({"word": "z"}, "word: "),
        ({"word": True}, "word: "),
        ({"more": {"a": 1}}, "more[...]: "),
    ],
)
def test_what_does_not_fit_is_named(values: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError) as refused:
        typed({**SOUND, **values}, _Whole, "some.json")
    assert str(refused.value).startswith(f"some.json: {says}")
    assert "\n" not in str(refused.value)


def test_what_is_missing_is_named() -> None:
    for key in SOUND:
        with pytest.raises(InputError, match=rf"^some\.json: .*`{key}`$"):
            typed({name: SOUND[name] for name in SOUND if name != key}, _Whole, "some.json")
    with pytest.raises(InputError, match=r"^some\.json: Expected `object`, got `array`"):
        typed([SOUND], _Whole, "some.json")
