"""The first screen of the report: what stands and what does not, in plain words."""

from collections import Counter
from collections.abc import Mapping, Sequence

from presswear.studies.paper.claims import Comparison
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.printed import LOST_FACTOR, PRINTED, Place
from presswear.studies.paper.report.chosen import fit_of
from presswear.studies.paper.report.numbers import standings
from presswear.studies.paper.variants import (
    BASE,
    FAST,
    FRICTION,
    HIGH_FRICTION,
    PAPER_STEP,
    SLOW,
    WEAR,
)
from presswear.studies.paper.verdicts import Judged, Standing, Verdict, compared
from presswear.studies.paper.words import ratio_text
from presswear.tools.numbers import readable


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
    return [
        *_trends(evidence),
        *_peaks(evidence),
        *_scale(evidence),
        *(
            f"The paper's own step, 1e-4 s, is as long as a contact: the same equations stepped "
            f"so end early ({failures[case]})."
            for case in (PAPER_STEP,)
            if case in failures
        ),
    ]


_RATIOS = {
    "second": Comparison("depth", (Place(WEAR, 2, "A"),), (Place(WEAR, 1, "A"),)),
    "wear": Comparison("depth", (Place(HIGH_FRICTION, 1, "A"),), (Place(FRICTION, 1, "A"),)),
    "force": Comparison("force", (Place(HIGH_FRICTION, 0, "A"),), (Place(FRICTION, 0, "A"),)),
    "fast": Comparison("depth", (Place(FAST, 1, "A"),), (Place(SLOW, 1, "A"),)),
    "joints": Comparison("depth", (Place(FAST, 1, "A"),), (Place(FAST, 1, "C"),)),
}
_TRENDS = (
    (
        ("second",),
        "The second wear does not run away: after it the deepest wear at A is {second} times that "
        "after the first; the paper prints {second_printed} times. presswear run runaway asks why.",
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
    for name, part in _RATIOS.items():
        ours = compared(evidence, BASE, part)
        if ours is not None:
            texts |= {name: ratio_text(ours), f"{name}_printed": readable(part.printed)}
    return [sentence.format(**texts) for names, sentence in _TRENDS if texts.keys() >= set(names)]


def _peaks(evidence: Evidence) -> list[str]:
    """Printed peaks by whether the surfaces were worn; those of an unsaid stage are left out."""
    told = [
        (item.place.wears > 0, stand is Standing.INSIDE)
        for item, stand in standings(evidence)
        if not item.stage_not_said and stand in (Standing.INSIDE, Standing.ABOVE, Standing.BELOW)
    ]
    new, worn = ([inside for is_worn, inside in told if is_worn is own] for own in (False, True))
    if not new or not worn:
        return []
    return [
        f"A peak of one cycle is one draw of many. Without wear {sum(new)} of {len(new)} printed "
        f"peaks lie within the scatter of our single cycles; after a wear {sum(worn)} of "
        f"{len(worn)} do, and the others are higher than any but the rarest of ours."
    ]


def _scale(evidence: Evidence) -> list[str]:
    """The one factor on K_d / b."""
    fit = fit_of(evidence, BASE)
    if not fit.logs:
        return []
    lost = sum(item.misprint == LOST_FACTOR for item in PRINTED)
    return [
        f"One number for K_d / b, {readable(fit.best)} times ours, meets the other printed "
        f"first-wear depths within a factor of {readable(fit.spread)}; {lost} at A are printed ten "
        "times or more below it and below C, against the paper's own text: their power of ten is "
        "probably a misprint."
    ]
