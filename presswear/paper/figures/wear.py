"""Figures 8 to 16: wear depth over angle, worn surfaces of pin and bearing."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MultipleLocator

from presswear.paper.evidence import Evidence, Measured, WearMap
from presswear.paper.figures.lines import Drawn, Lines, PaperLine, counted, joint_title
from presswear.paper.printed import (
    JOINTS,
    RANGES,
    Printed,
    PrintedRange,
    printed_at,
    shown_in,
)
from presswear.paper.variants import BASE
from presswear.results.result import Result
from presswear.results.stage import SIDES
from presswear.show.figures.style import (
    MICRONS,
    REFERENCE,
    WIDTH,
    Axes,
    Sheet,
    ShownStage,
    maps_turn,
)
from presswear.show.figures.surfaces import worn_surface
from presswear.tools.numbers import readable

_LINEAR_RATIO = 20.0
"""Ratio of the largest to the smallest peak up to which one linear scale shows both."""


@dataclass(frozen=True)
class _DepthLine:
    """A wear map with our measure of its deepest place and what the paper prints of it.

    Attributes
    ----------
    turns : bool
        True where its angles are on the bodies.
    """

    line: PaperLine
    map: WearMap
    known: Measured
    depth: Printed | None
    angle: Printed | None
    turns: bool


def depths(evidence: Evidence, number: int, lines: Lines) -> Drawn:
    """Depth of pin and bearing together over the direction of contact, at A and at C."""
    panels = {joint: _curves(evidence, joint, lines) for joint in JOINTS}
    panels = {joint: curves for joint, curves in panels.items() if curves}
    if not panels:
        return None
    ranges = [one for one in RANGES if one.figure[:-1] == str(number)]
    sheet = Sheet(figsize=(WIDTH, 0.8 + 2.5 * len(panels)), layout="constrained")
    grid = sheet.subplots(len(panels), 1, squeeze=False)
    everything = [curve for curves in panels.values() for curve in curves]
    where = "angle on each body" if everything[0].turns else "direction of contact"
    for axes, (joint, curves) in zip(grid.flat, panels.items(), strict=True):
        _draw(axes, curves)
        for one in ranges:
            if one.joint == joint:
                _draw_range(axes, one)
        axes.set_xlabel(f"{where} (degrees)")
        axes.set_ylabel("depth, bearing + pin (µm)")
        axes.set_title(joint_title(joint), loc="left", fontweight="bold")
    drawn = {curve.line: curve.line.pen(curve.line.wear_name).handle() for curve in everything}
    handles: list[Line2D | Patch] = list(drawn.values())
    handles.append(
        Line2D([], [], color=REFERENCE, label="printed, deepest", **_MARK | {"linestyle": "none"})
    )
    if ranges:
        handles.append(Patch(color=_RANGE_COLOUR, label="printed, mainly worn"))
    sheet.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    caption = (
        "Depth that pin and bearing lose together, all wears so far added up, over the direction "
        f"in which they touch. Lines: mean over {counted([c.known for c in everything])}; bands: "
        "95 % interval of that mean at each angle by itself. Diamonds: deepest wear and its angle "
        "as the paper prints them."
    )
    if ranges:
        caption += " Grey bars: where the paper says that the joint is mainly worn."
    if any(axes.get_yscale() == "log" for axes in grid.flat):
        caption += " The scale is logarithmic where peaks differ much; lower depths are cut."
    doubts = dict.fromkeys(one.misprint for one in shown_in(number) if one.misprint)
    if doubts:
        caption += f" *: {'; '.join(doubts)}."
    return caption, sheet


def _curves(evidence: Evidence, joint: str, lines: Lines) -> list[_DepthLine]:
    found = []
    for place, line in ((line.at(joint), line) for line in lines):
        result, worn = evidence.worn_at(BASE, place), evidence.wear_map(BASE, place)
        known = evidence.measured(BASE, place, "depth")
        if result and worn and known and np.any(worn.mean > 0.0):
            printed = (printed_at(place, "depth"), printed_at(place, "angle"))
            found.append(_DepthLine(line, worn, known, *printed, maps_turn(result)))
    return found


_MARK: dict[str, Any] = {
    "marker": "D",
    "markersize": 5.5,
    "markerfacecolor": "white",
    "markeredgewidth": 1.2,
}
_RANGE_COLOUR = "0.7"


def _draw(axes: Axes, curves: Sequence[_DepthLine]) -> None:
    peaks = [MICRONS * float(curve.map.mean.max()) for curve in curves]
    marked = [MICRONS * curve.depth.value for curve in curves if curve.depth is not None]
    least, most = min(peaks + marked), max(peaks + marked)
    logarithmic = most > _LINEAR_RATIO * least
    floor = min(least / 3.0, min(peaks) / 100.0) if logarithmic else 0.0
    for curve in curves:
        degrees = np.degrees(curve.map.angle)
        # A band that ends at nothing has no lower end on a logarithmic scale.
        low, high = (np.maximum(MICRONS * end, floor) for end in (curve.map.low, curve.map.high))
        axes.fill_between(degrees, low, high, color=curve.line.colour, alpha=0.2, linewidth=0.0)
        curve.line.pen("").draw(axes, degrees, MICRONS * curve.map.mean, linewidth=1.2)
    axes.set_xlim(0.0, 360.0)
    axes.xaxis.set_major_locator(MultipleLocator(60.0))
    if logarithmic:
        axes.set_yscale("log", nonpositive="mask")
        axes.set_ylim(floor, 3.0 * most)
    else:
        highest = max(float(curve.map.high.max()) for curve in curves)
        axes.set_ylim(0.0, 1.2 * max(most, MICRONS * highest))
    for curve in curves:
        _mark(axes, curve)


def _mark(axes: Axes, curve: _DepthLine) -> None:
    """Mark the printed deepest place."""
    if curve.depth is None or curve.angle is None:
        return
    at = (np.degrees(curve.angle.value), MICRONS * curve.depth.value)
    axes.plot(*at, color=curve.line.colour, gid="printed", **_MARK)
    text = f"{readable(at[1], 4)} µm{'*' if curve.depth.misprint else ''}"
    axes.annotate(
        text,
        at,
        xytext=(6.0, 0.0),
        textcoords="offset points",
        ha="left",
        va="center",
        color="0.25",
        fontsize=8.0,
        bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5},
    )


def _draw_range(axes: Axes, printed: PrintedRange) -> None:
    """Where the paper says that a joint is worn, along the upper edge."""
    for arc in printed.arcs:
        axes.plot(
            np.degrees(arc),
            (0.985, 0.985),
            transform=axes.get_xaxis_transform(),
            color=_RANGE_COLOUR,
            linewidth=4.0,
            solid_capstyle="butt",
        )


def surfaces(joint: str, evidence: Evidence, number: int, lines: Lines) -> Drawn:
    """Surfaces of a joint, outlines and an enlarged part."""
    shown = [found for line in lines if (found := _worn(evidence, line, joint)) is not None]
    if not shown:
        return None
    drawing = worn_surface(shown[0][0], joint, [stage for _, stage in shown])
    caption = (
        f"{drawing.caption} The surfaces are those that the stage before left on average "
        "over the cycles of all its starts: how uneven they are is partly chance, and the "
        f"depths with their intervals are in Fig. {number - (1 if joint == 'A' else 2)}. The "
        f"enlarged part is around the deepest wear of “{shown[-1][1].pen.label}”."
    )
    return caption, drawing.sheet


def _worn(evidence: Evidence, line: PaperLine, joint: str) -> tuple[Result, ShownStage] | None:
    """The run of a line, with its surfaces; None where nothing is worn."""
    result = evidence.worn_at(BASE, line.at(joint))
    if result is None:
        return None
    stage = result.stages[line.wear_updates - 1]
    before, arrays = stage.arrays, dict(stage.arrays)
    for side in SIDES:
        name = f"{joint}_depth_{side}"
        # What a stage ran on is what is known best: a wear may have gone in steps.
        if line.wear_updates < len(result.stages):
            arrays[name] = result.stages[line.wear_updates].arrays[name]
        else:
            arrays[name] = before[name] + before[f"{joint}_wear_{side}"]
    if not any(np.any(arrays[f"{joint}_depth_{side}"] > 0.0) for side in SIDES):
        return None
    return result, ShownStage(replace(stage, arrays=arrays), line.pen(line.wear_name))
