"""Bars of sensitivity: the tornado, shares of the variance, effects of single jumps."""

from collections.abc import Sequence

import numpy as np

from presswear.recording.statistics import Estimate
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
from presswear.sweeps.estimates import as_share
from presswear.sweeps.figures.scales import Scale, file_part, scales_of
from presswear.sweeps.responses import Responses
from presswear.sweeps.sensitivity import Indices, Screening, Swing

_NAMES = 2.2
"""Width of the names of factors, inches."""
_THICK = 0.36
"""Height of a bar, where a factor has two, part of its row."""


def tornado(own: Responses, swings: Sequence[Swing | None]) -> Drawing:
    """How far each factor alone moves a measure, the strongest at the top."""
    told = [(k, swing) for k, swing in enumerate(swings) if swing is not None]
    told.sort(key=lambda one: -one[1].span)
    ends = np.array([[s.at_low.mean, s.at_high.mean] for _, s in told])
    measure = Scale.of(own.measure, np.append(ends, 0.0))
    scales = scales_of(own.factors, own.points)
    sheet, axes = _rows(len(told))
    pens = [Pen("low", *LINES[0], width=7.0), Pen("high", LINES[1][0], width=7.0)]
    for row, (k, swing) in enumerate(told):
        both = zip(pens, (swing.at_low, swing.at_high), (swing.low, swing.high), strict=True)
        for place, (pen, change, value) in enumerate(both):
            y = row + (place - 0.5) * _THICK
            _bar(axes, y, change, measure.factor, pen.colour)
            outward = -1.0 if change.mean < 0.0 else 1.0
            tip = max(
                outward * end for end in (change.mean, change.low, change.high) if end is not None
            )
            axes.annotate(
                scales[k].told(value),
                (measure.factor * outward * tip, y),
                (3.0 * outward, 0.0),
                textcoords="offset points",
                ha="right" if outward < 0.0 else "left",
                va="center",
                fontsize=7.5,
            )
    axes.axvline(0.0, color=REFERENCE, linewidth=0.8)
    axes.margins(x=0.3)
    _names(axes, [own.factors[k].key for k, _ in told])
    middle = measure.told(float(own.means[0]))
    unit = f" ({measure.unit})" if measure.unit else ""
    axes.set_xlabel(f"{own.measure.key} less {middle}, that in the middle{unit}")
    legend(sheet, pens, "outside upper center")
    caption = (
        "The measure when one factor alone is at its lowest and its highest, beside the bars; thin "
        "lines are 95 % intervals of the change."
    )
    return Drawing(
        f"tornado-{file_part(own.measure)}.png", f"What moves {own.measure.key}", caption, sheet
    )


def shares(own: Responses, found: Indices) -> Drawing:
    """Shares of the variance of a measure, first and total, and that of chaos."""
    both = bool(found.total)
    strength = [one.mean for one in (found.total or found.first)]
    order = sorted(range(len(strength)), key=lambda k: -strength[k])
    names = [own.factors[k].key for k in order]
    sheet, axes = _rows(len(order) + (found.chaos is not None))
    pens = [Pen("alone (first order)", *LINES[0], width=7.0)]
    pens += [Pen("with others (total)", LINES[1][0], width=7.0)] * both
    for row, k in enumerate(order):
        kinds = [found.first, found.total] if both else [found.first]
        for place, (pen, kind) in enumerate(zip(pens, kinds, strict=True)):
            _bar(axes, row + (place - 0.5) * _THICK * both, as_share(kind[k]), 1.0, pen.colour)
    if found.chaos is not None:
        pens.append(Pen("chaos, of a single run", MUTED, width=7.0))
        _bar(axes, len(order), as_share(found.chaos), 1.0, MUTED)
        names.append("chaos")
    axes.set_xlim(0.0, 1.0)
    _names(axes, names)
    axes.set_xlabel(f"share of the variance of {own.measure.key}")
    legend(sheet, pens, "outside upper center")
    caption = (
        "Share of the variance of the means that goes when a factor is known (first order)"
        f"{', and that stays when all others are (total)' if both else ''}; lines are 95 % "
        "intervals."
    )
    title = f"What {own.measure.key} depends on"
    return Drawing(f"shares-{file_part(own.measure)}.png", title, caption, sheet)


def effects(own: Responses, found: Sequence[Screening]) -> Drawing:
    """Mean absolute effects of jumps by half of the range, with what chaos alone would give."""
    order = sorted(range(len(found)), key=lambda k: -found[k].size.mean)
    largest = max(one.size.high or one.size.mean for one in found)
    measure = Scale.of(own.measure, np.array([0.0, largest]))
    sheet, axes = _rows(len(order))
    pens = [
        Pen("mean size of the effect", *LINES[0], width=7.0),
        Pen("scatter of the effect", LINES[1][0], width=7.0),
    ]
    for row, k in enumerate(order):
        _bar(axes, row - 0.5 * _THICK, found[k].size, measure.factor, pens[0].colour)
        _bar(axes, row + 0.5 * _THICK, found[k].scatter, measure.factor, pens[1].colour)
        if not np.isnan(found[k].floor):
            axes.plot(
                [measure.factor * found[k].floor] * 2, [row - 0.45, row + 0.05], **_FLOOR.look
            )
    has_floor = not np.isnan(found[0].floor)
    axes.set_xlim(left=0.0)
    _names(axes, [own.factors[k].key for k in order])
    unit = f" ({measure.unit})" if measure.unit else ""
    axes.set_xlabel(f"effect on {own.measure.key}{unit}")
    legend(sheet, [*pens, *([_FLOOR] * has_floor)], "outside upper center")
    caption = (
        "Change of the measure when a factor goes up by half of its range, over paths through all "
        "others; lines are 95 % intervals. Chaos is in both bars."
    )
    title = f"Effects on {own.measure.key}"
    return Drawing(f"effects-{file_part(own.measure)}.png", title, caption, sheet)


_FLOOR = Pen("chaos alone", REFERENCE, "dotted", 1.4)


def _rows(count: int) -> tuple[Sheet, Axes]:
    sheet = Sheet(figsize=(WIDTH, 1.1 + 0.42 * count), layout="constrained")
    axes = sheet.subplots()
    axes.set_ylim(count - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    return sheet, axes


def _bar(axes: Axes, y: float, own: Estimate, factor: float, colour: str) -> None:
    axes.barh(y, factor * own.mean, _THICK * 0.9, color=colour)
    if own.low is not None and own.high is not None:
        axes.plot([factor * own.low, factor * own.high], [y, y], color=REFERENCE, linewidth=0.9)


def _names(axes: Axes, names: Sequence[str]) -> None:
    axes.set_yticks(range(len(names)), [wrapped(name.replace("_", " "), _NAMES) for name in names])
