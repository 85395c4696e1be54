"""Figures of final motions: survival of the irregular motion, and half-life over a parameter."""

from typing import Any

import matplotlib
import numpy as np

from presswear.analysis.final_motions import FinalMotions, FinalMotionsAt
from presswear.analysis.settling_tables import summary
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing, Pen
from presswear.tools.numbers import readable, unit_scale

_MARKERS = "osD^v<>p"  # markers of final motions; the first is that of most starts
_BAND = 0.2  # opacity of an interval
CURVE = Pen("starts", style.LINES[0][0])
FIT = Pen("exponential law", *style.LINES[1])


def drawings_of(result: FinalMotions) -> list[Drawing]:
    """Return the figures of final motions: of a scene, or over a parameter."""
    if result.parameter is not None:
        return [draw_half_life(result)]
    return [draw_settling(result, settled) for settled in result.values]


@matplotlib.rc_context(style.SETTINGS)
def draw_settling(result: FinalMotions, settled: FinalMotionsAt) -> Drawing:
    """Return the survival curve of the irregular motion, and the starts by final motion."""
    sheet, grid = style.panels(1, 2, 3.4, is_measured=True)
    _draw_survival(grid[0, 0], settled)
    joint = _draw_starts(grid[0, 1], result, settled)
    pens = [CURVE, FIT] if settled.half_life else [CURVE]
    (drawing,) = style.finished(
        "settling",
        sheet,
        pens,
        startup=STARTUP_CYCLES,
        summary=summary(result, settled),
        joint=joint,
    )
    return drawing


def _draw_survival(axes: Axes, settled: FinalMotionsAt) -> None:
    """Draw the share of starts that have not settled over the cycles, with the exponential law."""
    cycles, share = settled.unsettled()
    is_shown = share > 0.0
    CURVE.draw(axes, cycles[is_shown], 100.0 * share[is_shown], drawstyle="steps-post")
    half_life = settled.half_life
    if half_life is not None:
        late = cycles[cycles >= STARTUP_CYCLES]
        age = late - STARTUP_CYCLES
        first = 100.0 * share[min(STARTUP_CYCLES, len(share) - 1)]
        low, high = _ends_of(half_life)
        FIT.draw(axes, late, first * 0.5 ** (age / half_life.mean))
        axes.fill_between(
            late,
            first * 0.5 ** (age / low),
            first * 0.5 ** (age / high),
            color=FIT.colour,
            alpha=_BAND,
            linewidth=0.0,
        )
    axes.set_yscale("log", subs=style.SUBTICKS)
    axes.set_ylim(50.0 / max(settled.counted, 1), 120.0)
    axes.set_xlim(0.0, None)
    axes.set_xlabel("cycles")
    axes.set_ylabel("starts not settled (%)")


def _draw_starts(axes: Axes, result: FinalMotions, settled: FinalMotionsAt) -> str:
    """Draw where the pin with the largest force starts, by final motion; return its joint."""
    largest = dict.fromkeys(settled.joints, 0.0)
    for motion in settled.motions:
        for name in largest:
            largest[name] = max(largest[name], motion.peak_force[name])
    joint = max(largest, key=lambda name: largest[name])
    k = settled.joints.index(joint)
    clearance = result.scene.bearing(joint).clearance
    factor, unit = unit_scale("m", clearance)
    for number, motion in enumerate(settled.motions):
        x, y = factor * settled.runs.eccentricity[list(motion.runs), k].T
        force = f"{readable(motion.peak_force[joint], 4)} N"
        if motion.period is None:
            line_style: dict[str, Any] = {"marker": "x", "color": style.MUTED}
            label = f"irregular: {force}"
        else:
            colour = style.LINES[number % len(style.LINES)][0]
            line_style = {"marker": _MARKERS[number % len(_MARKERS)], "color": colour}
            label = f"period {motion.period}: {force}"
        axes.scatter(x, y, 14.0, label=label, linewidths=0.8, **line_style)
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = factor * clearance * np.array([np.cos(turn), np.sin(turn)])
    axes.plot(*circle, color=style.REFERENCE, linewidth=0.7)
    axes.set_aspect("equal")
    limit = 1.1 * factor * clearance
    axes.set_ylim(-limit, limit)
    axes.set_xlabel(f"start of the pin at {joint}, x ({unit})")
    axes.set_ylabel(f"start of the pin at {joint}, y ({unit})")
    # Above the axes no marker of the legend is mistaken for a start.
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return joint


@matplotlib.rc_context(style.SETTINGS)
def draw_half_life(result: FinalMotions) -> Drawing:
    """Return half-life, share of settled starts and peak force over the parameter."""
    assert result.parameter is not None
    parameter = result.parameter
    factor, unit = unit_scale(parameter.unit, parameter.values[-1])
    sheet, grid = style.panels(3, 1, 6.0, is_measured=True, sharex=True)
    of_half_life, of_share, of_force = grid[:, 0]
    colour = style.LINES[0][0]
    for settled in result.values:
        value = factor * (settled.value or 0.0)
        _draw_half_life(of_half_life, value, settled)
        share = (settled.counted - settled.irregular) / max(settled.counted, 1)
        of_share.plot(value, 100.0 * share, "o", color=colour)
        for motion in settled.motions:
            marker = "x" if motion.period is None else "o"
            force = max(motion.peak_force.values())
            size = 2.0 + 4.0 * motion.share.mean
            of_force.plot(value, force, marker, color=colour, markersize=size)
    of_half_life.set_ylabel("half-life of the\nirregular motion (cycles)")
    of_share.set_ylabel("starts that\nsettled (%)")
    of_share.set_ylim(-5.0, 105.0)
    of_force.set_ylabel("peak force of the\nfinal motions (N)")
    of_force.set_xlabel(f"{parameter.key} ({unit})" if unit else parameter.key)
    of_half_life.plot(
        [], [], "^", color=colour, fillstyle="none", label="lower limit, 95 %"
    )
    of_force.plot([], [], "x", color=colour, label="irregular motion")
    for axes in of_half_life, of_force:
        axes.set_yscale("log", subs=style.SUBTICKS)
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0))
    sheet.align_ylabels()
    (drawing,) = style.finished(
        "half-life", sheet, parameter=parameter, watch=result.watch
    )
    return drawing


def _ends_of(estimate: Estimate) -> tuple[float, float]:
    """Return the ends of an interval; the mean if there is no interval."""
    return estimate.low or estimate.mean, estimate.high or estimate.mean


def _draw_half_life(axes: Axes, value: float, settled: FinalMotionsAt) -> None:
    """Draw a half-life with its interval, or an arrow from its lower limit."""
    colour = style.LINES[0][0]
    half_life = settled.half_life
    if half_life is not None:
        mean = half_life.mean
        low, high = _ends_of(half_life)
        errors = [[mean - low], [high - mean]]
        axes.errorbar(value, mean, errors, fmt="o", color=colour)
    elif settled.least_half_life is not None:
        axes.plot(value, settled.least_half_life, "^", color=colour, fillstyle="none")
