"""The report of a study of speed against error: one HTML file."""

import math
from collections.abc import Sequence
from pathlib import Path

from presswear.scene.numerics import Numerics
from presswear.show.report.page import Illustration, illustrate, render_page
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import given, readable, with_interval
from presswear.validation.precision.chaos import Chaos, StatisticPoint
from presswear.validation.precision.diagram import TaskPoint
from presswear.validation.precision.figures import precision_drawings
from presswear.validation.precision.growth import APART, HIGH, LOW, PARTED
from presswear.validation.precision.recommendation import RULES, Recommendation, recommend
from presswear.validation.precision.study import Precision
from presswear.validation.precision.tables import (
    failures_table,
    growth_table,
    origin_table,
    references_table,
    sampling_table,
    statistics_table,
    task_table,
    wear_table,
)


def headline(precision: Precision, found: tuple[Recommendation, ...]) -> str:
    """Answer in a few sentences."""
    best, cycles = precision.chaos.cheapest(), precision.chaos.stage_cycles
    if best is None:
        text = (
            "No setting has been shown to be honest for wear: so few cycles leave room for step "
            f"errors larger than the sampling error of a stage of {cycles} cycles."
        )
    else:
        text = (
            f"The cheapest setting that is honest for wear is {best.method.label}: "
            f"{best.cost:.2g} s for a simulated second, with every step error below the sampling "
            f"error of a stage of {cycles} cycles."
        )
    agreed = [one for one in found if one.agrees is not None and one.recommended]
    nothing = sum(not one.recommended for one in found)
    if agreed:
        taken = sum(bool(one.agrees) for one in agreed)
        finer = sum(bool(one.meets) and not one.agrees for one in agreed)
        rest = len(agreed) - taken - finer
        text += (
            f" Of {len(agreed)} recommendations below the code takes {taken} as they are, {finer} "
            f"in a form that meets the rule at a higher price, and {rest} in one that does not."
            + (f" For {nothing} more nothing that was run meets the rule." if nothing else "")
        )
    tasks: list[tuple[str, Sequence[TaskPoint | StatisticPoint]]] = [
        *((diagram.title, diagram.points) for diagram in precision.diagrams),
        ("statistics of wear", precision.chaos.points),
    ]
    failed = [
        title for title, points in tasks if any(p.method.is_paper and p.failure for p in points)
    ]
    if failed:
        text += f" The paper's setting, RK4 at 1e-4 s, fails: {'; '.join(failed)}."
    return text


def growth_sentence(chaos: Chaos) -> str:
    """Tell growth rate and divergence time in a sentence."""
    first = chaos.growth
    if first.window is None:
        return (
            f"Two runs whose starts are {given(APART)} m apart stay within {given(HIGH)} m over "
            f"{readable(first.time[-1])} s."
        )
    per_touchdown = None if first.per_touchdown is None else 100.0 * math.expm1(first.per_touchdown)
    text = (
        f"The distance of two runs whose starts are {given(APART)} m apart grows by "
        f"{readable(first.rate)} /s between {given(LOW)} and {given(HIGH)} m, or by "
        f"{readable(per_touchdown, 2)} % a touch"
    )
    if first.divergence is not None:
        text += (
            f"; it is {given(PARTED)} m after {readable(first.divergence)} s and "
            f"{first.touchdowns_to_divergence} touches"
        )
    if chaos.exponent is not None:
        rate = with_interval(chaos.exponent.value, chaos.exponent.half_width)
        text += (
            ". That is while the pins, which start in the middle of their bearings, settle; over "
            f"longer times, lulls included, the largest Lyapunov exponent is {rate} /s"
        )
    return f"{text}."


def write_precision_report(precision: Precision, taken: Numerics, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and the figures into a folder; returns the answer and the path.

    Parameters
    ----------
    taken : Numerics
        Engines that the study of the paper takes for statistics.
    """
    into = inside(folder, "figures")
    figures = {drawing.file: illustrate(drawing, into) for drawing in precision_drawings(precision)}

    def named(*names: str) -> list[Illustration]:
        files = [f"precision-{name}.png" for name in names]
        return [figures[file] for file in files if file in figures]

    found, chaos = recommend(precision, taken), precision.chaos
    answer = headline(precision, found)
    text = render_page(
        "precision.html",
        "presswear.validation.precision",
        scene=precision.scene,
        quick=precision.extent.quick,
        headline=answer,
        growth=growth_sentence(chaos),
        purposes=[
            (rule, words, [one for one in found if one.purpose == rule])
            for rule, words in RULES.items()
        ],
        tasks=[(own.key, own.title, named(own.key), task_table(own)) for own in precision.diagrams],
        together=named("orders", "energy"),
        chaos_figures=named("growth", "statistics"),
        growth_table=growth_table(chaos),
        sampling_table=sampling_table(chaos),
        statistics_table=statistics_table(chaos),
        wear_figures=named("wear", "contact"),
        wear_table=wear_table(precision.wear),
        failures=failures_table(precision),
        references=references_table(precision.diagrams),
        origin=origin_table(precision),
    )
    path = folder / "report.html"
    write_bytes(path, text.encode())
    return answer, path
