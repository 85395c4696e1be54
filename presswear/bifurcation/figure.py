"""Figure of a bifurcation diagram: places once a cycle, exponent and period over a quantity."""

from typing import Any

import matplotlib
import numpy as np
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
_LEAST = 4.0
"""Highest period up to which the axis goes at least."""


def draw(diagram: Diagram) -> Drawing:
    """Both branches of a diagram, in the text width of a page."""
    with matplotlib.rc_context(SETTINGS):
        return _draw(diagram)


def _draw(diagram: Diagram) -> Drawing:
    over, joints = diagram.over, diagram.scene.clearance_joints
    has_exponent = diagram.extent.exponent_cycles > 0
    count = len(joints) + 1 + has_exponent
    sheet = Sheet(figsize=(WIDTH, 0.8 + 1.9 * count), layout="constrained")
    panels = sheet.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    pens = []
    factor, unit = unit_scale(over.unit, over.high)
    for (way, points), (colour, _) in zip(diagram.branches.items(), LINES, strict=False):
        pens.append(Pen(f"{_WORDS[way]} {over.key}", colour))
        for k, axes in enumerate(panels[: len(joints)]):
            x, y = np.moveaxis(points.eccentricity(k)[:, :, -1], -1, 0)
            angle = np.degrees(np.arctan2(y, x))
            value = np.repeat(factor * points.value[:, None], angle.shape[1], axis=1)
            axes.scatter(value, angle, s=0.6, color=colour, linewidths=0.0, rasterized=True)
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
        axes.set_ylim(-180.0, 180.0)
        axes.set_yticks(np.arange(-180.0, 181.0, 90.0))
    if has_exponent:
        panels[-2].axhline(0.0, color=REFERENCE, linewidth=0.7)
        panels[-2].set_ylabel("largest Lyapunov\nexponent (1/s)")
    panels[-1].set_ylabel("period (cycles);\n0: none found")
    panels[-1].set_ylim(-0.5, max(_LEAST, panels[-1].get_ylim()[1]) + 0.5)
    panels[-1].yaxis.set_major_locator(MaxNLocator(5, integer=True))
    panels[-1].set_xlabel(f"{over.key}" + (f" ({unit})" if unit else ""))
    legend(sheet, pens, "outside upper center")
    caption = (
        f"The last {diagram.extent.kept} of {diagram.extent.cycles} cycles at each of "
        f"{over.count} values, each run begun where the last one ended: direction of each pin from "
        "the centre of its bearing at the end of every cycle"
    )
    caption += ", the largest exponent with its 95 % interval," if has_exponent else ""
    caption += f" and the period. {' '.join(diagram.words)}"
    return Drawing("diagram.png", f"Bifurcation over {over.key}", caption, sheet)
