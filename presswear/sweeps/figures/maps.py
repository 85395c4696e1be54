"""Maps of a measure over two factors, and all factors side by side."""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D

from presswear.show.figures.style import MUTED, REFERENCE, WIDTH, Axes, Drawing, Sheet, wrapped
from presswear.sweeps.figures.scales import Scale, file_part, scales_of
from presswear.sweeps.responses import Responses
from presswear.sweeps.surface import Surface
from presswear.tools.arrays import Array
from presswear.tools.numbers import readable

COLOURS = "cividis"
"""Told apart with every common colour blindness, and in print without colour."""
_FINE = 60
"""Cells of a map along each axis."""
_MOST_LINES = 400
"""Lines beyond which evenly spaced ones of the order of the measure are drawn."""


def heat_map(own: Responses, places: tuple[int, int], found: Surface | None) -> Drawing:
    """A measure over two of its factors: the runs as points, the response surface behind them.

    Parameters
    ----------
    places : tuple of int
        Of both factors.
    found : Surface or None
        None: the points alone.
    """
    scales = scales_of(own.factors, own.points)
    across, up = (scales[place] for place in places)
    measure = Scale.of(own.measure, own.means)
    norm = Normalize(measure.low, measure.high)
    sheet = Sheet(figsize=(WIDTH, 4.2), layout="constrained")
    axes = sheet.subplots()
    others = _others(own, places, scales)
    caption = f"{own.measure.text[:1].upper()}{own.measure.text[1:]}: a point for each that ran"
    if found is not None:
        x, y = across.grid(_FINE), up.grid(_FINE)
        points = np.tile(own.middle, (_FINE * _FINE, 1))
        points[:, places[0]], points[:, places[1]] = (part.ravel() for part in np.meshgrid(x, y))
        level = measure.factor * found.level(points).reshape(_FINE, _FINE)
        axes.pcolormesh(
            across.factor * x, up.factor * y, level, norm=norm, cmap=COLOURS, shading="gouraud"
        )
        if others:
            caption += f"; behind them the response surface at {others}"
        else:
            caption += "; behind them the response surface"
    known = own.has_value
    edge = REFERENCE if found is None else "white"
    _points(axes, own, places, scales, measure, norm, edge)
    across.along_x(axes, WIDTH)
    up.along_y(axes, 4.0)
    axes.grid(visible=found is None)
    bar = sheet.colorbar(ScalarMappable(norm, COLOURS), ax=axes)
    bar.set_label(wrapped(measure.label, 4.0))
    handles = []
    if own.is_beyond.any():
        handles.append(Line2D([], [], marker="^", color=MUTED, linestyle="", label="lower bound"))
    if not known.all():
        handles.append(Line2D([], [], marker="x", color=REFERENCE, linestyle="", label="failed"))
    if handles:
        sheet.legend(handles=handles, loc="outside upper right", ncols=2)
    keys = " and ".join(scales[place].column.key for place in places)
    file = f"map-{file_part(own.measure)}.png"
    return Drawing(file, f"{own.measure.key} over {keys}", f"{caption}.", sheet)


def _points(
    axes: Axes,
    own: Responses,
    places: tuple[int, int],
    scales: list[Scale],
    measure: Scale,
    norm: Normalize,
    edge: str,
) -> None:
    x, y = (scales[place].factor * own.points[:, place] for place in places)
    for kind, rows in (
        ("o", own.has_value & ~own.is_beyond),
        ("^", own.has_value & own.is_beyond),
    ):
        axes.scatter(
            x[rows],
            y[rows],
            22.0,
            measure.factor * own.means[rows],
            marker=kind,
            cmap=COLOURS,
            norm=norm,
            edgecolors=edge,
            linewidths=0.7,
        )
    axes.scatter(x[~own.has_value], y[~own.has_value], 26.0, REFERENCE, marker="x")


def _others(own: Responses, places: tuple[int, int], scales: list[Scale]) -> str:
    """What the factors that a map does not show are at, in words."""
    middle, told = own.middle, []
    for k, scale in enumerate(scales):
        if k not in places:
            told.append(f"{scale.column.key} = {scale.told(middle[k])}")
    return ", ".join(told)


def parallel(own: Responses) -> Drawing:
    """All factors and the measure side by side, a line for each point."""
    kept = own.only(own.has_value)
    scales = [*scales_of(kept.factors, kept.points), Scale.of(kept.measure, kept.means)]
    values = np.column_stack([kept.points, kept.means])
    order = np.argsort(kept.means)
    drawn = order[np.unique(np.linspace(0, len(order) - 1, _MOST_LINES).round().astype(int))]
    norm = Normalize(kept.means.min(), kept.means.max())
    heights = np.column_stack([_height(s, values[:, k]) for k, s in enumerate(scales)])
    sheet = Sheet(figsize=(WIDTH, 3.6), layout="constrained")
    axes = sheet.subplots()
    for row in drawn:
        colour = colormaps[COLOURS](norm(kept.means[row]))
        axes.plot(heights[row], color=colour, linewidth=0.8, alpha=0.7)
    count = len(scales)
    room = WIDTH / count
    for k, scale in enumerate(scales):
        axes.axvline(k, color=REFERENCE, linewidth=0.6)
        for height, text in _ends(scale):
            axes.annotate(
                text,
                (k, height),
                (3.0, 0.0),
                textcoords="offset points",
                va="center",
                fontsize=7.5,
                bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.5},
            )
    axes.set_xticks(
        range(count), [wrapped(scale.label.replace("_", " "), room) for scale in scales]
    )
    axes.set_yticks([])
    axes.grid(visible=False)
    axes.set_xlim(-0.1, count - 0.65)
    axes.spines[["left", "bottom"]].set_visible(False)
    what = (
        "a line for each point"
        if len(drawn) == len(order)
        else (f"{len(drawn)} of {len(order)} points, evenly spaced in the order of the measure")
    )
    caption = f"Every factor, and at the right {own.measure.text}: {what}, coloured by the measure."
    if kept.is_beyond.any():
        caption = f"{caption[:-1]}; lower bounds are drawn as values."
    return Drawing(
        f"parallel-{file_part(own.measure)}.png",
        f"All factors and {own.measure.key}",
        caption,
        sheet,
    )


def _height(scale: Scale, values: Array) -> Array:
    """Places of values between both ends of a scale, 0 to 1."""
    if scale.column.words:
        return values / max(len(scale.column.words) - 1, 1)
    shown, low, high = scale.factor * values, scale.low, scale.high
    if scale.is_logarithmic:
        shown, low, high = np.log(shown), np.log(low), np.log(high)
    return np.asarray((shown - low) / (high - low)) if high > low else np.full(len(values), 0.5)


def _ends(scale: Scale) -> list[tuple[float, str]]:
    words = scale.column.words
    if words:
        return [(k / max(len(words) - 1, 1), word) for k, word in enumerate(words)]
    if scale.high == scale.low:
        return [(0.5, readable(scale.low))]
    return [(0.0, readable(scale.low)), (1.0, readable(scale.high))]
