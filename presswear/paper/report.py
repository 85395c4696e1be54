"""Report page of the paper's study: verdicts, printed numbers, figures, assumptions and runs."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, get_args

import numpy as np

import presswear as pw
from presswear.paper import settings, verdicts
from presswear.paper.errors import error_table
from presswear.paper.evidence import OF_MAPS, QUANTITIES, Evidence
from presswear.paper.figures import drawings
from presswear.paper.printed import (
    COMPARISONS,
    DEPTH_RATIOS,
    DOUBTFUL,
    HIGHLIGHTS,
    PRINTED,
    RANGES,
    TEXTS,
    Comparison,
    Place,
    Printed,
    printed_at,
)
from presswear.paper.settings import (
    BASE,
    GEOMETRIES,
    JOINTS,
    JUDGED,
    LONG,
    SETTINGS,
    WEAR,
)
from presswear.paper.verdicts import Judged, compared
from presswear.show import page
from presswear.show.figures.style import TEMPLATES
from presswear.show.page import NOTHING, Line, Section, Table, plain_table, text_of
from presswear.show.report import provenance_table
from presswear.show.scene_tables import setting_tables
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import readable, unit_factor, whole

TITLE = "Chen, Tang and Gao's worn press, computed again"
SENSITIVE_RATIOS = len(settings.SENSITIVITIES) * len(TEXTS["tables"]["sensitive"])
RUNAWAY = 10.0  # a second wear that adds so many times the depth of the first runs away


def write_report(results: Mapping[str, pw.Result], folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and its figures into a folder; return the answer and the path."""
    evidence = Evidence(results)
    path = folder / "report.html"
    claims = verdicts.judge(evidence)
    answer = headline(evidence, claims)
    sections = page_sections(evidence, claims)
    figures = page.illustrated(drawings(evidence), inside(folder, "figures"))
    sections.insert(3, Section("Figures 8 to 25", figures=figures, is_open=True))
    write_bytes(
        path, page.render_page(TITLE, page.FirstScreen(), sections, [answer]).encode()
    )
    return answer, path


def failures_of(evidence: Evidence) -> dict[str, str]:
    """Return the messages of the runs that failed, by case."""
    return {
        name.partition("--")[0]: result.message
        for name, result in evidence.results.items()
        if result.status == "failed"
    }


def page_sections(evidence: Evidence, claims: Sequence[Judged]) -> list[Section]:
    """Return the sections of the page without the figures of the paper."""
    failures = failures_of(evidence)
    runs: dict[str, Table | None] = {"": run_table(evidence)}
    if first := next(iter(evidence.results.values()), None):
        runs["Parameters of the first setting"] = setting_tables(first)["parameters"]
        runs["Provenance"] = provenance_table(first)
    numbers = {"": number_table(evidence), "Ratios of depths": ratio_table(evidence)}
    numbers["Ranges of wear"] = range_table(evidence)
    assumptions = {
        "Geometries": geometry_table(evidence),
        "Wear coefficient": fit_table(evidence),
    }
    assumptions["One assumption changed"] = sensitivity_table(evidence, failures)
    claim_text = TEXTS["claims"].format(
        comparisons=COMPARISONS, least=100 * verdicts.NO_EFFECT
    )
    assumption_text = TEXTS["assumptions"].format(ratios=SENSITIVE_RATIOS)
    verdict_counts = {"Verdicts": count_table(claims)}
    parts: list[tuple[str, Sequence[str], Mapping[str, Table | None]]] = [
        ("In short", findings(evidence, failures), verdict_counts),
        ("Claims on trends", [claim_text], {"": claim_table(evidence, claims)}),
        ("Every printed number of sections 5.3 and 5.4", [TEXTS["numbers"]], numbers),
        ("Assumptions, their fit and their effect", [assumption_text], assumptions),
        ("Errors of the paper", [TEXTS["errors"]], {"": error_table(evidence)}),
        (
            "Accuracy of the statistics",
            [TEXTS["statistics"]],
            {"": long_table(evidence)},
        ),
        ("Runs", (), runs),
    ]
    return [
        Section(
            heading,
            texts,
            [(name, one) for name, one in tables.items() if one],
            is_open=not k,
        )
        for k, (heading, texts, tables) in enumerate(parts)
    ]


def headline(evidence: Evidence, claims: Sequence[Judged]) -> str:
    """Return the answer of the study in a few sentences."""
    peaks = verdicts.positions(evidence)
    text = TEMPLATES.from_string(TEXTS["headline"]).render(
        claims=len(claims),
        count=Counter(claim.verdict() for claim in claims),
        same=sum(claim.geometry.startswith("same") for claim in claims),
        peaks=Counter(
            one for number, one in peaks if number.quantity not in ("depth", "angle")
        ),
    )
    return text.strip()


def findings(evidence: Evidence, failures: Mapping[str, str]) -> list[str]:
    """Return the most important results, each with its numbers, as far as they were computed."""
    ours = {name: compared(evidence, BASE, part) for name, part in HIGHLIGHTS.items()}
    second = ours["second wear"]
    # positions of peaks where the stage is known
    new = Counter[str]()
    worn = Counter[str]()
    for number, one in verdicts.positions(evidence):
        if len(number.places) == 1 and one in ("inside", "above", "below"):
            (worn if number.place.wear_updates else new)[one] += 1
    wide = {
        name: compared(evidence, BASE, part, COMPARISONS)
        for name, part in HIGHLIGHTS.items()
    }
    effects = {
        name: verdicts.verdict(wide[name], part) for name, part in HIGHLIGHTS.items()
    }
    text = TEMPLATES.from_string(TEXTS["findings"]).render(
        ours=ours,
        text={name: text_of(one) for name, one in ours.items()},
        printed={
            name: f"printed: {readable(one.printed)}"
            for name, one in HIGHLIGHTS.items()
        },
        # The ratio of total depths has the first wear in it.
        runs_away=second is not None and second.mean - 1.0 > RUNAWAY,
        new=new,
        worn=worn,
        effect={name: TEXTS["effects"][one] for name, one in effects.items()},
        fit=fit(depth_factors(evidence, BASE)),
        doubtful=len(DOUBTFUL),
        failure=failures.get(settings.PAPER_STEP, ""),
    )
    return [line for line in text.splitlines() if line.strip()]


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


def printed_text(number: Printed | None) -> str:
    """Return a printed value with all its digits, in our unit."""
    if number is None:
        return readable(None)
    return readable(unit_factor(QUANTITIES[number.quantity].unit) * number.value, 4)


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
    names = [SETTINGS[place.setting].short for place in (first, second)]
    if first.setting != second.setting:
        change = f"{' → '.join(names)}, {stage}"
    else:
        change = f"{names[1]}, {stage_text(first, part.quantity)} → {stage}"
    if len(part.over) > 1:
        return f"{change}, growth at A over growth at C"
    if first.joint != second.joint:
        return (
            f"{first.joint} → {second.joint}, {SETTINGS[second.setting].label}, {stage}"
        )
    return f"joint {second.joint}, {change}" if second.joint else change


def detail(evidence: Evidence, part: Comparison) -> str:
    """Return our value of a comparison on the standard geometry, the printed one, the verdict."""
    ours = compared(evidence, BASE, part)
    row = QUANTITIES[part.quantity]
    unit, sign, after = (
        (row.unit, "", f" {row.unit}") if part.is_difference else ("", "×", "")
    )
    text = f"{row.label}, {comparison_text(part)}: {sign}{text_of(ours, unit)}{after}"
    if part.printed is not None:
        text += f"; printed {sign}{readable(unit_factor(unit) * part.printed)}{after}"
    wide = compared(evidence, BASE, part, COMPARISONS)
    return f"{text}; {verdicts.verdict(wide, part)}"


def claim_table(evidence: Evidence, claims: Sequence[Judged]) -> Table:
    """Return every claim with its verdicts, and the details of its comparisons."""
    lines = []
    meanings = {}
    for judged in claims:
        label = f"§ {judged.claim.where}: “{judged.claim.quote}”"
        lines.append((label, *(judged.text(case) for case in JUDGED), judged.geometry))
        details = (detail(evidence, part) for part in judged.claim.parts)
        meanings[label] = " | ".join(filter(None, (judged.claim.note, *details)))
    head = ("the paper's words", *GEOMETRIES, "refined conventions", "geometry")
    return Table(head, (("", tuple(lines)),), numeric=False, meanings=meanings)


def count_table(claims: Sequence[Judged]) -> Table:
    """Return how many claims have which verdict, by case."""
    lines = (
        (
            word,
            *(str(sum(one.verdict(case) == word for one in claims)) for case in JUDGED),
        )
        for word in get_args(verdicts.Verdict)
    )
    return plain_table(("claims", *GEOMETRIES, "refined conventions"), lines)


def number_table(evidence: Evidence) -> Table:
    """Return every printed number beside ours."""
    groups = dict[str, list[Line]]()
    meanings = dict[str, str]()
    for number in PRINTED:
        setting = SETTINGS[number.place.setting]
        row = QUANTITIES[number.quantity]
        heading = f"Section {number.section}: {setting.label}"
        for place in number.places:
            ours = evidence.measured(BASE, place, number.quantity)
            label = f"{setting.short}: {place_text(place, number.quantity)}, Fig. {number.figure}"
            over = None
            ranges = list[str]()
            remarks = [number.misprint]
            if (
                ours is not None
                and ours.estimate.mean > 0.0
                and number.quantity != "angle"
            ):
                over = number.value / ours.estimate.mean
            for ends in (
                (ours.single_cycles, ours.first_cycles) if ours else (None, None)
            ):
                ranges.append(range_text(ends, row.unit, row.digits))
            value = value_text(evidence, BASE, place, number.quantity)
            position = verdicts.position(number, ours)
            line = (
                label,
                printed_text(number),
                value,
                *ranges,
                readable(over),
                position,
            )
            groups.setdefault(heading, []).append(line)
            if len(number.places) > 1:
                remarks.append(
                    "the paper does not say before or after which wear; both are shown"
                )
            if ours is not None and ours.differ:
                remarks.append(
                    "our replicates differ, so that the interval is over replicates"
                )
            if any(remarks):
                meanings[label] = "; ".join(filter(None, remarks))
    ours_heads = ("ours (95 % interval)", "single cycles (95 %)", "first cycles")
    head = ("printed number", "paper", *ours_heads, "paper / ours", "printed number is")
    return Table(
        head, tuple((name, tuple(one)) for name, one in groups.items()), False, meanings
    )


def ratio_table(evidence: Evidence) -> Table:
    """Return ratios of printed depths beside ours, which do not depend on K_d / b."""
    lines = []
    for part in DEPTH_RATIOS:
        ours = compared(evidence, BASE, part)
        printed = part.printed
        assert printed is not None, "only printed depths are compared"
        texts = (
            readable(printed),
            text_of(ours),
            readable(printed / ours.mean if ours else None),
        )
        wide = compared(evidence, BASE, part, len(DEPTH_RATIOS))
        lines.append((comparison_text(part), *texts, verdicts.agreement(printed, wide)))
    head = (
        "ratio of deepest wears",
        "paper",
        "ours (95 % interval)",
        "paper / ours",
        "the paper",
    )
    return plain_table(head, lines, numeric=False)


def range_table(evidence: Evidence) -> Table:
    """Return how much of our wear lies in the printed ranges."""
    lines = []
    for figure, joint, arcs in RANGES:
        degrees = np.degrees(arcs)
        for setting in (settings.FRICTION, settings.HIGH_FRICTION):
            place = Place(setting, 1, joint)
            ours = evidence.wear_map(BASE, place)
            text = NOTHING
            if ours is not None:
                inside_arcs = [
                    (low <= ours.angle) & (ours.angle <= high) for low, high in arcs
                ]
                part = float(
                    ours.mean[np.any(inside_arcs, axis=0)].sum() / ours.mean.sum()
                )
                text = f"{readable(100.0 * part)} %"
            printed = ", ".join(f"{low:.4g}° to {high:.4g}°" for low, high in degrees)
            circle = f"{np.diff(degrees).sum() / 3.6:.3g} %"
            lines.append((joint_text(place), figure, printed, circle, text))
    head = (
        "main wear area",
        "Fig.",
        "paper",
        "part of the circle",
        "part of our wear inside",
    )
    return plain_table(head, lines, numeric=False)


def geometry_table(evidence: Evidence) -> Table:
    """Return how each geometry meets the printed peaks of the smooth motion."""
    lines = []
    for quantity, wear_updates in TEXTS["tables"]["smooth"]:
        place = Place(WEAR, wear_updates)
        texts = (value_text(evidence, name, place, quantity) for name in GEOMETRIES)
        value = printed_text(printed_at(place, quantity))
        lines.append((place_text(place, quantity), value, *texts))
    return plain_table(("", "paper", *GEOMETRIES), lines)


def depth_factors(evidence: Evidence, case: str) -> dict[Place, float]:
    """Return printed depths after a first wear divided by ours."""
    factors: dict[Place, float] = {}
    for number in PRINTED:
        if (number.quantity, number.place.wear_updates) == ("depth", 1):
            ours = evidence.estimate(case, number.place, "depth")
            if ours is not None and ours.mean > 0.0:
                factors[number.place] = number.value / ours.mean
    return factors


class Fit(NamedTuple):
    """One factor on K_d / b for all printed depths; nan if there are none."""

    best: float  # geometric mean of all but the doubtful prints
    # factor by which single depths miss it, root mean square of logarithms
    typical: float
    largest: float  # of these factors


def fit(factors: Mapping[Place, float]) -> Fit:
    """Return the factor on K_d / b that fits best, and how far single depths are from it."""
    logs = np.log(
        [factor for place, factor in factors.items() if place not in DOUBTFUL]
    )
    if not logs.size:
        return Fit(math.nan, math.nan, math.nan)
    off = logs - logs.mean()
    numbers = (logs.mean(), logs.std(), np.abs(off).max())
    return Fit(*(math.exp(number) for number in numbers))


def fit_table(evidence: Evidence) -> Table:
    """Return printed depths divided by ours; a perfect fit would be one number for all."""
    factors = [depth_factors(evidence, name) for name in JUDGED]
    lines = []
    for place in dict.fromkeys(place for one in factors for place in one):
        doubt = " (doubtful print, left out)" if place in DOUBTFUL else ""
        lines.append(
            (joint_text(place) + doubt, *(readable(one.get(place)) for one in factors))
        )
    best, typical, largest = zip(*map(fit, factors), strict=True)
    summary = (
        ("best factor on K_d / b", *map(readable, best)),
        (
            "factor by which single depths miss it, rms of logarithms",
            *map(readable, typical),
        ),
        ("largest of these factors", *map(readable, largest)),
    )
    head = ("paper / ours, deepest after the first wear", *JUDGED)
    return Table(head, (("", tuple(lines)), ("One number for all", summary)))


def case_ratio(
    evidence: Evidence,
    place: Place,
    quantity: str,
    cases: tuple[str, str],
    count: int,
) -> tuple[str, bool]:
    """Return a quantity under a case over that under another, and whether it is not 1.

    It is not 1 if its interval, one of ``count`` that hold together with 95 %, does not
    hold 1.
    """
    pair = [evidence.measured(name, place, quantity) for name in cases]
    measured = [one for one in pair if one is not None and one.estimate.mean > 0.0]
    if len(measured) < 2:
        return text_of(None), False
    over, under = ([one.estimate] for one in measured)
    wide = verdicts.ratio(over, under, verdicts.factors_of(measured, count))
    differs = (
        wide.low is not None
        and wide.high is not None
        and not wide.low <= 1.0 <= wide.high
    )
    return text_of(verdicts.ratio(over, under)), differs


def sensitivity_table(evidence: Evidence, failures: Mapping[str, str]) -> Table:
    """Return the effect of each changed assumption; failures are messages by case."""
    shown = [
        (name, Place(WEAR, *place)) for name, *place in TEXTS["tables"]["sensitive"]
    ]
    lines = []
    for name, case in settings.SENSITIVITIES.items():
        ratios = [
            case_ratio(evidence, place, quantity, (name, BASE), SENSITIVE_RATIOS)
            for quantity, place in shown
        ]
        cells = (f"{text}{' *' * differs}" for text, differs in ratios)
        failure = f": {failures[name]}" if name in failures else ""
        lines.append((f"{case.label}{failure}", *cells))
    heads = (
        f"{quantity} {one.joint} {stage_text(one, quantity)}" for quantity, one in shown
    )
    return plain_table(("changed alone", *heads), lines)


def long_table(evidence: Evidence) -> Table:
    """Return the standard runs beside those of 200 cycles of each replicate."""
    lines = []
    places = [
        (Place(setting, wear_updates, joint), quantity)
        for setting in settings.CASES[LONG].settings
        for quantity, wear_updates in TEXTS["tables"]["long"]
        for joint in (("",) if quantity in ("velocity", "acceleration") else JOINTS)
    ]
    for place, quantity in places:
        short, long = (
            evidence.measured(case, place, quantity) for case in (BASE, LONG)
        )
        text, differs = case_ratio(evidence, place, quantity, (BASE, LONG), len(places))
        if short is None or long is None or text == NOTHING:
            continue
        cycles = (
            f"{short.estimate.samples} of {short.replicates}",
            str(long.estimate.samples),
        )
        texts = (value_text(evidence, case, place, quantity) for case in (BASE, LONG))
        ours = [text for pair in zip(texts, cycles, strict=True) for text in pair]
        lines.append(
            (place_text(place, quantity), *ours, text, "no" if differs else "yes")
        )
    heads = (
        "run",
        "cycles, replicates",
        "200 of each",
        "cycles",
        "ratio",
        "may be the same",
    )
    return plain_table(("", *heads), lines, numeric=False)


def run_table(evidence: Evidence) -> Table:
    """Return cycles, status, energy residual and wall time of each run."""
    lines = []
    for name, result in evidence.results.items():
        statistics = [stage.statistics for stage in result.stages]
        moving = [one for one in statistics if one.energy_exchanged]
        residuals = [abs(one.energy_residual) / one.energy_exchanged for one in moving]
        cycles = ", ".join(whole(one.cycles) for one in statistics)
        status = f"{result.status}: {result.message}".removesuffix(": ")
        residual = text_of(max(residuals, default=None), digits=1)
        wall = text_of(result.wall_s)
        lines.append((settings.run_label(name), cycles, status, residual, wall))
    heads = (
        "run",
        "cycles of each stage",
        "status",
        "energy residual",
        "wall time (s)",
    )
    return plain_table(heads, lines, numeric=False)
