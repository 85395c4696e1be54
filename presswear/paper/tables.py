"""Tables of the report on the paper."""

import math
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import NamedTuple, get_args

import numpy as np

from presswear.paper import settings, verdicts
from presswear.paper.evidence import QUANTITIES, Evidence, Measured
from presswear.paper.printed import (
    DEPTH_RATIOS,
    DOUBTFUL,
    PRINTED,
    RANGES,
    TEXTS,
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
from presswear.paper.words import (
    comparison_text,
    detail,
    joint_text,
    place_text,
    printed_text,
    range_text,
    stage_text,
    value_text,
)
from presswear.show.page import NOTHING, Line, Table, plain_table, text_of
from presswear.tools.numbers import readable, whole

SENSITIVE_RATIOS = len(settings.SENSITIVITIES) * len(TEXTS["tables"]["sensitive"])


def claim_table(evidence: Evidence, claims: Sequence[Judged]) -> Table:
    """Return every claim with its verdicts, and the details of its comparisons."""
    lines = []
    meanings = {}
    for judged in claims:
        label = f"§ {judged.claim.where}: “{judged.claim.quote}”"
        lines.append((label, *(judged.text(case) for case in JUDGED), judged.geometry))
        comparisons = judged.claim.comparisons
        details = (detail(evidence, comparison) for comparison in comparisons)
        meanings[label] = " | ".join(filter(None, (judged.claim.note, *details)))
    head = ("the paper's words", *GEOMETRIES, "refined conventions", "geometry")
    return Table(head, (("", tuple(lines)),), numeric=False, meanings=meanings)


def count_table(claims: Sequence[Judged]) -> Table:
    """Return how many claims have which verdict, by case."""
    lines = []
    for word in get_args(verdicts.Verdict):
        counts = []
        for case in JUDGED:
            count = sum(claim.verdict(case) == word for claim in claims)
            counts.append(str(count))
        lines.append((word, *counts))
    return plain_table(("claims", *GEOMETRIES, "refined conventions"), lines)


def number_table(evidence: Evidence) -> Table:
    """Return every printed number beside ours."""
    groups = dict[str, list[Line]]()
    meanings = dict[str, str]()
    for number in PRINTED:
        setting = SETTINGS[number.place.setting]
        lines = groups.setdefault(f"Section {number.section}: {setting.label}", [])
        for place in number.places:
            ours = evidence.measured(BASE, place, number.quantity)
            text = place_text(place, number.quantity)
            label = f"{setting.short}: {text}, Fig. {number.figure}"
            lines.append((label, *_number_cells(evidence, number, place, ours)))
            if remarks := _remarks(number, ours):
                meanings[label] = remarks
    head = (
        "printed number",
        "paper",
        "ours (95 % interval)",
        "single cycles (95 %)",
        "first cycles",
        "paper / ours",
        "printed number is",
    )
    filled = tuple((name, tuple(lines)) for name, lines in groups.items())
    return Table(head, filled, numeric=False, meanings=meanings)


def _number_cells(
    evidence: Evidence, number: Printed, place: Place, ours: Measured | None
) -> Line:
    """Return the cells of a printed number beside ours, without its label."""
    row = QUANTITIES[number.quantity]
    over = single_cycles = first_cycles = None
    if ours is not None:
        single_cycles = ours.single_cycles
        first_cycles = ours.first_cycles
        if ours.estimate.mean > 0.0 and number.quantity != "angle":
            over = number.value / ours.estimate.mean
    return (
        printed_text(number),
        value_text(evidence, BASE, place, number.quantity),
        range_text(single_cycles, row.unit, row.digits),
        range_text(first_cycles, row.unit, row.digits),
        readable(over),
        verdicts.position(number, ours),
    )


def _remarks(number: Printed, ours: Measured | None) -> str:
    """Return remarks on a printed number and on ours; empty without any."""
    remarks = [number.misprint] if number.misprint else []
    if len(number.places) > 1:
        text = "the paper does not say before or after which wear; both are shown"
        remarks.append(text)
    if ours is not None and ours.differ:
        text = "our replicates differ, so that the interval is over replicates"
        remarks.append(text)
    return "; ".join(remarks)


def ratio_table(evidence: Evidence) -> Table:
    """Return ratios of printed depths beside ours, which do not depend on K_d / b."""
    lines = []
    for comparison in DEPTH_RATIOS:
        ours = compared(evidence, BASE, comparison)
        printed = comparison.printed
        assert printed is not None, "only printed depths are compared"
        wide = compared(evidence, BASE, comparison, len(DEPTH_RATIOS))
        line = (
            comparison_text(comparison),
            readable(printed),
            text_of(ours),
            readable(printed / ours.mean if ours else None),
            verdicts.agreement(printed, wide),
        )
        lines.append(line)
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
                is_inside = np.zeros(ours.angle.size, bool)
                for low, high in arcs:
                    is_inside |= (low <= ours.angle) & (ours.angle <= high)
                share = float(ours.mean[is_inside].sum() / ours.mean.sum())
                text = f"{readable(100.0 * share)} %"
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
        if number.quantity == "depth" and number.place.wear_updates == 1:
            ours = evidence.estimate(case, number.place, "depth")
            if ours is not None and ours.mean > 0.0:
                factors[number.place] = number.value / ours.mean
    return factors


class Fit(NamedTuple):
    """One factor on K_d / b for all printed depths; nan if there are none."""

    best: float  # geometric mean of all but the doubtful prints
    # factor between a printed depth and the fit: root mean square of its logarithm
    typical: float
    largest: float  # largest factor between a printed depth and the fit


def fit(factors: Mapping[Place, float]) -> Fit:
    """Return the factor on K_d / b that fits best, and the scatter of the printed depths."""
    certain = [factors[place] for place in factors if place not in DOUBTFUL]
    if not certain:
        return Fit(math.nan, math.nan, math.nan)
    logs = np.log(certain)
    mean = logs.mean()
    largest = np.abs(logs - mean).max()
    return Fit(math.exp(mean), math.exp(logs.std()), math.exp(largest))


def fit_table(evidence: Evidence) -> Table:
    """Return printed depths divided by ours; a perfect fit would be one number for all."""
    factors = [depth_factors(evidence, name) for name in JUDGED]
    lines = []
    for place in dict.fromkeys(chain(*factors)):
        doubt = " (doubtful print, left out)" if place in DOUBTFUL else ""
        texts = (readable(by_place.get(place)) for by_place in factors)
        lines.append((joint_text(place) + doubt, *texts))
    best, typical, largest = zip(*map(fit, factors), strict=True)
    miss = "factor by which single depths miss it, rms of logarithms"
    summary = (
        ("best factor on K_d / b", *map(readable, best)),
        (miss, *map(readable, typical)),
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
    measured = []
    for case in cases:
        value = evidence.measured(case, place, quantity)
        if value is None or value.estimate.mean <= 0.0:
            return text_of(None), False
        measured.append(value)
    over, under = ([value.estimate] for value in measured)
    text = text_of(verdicts.ratio(over, under))
    wide = verdicts.ratio(over, under, verdicts.factors_of(measured, count))
    if wide.low is None or wide.high is None:
        return text, False
    return text, not wide.low <= 1.0 <= wide.high


def sensitivity_table(evidence: Evidence, failures: Mapping[str, str]) -> Table:
    """Return the effect of each changed assumption; failures are messages by case."""
    shown = []
    heads = ["changed alone"]
    for quantity, *stage_and_joint in TEXTS["tables"]["sensitive"]:
        place = Place(WEAR, *stage_and_joint)
        shown.append((quantity, place))
        heads.append(f"{quantity} {place.joint} {stage_text(place, quantity)}")
    lines = []
    for name, case in settings.SENSITIVITIES.items():
        failure = f": {failures[name]}" if name in failures else ""
        cells = [f"{case.label}{failure}"]
        for quantity, place in shown:
            pair = (name, BASE)
            text, differs = case_ratio(
                evidence, place, quantity, pair, SENSITIVE_RATIOS
            )
            cells.append(f"{text} *" if differs else text)
        lines.append(tuple(cells))
    return plain_table(heads, lines)


def long_table(evidence: Evidence) -> Table:
    """Return the standard runs beside those of 200 cycles of each replicate."""
    lines = []
    places = []
    for setting in settings.CASES[LONG].settings:
        for quantity, wear_updates in TEXTS["tables"]["long"]:
            is_of_slider = quantity in ("velocity", "acceleration")
            for joint in ("",) if is_of_slider else JOINTS:
                places.append((Place(setting, wear_updates, joint), quantity))
    for place, quantity in places:
        short = evidence.measured(BASE, place, quantity)
        long = evidence.measured(LONG, place, quantity)
        text, differs = case_ratio(evidence, place, quantity, (BASE, LONG), len(places))
        if short is None or long is None or text == NOTHING:
            continue
        line = (
            place_text(place, quantity),
            value_text(evidence, BASE, place, quantity),
            f"{short.estimate.samples} of {short.replicates}",
            value_text(evidence, LONG, place, quantity),
            str(long.estimate.samples),
            text,
            "no" if differs else "yes",
        )
        lines.append(line)
    heads = (
        "",
        "run",
        "cycles, replicates",
        "200 of each",
        "cycles",
        "ratio",
        "may be the same",
    )
    return plain_table(heads, lines, numeric=False)


def run_table(evidence: Evidence) -> Table:
    """Return cycles, status, energy residual and wall time of each run."""
    lines = []
    for name, result in evidence.results.items():
        cycles = ", ".join(whole(stage.statistics.cycles) for stage in result.stages)
        residuals = []
        for stage in result.stages:
            energy = stage.statistics.energy_exchanged
            if energy:
                residuals.append(abs(stage.statistics.energy_residual) / energy)
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
