"""Beyond the horizon: growth of a disturbance, and statistics against their cost."""

import math
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from presswear.show.figures.style import LINES, MUTED, REFERENCE, WIDTH, Axes, Drawing, Pen, Sheet
from presswear.tools.numbers import given
from presswear.validation.precision.chaos import Chaos
from presswear.validation.precision.figures.panels import (
    PAPER,
    RING,
    STAR,
    failed_strip,
    legend_above,
    log_labels,
    look_of,
    panels,
    plain_labels,
)
from presswear.validation.precision.growth import APART, HIGH, LOW, PARTED, TOLERANCE
from presswear.validation.precision.statistic import sampling_error

_SMALLEST = 1e-12  # m
_PERCENT = 100.0
_LEAST = 0.1
"""Per cent; what is smaller is drawn there."""
_BAND = "#F0E442"
_DASHED = (0.0, (4.0, 2.0))
_DOTTED = (0.0, (2.0, 2.0))


def growth_of_disturbance(chaos: Chaos) -> Drawing:
    """Draw the distance of the pair over time, with the bounds of the fit and the touchdowns."""
    sheet = Sheet(figsize=(WIDTH, 3.6), layout="constrained")
    axes = sheet.subplots()
    axes.set_yscale("log")
    top = axes.get_xaxis_transform()
    growth = chaos.growth
    time, apart = np.array(growth.time), np.array(growth.distance)
    shown = np.maximum(apart, _SMALLEST)
    Pen("pair of starts", *LINES[0], 1.3).draw(axes, time, shown, label="pair of starts")
    inside = growth.inside
    if growth.rate is not None:
        middle = float(np.log(apart[inside]).mean())
        line = np.exp(middle + growth.rate * (time[inside] - time[inside].mean()))
        Pen("fit to it", *LINES[1], 1.6).draw(axes, time[inside], line, label="fit to it")
    touched = np.diff(growth.touchdowns, prepend=0) > 0
    marks: dict[str, Any] = {
        "linestyle": "none",
        "marker": "|",
        "markersize": 6.0,
        "color": REFERENCE,
    }
    where = np.full(np.count_nonzero(touched), 0.02)
    axes.plot(time[touched], where, transform=top, label="touches of the first", **marks)
    for bound, word, colour, style, text in (
        (LOW, "fitted from", MUTED, _DOTTED, "0.3"),
        (HIGH, "fitted to", MUTED, _DOTTED, "0.3"),
        (PARTED, "parted", REFERENCE, "solid", "black"),
    ):
        axes.axhline(bound, color=colour, linewidth=0.8, linestyle=style)
        at: dict[str, Any] = {"ha": "right", "va": "bottom", "color": text}
        axes.annotate(word, (0.998, bound), xycoords=("axes fraction", "data"), **at)
    paper = next((p for p in chaos.points if p.method.is_paper and p.failure), None)
    if paper is not None:
        label = f"{PAPER}: failed by then"
        axes.plot(paper.simulated, 0.94, transform=top, gid="paper", label=label, **STAR)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("distance of two runs (m)")
    axes.margins(x=0.01)
    sheet.legend(loc="outside upper left", ncols=2)
    return Drawing(
        "precision-growth.png",
        "Growth of a disturbance",
        "Greatest difference of the pins' places in their bearings between two runs of one method "
        f"(DOP853 of dae at {given(TOLERANCE)}) whose starts are {given(APART)} m apart, "
        "with pins in the middle of their bearings as in every scene.",
        sheet,
    )


def statistics_against_cost(chaos: Chaos) -> Drawing:
    """Draw the step error of each statistic over wall time, and what sampling error hides."""
    sheet, found = panels(len(chaos.names), 1.1, 2.3, sharex=True)
    # Statistic by statistic, joint beside joint.
    for axes, name in zip(found, chaos.names, strict=True):
        _panel(axes, chaos, name)
    for axes in found[-2:]:
        axes.set_xlabel("wall time for a simulated second (s)")
    marks = [
        Line2D([], [], color=_BAND, linewidth=5.0, label="below the sampling error of a stage"),
        Line2D([], [], color="0.3", linewidth=0.8, label="bound of the step error, 95 %"),
    ]
    if chaos.cheapest() is not None:
        marks.append(Line2D([], [], color=REFERENCE, linestyle=_DASHED, label="cheapest honest"))
    methods = [point.method for point in chaos.points]
    legend_above(sheet, chaos.families, methods, False, marks)
    failed = "; ".join(p.method.label for p in chaos.points if p.failure)
    reference = chaos.reference
    any_cycles = next(iter(reference.statistics.values())).cycles
    return Drawing(
        "precision-statistics.png",
        "Statistics against cost, and where step error drops below sampling error",
        f"Size of the difference of each statistic from that of the finest method "
        f"({reference.method.label}, {any_cycles} cycles), in per cent, with the bound that it "
        "does not exceed at 95 %. What is estimated below "
        f"{_LEAST:g} % is drawn there. A setting is honest where the bound is in the coloured "
        f"band: below the sampling error (95 %) of a stage of {chaos.stage_cycles} cycles, which "
        "is what the scene runs by itself. Bounds fall with more cycles: an open mark is a "
        "setting that has not been shown to be honest, for want of cycles or of accuracy. "
        f"Dashed: the cheapest setting that is honest in wear totals and wear maps."
        f"{f' Failed: {failed}.' if failed else ''}",
        sheet,
    )


def _panel(axes: Axes, chaos: Chaos, name: str) -> None:
    reference = chaos.reference.statistics[name]
    axes.set_xscale("log")
    axes.set_yscale("log")
    sampling = _PERCENT * sampling_error(reference, chaos.stage_cycles) / abs(reference.mean)
    if math.isfinite(sampling):
        axes.axhspan(_LEAST / 3.0, sampling, color=_BAND, alpha=0.35, linewidth=0.0, zorder=0.4)
        axes.axhline(sampling, color="0.4", linewidth=0.8, zorder=0.5)
    for family, points in chaos.families.items():
        ran = [p for p in points if not p.failure]
        look = look_of(family)
        costs = [point.cost for point in ran]
        sizes = [_percent(point.step_errors[name].value, reference.mean) for point in ran]
        axes.plot(costs, sizes, **look.line(marker="none", linewidth=0.8, alpha=0.7))
        for point, cost, size in zip(ran, costs, sizes, strict=True):
            bound = _percent(point.step_errors[name].bound, reference.mean)
            axes.plot((cost, cost), (size, bound), color=look.colour, linewidth=0.8)
            axes.plot(cost, bound, color=look.colour, marker="_", markersize=5.0)
            is_honest = chaos.is_honest_in(point, name)
            fill = look.colour if is_honest else "white"
            mark = look.line(linestyle="none", markerfacecolor=fill)
            axes.plot(cost, size, gid="honest" if is_honest else "open", **mark)
            if point.method.is_default:
                axes.plot(cost, size, gid="default", **RING)
    failed_strip(axes, [point.method for point in chaos.points if point.failure])
    best = chaos.cheapest()
    if best is not None:
        axes.axvline(best.cost, color=REFERENCE, linewidth=0.9, linestyle=_DASHED)
    axes.set_ylabel(f"{name} (%)")
    axes.set_ylim(_LEAST / 1.5, None)
    plain_labels(axes.yaxis)
    log_labels(axes.xaxis)


def _percent(value: float | None, mean: float) -> float:
    return math.nan if value is None else max(_PERCENT * abs(value / mean), _LEAST)
