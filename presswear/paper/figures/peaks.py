"""Peaks of single cycles: our mean and scatter, and what the paper prints."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator

from presswear.paper.evidence import Evidence, Measured
from presswear.paper.figures.lines import ShownLine, counted
from presswear.paper.printed import printed_at, shown_in
from presswear.paper.variants import BASE
from presswear.show.figures.style import REFERENCE, WIDTH, Axes, Sheet

ROW = 0.24
"""Height of a line, inches."""


def _mark(marker: str, size: float, width: float, **others: Any) -> dict[str, Any]:
    """Look of a mark."""
    return {"marker": marker, "markersize": size, "markeredgewidth": width, **others}


_MARK = _mark("D", 5.0, 1.1, markerfacecolor="none")
_CYCLE = _mark("x", 6.0, 1.5)
_IDEAL: dict[str, Any] = {"color": REFERENCE, "linewidth": 1.6}
_SCATTER: dict[str, Any] = {"alpha": 0.25, "linewidth": 0.0}


@dataclass(frozen=True)
class PeakPanel:
    """A panel with peaks of a quantity.

    Attributes
    ----------
    quantity, label, joint : str
        Without a joint it is the slider's.
    ideal : sequence of float
        Peaks of the ideal motion of the lines; empty: none are shown.
    """

    quantity: str
    label: str
    joint: str = ""
    ideal: Sequence[float] = ()


def sheet_over_peaks(upper: float, lower: float) -> tuple[Sheet, SubFigure, SubFigure]:
    """A sheet in two parts, the lower one for peaks; heights in inches."""
    sheet = Sheet(figsize=(WIDTH, upper + lower), layout="constrained")
    top, bottom = sheet.subfigures(2, 1, squeeze=False, height_ratios=(upper, lower))[:, 0]
    return sheet, top, bottom


def draw_peaks(
    sheet: SubFigure,
    evidence: Evidence,
    number: int,
    shown: Sequence[ShownLine],
    peaks: Sequence[PeakPanel],
) -> str:
    """Draw panels of peaks beside each other; returns what they show, for the caption."""
    known = []
    panels = sheet.subplots(1, len(peaks), sharey=True, squeeze=False)[0]
    for axes, peak in zip(panels, peaks, strict=True):
        known += _draw_panel(axes, evidence, shown, peak)
    handles: list[Line2D | Patch] = [
        Line2D([], [], color="0.3", marker="o", markersize=4.5, linewidth=1.8, label="mean, 95 %"),
        Patch(color="0.3", label="95 % of cycles", **_SCATTER),
        Line2D([], [], color="0.3", linestyle="none", label="cycle shown", **_CYCLE),
        Line2D([], [], color=REFERENCE, linestyle="none", label="printed", **_MARK),
    ]
    if any(peak.ideal for peak in peaks):
        bar = _mark("|", 9.0, 1.6)
        handles.append(Line2D([], [], color=REFERENCE, linestyle="none", label="ideal", **bar))
    sheet.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return _caption(known, number)


def _draw_panel(
    axes: Axes, evidence: Evidence, shown: Sequence[ShownLine], peak: PeakPanel
) -> list[Measured]:
    """Draw a row for each line, the first on top; returns what is known."""
    found = []
    for row, one in enumerate(shown):
        place, colour = one.line.at(peak.joint), one.line.colour
        known = evidence.measured(BASE, place, peak.quantity)
        if known is not None:
            found.append(known)
            if known.draws is not None:
                low, high = known.draws
                axes.barh(row, high - low, 0.62, low, color=colour, **_SCATTER)
            if known.ends is not None:
                axes.plot(known.ends, (row, row), color=colour, linewidth=1.8)
            axes.plot(known.value, row, color=colour, marker="o", markersize=4.5, gid="mean")
        if peak.ideal:
            axes.plot((peak.ideal[row],) * 2, (row - 0.34, row + 0.34), **_IDEAL)
        axes.plot(one.peak(peak.quantity, peak.joint), row, color=colour, gid="shown", **_CYCLE)
        printed = printed_at(place, peak.quantity)
        if printed is not None:
            axes.plot(printed.value, row, color=REFERENCE, gid="printed", **_MARK)
    axes.set_xlabel(peak.label)
    axes.set_yticks(range(len(shown)), [one.line.name for one in shown])
    axes.set_ylim(len(shown) - 0.5, -0.5)
    axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.tick_params(axis="y", length=0.0)
    axes.grid(visible=False, axis="y")
    axes.margins(x=0.08)
    if peak.joint:
        axes.set_xlim(0.0, None)
    return found


def _caption(known: Sequence[Measured], number: int) -> str:
    """Tell what the lowest row of a figure shows."""
    if not known:
        return "Lowest row: peaks of single cycles; none ran to its end."
    text = (
        f"Lowest row: the peak of a cycle over {counted(known)}: its mean (dot) with the 95 % "
        "interval of the mean (line), and the range of 95 % of single cycles (pale bar). First "
        "cycles, which start with the pins in the middle of their bearings, are not among these "
        "cycles where enough others ran; the peak of the one that is shown above is a cross. "
        "Diamond: the peak that the paper prints."
    )
    if any(one.differ for one in known):
        text += (
            " Where starts differ by more than their cycles explain, each start is one sample, "
            "and the interval is wide."
        )
    printed = shown_in(number)
    if any(one.stage_not_said for one in printed):
        text += (
            " The paper does not say before or after which wear its peaks were read; they are "
            "marked at no wear."
        )
    misprints = dict.fromkeys(part for one in printed for part in one.misprint.split("; ") if part)
    return f"{text} In print: {'; '.join(misprints)}." if misprints else text
