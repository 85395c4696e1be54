"""The first screen of the report: what stands and what does not, in plain words."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence

from presswear.paper.claims import Comparison, by_friction, by_speed, by_wear, c_and_a, more
from presswear.paper.evidence import Evidence
from presswear.paper.printed import DOUBTFUL
from presswear.paper.report.chosen import factors_of, fit_of
from presswear.paper.report.numbers import standings
from presswear.paper.variants import (
    BASE,
    FAST,
    GEOMETRIES,
    JUDGED,
    PAPER_STEP,
)
from presswear.paper.verdicts import Judged, Standing, Verdict, compared, verdict
from presswear.paper.words import QUANTITIES, compared_text, ratio_text
from presswear.show.page import Table
from presswear.tools.numbers import readable

RUNAWAY = 10.0  # a second wear that adds so many times the depth of the first has run away
STYLES = {
    Verdict.HOLDS: "good",
    Verdict.FAILS: "bad",
    Verdict.IN_PART: "half",
    Verdict.OPEN: "open",
    Verdict.MISSING: "open",
}
"""How a verdict is coloured."""


def detail(evidence: Evidence, part: Comparison) -> str:
    """Tell a comparison on the standard geometry: ours, what is printed, the verdict."""
    ours = compared(evidence, BASE, part)
    shown = QUANTITIES[part.quantity]
    factor, sign, unit = 1.0, "×", ""
    if part.is_difference:
        factor, sign, unit = shown.factor, "", f" {shown.unit}"
    text = f"{shown.label}, {compared_text(part)}: {sign}{ratio_text(ours, factor)}{unit}"
    if part.printed is not None:
        text += f"; printed {sign}{readable(factor * part.printed)}{unit}"
    return f"{text}; {verdict(ours, part)}"


def counts_table(claims: Sequence[Judged]) -> Table:
    """How many claims have which verdict, by case."""
    rows = tuple(
        (str(word), *(str(sum(claim.verdict(case) is word for claim in claims)) for case in JUDGED))
        for word in Verdict
    )
    return Table(("claims", *GEOMETRIES, "refined conventions"), (("", rows),))


def headline(evidence: Evidence, claims: Sequence[Judged]) -> str:
    """The answer in a few sentences."""
    count = Counter(claim.verdict() for claim in claims)
    same = sum(claim.survives.startswith("same") for claim in claims)
    peaks = Counter(
        stand for item, stand in standings(evidence) if item.quantity not in ("depth", "angle")
    )
    held = peaks.total() - peaks[Standing.MISSING]
    return (
        f"Of {len(claims)} claims on trends, {count[Verdict.HOLDS]} hold, "
        f"{count[Verdict.IN_PART]} hold in part, {count[Verdict.FAILS]} do not hold and "
        f"{count[Verdict.OPEN] + count[Verdict.MISSING]} cannot be told; {same} verdicts are the "
        f"same on all three geometries that fit the paper. Of {held} printed peaks held "
        f"against single cycles of ours, {peaks[Standing.INSIDE]} lie within their scatter, "
        f"{peaks[Standing.ABOVE]} above and {peaks[Standing.BELOW]} below."
    )


def findings(evidence: Evidence, failures: Mapping[str, str]) -> list[str]:
    """Tell what matters most, each with its figures."""
    found = [*_trends(evidence), *_peaks(evidence), *_scale(evidence)]
    if PAPER_STEP in failures:
        found.append(
            "The paper's own step, 1e-4 s, is as long as a contact: the same equations stepped "
            f"so end early ({failures[PAPER_STEP]})."
        )
    return found


_RATIOS = {
    "second": more("depth", by_wear(("A",), 1, 2)),
    "wear": more("depth", by_friction(("A",), 1)),
    "force": more("force", by_friction(("A",), 0)),
    "fast": more("depth", by_speed(("A",), 1)),
    "joints": more("depth", c_and_a((FAST, 1))),
}
_TRENDS = (
    (
        ("second",),
        "The second wear {second_runs}: after it the deepest wear at A is {second} times that "
        "after the first; the paper prints {second_printed} times. scenarios/runaway.py asks why.",
    ),
    (
        ("wear", "force"),
        "Doubling the friction coefficient changes the deepest wear at A by a factor of {wear}, "
        "the mean peak force of a cycle by {force}; the paper prints {wear_printed} and "
        "{force_printed}.",
    ),
    (
        ("fast", "joints"),
        "Twice the speed makes the wear at A {fast} times deeper (printed: {fast_printed}), and A "
        "wears {joints} times deeper than C at 8π (printed: {joints_printed}).",
    ),
)
"""Ratios, and a sentence of them and of what the paper prints for them."""


def _trends(evidence: Evidence) -> list[str]:
    """Sentences whose ratios are all known."""
    texts: dict[str, str] = {}
    for name, (part,) in _RATIOS.items():
        ours = compared(evidence, BASE, part)
        if ours is not None:
            texts |= {name: ratio_text(ours), f"{name}_printed": readable(part.printed)}
            # Of a ratio of depths one is the first wear itself.
            is_away = ours.value - 1.0 > RUNAWAY
            texts[f"{name}_runs"] = "runs away" if is_away else "does not run away"
    return [sentence.format(**texts) for names, sentence in _TRENDS if texts.keys() >= set(names)]


def _peaks(evidence: Evidence) -> list[str]:
    """Printed peaks by whether the surfaces were worn; those of an unsaid stage are left out."""
    new, worn = (
        Counter(
            stand
            for item, stand in standings(evidence)
            if not item.stage_not_said
            and (item.place.wear_updates > 0) is is_worn
            and stand in (Standing.INSIDE, Standing.ABOVE, Standing.BELOW)
        )
        for is_worn in (False, True)
    )
    if not new or not worn:
        return []
    below = worn[Standing.BELOW]
    others = f"{below} of the others are lower" if below else "the others are higher"
    return [
        f"A peak of one cycle is one draw of many. Without wear {new[Standing.INSIDE]} of "
        f"{new.total()} printed peaks lie within the scatter of our single cycles; after a wear "
        f"{worn[Standing.INSIDE]} of {worn.total()} do, and {others} than any but the rarest of "
        "ours."
    ]


def _scale(evidence: Evidence) -> list[str]:
    """The one factor on K_d / b."""
    best, spread = fit_of(factors_of(evidence, BASE))
    if math.isnan(best):
        return []
    return [
        f"One number for K_d / b, {readable(best)} times ours, meets the other printed "
        f"first-wear depths within a factor of {readable(spread)}; {len(DOUBTFUL)} at A are "
        "printed ten times or more below it and below C, against the paper's own text: their "
        "power of ten is probably a misprint."
    ]
