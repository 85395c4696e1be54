"""Figures over a bifurcation parameter: pin directions, exponent and period; order amplitudes."""

from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import MaxNLocator

from presswear.analysis.bifurcation import Diagram
from presswear.show.figures.style import LINES, REFERENCE, SETTINGS, Drawing, Pen, finished, panels
from presswear.tools.numbers import unit_scale

BRANCHES = {"up": ("increasing", "^"), "down": ("decreasing", "v")}  # word and marker
NO_PERIOD = 0.0  # ordinate of a motion without period
DYNAMIC_RANGE = 1e-4  # smallest amplitude shown, relative to the largest
DOT_AREA = 4000.0  # area of all dots of a branch, square points
MIN_PERIOD_AXIS = 4.0  # smallest upper end of the period axis


def _axis(diagram: Diagram) -> tuple[float, str]:
    """Return the factor from SI and the label of the parameter axis."""
    parameter = diagram.parameter
    factor, unit = unit_scale(parameter.unit, parameter.values[-1])
    return factor, f"{parameter.key} ({unit})" if unit else parameter.key


@matplotlib.rc_context(SETTINGS)
def draw_diagram(diagram: Diagram) -> Drawing:
    """Return the bifurcation diagram with both branches."""
    parameter, cycles, joints = diagram.parameter, diagram.cycles, diagram.scene.clearance_joints
    has_exponent = cycles.exponent > 0
    count = len(joints) + 1 + has_exponent
    sheet, grid = panels(count, 1, 0.8 + 1.9 * count, sharex=True)
    column, pens = grid[:, 0], []
    factor, label = _axis(diagram)
    size = float(np.clip(DOT_AREA / (len(parameter.values) * cycles.stored), 0.6, 6.0))
    for (direction, branch), (colour, _) in zip(diagram.branches.items(), LINES, strict=False):
        word, marker = BRANCHES[direction]
        pens.append(Pen(f"{word} {parameter.key}", colour))
        value = factor * branch.value
        for k, axes in enumerate(column[: len(joints)]):
            x, y = np.moveaxis(branch.pins[:, :, -1, k], -1, 0)
            angle = np.degrees(np.arctan2(y, x))
            values = np.repeat(value[:, None], angle.shape[1], axis=1)
            axes.scatter(values, angle, s=size, color=colour, linewidths=0.0, rasterized=True)
        if has_exponent:
            order = np.argsort(value)
            mean, half = branch.exponent[order].T
            look: dict[str, Any] = {"color": colour, "alpha": 0.2, "linewidth": 0.0}
            column[-2].fill_between(value[order], mean - half, mean + half, **look)
            column[-2].plot(value[order], mean, color=colour, linewidth=0.8)
        each = diagram.periods(direction)
        periods = [np.nan if one is None else (one.period or NO_PERIOD) for one in each]
        look = {"markersize": 3.0, "fillstyle": "none", "markeredgewidth": 0.5}
        column[-1].plot(value, periods, marker, color=colour, **look)
    for axes, joint in zip(column, joints, strict=False):
        axes.set_ylabel(f"direction of the pin\nin joint {joint} (degrees)")
        axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1.0, 1.5, 3.0, 4.5, 9.0, 10.0]))
    if has_exponent:
        column[-2].axhline(0.0, color=REFERENCE, linewidth=0.7)
        column[-2].set_ylabel("largest Lyapunov\nexponent (1/s)")
    column[-1].set_ylabel("period (cycles);\n0: no period")
    column[-1].set_ylim(-0.5, max(MIN_PERIOD_AXIS, column[-1].get_ylim()[1]) + 0.5)
    column[-1].yaxis.set_major_locator(MaxNLocator(5, integer=True))
    column[-1].set_xlabel(label)
    content: dict[str, Any] = {
        "parameter": parameter,
        "cycles": cycles,
        "summary": diagram.summary(),
    }
    (drawing,) = finished("diagram", sheet, pens, has_exponent=has_exponent, **content)
    return drawing


@matplotlib.rc_context(SETTINGS)
def draw_orders(diagram: Diagram) -> Drawing:
    """Return the amplitudes at the orders of the crank, one column for each branch."""
    joints, branches = diagram.scene.clearance_joints, diagram.branches
    count = 1 + len(joints)
    height = 0.9 + 2.2 * count
    sheet, grid = panels(count, len(branches), height, sharex=True, sharey=True)
    factor, label = _axis(diagram)
    ring = Pen("contact resonance", REFERENCE, (0.0, (6.0, 1.2, 1.5, 1.2)), 0.9)
    names = [f"acceleration of the\n{diagram.scene.output} (m/s²)"]
    names += [f"force at {joint} (N)" for joint in joints]
    for k, row in enumerate(grid):
        amplitudes = [branch.amplitude[:, k] for branch in branches.values()]
        largest = max(float(np.nanmax(each, initial=0.0)) for each in amplitudes) or 1.0
        for axes, branch, amplitude in zip(row, branches.values(), amplitudes, strict=True):
            order = np.argsort(branch.value)
            image = axes.pcolormesh(
                factor * branch.value[order],
                np.arange(1, amplitude.shape[1] + 1),
                np.maximum(amplitude[order].T, DYNAMIC_RANGE * largest),
                norm=LogNorm(DYNAMIC_RANGE * largest, largest),
                cmap="cividis",
                shading="nearest",
                rasterized=True,
            )
            if k > 0:
                ring.draw(axes, factor * branch.value[order], branch.resonance[order, k - 1])
            axes.set_yscale("log")
            axes.set_ylim(0.5, amplitude.shape[1])
            axes.grid(False)
        row[0].set_ylabel("order (multiples of\nthe crank frequency)")
        sheet.colorbar(image, ax=row.tolist(), label=f"amplitude:\n{names[k]}", pad=0.01)
    for axes, direction in zip(grid[0], branches, strict=True):
        axes.set_title(f"{BRANCHES[direction][0]} {diagram.parameter.key}")
    for axes in grid[-1]:
        axes.set_xlabel(label)
    content: dict[str, Any] = {"parameter": diagram.parameter, "cycles": diagram.cycles}
    return finished("orders", sheet, [ring], **content)[0]
