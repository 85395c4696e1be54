"""Figures of a sweep."""

import math
from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import NullFormatter

from presswear.show.figures.style import (
    LINES,
    MUTED,
    REFERENCE,
    WIDTH,
    Axes,
    Drawing,
    Pen,
    Sheet,
    legend,
    wrapped,
)
from presswear.sweeps.parameters import Column
from presswear.sweeps.responses import Limit
from presswear.sweeps.sensitivity import PROBABILITIES, Points, Sensitivity, Spread
from presswear.sweeps.surrogate import Surrogate, is_logarithmic
from presswear.tools.arrays import Array
from presswear.tools.numbers import readable, unit_scale

COLOURS = "cividis"  # distinguishable with colour blindness and in grey print
CELLS = 60  # cells of a map along each axis
BAR = 0.36  # height of a bar, part of the row of a parameter
NAME_WIDTH = 2.2  # width of the names of parameters, inches


@dataclass(frozen=True)
class Display:
    """Display unit of a column, and the factor to it from the SI unit."""

    column: Column
    factor: float
    unit: str

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.column.key} ({self.unit})" if self.unit else self.column.key

    def number(self, value: float, digits: int = 3) -> str:
        """Return a value in SI units as text in the display unit, without the unit."""
        if self.column.choices and not math.isnan(value):
            return self.column.choices[int(value)]
        return readable(self.factor * value, digits)

    def text(self, value: float) -> str:
        """Return a value in SI units as text with the display unit."""
        return f"{self.number(value)} {self.unit}".rstrip()


def display(column: Column, values: Array) -> Display:
    """Return the display unit in which values read well."""
    largest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    factor, unit = unit_scale(column.unit, largest) if largest > 0.0 else (1.0, column.unit)
    return Display(column, factor, unit)


def _sheet(height: float) -> tuple[Sheet, Axes]:
    sheet = Sheet(figsize=(WIDTH, height), layout="constrained")
    return sheet, sheet.subplots()


def _drawing(kind: str, points: Points, title: str, caption: str, sheet: Sheet) -> Drawing:
    key = points.response.key
    name = "".join(c if c.isalnum() or c in "-_" else "-" for c in key)
    return Drawing(f"{kind}-{name}.png", title.format(key), caption, sheet)


def _axis(axes: Axes, side: str, column: Column, values: Array, width: float) -> Display:
    """Set label, ticks and scale of the x or y axis of a parameter."""
    shown, axis = display(column, values), axes.xaxis if side == "x" else axes.yaxis
    axis.set_label_text(wrapped(shown.label.replace("_", " "), width))
    if column.choices:
        axis.set_ticks(range(len(column.choices)), column.choices)
    elif is_logarithmic(values):
        (axes.set_xscale if side == "x" else axes.set_yscale)("log")
        axis.set_minor_formatter(NullFormatter())
    return shown


def bars(points: Points, result: Sensitivity) -> Drawing:
    """Draw the sensitivity to each parameter as bars, the most important at the top."""
    order, rows = result.order, np.arange(len(result.order))
    shown = display(points.response, result.values)
    factor = 1.0 if result.is_share else shown.factor
    sheet, axes = _sheet(1.1 + 0.42 * len(rows))
    pens = [Pen(name, line[0], width=7.0) for name, line in zip(result.names, LINES, strict=False)]
    for k, pen in enumerate(pens):
        y = rows + (k - 0.5 * (len(pens) - 1)) * BAR
        lengths = factor * np.nan_to_num(result.values[k, order])
        halves = factor * np.nan_to_num(result.half_widths[k, order])
        axes.barh(y, lengths, 0.9 * BAR, color=pen.colour)
        axes.errorbar(lengths, y, xerr=halves, fmt="none", ecolor=REFERENCE, elinewidth=0.9)
    names = [points.parameters[k].key.replace("_", " ") for k in order]
    axes.set_yticks(rows, [wrapped(name, NAME_WIDTH) for name in names])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.axvline(0.0, color=REFERENCE, linewidth=0.8)
    label = f"share of the variance of {points.response.key}" if result.is_share else shown.label
    axes.set_xlabel(label)
    if result.is_share:
        axes.set_xlim(0.0, 1.0)
    caption = f"{result.title} ({result.method}). Thin lines are 95 % intervals."
    if not math.isnan(result.noise):
        axes.axvline(factor * result.noise, color=MUTED, linestyle="dotted")
        caption += " The dotted line is the mean effect that chaos alone would give."
    legend(sheet, pens, "outside upper center")
    return _drawing("sensitivity", points, "Sensitivity of {}", caption, sheet)


def curves(points: Points) -> Drawing | None:
    """Draw a response over the parameter with most values, a line for each value of another.

    None if the points are not a grid of one or two parameters with at most five lines.
    """
    levels = [np.unique(column) for column in points.points.T]
    varied = [k for k, values in enumerate(levels) if len(values) > 1]
    varied.sort(key=lambda k: (bool(points.parameters[k].choices), -len(levels[k])))
    size = math.prod(len(levels[k]) for k in varied)
    if len(varied) not in (1, 2) or size != len(points.means):
        return None
    along, *rest = varied
    groups = levels[rest[0]] if rest else np.zeros(1)
    if points.parameters[along].choices or len(groups) > len(LINES):
        return None
    sheet, axes = _sheet(3.6)
    x_axis = _axis(axes, "x", points.parameters[along], points.points[:, along], WIDTH)
    y_axis, pens = display(points.response, points.means), []
    half_widths = points.half_widths(points.noise)
    for value, line in zip(groups, LINES, strict=False):
        label, rows = points.response.key, points.has_value
        if rest:
            group = display(points.parameters[rest[0]], levels[rest[0]])
            label = f"{group.column.key} = {group.text(value)}"
            rows = rows & (points.points[:, rest[0]] == value)
        order = np.flatnonzero(rows)[np.argsort(points.points[rows, along])]
        x, y = x_axis.factor * points.points[order, along], y_axis.factor * points.means[order]
        half = y_axis.factor * half_widths[order]
        pens.append(Pen(label, *line))
        axes.fill_between(x, y - half, y + half, color=line[0], alpha=0.2, linewidth=0.0)
        pens[-1].draw(axes, x, y, marker="o", markersize=3.5)
    axes.set_ylabel(y_axis.label)
    if rest:
        legend(sheet, pens, "outside upper center")
    caption = f"Means over the replicates: {points.response.text}."
    if points.noise_source != "none":
        caption += " Bands are 95 % intervals."
    title = f"{{}} over {points.parameters[along].key}"
    return _drawing("lines", points, title, caption, sheet)


def heat_map(points: Points, pair: tuple[int, int], surrogate: Surrogate | None) -> Drawing:
    """Draw the points over two parameters, with the surrogate at the median of the others."""
    sheet, axes = _sheet(4.2)
    across, up = (points.points[:, k] for k in pair)
    x_axis = _axis(axes, "x", points.parameters[pair[0]], across, WIDTH)
    y_axis = _axis(axes, "y", points.parameters[pair[1]], up, 4.0)
    shown = display(points.response, points.means)
    least, most = (shown.factor * float(end(points.means)) for end in (np.nanmin, np.nanmax))
    norm = Normalize(least, most)
    caption = "Triangles are lower bounds, crosses failed runs."
    if surrogate is not None:
        x, y = (
            (np.geomspace if is_logarithmic(values) else np.linspace)(
                values.min(), values.max(), CELLS
            )
            for values in (across, up)
        )
        grid = np.tile(np.median(points.points, axis=0), (CELLS * CELLS, 1))
        for k, values in zip(pair, np.meshgrid(x, y), strict=True):
            grid[:, k] = values.ravel()
        level = shown.factor * surrogate.predict(grid)[0].reshape(CELLS, CELLS)
        x, y = x_axis.factor * x, y_axis.factor * y
        axes.pcolormesh(x, y, level, norm=norm, cmap=COLOURS, shading="gouraud")
        caption += " The background is the surrogate at the medians of all other parameters."
    x, y = x_axis.factor * across, y_axis.factor * up
    colours = colormaps[COLOURS](norm(shown.factor * points.means))
    for marker, rows in (
        ("o", points.has_value & ~points.censored),
        ("^", points.has_value & points.censored),
    ):
        axes.scatter(x[rows], y[rows], c=colours[rows], marker=marker, edgecolors="white")
    axes.scatter(x[~points.has_value], y[~points.has_value], color=REFERENCE, marker="x")
    axes.grid(visible=False)
    sheet.colorbar(ScalarMappable(norm, COLOURS), ax=axes, label=shown.label)
    title = f"{{}} over {' and '.join(points.parameters[k].key for k in pair)}"
    return _drawing("map", points, title, caption, sheet)


def distribution(points: Points, spread: Spread, limit: Limit | None) -> Drawing:
    """Draw the cumulative distribution of a response with its 95 % band and its limit."""
    sheet, axes = _sheet(3.6)
    shown, percent = display(points.response, spread.values), 100.0 * PROBABILITIES
    pens = [Pen("cumulative probability, 95 % band", *LINES[0])]
    pens[0].draw(axes, shown.factor * spread.values, percent)
    ends = zip((spread.low, spread.high), axes.get_xlim(), strict=True)
    low, high = (np.where(np.isnan(end), edge, shown.factor * end) for end, edge in ends)
    axes.fill_betweenx(percent, low, high, color=pens[0].colour, alpha=0.25, linewidth=0.0)
    if limit is not None:
        pens.append(Pen(f"limit {shown.text(limit.value)}", REFERENCE, LINES[3][1]))
        axes.axvline(shown.factor * limit.value, **pens[-1].look)
    axes.set_ylim(0.0, 100.0)
    axes.set_xlabel(shown.label)
    axes.set_ylabel("probability of a smaller value (%)")
    legend(sheet, pens, "outside upper center")
    caption = f"Over the distributions of the parameters, {spread.source}."
    return _drawing("distribution", points, "Distribution of {}", caption, sheet)
