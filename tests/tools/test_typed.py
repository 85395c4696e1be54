"""Data classes made of stored data: what their annotations allow."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

import pytest

from presswear.tools.typed import fits, misfits


@dataclass(frozen=True)
class _Part:
    value: float | None = 1.0


@dataclass(frozen=True)
class _Whole:
    kind: ClassVar[str] = "whole"
    name: str = "a"
    count: int = 1
    part: _Part = field(default_factory=_Part)
    parts: tuple[_Part, ...] = ()
    pair: tuple[float, float] = (0.0, 1.0)
    by_name: Mapping[str, float] = field(default_factory=dict)
    word: Literal["x", "y"] = "x"
    anything: Any = None


@pytest.mark.parametrize(
    ("values", "wrong"),
    [
        ({}, []),
        ({"part": _Part(None), "parts": (_Part(), _Part(2.0)), "word": "y"}, []),
        ({"part": _Part(math.nan), "by_name": {"a": math.inf, "b": 3}}, []),
        ({"name": 1}, ["name"]),
        ({"count": True}, ["count"]),
        ({"count": 1.0}, ["count"]),
        ({"count": 10**400}, ["count"]),
        ({"part": 3}, ["part"]),
        ({"part": _Part("1")}, ["part.value"]),  # type: ignore[arg-type]
        ({"part": _Part(1e301)}, ["part.value"]),
        ({"parts": [_Part()]}, ["parts"]),
        ({"parts": (_Part(), _Part(False))}, ["parts"]),
        ({"pair": (0.0,)}, ["pair"]),
        ({"pair": (0.0, "1")}, ["pair"]),
        ({"by_name": {"a": None}}, ["by_name"]),
        ({"by_name": {1: 1.0}}, ["by_name"]),
        ({"word": "z", "anything": object()}, ["word"]),
    ],
)
def test_misfits_are_named(values: dict[str, Any], wrong: list[str]) -> None:
    assert list(misfits(_Whole(**values))) == wrong


def test_true_is_no_number_and_one_no_truth() -> None:
    assert not fits(True, float)
    assert not fits(True, Literal[1])
    assert fits(1, float)
    assert not fits(1, Literal[True])
