"""Numbers printed in sections 5.3 and 5.4 of the paper, and its claims on trends.

Numbers are in ``printed.toml``; misprints are kept and described. Claims are in
``claims.toml`` as comparisons of quantities; its head explains how they are written.
The units are SI and rad.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from math import radians
from typing import Any, Literal, cast

from presswear.paper.settings import FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR, read

_DATA = read("printed.toml")
_CLAIMS = read("claims.toml")
TEXTS = read("report.toml")


@dataclass(frozen=True)
class Place:
    """Stage of a setting, and a joint in it or the slider, to which a quantity belongs."""

    setting: str  # key of SETTINGS
    wear_updates: int  # before the stage; for wear depths, those that are added up
    joint: str = ""  # empty for the slider


@dataclass(frozen=True)
class Printed:
    """Printed number."""

    section: str
    figure: str
    place: Place
    quantity: str  # key of `evidence.QUANTITIES`
    value: float  # SI units, rad
    misprint: str = ""  # errors of the print, separated by semicolons

    @property
    def places(self) -> tuple[Place, ...]:
        """Places to compare with: two in section 5.4.2, which does not say after which wear."""
        if self.section != "5.4.2":
            return (self.place,)
        return tuple(Place(self.place.setting, k, self.place.joint) for k in (0, 1))


def _misprint(names: list[str]) -> str:
    return "; ".join(_DATA["misprints"][name] for name in names)


def _printed_depths() -> Iterator[Printed]:
    """Yield the printed depths and their angles."""
    for row in _DATA["depths"]:
        section, figure, setting, wear_updates, joint, depth, angle, names = row
        place = Place(setting, wear_updates, joint)
        yield Printed(section, figure, place, "depth", depth, _misprint(names))
        yield Printed(section, figure, place, "angle", radians(angle))


def _printed_peaks() -> Iterator[Printed]:
    """Yield the printed peaks of successive stages."""
    for row in _DATA["peaks"]:
        section, figure, setting, first, joint, quantity, values, names = row
        for wear_updates, value in enumerate(values, first):
            place = Place(setting, wear_updates, joint)
            yield Printed(section, figure, place, quantity, value, _misprint(names))


PRINTED: tuple[Printed, ...] = (*_printed_depths(), *_printed_peaks())

# Places whose printed depth has probably lost a power of ten
LOST_FACTOR = _misprint(["lost_factor"])
DOUBTFUL = frozenset(
    number.place for number in PRINTED if number.misprint == LOST_FACTOR
)


def _ranges() -> Iterator[tuple[str, str, list[tuple[float, float]]]]:
    """Yield figure, joint, and the arcs in which it is mainly worn, rad."""
    for figure, joint, arcs in _DATA["ranges"]:
        yield figure, joint, [(radians(low), radians(high)) for low, high in arcs]


RANGES = tuple(_ranges())


def printed_at(place: Place, quantity: str) -> Printed | None:
    """Return the printed number of a quantity at a place; None if none is printed."""
    for number in PRINTED:
        if number.place == place and number.quantity == quantity:
            return number
    return None


# --- Claims -------------------------------------------------------------------------

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
        numerators = _printed_values(self.over, self.quantity)
        denominators = _printed_values(self.under, self.quantity)
        if numerators is None or denominators is None:
            return None
        if self.is_difference:
            return wrapped_angle(numerators[0] - denominators[0])
        return math.prod(numerators) / math.prod(denominators)


def _printed_values(places: Sequence[Place], quantity: str) -> list[float] | None:
    """Return the printed numbers of a quantity; None if one of them is not printed."""
    numbers = [printed_at(place, quantity) for place in places]
    values = [number.value for number in numbers if number is not None]
    return values if len(values) == len(places) else None


@dataclass(frozen=True)
class Claim:
    """Sentence that claims a trend."""

    where: str  # section and figure
    quote: str  # words of the paper, shortened
    comparisons: tuple[Comparison, ...]
    note: str = ""  # interpretation of the words, or what is odd about them


def wrapped_angle(angle: float) -> float:
    """Return the angle between -pi and pi, rad."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def comparisons(text: str) -> Iterator[Comparison]:
    """Yield the comparisons of a text such as ``depth more wear A,C 1,2``."""
    quantity, expected, kind, *words = text.split()
    if kind == "joints":
        sides = _between_joints(words)
    elif kind == "growth":
        sides = _between_growths(words)
    else:
        sides = _between_settings(kind, *words)
    for over, under in sides:
        yield Comparison(quantity, tuple(over), tuple(under), cast(Expected, expected))


_Sides = Iterator[tuple[list[Place], list[Place]]]  # numerators and denominators


def _place(word: str, joint: str) -> Place:
    """Return the place of a joint in a stage such as ``wear:1``."""
    setting, wear_updates = word.split(":")
    return Place(setting, int(wear_updates), joint)


def _between_joints(stages: list[str]) -> _Sides:
    """Yield joint A over joint C in each stage."""
    for stage in stages:
        yield [_place(stage, "A")], [_place(stage, "C")]


def _between_growths(pairs: list[str]) -> _Sides:
    """Yield the growth at A over that at C, from one stage to another, ``wear:1>wear:2``."""
    for pair in pairs:
        first, last = pair.split(">")
        yield (
            [_place(last, "A"), _place(first, "C")],
            [_place(first, "A"), _place(last, "C")],
        )


def _between_settings(
    kind: str, joints: str, numbers: str, setting: str = WEAR
) -> _Sides:
    """Yield successive wears of a setting, or the higher over the lower of two settings."""
    updates = [int(number) for number in numbers.split(",")]
    if kind == "wear":
        steps = [((setting, i), (setting, k)) for i, k in pairwise(updates)]
    else:
        lower, higher = _SETTINGS[kind]
        steps = [((lower, k), (higher, k)) for k in updates]
    for joint in [""] if joints == "slider" else joints.split(","):
        for first, second in steps:
            yield [Place(*second, joint)], [Place(*first, joint)]


def _claim(data: Mapping[str, Any]) -> Claim:
    """Return a claim from its table in ``claims.toml``."""
    return Claim(
        where=data["where"],
        quote=data["quote"],
        comparisons=tuple(chain(*map(comparisons, data["parts"]))),
        note=data.get("note", "").format(**_CLAIMS["notes"]),
    )


CLAIMS = tuple(map(_claim, _CLAIMS["claims"]))
# Number of different comparisons of all claims
COMPARISONS = len(set(chain(*(claim.comparisons for claim in CLAIMS))))

_SHOWN = f"{WEAR}:1 {WEAR}:2 {FRICTION}:1 {HIGH_FRICTION}:1 {SLOW}:1 {FAST}:1"


def _inverse(comparison: Comparison) -> Comparison:
    """Return a comparison with numerators and denominators exchanged."""
    return replace(comparison, over=comparison.under, under=comparison.over)


# Ratios of printed depths, which do not depend on K_d / b, because it is not printed
DEPTH_RATIOS = (
    *comparisons("depth more wear A,C 1,2"),
    *map(_inverse, comparisons(f"depth more joints {_SHOWN}")),
    *comparisons("depth more friction A,C 1"),
    *comparisons("depth more speed A,C 1"),
)
# Comparisons at joint A that the report states first
HIGHLIGHTS = {
    name: next(comparisons(words)) for name, words in _CLAIMS["highlights"].items()
}
