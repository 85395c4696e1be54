"""Figure of wear depth over angle."""

from dataclasses import dataclass

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from presswear.results.result import Result
from presswear.scene.scene import stage_name
from presswear.show.figures.style import (
    MICRONS,
    MUTED,
    SIDES,
    WIDTH,
    Array,
    Axes,
    Drawing,
    LineStyle,
    Sheet,
    maps_turn,
    shown_stages,
)

_LINEAR_RATIO = 20.0
"""Ratio of the largest to the smallest peak up to which one linear scale shows both."""
_PLAIN_DASHES: LineStyle = (0.0, (2.0, 2.0))


@dataclass(frozen=True)
class _Curve:
    """One wear map as drawn: depth at the bin centres, m."""

    label: str
    colour: str
    dashes: LineStyle
    depth: Array


def _panels(result: Result) -> list[tuple[str, tuple[str, ...]]]:
    """Joint and sides whose depth one panel adds up."""
    kinds: tuple[tuple[str, ...], ...] = (("bearing",), ("pin",)) if maps_turn(result) else (SIDES,)
    return [(joint, sides) for joint in result.scene.clearance_joints for sides in kinds]


def _next_wear(result: Result, joint: str, sides: tuple[str, ...]) -> _Curve | None:
    """What one more wear would leave; None where the last stage says nothing about it."""
    if not result.stages or result.stages[-1].status == "failed":
        return None
    arrays = result.stages[-1].arrays
    depth = sum(
        (arrays[f"{joint}_depth_{side}"] + arrays[f"{joint}_wear_{side}"] for side in sides),
        np.zeros(arrays["angle"].size),
    )
    index = result.stages[-1].index + 1
    return _Curve(f"{stage_name(index)}, not run", MUTED, _PLAIN_DASHES, depth)


def _curves(result: Result, joint: str, sides: tuple[str, ...]) -> list[_Curve]:
    """Cumulative depth after each wear that left anything."""
    curves = [
        _Curve(
            stage.label,
            stage.colour,
            stage.dashes,
            sum((stage.depth(joint, side) for side in sides), np.zeros(stage.arrays["angle"].size)),
        )
        for stage in shown_stages(result)
        if stage.index > 0
    ]
    further = _next_wear(result, joint, sides)
    if further is not None:
        curves.append(further)
    return [curve for curve in curves if np.any(curve.depth > 0.0)]


def wear_depth(result: Result) -> list[Drawing]:
    """Cumulative wear depth over angle at each clearance joint."""
    panels = [(joint, sides, _curves(result, joint, sides)) for joint, sides in _panels(result)]
    everything = [curve for _, _, curves in panels for curve in curves]
    if not everything:
        return []
    columns = 2 if maps_turn(result) else 1
    rows = len(panels) // columns
    sheet = Sheet(figsize=(WIDTH, 0.5 + 2.3 * rows), layout="constrained")
    grid = sheet.subplots(rows, columns, squeeze=False)
    for axes, (joint, sides, curves) in zip(grid.flat, panels, strict=True):
        _draw_depth(axes, result.stages[0].arrays["angle"], curves)
        where = f"angle on the {sides[0]}" if maps_turn(result) else "direction of contact"
        axes.set_xlabel(f"{where} (degrees)")
        axes.set_ylabel(f"depth, {' + '.join(sides)} (µm)")
        axes.set_title(f"joint {joint}", loc="left", fontweight="bold")
    # Keyed by label: every panel may lack a line that another has.
    lines = {curve.label: _legend_line(curve) for curve in everything}
    sheet.legend(handles=list(lines.values()), loc="outside upper right", ncols=len(lines))
    caption = (
        "Wear depth of bearing and pin, each over the angle on its own body, in total after each "
        "wear."
        if maps_turn(result)
        else "Wear depth of bearing and pin together over the direction of contact, in total "
        "after each wear."
    )
    if any(line.get_color() == MUTED for line in lines.values()):
        jump = " in a single jump" if result.grew_in_steps else ""
        caption += f" The grey line adds what the last stage would wear off{jump}; none ran on it."
    if any(axes.get_yscale() == "log" for axes in grid.flat):
        caption += " The scale is logarithmic where the peaks differ much; lower depths are cut."
    return [Drawing("wear-depth.png", "Wear depth", caption, sheet)]


def _legend_line(curve: _Curve) -> Line2D:
    return Line2D([], [], color=curve.colour, linestyle=curve.dashes, label=curve.label)


def _draw_depth(axes: Axes, angle: Array, curves: list[_Curve]) -> None:
    peaks = [MICRONS * float(curve.depth.max()) for curve in curves]
    for curve in curves:
        width = 0.9 if curve.colour == MUTED else 1.2
        axes.plot(
            np.degrees(angle),
            MICRONS * curve.depth,
            color=curve.colour,
            linestyle=curve.dashes,
            linewidth=width,
        )
    axes.set_xlim(0.0, 360.0)
    axes.xaxis.set_major_locator(MultipleLocator(60.0))
    if peaks and max(peaks) > _LINEAR_RATIO * min(peaks):
        axes.set_yscale("log", nonpositive="mask")
        axes.set_ylim(min(peaks) / 100.0, 2.0 * max(peaks))
    else:
        axes.set_ylim(0.0, None)
