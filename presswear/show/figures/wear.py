"""Figures of wear depth, over angle and over the cycles that a campaign stands for."""

from itertools import accumulate

import numpy as np
from matplotlib.ticker import MultipleLocator

from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult
from presswear.show.figures.style import (
    LINES,
    MICRONS,
    MUTED,
    WIDTH,
    Array,
    Axes,
    Drawing,
    Pen,
    Sheet,
    Stages,
    angle_label,
    legend,
    maps_turn,
    shown_stages,
)

_LINEAR_RATIO = 20.0
"""Ratio of the largest to the smallest peak up to which one linear scale shows both."""
_MILLIONS = 1e-6
_SURFACES = {side: Pen(side, *line) for side, line in zip(SIDES, LINES, strict=False)}
_MARKED_STEPS = 60
"""Most steps whose ends are marked; more would be a thick line."""
_NAMED_WEARS = 2
"""Most wears whose names stand beside each other above a panel; of more, the last is named."""

_HARDLY = 0.05
"""Part of the greatest depth up to which a place is hardly worn."""
_TICKS = 60.0
"""Between two ticks of an axis of angles, degrees."""

Curve = tuple[Pen, Array]
"""Depth at the bin centres, m, and its line."""


def wear_depth(result: Result, stages: Stages) -> list[Drawing]:
    """Cumulative wear depth over angle at each clearance joint."""
    parts = [(side,) for side in SIDES] if maps_turn(result) else [SIDES]
    panels = [
        (joint, sides, _curves(result, stages, joint, sides))
        for joint in result.scene.clearance_joints
        for sides in parts
    ]
    # By name: every panel may lack a line that another has.
    pens = {pen.label: pen for _, _, curves in panels for pen, _ in curves}
    if not pens:
        return []
    rows = len(panels) // len(parts)
    sheet = Sheet(figsize=(WIDTH, 0.5 + 2.3 * rows), layout="constrained")
    grid = sheet.subplots(rows, len(parts), squeeze=False)
    for axes, (joint, sides, curves) in zip(grid.flat, panels, strict=True):
        _draw_depth(axes, stages[0].joints[joint].angle, curves)
        axes.set_xlabel(angle_label(result, sides[0]))
        axes.set_ylabel(f"depth, {' + '.join(sides)} (µm)")
        axes.set_title(f"joint {joint}", loc="left", fontweight="bold")
    legend(sheet, pens.values(), "outside upper right")
    caption = (
        "Wear depth of bearing and pin, each over the angle on its own body, in total after each "
        "wear."
        if maps_turn(result)
        else "Wear depth of bearing and pin together over the direction of contact, in total "
        "after each wear."
    )
    if any(axes.get_xlim()[0] for axes in grid.flat):
        caption += " An axis begins where least is worn, so that no groove is cut in two."
    if any(pen.colour == MUTED for pen in pens.values()):
        jump = " in a single jump" if result.grew_in_steps else ""
        caption += f" The grey line adds what the last stage would wear off{jump}; none ran on it."
    if any(axes.get_yscale() == "log" for axes in grid.flat):
        caption += " The scale is logarithmic where the peaks differ much; lower depths are cut."
    return [Drawing("wear-depth.png", "Wear depth", caption, sheet)]


def _curves(result: Result, stages: Stages, joint: str, sides: tuple[str, ...]) -> list[Curve]:
    """Cumulative depth after each wear that left anything, the one after the last stage too."""

    def total(stage: StageResult, *kinds: str) -> Array:
        own = stage.joints[joint].arrays
        return np.asarray(sum(own[f"{kind}_{side}"] for side in sides for kind in kinds))

    curves = [
        (stage.pen, total(stage.data, "depth"))
        for stage in shown_stages(result, stages)
        if stage.data.is_worn
    ]
    last = stages[-1]
    # Behind a life nobody asks for more.
    if last is result.stages[-1] and not last.failed and result.life is None:
        not_run = Pen(f"{result.stage_name(last.index + 1)}, not run", MUTED, (0.0, (2.0, 2.0)))
        curves.append((not_run, total(last, "depth", "wear")))
    return [(pen, depth) for pen, depth in curves if np.any(depth > 0.0)]


def seam(angle: Array, depths: list[Array]) -> float:
    """Angle at which to cut a full turn open, degrees: 0 where nothing is worn there.

    Else amid the widest stretch that is hardly worn, so that no lobe is cut in two.

    Parameters
    ----------
    angle, depths : ndarray, shape (n,) each
        rad, from 0 to a turn; m.
    """
    deepest = np.max([depth / depth.max(initial=1e-300) for depth in depths], axis=0, initial=0.0)
    is_worn = deepest > max(_HARDLY, float(deepest.min(initial=1.0)))
    if not is_worn.any() or not (is_worn[0] or is_worn[-1]):
        return 0.0
    worn = np.degrees(angle[is_worn])
    gaps = np.diff(worn, append=worn[0] + 360.0)
    k = int(np.argmax(gaps))
    return 10.0 * round(float(worn[k] + 0.5 * gaps[k]) / 10.0) % 360.0


def _draw_depth(axes: Axes, angle: Array, curves: list[Curve]) -> None:
    peaks = [MICRONS * float(depth.max()) for _, depth in curves]
    begin = seam(angle, [depth for _, depth in curves])
    since = (np.degrees(angle) - begin) % 360.0
    order = np.argsort(since)
    for pen, depth in curves:
        width = 0.9 if pen.colour == MUTED else 1.2
        pen.draw(axes, begin + since[order], MICRONS * depth[order], linewidth=width)
    axes.set_xlim(begin, begin + 360.0)
    axes.xaxis.set_major_locator(MultipleLocator(_TICKS))
    axes.xaxis.set_major_formatter(lambda place, _: f"{place % 360.0:.0f}")
    if peaks and max(peaks) > _LINEAR_RATIO * min(peaks):
        axes.set_yscale("log", nonpositive="mask")
        axes.set_ylim(min(peaks) / 100.0, 2.0 * max(peaks))
    else:
        axes.set_ylim(0.0, None)


def wear_growth(result: Result, stages: Stages) -> list[Drawing]:
    """Deepest depth of each surface over represented cycles, where wear went in steps.

    Nothing of a life, which has a figure of its own.
    """
    grew = result.grew_in_steps and any(stage.wear_steps for stage in stages)
    if result.life is not None or not grew:
        return []
    joints = result.scene.clearance_joints
    steps = [step for stage in result.stages for step in stage.wear_steps]
    cycles = list(accumulate((_MILLIONS * step.cycles_per_update for step in steps), initial=0.0))
    first = sum(len(stage.wear_steps) for stage in result.stages if stage.index < stages[0].index)
    last, ends = first, []
    for stage in stages:
        last += len(stage.wear_steps)
        if stage.wear_steps:
            ends.append((cycles[last], result.stage_name(stage.index + 1)))
    shown = slice(first, last + 1)
    marker = "." if last - first < _MARKED_STEPS else ""
    sheet = Sheet(figsize=(WIDTH, 2.9), layout="constrained")
    grid = sheet.subplots(1, len(joints), squeeze=False)
    for axes, joint in zip(grid.flat, joints, strict=True):
        for side, pen in _SURFACES.items():
            begun = float(result.stages[0].joints[joint].depth(side).max())
            depth = MICRONS * np.array([begun, *(step.max_depth[joint][side] for step in steps)])
            pen.draw(axes, cycles[shown], depth[shown], marker=marker, markersize=4.0)
        _mark_wears(axes, ends)
        axes.set_xlim(cycles[first], None)
        axes.set_ylim(0.0, None)
        axes.set_xlabel("represented cycles (million)")
        axes.set_ylabel("deepest wear (µm)")
        axes.set_title(f"joint {joint}", loc="left", fontweight="bold")
    legend(sheet, _SURFACES.values(), "outside upper right")
    caption = (
        "Deepest wear of each surface over the cycles that the runs stand for, as the mean of "
        "the starts. Every point is a simulated cycle, after which the surfaces were rebuilt. "
        "Grey lines end a wear. The deepest place may move along a surface."
    )
    if not maps_turn(result):
        caption += " Both surfaces are shown apart, each with its share of the depth."
    return [Drawing("wear-growth.png", "Growth of the wear", caption, sheet)]


def _mark_wears(axes: Axes, ends: list[tuple[float, str]]) -> None:
    for end, _ in ends:
        axes.axvline(end, color=MUTED, linewidth=0.6)
    for end, name in ends if len(ends) <= _NAMED_WEARS else ends[-1:]:
        axes.annotate(
            name,
            (end, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0.0, 2.0),
            textcoords="offset points",
            ha="right",
            va="bottom",
            color=MUTED,
        )
