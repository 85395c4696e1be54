"""Figures over a bifurcation parameter: pin directions, exponent and period; order amplitudes."""

import matplotlib
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import MaxNLocator

from presswear.analysis.bifurcation import Diagram
from presswear.show.figures.style import (
    LINES,
    REFERENCE,
    SETTINGS,
    WIDTH,
    Drawing,
    Pen,
    Sheet,
    captioned,
    legend,
)
from presswear.tools.numbers import unit_scale

DIRECTION_LABELS = {"up": "increasing", "down": "decreasing"}
MARKERS = {"up": "^", "down": "v"}
NO_PERIOD = 0.0  # ordinate of a motion without period
DYNAMIC_RANGE = 1e-4  # smallest amplitude shown, relative to the largest
DOT_AREA = 4000.0  # area of all dots of a branch, square points
MIN_PERIOD_AXIS = 4.0  # smallest upper end of the period axis


def _axis(diagram: Diagram) -> tuple[float, str]:
    """Return the factor from SI and the label of the parameter axis."""
    parameter = diagram.parameter
    factor, unit = unit_scale(parameter.unit, parameter.values[-1])
    return factor, f"{parameter.key} ({unit})" if unit else parameter.key


def draw_diagram(diagram: Diagram) -> Drawing:
    """Return the bifurcation diagram with both branches."""
    with matplotlib.rc_context(SETTINGS):
        return _diagram(diagram)


def _diagram(diagram: Diagram) -> Drawing:
    parameter, cycles = diagram.parameter, diagram.cycles
    joints, has_exponent = diagram.scene.clearance_joints, diagram.cycles.exponent > 0
    count = len(joints) + 1 + has_exponent
    sheet = Sheet(figsize=(WIDTH, 0.8 + 1.9 * count), layout="constrained")
    panels = sheet.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    pens = []
    factor, label = _axis(diagram)
    size = float(np.clip(DOT_AREA / (len(parameter.values) * cycles.stored), 0.6, 6.0))
    for (direction, branch), (colour, _) in zip(diagram.branches.items(), LINES, strict=False):
        pens.append(Pen(f"{DIRECTION_LABELS[direction]} {parameter.key}", colour))
        value = factor * branch.value
        for k, axes in enumerate(panels[: len(joints)]):
            x, y = np.moveaxis(branch.eccentricity(k)[:, :, -1], -1, 0)
            angle = np.degrees(np.arctan2(y, x))
            values = np.repeat(value[:, None], angle.shape[1], axis=1)
            axes.scatter(values, angle, s=size, color=colour, linewidths=0.0, rasterized=True)
        if has_exponent:
            order = np.argsort(value)
            mean, half = branch.exponent[order].T
            look = {"color": colour, "alpha": 0.2, "linewidth": 0.0}
            panels[-2].fill_between(value[order], mean - half, mean + half, **look)
            panels[-2].plot(value[order], mean, color=colour, linewidth=0.8)
        periods = [
            np.nan if each is None else (each.period or NO_PERIOD)
            for each in diagram.periods(direction)
        ]
        panels[-1].plot(
            value,
            periods,
            MARKERS[direction],
            color=colour,
            markersize=3.0,
            fillstyle="none",
            markeredgewidth=0.5,
        )
    for axes, joint in zip(panels, joints, strict=False):
        axes.set_ylabel(f"direction of the pin\nin joint {joint} (degrees)")
        axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1.0, 1.5, 3.0, 4.5, 9.0, 10.0]))
    if has_exponent:
        panels[-2].axhline(0.0, color=REFERENCE, linewidth=0.7)
        panels[-2].set_ylabel("largest Lyapunov\nexponent (1/s)")
    panels[-1].set_ylabel("period (cycles);\n0: no period")
    panels[-1].set_ylim(-0.5, max(MIN_PERIOD_AXIS, panels[-1].get_ylim()[1]) + 0.5)
    panels[-1].yaxis.set_major_locator(MaxNLocator(5, integer=True))
    panels[-1].set_xlabel(label)
    legend(sheet, pens, "outside upper center")
    return captioned(
        "diagram",
        sheet,
        parameter=parameter,
        cycles=cycles,
        has_exponent=has_exponent,
        summary=diagram.summary(),
    )


def draw_orders(diagram: Diagram) -> Drawing:
    """Return the amplitudes at the orders of the crank, one column for each branch."""
    with matplotlib.rc_context(SETTINGS):
        return _orders(diagram)


def _orders(diagram: Diagram) -> Drawing:
    joints, branches = diagram.scene.clearance_joints, diagram.branches
    count = 1 + len(joints)
    sheet = Sheet(figsize=(WIDTH, 0.9 + 2.2 * count), layout="constrained")
    grid = sheet.subplots(count, len(branches), squeeze=False, sharex=True, sharey=True)
    factor, label = _axis(diagram)
    ring = Pen("contact resonance", REFERENCE, (0.0, (6.0, 1.2, 1.5, 1.2)), 0.9)
    names = [f"acceleration of the\n{diagram.scene.output} (m/s²)"]
    names += [f"force at {joint} (N)" for joint in joints]
    for k, panels in enumerate(grid):
        amplitudes = [branch.amplitude[:, k] for branch in branches.values()]
        largest = max(float(np.nanmax(each, initial=0.0)) for each in amplitudes) or 1.0
        for axes, branch, amplitude in zip(panels, branches.values(), amplitudes, strict=True):
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
        panels[0].set_ylabel("order (multiples of\nthe crank frequency)")
        sheet.colorbar(image, ax=panels.tolist(), label=f"amplitude:\n{names[k]}", pad=0.01)
    for axes, direction in zip(grid[0], branches, strict=True):
        axes.set_title(f"{DIRECTION_LABELS[direction]} {diagram.parameter.key}")
    for axes in grid[-1]:
        axes.set_xlabel(label)
    legend(sheet, [ring], "outside upper center")
    return captioned("orders", sheet, parameter=diagram.parameter, cycles=diagram.cycles)
