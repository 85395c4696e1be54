"""Verdicts on claims and printed numbers: how they stand against our intervals."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from presswear.paper.claims import CLAIMS, Claim, Comparison, turned
from presswear.paper.evidence import Ends, Evidence, Measured
from presswear.paper.printed import Printed
from presswear.paper.variants import BASE, GEOMETRIES, JUDGED

SAME = 0.02
"""Change below which, for certain, a quantity stays the same."""


class Verdict(StrEnum):
    """Words for how a claim stands."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"
    OPEN = "cannot be told"
    MISSING = "not computed"


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


def ratio(over: Sequence[Measured], under: Sequence[Measured]) -> Measured:
    """Products over products with the interval that their intervals give.

    The method of variance estimates recovery on logarithms (Donner and Zou, Statistical
    Methods in Medical Research 21, 2012, 347).
    """

    def logs(value: float, ends: Ends) -> Ends:
        """Distances from a value to the ends of its interval, as logarithms."""
        below = math.log(value / ends[0]) if ends[0] > 0.0 else math.inf
        return below, math.log(max(ends[1] / value, 1.0))

    value = math.prod(m.value for m in over) / math.prod(m.value for m in under)
    above, below = ([logs(m.value, m.ends) for m in some if m.ends] for some in (over, under))
    if len(above) + len(below) < len(over) + len(under):
        return Measured(value, None)
    down = math.hypot(*(low for low, _ in above), *(high for _, high in below))
    up = math.hypot(*(high for _, high in above), *(low for low, _ in below))
    return Measured(value, (value * math.exp(-down), value * math.exp(up)))


def difference(over: Measured, under: Measured, is_angle: bool) -> Measured:
    """One less the other, with the interval that their intervals give."""
    value = over.value - under.value
    if is_angle:
        value = turned(value)
    if over.ends is None or under.ends is None:
        return Measured(value, None)
    down = math.hypot(over.value - over.ends[0], under.ends[1] - under.value)
    up = math.hypot(over.ends[1] - over.value, under.value - under.ends[0])
    return Measured(value, (value - down, value + up))


def compared(evidence: Evidence, case: str, comparison: Comparison) -> Measured | None:
    """Our own ratio or difference; None where one of its quantities is missing."""
    places = (*comparison.over, *comparison.under)
    found = [evidence.measured(case, place, comparison.quantity) for place in places]
    known = [m for m in found if m is not None]
    if len(known) < len(found):
        return None
    if comparison.is_difference:
        return difference(known[0], known[1], comparison.quantity == "angle")
    if any(m.value <= 0.0 for m in known):
        return None
    count = len(comparison.over)
    return ratio(known[:count], known[count:])


def verdict(ours: Measured | None, comparison: Comparison) -> Verdict:
    """Judge whether an interval bears out what is expected."""
    if ours is None:
        return Verdict.MISSING
    if ours.ends is None:
        return Verdict.OPEN
    low, high = ours.ends
    neutral = 0.0 if comparison.is_difference else 1.0
    above, below = low > neutral, high < neutral
    match comparison.expected:
        case "more":
            holds, fails = above, below
        case "less":
            holds, fails = below, above
        case "same":
            least, most = neutral - SAME, neutral + SAME
            holds, fails = least <= low and high <= most, low > most or high < least
    if holds:
        return Verdict.HOLDS
    return Verdict.FAILS if fails else Verdict.OPEN


def together(verdicts: Iterable[Verdict]) -> Verdict:
    """The verdict on a claim from those on its parts."""
    told = set(verdicts) - {Verdict.MISSING}
    if not told:
        return Verdict.MISSING
    if Verdict.FAILS in told:
        return Verdict.IN_PART if Verdict.HOLDS in told else Verdict.FAILS
    return Verdict.HOLDS if told == {Verdict.HOLDS} else Verdict.OPEN


@dataclass(frozen=True)
class Judged:
    """A claim with the verdicts on its comparisons, by case."""

    claim: Claim
    parts: dict[str, tuple[Verdict, ...]]

    def verdict(self, case: str = BASE) -> Verdict:
        """The verdict under a case."""
        return together(self.parts[case])

    @property
    def survives(self) -> str:
        """How the verdicts on all geometries go together, in words."""
        told = {self.verdict(name) for name in GEOMETRIES}
        if len(told) == 1 and told <= {Verdict.HOLDS, Verdict.FAILS, Verdict.IN_PART}:
            return "same on all three geometries"
        if Verdict.HOLDS in told and told & {Verdict.FAILS, Verdict.IN_PART}:
            return "changes with the geometry"
        return "not decided on all three"

    def count(self, case: str) -> str:
        """How many comparisons hold where they disagree, and how many are missing, in words."""
        count = Counter(self.parts[case])
        missing = count.pop(Verdict.MISSING, 0)
        text = f"{count[Verdict.HOLDS]} of {count.total()} hold" if len(count) > 1 else ""
        return text + (f" ({missing} not computed)" if missing and count else "")


def judged(evidence: Evidence) -> list[Judged]:
    """Judge every claim under every case."""
    return [
        Judged(
            claim,
            {
                case: tuple(verdict(compared(evidence, case, part), part) for part in claim.parts)
                for case in JUDGED
            },
        )
        for claim in CLAIMS
    ]


def standing(number: Printed, ours: Measured | None) -> Standing:
    """How a printed number stands against our own.

    A printed peak is one draw, so it is held against single cycles.  A printed depth scales
    with K_d / b, which the paper does not print: ratios of depths are compared instead.
    """
    if ours is None:
        return Standing.MISSING
    if number.quantity == "depth":
        return Standing.FREE
    if number.quantity == "angle":
        # Turned to the side of our own.
        return agreement(ours.value + turned(number.value - ours.value), ours)
    if ours.draws is None or ours.first is None:
        return Standing.OPEN
    # The paper shows the first cycle of its run; ours is among what it is held against.
    if number.value > max(ours.draws[1], ours.first[1]):
        return Standing.ABOVE
    is_below = number.value < min(ours.draws[0], ours.first[0])
    return Standing.BELOW if is_below else Standing.INSIDE


def agreement(printed: float, ours: Measured | None) -> Standing:
    """How a printed number stands against our interval."""
    if ours is None:
        return Standing.MISSING
    if ours.ends is None:
        return Standing.OPEN
    return Standing.AGREES if ours.ends[0] <= printed <= ours.ends[1] else Standing.DIFFERS
