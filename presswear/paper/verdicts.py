"""Verdicts on claims and on printed numbers, from the intervals of our quantities."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import presswear as pw
from presswear.paper.evidence import Evidence, Measured
from presswear.paper.printed import CLAIMS, PRINTED, Claim, Comparison, Printed, wrapped_angle
from presswear.paper.settings import BASE, GEOMETRIES, JUDGED

SAME = 0.02  # relative change below which a quantity is considered unchanged


class Verdict(StrEnum):
    """Verdict on a claim."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"
    OPEN = "undecided"
    MISSING = "not computed"


class Position(StrEnum):
    """Position of a printed number relative to ours."""

    INSIDE = "inside"
    ABOVE = "above"
    BELOW = "below"
    AGREES = "agrees"
    DIFFERS = "differs"
    FREE = "as ratios only"
    OPEN = "undecided"
    MISSING = "not computed"


def ratio(over: Sequence[pw.Estimate], under: Sequence[pw.Estimate]) -> pw.Estimate:
    """Return a product of estimates divided by another product, with its interval.

    Variance estimates are recovered from the intervals, on logarithms (Donner and Zou,
    Statistical Methods in Medical Research 21, 2012, 347).
    """

    def log_widths(one: pw.Estimate) -> tuple[float, float]:
        if one.low is None or one.high is None:
            return math.nan, math.nan
        below = math.log(one.mean / one.low) if one.low > 0.0 else math.inf
        return below, math.log(max(one.high / one.mean, 1.0))

    value = math.prod(one.mean for one in over) / math.prod(one.mean for one in under)
    above, below = map(log_widths, over), map(log_widths, under)
    pairs = [*above, *((high, low) for low, high in below)]
    down, up = (math.hypot(*widths) for widths in zip(*pairs, strict=True))
    if any(math.isnan(width) for pair in pairs for width in pair):
        return pw.Estimate(value)
    return pw.Estimate(value, value * math.exp(-down), value * math.exp(up))


def difference(over: pw.Estimate, under: pw.Estimate, is_angle: bool) -> pw.Estimate:
    """Return the difference of two estimates, with its interval."""
    value = over.mean - under.mean
    if is_angle:
        value = wrapped_angle(value)
    if over.low is None or over.high is None or under.low is None or under.high is None:
        return pw.Estimate(value)
    down = math.hypot(over.mean - over.low, under.high - under.mean)
    up = math.hypot(over.high - over.mean, under.mean - under.low)
    return pw.Estimate(value, value - down, value + up)


def compared(evidence: Evidence, case: str, comparison: Comparison) -> pw.Estimate | None:
    """Return our ratio or difference; None if one of its quantities was not computed."""
    places = (*comparison.over, *comparison.under)
    every = [evidence.estimate(case, place, comparison.quantity) for place in places]
    ours = [one for one in every if one is not None]
    if len(ours) < len(places):
        return None
    if comparison.is_difference:
        return difference(ours[0], ours[1], comparison.quantity == "angle")
    if any(one.mean <= 0.0 for one in ours):
        return None
    count = len(comparison.over)
    return ratio(ours[:count], ours[count:])


def verdict(ours: pw.Estimate | None, comparison: Comparison) -> Verdict:
    """Return whether an interval confirms the expected change."""
    if ours is None:
        return Verdict.MISSING
    if ours.low is None or ours.high is None:
        return Verdict.OPEN
    neutral = 0.0 if comparison.is_difference else 1.0
    above, below = ours.low > neutral, ours.high < neutral
    match comparison.expected:
        case "more":
            holds, fails = above, below
        case "less":
            holds, fails = below, above
        case "same":
            least, most = neutral - SAME, neutral + SAME
            holds = least <= ours.low and ours.high <= most
            fails = ours.low > most or ours.high < least
    if holds:
        return Verdict.HOLDS
    return Verdict.FAILS if fails else Verdict.OPEN


def combined(verdicts: Iterable[Verdict]) -> Verdict:
    """Return the verdict on a claim from the verdicts on its comparisons."""
    computed = set(verdicts) - {Verdict.MISSING}
    if not computed:
        return Verdict.MISSING
    if Verdict.FAILS in computed:
        return Verdict.IN_PART if Verdict.HOLDS in computed else Verdict.FAILS
    return Verdict.HOLDS if computed == {Verdict.HOLDS} else Verdict.OPEN


@dataclass(frozen=True)
class Judged:
    """Claim with the verdicts on its comparisons, by case."""

    claim: Claim
    parts: dict[str, tuple[Verdict, ...]]

    def verdict(self, case: str = BASE) -> Verdict:
        """Return the verdict under a case."""
        return combined(self.parts[case])

    @property
    def geometry(self) -> str:
        """Agreement of the verdicts on all geometries, in words."""
        verdicts = {self.verdict(name) for name in GEOMETRIES}
        if len(verdicts) == 1 and verdicts <= {Verdict.HOLDS, Verdict.FAILS, Verdict.IN_PART}:
            return "same on all three geometries"
        if Verdict.HOLDS in verdicts and verdicts & {Verdict.FAILS, Verdict.IN_PART}:
            return "changes with the geometry"
        return "not decided on all three"

    def text(self, case: str) -> str:
        """Return the verdict, with counts where comparisons disagree or are missing."""
        count = Counter(self.parts[case])
        missing = count.pop(Verdict.MISSING, 0)
        text = f"{self.verdict(case)}"
        if len(count) > 1:
            text += f" ({count[Verdict.HOLDS]} of {count.total()} hold)"
        return text + (f" ({missing} not computed)" if missing and count else "")


def judge(evidence: Evidence) -> list[Judged]:
    """Return every claim with its verdicts under every case."""
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


def position(number: Printed, ours: Measured | None) -> Position:
    """Return the position of a printed number relative to ours.

    A printed peak is one draw, so it is compared with single cycles. A printed depth scales with
    K_d / b, which the paper does not print, so ratios of depths are compared instead.
    """
    if ours is None:
        return Position.MISSING
    if number.quantity == "depth":
        return Position.FREE
    if number.quantity == "angle":
        value = ours.estimate.mean
        return agreement(value + wrapped_angle(number.value - value), ours.estimate)
    if ours.single_cycles is None or ours.first_cycles is None:
        return Position.OPEN
    # The paper shows the first cycle of its run, so ours are part of the range.
    if number.value > max(ours.single_cycles[1], ours.first_cycles[1]):
        return Position.ABOVE
    is_below = number.value < min(ours.single_cycles[0], ours.first_cycles[0])
    return Position.BELOW if is_below else Position.INSIDE


def agreement(printed: float, ours: pw.Estimate | None) -> Position:
    """Return whether a printed number is in our interval."""
    if ours is None:
        return Position.MISSING
    if ours.low is None or ours.high is None:
        return Position.OPEN
    return Position.AGREES if ours.low <= printed <= ours.high else Position.DIFFERS


def positions(evidence: Evidence) -> list[tuple[Printed, Position]]:
    """Return the position of every printed number, for each stage that it may belong to."""
    return [
        (number, position(number, evidence.measured(BASE, place, number.quantity)))
        for number in PRINTED
        for place in number.places
    ]
