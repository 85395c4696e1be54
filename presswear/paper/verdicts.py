"""Verdicts on claims and on printed numbers, from the intervals of our quantities."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from scipy.special import stdtrit

import presswear as pw
from presswear.paper.evidence import Evidence, Measured
from presswear.paper.printed import (
    CLAIMS,
    COMPARISONS,
    PRINTED,
    Claim,
    Comparison,
    Printed,
    wrapped_angle,
)
from presswear.paper.settings import BASE, GEOMETRIES, JUDGED

SAME = 0.02  # change, relative or rad, below which the paper's "unchanged" holds
NO_EFFECT = 0.1  # change, relative or rad, that is too small for a claimed change

Verdict = Literal[
    "holds", "holds in part", "does not hold", "no effect", "undecided", "not computed"
]
_DECIDED = {"holds", "holds in part", "does not hold", "no effect"}
# Position of a printed number relative to ours.
Position = Literal[
    "inside",
    "above",
    "below",
    "agrees",
    "differs",
    "as ratios only",
    "undecided",
    "not computed",
]


def ratio(
    over: Sequence[pw.statistics.Estimate],
    under: Sequence[pw.statistics.Estimate],
    factors: Sequence[float] = (),
) -> pw.statistics.Estimate:
    """Return a product of estimates divided by another product, with its interval.

    Variance estimates are recovered from the intervals, on logarithms (Donner and Zou,
    Statistical Methods in Medical Research 21, 2012, 347). ``factors`` widen the
    intervals.
    """

    def log_widths(
        estimate: pw.statistics.Estimate, factor: float
    ) -> tuple[float, float]:
        if estimate.low is None or estimate.high is None:
            return math.nan, math.nan
        below = math.inf
        if estimate.low > 0.0:
            below = math.log(estimate.mean / estimate.low)
        above = math.log(max(estimate.high / estimate.mean, 1.0))
        return factor * below, factor * above

    numerator = math.prod(estimate.mean for estimate in over)
    denominator = math.prod(estimate.mean for estimate in under)
    value = numerator / denominator
    every = [*over, *under]
    below = []  # widths of the logarithms below and above the ratio
    above = []
    for k, estimate in enumerate(every):
        low, high = log_widths(estimate, factors[k] if factors else 1.0)
        # A larger denominator makes the ratio smaller.
        is_denominator = k >= len(over)
        below.append(high if is_denominator else low)
        above.append(low if is_denominator else high)
    down = math.hypot(*below)
    up = math.hypot(*above)
    if math.isnan(down) or math.isnan(up):
        return pw.statistics.Estimate(value)
    return pw.statistics.Estimate(value, value * math.exp(-down), value * math.exp(up))


def difference(
    over: pw.statistics.Estimate,
    under: pw.statistics.Estimate,
    is_angle: bool,
    factors: Sequence[float] = (1.0, 1.0),
) -> pw.statistics.Estimate:
    """Return the difference of two estimates, with its interval; ``factors`` widen theirs."""
    value = over.mean - under.mean
    if is_angle:
        value = wrapped_angle(value)
    if over.low is None or over.high is None or under.low is None or under.high is None:
        return pw.statistics.Estimate(value)
    first, second = factors
    down = math.hypot(
        first * (over.mean - over.low), second * (under.high - under.mean)
    )
    up = math.hypot(first * (over.high - over.mean), second * (under.mean - under.low))
    return pw.statistics.Estimate(value, value - down, value + up)


def widening(freedom: float, count: int) -> float:
    """Return the factor by which ``count`` intervals widen to hold together with 95 %.

    Without it each of them holds with 95 %. Each of the wider intervals has an error
    probability of 5 % / ``count`` (Bonferroni). ``freedom`` is the number of degrees of
    freedom of Student's interval.
    """
    single = stdtrit(freedom, 0.975)
    many = stdtrit(freedom, 1.0 - 0.025 / count)
    return float(many / single)


def compared(
    evidence: Evidence, case: str, comparison: Comparison, count: int = 1
) -> pw.statistics.Estimate | None:
    """Return our ratio or difference; None if one of its quantities was not computed.

    Its interval is wide enough for ``count`` intervals to hold together with 95 %.
    """
    places = (*comparison.over, *comparison.under)
    every = [evidence.measured(case, place, comparison.quantity) for place in places]
    measured = [value for value in every if value is not None]
    if len(measured) < len(places):
        return None
    ours = [value.estimate for value in measured]
    factors = factors_of(measured, count)
    if comparison.is_difference:
        return difference(ours[0], ours[1], comparison.quantity == "angle", factors)
    if any(estimate.mean <= 0.0 for estimate in ours):
        return None
    numerators = len(comparison.over)
    return ratio(ours[:numerators], ours[numerators:], factors)


def factors_of(measured: Sequence[Measured], count: int) -> list[float]:
    """Return the factors by which the intervals of quantities widen; see ``widening``."""
    return [widening(value.freedom, count) for value in measured]


def verdict(ours: pw.statistics.Estimate | None, comparison: Comparison) -> Verdict:
    """Return whether an interval confirms the expected change."""
    if ours is None:
        return "not computed"
    if ours.low is None or ours.high is None:
        return "undecided"
    neutral = 0.0 if comparison.is_difference else 1.0
    margin = SAME if comparison.expected == "same" else 0.0
    if ours.low > neutral + margin:
        side = "more"
    elif ours.high < neutral - margin:
        side = "less"
    elif margin and neutral - margin <= ours.low and ours.high <= neutral + margin:
        side = "same"
    else:
        small = NO_EFFECT
        if comparison.expected == "same" or comparison.quantity == "lag":
            small = 0.0  # a lag has no scale on which a change is small
        is_small = neutral - small <= ours.low and ours.high <= neutral + small
        return "no effect" if is_small else "undecided"
    return "holds" if side == comparison.expected else "does not hold"


def combined(verdicts: Iterable[Verdict]) -> Verdict:
    """Return the verdict on a claim from the verdicts on its comparisons."""
    computed = set(verdicts) - {"not computed"}
    if not computed:
        return "not computed"
    if computed & {"does not hold", "no effect"}:
        if "holds" in computed:
            return "holds in part"
        return "does not hold" if "does not hold" in computed else "no effect"
    return "holds" if computed == {"holds"} else "undecided"


@dataclass(frozen=True)
class Judged:
    """Claim with the verdicts on its comparisons, by case."""

    claim: Claim
    verdicts: dict[str, tuple[Verdict, ...]]

    def verdict(self, case: str = BASE) -> Verdict:
        """Return the verdict under a case."""
        return combined(self.verdicts[case])

    @property
    def geometry(self) -> str:
        """Agreement of the verdicts on all geometries, in words."""
        verdicts = {self.verdict(name) for name in GEOMETRIES}
        if len(verdicts) == 1 and verdicts <= _DECIDED:
            return "same on all three geometries"
        if "holds" in verdicts and verdicts & _DECIDED - {"holds"}:
            return "changes with the geometry"
        return "not decided on all three"

    def text(self, case: str) -> str:
        """Return the verdict, with counts where comparisons disagree or are missing."""
        count = Counter(self.verdicts[case])
        missing = count.pop("not computed", 0)
        text = f"{self.verdict(case)}"
        if len(count) > 1:
            text += f" ({count['holds']} of {count.total()} hold)"
        if missing and count:
            text += f" ({missing} not computed)"
        return text


def judge(evidence: Evidence) -> list[Judged]:
    """Return every claim with its verdicts under every case.

    The intervals of all comparisons of a case hold together with 95 %.
    """
    claims = []
    for claim in CLAIMS:
        by_case = {}
        for case in JUDGED:
            verdicts = []
            for comparison in claim.comparisons:
                estimate = compared(evidence, case, comparison, COMPARISONS)
                verdicts.append(verdict(estimate, comparison))
            by_case[case] = tuple(verdicts)
        claims.append(Judged(claim, by_case))
    return claims


def position(number: Printed, ours: Measured | None) -> Position:
    """Return the position of a printed number relative to ours.

    A printed peak is one draw, so it is compared with single cycles. A printed depth
    scales with K_d / b, which the paper does not print, so ratios of depths are
    compared instead.
    """
    if ours is None:
        return "not computed"
    if number.quantity == "depth":
        return "as ratios only"
    if number.quantity == "angle":
        value = ours.estimate.mean
        return agreement(value + wrapped_angle(number.value - value), ours.estimate)
    if ours.single_cycles is None or ours.first_cycles is None:
        return "undecided"
    # The paper shows the first cycle of its run, so ours are part of the range.
    if number.value > max(ours.single_cycles[1], ours.first_cycles[1]):
        return "above"
    is_below = number.value < min(ours.single_cycles[0], ours.first_cycles[0])
    return "below" if is_below else "inside"


def agreement(printed: float, ours: pw.statistics.Estimate | None) -> Position:
    """Return whether a printed number is in our interval."""
    if ours is None:
        return "not computed"
    if ours.low is None or ours.high is None:
        return "undecided"
    return "agrees" if ours.low <= printed <= ours.high else "differs"


def positions(evidence: Evidence) -> list[tuple[Printed, Position]]:
    """Return the position of every printed number, for each stage that it may belong to."""
    result = []
    for number in PRINTED:
        for place in number.places:
            ours = evidence.measured(BASE, place, number.quantity)
            result.append((number, position(number, ours)))
    return result
