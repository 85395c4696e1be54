"""The paper's claims, judged, as the page shows them."""

from collections.abc import Sequence

from presswear.show.report.parts import Table
from presswear.studies.paper.claims import Comparison
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.variants import BASE, GEOMETRIES, JUDGED
from presswear.studies.paper.verdicts import Judged, Verdict, compared, verdict
from presswear.studies.paper.words import QUANTITIES, compared_text, ratio_text
from presswear.tools.numbers import readable

STYLES = {
    Verdict.HOLDS: "good",
    Verdict.FAILS: "bad",
    Verdict.IN_PART: "bad",
    Verdict.OPEN: "open",
    Verdict.MISSING: "open",
}
"""How a verdict is coloured."""


def details(evidence: Evidence, claim: Judged) -> list[str]:
    """Each comparison on the standard geometry: of what, ours, the printed one, the verdict."""
    return [_detail(evidence, part) for part in claim.claim.parts]


def _detail(evidence: Evidence, part: Comparison) -> str:
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
