"""The report of a study of speed against error: one HTML file."""

from pathlib import Path

from presswear.figures import save
from presswear.figures.numbers import with_interval
from presswear.figures.precision import precision_drawings
from presswear.precision.growth import HIGH, LOW, PARTED
from presswear.precision.recommendation import RULES, Recommendation, recommend
from presswear.precision.study import Precision
from presswear.report.page import Illustration, render_page
from presswear.report.parts import Table
from presswear.report.precision_tables import (
    diagram_table,
    failures_table,
    growth_table,
    origin_table,
    references_table,
    sampling_table,
    statistics_table,
    wear_table,
)
from presswear.results import write_bytes
from presswear.starts import APART

_STYLES = {True: "good", False: "bad", None: "open"}


def recommendations(precision: Precision) -> tuple[Recommendation, ...]:
    """What to take, from everything that the study has."""
    return recommend(precision.scene, precision.diagrams, precision.chaos, precision.wear)


def headline(precision: Precision, found: tuple[Recommendation, ...]) -> str:
    """The answer in a few sentences."""
    parts = []
    chaos = precision.chaos
    best = None if chaos is None else chaos.cheapest()
    if chaos is not None and best is not None:
        parts.append(
            f"The cheapest setting that is honest for wear is {best.method.label}: "
            f"{best.cost:.2g} s for a simulated second, with every step error below the sampling "
            f"error of a stage of {chaos.stage_cycles} cycles."
        )
    elif chaos is not None:
        parts.append(
            "No setting has been shown to be honest for wear: so few cycles leave room for step "
            f"errors larger than the sampling error of a stage of {chaos.stage_cycles} cycles."
        )
    agreed = [one for one in found if one.agrees is not None]
    if agreed:
        count = sum(bool(one.agrees) for one in agreed)
        parts.append(
            f"Of {len(agreed)} recommendations that can be compared the code takes {count}."
        )
    failed = paper_failures(precision)
    if failed:
        parts.append(f"The paper's setting, RK4 at 1e-4 s, fails: {failed}.")
    return " ".join(parts) or "There is nothing to recommend from what was run."


def paper_failures(precision: Precision) -> str:
    """Where the paper's setting failed, in words; may be empty."""
    failed = [
        (diagram.title, point.failure)
        for diagram in precision.diagrams
        for point in diagram.points
        if point.method.is_paper and point.failure
    ]
    if precision.chaos is not None:
        failed += [
            ("statistics", point.failure)
            for point in precision.chaos.points
            if point.method.is_paper and point.failure
        ]
    return "; ".join(f"{title} ({why})" for title, why in failed)


def growth_sentence(precision: Precision) -> str:
    """Growth rate and divergence time, in a sentence."""
    chaos = precision.chaos
    if chaos is None or not chaos.growths:
        return ""
    first = chaos.growths[0]
    if first.window is None:
        return (
            f"Two runs whose starts are {APART:g} m apart stay within {HIGH:g} m over "
            f"{first.time[-1]:.3g} s."
        )
    text = (
        f"From {LOW:g} to {HIGH:g} m the distance of two runs whose starts are {APART:g} m apart "
        f"grows by {first.rate:.3g} /s, or {first.per_touch:.2g} in the logarithm a touch"
    )
    if first.divergence is not None:
        text += (
            f"; it is {PARTED:g} m after {first.divergence:.3g} s and "
            f"{first.touches_to_divergence} touches"
        )
    others = chaos.growths[1:]
    if others:
        settled = chaos.settled_rate
        parted = sum(growth.divergence is not None for growth in others)
        text += (
            f". That is while the pins, which start in the middle of their bearings, settle. Of "
            f"{len(others)} further pairs, begun later in the motion, {parted} part within "
            f"{others[0].time[-1]:.3g} s; lulls included, they grow by "
            f"{with_interval(settled.mean, settled.half_width)} /s"
        )
    return f"{text}."


def recommendation_table(found: tuple[Recommendation, ...]) -> list[dict[str, object]]:
    """Recommendations by purpose, with the rule and the rows."""
    return [
        {
            "purpose": purpose,
            "rule": rule,
            "rows": [
                {"one": one, "style": _STYLES[one.agrees]}
                for one in found
                if one.purpose == purpose
            ],
        }
        for purpose, rule in RULES.items()
        if any(one.purpose == purpose for one in found)
    ]


def write_precision_report(precision: Precision, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and the figures into a folder; returns the answer and the path."""
    figures = {
        drawing.file: Illustration.of(save(drawing, folder / "figures"), folder / "figures")
        for drawing in precision_drawings(precision)
    }
    found = recommendations(precision)
    answer = headline(precision, found)
    path = folder / "report.html"
    write_bytes(path, render(precision, found, figures).encode())
    return answer, path


def _named(figures: dict[str, Illustration], *names: str) -> list[Illustration]:
    files = [f"precision-{name}.png" for name in names]
    return [figures[file] for file in files if file in figures]


def render(
    precision: Precision,
    found: tuple[Recommendation, ...],
    figures: dict[str, Illustration],
) -> str:
    """The page as text."""
    tasks: list[tuple[str, str, list[Illustration], Table]] = [
        (diagram.key, diagram.title, _named(figures, diagram.key), diagram_table(diagram))
        for diagram in precision.diagrams
    ]
    chaos, wear = precision.chaos, precision.wear
    return render_page(
        "precision.html",
        scene=precision.scene,
        quick=precision.extent.quick,
        headline=headline(precision, found),
        growth=growth_sentence(precision),
        purposes=recommendation_table(found),
        tasks=tasks,
        together=_named(figures, "orders", "energy"),
        chaos=chaos,
        chaos_figures=_named(figures, "growth", "statistics"),
        growth_table=None if chaos is None else growth_table(chaos),
        sampling_table=None if chaos is None else sampling_table(chaos),
        statistics_table=None if chaos is None else statistics_table(chaos),
        wear=wear,
        wear_figures=_named(figures, "wear", "contact"),
        wear_table=None if wear is None else wear_table(wear),
        failures=failures_table(precision),
        references=references_table(precision.diagrams),
        origin=origin_table(precision),
    )
