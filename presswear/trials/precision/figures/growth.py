"""Growth of the distance of neighbouring starts."""

from typing import Any

import numpy as np

from presswear.campaign.starts import APART
from presswear.show.figures.style import LINES, MUTED, REFERENCE, WIDTH, Axes, Drawing, Sheet
from presswear.tools.numbers import given
from presswear.trials.precision.chaos import Chaos
from presswear.trials.precision.figures.panels import PAPER, STAR
from presswear.trials.precision.growth import HIGH, LOW, PARTED, TOLERANCE, Parting

_SMALLEST = 1e-12
"""m."""


def growth_of_disturbance(chaos: Chaos) -> Drawing:
    """Draw the distance of each pair over time, with the bounds of the fit and the touchdowns."""
    sheet = Sheet(figsize=(WIDTH, 3.6), layout="constrained")
    axes = sheet.subplots()
    axes.set_yscale("log")
    for place, growth in enumerate(chaos.growths):
        apart = np.maximum(growth.distance, _SMALLEST)
        if place == 0:
            colour, dashes = LINES[0]
            first: dict[str, Any] = {"color": colour, "linestyle": dashes, "linewidth": 1.3}
            axes.plot(growth.time, apart, label="first pair", **first)
            _fit(axes, growth)
            touched = np.diff(growth.touchdowns, prepend=0) > 0
            axes.plot(
                np.array(growth.time)[touched],
                np.full(np.count_nonzero(touched), 0.02),
                transform=axes.get_xaxis_transform(),
                linestyle="none",
                marker="|",
                markersize=6.0,
                color=REFERENCE,
                label="touches of the first",
            )
        else:
            label = "further pairs" if place == 1 else None
            axes.plot(growth.time, apart, color="0.65", linewidth=0.7, label=label)
    dotted = (0.0, (2.0, 2.0))
    for bound, word, colour, style, text in (
        (LOW, "fitted from", MUTED, dotted, "0.3"),
        (HIGH, "fitted to", MUTED, dotted, "0.3"),
        (PARTED, "parted", REFERENCE, "solid", "black"),
    ):
        axes.axhline(bound, color=colour, linewidth=0.8, linestyle=style)
        axes.annotate(
            word,
            (0.998, bound),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            color=text,
        )
    paper = next((p for p in chaos.points if p.method.is_paper and p.failure), None)
    if paper is not None:
        top = axes.get_xaxis_transform()
        label = f"{PAPER}: failed by then"
        axes.plot(paper.simulated, 0.94, transform=top, gid="paper", label=label, **STAR)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("distance of two runs (m)")
    axes.margins(x=0.01)
    sheet.legend(loc="outside upper left", ncols=2)
    return Drawing(
        "precision-growth.png",
        "Growth of a disturbance",
        "Greatest difference of the pins' places in their bearings between two runs of one method "
        f"(DOP853 of dae at {given(TOLERANCE)}) whose starts are {given(APART)} m apart. The first "
        "pair starts as scenes do, with pins in the middle of their bearings; each further one "
        "where the last one's first run was after whole cycles.",
        sheet,
    )


def _fit(axes: Axes, growth: Parting) -> None:
    """Draw the fitted exponential between its bounds."""
    if growth.rate is None:
        return
    time, apart = np.array(growth.time), np.array(growth.distance)
    inside = growth.inside
    middle = float(np.log(apart[inside]).mean())
    line = np.exp(middle + growth.rate * (time[inside] - time[inside].mean()))
    colour, dashes = LINES[1]
    fit: dict[str, Any] = {"color": colour, "linestyle": dashes, "linewidth": 1.6}
    axes.plot(time[inside], line, label="fit to it", **fit)
