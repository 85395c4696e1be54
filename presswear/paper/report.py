"""Report page of the paper's study: verdicts, printed numbers, figures, assumptions and runs."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

import presswear as pw
from presswear.paper import settings
from presswear.paper.claims import DEPTH_RATIOS, HIGHLIGHTS, Comparison
from presswear.paper.evidence import OF_MAPS, QUANTITIES, Evidence
from presswear.paper.figures import drawers
from presswear.paper.printed import DOUBTFUL, PRINTED, RANGES, Place, Printed, printed_at
from presswear.paper.settings import BASE, GEOMETRIES, JOINTS, JUDGED, LONG, SETTINGS, WEAR
from presswear.paper.verdicts import Judged, Position, Verdict, agreement, compared, judge

from presswear.paper.verdicts import position, positions, ratio, verdict  # isort: skip
from presswear.show.page import NOTHING, Line, Row, Section, Table, illustrated, render_page

from presswear.show.page import row_table, text_of  # isort: skip
from presswear.show.report_tables import convention_table, parameter_table, provenance_table
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import readable, unit_factor, whole

TITLE = "Chen, Tang and Gao's worn press, computed again"
RUNAWAY = 10.0  # a second wear that adds so many times the depth of the first runs away

# quantity and wear updates of the slider by which the geometries were chosen
_SMOOTH = (
    *(("displacement", 1), ("displacement", 2), ("stroke", 0)),
    *(("velocity", 0), ("velocity", 1), ("velocity", 2)),
)
# those that are shown for each changed assumption
_SENSITIVE = (
    *(("depth", Place(WEAR, 1, joint)) for joint in JOINTS),
    *(("force", Place(WEAR, k, joint)) for k in (0, 1) for joint in JOINTS),
    ("displacement", Place(WEAR, 0)),
)
# those that are compared with runs of 200 cycles of each replicate
_LONG = (
    *(("depth", 1), ("added_mean", 1), ("range", 1), ("added_mean", 2), ("force", 0)),
    *(("force", 1), ("velocity", 0), ("acceleration", 0), ("acceleration", 1)),
)


def write_report(results: Mapping[str, pw.Result], folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and its figures into a folder; return the answer and the path."""
    evidence, path = Evidence(results), folder / "report.html"
    claims = judge(evidence)
    answer, sections = headline(evidence, claims), page_sections(evidence, claims)
    figures = illustrated(drawers(evidence), inside(folder, "figures"))
    sections.insert(3, Section("Figures 8 to 25", figures=figures))
    write_bytes(path, render_page(TITLE, sections, answer=[answer]).encode())
    return answer, path


def page_sections(evidence: Evidence, claims: Sequence[Judged]) -> list[Section]:
    """Return the sections of the page without the figures of the paper."""
    failures = {
        name.partition("--")[0]: result.message
        for name, result in evidence.results.items()
        if result.status == "failed"
    }
    runs: list[tuple[str, Table]] = [("", run_table(evidence))]
    for first in list(evidence.results.values())[:1]:
        runs.append(("Conventions", convention_table(first)))
        runs.append(("Parameters of the first setting", parameter_table(first)))
        if origin := provenance_table(first):
            runs.append(("Provenance", origin))
    assumptions = [
        ("Geometries", geometry_table(evidence)),
        ("Wear coefficient", fit_table(evidence)),
        ("One assumption changed", sensitivity_table(evidence, failures)),
    ]
    numbers = [
        ("", number_table(evidence)),
        ("Ratios of depths", ratio_table(evidence)),
        ("Ranges of wear", range_table(evidence)),
    ]
    verdicts = [("Verdicts", count_table(claims))]
    return [
        Section("In short", findings(evidence, failures), verdicts),
        Section("Claims on trends", [CLAIMS_TEXT], [("", claim_table(evidence, claims))]),
        Section("Every printed number of sections 5.3 and 5.4", [NUMBERS_TEXT], numbers),
        Section("Assumptions, their fit and their effect", [ASSUMPTIONS_TEXT], assumptions),
        Section("Accuracy of the statistics", [STATISTICS_TEXT], [("", long_table(evidence))]),
        Section("Runs", tables=runs),
    ]


CLAIMS_TEXT = """
A claim holds if the 95 % interval of each of its ratios (or differences) lies on the claimed side,
and does not hold if one lies on the other side; otherwise it is undecided. Of a hundred comparisons
at 95 % some five are wrong. Below each claim: our values on the standard geometry, and what the
paper prints."""
NUMBERS_TEXT = """
Ours: mean over the cycles of all replicates after the start-up, with its 95 % interval. The paper
reads its peaks from the first cycle of one run, so a printed peak is compared with the range of
95 % of our single cycles and with our first cycles, which begin with the pins amid their bearings.
Depths scale with K_d / b, which the paper does not print; their ratios are compared."""
ASSUMPTIONS_TEXT = """
The paper does not print the place of the second frame joint, which side of the plate is which, the
wear coefficient and the width of the bearings. Three geometries were chosen by the printed peaks of
the smooth motion. One K_d / b is assumed for all scenes; the second table shows what it would have
to be for each printed depth, relative to the assumed one. The last table has ratios to the standard
runs at 3.5π with 95 % intervals, with one assumption changed; those marked * are certainly not 1.
Engine and step should bear few marks."""
STATISTICS_TEXT = """
The motion is chaotic: replicates from slightly different positions separate within a cycle or two.
The first two cycles are left out; the others are samples, in batches where there are many.
Intervals of means are Student's. After a wear, and where replicates differ by more than their
cycles explain (analysis of variance, 1 %), the replicates are the samples. Intervals of the deepest
place of a map are from a bootstrap over the same samples. The table has the runs beside others in
which each replicate takes 200 cycles."""


def range_text(ends: tuple[float, float] | None, unit: str, digits: int = 3) -> str:
    """Return a range in a display unit, without the unit."""
    if ends is None:
        return NOTHING
    low, high = (readable(unit_factor(unit) * end, digits) for end in ends)
    return low if low == high else f"{low} to {high}"


def value_text(evidence: Evidence, case: str, place: Place, quantity: str) -> str:
    """Return our value of a quantity with its interval."""
    row = QUANTITIES[quantity]
    return text_of(evidence.estimate(case, place, quantity), row.unit, row.digits)


def printed_text(value: float | None, quantity: str) -> str:
    """Return a printed value with all its digits, in our unit."""
    factor = unit_factor(QUANTITIES[quantity].unit)
    return readable(None if value is None else factor * value, 4)


def stage_text(place: Place, quantity: str) -> str:
    """Return the stage, or the wear, that a quantity belongs to."""
    stage = settings.STAGES[place.wear_updates]
    return f"after the {stage}" if quantity in OF_MAPS else stage


def place_text(place: Place, quantity: str) -> str:
    """Return a quantity at a place in words, with its unit and without its setting."""
    row = QUANTITIES[quantity]
    joint = f"joint {place.joint}, " if place.joint else ""
    return f"{row.label}, {joint}{stage_text(place, quantity)} ({row.unit})"


def joint_text(place: Place) -> str:
    """Return a joint in a setting, in words."""
    return f"joint {place.joint}, {SETTINGS[place.setting].label}"


def comparison_text(part: Comparison) -> str:
    """Return both sides of a comparison, in words."""
    first, second = part.under[0], part.over[0]
    stage = stage_text(second, part.quantity)
    settings = [SETTINGS[place.setting].short for place in (first, second)]
    if first.setting != second.setting:
        change = f"{' → '.join(settings)}, {stage}"
    else:
        change = f"{settings[1]}, {stage_text(first, part.quantity)} → {stage}"
    if len(part.over) > 1:
        return f"{change}, growth at A over growth at C"
    if first.joint != second.joint:
        return f"{first.joint} → {second.joint}, {SETTINGS[second.setting].label}, {stage}"
    return f"joint {second.joint}, {change}" if second.joint else change


def detail(evidence: Evidence, part: Comparison) -> str:
    """Return our value of a comparison on the standard geometry, the printed one, the verdict."""
    ours, row = compared(evidence, BASE, part), QUANTITIES[part.quantity]
    unit, sign, after = (row.unit, "", f" {row.unit}") if part.is_difference else ("", "×", "")
    text = f"{row.label}, {comparison_text(part)}: {sign}{text_of(ours, unit)}{after}"
    if part.printed is not None:
        text += f"; printed {sign}{readable(unit_factor(unit) * part.printed)}{after}"
    return f"{text}; {verdict(ours, part)}"


def claim_table(evidence: Evidence, claims: Sequence[Judged]) -> Table:
    """Return every claim with its verdicts, and the details of its comparisons."""
    lines, meanings = [], {}
    for judged in claims:
        label = f"§ {judged.claim.where}: “{judged.claim.quote}”"
        lines.append((label, *(judged.text(case) for case in JUDGED), judged.geometry))
        details = (detail(evidence, part) for part in judged.claim.parts)
        meanings[label] = " | ".join(filter(None, (judged.claim.note, *details)))
    head = ("the paper's words", *GEOMETRIES, "refined conventions", "geometry")
    return Table(head, (("", tuple(lines)),), numeric=False, meanings=meanings)


def count_table(claims: Sequence[Judged]) -> Table:
    """Return how many claims have which verdict, by case."""
    lines = tuple(
        (str(word), *(str(sum(one.verdict(case) is word for one in claims)) for case in JUDGED))
        for word in Verdict
    )
    return Table(("claims", *GEOMETRIES, "refined conventions"), (("", lines),))


def number_table(evidence: Evidence) -> Table:
    """Return every printed number beside ours."""
    groups: dict[str, list[Line]] = {}
    meanings = {}
    for number in PRINTED:
        heading = f"Section {number.section}: {SETTINGS[number.place.setting].label}"
        for place in number.places:
            label, line, remark = _number_line(evidence, number, place)
            groups.setdefault(heading, []).append((label, *line))
            if remark:
                meanings[label] = remark
    ours = ("ours (95 % interval)", "single cycles (95 %)", "first cycles")
    head = ("printed number", "paper", *ours, "paper / ours", "printed number is")
    return Table(head, tuple((name, tuple(one)) for name, one in groups.items()), False, meanings)


def _number_line(evidence: Evidence, number: Printed, place: Place) -> tuple[str, Line, str]:
    """Return label, texts and remark of a printed number."""
    ours = evidence.measured(BASE, place, number.quantity)
    row = QUANTITIES[number.quantity]
    label = f"{SETTINGS[place.setting].short}: {place_text(place, number.quantity)}"
    remarks = [number.misprint] if number.misprint else []
    if len(number.places) > 1:
        remarks.append("the paper does not say before or after which wear; both are shown")
    if ours is not None and ours.differ:
        remarks.append("our replicates differ, so that the interval is over replicates")
    over = None
    if ours is not None and ours.estimate.mean > 0.0 and number.quantity != "angle":
        over = number.value / ours.estimate.mean
    line = (
        printed_text(number.value, number.quantity),
        value_text(evidence, BASE, place, number.quantity),
        range_text(ours.single_cycles if ours else None, row.unit, row.digits),
        range_text(ours.first_cycles if ours else None, row.unit, row.digits),
        readable(over),
        str(position(number, ours)),
    )
    return f"{label}, Fig. {number.figure}", line, "; ".join(remarks)


def ratio_table(evidence: Evidence) -> Table:
    """Return ratios of printed depths beside ours, which do not depend on K_d / b."""
    lines = []
    for part in DEPTH_RATIOS:
        ours, printed = compared(evidence, BASE, part), part.printed
        assert printed is not None, "only printed depths are compared"
        over = readable(printed / ours.mean if ours else None)
        texts = (readable(printed), text_of(ours), over, str(agreement(printed, ours)))
        lines.append((comparison_text(part), *texts))
    head = ("ratio of deepest wears", "paper", "ours (95 % interval)", "paper / ours", "the paper")
    return Table(head, (("", tuple(lines)),), numeric=False)


def range_table(evidence: Evidence) -> Table:
    """Return how much of our wear lies in the printed ranges."""
    lines = []
    for figure, joint, arcs in RANGES:
        degrees = np.degrees(arcs)
        for setting in (settings.FRICTION, settings.HIGH_FRICTION):
            place = Place(setting, 1, joint)
            ours, part = evidence.wear_map(BASE, place), None
            if ours is not None:
                inside_arcs = [(low <= ours.angle) & (ours.angle <= high) for low, high in arcs]
                part = float(ours.mean[np.any(inside_arcs, axis=0)].sum() / ours.mean.sum())
            printed = ", ".join(f"{low:.4g}° to {high:.4g}°" for low, high in degrees)
            circle = f"{np.diff(degrees).sum() / 3.6:.3g} %"
            ours_text = NOTHING if part is None else f"{readable(100.0 * part)} %"
            lines.append((joint_text(place), figure, printed, circle, ours_text))
    head = ("main wear area", "Fig.", "paper", "part of the circle", "part of our wear inside")
    return Table(head, (("", tuple(lines)),), numeric=False)


def geometry_table(evidence: Evidence) -> Table:
    """Return how each geometry meets the printed peaks of the smooth motion."""
    lines = []
    for quantity, wear_updates in _SMOOTH:
        place = Place(WEAR, wear_updates)
        printed = printed_at(place, quantity)
        texts = (value_text(evidence, name, place, quantity) for name in GEOMETRIES)
        value = printed_text(printed.value if printed else None, quantity)
        lines.append((place_text(place, quantity), value, *texts))
    return Table(("", "paper", *GEOMETRIES), (("", tuple(lines)),))


def depth_factors(evidence: Evidence, case: str) -> dict[Place, float]:
    """Return printed depths after a first wear divided by ours."""
    factors: dict[Place, float] = {}
    for number in PRINTED:
        if (number.quantity, number.place.wear_updates) == ("depth", 1):
            ours = evidence.estimate(case, number.place, "depth")
            if ours is not None and ours.mean > 0.0:
                factors[number.place] = number.value / ours.mean
    return factors


def fit(factors: Mapping[Place, float]) -> tuple[float, float]:
    """Return the factor on K_d / b that fits best, and the factor by which single depths miss it.

    They are the geometric mean of all but the doubtful prints, and the root mean square of
    logarithms; nan if there are none.
    """
    logs = [math.log(factor) for place, factor in factors.items() if place not in DOUBTFUL]
    if not logs:
        return math.nan, math.nan
    mean = sum(logs) / len(logs)
    return math.exp(mean), math.exp(math.sqrt(sum((log - mean) ** 2 for log in logs) / len(logs)))


def fit_table(evidence: Evidence) -> Table:
    """Return printed depths divided by ours; a perfect fit would be one number for all."""
    factors = [depth_factors(evidence, name) for name in JUDGED]
    lines = []
    for place in dict.fromkeys(place for one in factors for place in one):
        doubt = " (doubtful print, left out)" if place in DOUBTFUL else ""
        lines.append((joint_text(place) + doubt, *(readable(one.get(place)) for one in factors)))
    best, spread = zip(*map(fit, factors), strict=True)
    summary = (
        ("best factor on K_d / b", *map(readable, best)),
        ("factor by which single depths miss it", *map(readable, spread)),
    )
    head = ("paper / ours, deepest after the first wear", *JUDGED)
    return Table(head, (("", tuple(lines)), ("One number for all", summary)))


def case_ratio(
    evidence: Evidence, place: Place, quantity: str, case: str, reference: str = BASE
) -> pw.Estimate | None:
    """Return a quantity under a case divided by itself under another case."""
    pair = [evidence.estimate(name, place, quantity) for name in (case, reference)]
    positive = [one for one in pair if one is not None and one.mean > 0.0]
    return ratio(positive[:1], positive[1:]) if len(positive) == 2 else None


def differs_from_one(estimate: pw.Estimate | None) -> bool:
    """Return whether the interval of a ratio excludes 1."""
    if estimate is None or estimate.low is None or estimate.high is None:
        return False
    return not estimate.low <= 1.0 <= estimate.high


def sensitivity_table(evidence: Evidence, failures: Mapping[str, str]) -> Table:
    """Return the effect of each changed assumption; failures are messages by case."""
    lines = []
    for case, (label, _) in settings.SENSITIVITIES.items():
        ratios = [case_ratio(evidence, place, quantity, case) for quantity, place in _SENSITIVE]
        cells = (f"{text_of(one)}{' *' * differs_from_one(one)}" for one in ratios)
        lines.append((f"{label}: {failures[case]}" if case in failures else label, *cells))
    heads = (
        f"{quantity} {place.joint} {stage_text(place, quantity)}" for quantity, place in _SENSITIVE
    )
    return Table(("changed alone", *heads), (("", tuple(lines)),))


def long_table(evidence: Evidence) -> Table:
    """Return the standard runs beside those of 200 cycles of each replicate."""
    lines = []
    places = [
        (Place(setting, wear_updates, joint), quantity)
        for setting in settings.LONG_SETTINGS
        for quantity, wear_updates in _LONG
        for joint in (("",) if quantity in ("velocity", "acceleration") else JOINTS)
    ]
    for place, quantity in places:
        short, long = (evidence.measured(case, place, quantity) for case in (BASE, LONG))
        over = case_ratio(evidence, place, quantity, BASE, LONG)
        if short is None or long is None or over is None:
            continue
        cycles = f"{short.estimate.samples} of {short.replicates}", str(long.estimate.samples)
        texts = (value_text(evidence, case, place, quantity) for case in (BASE, LONG))
        ours = [text for pair in zip(texts, cycles, strict=True) for text in pair]
        agrees = "no" if differs_from_one(over) else "yes"
        lines.append((place_text(place, quantity), *ours, text_of(over), agrees))
    heads = ("run", "cycles, replicates", "200 of each", "cycles", "ratio", "may be the same")
    return Table(("", *heads), (("", tuple(lines)),), numeric=False)


def run_table(evidence: Evidence) -> Table:
    """Return cycles, status, energy residual and wall time of each run."""
    records = []
    for name, result in evidence.results.items():
        statistics = [stage.statistics for stage in result.stages]
        moving = [one for one in statistics if one.energy_exchanged]
        residuals = [abs(one.energy_residual) / one.energy_exchanged for one in moving]
        record = {
            "label": settings.run_label(name),
            "cycles": ", ".join(whole(one.cycles) for one in statistics),
            "status": f"{result.status}: {result.message}".removesuffix(": "),
            "residual": max(residuals, default=None),
            "wall": result.wall_s,
        }
        records.append(record)
    columns = [Row("run", "label"), Row("cycles of each stage", "cycles"), Row("status", "status")]
    columns += [Row("energy residual", "residual", digits=1), Row("wall time", "wall", "s")]
    return row_table(columns, records, numeric=False)


def headline(evidence: Evidence, claims: Sequence[Judged]) -> str:
    """Return the answer of the study in a few sentences."""
    count = Counter(claim.verdict() for claim in claims)
    same = sum(claim.geometry.startswith("same") for claim in claims)
    peaks = Counter(
        one for number, one in positions(evidence) if number.quantity not in ("depth", "angle")
    )
    computed = peaks.total() - peaks[Position.MISSING]
    return (
        f"Of {len(claims)} claims on trends, {count[Verdict.HOLDS]} hold, "
        f"{count[Verdict.IN_PART]} hold in part, {count[Verdict.FAILS]} do not hold and "
        f"{count[Verdict.OPEN] + count[Verdict.MISSING]} are undecided; {same} verdicts are the "
        f"same on all three geometries that fit the paper. Of {computed} printed peaks compared "
        f"with our single cycles, {peaks[Position.INSIDE]} lie within their scatter, "
        f"{peaks[Position.ABOVE]} above and {peaks[Position.BELOW]} below."
    )


def findings(evidence: Evidence, failures: Mapping[str, str]) -> list[str]:
    """Return the most important results, each with its numbers."""
    sentences = [*_trends(evidence), *_peaks(evidence)]
    best, spread = fit(depth_factors(evidence, BASE))
    if not math.isnan(best):
        sentences.append(
            f"One number for K_d / b, {readable(best)} times ours, meets the other printed "
            f"first-wear depths within a factor of {readable(spread)}; {len(DOUBTFUL)} at A are "
            "printed ten times or more below it and below C, against the paper's own text: their "
            "power of ten is probably a misprint."
        )
    if settings.PAPER_STEP in failures:
        sentences.append(
            "The paper's step, 1e-4 s, is as long as a contact: the same equations with this step "
            f"end early ({failures[settings.PAPER_STEP]})."
        )
    return sentences


def _trends(evidence: Evidence) -> list[str]:
    """Return the changes by a second wear, friction and speed, as far as they were computed."""
    ours = {name: compared(evidence, BASE, part) for name, part in HIGHLIGHTS.items()}
    text = {name: text_of(one) for name, one in ours.items()}
    printed = {name: f"printed: {readable(part.printed)}" for name, part in HIGHLIGHTS.items()}
    sentences = []
    if second := ours["second wear"]:
        # The ratio of total depths has the first wear in it.
        runs_away = "runs away" if second.mean - 1.0 > RUNAWAY else "does not run away"
        sentences.append(
            f"The second wear {runs_away}: after it the deepest wear at A is {text['second wear']} "
            f"times that after the first ({printed['second wear']}). scenarios/runaway.py asks why."
        )
    if ours["friction, wear"] and ours["friction, force"]:
        sentences.append(
            f"Doubling the friction coefficient changes the deepest wear at A by a factor of "
            f"{text['friction, wear']} ({printed['friction, wear']}), the mean peak force of a "
            f"cycle by {text['friction, force']} ({printed['friction, force']})."
        )
    if ours["speed"] and ours["joints"]:
        sentences.append(
            f"Twice the speed makes the wear at A {text['speed']} times deeper "
            f"({printed['speed']}), and A wears {text['joints']} times deeper than C at 8π "
            f"({printed['joints']})."
        )
    return sentences


def _peaks(evidence: Evidence) -> list[str]:
    """Return the positions of printed peaks without and after a wear, where the stage is known."""
    compared_peaks = [
        (number.place.wear_updates > 0, one)
        for number, one in positions(evidence)
        if len(number.places) == 1 and one in (Position.INSIDE, Position.ABOVE, Position.BELOW)
    ]
    new, worn = (
        Counter(one for is_worn, one in compared_peaks if is_worn is wanted)
        for wanted in (False, True)
    )
    if not new or not worn:
        return []
    below = worn[Position.BELOW]
    others = f"{below} of the others are lower" if below else "the others are higher"
    return [
        f"A peak of one cycle is one draw of many. Without wear {new[Position.INSIDE]} of "
        f"{new.total()} printed peaks lie within the scatter of our single cycles; after a wear "
        f"{worn[Position.INSIDE]} of {worn.total()} do, and {others} than any but the rarest of "
        "ours."
    ]
