"""Error over the number of steps with observed orders, and energy over step or tolerance."""

import math
from collections.abc import Sequence

from presswear.show.figures.style import WIDTH, Axes, Drawing, Sheet
from presswear.trials.precision.figures.diagrams import (
    failed_strip,
    log_labels,
    log_scales,
    mark_point,
    pad_y,
)
from presswear.trials.precision.figures.families import (
    family_handles,
    legend_above,
    look_of,
    mark_handles,
)
from presswear.trials.precision.points import Diagram, Point

_LEAST = 1e-17
SMOOTH = ("ideal", "andrews")
"""Keys of the tasks without contacts."""
ENERGY = "energy"
"""In the names of quantities that are energy residuals."""


def orders(diagrams: Sequence[Diagram]) -> Drawing:
    """Error of the first quantity of each task over the steps taken."""
    rows = math.ceil(len(diagrams) / 2)
    sheet = Sheet(figsize=(WIDTH, 1.0 + 2.6 * rows), layout="constrained")
    panels = sheet.subplots(rows, 2, squeeze=False).ravel()
    for axes, diagram in zip(panels, diagrams, strict=False):
        _orders_panel(axes, diagram, next(iter(diagram.quantities)))
    for axes in panels[len(diagrams) :]:
        axes.set_axis_off()
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


def shown_order(diagram: Diagram, family: str, name: str) -> float:
    """Observed order, nan where it means nothing.

    Around contacts a method that controls its error has none: its steps are as many as there
    are contacts, whatever its tolerance.
    """
    controlled = any(p.method.knob == "tolerance" for p in diagram.families().get(family, []))
    if controlled and diagram.key not in SMOOTH:
        return math.nan
    return diagram.order(family, name)


def _legend(sheet: Sheet, diagrams: Sequence[Diagram]) -> None:
    families = dict.fromkeys(family for diagram in diagrams for family in diagram.families())
    points = [point for diagram in diagrams for point in diagram.points]
    failed = any(point.failure for point in points)
    marks = mark_handles((point.method for point in points), failed)
    legend_above(sheet, family_handles(families) + marks, 2)


def _steps(point: Point) -> float:
    return math.nan if point.effort is None else float(point.effort.steps + point.effort.sent_back)


def _ran(points: Sequence[Point]) -> list[Point]:
    return [point for point in points if point.effort is not None and not point.failure]


def _orders_panel(axes: Axes, diagram: Diagram, name: str) -> None:
    log_scales(axes)
    known = diagram.reference_errors.get(name, 0.0)
    if known > 0.0:
        axes.axhline(known, color="0.6", linewidth=1.6, zorder=0.5)
    for family, points in diagram.families().items():
        ran = _ran(points)
        curve = [point for point in ran if not point.method.is_paper]
        steps = [_steps(point) for point in curve]
        errors = [max(point.errors.get(name, math.nan), _LEAST) for point in curve]
        look = look_of(family)
        axes.plot(steps, errors, **look.line())
        order = shown_order(diagram, family, name)
        if curve and math.isfinite(order):
            axes.annotate(
                f"{order:.1f}",
                (steps[-1], errors[-1]),
                xytext=(5.0, -2.0),
                textcoords="offset points",
                color=look.colour,
                va="top",
            )
        for point in ran:
            mark_point(axes, point.method, _steps(point), max(point.errors[name], _LEAST))
    failed_strip(axes, [point for point in diagram.points if point.failure])
    log_labels(axes.xaxis)
    axes.set_xlabel("steps")
    unit = diagram.quantities[name]
    axes.set_ylabel(f"{diagram.key}: {name}{f' ({unit})' if unit else ''}")
    axes.margins(x=0.12)
    pad_y(axes)


_KNOBS = ("tolerance", "step (s)", "steps in an impact")


def energy(diagrams: Sequence[Diagram]) -> Drawing | None:
    """Energy that is missing over tolerance and step; None where no task tells it."""
    told = [(d, name) for d in diagrams for name in d.quantities if ENERGY in name]
    if not told:
        return None
    knobs = [k for k in _KNOBS if any(p.method.knob == k for d, _ in told for p in d.points)]
    sheet = Sheet(figsize=(WIDTH, 1.0 + 2.4 * len(told)), layout="constrained")
    panels = sheet.subplots(len(told), len(knobs), sharey="row", squeeze=False)
    for row, (diagram, name) in zip(panels, told, strict=True):
        for axes, knob in zip(row, knobs, strict=True):
            _energy_panel(axes, diagram, name, knob)
        unit = diagram.quantities[name]
        row[0].set_ylabel(f"{diagram.key}: {name}{f' ({unit})' if unit else ''}")
        pad_y(row[0])
    _legend(sheet, [diagram for diagram, _ in told])
    return Drawing(
        "precision-energy.png",
        "Energy residual against tolerance and step",
        "Energy that does not add up over tolerance, equal step, and steps in an impact. Finer is "
        "to the right in every panel.",
        sheet,
    )


def _energy_panel(axes: Axes, diagram: Diagram, name: str, knob: str) -> None:
    log_scales(axes)
    for family, points in diagram.families().items():
        own = [point for point in _ran(points) if point.method.knob == knob]
        curve = [point for point in own if not point.method.is_paper]
        errors = [max(point.errors.get(name, math.nan), _LEAST) for point in curve]
        if curve:
            values = [point.method.value for point in curve]
            axes.plot(values, errors, **look_of(family).line())
        for point in own:
            mark_point(axes, point.method, point.method.value, max(point.errors[name], _LEAST))
    failed_strip(axes, [p for p in diagram.points if p.failure and p.method.knob == knob])
    log_labels(axes.xaxis)
    if knob != "steps in an impact":
        axes.invert_xaxis()
    axes.set_xlabel(knob)
