"""Sentences of sections 5.3, 5.4 and 6 that claim a trend, as comparisons of quantities.

The claims are in ``claims.toml``, whose head explains how comparisons are written.
"""

import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from itertools import pairwise
from typing import Literal, cast

from presswear.paper.printed import Place, printed_at
from presswear.paper.settings import FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR

Expected = Literal["more", "less", "same"]
_SETTINGS = {"friction": (FRICTION, HIGH_FRICTION), "speed": (SLOW, FAST)}


@dataclass(frozen=True)
class Comparison:
    """Ratio or difference of quantities, and its expected change."""

    quantity: str  # key of `evidence.QUANTITIES`
    over: tuple[Place, ...]  # numerators; one for a difference
    under: tuple[Place, ...]  # as many denominators
    expected: Expected = "more"  # change of the second against the first

    @property
    def is_difference(self) -> bool:
        """True for quantities that may change their sign, whose differences are compared."""
        return self.quantity in ("angle", "lag")

    @property
    def printed(self) -> float | None:
        """Ratio or difference of the printed numbers; None if one of them is not printed."""
        places = (*self.over, *self.under)
        numbers = [printed_at(place, self.quantity) for place in places]
        values = [number.value for number in numbers if number is not None]
        if len(values) < len(places):
            return None
        if self.is_difference:
            return wrapped_angle(values[0] - values[1])
        count = len(self.over)
        return math.prod(values[:count]) / math.prod(values[count:])


@dataclass(frozen=True)
class Claim:
    """Sentence that claims a trend."""

    where: str  # section and figure
    quote: str  # words of the paper, shortened
    parts: tuple[Comparison, ...]
    note: str = ""  # interpretation of the words, or what is odd about them


def wrapped_angle(angle: float) -> float:
    """Return the angle between -pi and pi, rad."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def comparisons(text: str) -> Iterator[Comparison]:
    """Yield the comparisons of a text such as ``depth more wear A,C 1,2``."""
    quantity, expected, kind, *words = text.split()

    def places(stage: str) -> list[Place]:
        setting, _, updates = stage.partition(":")
        return [Place(setting, int(updates), joint) for joint in "CA"]

    if kind in ("wear", "friction", "speed"):
        joints = [""] if words[0] == "slider" else words[0].split(",")
        updates = [int(word) for word in words[1].split(",")]
        setting = words[2] if len(words) > 2 else WEAR
        for joint in joints:
            if kind == "wear":
                steps = [((setting, i), (setting, k)) for i, k in pairwise(updates)]
            else:
                lower, higher = _SETTINGS[kind]
                steps = [((lower, k), (higher, k)) for k in updates]
            for first, second in steps:
                over, under = (Place(*second, joint),), (Place(*first, joint),)
                yield Comparison(quantity, over, under, cast(Expected, expected))
        return
    for word in words:
        start, _, end = word.partition(">")
        c, a = places(start)
        overs, unders = [a], [c]
        if kind == "growth":
            last_c, last_a = places(end)
            overs, unders = [last_a, c], [a, last_c]
        yield Comparison(quantity, tuple(overs), tuple(unders), cast(Expected, expected))


_DATA = tomllib.loads(files("presswear.paper").joinpath("claims.toml").read_text("utf-8"))
CLAIMS = tuple(
    Claim(
        item["where"],
        item["quote"],
        tuple(part for words in item["parts"] for part in comparisons(words)),
        item.get("note", "").format(**_DATA["notes"]),
    )
    for item in _DATA["claims"]
)

_SHOWN = f"{WEAR}:1 {WEAR}:2 {FRICTION}:1 {HIGH_FRICTION}:1 {SLOW}:1 {FAST}:1"
DEPTH_RATIOS = (  # what the printed depths predict although K_d / b is not printed
    *comparisons("depth more wear A,C 1,2"),
    *(
        Comparison("depth", one.under, one.over)
        for one in comparisons(f"depth more joints {_SHOWN}")
    ),
    *comparisons("depth more friction A,C 1"),
    *comparisons("depth more speed A,C 1"),
)
# comparisons at joint A that the report states first
HIGHLIGHTS = {name: next(comparisons(words)) for name, words in _DATA["highlights"].items()}
