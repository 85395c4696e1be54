"""Figures of the dynamics: phase portraits, sections, modes and spectra; bifurcation diagrams."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.ticker import MaxNLocator

from presswear.analysis.contact_modes import (
    MODES,
    over_nominal_time,
    timeline_of,
)
from presswear.analysis.periods import impacts_of, period_of, section_of
from presswear.analysis.spectra import MAX_ORDER, spectra_of
from presswear.results.result import Result
from presswear.results.sampled_cycles import sampled_span
from presswear.show.figures import style
from presswear.show.figures.motion import pin_panels
from presswear.show.figures.style import Axes, Drawing, Pen, Shown, ShownStage
from presswear.tools.arrays import Array
from presswear.tools.numbers import unit_scale

if TYPE_CHECKING:
    from presswear.analysis.bifurcation import Diagram

BINS = 180  # bins of the cycle in a timeline of modes
_MODE_COLOURS = ("0.92", "#E69F00", "#0072B2", "#009E73")
_MODE_WORDS = ("free", "impact", "sustained", "sticking")
_HARMONICS = 10  # harmonics of the crank that are marked
BRANCHES = {"up": ("increasing", "^"), "down": ("decreasing", "v")}  # word and marker
NO_PERIOD = 0.0  # ordinate of a motion without period
DOT_AREA = 4000.0  # area of all dots of a branch, square points
MIN_PERIOD_AXIS = 4.0  # smallest upper end of the period axis


def phase_portrait(result: Result, shown: Shown) -> list[Drawing]:
    """Draw velocity over position: of the output, and of each pin along the line of centres."""
    scene = result.scene
    joints = result.scene.loose_pins
    # Both stages of a joint have the same scale.
    share: Any = "row" if len(shown) > 1 else False
    names = ["", *joints]
    sheet, places, _ = style.joint_panels(names, shown, 2.4, sharex=share, sharey=share)
    clearances = [scene.bearing(joint).clearance for joint in joints]
    factor, unit = unit_scale("m", max(clearances, default=1.0))
    for axes, joint, stage in places:
        data = style.between(stage.data, *sampled_span(scene, stage.data))
        line_style: dict[str, Any] = {"color": stage.pen.colour, "linewidth": 0.3}
        if not joint:
            axes.plot(1e3 * data.displacement, data.velocity, **line_style)
            axes.set_title(f"{scene.output}, {stage.pen.label}")
            axes.set(xlabel="displacement (mm)", ylabel="velocity (m/s)")
            continue
        distance = np.hypot(*data.joints[joint].eccentricity.T)
        # Times of successive rows may differ by round-off only.
        time, rows = np.unique(data.clock, return_index=True)
        axes.plot(
            factor * distance[rows], np.gradient(distance[rows], time), **line_style
        )
        clearance = factor * scene.bearing(joint).clearance
        axes.axvline(
            clearance, color=style.REFERENCE, linewidth=0.7, linestyle="dashed"
        )
        axes.set(xlabel=f"|e| ({unit})", ylabel="d|e|/dt (m/s)")
    return style.finished("phase", sheet, scene=scene)


def poincare_section(result: Result, shown: Shown) -> list[Drawing]:
    """Draw the position of each pin once per cycle, in the first and last stage."""
    scene = result.scene
    phase = 1.0
    counts = []

    def draw(axes: Axes, stage: ShownStage, joint: str, factor: float) -> Array:
        nonlocal phase
        points, phase = section_of(scene, stage.data, joint)
        counts.append(len(points))
        size = 9.0 if len(points) < 50 else 3.0
        x, y = factor * points.T
        axes.scatter(x, y, size, stage.pen.colour, linewidths=0.0, zorder=3)
        return points.T

    sheet, circle = pin_panels(result, shown, draw)
    shown = style.first_and_last(shown)
    periods = [f"{stage.pen.label}: {period_of(scene, stage.data)}" for stage in shown]
    return style.finished(
        "poincare",
        sheet,
        [circle],
        scene=scene,
        angle=360.0 * (phase % 1.0),
        fewest=min(counts),
        periods=periods,
    )


def impact_section(result: Result, shown: Shown) -> list[Drawing]:
    """Draw the closing speed over the cycle at every touchdown, a panel for joint and stage."""
    scene = result.scene
    joints = scene.dry_pins
    impacts = {}
    for joint in joints:
        for stage in shown:
            key = (joint, stage.data.index)
            impacts[key] = impacts_of(scene, stage.data, joint)
    if not any(speed.any() for _, speed in impacts.values()):
        return []
    label = "closing speed (m/s)"
    sheet, places, lowest = style.joint_panels(
        joints, shown, 1.6, label, sharex=True, sharey=True
    )
    counts = []
    for axes, joint, stage in places:
        when, speed = impacts[joint, stage.data.index]
        counts.append(len(speed))
        axes.scatter(360.0 * when, speed, s=4.0, color=stage.pen.colour, linewidths=0.0)
        # Most touchdowns of a resting pin are far slower than those that end a flight.
        axes.set_yscale("log", subs=style.SUBTICKS)
    _label_phase(lowest, result)
    return style.finished("impacts", sheet, scene=scene, fewest=min(counts))


def _label_phase(lowest: list[Axes], result: Result) -> None:
    """Label the lowest panels with the phase of the cycle."""
    for axes in lowest:
        axes.set_xlabel(
            f"{result.scene.mechanism.linkage().phase} in the cycle (degrees)"
        )
        axes.set_xticks(np.arange(0.0, 361.0, 90.0))
        axes.set_xlim(0.0, 360.0)


def contact_modes(result: Result, shown: Shown) -> list[Drawing]:
    """Draw the share of each contact mode over the cycle, a panel for joint and stage."""
    scene = result.scene
    joints = scene.dry_pins
    if not joints:
        return []
    label = "part of the time (%)"
    sheet, places, lowest = style.joint_panels(
        joints, shown, 1.7, label, sharex=True, sharey=True
    )
    for axes, joint, stage in places:
        by_clock = timeline_of(scene, stage.data, joint)
        line = over_nominal_time(scene, stage.data, by_clock)
        percent = 100.0 * line.over_phase(scene.mechanism.period, BINS)
        percent = np.column_stack([percent, percent[:, -1]])
        edges = np.linspace(0.0, 360.0, BINS + 1)
        axes.stackplot(edges, percent, colors=_MODE_COLOURS, linewidth=0.0, step="post")
        axes.set_ylim(0.0, 100.0)
        axes.grid(False)
        shares = zip(_MODE_WORDS, by_clock.shares.values(), strict=True)
        text = ", ".join(f"{word} {100.0 * share:.2f}" for word, share in shares)
        title = f"joint {joint}, {stage.pen.label}\n{text} %"
        axes.set_title(title, fontsize=7.0, fontweight="normal")
    _label_phase(lowest, result)
    colours = zip(MODES, _MODE_COLOURS, strict=True)
    pens = [Pen(mode, colour, width=5.0) for mode, colour in colours]
    return style.finished("modes", sheet, pens)


def spectrum(result: Result, shown: Shown) -> list[Drawing]:
    """Draw spectra of acceleration and contact forces, with harmonics."""
    scene = result.scene
    joints = result.scene.loose_pins
    columns = 2 if len(joints) > 2 else 1
    sheet, panels, lowest = style.panel_list(1 + len(joints), 1.9, columns, sharex=True)
    spectra = [spectra_of(scene, stage.data) for stage in shown]
    for stage, of_stage in zip(shown, spectra, strict=True):
        for axes, name in zip(panels, ("", *joints), strict=True):
            of_name = of_stage[name]
            stage.pen.draw(axes, of_name.order[1:], of_name.density[1:], linewidth=0.6)
    for axes, joint in zip(panels[1:], joints, strict=True):
        axes.set_ylabel(f"force at {joint}\n(N²/Hz)")
    panels[0].set_ylabel("acceleration\n((m/s²)²/Hz)")
    for axes in panels:
        axes.set_xscale("log", subs=style.SUBTICKS)
        axes.set_yscale("log", subs=style.SUBTICKS)
        for order in range(1, _HARMONICS + 1):
            axes.axvline(order, color="0.8", linewidth=0.6, zorder=0.5)
    panels[-1].set_xlim(0.2, MAX_ORDER)
    for axes in lowest:
        axes.set_xlabel("frequency in turns of the cycle (orders)")
    return style.finished(
        "spectrum",
        sheet,
        [stage.pen for stage in shown],
        scene=scene,
        harmonics=_HARMONICS,
        period=spectra[-1][""].period,
    )


def _axis_label(diagram: "Diagram") -> str:
    """Return the label of the parameter axis."""
    parameter = diagram.parameter
    _, unit = parameter.factor_and_unit
    return f"{parameter.key} ({unit})" if unit else parameter.key


def _branches(diagram: "Diagram") -> list[tuple[str, Pen, Array]]:
    """Return direction, pen and shown values of the parameter of each branch."""
    parameter = diagram.parameter
    factor, _ = parameter.factor_and_unit
    branches = []
    for direction, (colour, _) in zip(diagram.branches, style.LINES, strict=False):
        word, _ = BRANCHES[direction]
        value = factor * diagram.branches[direction].value
        branches.append((direction, Pen(f"{word} {parameter.key}", colour), value))
    return branches


@matplotlib.rc_context(style.SETTINGS)
def draw_diagram(diagram: "Diagram") -> Drawing:
    """Return the bifurcation diagram with both branches."""
    joints = diagram.scene.loose_pins
    has_exponent = diagram.cycles.exponent > 0
    count = len(joints) + 1
    if has_exponent:
        count += 1
    sheet, grid = style.panels(count, 1, 0.8 + 1.9 * count, sharex=True)
    of_pins = grid[: len(joints), 0]
    of_exponent = grid[len(joints), 0] if has_exponent else None
    of_period = grid[-1, 0]
    branches = _branches(diagram)
    for direction, pen, value in branches:
        _draw_pins(of_pins, diagram, direction, value, pen.colour)
        if of_exponent is not None:
            _draw_exponent(of_exponent, diagram, direction, value, pen.colour)
        _draw_periods(of_period, diagram, direction, value, pen.colour)
    for axes, joint in zip(of_pins, joints, strict=True):
        axes.set_ylabel(f"direction of the pin\nin joint {joint} (degrees)")
        steps = [1.0, 1.5, 3.0, 4.5, 9.0, 10.0]
        axes.yaxis.set_major_locator(MaxNLocator(5, steps=steps))
    if of_exponent is not None:
        of_exponent.axhline(0.0, color=style.REFERENCE, linewidth=0.7)
        of_exponent.set_ylabel("largest Lyapunov\nexponent (1/s)")
    of_period.set_ylabel("period (cycles);\n0: no period")
    _, top = of_period.get_ylim()
    of_period.set_ylim(-0.5, max(MIN_PERIOD_AXIS, top) + 0.5)
    of_period.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    of_period.set_xlabel(_axis_label(diagram))
    (drawing,) = style.finished(
        "diagram",
        sheet,
        [pen for _, pen, _ in branches],
        has_exponent=has_exponent,
        parameter=diagram.parameter,
        cycles=diagram.cycles,
        summary=diagram.summary(),
    )
    return drawing


@matplotlib.rc_context(style.SETTINGS)
def draw_quantity(diagram: "Diagram", name: str) -> Drawing:
    """Return a quantity of each stored cycle over the parameter, of both branches."""
    column = diagram.quantities[name]
    sheet, ((axes,),) = style.panels(1, 1, 3.0)
    branches = _branches(diagram)
    for direction, pen, value in branches:
        _draw_dots(axes, value, diagram.numbers(name, direction), pen.colour)
    style.label_values(axes, name, column.unit)
    axes.set_xlabel(_axis_label(diagram))
    (drawing,) = style.finished(
        "diagram_quantity",
        sheet,
        [pen for _, pen, _ in branches],
        quantity=name,
        text=column.text,
        parameter=diagram.parameter,
        cycles=diagram.cycles,
    )
    return drawing


def _draw_dots(axes: Axes, value: Array, numbers: Array, colour: str) -> None:
    """Draw numbers over the values of a parameter, shape (values, cycles), as dots."""
    size = float(np.clip(DOT_AREA / numbers.size, 0.6, 6.0))
    values = np.repeat(value[:, np.newaxis], numbers.shape[1], axis=1)
    axes.scatter(values, numbers, s=size, color=colour, linewidths=0.0, rasterized=True)


def _draw_pins(
    panels: Sequence[Axes],
    diagram: "Diagram",
    direction: str,
    value: Array,
    colour: str,
) -> None:
    """Draw the directions of the pins at the end of the stored cycles over a parameter."""
    # pins at the last phase of each cycle
    at_end = diagram.branches[direction].pins[:, :, -1]
    for k, axes in enumerate(panels):
        angle = np.degrees(np.arctan2(at_end[:, :, k, 1], at_end[:, :, k, 0]))
        _draw_dots(axes, value, angle, colour)


def _draw_exponent(
    axes: Axes, diagram: "Diagram", direction: str, value: Array, colour: str
) -> None:
    """Draw the largest Lyapunov exponent with its interval over a parameter."""
    order = np.argsort(value)
    mean, half = diagram.branches[direction].exponent[order].T
    axes.fill_between(
        value[order], mean - half, mean + half, color=colour, alpha=0.2, linewidth=0.0
    )
    axes.plot(value[order], mean, color=colour, linewidth=0.8)


def _draw_periods(
    axes: Axes, diagram: "Diagram", direction: str, value: Array, colour: str
) -> None:
    """Draw the periods over a parameter; none at a value without a run."""
    _, marker = BRANCHES[direction]
    periods = []
    for motion in diagram.periods(direction):
        periods.append(np.nan if motion is None else motion.period or NO_PERIOD)
    axes.plot(
        value,
        periods,
        marker,
        color=colour,
        markersize=3.0,
        fillstyle="none",
        markeredgewidth=0.5,
    )
