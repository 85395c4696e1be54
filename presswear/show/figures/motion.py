"""Figures of motion: stroke, response, forces, paths of the pin centres, tonnage and drives."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.ticker import MaxNLocator, MultipleLocator

from presswear.linkage.loads import Coining
from presswear.physics.ideal import bottom_of
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.press_analysis import bottom_errors as bottom_strokes
from presswear.results.press_analysis import (
    curves_of,
    height_of,
    ideal_curves,
    process_force,
    settled_strokes,
    strokes_of,
)
from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult
from presswear.show.figures.style import (
    MUTED,
    REFERENCE,
    SHOWN_CYCLES,
    TALLEST,
    WIDTH,
    Array,
    Axes,
    Drawing,
    Pen,
    ShownStage,
    Stages,
    between,
    finished,
    maps_turn,
    note,
    panels,
    shown_stages,
    square_side,
    title_joint,
    title_stages,
    wrapped,
)
from presswear.tools.numbers import quantity_text, readable, unit_scale

_MEANS_PER_CYCLE = 50  # intervals over which the acceleration is averaged
_TAIL = 0.005  # fraction of the time beyond either end of a panel of the drives
_REACH = 1.3  # greatest height shown, relative to that at which the work is touched
_MOMENTS = {
    "contact": ("v", "triangle down: touches the work"),
    "fracture": ("x", "cross: the work breaks"),
    "separation": ("^", "triangle up: leaves the work"),
}
IDEAL = Pen("ideal", REFERENCE, (0.0, (4.0, 2.0)))
_ROUND_GAP = replace(IDEAL, width=0.7)
_LIMIT = Pen("gap limit, c + wear depths", REFERENCE, width=0.7)


def moving_stages(result: Result, stages: Stages, joints: bool = False) -> list[ShownStage]:
    """Return the shown stages with a motion, and with series of the joints if required.

    A failed stage is left out, because its numbers are meaningless.
    """
    return [
        stage
        for stage in shown_stages(result, stages)
        if not stage.data.failed
        and stage.data.time.size > 1
        and (stage.data.has_joint_series or not joints)
    ]


@dataclass(frozen=True)
class Window:
    """Part of the motion that is shown.

    Attributes
    ----------
    start, end, period, run_up : float
        s.
    phase : str
        Name of the angle that makes a full turn in a cycle.
    words : str
        Description of the part.
    """

    start: float
    end: float
    period: float
    run_up: float
    phase: str
    words: str

    def label(self, axes: Axes) -> None:
        """Limit a time axis to the window and mark the phase of the cycle on it."""
        axes.set_xlim(self.start, self.end)
        axes.xaxis.set_major_locator(MultipleLocator(0.25 * self.period))
        axes.xaxis.set_major_formatter(
            lambda time, place: f"{360.0 * (time - 0.5 * self.run_up) / self.period:.0f}"
        )
        axes.set_xlabel(f"{self.phase} since the start (degrees)")


def settled(result: Result, stages: Sequence[ShownStage]) -> tuple[list[ShownStage], Window]:
    """Return the stages cut to the part of the motion that is shown: cycles after the start-up."""
    period, run_up = result.scene.mechanism.period, result.scene.run_up
    whole = [round((float(stage.data.time[-1]) - run_up) / period - 0.48) for stage in stages]
    first = max(min(STARTUP_CYCLES, min(whole) - 1), 0)
    start = run_up + first * period
    last = max(float(stage.data.time[-1]) for stage in stages)
    end = min(start + SHOWN_CYCLES * period, last)
    count = (end - run_up) / period
    cycles = round(count)
    if abs(count - cycles) > 0.02:
        words = f"the first {count:.2g} cycles"
    elif first:
        words = f"cycle {cycles}" if first + 1 == cycles else f"cycles {first + 1} to {cycles}"
    else:
        words = "the first cycle, at the start" if cycles == 1 else f"the first {cycles} cycles"
    words = f"{words} of {1e3 * period:.0f} ms{' after the run-up' if run_up > 0.0 else ''}"
    shown = [replace(stage, data=between(stage.data, start, end)) for stage in stages]
    phase = result.scene.mechanism.linkage().phase
    return shown, Window(start, end, period, run_up, phase, words)


def _pens(stages: Iterable[ShownStage]) -> list[Pen]:
    return [IDEAL, *(stage.pen for stage in stages)]


def height_over_angle(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the height over the ideal bottom dead centre, with the moments of the work."""
    scene = result.scene
    moving = moving_stages(result, stages)
    if not moving or bottom_of(scene.ideal) is None:
        return []
    shown, window = settled(result, moving)
    factor, unit = unit_scale("m", scene.stroke)
    time = np.linspace(window.start, window.end, 1001)
    offset = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)[0, 0]
    ideal = offset + scene.ideal_slider(time)[:, 0] - scene.bottom
    sheet, ((axes,),) = panels(1, 1, 2.9)
    marks: dict[str, str] = {}
    for stage, full in zip(shown, moving, strict=True):
        stage.pen.draw(axes, stage.data.time, factor * height_of(scene, stage.data))
        strokes = strokes_of(scene, full.data)
        for name, (mark, words) in _MOMENTS.items() if strokes else ():
            moments = getattr(strokes, name)
            inside = (moments[:, 0] >= window.start) & (moments[:, 0] <= window.end)
            if inside.any():
                marks[mark] = words
                when, height = moments[inside].T
                axes.plot(when, factor * height, mark, color=stage.pen.colour, markersize=6)
    IDEAL.draw(axes, time, factor * ideal, linewidth=0.9)
    axes.set_ylabel(f"height of the {scene.output}\nover bottom dead centre ({unit})")
    window.label(axes)
    caption = (
        f"Height of the {scene.output} over its lowest position without clearance, over "
        f"{window.words}."
    )
    if marks:
        caption += f" Marks: {', '.join(marks.values())}."
    title = f"Height of the {scene.output} in the stroke"
    return finished("stroke.png", title, caption, sheet, _pens(shown))


def response(result: Result, stages: Stages) -> list[Drawing]:
    """Draw displacement, velocity and acceleration of the output against the ideal."""
    moving = moving_stages(result, stages)
    if not moving:
        return []
    shown, window = settled(result, moving)
    output, time = result.scene.output, np.linspace(window.start, window.end, 2001)
    ideal = result.scene.ideal_slider(time)
    has_impacts = bool(result.scene.clearance_joints)
    heights = [1.25, 1.0, 1.25] + [0.95] * len(shown) + [1.25] * has_impacts
    inches = min(1.15, (TALLEST - 0.9) / sum(heights))
    height = 0.9 + inches * sum(heights)
    sheet, grid = panels(len(heights), 1, height, sharex=True, height_ratios=heights)
    column = grid[:, 0]
    _draw_displacements(column[:2], result, shown, time, ideal[:, 0])
    for stage in shown:
        stage.pen.draw(column[2], stage.data.time, stage.data.velocity, linewidth=0.9)
    IDEAL.draw(column[2], time, ideal[:, 1], linewidth=0.9)
    column[2].set_ylabel("velocity\n(m/s)")
    _draw_accelerations(column[3 : 3 + len(shown)], window, shown, time, ideal[:, 2])
    caption = f"The {output} over {window.words}, against the motion without clearance."
    if has_impacts:
        interval = result.scene.mechanism.period / _MEANS_PER_CYCLE
        _draw_mean_accelerations(column[-1], moving, time, ideal[:, 1], interval)
        caption += (
            " Impacts exceed the ideal acceleration by far: each stage has its own panel on a "
            f"common scale; the lowest panel shows means over {readable(1e3 * interval, 2)} ms, "
            "which show the motion between the impacts."
        )
    window.label(column[-1])
    return finished("response.png", f"Motion of the {output}", caption, sheet, _pens(shown))


def _draw_displacements(
    axes: Sequence[Axes], result: Result, stages: list[ShownStage], time: Array, ideal: Array
) -> None:
    deviations = [
        stage.data.displacement - result.scene.ideal_slider(stage.data.time)[:, 0]
        for stage in stages
    ]
    factor, unit = unit_scale("m", max(float(np.abs(values).max()) for values in deviations))
    for stage, deviation in zip(stages, deviations, strict=True):
        stage.pen.draw(axes[0], stage.data.time, stage.data.displacement, linewidth=0.9)
        stage.pen.draw(axes[1], stage.data.time, factor * deviation, linewidth=0.9)
    IDEAL.draw(axes[0], time, ideal, linewidth=0.9)
    IDEAL.draw(axes[1], time, np.zeros_like(time), linewidth=0.9)
    axes[0].set_ylabel("displacement\n(m)")
    axes[1].set_ylabel(f"displacement\nminus ideal ({unit})")


def _draw_accelerations(
    column: Sequence[Axes], window: Window, stages: list[ShownStage], time: Array, ideal: Array
) -> None:
    low, high = float(ideal.min()), float(ideal.max())
    for axes, stage in zip(column, stages, strict=True):
        values, peaks = stage.data.acceleration, stage.data.each_cycle("acceleration_max")
        _draw_jagged(axes, stage, values, peaks, window, "m/s²")
        IDEAL.draw(axes, time, ideal, linewidth=0.9)
        axes.set_ylabel("acceleration\n(m/s²)")
        low, high = min(low, float(values.min())), max(high, float(values.max()))
    for axes in column:
        axes.set_ylim(low - 0.05 * (high - low), high + 0.3 * (high - low))


def _draw_jagged(
    axes: Axes, stage: ShownStage, values: Array, each_cycle: Array, window: Window, unit: str
) -> float:
    """Draw a series with impacts, note its largest magnitude and return it.

    Parameters
    ----------
    each_cycle : ndarray
        Largest value of each cycle. The series is thinned, so a peak may lie between its rows.
    """
    ends = stage.data.time[[0, -1]] - window.run_up
    start, end = (int(time / window.period + 0.02) for time in ends)
    peaks = each_cycle[start:end]
    largest = max(float(np.abs(values).max()), float(peaks.max(initial=0.0)))
    axes.plot(stage.data.time, values, color=stage.pen.colour, linewidth=0.7)
    note(axes, f"{stage.pen.label}, largest {readable(largest)} {unit}")
    return largest


def _draw_mean_accelerations(
    axes: Axes, stages: list[ShownStage], time: Array, ideal_velocity: Array, interval: float
) -> None:
    """Draw accelerations as means over an interval, s: differences of the velocity over it."""
    middle = time[(time >= 0.5 * interval) & (time <= time[-1] - 0.5 * interval)]

    def mean(times: Array, velocity: Array) -> Array:
        before, after = (np.interp(middle + s * interval, times, velocity) for s in (-0.5, 0.5))
        return np.asarray((after - before) / interval)

    for stage in stages:
        stage.pen.draw(axes, middle, mean(stage.data.time, stage.data.velocity), linewidth=0.8)
    IDEAL.draw(axes, middle, mean(time, ideal_velocity), linewidth=0.9)
    axes.set_ylabel(f"acceleration,\n{readable(1e3 * interval, 2)} ms mean\n(m/s²)")


def contact_force(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the normal force at each clearance joint over time, a panel for each stage."""
    joints, moving = result.scene.clearance_joints, moving_stages(result, stages, joints=True)
    if not moving:
        return []
    shown, window = settled(result, moving)
    height = 0.5 + 1.35 * len(shown)
    sheet, grid = panels(len(shown), len(joints), height, sharex=True, sharey="col")
    for column, joint in zip(grid.T, joints, strict=True):
        largest = 0.0
        for axes, stage in zip(column, shown, strict=True):
            series = stage.data.joints[joint]
            peaks = series.each_cycle("force_max")
            peak = _draw_jagged(axes, stage, series.force[:, 0], peaks, window, "N")
            axes.set_ylabel("normal force (N)")
            largest = max(largest, peak)
        title_joint(column[0], f"joint {joint}")
        column[0].set_ylim(0.0, 1.25 * largest if largest > 0.0 else 1.0)
        window.label(column[-1])
    caption = (
        f"Normal contact force over {window.words}, on the same scale for all stages of a joint. "
        "The largest force of all cycles is in the table of key numbers."
    )
    return finished("contact-force.png", "Contact force", caption, sheet)


def bottom_dead_centre(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the height of bottom dead centre over the ideal in each stroke, a panel per stage."""
    scene = result.scene
    shown = [stage for stage in shown_stages(result, stages) if stage.data.statistics.bdc]
    if not shown or not scene.clearance_joints:
        return []
    strokes = [bottom_strokes(scene, stage.data) for stage in shown]
    heights = np.concatenate([rows for replicates in strokes for _, rows in replicates])
    factor, unit = unit_scale("m", float(np.abs(heights).max(initial=0.0)))
    sheet, (row,) = panels(1, len(shown), 2.6, sharey=True)
    for axes, stage, replicates in zip(row, shown, strokes, strict=True):
        for number, rows in replicates:
            stage.pen.draw(axes, number, factor * rows, linewidth=0.7, marker=".", markersize=3.0)
        error = stage.data.bdc.error.scaled(factor)
        ends = (error.mean if end is None else end for end in (error.low, error.high))
        axes.axhspan(*ends, color=stage.pen.colour, alpha=0.2, linewidth=0.0)
        axes.axvspan(0.5, STARTUP_CYCLES + 0.5, color=MUTED, alpha=0.12, linewidth=0.0)
        last = max(float(number[-1]) for number, _ in replicates if number.size)
        axes.set_xlim(0.5, last + 0.5)
        axes.xaxis.set_major_locator(MaxNLocator(6, integer=True))
        axes.set_xlabel(wrapped("since the start (strokes)", (WIDTH - 0.7) / len(shown) - 0.1))
    row[0].set_ylabel(f"lowest position of the {scene.output}\nminus ideal ({unit})")
    caption = (
        f"Bottom dead centre of the {scene.output} over the ideal one in each stroke; one line "
        "per replicate. The band is the mean of the settled strokes with its 95 % interval; "
        "strokes in the grey band are left out."
    )
    pens = [stage.pen for stage in shown]
    return finished("bottom-dead-centre.png", "Bottom dead centre", caption, sheet, pens)


def centre_trajectory(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the path of each pin centre inside its bearing, a panel for each stage."""
    joints, moving = result.scene.clearance_joints, moving_stages(result, stages, joints=True)
    if not moving:
        return []
    shown, window = settled(result, moving)
    side = square_side(len(shown))
    height = 0.95 + (side + 0.1) * len(joints)
    sheet, grid = panels(len(joints), len(shown), height, sharex=True, sharey=True)
    gaps = {joint: result.scene.bearing(joint).clearance for joint in joints}
    factor, unit = unit_scale("m", max(gaps.values()))
    widest, is_bounded = max(gaps.values()), False
    for row, joint in zip(grid, joints, strict=True):
        for axes, stage in zip(row, shown, strict=True):
            path = stage.data.joints[joint].eccentricity
            limit = gap_limit(result, joint, stage.data)
            reach = draw_path(axes, path, limit, gaps[joint], factor, stage.pen.colour)
            widest, is_bounded = max(widest, reach), is_bounded or limit.size > 0
    title_stages(grid, shown, side)
    label_paths(grid, joints, unit)
    set_path_limits(grid.flat, 1.06 * factor * widest)
    caption = (
        f"Centre of the pin relative to the centre of its bearing over {window.words}, in fixed "
        "directions."
    )
    if window.start == 0.0:
        caption += " The pin starts in the middle."
    depths = (stage.data.joints[j].depth(side) for stage in shown for j in joints for side in SIDES)
    if not is_bounded and any(np.any(depth > 0.0) for depth in depths):
        caption += " Worn surfaces turn with their bodies, so that no fixed line bounds the path."
    pens = path_pens(clearance_text(gaps), is_bounded)
    return finished("centre-trajectory.png", "Path of the pin centre", caption, sheet, pens)


def clearance_text(gaps: dict[str, float]) -> str:
    """Return the clearances of joints, with the names of the joints where they differ."""
    joints: dict[str, list[str]] = {}
    for joint, gap in gaps.items():
        joints.setdefault(quantity_text(gap, "m"), []).append(joint)
    if len(joints) == 1:
        return next(iter(joints))
    return ", ".join(f"{gap} ({', '.join(names)})" for gap, names in joints.items())


def draw_path(
    axes: Axes, path: Array, limit: Array, clearance: float, factor: float, colour: str
) -> float:
    """Draw the path of a pin centre with its bounds and return their greatest radius, m.

    Parameters
    ----------
    path : ndarray, shape (n, 2)
        Eccentricity, m.
    limit : ndarray, shape (2, n)
        From ``gap_limit``.
    factor : float
        Units of the axes in a metre.
    """
    axes.plot(*(factor * path.T), color=colour, linewidth=0.5)
    draw_clearance(axes, factor * clearance)
    _LIMIT.draw(axes, *(factor * limit))
    return max(clearance, float(np.hypot(*np.hstack([path.T, limit])).max(initial=0.0)))


def draw_clearance(axes: Axes, radius: float) -> None:
    """Draw the clearance circle, its radius in the units of the axes."""
    around = np.linspace(0.0, 2.0 * math.pi, 361)
    _ROUND_GAP.draw(axes, radius * np.cos(around), radius * np.sin(around))


def label_paths(grid: Array, joints: Sequence[str], unit: str) -> None:
    """Label the axes of paths: a row for each joint."""
    for row, joint in zip(grid, joints, strict=True):
        row[0].set_ylabel(f"joint {joint}\n$e_y$ ({unit})")
    for axes in grid[-1]:
        axes.set_xlabel(f"$e_x$ ({unit})")


def set_path_limits(grid: Iterable[Axes], edge: float) -> None:
    """Give all paths one square range, in the units of the axes."""
    for axes in grid:
        axes.set_xlim(-edge, edge)
        axes.set_ylim(-edge, edge)
        axes.set_aspect("equal")
        axes.xaxis.set_major_locator(MaxNLocator(4, symmetric=True))
        axes.yaxis.set_major_locator(MaxNLocator(4, symmetric=True))


def path_pens(clearance: str, bounded: bool) -> list[Pen]:
    """Return the lines that bound paths; the clearance is a number with its unit."""
    circle = replace(_ROUND_GAP, label=f"clearance circle, c = {clearance}")
    return [circle, _LIMIT] if bounded else [circle]


def gap_limit(result: Result, joint: str, stage: StageResult) -> Array:
    """Return the line that bounds a pin centre, m, shape (2, n); empty if none is fixed."""
    maps = stage.joints[joint]
    depth = maps.depth("bearing") + maps.depth("pin")
    if maps_turn(result) or not np.any(depth > 0.0):
        return np.zeros((2, 0))
    angle = np.append(maps.angle, maps.angle[0])
    gap = result.scene.bearing(joint).clearance + np.append(depth, depth[0])
    return gap * np.array([np.cos(angle), np.sin(angle)])


def force_over_stroke(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the forces of the work and of the joints over the height of the stroke."""
    scene, process = result.scene, result.scene.process
    shown = [
        (stage, strokes)
        for stage in moving_stages(result, stages)
        if (strokes := settled_strokes(scene, stage.data))
    ]
    if process is None or not shown:
        return []
    joints = scene.clearance_joints if all(one.data.has_joint_series for one, _ in shown) else ()
    reach = _REACH * process.height
    factor, unit = unit_scale("m", reach)
    sheet, grid = panels(1 + len(joints), 1, 0.8 + 1.7 * (1 + len(joints)), sharex=True)
    column = grid[:, 0]
    for stage, strokes in shown:
        time, height = stage.data.time, height_of(scene, stage.data)
        force = process_force(scene, stage.data)
        assert force is not None, "the scene has a process"
        series = [force, *(np.hypot(*stage.data.joints[name].force.T) for name in joints)]
        for stroke in strokes:
            # Above the reach nothing presses on the work.
            inside = (time >= stroke.start) & (time < stroke.end) & (height <= reach)
            for axes, values in zip(column, series, strict=True):
                stage.pen.draw(axes, factor * height[inside], values[inside], linewidth=0.7)
    if isinstance(process, Coining):
        depth = np.array([0.0, process.height])
        curve = process.stiffness * depth
    else:
        depth, curve = np.array(process.curve).T
    IDEAL.draw(column[0], factor * (process.height - depth), curve, linewidth=0.9)
    for axes, name in zip(column, ("of the work", *(f"at {name}" for name in joints)), strict=True):
        axes.set_ylabel(f"force {name} (N)")
    column[-1].set_xlim(factor * reach, 0.0)
    column[-1].set_xlabel(f"height over the ideal bottom dead centre ({unit})")
    caption = (
        f"Force of the work on the {scene.output}, and between pins and bearings, in the settled "
        "strokes that were recorded. The downward motion is to the right; the return motion lies "
        "over it. Dashed: force curve of the work without a cushion."
    )
    pens = _pens(stage for stage, _ in shown)
    return finished("force-over-stroke.png", "Force over the stroke", caption, sheet, pens)


def drive_work(result: Result, stages: Stages) -> list[Drawing]:
    """Draw torque and power of each drive over the phase of the cycle, beside ideal joints.

    Only if torques were stored and ideal torques do not need untrusted stored laws.
    """
    scene = result.scene
    shown = [s for s in moving_stages(result, stages) if "drive_torque" in s.data.arrays]
    drives = [drive.body for drive in scene.mechanism.linkage().drives]
    if not shown or not drives or scene.has_untrusted_loads:
        return []
    shown, window = settled(result, shown)
    sheet, grid = panels(len(drives), 2, 0.6 + 1.9 * len(drives), sharex=True)
    curves = [(stage.pen, stage.data.time, curves_of(scene, stage.data)) for stage in shown]
    ideal = ideal_curves(scene)
    cycles = np.arange(np.ceil((window.end - window.start) / window.period))
    for row, drive in zip(grid, drives, strict=True):
        time = ideal[drive].time - scene.run_up - window.period
        time = np.add.outer(window.start + window.period * cycles, time).ravel()
        for axes, name, unit in zip(row, ("torque", "power"), ("N m", "W"), strict=True):
            lines = [(pen, times, getattr(each[drive], name)) for pen, times, each in curves]
            expected = np.tile(getattr(ideal[drive], name), cycles.size)
            _draw_drive(axes, lines, (time, expected), unit)
            axes.set_ylabel(f"{name} ({unit})")
        title_joint(row[0], drive)
    for axes in grid[-1]:
        window.label(axes)
    caption = (
        "Torque of each drive on its body, positive counterclockwise, and its power, over "
        f"{window.words}; dashed with ideal joints. Panels show the ideal curve and all but "
        f"{200.0 * _TAIL:g} % of the time; peaks of impacts exceed them, and the values farthest "
        "from zero are written above in the order of the legend."
    )
    title = "Torque and power of the drives"
    return finished("drives.png", title, caption, sheet, _pens(shown))


def _draw_drive(
    axes: Axes, lines: Sequence[tuple[Pen, Array, Array]], ideal: tuple[Array, Array], unit: str
) -> None:
    """Draw lines over time below the ideal one, in a panel that short peaks exceed."""
    low, high = float(ideal[1].min()), float(ideal[1].max())
    for pen, time, values in lines:
        pen.draw(axes, time, values, linewidth=0.7)
        least, most = central_range(time, values, _TAIL)
        low, high = min(low, least), max(high, most)
    IDEAL.draw(axes, *ideal, linewidth=0.9)
    margin = 0.08 * (high - low)
    axes.set_ylim(low - margin, high + margin)
    farthest = (readable(float(values[np.abs(values).argmax()])) for _, _, values in lines)
    axes.set_title(f"farthest: {', '.join(farthest)} {unit}", loc="right", fontsize="small")


def central_range(time: Array, values: Array, tail: float) -> tuple[float, float]:
    """Return the quantiles of a sampled quantity over time at ``tail`` and ``1 - tail``.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
    """
    weights = np.gradient(time)
    order = np.argsort(values)
    fraction = np.cumsum(weights[order]) / weights.sum()
    least, most = np.searchsorted(fraction, (tail, 1.0 - tail))
    return float(values[order[least]]), float(values[order[min(most, order.size - 1)]])
