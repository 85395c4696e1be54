"""Figures of a sweep, with titles and captions in ``captions.toml``."""

import math

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import NullFormatter

from presswear.show.figures import style
from presswear.show.figures.style import LINES, Drawing, Pen, finished
from presswear.sweeps.analysis import Analysis
from presswear.sweeps.parameters import Column, Display
from presswear.sweeps.response_distribution import PROBABILITIES, Spread
from presswear.sweeps.response_limits import ResponseLimit
from presswear.sweeps.response_points import Points
from presswear.sweeps.sensitivity import Sensitivity
from presswear.sweeps.surrogate import Surrogate, is_logarithmic
from presswear.tools.arrays import Array

COLOURS = "cividis"  # distinguishable with colour blindness and in grey print
MAX_TICKS = 6  # values of a parameter that are all written on its axis
CELLS = 60  # cells of a map along each axis
BAR = 0.36  # height of a bar, part of the row of a parameter
NAME_WIDTH = 2.2  # width of the names of parameters, inches


def drawings(analysis: Analysis) -> list[Drawing]:
    """Return the figures of a response."""
    points = analysis.points
    result = analysis.sensitivity
    spread = analysis.spread
    if points.is_constant:
        return []
    drawn = [] if result is None else bars(points, result)
    if spread is not None and np.isfinite(spread.values).sum() > 1:
        drawn += distribution(points, spread, analysis.limit)
    drawn += curves(points)
    order = range(len(points.parameters)) if result is None else result.order
    numbers = [k for k in order if not points.parameters[k].choices]
    varied = [k for k in numbers if np.ptp(points.points[:, k]) > 0.0]
    if len(varied) > 1:
        drawn += heat_map(points, (varied[0], varied[1]), analysis.surrogate)
    return drawn


def _axis(
    axes: style.Axes, side: str, column: Column, values: Array, width: float
) -> Display:
    """Set label, ticks and scale of the x or y axis of a parameter."""
    shown = Display(column, values)
    axis = axes.xaxis if side == "x" else axes.yaxis
    axis.set_label_text(style.wrapped(shown.label.replace("_", " "), width))
    if column.choices:
        axis.set_ticks(range(len(column.choices)), column.choices)
        return shown
    if is_logarithmic(values):
        axes.set(**{f"{side}scale": "log"})
        axis.set_minor_formatter(NullFormatter())
    levels = np.unique(values)
    if len(levels) <= MAX_TICKS:
        axis.set_ticks(shown.factor * levels, [shown.number(value) for value in levels])
    return shown


def bars(points: Points, result: Sensitivity) -> list[Drawing]:
    """Draw the sensitivity to each parameter as bars, the most important at the top."""
    order = result.order
    rows = np.arange(len(result.order))
    shown = Display(points.response, result.values)
    factor = 1.0 if result.is_share else shown.factor
    sheet, ((axes,),) = style.panels(1, 1, 1.1 + 0.42 * len(rows))
    pens = []
    for k, name in enumerate(result.names):
        pen = Pen(name, LINES[k][0], width=7.0)
        pens.append(pen)
        y = rows + (k - 0.5 * (len(result.names) - 1)) * BAR
        lengths = factor * np.nan_to_num(result.values[k, order])
        halves = factor * np.nan_to_num(result.half_widths[k, order])
        axes.barh(y, lengths, 0.9 * BAR, color=pen.colour)
        axes.errorbar(
            lengths, y, xerr=halves, fmt="none", ecolor=style.REFERENCE, elinewidth=0.9
        )
    names = [points.parameters[k].key.replace("_", " ") for k in order]
    axes.set_yticks(rows, [style.wrapped(name, NAME_WIDTH) for name in names])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.axvline(0.0, color=style.REFERENCE, linewidth=0.8)
    axes.set_xlabel(shown.label)
    if result.is_share:
        axes.set(
            xlim=(0.0, 1.0), xlabel=f"share of the variance of {points.response.key}"
        )
    if not math.isnan(result.noise):
        axes.axvline(factor * result.noise, color=style.MUTED, linestyle="dotted")
    return finished("sensitivity", sheet, pens, key=points.response.key, result=result)


def curves(points: Points) -> list[Drawing]:
    """Draw a response over the parameter with most values, a line for each value of another.

    Empty if the points are not a grid of one or two parameters with at most five lines.
    """
    levels = [np.unique(column) for column in points.points.T]
    varied = [k for k, values in enumerate(levels) if len(values) > 1]
    varied.sort(key=lambda k: (bool(points.parameters[k].choices), -len(levels[k])))
    size = math.prod(len(levels[k]) for k in varied)
    if len(varied) not in (1, 2) or size != len(points.means):
        return []
    along, *rest = varied
    groups = levels[rest[0]] if rest else np.zeros(1)
    if points.parameters[along].choices or len(groups) > len(LINES):
        return []
    sheet, ((axes,),) = style.panels(1, 1, 3.6)
    x_axis = _axis(
        axes, "x", points.parameters[along], points.points[:, along], style.WIDTH
    )
    y_axis = Display(points.response, points.means)
    pens = []
    half_widths = points.half_widths
    for value, line in zip(groups, LINES, strict=False):
        label = points.response.key
        rows = points.has_value
        if rest:
            group = Display(points.parameters[rest[0]], levels[rest[0]])
            label = f"{group.column.key} = {group.text(value)}"
            rows = rows & (points.points[:, rest[0]] == value)
        order = np.flatnonzero(rows)[np.argsort(points.points[rows, along])]
        x = x_axis.factor * points.points[order, along]
        y = y_axis.factor * points.means[order]
        half = y_axis.factor * half_widths[order]
        pens.append(Pen(label, *line))
        axes.fill_between(
            x, y - half, y + half, color=line[0], alpha=0.2, linewidth=0.0
        )
        pens[-1].draw(axes, x, y, marker="o", markersize=3.5)
    axes.set_ylabel(style.wrapped(f"{y_axis.label}, {points.response.text}", 3.2))
    key = points.response.key
    name = points.parameters[along].key
    return finished(
        "lines", sheet, pens if rest else (), key=key, points=points, along=name
    )


def _even_values(values: Array) -> Array:
    """Return CELLS values over the range of some values, evenly spaced on their axis."""
    space = np.geomspace if is_logarithmic(values) else np.linspace
    return space(values.min(), values.max(), CELLS)


def _predicted(
    surrogate: Surrogate, points: Points, pair: tuple[int, int], x: Array, y: Array
) -> Array:
    """Return the surrogate over two parameters at the median of the others, (CELLS, CELLS)."""
    grid = np.tile(np.median(points.points, axis=0), (CELLS * CELLS, 1))
    for k, values in zip(pair, np.meshgrid(x, y), strict=True):
        grid[:, k] = values.ravel()
    return surrogate.predict(grid).reshape(CELLS, CELLS)


def heat_map(
    points: Points, pair: tuple[int, int], surrogate: Surrogate | None
) -> list[Drawing]:
    """Draw the points over two parameters, with the surrogate at the median of the others."""
    sheet, ((axes,),) = style.panels(1, 1, 4.2, is_measured=True)
    across, up = (points.points[:, k] for k in pair)
    x_axis = _axis(axes, "x", points.parameters[pair[0]], across, style.WIDTH)
    y_axis = _axis(axes, "y", points.parameters[pair[1]], up, 4.0)
    shown = Display(points.response, points.means)
    means = shown.factor * points.means
    norm = Normalize(float(np.nanmin(means)), float(np.nanmax(means)))
    if surrogate is not None:
        x = _even_values(across)
        y = _even_values(up)
        axes.pcolormesh(
            x_axis.factor * x,
            y_axis.factor * y,
            shown.factor * _predicted(surrogate, points, pair, x, y),
            norm=norm,
            cmap=COLOURS,
            shading="gouraud",
            rasterized=True,
        )
    x = x_axis.factor * across
    y = y_axis.factor * up
    for marker, is_bound in (("o", False), ("^", True)):
        rows = points.has_value & (points.censored == is_bound)
        axes.scatter(
            x[rows],
            y[rows],
            c=means[rows],
            marker=marker,
            norm=norm,
            cmap=COLOURS,
            edgecolors="white",
        )
    missing = ~points.has_value
    axes.scatter(x[missing], y[missing], color=style.REFERENCE, marker="x")
    axes.grid(visible=False)
    sheet.colorbar(ScalarMappable(norm, COLOURS), ax=axes, label=shown.label)
    names = [points.parameters[k].key for k in pair]
    return finished(
        "map", sheet, key=points.response.key, names=names, surrogate=surrogate
    )


def distribution(
    points: Points, spread: Spread, limit: ResponseLimit | None
) -> list[Drawing]:
    """Draw the cumulative distribution of a response with its 95 % band and its limit."""
    sheet, ((axes,),) = style.panels(1, 1, 3.6)
    shown = Display(points.response, spread.values)
    percent = 100.0 * PROBABILITIES
    pens = [Pen("cumulative probability, 95 % band", *LINES[0])]
    pens[0].draw(axes, shown.factor * spread.values, percent)
    left, right = axes.get_xlim()
    low = np.where(np.isnan(spread.low), left, shown.factor * spread.low)
    high = np.where(np.isnan(spread.high), right, shown.factor * spread.high)
    axes.fill_betweenx(
        percent, low, high, color=pens[0].colour, alpha=0.25, linewidth=0.0
    )
    if limit is not None:
        name = f"limit {shown.text(limit.value)}"
        pen = Pen(name, style.REFERENCE, LINES[3][1])
        axes.axvline(shown.factor * limit.value, **pen.line_style)
        pens.append(pen)
    axes.set(
        ylim=(0.0, 100.0),
        xlabel=shown.label,
        ylabel="probability of a smaller value (%)",
    )
    return finished(
        "distribution", sheet, pens, key=points.response.key, source=spread.source
    )
