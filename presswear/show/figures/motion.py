"""Figures of motion: slider response, contact forces, paths of the pin centres."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.ticker import MaxNLocator, MultipleLocator

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult
from presswear.show.figures.style import (
    REFERENCE,
    SHOWN_CYCLES,
    WIDTH,
    Array,
    Axes,
    Drawing,
    Pen,
    Sheet,
    ShownStage,
    Stages,
    between,
    legend,
    maps_turn,
    note,
    shown_stages,
    wrapped,
)
from presswear.tools.numbers import readable, unit_scale

_MEANS_PER_CYCLE = 50
"""Intervals in a cycle over which the acceleration is averaged."""
_TALLEST = 9.6
"""Greatest height that fits an A4 page with its caption, inches."""
IDEAL = Pen("ideal", REFERENCE, (0.0, (4.0, 2.0)))
_ROUND_GAP = replace(IDEAL, width=0.7)
_LIMIT = Pen("gap limit, c + wear depths", REFERENCE, width=0.7)


def moving_stages(result: Result, stages: Stages) -> list[ShownStage]:
    """The shown stages that have a motion to show, each with the whole of it.

    One that failed has none: up to where it was ended its numbers are worth nothing.
    """
    return [
        stage
        for stage in shown_stages(result, stages)
        if not stage.data.failed and stage.data.time.size > 1
    ]


@dataclass(frozen=True)
class Window:
    """The part of the motion that is shown.

    Attributes
    ----------
    begin, end, period, run_up : float
        s.
    phase : str
        Name of the angle that is a whole turn in a cycle.
    words : str
        The part in words.
    """

    begin: float
    end: float
    period: float
    run_up: float
    phase: str
    words: str

    def label(self, axes: Axes) -> None:
        """Limit an axis of time to it, and mark the phase of the cycle there."""
        axes.set_xlim(self.begin, self.end)
        axes.xaxis.set_major_locator(MultipleLocator(0.25 * self.period))
        axes.xaxis.set_major_formatter(
            lambda time, place: f"{360.0 * (time - 0.5 * self.run_up) / self.period:.0f}"
        )
        axes.set_xlabel(f"{self.phase} since the start (degrees)")


def settled(result: Result, stages: Sequence[ShownStage]) -> tuple[list[ShownStage], Window]:
    """The stages over the part of the motion that is shown: cycles behind the start-up."""
    period, run_up = result.scene.mechanism.period, result.scene.run_up
    whole = [round((float(stage.data.time[-1]) - run_up) / period - 0.48) for stage in stages]
    first = max(min(STARTUP_CYCLES, min(whole) - 1), 0)
    begin = run_up + first * period
    last = max(float(stage.data.time[-1]) for stage in stages)
    end = min(begin + SHOWN_CYCLES * period, last)
    ran = (end - run_up) / period
    cycles = round(ran)
    if abs(ran - cycles) > 0.02:
        words = f"the first {ran:.2g} cycles"
    elif first:
        one = first + 1 == cycles
        words = f"cycle {cycles}" if one else f"cycles {first + 1} to {cycles}"
    else:
        words = "the first cycle, at the start" if cycles == 1 else f"the first {cycles} cycles"
    shown = [replace(stage, data=between(stage.data, begin, end)) for stage in stages]
    words = f"{words} of {1e3 * period:.0f} ms"
    if run_up > 0.0:
        words += " behind the run-up"
    phase = result.scene.mechanism.linkage().phase
    return shown, Window(begin, end, period, run_up, phase, words)


def response(result: Result, stages: Stages) -> list[Drawing]:
    """Displacement, velocity and acceleration of the slider against the ideal."""
    moving = moving_stages(result, stages)
    if not moving:
        return []
    shown, window = settled(result, moving)
    time = np.linspace(window.begin, window.end, 2001)
    ideal = result.scene.ideal_slider(time)
    with_impacts = bool(result.scene.clearance_joints)
    heights = [1.25, 1.0, 1.25] + [0.95] * len(shown) + [1.25] * with_impacts
    inches = min(1.15, (_TALLEST - 0.9) / sum(heights))
    sheet = Sheet(figsize=(WIDTH, 0.9 + inches * sum(heights)), layout="constrained")
    panels = sheet.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    _draw_displacements(panels[:2], result, shown, time, ideal[:, 0])
    for stage in shown:
        stage.pen.draw(panels[2], stage.data.time, stage.data.velocity, linewidth=0.9)
    IDEAL.draw(panels[2], time, ideal[:, 1], linewidth=0.9)
    panels[2].set_ylabel("velocity\n(m/s)")
    _draw_accelerations(panels[3 : 3 + len(shown)], window, shown, time, ideal[:, 2])
    watched = result.scene.output
    caption = f"The {watched} over {window.words}, against the motion without clearance."
    if with_impacts:
        interval = result.scene.mechanism.period / _MEANS_PER_CYCLE
        _draw_mean_accelerations(panels[-1], moving, time, ideal[:, 1], interval)
        caption += (
            " Impacts dwarf the ideal acceleration: each stage has a panel of its own on one "
            f"common scale; the lowest panel shows means over {readable(1e3 * interval, 2)} ms, in "
            "which the motion between the impacts is seen."
        )
    window.label(panels[-1])
    sheet.align_ylabels()
    legend(sheet, [IDEAL, *(stage.pen for stage in shown)], "outside upper center")
    return [Drawing("response.png", f"Motion of the {watched}", caption, sheet)]


def _draw_displacements(
    panels: Sequence[Axes], result: Result, stages: list[ShownStage], time: Array, ideal: Array
) -> None:
    """The displacement, and its difference from the ideal."""
    deviations = [
        stage.data.displacement - result.scene.ideal_slider(stage.data.time)[:, 0]
        for stage in stages
    ]
    factor, unit = unit_scale("m", max(float(np.abs(values).max()) for values in deviations))
    for stage, deviation in zip(stages, deviations, strict=True):
        stage.pen.draw(panels[0], stage.data.time, stage.data.displacement, linewidth=0.9)
        stage.pen.draw(panels[1], stage.data.time, factor * deviation, linewidth=0.9)
    IDEAL.draw(panels[0], time, ideal, linewidth=0.9)
    IDEAL.draw(panels[1], time, np.zeros_like(time), linewidth=0.9)
    panels[0].set_ylabel("displacement\n(m)")
    panels[1].set_ylabel(f"displacement\nless ideal ({unit})")


def _draw_jagged(
    axes: Axes, stage: ShownStage, values: Array, each_cycle: Array, window: Window, unit: str
) -> float:
    """Draw what impacts make jagged, and name its largest value of either sign; gives that.

    Parameters
    ----------
    each_cycle : ndarray
        Largest value of each cycle.  Rows of a series are kept as a force changes by 2 % of its
        peak, so that a peak itself may lie between two of them.
    """
    ran = stage.data.time[[0, -1]] - window.run_up
    begin, end = (int(time / window.period + 0.02) for time in ran)
    shown = each_cycle[begin:end]
    largest = max(float(np.abs(values).max()), float(shown.max(initial=0.0)))
    axes.plot(stage.data.time, values, color=stage.pen.colour, linewidth=0.7)
    note(axes, f"{stage.pen.label}, largest {readable(largest)} {unit}")
    return largest


def _draw_accelerations(
    panels: Sequence[Axes], window: Window, stages: list[ShownStage], time: Array, ideal: Array
) -> None:
    """One panel a stage on a common scale."""
    low, high = float(ideal.min()), float(ideal.max())
    for axes, stage in zip(panels, stages, strict=True):
        values, peaks = stage.data.acceleration, stage.data.each_cycle("acceleration_max")
        _draw_jagged(axes, stage, values, peaks, window, "m/s²")
        IDEAL.draw(axes, time, ideal, linewidth=0.9)
        axes.set_ylabel("acceleration\n(m/s²)")
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
        stage.pen.draw(axes, middle, mean(stage.data.time, stage.data.velocity), linewidth=0.8)
    IDEAL.draw(axes, middle, mean(time, ideal_velocity), linewidth=0.9)
    axes.set_ylabel(f"acceleration,\n{readable(1e3 * interval, 2)} ms mean\n(m/s²)")


def contact_force(result: Result, stages: Stages) -> list[Drawing]:
    """Normal force at each clearance joint over time, a panel for each stage."""
    joints = result.scene.clearance_joints
    moving = [own for own in moving_stages(result, stages) if own.data.has_joint_series]
    if not moving:
        return []
    shown, window = settled(result, moving)
    sheet = Sheet(figsize=(WIDTH, 0.5 + 1.35 * len(shown)), layout="constrained")
    grid = sheet.subplots(len(shown), len(joints), squeeze=False, sharex=True, sharey="col")
    for column, joint in zip(grid.T, joints, strict=True):
        largest = 0.0
        for axes, stage in zip(column, shown, strict=True):
            own = stage.data.joints[joint]
            peaks = own.each_cycle("force_max")
            peak = _draw_jagged(axes, stage, own.force[:, 0], peaks, window, "N")
            axes.set_ylabel("normal force (N)")
            largest = max(largest, peak)
        column[0].set_title(f"joint {joint}", loc="left", fontweight="bold")
        column[0].set_ylim(0.0, 1.25 * largest if largest > 0.0 else 1.0)
        window.label(column[-1])
    caption = (
        f"Normal contact force over {window.words}; the same scale for all stages of a "
        "joint. The largest of all cycles is in the table of key numbers."
    )
    return [Drawing("contact-force.png", "Contact force", caption, sheet)]


def centre_trajectory(result: Result, stages: Stages) -> list[Drawing]:
    """Path of each pin's centre inside its bearing, a panel for each stage."""
    joints = result.scene.clearance_joints
    moving = [own for own in moving_stages(result, stages) if own.data.has_joint_series]
    if not moving:
        return []
    shown, window = settled(result, moving)
    side = (WIDTH - 0.9) / max(len(shown), 2) - 0.1
    sheet = Sheet(figsize=(WIDTH, 0.95 + (side + 0.1) * len(joints)), layout="constrained")
    grid = sheet.subplots(len(joints), len(shown), squeeze=False, sharex=True, sharey=True)
    gaps = {joint: result.scene.bearing(joint).clearance for joint in joints}
    factor, unit = unit_scale("m", max(gaps.values()))
    widest, bounded = max(gaps.values()), False
    for row, joint in zip(grid, joints, strict=True):
        for axes, stage in zip(row, shown, strict=True):
            path = stage.data.joints[joint].eccentricity
            limit = gap_limit(result, joint, stage.data)
            reach = draw_path(axes, path, limit, gaps[joint], factor, stage.pen.colour)
            widest, bounded = max(widest, reach), bounded or limit.size > 0
        row[0].set_ylabel(f"joint {joint}\n$e_y$ ({unit})")
    for axes, stage in zip(grid[0], shown, strict=True):
        axes.set_title(wrapped(stage.pen.label, side))
    for axes in grid[-1]:
        axes.set_xlabel(f"$e_x$ ({unit})")
    set_path_limits(grid.flat, 1.06 * factor * widest)
    caption = (
        f"Centre of the pin from the centre of its bearing over {window.words}, in "
        "fixed directions."
    )
    if window.begin == 0.0:
        caption += " It starts in the middle."
    depths = (stage.data.joints[j].depth(side) for stage in shown for j in joints for side in SIDES)
    if not bounded and any(np.any(depth > 0.0) for depth in depths):
        caption += " Worn surfaces turn with their bodies, so that no fixed line bounds the path."
    distinct = dict.fromkeys(gaps.values())
    told = ", ".join(
        f"{readable(factor * gap)} {unit}"
        + (f" ({', '.join(j for j in joints if gaps[j] == gap)})" if len(distinct) > 1 else "")
        for gap in distinct
    )
    legend(sheet, path_pens(told, bounded), "outside upper center")
    return [Drawing("centre-trajectory.png", "Path of the pin centre", caption, sheet)]


def draw_path(
    axes: Axes, path: Array, limit: Array, clearance: float, factor: float, colour: str
) -> float:
    """Draw the path of a pin's centre with its bounds; gives how far all reach, m.

    Parameters
    ----------
    path : ndarray, shape (n, 2)
        Eccentricity, m.
    limit : ndarray, shape (2, n)
        As ``gap_limit`` gives it.
    factor : float
        Units of the axes in a metre.
    """
    around = np.linspace(0.0, 2.0 * math.pi, 361)
    axes.plot(*(factor * path.T), color=colour, linewidth=0.5)
    _ROUND_GAP.draw(axes, *(factor * clearance * np.array([np.cos(around), np.sin(around)])))
    _LIMIT.draw(axes, *(factor * limit))
    return max(clearance, float(np.hypot(*np.hstack([path.T, limit])).max(initial=0.0)))


def set_path_limits(panels: Iterable[Axes], edge: float) -> None:
    """Give all paths one square range, in the units of the axes."""
    for axes in panels:
        axes.set_xlim(-edge, edge)
        axes.set_ylim(-edge, edge)
        axes.set_aspect("equal")
        axes.xaxis.set_major_locator(MaxNLocator(4, symmetric=True))
        axes.yaxis.set_major_locator(MaxNLocator(4, symmetric=True))


def path_pens(clearance: str, bounded: bool) -> list[Pen]:
    """Lines that bound paths; the clearance is a number with its unit."""
    circle = replace(_ROUND_GAP, label=f"clearance circle, c = {clearance}")
    return [circle, _LIMIT] if bounded else [circle]


def gap_limit(result: Result, joint: str, stage: StageResult) -> Array:
    """Line that bounds a pin's centre, m, shape (2, n); empty where none is fixed."""
    own = stage.joints[joint]
    depth = own.depth("bearing") + own.depth("pin")
    if maps_turn(result) or not np.any(depth > 0.0):
        return np.zeros((2, 0))
    angle = np.append(own.angle, own.angle[0])
    gap = result.scene.bearing(joint).clearance + np.append(depth, depth[0])
    return gap * np.array([np.cos(angle), np.sin(angle)])
