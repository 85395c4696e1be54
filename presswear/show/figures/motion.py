"""Figures of motion: slider response, contact forces, paths of the pin centres."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from presswear.results.result import Result
from presswear.scene.ideal import ideal_slider
from presswear.scene.scene import Scene
from presswear.show.figures.style import (
    REFERENCE,
    SIDES,
    WIDTH,
    Array,
    Axes,
    Drawing,
    Sheet,
    ShownStage,
    length_scale,
    maps_turn,
    moving_stages,
    note,
    shown_time,
    shown_time_text,
)
from presswear.tools.numbers import readable

_MEANS_PER_CYCLE = 50
"""Intervals in a cycle over which the acceleration is averaged."""
_TALLEST = 9.6
"""Greatest height that fits an A4 page with its caption, inches."""
IDEAL_DASHES = (0.0, (4.0, 2.0))
"""Of the ideal motion and of the round gap."""
_LIMIT: dict[str, Any] = {"color": REFERENCE, "linewidth": 0.7}


def response(result: Result) -> list[Drawing]:
    """Displacement, velocity and acceleration of the slider against the ideal."""
    stages = moving_stages(result)
    if not stages:
        return []
    end = shown_time(result)
    time = np.linspace(0.0, end, 2001)
    ideal = ideal_slider(result.scene, time)
    with_impacts = bool(result.scene.clearance_joints)
    heights = [1.25, 1.0, 1.25] + [0.95] * len(stages) + [1.25] * with_impacts
    inches = min(1.15, (_TALLEST - 0.9) / sum(heights))
    sheet = Sheet(figsize=(WIDTH, 0.9 + inches * sum(heights)), layout="constrained")
    panels = sheet.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    _draw_displacements(panels[:2], result.scene, stages, time, ideal[:, 0])
    for stage in stages:
        draw_stage(panels[2], stage, stage.early(end), stage.arrays["slider"][:, 1])
    draw_ideal(panels[2], time, ideal[:, 1])
    panels[2].set_ylabel("velocity\n(m/s)")
    _draw_accelerations(panels[3 : 3 + len(stages)], stages, time, ideal[:, 2])
    caption = f"The slider over {shown_time_text(result)}, against the ideal motion in closed form."
    if with_impacts:
        interval = result.scene.mechanism.period / _MEANS_PER_CYCLE
        _draw_mean_accelerations(panels[-1], stages, time, ideal[:, 1], interval)
        caption += (
            " Impacts dwarf the ideal acceleration: each stage has a panel of its own on one "
            f"common scale; the lowest panel shows means over {readable(1e3 * interval, 2)} ms, in "
            "which the motion between the impacts is seen."
        )
    panels[-1].set_xlabel("time (s)")
    panels[-1].set_xlim(0.0, end)
    sheet.align_ylabels()
    handles = [Line2D([], [], color=REFERENCE, linestyle=IDEAL_DASHES, label="ideal")]
    handles += [
        Line2D([], [], color=stage.colour, linestyle=stage.dashes, label=stage.label)
        for stage in stages
    ]
    sheet.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return [Drawing("response.png", "Motion of the slider", caption, sheet)]


def draw_stage(axes: Axes, stage: ShownStage, rows: slice, values: Array) -> None:
    """Values of a stage over some rows of its time."""
    axes.plot(
        stage.arrays["time"][rows],
        values[rows],
        color=stage.colour,
        linestyle=stage.dashes,
        linewidth=0.9,
    )


def draw_ideal(axes: Axes, time: Array, values: Array) -> None:
    """Values of the ideal motion."""
    axes.plot(time, values, color=REFERENCE, linestyle=IDEAL_DASHES, linewidth=0.9)


def _draw_displacements(
    panels: Sequence[Axes], scene: Scene, stages: list[ShownStage], time: Array, ideal: Array
) -> None:
    """The displacement, and what it differs from the ideal."""
    end = float(time[-1])
    shown = [stage.early(end) for stage in stages]
    deviations = [
        stage.arrays["slider"][:, 0] - ideal_slider(scene, stage.arrays["time"])[:, 0]
        for stage in stages
    ]
    largest = max(
        float(np.abs(values[rows]).max()) for values, rows in zip(deviations, shown, strict=True)
    )
    factor, unit = length_scale(largest)
    for stage, rows, deviation in zip(stages, shown, deviations, strict=True):
        draw_stage(panels[0], stage, rows, stage.arrays["slider"][:, 0])
        draw_stage(panels[1], stage, rows, factor * deviation)
    draw_ideal(panels[0], time, ideal)
    draw_ideal(panels[1], time, np.zeros_like(time))
    panels[0].set_ylabel("displacement\n(m)")
    panels[1].set_ylabel(f"displacement\nless ideal ({unit})")


def _draw_accelerations(
    panels: Sequence[Axes], stages: list[ShownStage], time: Array, ideal: Array
) -> None:
    """One panel a stage on a common scale."""
    low, high = float(ideal.min()), float(ideal.max())
    for axes, stage in zip(panels, stages, strict=True):
        rows = stage.early(float(time[-1]))
        values = stage.arrays["slider"][rows, 2]
        axes.plot(stage.arrays["time"][rows], values, color=stage.colour, linewidth=0.7)
        draw_ideal(axes, time, ideal)
        axes.set_ylabel("acceleration\n(m/s²)")
        note(axes, f"{stage.label}, largest {readable(float(np.abs(values).max()))} m/s²")
        low, high = min(low, float(values.min())), max(high, float(values.max()))
    for axes in panels:
        axes.set_ylim(low - 0.05 * (high - low), high + 0.3 * (high - low))


def _draw_mean_accelerations(
    axes: Axes, stages: list[ShownStage], time: Array, ideal_velocity: Array, interval: float
) -> None:
    """Acceleration as the mean over an interval, s: the difference of velocity over it."""
    middle = time[(time >= 0.5 * interval) & (time <= time[-1] - 0.5 * interval)]

    def mean(times: Array, velocity: Array) -> Array:
        before, after = (np.interp(middle + s * interval, times, velocity) for s in (-0.5, 0.5))
        return np.asarray((after - before) / interval)

    for stage in stages:
        values = mean(stage.arrays["time"], stage.arrays["slider"][:, 1])
        axes.plot(middle, values, color=stage.colour, linestyle=stage.dashes, linewidth=0.8)
    draw_ideal(axes, middle, mean(time, ideal_velocity))
    axes.set_ylabel(f"acceleration,\n{readable(1e3 * interval, 2)} ms mean\n(m/s²)")


def contact_force(result: Result) -> list[Drawing]:
    """Normal force at each clearance joint over time, a panel for each stage."""
    joints = result.scene.clearance_joints
    stages = moving_stages(result)
    if not joints or not stages:
        return []
    end = shown_time(result)
    size = (WIDTH, 0.5 + 1.35 * len(stages))
    sheet = Sheet(figsize=size, layout="constrained")
    grid = sheet.subplots(len(stages), len(joints), squeeze=False, sharex=True, sharey="col")
    for column, joint in zip(grid.T, joints, strict=True):
        largest = 0.0
        for axes, stage in zip(column, stages, strict=True):
            rows = stage.early(end)
            force = stage.arrays[f"{joint}_force"][rows, 0]
            axes.plot(stage.arrays["time"][rows], force, color=stage.colour, linewidth=0.7)
            axes.set_ylabel("normal force (N)")
            note(axes, f"{stage.label}, largest {readable(float(force.max()))} N")
            largest = max(largest, float(force.max()))
        column[0].set_title(f"joint {joint}", loc="left", fontweight="bold")
        column[0].set_ylim(0.0, 1.25 * largest if largest > 0.0 else 1.0)
        column[-1].set_xlabel("time (s)")
        column[-1].set_xlim(0.0, end)
    caption = (
        f"Normal contact force over {shown_time_text(result)}; the same scale for all stages of a "
        "joint. The largest of all cycles is in the table of key numbers."
    )
    return [Drawing("contact-force.png", "Contact force", caption, sheet)]


def centre_trajectory(result: Result) -> list[Drawing]:
    """Path of each pin's centre inside its bearing, a panel for each stage."""
    joints = result.scene.clearance_joints
    stages = moving_stages(result)
    if not joints or not stages:
        return []
    side = (WIDTH - 0.9) / max(len(stages), 2) - 0.1
    sheet = Sheet(figsize=(WIDTH, 0.95 + (side + 0.1) * len(joints)), layout="constrained")
    grid = sheet.subplots(len(joints), len(stages), squeeze=False, sharex=True, sharey=True)
    clearance = result.scene.bearings.clearance
    factor, unit = length_scale(clearance)
    limits = {
        (joint, stage.index): gap_limit(result, joint, stage)
        for joint in joints
        for stage in stages
    }
    widest = clearance
    for row, joint in zip(grid, joints, strict=True):
        for axes, stage in zip(row, stages, strict=True):
            path = stage.arrays[f"{joint}_eccentricity"][stage.early(shown_time(result))]
            limit = limits[joint, stage.index]
            reach = draw_path(axes, path, limit, clearance, factor, stage.colour)
            widest = max(widest, reach)
        row[0].set_ylabel(f"joint {joint}\n$e_y$ ({unit})")
    for axes, stage in zip(grid[0], stages, strict=True):
        axes.set_title(stage.label)
    for axes in grid[-1]:
        axes.set_xlabel(f"$e_x$ ({unit})")
    set_path_limits(grid.flat, 1.06 * factor * widest)
    handles = [circle_line(f"clearance circle, c = {readable(factor * clearance)} {unit}")]
    caption = (
        f"Centre of the pin from the centre of its bearing over {shown_time_text(result)}, in "
        "fixed directions. It starts in the middle."
    )
    if any(limit.size for limit in limits.values()):
        handles.append(limit_line())
    elif any(np.any(s.depth(j, side) > 0.0) for s in stages for j in joints for side in SIDES):
        caption += " Worn surfaces turn with their bodies, so that no fixed line bounds the path."
    sheet.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return [Drawing("centre-trajectory.png", "Path of the pin centre", caption, sheet)]


def draw_path(
    axes: Axes, path: Array, limit: Array, clearance: float, factor: float, colour: str
) -> float:
    """Path of a pin's centre, shape (n, 2), m, with what bounds it; returns how far all reach, m.

    Parameters
    ----------
    limit : ndarray, shape (2, n)
        As ``gap_limit`` gives it.
    factor : float
        Units of the axes in a metre.
    """
    axes.plot(*(factor * path.T), color=colour, linewidth=0.5)
    axes.plot(*(factor * _circle(clearance)), linestyle=IDEAL_DASHES, **_LIMIT)
    axes.plot(*(factor * limit), **_LIMIT)
    return max(clearance, float(np.hypot(*np.hstack([path.T, limit])).max(initial=0.0)))


def set_path_limits(panels: Iterable[Axes], edge: float) -> None:
    """One square range, in the units of the axes, for all paths."""
    for axes in panels:
        axes.set_xlim(-edge, edge)
        axes.set_ylim(-edge, edge)
        axes.set_aspect("equal")
        axes.xaxis.set_major_locator(MaxNLocator(4, symmetric=True))
        axes.yaxis.set_major_locator(MaxNLocator(4, symmetric=True))


def circle_line(label: str) -> Line2D:
    """The clearance circle in a legend."""
    return Line2D([], [], linestyle=IDEAL_DASHES, label=label, **_LIMIT)


def limit_line() -> Line2D:
    """The limit of the gap in a legend."""
    return Line2D([], [], label="gap limit, c + wear depths", **_LIMIT)


def _circle(radius: float) -> Array:
    """A circle about the centre, m, shape (2, n)."""
    around = np.linspace(0.0, 2.0 * math.pi, 361)
    return radius * np.array([np.cos(around), np.sin(around)])


def gap_limit(result: Result, joint: str, stage: ShownStage) -> Array:
    """How far the pin's centre can go, m, shape (2, n); empty where no fixed line says it."""
    depth = stage.depth(joint, "bearing") + stage.depth(joint, "pin")
    if maps_turn(result) or not np.any(depth > 0.0):
        return np.zeros((2, 0))
    angle = np.append(stage.arrays["angle"], stage.arrays["angle"][0])
    gap = result.scene.bearings.clearance + np.append(depth, depth[0])
    return gap * np.array([np.cos(angle), np.sin(angle)])
