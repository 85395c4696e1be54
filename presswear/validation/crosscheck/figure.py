"""Figure of a cross-check: how far the engines are apart over time."""

import matplotlib

from presswear.show.figures.style import MUTED, REFERENCE, SETTINGS, WIDTH, Drawing, Sheet
from presswear.validation.crosscheck.check import GROWTH, SLIDER_BOUND, Crosscheck

BEYOND = 1.5
"""Horizons after which the figure ends."""
_COLOURS = ("#56B4E9", "#0072B2", "#009E73", "#E69F00", "#D55E00")


@matplotlib.rc_context(SETTINGS)
def draw_differences(outcome: Crosscheck) -> Drawing:
    """Draw the slider's distance from the reference over time, on a logarithmic scale."""
    sheet = Sheet(figsize=(WIDTH, 3.6), layout="constrained")
    axes = sheet.subplots()
    end = max(float(curve.time[-1]) for curve in outcome.differences)
    end = min(end, BEYOND * outcome.horizon)
    colours = _COLOURS if len(outcome.differences) == len(_COLOURS) else (MUTED, *_COLOURS)
    for curve, colour in zip(outcome.differences, colours, strict=False):
        # A logarithm shows no zeros.
        shown = (curve.time <= end) & (curve.slider > 0.0)
        time, apart = curve.time[shown], curve.slider[shown]
        axes.semilogy(time, apart, color=colour, linewidth=0.9, label=curve.label)
    axes.axhline(SLIDER_BOUND, color=REFERENCE, linewidth=0.7, linestyle=(0.0, (4.0, 2.0)))
    axes.text(0.0, SLIDER_BOUND, " bound", va="bottom", ha="left")
    if outcome.parted:
        axes.axvline(outcome.horizon, color=REFERENCE, linewidth=0.7)
        axes.text(
            outcome.horizon,
            0.02,
            f" horizon: grown {GROWTH:g} times ",
            transform=axes.get_xaxis_transform(),
            va="bottom",
            ha="left" if outcome.horizon < 0.7 * end else "right",
        )
    axes.set_xlim(0.0, end)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("distance of the slider from the\nin-house reference (m)")
    sheet.legend(loc="outside upper center", ncols=3)
    title = "Distance of the engines from the in-house reference"
    return Drawing("difference.png", title, "", sheet)
