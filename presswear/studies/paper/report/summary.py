"""The first screen of the report: what stands and what does not, in plain words."""

from collections import Counter
from collections.abc import Mapping, Sequence

from presswear.show.report.parts import Table
from presswear.studies.paper.choices import fit_of
from presswear.studies.paper.evidence import Evidence, Place
from presswear.studies.paper.printed import (
    FAST,
    FRICTION,
    HIGH_FRICTION,
    LOST_FACTOR,
    PRINTED,
    SLOW,
    WEAR,
)
from presswear.studies.paper.report.numbers import standings
from presswear.studies.paper.report.trends import JUDGED_CASES, Judged
from presswear.studies.paper.variants import BASE, PAPER_STEP
from presswear.studies.paper.verdicts import Comparison, Standing, Verdict, compared
from presswear.studies.paper.words import ratio_text
from presswear.tools.numbers import readable


def headline(evidence: Evidence, claims: Sequence[Judged]) -> str:
    """The answer in a few sentences."""
    count = Counter(claim.standard for claim in claims)
    same = sum(claim.survives.startswith("same") for claim in claims)
    peaks = [
        stand
        for item, stand in standings(evidence)
        if item.quantity not in ("depth", "angle") and stand is not Standing.MISSING
    ]
    inside = sum(stand is Standing.INSIDE for stand in peaks)
    above = sum(stand is Standing.ABOVE for stand in peaks)
    below = sum(stand is Standing.BELOW for stand in peaks)
    return (
        f"Of {len(claims)} claims on trends, {count[Verdict.HOLDS]} hold, "
        f"{count[Verdict.IN_PART]} hold in part, {count[Verdict.FAILS]} do not hold and "
        f"{count[Verdict.OPEN] + count[Verdict.MISSING]} cannot be told; {same} verdicts are the "
        f"same on all three geometries that fit the paper. Of {len(peaks)} printed peaks held "
        f"against single cycles of ours, {inside} lie within their scatter, {above} above and "
        f"{below} below."
    )


def findings(evidence: Evidence, failures: Mapping[str, str]) -> list[str]:
    """What matters most, each with its figures."""
    found = [
        _second_wear(evidence),
        _friction(evidence),
        _speed_and_joint(evidence),
        _peaks(evidence),
        _scale(evidence),
    ]
    if PAPER_STEP in failures:
        found.append(
            "The paper's own step, 1e-4 s, is as long as a contact: the same equations stepped "
            f"so end early ({failures[PAPER_STEP]})."
        )
    return [sentence for sentence in found if sentence]


def _ratio(evidence: Evidence, quantity: str, over: Place, under: Place) -> tuple[str, str]:
    """Our ratio and the printed one, as text; empty where there is none."""
    part = Comparison(quantity, (over,), (under,))
    ours = compared(evidence, BASE, part)
    printed = part.printed
    return (
        "" if ours is None else ratio_text(ours),
        "" if printed is None else readable(printed),
    )


def _second_wear(evidence: Evidence) -> str:
    ours, printed = _ratio(evidence, "depth", Place(WEAR, 2, "A"), Place(WEAR, 1, "A"))
    if not ours:
        return ""
    return (
        f"The second wear does not run away: after it the deepest wear at A is {ours} times that "
        f"after the first; the paper prints {printed} times. presswear run runaway asks why."
    )


def _friction(evidence: Evidence) -> str:
    ours, printed = _ratio(evidence, "depth", Place(HIGH_FRICTION, 1, "A"), Place(FRICTION, 1, "A"))
    force, force_printed = _ratio(
        evidence, "force", Place(HIGH_FRICTION, 0, "A"), Place(FRICTION, 0, "A")
    )
    if not ours or not force:
        return ""
    return (
        f"Doubling the friction coefficient changes the deepest wear at A by a factor of {ours}, "
        f"the mean peak force of a cycle by {force}; the paper prints {printed} and "
        f"{force_printed}."
    )


def _speed_and_joint(evidence: Evidence) -> str:
    ours, printed = _ratio(evidence, "depth", Place(FAST, 1, "A"), Place(SLOW, 1, "A"))
    joints, joints_printed = _ratio(evidence, "depth", Place(FAST, 1, "A"), Place(FAST, 1, "C"))
    if not ours or not joints:
        return ""
    return (
        f"Twice the speed makes the wear at A {ours} times deeper (printed: {printed}), and A "
        f"wears {joints} times deeper than C at 8π (printed: {joints_printed})."
    )


def _peaks(evidence: Evidence) -> str:
    """Printed peaks by whether the surfaces were worn; those of an unsaid stage are left out."""
    told = [
        (item.place.wears > 0, stand)
        for item, stand in standings(evidence)
        if not item.stage_not_said and stand in (Standing.INSIDE, Standing.ABOVE, Standing.BELOW)
    ]
    new, worn = (
        [stand for is_worn, stand in told if is_worn is wanted] for wanted in (False, True)
    )
    if not new or not worn:
        return ""
    inside = [sum(stand is Standing.INSIDE for stand in some) for some in (new, worn)]
    return (
        f"A peak of one cycle is one draw of many. Without wear {inside[0]} of {len(new)} printed "
        f"peaks lie within the scatter of our single cycles; after a wear {inside[1]} of "
        f"{len(worn)} do, and the others are higher than any but the rarest of ours."
    )


def _scale(evidence: Evidence) -> str:
    fit = fit_of(evidence, BASE)
    if not fit.used:
        return ""
    lost = sum(item.misprint == LOST_FACTOR for item in PRINTED)
    return (
        f"One number for K_d / b, {readable(fit.best)} times ours, meets the other printed "
        f"first-wear depths within a factor of {readable(fit.spread)}; {lost} at A are printed ten "
        "times or more below it and below C, against the paper's own text: their power of ten is "
        "probably a misprint."
    )


def counts_table(claims: Sequence[Judged]) -> Table:
    """How many claims have which verdict, by case."""
    rows = tuple(
        (
            str(word),
            *(
                str(sum(dict(claim.verdicts)[case] is word for claim in claims))
                for case in JUDGED_CASES
            ),
        )
        for word in Verdict
    )
    head = ("claims", *JUDGED_CASES[:3], "refined conventions")
    return Table(head, (("", rows),))
