"""Figures of the dynamics: phase portraits, Poincare sections, contact modes and spectra."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from presswear.analysis.contact_modes import MODES, resonance, timeline_of
from presswear.analysis.periods import impacts_of, period_of, section_of
from presswear.analysis.spectra import MAX_ORDER, spectra_of
from presswear.results import press_analysis as press
from presswear.results.result import Result
from presswear.show.figures import style
from presswear.show.figures.motion import pin_panels
from presswear.show.figures.style import Array, Axes, Drawing, Pen, ShownStage, Stages
from presswear.tools.numbers import readable, unit_scale

BINS = 180  # bins of the cycle in a timeline of modes
_MODE_COLOURS = ("0.92", "#E69F00", "#0072B2", "#009E73")
_MODE_WORDS = ("free", "impact", "sustained", "sticking")
_HARMONICS = 10  # harmonics of the crank that are marked


def _rattling(result: Result, stages: Stages) -> list[ShownStage]:
    """Return the shown stages with at least a cycle of motion in joints with clearance."""
    shown = style.shown_stages(result, stages)
    return [stage for stage in shown if press.has_motion(result.scene, stage.data)]


def _label_phase(row: Sequence[Axes], result: Result) -> None:
    for axes in row:
        axes.set_xlabel(f"{result.scene.mechanism.linkage().phase} in the cycle (degrees)")
        axes.set_xticks(np.arange(0.0, 361.0, 90.0))
        axes.set_xlim(0.0, 360.0)


def phase_portrait(result: Result, stages: Stages) -> list[Drawing]:
    """Draw velocity over position: of the output, and of each pin along the line of centres."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints, side = scene.clearance_joints, style.square_side(len(shown))
    count = 1 + len(joints)
    height = 0.7 + (0.75 * side + 0.35) * count
    sheet, grid = style.panels(count, len(shown), height, sharex="row", sharey="row")
    factor, unit = unit_scale("m", max(scene.bearing(joint).clearance for joint in joints))
    for column, stage in zip(grid.T, shown, strict=True):
        data = style.between(stage.data, *press.settled_span(scene, stage.data))
        look: dict[str, Any] = {"color": stage.pen.colour, "linewidth": 0.3}
        column[0].plot(1e3 * data.displacement, data.velocity, **look)
        column[0].set_xlabel(f"displacement of the {scene.output} (mm)")
        for axes, joint in zip(column[1:], joints, strict=True):
            distance = np.hypot(*data.joints[joint].eccentricity.T)
            # Times of successive rows may differ by round-off only.
            time, rows = np.unique(data.time, return_index=True)
            axes.plot(factor * distance[rows], np.gradient(distance[rows], time), **look)
            clearance = factor * scene.bearing(joint).clearance
            axes.axvline(clearance, color=style.REFERENCE, linewidth=0.7, linestyle="dashed")
            axes.set_xlabel(f"|e| in joint {joint} ({unit})")
    style.title_stages(grid, shown, side)
    for axes, label in zip(grid[:, 0], ("velocity", *["d|e|/dt"] * len(joints)), strict=True):
        axes.set_ylabel(f"{label} (m/s)")
    return style.finished("phase", sheet, scene=scene)


def poincare_section(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the position of each pin once per cycle, a panel for each stage."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    phase, counts = 1.0, []

    def draw(axes: Axes, stage: ShownStage, joint: str, factor: float) -> Array:
        nonlocal phase
        points, phase = section_of(scene, stage.data, joint)
        counts.append(len(points))
        x, y = factor * points.T
        size = 9.0 if len(points) < 50 else 3.0
        axes.scatter(x, y, size, stage.pen.colour, linewidths=0.0, zorder=3)
        return points.T

    sheet, circle = pin_panels(result, shown, draw)
    return style.finished(
        "poincare",
        sheet,
        [circle],
        scene=scene,
        angle=360.0 * (phase % 1.0),
        fewest=min(counts),
        periods=[f"{one.pen.label}: {period_of(scene, one.data)}" for one in shown],
    )


def impact_section(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the closing speed over the cycle at every touchdown, a panel for joint and stage."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints = scene.clearance_joints
    impacts = [[impacts_of(scene, stage.data, joint) for stage in shown] for joint in joints]
    if not any(speed.any() for row in impacts for _, speed in row):
        return []
    height = 0.7 + 1.5 * len(joints)
    sheet, grid = style.panels(len(joints), len(shown), height, sharex=True, sharey=True)
    for data, row, joint in zip(impacts, grid, joints, strict=True):
        for (when, speed), axes, stage in zip(data, row, shown, strict=True):
            axes.scatter(360.0 * when, speed, s=4.0, color=stage.pen.colour, linewidths=0.0)
            # Most touchdowns of a resting pin are far slower than those that end a flight.
            axes.set_yscale("log")
        row[0].set_ylabel(f"joint {joint}\nclosing speed (m/s)")
    style.title_stages(grid, shown, (style.WIDTH - 0.9) / len(shown))
    _label_phase(grid[-1], result)
    fewest = min(len(speed) for row in impacts for _, speed in row)
    return style.finished("impacts", sheet, scene=scene, fewest=fewest)


def contact_modes(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the share of each contact mode over the cycle, a panel for joint and stage."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints, height = scene.clearance_joints, 0.9 + 1.6 * len(shown)
    sheet, grid = style.panels(len(shown), len(joints), height, sharex=True, sharey=True)
    for row, stage in zip(grid, shown, strict=True):
        for axes, joint in zip(row, joints, strict=True):
            line = timeline_of(scene, stage.data, joint)
            _stack(axes, 100.0 * line.over_phase(scene.mechanism.period, BINS))
            shares = zip(_MODE_WORDS, line.shares.values(), strict=True)
            text = ", ".join(f"{word} {100.0 * share:.2f}" for word, share in shares)
            axes.set_title(f"{stage.pen.label}, {joint}\n{text} %", fontsize=7.0)
        row[0].set_ylabel("part of the time (%)")
    _label_phase(grid[-1], result)
    pens = [Pen(name, c, width=5.0) for name, c in zip(MODES, _MODE_COLOURS, strict=True)]
    return style.finished("modes", sheet, pens)


def _stack(axes: Axes, parts: Array) -> None:
    edges = np.linspace(0.0, 360.0, BINS + 1)
    parts = np.column_stack([parts, parts[:, -1]])
    axes.stackplot(edges, parts, colors=_MODE_COLOURS, linewidth=0.0, step="post")
    axes.set_ylim(0.0, 100.0)
    axes.grid(False)


def spectrum(result: Result, stages: Stages) -> list[Drawing]:
    """Draw spectra of acceleration and contact forces, with harmonics and contact resonance."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints, period = scene.clearance_joints, scene.mechanism.period
    sheet, grid = style.panels(1 + len(joints), 1, 0.6 + 1.9 * (1 + len(joints)), sharex=True)
    column, resonances = grid[:, 0], []
    for stage in shown:
        for axes, density in zip(column, spectra_of(scene, stage.data).values(), strict=True):
            stage.pen.draw(axes, density.order[1:], density.density[1:], linewidth=0.6)
    for axes, joint in zip(column[1:], joints, strict=True):
        frequencies = [(stage.pen.colour, resonance(stage.data, joint)) for stage in shown]
        for colour, frequency in frequencies:
            if frequency is not None:
                axes.axvline(frequency * period, color=colour, linewidth=0.9, linestyle="dashdot")
        if hertz := sorted(frequency for _, frequency in frequencies if frequency is not None):
            ends = dict.fromkeys(map(readable, (hertz[0], hertz[-1])))
            resonances.append(f"{joint} {' to '.join(ends)} Hz")
        axes.set_ylabel(f"force at {joint}\n(N²/Hz)")
    column[0].set_ylabel("acceleration\n((m/s²)²/Hz)")
    for axes in column:
        axes.set_xscale("log")
        axes.set_yscale("log")
        for order in range(1, _HARMONICS + 1):
            axes.axvline(order, color="0.8", linewidth=0.6, zorder=0.5)
    column[-1].set_xlim(0.2, MAX_ORDER)
    column[-1].set_xlabel("frequency in turns of the cycle (orders)")
    pens = [stage.pen for stage in shown]
    content: dict[str, Any] = {"harmonics": _HARMONICS, "resonances": resonances}
    return style.finished("spectrum", sheet, pens, scene=scene, **content)
