"""Work-precision diagrams: error over wall time, over steps, and over step or tolerance."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.ticker import LogLocator, NullFormatter

from presswear.show.figures.style import WIDTH, Axes, Drawing, Sheet
from presswear.validation.precision.diagram import Diagram, Quantity, TaskPoint
from presswear.validation.precision.figures.panels import (
    RING,
    STAR,
    failed_strip,
    legend_above,
    log_labels,
    look_of,
    pad_y,
    panels,
)
from presswear.validation.precision.methods import IMPACT, STEP, TOLERANCE, grouped
from presswear.validation.timing import Timing

_MILLISECONDS = 1e3
_LEAST = 1e-17
"""Errors are not drawn below; that of an exact result is 0."""
SMOOTH = ("ideal", "andrews")
"""Keys of the tasks without contacts."""
ENERGY = "energy"
"""In the names of quantities that are energy residuals."""


def _curves(
    axes: Axes,
    diagram: Diagram,
    quantity: Quantity,
    place: Callable[[TaskPoint, Timing], float],
    knobs: Sequence[str] = (STEP, IMPACT, TOLERANCE),
    spread: bool = False,
) -> dict[str, tuple[float, float]]:
    """Draw the error of every method; gives the last point of each family's curve.

    Parameters
    ----------
    place : callable
        Where a point stands along x.
    knobs : sequence of str
        Methods that vary another are left out.
    spread : bool
        True draws bars from the least to the greatest wall time.
    """
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_minor_formatter(NullFormatter())
    if quantity.known > 0.0:
        axes.axhline(quantity.known, color="0.6", linewidth=1.6, zorder=0.5)
    shown = [point for point in diagram.points if point.method.knob in knobs]
    ends = {}
    for family, points in grouped(shown).items():
        ran = [(p, p.timing) for p in points if p.timing is not None and not p.failure]
        places = [
            (place(p, timing), max(p.errors.get(quantity.name, math.nan), _LEAST))
            for p, timing in ran
        ]
        curve = [k for k, (point, _) in enumerate(ran) if not point.method.is_paper]
        if curve:
            x, y = zip(*(places[k] for k in curve), strict=True)
            walls = [(t.wall - t.ends[0], t.ends[1] - t.wall) for _, t in (ran[k] for k in curve)]
            bars = _MILLISECONDS * np.transpose(walls) if spread else None
            axes.errorbar(x, y, xerr=bars, elinewidth=0.9, **look_of(family).line())
            ends[family] = places[curve[-1]]
        for (point, _), at in zip(ran, places, strict=True):
            if point.method.is_default:
                axes.plot(*at, gid="default", **RING)
            if point.method.is_paper:
                axes.plot(*at, zorder=4.0, gid="paper", **STAR)
    failed_strip(axes, [point.method for point in shown if point.failure])
    log_labels(axes.xaxis)
    return ends


def _legend(sheet: Sheet, diagrams: Sequence[Diagram]) -> None:
    families = dict.fromkeys(family for diagram in diagrams for family in diagram.families)
    points = [point for diagram in diagrams for point in diagram.points]
    failed = any(point.failure for point in points)
    legend_above(sheet, families, (point.method for point in points), failed)


def work_precision(diagram: Diagram) -> Drawing:
    """Draw the error over wall time of every method of a task, a panel for each quantity."""
    sheet, found = panels(len(diagram.quantities), 1.0, 2.5)
    for axes, quantity in zip(found, diagram.quantities, strict=True):
        _curves(axes, diagram, quantity, lambda _, t: _MILLISECONDS * t.wall, spread=True)
        axes.set_xlabel("wall time (ms)")
        axes.set_ylabel(quantity.title)
        pad_y(axes)
    _legend(sheet, [diagram])
    failed = "; ".join(point.method.label for point in diagram.points if point.failure)
    return Drawing(
        f"precision-{diagram.key}.png",
        f"Error against wall time: {diagram.title}",
        f"{diagram.task} Errors from {diagram.reference}. Medians of wall times without warm-up, "
        "bars from the least to the greatest; down and left is better. Grey: how well the "
        "reference is known itself."
        + (f" Failed, shown above the panels: {failed}." if failed else ""),
        sheet,
    )


def orders(diagrams: Sequence[Diagram]) -> Drawing:
    """Draw the error of the first quantity of each task over the steps taken."""
    sheet, found = panels(len(diagrams), 1.0, 2.6)
    for axes, diagram in zip(found, diagrams, strict=True):
        quantity = diagram.quantities[0]
        ends = _curves(axes, diagram, quantity, lambda _, t: float(t.attempts))
        for family, end in ends.items():
            order = shown_order(diagram, family, quantity)
            if math.isfinite(order):
                axes.annotate(
                    f"{order:.1f}",
                    end,
                    xytext=(5.0, -2.0),
                    textcoords="offset points",
                    color=look_of(family).colour,
                    va="top",
                )
        axes.set_xlabel("steps")
        axes.set_ylabel(f"{diagram.key}: {quantity.title}")
        axes.margins(x=0.12)
        pad_y(axes)
    _legend(sheet, diagrams)
    return Drawing(
        "precision-orders.png",
        "Error against steps, with observed orders",
        "The first quantity of each task over attempted steps. The number at a curve's end is its "
        "observed order: the slope of log error over log accepted steps, of points whose error is "
        "ten times that of the reference or more; it is left out where methods that control their "
        "error meet contacts. Grey: how well the reference is known itself.",
        sheet,
    )


def shown_order(diagram: Diagram, family: str, quantity: Quantity) -> float:
    """Observed order, nan where it means nothing.

    Around contacts a method that controls its error has none: its steps are as many as there
    are contacts, whatever its tolerance.
    """
    controlled = any(p.method.knob == TOLERANCE for p in diagram.families.get(family, []))
    if controlled and diagram.key not in SMOOTH:
        return math.nan
    return diagram.order(family, quantity)


def energy(diagrams: Sequence[Diagram]) -> Drawing:
    """Draw energy that is missing over tolerance and step."""
    told = [(d, own) for d in diagrams for own in d.quantities if ENERGY in own.name]
    known = {point.method.knob for diagram, _ in told for point in diagram.points}
    knobs = [knob for knob in (TOLERANCE, STEP, IMPACT) if knob in known]
    sheet = Sheet(figsize=(WIDTH, 1.0 + 2.4 * len(told)), layout="constrained")
    grid = sheet.subplots(len(told), len(knobs), sharey="row", squeeze=False)
    for row, (diagram, quantity) in zip(grid, told, strict=True):
        for axes, knob in zip(row, knobs, strict=True):
            _curves(axes, diagram, quantity, lambda point, _: point.method.value, (knob,))
            if knob != IMPACT:
                axes.invert_xaxis()
            axes.set_xlabel(knob)
        row[0].set_ylabel(f"{diagram.key}: {quantity.title}")
        pad_y(row[0])
    _legend(sheet, [diagram for diagram, _ in told])
    return Drawing(
        "precision-energy.png",
        "Energy residual against tolerance and step",
        "Energy that does not add up over tolerance, equal step, and steps in an impact. Finer is "
        "to the right in every panel.",
        sheet,
    )
