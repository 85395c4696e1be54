"""Figure of a cross-check: how far the engines are apart over time."""

from pathlib import Path

import matplotlib

from presswear.show.figures.style import (
    DOTS_PER_INCH,
    MUTED,
    REFERENCE,
    SETTINGS,
    WIDTH,
    Sheet,
)
from presswear.tools.files import write_whole
from presswear.trials.crosscheck.check import GROWTH, SLIDER_BOUND, Crosscheck
from presswear.trials.crosscheck.traces import Array, Difference

BEYOND = 1.5
"""The figure ends at so many horizons."""
_COLOURS = ("#56B4E9", "#0072B2", "#009E73", "#E69F00", "#D55E00")


def difference_sheet(outcome: Crosscheck) -> Sheet:
    """Draw the slider's distance from the reference over time, on a logarithmic scale."""
    sheet = Sheet(figsize=(WIDTH, 3.6), layout="constrained")
    axes = sheet.subplots()
    end = max(float(curve.time[-1]) for curve in outcome.differences)
    end = min(end, BEYOND * outcome.horizon)
    colours = _COLOURS if len(outcome.differences) == len(_COLOURS) else (MUTED, *_COLOURS)
    for curve, colour in zip(outcome.differences, colours, strict=False):
        time, apart = _shown(curve, end)
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
    return sheet


def _shown(curve: Difference, end: float) -> tuple[Array, Array]:
    # A logarithm shows no zeros.
    shown = (curve.time <= end) & (curve.slider > 0.0)
    return curve.time[shown], curve.slider[shown]


def write_differences(outcome: Crosscheck, path: Path) -> None:
    """Write the figure as PNG."""
    with matplotlib.rc_context(SETTINGS):
        sheet = difference_sheet(outcome)
        write_whole(path, lambda file: sheet.savefig(file, format="png", dpi=DOTS_PER_INCH))
