"""The paper's claims, judged: what holds, on which geometry, by which figures."""

from dataclasses import dataclass

from presswear.studies.paper.claim import Claim
from presswear.studies.paper.claims import CLAIMS
from presswear.studies.paper.evidence import Evidence, Place
from presswear.studies.paper.variants import BASE, GEOMETRIES, REFINED
from presswear.studies.paper.verdicts import Comparison, Verdict, compared, together, verdict
from presswear.studies.paper.words import QUANTITIES, ratio_text, setting_text, stage_text
from presswear.tools.numbers import readable

JUDGED_CASES = (*GEOMETRIES, REFINED)
"""Cases in which every claim is judged."""

STYLES = {
    Verdict.HOLDS: "good",
    Verdict.FAILS: "bad",
    Verdict.IN_PART: "bad",
    Verdict.OPEN: "open",
    Verdict.MISSING: "open",
}
"""How a verdict is coloured."""

_SHORT = {
    "wear-times": "3.5π",
    "friction-0.05": "c_f 0.05",
    "friction-0.1": "c_f 0.1",
    "speed-4pi": "4π",
    "speed-8pi": "8π",
}


@dataclass(frozen=True)
class Judged:
    """A claim with its verdicts.

    Attributes
    ----------
    verdicts : tuple of (str, Verdict)
        By case.
    parts : tuple of tuple of Verdict
        Of the claim's comparisons, by case.
    details : tuple of str
        What our runs and the paper have for each comparison, standard geometry.
    """

    claim: Claim
    verdicts: tuple[tuple[str, Verdict], ...]
    parts: tuple[tuple[Verdict, ...], ...]
    details: tuple[str, ...]

    @property
    def standard(self) -> Verdict:
        """The verdict on the standard geometry."""
        return dict(self.verdicts)[BASE]

    @property
    def survives(self) -> str:
        """Whether the verdict is the same on all geometries."""
        by_case = dict(self.verdicts)
        told = {by_case[name] for name in GEOMETRIES}
        if len(told) == 1 and told <= {Verdict.HOLDS, Verdict.FAILS, Verdict.IN_PART}:
            return "same on all three geometries"
        if Verdict.HOLDS in told and told & {Verdict.FAILS, Verdict.IN_PART}:
            return "changes with the geometry"
        return "not decided on all three"

    def rows(self) -> list[tuple[str, str, str, str]]:
        """Case, verdict, its style, and of how many comparisons it is where they disagree."""
        found = []
        for (case, word), parts in zip(self.verdicts, self.parts, strict=True):
            told = [part for part in parts if part is not Verdict.MISSING]
            count = ""
            if len(set(told)) > 1:
                count = f"{sum(part is Verdict.HOLDS for part in told)} of {len(told)} hold"
            if 0 < len(told) < len(parts):
                count += f" ({len(parts) - len(told)} not computed)"
            found.append((case, str(word), STYLES[word], count))
        return found


def judged(evidence: Evidence) -> list[Judged]:
    """Every claim under every case."""
    return [_judge(evidence, claim) for claim in CLAIMS]


def _judge(evidence: Evidence, claim: Claim) -> Judged:
    parts = tuple(
        tuple(verdict(compared(evidence, case, part), part) for part in claim.parts)
        for case in JUDGED_CASES
    )
    verdicts = tuple(
        (case, together(found)) for case, found in zip(JUDGED_CASES, parts, strict=True)
    )
    return Judged(claim, verdicts, parts, tuple(_detail(evidence, part) for part in claim.parts))


def _detail(evidence: Evidence, part: Comparison) -> str:
    """One comparison: what it is of, what we have, what is printed."""
    interval = compared(evidence, BASE, part)
    shown = QUANTITIES[part.quantity]
    factor = shown.factor if part.is_difference else 1.0
    unit = f" {shown.unit}" if part.is_difference else ""
    sign = "" if part.is_difference else "×"
    text = f"{shown.label}, {compared_text(part)}: {sign}{ratio_text(interval, factor)}{unit}"
    if part.printed is not None:
        text += f"; printed {sign}{readable(factor * part.printed)}{unit}"
    return f"{text}; {verdict(interval, part)}"


def compared_text(part: Comparison) -> str:
    """What is compared with what, in words."""
    first, second = part.under[0], part.over[0]
    if len(part.over) > 1:
        change = _change(first, second, part.quantity)
        return f"{change}, growth at A over growth at C"
    where = f"joint {second.joint}, " if second.joint and first.joint == second.joint else ""
    return where + _change(first, second, part.quantity)


def _change(first: Place, second: Place, quantity: str) -> str:
    """What changes from one place to another, and what stays."""
    if first.joint != second.joint:
        stage = stage_text(second, quantity)
        return f"{first.joint} → {second.joint}, {setting_text(second.setting)}, {stage}"
    if first.setting != second.setting:
        stage = stage_text(second, quantity)
        return f"{_SHORT[first.setting]} → {_SHORT[second.setting]}, {stage}"
    stages = f"{stage_text(first, quantity)} → {stage_text(second, quantity)}"
    return f"{_SHORT[second.setting]}, {stages}"
