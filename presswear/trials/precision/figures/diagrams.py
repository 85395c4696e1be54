"""Work-precision diagrams: error over wall time, a panel for each quantity."""

import math
from collections.abc import Sequence
from typing import Any

from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from matplotlib.transforms import ScaledTranslation

from presswear.show.figures.style import WIDTH, Axes, Drawing, Sheet
from presswear.trials.precision.figures.families import (
    FAILED,
    RING,
    STAR,
    family_handles,
    legend_above,
    look_of,
    mark_handles,
)
from presswear.trials.precision.points import Diagram, Method, Point

_MILLISECONDS = 1e3
_LEAST = 1e-17
"""Errors are not drawn below; that of an exact result is 0."""


def work_precision(diagram: Diagram) -> Drawing:
    """Error over wall time of every method of a task."""
    names = list(diagram.quantities)
    rows = math.ceil(len(names) / 2)
    sheet = Sheet(figsize=(WIDTH, 1.0 + 2.5 * rows), layout="constrained")
    panels = sheet.subplots(rows, 2, squeeze=False).ravel()
    for axes, name in zip(panels, names, strict=False):
        _panel(axes, diagram, name)
    for axes in panels[len(names) :]:
        axes.set_axis_off()
    methods = [point.method for point in diagram.points]
    failed = [point for point in diagram.points if point.failure]
    handles = family_handles(diagram.families()) + mark_handles(methods, bool(failed))
    legend_above(sheet, handles, 2)
    return Drawing(
        f"precision-{diagram.key}.png",
        f"Error against wall time: {diagram.title}",
        f"{diagram.task} Errors from {diagram.reference}. Medians of wall times without warm-up, "
        "bars from the least to the greatest; down and left is better. Grey: how well the "
        f"reference is known itself.{_failed_words(failed)}",
        sheet,
    )


def _failed_words(failed: Sequence[Point]) -> str:
    """What the marks above the panels are."""
    if not failed:
        return ""
    names = "; ".join(point.method.label for point in failed)
    return f" Failed, shown above the panels: {names}."


def _panel(axes: Axes, diagram: Diagram, name: str) -> None:
    unit = diagram.quantities[name]
    known = diagram.reference_errors.get(name, 0.0)
    log_scales(axes)
    if known > 0.0:
        axes.axhline(known, color="0.6", linewidth=1.6, zorder=0.5)
    for family, points in diagram.families().items():
        ran = [point for point in points if point.effort is not None and not point.failure]
        look = look_of(family)
        curve = [point for point in ran if not point.method.is_paper]
        walls = [_wall(point) for point in curve]
        errors = [_error(point, name) for point in curve]
        spread = [[_wall(p) - _MILLISECONDS * p.effort.spread[0] for p in curve if p.effort]]
        spread.append([_MILLISECONDS * p.effort.spread[1] - _wall(p) for p in curve if p.effort])
        axes.errorbar(walls, errors, xerr=spread, elinewidth=0.9, **look.line())
        for point in ran:
            mark_point(axes, point.method, _wall(point), _error(point, name))
    failed_strip(axes, [point for point in diagram.points if point.failure])
    log_labels(axes.xaxis)
    axes.set_xlabel("wall time (ms)")
    axes.set_ylabel(f"{name}{f' ({unit})' if unit else ''}")
    pad_y(axes)


def _wall(point: Point) -> float:
    return math.nan if point.effort is None else _MILLISECONDS * point.effort.wall


def _error(point: Point, name: str) -> float:
    return max(point.errors.get(name, math.nan), _LEAST)


def log_scales(axes: Axes) -> None:
    """Both axes logarithmic, with as many labels as fit."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_minor_formatter(NullFormatter())


def pad_y(axes: Axes) -> None:
    """Room above and below the curves."""
    low, high = axes.get_ylim()
    axes.set_ylim(low / 2.0, high * 2.0)


def mark_point(axes: Axes, method: Method, x: float, y: float) -> None:
    """A ring around what scenes take by themselves, a star at the paper's own setting."""
    if method.is_default:
        axes.plot(x, y, gid="default", **RING)
    if method.is_paper:
        axes.plot(x, y, zorder=4.0, gid="paper", **STAR)


_STRIP, _FIRST, _NEXT = 1.0, 34.0, 9.0
"""Of the strip over a panel: its height, part of the panel; places of marks, points."""


def failed_strip(axes: Axes, failed: Sequence[Point]) -> None:
    """Marks of what failed in a strip over a panel: they have neither error nor time."""
    # The paper's own first, then family by family.
    methods = sorted((point.method for point in failed), key=lambda method: not method.is_paper)
    strip(axes, methods)


def strip(axes: Axes, methods: Sequence[Method]) -> None:
    """Marks of methods that failed over a panel."""
    if not methods:
        return
    corner = ScaledTranslation(0.0, 7.0 / 72.0, axes.figure.dpi_scale_trans)
    over: dict[str, Any] = {"clip_on": False}
    axes.text(0.0, _STRIP, "failed:", va="center", transform=axes.transAxes + corner, **over)
    for place, method in enumerate(methods):
        right = ScaledTranslation((_FIRST + _NEXT * place) / 72.0, 0.0, axes.figure.dpi_scale_trans)
        over["transform"] = axes.transAxes + corner + right
        if method.is_paper:
            axes.plot(0.0, _STRIP, zorder=4.0, gid="paper", **STAR, **over)
        else:
            colour = look_of(method.family).colour
            axes.plot(0.0, _STRIP, color=colour, gid="failed", **FAILED, **over)


def log_labels(axis: Axis) -> None:
    """Labels at 1, 2 and 5 on a logarithmic axis that spans too little for powers of ten."""
    low, high = sorted(axis.get_view_interval())
    axis.set_minor_formatter(NullFormatter())
    if high / low < 30.0:
        subs = (1.0, 2.0, 5.0) if high / low > 4.0 else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
        axis.set_major_locator(LogLocator(subs=subs))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
