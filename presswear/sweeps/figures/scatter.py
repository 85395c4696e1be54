"""The distribution of a measure, with the values that are told of it."""

import numpy as np

from presswear.show.figures.style import LINES, REFERENCE, WIDTH, Drawing, Pen, Sheet, legend
from presswear.sweeps.figures.scales import Scale, file_part
from presswear.sweeps.responses import Responses
from presswear.sweeps.spread import PROBABILITIES, Required, Spread

TOLD = 5
"""Percentage whose value is told."""


def distribution(
    own: Responses, found: Spread, required: Required | None, rows: Spread | None
) -> Drawing:
    """Probability of lower values of a measure, with its band and its 5 % quantile.

    Parameters
    ----------
    rows : Spread or None
        That of the rows alone, to be shown beside the one of the surface.
    """
    ends = [found.values, found.low, found.high, *([rows.values] if rows else [])]
    if required is not None:
        ends.append(np.array([required.value]))
    told = np.concatenate(ends)
    wide = told.max(where=np.isfinite(told), initial=0) > 20.0 * np.nanmedian(found.values)
    measure = Scale.of(own.measure, told, is_logarithmic=bool(wide and np.nanmin(told) > 0.0))
    sheet = Sheet(figsize=(WIDTH, 3.6), layout="constrained")
    axes = sheet.subplots()
    pens = [Pen("probability of less, 95 % band", *LINES[0])]
    percent = 100.0 * PROBABILITIES
    measure.along_x(axes, WIDTH)
    # An end that cannot be told lies beyond the edge.
    left, right = axes.get_xlim()
    axes.fill_betweenx(
        percent,
        np.where(np.isnan(found.low), left, measure.factor * found.low),
        np.where(np.isnan(found.high), right, measure.factor * found.high),
        color=pens[0].colour,
        alpha=0.25,
        linewidth=0.0,
    )
    pens[0].draw(axes, measure.factor * found.values, percent)
    if rows is not None:
        pens.append(Pen("the rows alone", LINES[4][0], LINES[1][1]))
        pens[-1].draw(axes, measure.factor * rows.values, percent, drawstyle="steps-post")
    five = found.quantile(TOLD)
    if not np.isnan(five.mean):
        pens.append(Pen(f"{TOLD} % quantile with its interval", LINES[1][0], width=2.0))
        low = left if five.low is None else measure.factor * five.low
        high = right if five.high is None else measure.factor * five.high
        pens[-1].draw(axes, [low, high], [TOLD, TOLD])
        axes.plot([measure.factor * five.mean], [TOLD], "o", color=LINES[1][0])
    if required is not None:
        word = "least" if required.is_least else "most"
        shown = measure.told(required.value)
        pens.append(Pen(f"required: at {word} {shown}", REFERENCE, LINES[3][1]))
        axes.axvline(measure.factor * required.value, **pens[-1].look)
    axes.set_xlim(left, right)
    axes.set_ylim(0.0, 100.0)
    axes.set_ylabel("probability of less (%)")
    legend(sheet, pens, "outside upper center")
    text = own.measure.text
    caption = f"{text[:1].upper()}{text[1:]}: its distribution over those of all factors."
    return Drawing(
        f"spread-{file_part(own.measure)}.png", f"Spread of {own.measure.key}", caption, sheet
    )
