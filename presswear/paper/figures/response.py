"""Figures 17 to 25: motion of the slider, contact forces and paths of the pin centres."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import SubFigure
from matplotlib.lines import Line2D

from presswear.paper.evidence import Evidence
from presswear.paper.figures.lines import (
    MILLIMETRES,
    ONE_CYCLE,
    Drawn,
    Lines,
    ShownLine,
    joint_title,
    shown_cycles,
    shown_joints,
)
from presswear.paper.figures.peaks import ROW, PeakPanel, draw_peaks, sheet_over_peaks
from presswear.scene.scene import stage_name
from presswear.show.figures.motion import (
    IDEAL,
    draw_path,
    gap_limit,
    path_pens,
    set_path_limits,
)
from presswear.show.figures.style import WIDTH, Array, Axes, Sheet, legend, note
from presswear.tools.numbers import readable

_QUANTITIES = (("displacement", "m"), ("velocity", "m/s"), ("acceleration", "m/s²"))
_HEIGHTS = (1.15, 0.95, 1.15)
"""Heights of displacement, its distance from the ideal, and velocity, inches."""
_ACCELERATION_HEIGHT = 1.05
_BESIDE = 3
"""Most lines whose names fit beside each other."""


def responses(evidence: Evidence, number: int, lines: Lines) -> Drawn:
    """The slider over one cycle against the ideal motion, and its peaks over all cycles."""
    shown = shown_cycles(evidence, lines)
    if not shown:
        return None
    columns = _columns(number, shown)
    rows = max(len(column) for column in columns.values())
    upper = sum(_HEIGHTS) + _ACCELERATION_HEIGHT * rows + 0.75
    sheet, top, bottom = sheet_over_peaks(upper, 0.95 + ROW * len(shown))
    _draw_motion(top, columns, rows)
    handles = [IDEAL.handle()]
    if len(shown) > _BESIDE:
        # Legends fill their columns downwards: the lines of a setting one below the other.
        handles.append(Line2D([], [], linestyle="none", label=" "))
    handles += [one.line.pen(one.line.name).handle() for one in shown]
    columns_of_legend = len(handles) if len(shown) <= _BESIDE else -(-len(handles) // 2)
    top.legend(handles=handles, loc="outside upper center", ncols=columns_of_legend)
    ideal = zip(*map(_ideal_peaks, shown), strict=True)
    panels = [
        PeakPanel(name, f"largest {name}\nof a cycle ({unit})", ideal=peaks)
        for (name, unit), peaks in zip(_QUANTITIES, ideal, strict=True)
    ]
    caption = (
        f"Time histories: {ONE_CYCLE}. Dashed: the ideal motion in closed form; the second row "
        "shows how far the displacement is from it. Each panel of acceleration has its own scale, "
        "for impacts dwarf the ideal acceleration, and names its largest value of either sign. "
        + draw_peaks(bottom, evidence, number, shown, panels)
    )
    return caption, sheet


def _columns(number: int, shown: Sequence[ShownLine]) -> dict[str, list[ShownLine]]:
    """Panels beside each other with their titles: one for each speed, or stage, or one at all."""
    columns: dict[str, list[ShownLine]] = {}
    for one in shown:
        title = {20: stage_name(one.line.wear_updates), 23: one.line.own}.get(number, "")
        columns.setdefault(title, []).append(one)
    return columns


def _draw_motion(sheet: SubFigure, columns: dict[str, list[ShownLine]], rows: int) -> None:
    """Time histories: three rows for all lines of a column, and one for each acceleration."""
    grid = sheet.subplots(
        3 + rows,
        len(columns),
        squeeze=False,
        sharex="col",
        height_ratios=(*_HEIGHTS, *[_ACCELERATION_HEIGHT] * rows),
    )
    for row in grid[:3]:
        for axes in row[1:]:
            axes.sharey(row[0])
            axes.tick_params(labelleft=False)
    for column, (title, shown) in zip(grid.T, columns.items(), strict=True):
        _draw_column(column, shown)
        column[0].set_title(title, loc="left", fontweight="bold")
        for spare in column[3 + len(shown) :]:
            spare.set_axis_off()
        # Where a panel is missing below, the lowest one names the time.
        lowest = column[2 + len(shown)]
        lowest.set_xlabel("time (s)")
        lowest.tick_params(labelbottom=True)
    first = grid[:, 0]
    labels = ["displacement\n(m)", "displacement\nless ideal (mm)", "velocity\n(m/s)"]
    for axes, text in zip(first, [*labels, *["acceleration\n(m/s²)"] * rows], strict=True):
        axes.set_ylabel(text)
    # Letters as in the paper.
    white = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0}
    look: dict[str, Any] = {"ha": "left", "va": "top", "fontweight": "bold", "bbox": white}
    for axes, letter in zip(first[[0, 2, 3]], "abc", strict=True):
        axes.text(0.008, 0.95, letter, transform=axes.transAxes, **look)
    sheet.align_ylabels(list(first))


def _draw_column(panels: Sequence[Axes], shown: Sequence[ShownLine]) -> None:
    period = max(one.period for one in shown)
    time = np.linspace(0.0, period, 1001)
    ideal = shown[0].result.scene.ideal_slider(time)
    for one in shown:
        stage, pen = one.stage, one.line.pen("")
        off = stage.displacement - one.result.scene.ideal_slider(stage.time)[:, 0]
        drawn = (stage.displacement, MILLIMETRES * off, stage.velocity)
        for axes, values in zip(panels, drawn, strict=False):
            pen.draw(axes, stage.time, values, linewidth=0.9)
    for axes, values in zip(panels, (ideal[:, 0], 0.0 * time, ideal[:, 1]), strict=False):
        IDEAL.draw(axes, time, values, linewidth=0.9)
    for axes, one in zip(panels[3:], shown, strict=False):
        _draw_acceleration(axes, one, time, ideal[:, 2])
    panels[0].set_xlim(0.0, period)


def _draw_acceleration(axes: Axes, one: ShownLine, time: Array, ideal: Array) -> None:
    values = one.stage.acceleration
    axes.plot(one.stage.time, values, color=one.line.colour, linewidth=0.7)
    IDEAL.draw(axes, time, ideal, linewidth=0.9)
    low, high = (float(end(np.append(values, ideal))) for end in (np.min, np.max))
    axes.set_ylim(low - 0.05 * (high - low), high + 0.4 * (high - low))
    note(axes, f"{one.line.name}, largest {readable(one.peak('acceleration'))} m/s²")


def _ideal_peaks(one: ShownLine) -> tuple[float, ...]:
    """Largest values of the ideal motion in a cycle; the acceleration's has either sign."""
    values = one.result.scene.ideal_slider(np.linspace(0.0, one.period, 2001))
    values[:, 2] = np.abs(values[:, 2])
    return tuple(map(float, values.max(axis=0)))


def contact_forces(evidence: Evidence, number: int, lines: Lines) -> Drawn:
    """Normal force over one cycle, and its peaks over all cycles."""
    shown = shown_cycles(evidence, lines)
    joints = shown_joints(shown)
    if not shown or not joints:
        return None
    sheet, top, bottom = sheet_over_peaks(0.5 + 1.2 * len(shown), 0.85 + ROW * len(shown))
    _draw_forces(top, shown, joints)
    panels = [
        PeakPanel("force", f"largest force at {joint} in a cycle (N)", joint) for joint in joints
    ]
    caption = (
        f"Normal contact force over time: {ONE_CYCLE}. Each panel has its own scale and names its "
        f"largest force. {draw_peaks(bottom, evidence, number, shown, panels)}"
    )
    return caption, sheet


def _draw_forces(sheet: SubFigure, shown: Sequence[ShownLine], joints: Sequence[str]) -> None:
    grid = sheet.subplots(len(shown), len(joints), squeeze=False)
    for row, one in zip(grid, shown, strict=True):
        for axes, joint in zip(row, joints, strict=True):
            _draw_force(axes, one, joint)
        row[0].set_ylabel("normal force (N)")
    for column, joint in zip(grid.T, joints, strict=True):
        column[0].set_title(joint_title(joint), loc="left", fontweight="bold")
        for k, axes in enumerate(column):
            # Times are named again where the period changes.
            last = k == len(shown) - 1 or shown[k + 1].period != shown[k].period
            axes.tick_params(labelbottom=last)
            if last:
                axes.set_xlabel("time (s)")
    sheet.align_ylabels(list(grid[:, 0]))


def _draw_force(axes: Axes, one: ShownLine, joint: str) -> None:
    force = one.stage.arrays[f"{joint}_force"][:, 0]
    axes.plot(one.stage.arrays["time"], force, color=one.line.colour, linewidth=0.7)
    largest = float(force.max())
    axes.set_xlim(0.0, one.period)
    axes.set_ylim(0.0, 1.35 * largest if largest > 0.0 else 1.0)
    note(axes, f"{one.line.name}, largest {readable(one.peak('force', joint))} N")


def centre_paths(evidence: Evidence, number: int, lines: Lines) -> Drawn:
    """Path of each pin's centre over one cycle, a panel for each line and joint."""
    shown = shown_cycles(evidence, lines)
    joints = shown_joints(shown)
    if not shown or not joints:
        return None
    side = (WIDTH - 0.9) / max(len(shown), 2) - 0.1
    sheet = Sheet(figsize=(WIDTH, 1.1 + (side + 0.1) * len(joints)), layout="constrained")
    grid = sheet.subplots(len(joints), len(shown), squeeze=False, sharex=True, sharey=True)
    clearance = shown[0].result.scene.bearings.clearance
    widest, bounded = clearance, False
    for row, joint in zip(grid, joints, strict=True):
        for axes, one in zip(row, shown, strict=True):
            path = one.stage.arrays[f"{joint}_eccentricity"]
            limit = gap_limit(one.result, joint, one.stage)
            reach = draw_path(axes, path, limit, clearance, MILLIMETRES, one.line.colour)
            widest, bounded = max(widest, reach), bounded or limit.size > 0
        row[0].set_ylabel(f"{joint_title(joint)}\n$e_y$ (mm)")
    for axes, one in zip(grid[0], shown, strict=True):
        axes.set_title(one.line.name.replace(", ", "\n"))
    for axes in grid[-1]:
        axes.set_xlabel("$e_x$ (mm)")
    set_path_limits(grid.flat, 1.06 * MILLIMETRES * widest)
    pens = path_pens(f"{readable(MILLIMETRES * clearance, 2)} mm", bounded)
    legend(sheet, pens, "outside upper center")
    caption = (
        "Centre of the pin from the centre of its bearing, in fixed directions, over "
        f"{ONE_CYCLE}. It starts in the middle. Dashed: how far the pin of a new joint can go; "
        "where it leaves the circle, it presses into the bearing or the bearing is worn."
    )
    return caption, sheet
