"""How a claim or a printed number stands against our intervals."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from presswear.record.sampling import Interval
from presswear.studies.paper.evidence import Evidence, Measured, Place
from presswear.studies.paper.printed import Printed, printed_at

Expected = Literal["more", "less", "same"]

SAME = 0.02
"""What changes by less, for certain, is the same."""


class Verdict(StrEnum):
    """Words for how a claim stands."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"
    OPEN = "cannot be told"
    MISSING = "not computed"


@dataclass(frozen=True)
class Comparison:
    """Quantities over quantities, or less them, and what a claim expects of that.

    Attributes
    ----------
    quantity : str
        As ``Evidence`` names it.
    over, under : tuple of Place
        Numerators and denominators, as many of each; one of each for a difference.
    expected : {"more", "less", "same"}
        What becomes of the second against the first.
    """

    quantity: str
    over: tuple[Place, ...]
    under: tuple[Place, ...]
    expected: Expected = "more"

    @property
    def is_difference(self) -> bool:
        """Whether the quantity has no natural zero, or may change its sign."""
        return self.quantity in DIFFERENCES

    @property
    def printed(self) -> float | None:
        """The paper's own ratio or difference, where it prints the numbers."""
        over = [printed_at(place, self.quantity) for place in self.over]
        under = [printed_at(place, self.quantity) for place in self.under]
        values = [number.value for number in (*over, *under) if number is not None]
        if len(values) < len(over) + len(under):
            return None
        if self.is_difference:
            return (
                turned(values[0] - values[1]) if self.quantity == "angle" else values[0] - values[1]
            )
        return math.prod(values[: len(over)]) / math.prod(values[len(over) :])


DIFFERENCES = ("angle", "lag")


def turned(angle: float) -> float:
    """An angle between -pi and pi, rad."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def ratio(over: Sequence[Measured], under: Sequence[Measured]) -> Interval:
    """Products over products with the interval that their intervals give.

    The method of variance estimates recovery on logarithms (Donner and Zou, Statistical
    Methods in Medical Research 21, 2012, 347).
    """
    value = math.prod(m.value for m in over) / math.prod(m.value for m in under)
    if any(m.low is None or m.high is None for m in (*over, *under)):
        return Interval(value, None, None)
    down = [_logs(m)[0] for m in over] + [_logs(m)[1] for m in under]
    up = [_logs(m)[1] for m in over] + [_logs(m)[0] for m in under]
    return Interval(value, value * math.exp(-math.hypot(*down)), value * math.exp(math.hypot(*up)))


def _logs(m: Measured) -> tuple[float, float]:
    """Distances from a value to the ends of its interval, as logarithms."""
    assert m.low is not None
    assert m.high is not None
    below = math.log(m.value / m.low) if m.low > 0.0 else math.inf
    return below, math.log(max(m.high / m.value, 1.0))


def difference(over: Measured, under: Measured, is_angle: bool) -> Interval:
    """One less the other, with the interval that their intervals give."""
    value = over.value - under.value
    if is_angle:
        value = turned(value)
    if over.low is None or over.high is None or under.low is None or under.high is None:
        return Interval(value, None, None)
    down = math.hypot(over.value - over.low, under.high - under.value)
    up = math.hypot(over.high - over.value, under.value - under.low)
    return Interval(value, value - down, value + up)


def compared(evidence: Evidence, case: str, comparison: Comparison) -> Interval | None:
    """What our runs say of a comparison; None where one of its quantities is missing."""
    found = [
        evidence.measured(case, place, comparison.quantity)
        for place in (*comparison.over, *comparison.under)
    ]
    known = [m for m in found if m is not None]
    if len(known) < len(found):
        return None
    over, under = known[: len(comparison.over)], known[len(comparison.over) :]
    if comparison.is_difference:
        return difference(over[0], under[0], comparison.quantity == "angle")
    if any(m.value <= 0.0 for m in known):
        return None
    return ratio(over, under)


def verdict(interval: Interval | None, comparison: Comparison) -> Verdict:
    """Whether an interval bears out what is expected."""
    if interval is None:
        return Verdict.MISSING
    if interval.low is None or interval.high is None:
        return Verdict.OPEN
    neutral = 0.0 if comparison.is_difference else 1.0
    if comparison.expected == "same":
        low, high = neutral - SAME, neutral + SAME
        if low <= interval.low and interval.high <= high:
            return Verdict.HOLDS
        return Verdict.FAILS if interval.low > high or interval.high < low else Verdict.OPEN
    above, below = interval.low > neutral, interval.high < neutral
    if comparison.expected == "less":
        above, below = below, above
    if above:
        return Verdict.HOLDS
    return Verdict.FAILS if below else Verdict.OPEN


def together(verdicts: Iterable[Verdict]) -> Verdict:
    """The verdict on a claim from those on its parts."""
    told = [v for v in verdicts if v is not Verdict.MISSING]
    if not told:
        return Verdict.MISSING
    if Verdict.FAILS in told or Verdict.IN_PART in told:
        has_support = Verdict.HOLDS in told or Verdict.IN_PART in told
        return Verdict.IN_PART if has_support else Verdict.FAILS
    return Verdict.HOLDS if all(v is Verdict.HOLDS for v in told) else Verdict.OPEN


class Standing(StrEnum):
    """Words for how a printed number stands."""

    INSIDE = "inside"
    ABOVE = "above"
    BELOW = "below"
    AGREES = "agrees"
    DIFFERS = "differs"
    FREE = "as ratios only"
    OPEN = "cannot be told"
    MISSING = "not computed"


def standing(number: Printed, ours: Measured | None) -> Standing:
    """How a printed number stands against what our runs have.

    A printed peak is one draw, so it is held against single cycles.  A printed depth scales
    with K_d / b, which the paper does not print: ratios of depths are compared instead.
    """
    if ours is None:
        return Standing.MISSING
    if number.quantity == "depth":
        return Standing.FREE
    if number.quantity == "angle":
        if ours.low is None or ours.high is None:
            return Standing.OPEN
        off = turned(number.value - ours.value)
        inside = ours.low - ours.value <= off <= ours.high - ours.value
        return Standing.AGREES if inside else Standing.DIFFERS
    if ours.draws is None or ours.first is None:
        return Standing.OPEN
    # The paper shows the first cycle of its run; ours is among what it is held against.
    low = min(ours.draws[0], ours.first[0])
    high = max(ours.draws[1], ours.first[1])
    if number.value > high:
        return Standing.ABOVE
    return Standing.BELOW if number.value < low else Standing.INSIDE


def ratio_standing(printed: float, ours: Interval | None) -> Standing:
    """How a printed ratio stands against ours."""
    if ours is None:
        return Standing.MISSING
    if ours.low is None or ours.high is None:
        return Standing.OPEN
    return Standing.AGREES if ours.low <= printed <= ours.high else Standing.DIFFERS
