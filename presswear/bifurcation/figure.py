"""Figures over a quantity: places once a cycle with exponent and period, and the orders."""

from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import MaxNLocator

from presswear.bifurcation.diagram import Diagram
from presswear.show.figures.style import (
    LINES,
    REFERENCE,
    SETTINGS,
    WIDTH,
    Drawing,
    Pen,
    Sheet,
    legend,
    unit_scale,
)

_WORDS = {"up": "rising", "down": "falling"}
_NONE = 0.0
"""Height at which a motion without period is drawn."""
_MARKS = {"up": "^", "down": "v"}
_LOOK: dict[str, Any] = {"markersize": 3.0, "fillstyle": "none", "markeredgewidth": 0.5}
_RANGE = 1e-4
"""Smallest amplitude that is told apart, part of the greatest."""
_DOTS = 4000.0
"""Area of all dots of a branch, square points: few are larger."""
_LEAST = 4.0
"""Highest period up to which the axis goes at least."""


def draw(diagram: Diagram) -> Drawing:
    """Both branches of a diagram, in the text width of a page."""
    with matplotlib.rc_context(SETTINGS):
        return _draw(diagram)


def draw_orders(diagram: Diagram) -> Drawing:
    """Amplitudes at the crank's orders, a column for each branch."""
    with matplotlib.rc_context(SETTINGS):
        return _draw_orders(diagram)


def _draw_orders(diagram: Diagram) -> Drawing:
    over, joints = diagram.over, diagram.scene.clearance_joints
    count = 1 + len(joints)
    sheet = Sheet(figsize=(WIDTH, 0.9 + 2.2 * count), layout="constrained")
    grid = sheet.subplots(count, len(diagram.branches), squeeze=False, sharex=True, sharey=True)
    factor, _ = unit_scale(over.unit, over.values[-1])
    ring = Pen("contact resonance", REFERENCE, (0.0, (6.0, 1.2, 1.5, 1.2)), 0.9)
    names = [f"acceleration of the\n{diagram.scene.watched} (m/s²)"]
    names += [f"force at {joint} (N)" for joint in joints]
    for k, row in enumerate(grid):
        own = [points.amplitude[:, k] for points in diagram.branches.values()]
        greatest = max(float(np.nanmax(values, initial=0.0)) for values in own) or 1.0
        for axes, points, values in zip(row, diagram.branches.values(), own, strict=True):
            rising = np.argsort(points.value)
            at = factor * points.value[rising]
            shown = axes.pcolormesh(
                at,
                np.arange(1, values.shape[1] + 1),
                np.maximum(values[rising].T, _RANGE * greatest),
                norm=LogNorm(_RANGE * greatest, greatest),
                cmap="cividis",
                shading="nearest",
                rasterized=True,
            )
            if k > 0:
                ring.draw(axes, at, points.resonance[rising, k - 1])
            axes.set_yscale("log")
            axes.set_ylim(0.5, values.shape[1])
            axes.grid(False)
        row[0].set_ylabel("order (turns\nof the crank)")
        sheet.colorbar(shown, ax=row.tolist(), label=f"amplitude:\n{names[k]}", pad=0.01)
    for axes, way in zip(grid[0], diagram.branches, strict=True):
        axes.set_title(f"{_WORDS[way]} {over.key}")
    for axes in grid[-1]:
        axes.set_xlabel(_label(diagram))
    legend(sheet, [ring], "outside upper center")
    caption = (
        "Amplitudes within half an order of the crank's harmonics, in "
        f"{diagram.extent.order_cycles} cycles at each of {len(over.values)} values, by Welch's "
        "method. Dash-dotted: the order at which the contacts of the joint ring, by one over twice "
        "their median impact, where there are any."
    )
    return Drawing("orders.png", f"Orders over {over.key}", caption, sheet)


def _label(diagram: Diagram) -> str:
    """Label of the axis of the quantity."""
    over = diagram.over
    unit = unit_scale(over.unit, over.values[-1])[1]
    return f"{over.key} ({unit})" if unit else over.key


def _draw(diagram: Diagram) -> Drawing:
    over, joints = diagram.over, diagram.scene.clearance_joints
    has_exponent = diagram.extent.exponent_cycles > 0
    count = len(joints) + 1 + has_exponent
    sheet = Sheet(figsize=(WIDTH, 0.8 + 1.9 * count), layout="constrained")
    panels = sheet.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    pens = []
    factor, _ = unit_scale(over.unit, over.values[-1])
    size = float(np.clip(_DOTS / (len(over.values) * diagram.extent.kept), 0.6, 6.0))
    for (way, points), (colour, _) in zip(diagram.branches.items(), LINES, strict=False):
        pens.append(Pen(f"{_WORDS[way]} {over.key}", colour))
        for k, axes in enumerate(panels[: len(joints)]):
            x, y = np.moveaxis(points.eccentricity(k)[:, :, -1], -1, 0)
            angle = np.degrees(np.arctan2(y, x))
            value = np.repeat(factor * points.value[:, None], angle.shape[1], axis=1)
            axes.scatter(value, angle, s=size, color=colour, linewidths=0.0, rasterized=True)
        if has_exponent:
            low, high = (points.exponent[:, 0] + s * points.exponent[:, 1] for s in (-1.0, 1.0))
            order = np.argsort(factor * points.value)
            panels[-2].fill_between(
                factor * points.value[order],
                low[order],
                high[order],
                color=colour,
                alpha=0.2,
                linewidth=0.0,
            )
            panels[-2].plot(
                factor * points.value[order], points.exponent[order, 0], color=colour, linewidth=0.8
            )
        periods = [np.nan if own is None else (own.period or _NONE) for own in diagram.periods(way)]
        panels[-1].plot(factor * points.value, periods, _MARKS[way], color=colour, **_LOOK)
    for axes, joint in zip(panels, joints, strict=False):
        axes.set_ylabel(f"direction of the pin\nin joint {joint} (degrees)")
        axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1.0, 1.5, 3.0, 4.5, 9.0, 10.0]))
    if has_exponent:
        panels[-2].axhline(0.0, color=REFERENCE, linewidth=0.7)
        panels[-2].set_ylabel("largest Lyapunov\nexponent (1/s)")
    panels[-1].set_ylabel("period (cycles);\n0: none found")
    panels[-1].set_ylim(-0.5, max(_LEAST, panels[-1].get_ylim()[1]) + 0.5)
    panels[-1].yaxis.set_major_locator(MaxNLocator(5, integer=True))
    panels[-1].set_xlabel(_label(diagram))
    legend(sheet, pens, "outside upper center")
    caption = (
        f"The last {diagram.extent.kept} of {diagram.extent.cycles} cycles at each of "
        f"{len(over.values)} values, each run begun where the last one ended: direction of each "
        "pin from the centre of its bearing at the end of every cycle"
    )
    caption += ", the largest exponent with its 95 % interval," if has_exponent else ""
    caption += f" and the period. {' '.join(diagram.words)}"
    return Drawing("diagram.png", f"Bifurcation over {over.key}", caption, sheet)
