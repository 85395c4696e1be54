"""A measure over one factor: lines of a grid with bands, and sections through a surface."""

import numpy as np

from presswear.recording.statistics import quantile
from presswear.show.figures.style import LINES, WIDTH, Drawing, Pen, Sheet, legend
from presswear.sweeps.figures.scales import Scale, file_part, scales_of
from presswear.sweeps.responses import Responses
from presswear.sweeps.surface import Surface
from presswear.tools.arrays import Array

_COLUMNS = 3
_FINE = 80
"""Places along a section."""


def curves(own: Responses) -> Drawing | None:
    """A measure over the factor with most values, a line for each value of another.

    None where the points are no grid of one or two factors, or have too many lines.
    """
    levels = [np.unique(column) for column in own.points.T]
    varied = [k for k, values in enumerate(levels) if len(values) > 1]
    varied.sort(key=lambda k: (bool(own.factors[k].words), -len(levels[k])))
    full = int(np.prod([len(levels[k]) for k in varied])) if varied else 0
    if not varied or len(varied) > 2 or full != len(own.points) or own.factors[varied[0]].words:
        return None
    along, *rest = varied
    groups = levels[rest[0]] if rest else np.zeros(1)
    if len(groups) > len(LINES):
        return None
    scales = scales_of(own.factors, own.points)
    measure = Scale.of(own.measure, own.means)
    sheet = Sheet(figsize=(WIDTH, 3.6), layout="constrained")
    axes = sheet.subplots()
    wide = own.half_widths
    pens = []
    for value, line in zip(groups, LINES, strict=False):
        pen = Pen(
            f"{own.factors[rest[0]].key} = {scales[rest[0]].told(value)}"
            if rest
            else own.measure.key,
            *line,
        )
        rows = own.has_value & ((own.points[:, rest[0]] == value) if rest else True)
        rows = np.flatnonzero(rows)[np.argsort(own.points[rows, along])]
        x, y = scales[along].factor * own.points[rows, along], own.means[rows]
        if own.noise_source != "nothing":
            ends = (measure.factor * (y - wide[rows]), measure.factor * (y + wide[rows]))
            axes.fill_between(x, *ends, color=pen.colour, alpha=0.2, linewidth=0.0)
        pen.draw(axes, x, measure.factor * y, marker="o", markersize=3.5)
        pens.append(pen)
    scales[along].along_x(axes, WIDTH)
    axes.set_ylabel(measure.label)
    if rest:
        legend(sheet, pens, "outside upper center")
    band = {
        "draws": "; the bands are 95 % intervals of the means over the draws of each point",
        "intervals": "; the bands are the 95 % intervals that the runs tell",
        "nothing": "",
    }[own.noise_source]
    text = own.measure.text
    caption = f"{text[:1].upper()}{text[1:]}{band}."
    title = f"{own.measure.key} over {own.factors[along].key}"
    return Drawing(f"lines-{file_part(own.measure)}.png", title, caption, sheet)


def sections(found: Surface) -> Drawing:
    """A response surface over each factor, all others in the middle, with its band and points."""
    own = found.own
    scales = scales_of(own.factors, own.points)
    numbers = [k for k, factor in enumerate(own.factors) if not factor.words]
    measure = Scale.of(own.measure, own.means)
    columns = 2 if len(numbers) == 4 else min(len(numbers), _COLUMNS)
    lines = -(-len(numbers) // columns)
    sheet = Sheet(figsize=(WIDTH, 0.4 + 2.2 * lines), layout="constrained")
    panels = sheet.subplots(lines, columns, sharey=True, squeeze=False).ravel()
    pen = Pen("", *LINES[0])
    for axes, k in zip(panels, numbers, strict=False):
        x = scales[k].grid(_FINE)
        points = np.tile(own.middle, (_FINE, 1))
        points[:, k] = x
        mean, deviation = found.predicted(points)
        shown = scales[k].factor * x
        axes.plot(
            scales[k].factor * own.points[:, k],
            measure.factor * own.means,
            "o",
            color="0.6",
            markersize=2.5,
        )
        axes.fill_between(
            shown,
            *_band(found, measure, mean, deviation),
            color=pen.colour,
            alpha=0.25,
            linewidth=0,
        )
        pen.draw(axes, shown, measure.factor * found.unscaled(mean))
        # Ticks and their label take a part of it.
        scales[k].along_x(axes, 0.8 * WIDTH / columns)
    for axes in panels[len(numbers) :]:
        axes.set_visible(False)
    sheet.supylabel(measure.label, fontsize=8.5)
    caption = (
        "The response surface along each factor with all others in the middle, its 95 % band "
        "(chaos is not in it), and the points, whose other factors are anywhere."
    )
    title = f"{own.measure.key} along each factor"
    return Drawing(f"sections-{file_part(own.measure)}.png", title, caption, sheet)


def _band(found: Surface, measure: Scale, mean: Array, deviation: Array) -> tuple[Array, Array]:
    wide = quantile(np.inf) * deviation
    return (
        measure.factor * found.unscaled(mean - wide),
        measure.factor * found.unscaled(mean + wide),
    )
