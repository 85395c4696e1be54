"""Figures of motion: response, forces, paths of the pin centres, tonnage and drives."""

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from itertools import chain, product

import numpy as np
from matplotlib.ticker import MaxNLocator

from presswear.linkage.drives import linear_bodies
from presswear.linkage.process import Coining
from presswear.linkage.surface import SIDES
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.bottom_dead_centre import bottom_errors
from presswear.results.drives import curves_of
from presswear.results.result import Result
from presswear.results.rigid_joints import ideal_curves
from presswear.results.stage import StageResult
from presswear.results.strokes import height_of, process_force, sampled_strokes
from presswear.show.figures import style
from presswear.show.figures.style import (
    Axes,
    Drawing,
    Pen,
    Sheet,
    Shown,
    ShownStage,
)
from presswear.show.figures.window import Window, draw_with_moments, sampled
from presswear.show.words import in_words_of
from presswear.tools.arrays import Array
from presswear.tools.numbers import quantity_text, readable, unit_scale

_MEANS_PER_CYCLE = 50  # intervals over which the acceleration is averaged
_ROUND_OFF = 1e-6  # of a time, over a cycle
_BEYOND = 0.02  # part of a cycle that may lie beyond the times that are shown
_FEW_JOINTS = 3  # joints up to which the path of a pin has a wide panel
_REACH = 1.3  # greatest height shown, relative to that at which the work is touched
IDEAL = Pen("ideal", style.REFERENCE, (0.0, (4.0, 2.0)), 0.9)
ROUND_GAP = replace(IDEAL, width=0.7)
_LIMIT = Pen("gap limit, c + wear depths", style.REFERENCE, width=0.7)


def _pens(stages: Shown) -> list[Pen]:
    return [IDEAL, *(stage.pen for stage in stages)]


def response(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the deviation of the output, then displacement, velocity and acceleration."""
    scene = result.scene
    shown, window = sampled(result, moving)
    has_means = bool(scene.clearance_joints)
    # Relative heights of the panels: deviation, displacement, velocity, acceleration of
    # each stage, means of the acceleration
    heights = [1.25, 1.25, 1.0] + [0.95] * len(shown)
    if has_means:
        heights.append(1.25)
    height = 0.9 + min(1.15 * sum(heights), style.TALLEST - 0.9)
    sheet, column, zones = window.rows(len(heights), height, height_ratios=heights)
    time = np.linspace(window.start, window.end, 2001)
    place, velocity, acceleration = scene.ideal_slider(time, closed=False).T
    marks = _draw_deviation(column[0], result, shown, moving, window)
    IDEAL.draw(column[0], time, 0.0 * time)
    for stage in shown:
        data = stage.data
        stage.pen.draw(column[1], data.time, data.displacement, linewidth=0.9)
        stage.pen.draw(column[2], data.time, data.velocity, linewidth=0.9)
    IDEAL.draw(column[1], time, place)
    IDEAL.draw(column[2], time, velocity)
    column[1].set_ylabel("displacement\n(m)")
    column[2].set_ylabel("velocity\n(m/s)")
    jagged = column[3 : 3 + len(shown)]
    _draw_accelerations(jagged, shown, window, (time, acceleration))
    interval = window.period / _MEANS_PER_CYCLE if has_means else None
    if interval:
        _draw_mean_accelerations(column[-1], moving, interval, (time, velocity))
    window.label(column, zones)
    return style.finished(
        "response",
        sheet,
        _pens(shown),
        scene=scene,
        window=window,
        interval=interval,
        marks=marks.values(),
    )


def _draw_accelerations(
    panels: Sequence[Axes], shown: Shown, window: Window, ideal: tuple[Array, Array]
) -> None:
    """Draw the acceleration of each stage, all at one scale; ``ideal`` are its time and values."""
    for axes, stage in zip(panels, shown, strict=True):
        peaks = stage.data.each_cycle("acceleration_max")
        largest = _draw_jagged(axes, stage, stage.data.acceleration, peaks, window)
        style.note(axes, f"{stage.pen.label}, largest {readable(largest)} m/s²")
        IDEAL.draw(axes, *ideal)
        axes.set_ylabel("acceleration\n(m/s²)")
    series = (stage.data.acceleration for stage in shown)
    everything = np.concatenate([ideal[1], *series])
    low = float(everything.min())
    reach = float(np.ptp(everything))
    for axes in panels:
        axes.set_ylim(low - 0.05 * reach, low + 1.3 * reach)


def _draw_mean_accelerations(
    axes: Axes, moving: Shown, interval: float, ideal: tuple[Array, Array]
) -> None:
    """Draw means of the acceleration over an interval, s: differences of the velocity.

    ``ideal`` are the times that are shown and the ideal velocity.
    """
    time, _ = ideal
    half = 0.5 * interval
    middle = time[(time >= half) & (time <= time[-1] - half)]
    series = [(stage.pen, stage.data.time, stage.data.velocity) for stage in moving]
    for pen, times, velocity in [*series, (IDEAL, *ideal)]:
        before = np.interp(middle - half, times, velocity)
        after = np.interp(middle + half, times, velocity)
        pen.draw(axes, middle, (after - before) / interval, linewidth=0.8)
    mean = f"{readable(1e3 * interval, 2)} ms mean"
    axes.set_ylabel(f"acceleration,\n{mean}\n(m/s²)")


def _draw_deviation(
    axes: Axes, result: Result, shown: Shown, moving: Shown, window: Window
) -> dict[str, str]:
    """Draw the displacement minus the ideal one; return the words of the marks of the work."""
    scene = result.scene

    def deviation(stage: StageResult) -> Array:
        ideal = scene.ideal_slider(stage.time, closed=False)[:, 0]
        return np.asarray(stage.displacement - ideal)

    deviations = np.concatenate([deviation(stage.data) for stage in shown])
    factor, unit = unit_scale("m", float(np.abs(deviations).max()))
    marks = draw_with_moments(
        axes, result, shown, moving, lambda stage: factor * deviation(stage), window
    )
    axes.set_ylabel(f"displacement\nminus\nideal ({unit})")
    return marks


def _draw_jagged(
    axes: Axes, stage: ShownStage, values: Array, each_cycle: Array, window: Window
) -> float:
    """Draw a series with impacts and return its largest magnitude.

    The series is thinned, so the largest values of whole cycles in it count as well.
    """
    peaks = each_cycle[whole_cycles(stage.data.time, window)]
    largest = max(float(np.abs(values).max()), float(peaks.max(initial=0.0)))
    axes.plot(stage.data.time, values, color=stage.pen.colour, linewidth=0.7)
    return largest


def whole_cycles(time: Array, window: Window) -> slice:
    """Return the cycles that lie between the first and the last time, s; a stroke may have none."""
    cycle = (time - window.run_up) / window.period
    return slice(math.ceil(cycle[0] - _BEYOND), math.floor(cycle[-1] + _BEYOND))


def contact_force(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the normal force at each clearance joint over time, in the first and last stage."""
    shown, window = sampled(result, moving)
    shown = style.first_and_last(shown)
    places = list(product(result.scene.loose_pins, shown))
    if window.zone:
        height = 0.8 + min(1.5 * len(places), style.TALLEST - 0.8)
        sheet, panels, zones = window.rows(len(places), height)
        lowest = panels[-1:]
    else:
        sheet, panels, lowest = style.panel_list(len(places), 1.5, sharex=True)
        zones = []
    largest = dict.fromkeys(result.scene.loose_pins, 0.0)
    for axes, (joint, stage) in zip(panels, places, strict=True):
        title = f"joint {joint}, {stage.pen.label}"
        axes.set_title(title)
        series = stage.data.joints[joint]
        peak = _draw_jagged(
            axes, stage, series.force[:, 0], series.each_cycle("force_max"), window
        )
        style.note(axes, f"largest {quantity_text(peak, 'N')}")
        largest[joint] = max(largest[joint], peak)
    for axes, (joint, _) in zip(panels, places, strict=True):
        axes.set_ylim(0.0, 1.25 * largest[joint] or 1.0)
        style.label_values(axes, "normal force", "N")
    for axes in lowest:
        window.label([axes])
    window.label(panels, zones)
    _share_limits(zones, [joint for joint, _ in places])
    return style.finished("force", sheet, window=window, stages=shown)


def _share_limits(zones: Sequence[Axes], joints: Sequence[str]) -> None:
    """Give the enlarged panels of a joint, one for each stage, the same upper limit."""
    tops = dict.fromkeys(joints, 0.0)
    for axes, joint in zip(zones, joints, strict=False):
        _, top = axes.get_ylim()
        tops[joint] = max(tops[joint], top)
    for axes, joint in zip(zones, joints, strict=False):
        axes.set_ylim(0.0, tops[joint])


def bottom_dead_centre(result: Result, shown: Shown) -> list[Drawing]:
    """Draw the height of bottom dead centre over the ideal in each stroke, first and last stage."""
    scene = result.scene
    shown = style.first_and_last(
        [stage for stage in shown if stage.data.statistics.bdc]
    )
    if not shown or not scene.has_deviations:
        return []
    strokes = [bottom_errors(scene, stage.data) for stage in shown]
    heights = [errors for _, errors in chain(*strokes)]
    largest = float(np.abs(np.concatenate(heights)).max(initial=0.0))
    factor, unit = unit_scale("m", largest)
    sheet, (row,) = style.panels(1, len(shown), 2.6, sharey=True)
    for axes, stage, replicates in zip(row, shown, strokes, strict=True):
        for number, errors in replicates:
            stage.pen.draw(
                axes, number, factor * errors, linewidth=0.7, marker=".", markersize=3.0
            )
        error = stage.data.bdc.error.scaled(factor)
        if error.low is not None and error.high is not None:
            axes.axhspan(
                error.low,
                error.high,
                color=stage.pen.colour,
                alpha=0.2,
                linewidth=0.0,
            )
        axes.axvspan(
            0.5, STARTUP_CYCLES + 0.5, color=style.MUTED, alpha=0.12, linewidth=0.0
        )
        last = max(float(number.max(initial=0.0)) for number, _ in replicates)
        axes.set_xlim(0.5, last + 0.5)
        axes.xaxis.set_major_locator(MaxNLocator(6, integer=True))
        axes.set_xlabel(in_words_of(scene, "strokes since the start"))
    row[0].set_ylabel(f"lowest position of {scene.output}\nminus ideal ({unit})")
    return style.finished("bottom", sheet, [stage.pen for stage in shown], scene=scene)


def centre_trajectory(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the path of each pin centre inside its bearing, in the first and last stage."""
    shown, window = sampled(result, moving)
    is_bounded = False

    def draw(axes: Axes, stage: ShownStage, joint: str, factor: float) -> Array:
        nonlocal is_bounded
        maps = stage.data.joints[joint]
        path = maps.eccentricity.T
        axes.plot(*(factor * path), color=stage.pen.colour, linewidth=0.5)
        depth = maps.depth("bearing") + maps.depth("pin")
        if style.maps_turn(result) or not np.any(depth > 0.0):
            return path
        is_bounded = True
        angle = np.append(maps.angle, maps.angle[0])
        gap = result.scene.bearing(joint).clearance + np.append(depth, depth[0])
        limit = gap * np.array([np.cos(angle), np.sin(angle)])
        _LIMIT.draw(axes, *(factor * limit))
        return np.hstack([path, limit])

    sheet, circle = pin_panels(result, shown, draw)
    worn_depths = []
    for stage in shown:
        for maps in stage.data.joints.values():
            worn_depths += [maps.depth(side) for side in SIDES]
    is_worn = any(np.any(depth > 0.0) for depth in worn_depths)
    pens = [circle, _LIMIT] if is_bounded else [circle]
    return style.finished(
        "path", sheet, pens, window=window, is_open=is_worn and not is_bounded
    )


def pin_panels(
    result: Result, shown: Shown, draw: Callable[[Axes, ShownStage, str, float], Array]
) -> tuple[Sheet, Pen]:
    """Draw positions of the pin centres in square panels, one for each joint and stage.

    ``draw`` draws a stage of a joint with a factor from metres, and returns positions,
    m, shape (2, n). The pen of the clearance circle is returned with the sheet.
    """
    scene = result.scene
    gaps = {joint: scene.bearing(joint).clearance for joint in scene.loose_pins}
    widest = max(gaps.values())
    factor, unit = unit_scale("m", widest)
    height = 3.1 if len(gaps) <= _FEW_JOINTS else 2.3
    label = f"$e_y$ ({unit})"
    sheet, places, lowest = style.joint_panels(
        gaps, shown, height, label, sharex=True, sharey=True
    )
    around = np.linspace(0.0, 2.0 * math.pi, 361)
    circle = np.array([np.cos(around), np.sin(around)])
    for axes, joint, stage in places:
        positions = draw(axes, stage, joint, factor)
        widest = max(widest, float(np.hypot(*positions).max(initial=0.0)))
        ROUND_GAP.draw(axes, *(factor * gaps[joint] * circle))
        axes.set_aspect("equal")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MaxNLocator(4, symmetric=True))
    edge = 1.06 * factor * widest
    places[0][0].set(xlim=(-edge, edge), ylim=(-edge, edge))
    for axes in lowest:
        axes.set_xlabel(f"$e_x$ ({unit})", parse_math=True)
    joints_of: dict[str, list[str]] = {}  # by clearance
    for joint, gap in gaps.items():
        joints_of.setdefault(quantity_text(gap, "m"), []).append(joint)
    texts = list(joints_of)
    if len(texts) > 1:
        texts = [f"{gap} ({', '.join(names)})" for gap, names in joints_of.items()]
    return sheet, replace(ROUND_GAP, label=f"clearance circle, c = {', '.join(texts)}")


def force_over_stroke(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the forces of the work and of the joints over the height of the stroke."""
    scene = result.scene
    process = scene.process
    shown = [stage for stage in moving if sampled_strokes(scene, stage.data)]
    if process is None or not shown:
        return []
    has_series = all(stage.data.has_joint_series for stage in shown)
    joints = scene.loose_pins if has_series else ()
    reach = _REACH * process.height
    factor, unit = unit_scale("m", reach)
    count = 1 + len(joints)
    columns = 2 if count > 3 else 1
    sheet, panels, lowest = style.panel_list(count, 1.7, columns, sharex=True)
    for stage in shown:
        height = height_of(scene, stage.data)
        force = process_force(scene, stage.data)
        assert force is not None, "the scene has a process"
        joint_results = [stage.data.joints[name] for name in joints]
        series = [force, *(np.hypot(*joint.force.T) for joint in joint_results)]
        for stroke in sampled_strokes(scene, stage.data):
            # Above the reach nothing presses on the work.
            inside = height <= reach
            inside &= stage.data.clock >= stroke.start
            inside &= stage.data.clock < stroke.end
            heights = factor * height[inside]
            for axes, values in zip(panels, series, strict=True):
                stage.pen.draw(axes, heights, values[inside], linewidth=0.7)
    if isinstance(process, Coining):
        depth = np.array([0.0, process.height])
        curve = process.stiffness * depth
    else:
        depth, curve = np.array(process.curve).T
    IDEAL.draw(panels[0], factor * (process.height - depth), curve)
    places = ["of the work", *(f"at {name}" for name in joints)]
    for axes, place in zip(panels, places, strict=True):
        style.label_values(axes, f"force {place}", "N")
    panels[-1].set_xlim(factor * reach, 0.0)
    for axes in lowest:
        axes.set_xlabel(f"height over bottom dead centre ({unit})")
    return style.finished("tonnage", sheet, _pens(shown), scene=scene)


def _quantities_of_drives(
    drives: Sequence[str], linear: Collection[str]
) -> list[tuple[str, str, str, str]]:
    """Return drive, field of its curves, label and unit of each panel."""
    panels = []
    for drive in drives:
        label_and_unit = ("force", "N") if drive in linear else ("torque", "N m")
        panels.append((drive, "torque", *label_and_unit))
        panels.append((drive, "power", "power", "W"))
    return panels


def drive_work(result: Result, moving: Shown) -> list[Drawing]:
    """Draw torque and power of each drive over the phase of the cycle, beside ideal joints.

    Only if torques were stored and ideal torques do not need untrusted stored laws.
    """
    scene = result.scene
    moving = [stage for stage in moving if "drive_torque" in stage.data.arrays]
    drives = [drive.body for drive in scene.mechanism.linkage().drives]
    if not moving or not drives or scene.has_untrusted_loads:
        return []
    shown, window = sampled(result, moving)
    linear = linear_bodies(scene.base_linkage.drives)
    places = _quantities_of_drives(drives, linear)
    height = 0.8 + min(1.7 * len(places), style.TALLEST - 0.8)
    sheet, panels, zones = window.rows(len(places), height)
    curves = [curves_of(scene, stage.data) for stage in shown]
    ideal, _ = ideal_curves(scene)
    # Cycles of the window, from the cycle in which it starts; round-off adds none.
    first = np.floor((window.start - window.run_up) / window.period + _ROUND_OFF)
    last = np.ceil((window.end - window.run_up) / window.period - _ROUND_OFF)
    for axes, (drive, name, label, unit) in zip(panels, places, strict=True):
        cycle = ideal[drive].time - scene.run_up - window.period
        starts = window.run_up + window.period * np.arange(first, last)
        expected = np.tile(getattr(ideal[drive], name), starts.size)
        for stage, curves_of_stage in zip(shown, curves, strict=True):
            values = getattr(curves_of_stage[drive], name)
            stage.pen.draw(axes, stage.data.time, values, linewidth=0.7)
        IDEAL.draw(axes, np.add.outer(starts, cycle).ravel(), expected)
        style.label_values(axes, label, unit)
        axes.set_title(drive)
    window.label(panels, zones)
    return style.finished(
        "drives",
        sheet,
        _pens(shown),
        window=window,
        cranks=len(drives) - len(linear),
        cylinders=len(linear),
    )
