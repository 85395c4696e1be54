"""Figures of what the motion is: phase portraits, Poincare sections, modes and spectra."""

import numpy as np

from presswear.analysis.contact_modes import MODES
from presswear.results.modes import (
    HIGHEST_ORDER,
    has_motion,
    impacts_of,
    period_of,
    resonance,
    section_of,
    settled_span,
    spectra_of,
    timeline_of,
)
from presswear.results.result import Result
from presswear.show.figures.motion import path_pens, set_path_limits
from presswear.show.figures.style import (
    REFERENCE,
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
    shown_stages,
    wrapped,
)
from presswear.tools.numbers import readable, unit_scale

BINS = 180
"""Bins of the cycle in a timeline of modes."""
_MODE_COLOURS = ("0.92", "#E69F00", "#0072B2", "#009E73")
_WORDS = ("free", "impact", "sustained", "sticking")
_HARMONICS = 10


def _rattling(result: Result, stages: Stages) -> list[ShownStage]:
    """Stages with a motion of a cycle at least, of a scene with clearance."""
    shown = shown_stages(result, stages)
    return [stage for stage in shown if has_motion(result.scene, stage.data)]


def phase_portrait(result: Result, stages: Stages) -> list[Drawing]:
    """Velocity over place: of what is watched, and of each pin away from its bearing's centre."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints = scene.clearance_joints
    side = (WIDTH - 0.9) / max(len(shown), 2) - 0.1
    height = 0.7 + (0.75 * side + 0.35) * (1 + len(joints))
    sheet = Sheet(figsize=(WIDTH, height), layout="constrained")
    grid = sheet.subplots(1 + len(joints), len(shown), squeeze=False, sharex="row", sharey="row")
    factor, unit = unit_scale("m", max(scene.bearing(joint).clearance for joint in joints))
    for column, stage in zip(grid.T, shown, strict=True):
        own = between(stage.data, *settled_span(scene, stage.data))
        look = {"color": stage.pen.colour, "linewidth": 0.3}
        column[0].plot(1e3 * own.displacement, own.velocity, **look)
        column[0].set_title(wrapped(stage.pen.label, side))
        column[0].set_xlabel(f"displacement of the {scene.output} (mm)")
        for axes, joint in zip(column[1:], joints, strict=True):
            away = np.hypot(*own.joints[joint].eccentricity.T)
            # Rows may follow each other by a rounding.
            time, kept = np.unique(own.time, return_index=True)
            axes.plot(factor * away[kept], np.gradient(away[kept], time), **look)
            clearance = factor * scene.bearing(joint).clearance
            axes.axvline(clearance, color=REFERENCE, linewidth=0.7, linestyle="dashed")
            axes.set_xlabel(f"|e| in joint {joint} ({unit})")
    grid[0, 0].set_ylabel("velocity (m/s)")
    for axes in grid[1:, 0]:
        axes.set_ylabel("d|e|/dt (m/s)")
    caption = (
        f"Velocity of the {scene.output} over its displacement, and rate of the pin's distance "
        "|e| from the centre of its bearing over that distance, in the recorded cycles behind the "
        "start-up. The dashed line is the clearance: beyond it the pin is in contact."
    )
    return [Drawing("phase.png", "Phase portrait", caption, sheet)]


def poincare_section(result: Result, stages: Stages) -> list[Drawing]:
    """Place of each pin once a cycle, a panel for each stage."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints = scene.clearance_joints
    gaps = {joint: scene.bearing(joint).clearance for joint in joints}
    factor, unit = unit_scale("m", max(gaps.values()))
    side = (WIDTH - 0.9) / max(len(shown), 2) - 0.1
    sheet = Sheet(figsize=(WIDTH, 0.95 + (side + 0.1) * len(joints)), layout="constrained")
    grid = sheet.subplots(len(joints), len(shown), squeeze=False, sharex=True, sharey=True)
    widest, phase, counts = max(gaps.values()), 1.0, []
    around = np.linspace(0.0, 2.0 * np.pi, 361)
    told = ", ".join(f"{readable(factor * gap)} {unit}" for gap in dict.fromkeys(gaps.values()))
    circle = path_pens(told, False)[0]
    for row, joint in zip(grid, joints, strict=True):
        for axes, stage in zip(row, shown, strict=True):
            places, phase = section_of(scene, stage.data, joint)
            size = 9.0 if len(places) < 50 else 3.0
            axes.scatter(
                *(factor * places.T), s=size, color=stage.pen.colour, linewidths=0.0, zorder=3
            )
            circle.draw(axes, *(factor * gaps[joint] * np.array([np.cos(around), np.sin(around)])))
            widest = max(widest, float(np.hypot(*places.T).max(initial=0.0)))
            counts.append(len(places))
        row[0].set_ylabel(f"joint {joint}\n$e_y$ ({unit})")
    for axes, stage in zip(grid[0], shown, strict=True):
        axes.set_title(wrapped(stage.pen.label, side))
    for axes in grid[-1]:
        axes.set_xlabel(f"$e_x$ ({unit})")
    set_path_limits(grid.flat, 1.06 * factor * widest)
    found = "; ".join(f"{stage.pen.label}: {period_of(scene, stage.data)}" for stage in shown)
    linkage_phase = scene.mechanism.linkage().phase
    caption = (
        f"Place of each pin in its bearing once a cycle, at {360.0 * (phase % 1.0):.4g} degrees of "
        f"the {linkage_phase}, behind the start-up ({min(counts)} points or more a panel). A "
        f"motion that repeats itself shows as many points as its period has cycles. {found}."
    )
    legend(sheet, [circle], "outside upper center")
    return [Drawing("poincare.png", "Poincaré section", caption, sheet)]


def impact_section(result: Result, stages: Stages) -> list[Drawing]:
    """Closing speed over the cycle at every touchdown, a panel for joint and stage."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints, phase = scene.clearance_joints, scene.mechanism.linkage().phase
    found = [[impacts_of(scene, stage.data, joint) for stage in shown] for joint in joints]
    fastest = max(float(speed.max(initial=0.0)) for row in found for _, speed in row)
    if fastest == 0.0:
        return []
    sheet = Sheet(figsize=(WIDTH, 0.7 + 1.5 * len(joints)), layout="constrained")
    grid = sheet.subplots(len(joints), len(shown), squeeze=False, sharex=True, sharey=True)
    for row, panels, joint in zip(found, grid, joints, strict=True):
        for (where, speed), axes, stage in zip(row, panels, shown, strict=True):
            axes.scatter(360.0 * where, speed, s=4.0, color=stage.pen.colour, linewidths=0.0)
            # Most touchdowns of a pin that rests are far slower than those that end a flight.
            axes.set_yscale("log")
        panels[0].set_ylabel(f"joint {joint}\nclosing speed (m/s)")
    for axes, stage in zip(grid[0], shown, strict=True):
        axes.set_title(wrapped(stage.pen.label, (WIDTH - 0.9) / len(shown)))
    for axes in grid[-1]:
        axes.set_xlabel(f"{phase} in the cycle (degrees)")
        axes.set_xticks(np.arange(0.0, 361.0, 90.0))
        axes.set_xlim(0.0, 360.0)
    fewest = min(len(speed) for row in found for _, speed in row)
    caption = (
        f"Every touchdown in the recorded cycles behind the start-up ({fewest} or more a panel): "
        f"the {phase} at which the pin meets its bearing, and the speed at which they close. A "
        "motion that repeats itself after k cycles shows each of its touchdowns as k points."
    )
    return [Drawing("impacts.png", "Section at touchdown", caption, sheet)]


def contact_modes(result: Result, stages: Stages) -> list[Drawing]:
    """Part of the time in each mode of contact over the cycle, a panel for joint and stage."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints, period = scene.clearance_joints, scene.mechanism.period
    sheet = Sheet(figsize=(WIDTH, 0.9 + 1.6 * len(shown)), layout="constrained")
    grid = sheet.subplots(len(shown), len(joints), squeeze=False, sharex=True, sharey=True)
    for row, stage in zip(grid, shown, strict=True):
        for axes, joint in zip(row, joints, strict=True):
            own = timeline_of(scene, stage.data, joint)
            _stack(axes, 100.0 * own.over_phase(period, BINS))
            parts = zip(_WORDS, own.shares.values(), strict=True)
            told = ", ".join(f"{word} {100.0 * part:.2f}" for word, part in parts)
            axes.set_title(f"{stage.pen.label}, {joint}\n{told} %", fontsize=7.0)
        row[0].set_ylabel("part of the time (%)")
    for axes in grid[-1]:
        axes.set_xlabel(f"{scene.mechanism.linkage().phase} in the cycle (degrees)")
        axes.set_xticks(np.arange(0.0, 361.0, 90.0))
    pens = [Pen(name, c, width=5.0) for name, c in zip(MODES, _MODE_COLOURS, strict=True)]
    legend(sheet, pens, "outside upper center")
    caption = (
        "Part of the time that each joint spends in each mode, over the cycle and, above, in all, "
        "in the recorded cycles behind the start-up. An impact is a contact that lasts at most "
        "twice as long as the fastest quarter of the contacts do, by Hertz's law at its own "
        "closing speed; every other contact is sustained, and sticking while it slides more slowly "
        "than the lower speed of the friction law."
    )
    return [Drawing("modes.png", "Modes of contact", caption, sheet)]


def _stack(axes: Axes, parts: Array) -> None:
    """Parts in the bins of a cycle on top of each other, up to 100 %."""
    edges = np.linspace(0.0, 360.0, BINS + 1)
    parts = np.column_stack([parts, parts[:, -1]])
    axes.stackplot(edges, parts, colors=_MODE_COLOURS, linewidth=0.0, step="post")
    axes.set_xlim(0.0, 360.0)
    axes.set_ylim(0.0, 100.0)
    axes.grid(False)


def spectrum(result: Result, stages: Stages) -> list[Drawing]:
    """Spectra of acceleration and contact forces, with harmonics and the contact resonance."""
    shown, scene = _rattling(result, stages), result.scene
    if not shown:
        return []
    joints, period = scene.clearance_joints, scene.mechanism.period
    count = 1 + len(joints)
    sheet = Sheet(figsize=(WIDTH, 0.6 + 1.9 * count), layout="constrained")
    panels = sheet.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    told = []
    for stage in shown:
        for axes, found in zip(panels, spectra_of(scene, stage.data).values(), strict=True):
            stage.pen.draw(axes, found.order[1:], found.density[1:], linewidth=0.6)
    for axes, joint in zip(panels[1:], joints, strict=True):
        known = {stage.pen.colour: resonance(stage.data, joint) for stage in shown}
        for colour, frequency in known.items():
            if frequency is not None:
                axes.axvline(frequency * period, color=colour, linewidth=0.9, linestyle="dashdot")
        hertz = sorted(frequency for frequency in known.values() if frequency is not None)
        if hertz:
            ends = dict.fromkeys(map(readable, (hertz[0], hertz[-1])))
            told.append(f"{joint} {' to '.join(ends)} Hz")
        axes.set_ylabel(f"force at {joint}\n(N²/Hz)")
    panels[0].set_ylabel("acceleration\n((m/s²)²/Hz)")
    for axes in panels:
        axes.set_xscale("log")
        axes.set_yscale("log")
        for order in range(1, _HARMONICS + 1):
            axes.axvline(order, color="0.8", linewidth=0.6, zorder=0.5)
    axes.set_xlim(0.2, HIGHEST_ORDER)
    panels[-1].set_xlabel("frequency in turns of the cycle (orders)")
    legend(sheet, [stage.pen for stage in shown], "outside upper center")
    caption = (
        f"Power spectral density of the acceleration of the {scene.output} and of the normal "
        f"forces (Welch), over the frequency in cycles of {readable(1e3 * period)} ms; grey lines "
        f"are the crank's first {_HARMONICS} harmonics."
    )
    if told:
        caption += (
            " Dash-dotted: the contact resonance, one over twice the median impact "
            f"({'; '.join(told)})."
        )
    return [Drawing("spectrum.png", "Spectra", caption, sheet)]
