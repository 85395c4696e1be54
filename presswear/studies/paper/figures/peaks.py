"""Peaks of single cycles: our mean and scatter, and what the paper prints."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator

from presswear.show.figures.style import REFERENCE, Axes
from presswear.studies.paper.evidence import Evidence, Measured
from presswear.studies.paper.figures.lines import Line, counted, differing, misprints, printed_in
from presswear.studies.paper.printed import printed_at
from presswear.studies.paper.variants import BASE

ROW = 0.24
"""Height of a line, inches."""
_MARK: dict[str, Any] = {
    "marker": "D",
    "markersize": 5.0,
    "markerfacecolor": "none",
    "markeredgewidth": 1.1,
}
_IDEAL: dict[str, Any] = {"color": REFERENCE, "linewidth": 1.6}
_SCATTER: dict[str, Any] = {"alpha": 0.25, "linewidth": 0.0}
_CYCLE: dict[str, Any] = {"marker": "x", "markersize": 6.0, "markeredgewidth": 1.5}


def peaks_caption(known: Mapping[str, Mapping[Line, Measured]], number: int) -> str:
    """What the row of peaks shows, of some quantities."""
    every = [one for found in known.values() for one in found.values()]
    if not every:
        return "Lowest row: peaks of single cycles; none ran to its end."
    text = (
        f"Lowest row: the peak of a cycle over {counted(every)}: its mean (dot) with the 95 % "
        "interval of the mean (line), and the range of 95 % of single cycles (pale bar). First "
        "cycles, which start with the pins in the middle of their bearings, are not among these "
        "cycles where enough others ran; the peak of the one that is shown above is a cross. "
        "Diamond: the peak that the paper prints."
    )
    text += differing(every)
    if any(one.stage_not_said for one in printed_in(number)):
        text += (
            " The paper does not say before or after which wear its peaks were read; they are "
            "marked at no wear."
        )
    return text + misprints(number)


def peaks(
    evidence: Evidence, lines: Sequence[Line], quantity: str, joint: str = ""
) -> dict[Line, Measured]:
    """The peak of each line that has any."""
    found = {line: evidence.measured(BASE, line.at(joint), quantity) for line in lines}
    return {line: known for line, known in found.items() if known is not None}


def draw_peaks(
    axes: Axes,
    lines: Sequence[Line],
    known: Mapping[Line, Measured],
    quantity: str,
    joint: str,
    shown: Mapping[Line, float],
    ideal: Mapping[Line, float] | None = None,
) -> None:
    """A row for each line, the first on top.

    Parameters
    ----------
    shown : mapping of Line to float
        Peak of the cycle that is shown.
    ideal : mapping of Line to float
        Peak of the ideal motion.
    """
    for row, line in enumerate(lines):
        peak = known.get(line)
        if peak is not None:
            if peak.draws is not None:
                low, high = peak.draws
                axes.barh(row, high - low, 0.62, low, color=line.colour, **_SCATTER)
            if peak.low is not None and peak.high is not None:
                axes.plot((peak.low, peak.high), (row, row), color=line.colour, linewidth=1.8)
            axes.plot(peak.value, row, color=line.colour, marker="o", markersize=4.5, gid="mean")
        if ideal is not None:
            axes.plot((ideal[line],) * 2, (row - 0.34, row + 0.34), **_IDEAL)
        axes.plot(shown[line], row, color=line.colour, gid="shown", **_CYCLE)
        printed = printed_at(line.at(joint), quantity)
        if printed is not None:
            axes.plot(printed.value, row, color=REFERENCE, gid="printed", **_MARK)
    axes.set_yticks(range(len(lines)), [line.name for line in lines])
    axes.set_ylim(len(lines) - 0.5, -0.5)
    axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.tick_params(axis="y", length=0.0)
    axes.grid(visible=False, axis="y")
    axes.margins(x=0.08)


def peak_handles(with_ideal: bool) -> list[Line2D | Patch]:
    """What the marks mean."""
    handles: list[Line2D | Patch] = [
        Line2D([], [], color="0.3", marker="o", markersize=4.5, linewidth=1.8, label="mean, 95 %"),
        Patch(color="0.3", label="95 % of cycles", **_SCATTER),
        Line2D([], [], color="0.3", linestyle="none", label="cycle shown", **_CYCLE),
        Line2D([], [], color=REFERENCE, linestyle="none", label="printed", **_MARK),
    ]
    if with_ideal:
        handles.append(
            Line2D(
                [],
                [],
                color=REFERENCE,
                linestyle="none",
                marker="|",
                markersize=9.0,
                markeredgewidth=1.6,
                label="ideal",
            )
        )
    return handles
