"""Figures of wear: depth over angle and over cycles, outlines and profiles of worn surfaces."""

import math
from collections.abc import Sequence
from itertools import accumulate, chain, product
from typing import NamedTuple

import numpy as np
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MultipleLocator

from presswear.linkage.surface import SIDES, Surface
from presswear.results.joint_result import JointResult
from presswear.results.result import Result
from presswear.results.stage import WearStep
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing, Pen, Sheet, Shown, Stages
from presswear.tools.arrays import Array
from presswear.tools.numbers import readable, unit_factor

# largest over smallest peak up to which one linear scale shows both
_LINEAR_RATIO = 20.0
_BARELY_WORN = 0.05  # depth relative to the deepest up to which a place is hardly worn
_TICKS = 60.0  # degrees between ticks of an axis of angles
_MARKED_STEPS = 60  # most steps whose ends are marked; more would be a thick line
# most wear updates named beside each other; of more, the last is named
_NAMED_UPDATES = 2
_SURFACES = {
    side: Pen(side, *line) for side, line in zip(SIDES, style.LINES, strict=False)
}
_MAX_OUTLINES = 4  # joints whose worn surfaces are drawn, each in a figure
_DRAWN_DEPTH = 0.25  # largest wear depth in an outline, relative to the bearing radius
LEAST_MILLION = 2e5  # cycles from which on they are counted by the million
_MATERIAL = "0.91"  # colour
_NEW = Pen("no wear", style.REFERENCE, "dotted", 0.8)
# Left, bottom, width and height in inches, because the scales of the profiles follow
# from them.
_HEIGHT = 4.3
_OUTLINE = (0.42, 0.62, 2.75, 2.75)
_PROFILES = {"bearing": (4.0, 2.45, 2.85, 1.3), "pin": (4.0, 0.5, 2.85, 1.3)}
_OUTWARDS = {"bearing": 1.0, "pin": -1.0}  # direction in which wear moves a surface

Worn = tuple[Pen, JointResult]
_RIGHT = "outside upper right"


def wear_depth(result: Result, shown: Shown) -> list[Drawing]:
    """Draw the cumulative wear depth over angle at each clearance joint."""
    joints = [name for name in result.scene.loose_pins if _wears(name, shown)]
    turns = style.maps_turn(result)
    # Maps that turn with the bodies have a panel for each side.
    panel_sides = [(side,) for side in SIDES] if turns else [SIDES]
    places = list(product(joints, panel_sides))
    curves = [_depth_curves(result, shown, *place) for place in places]
    pens: dict[str, Pen] = {}  # by label: a panel may lack a line of another panel
    for lines in curves:
        pens |= {pen.label: pen for pen, _ in lines}
    if not pens:
        return []
    sheet, panels, _ = style.panel_list(len(places), 1.9)
    for axes, (joint, sides), lines in zip(panels, places, curves, strict=True):
        _draw_depth(axes, shown[0].data.joints[joint].angle, lines)
        axes.set_xlabel(style.angle_label(result, sides[0]))
        axes.set_ylabel("depth (µm)")
        axes.set_title(f"joint {joint}, {' + '.join(sides)}")
    return style.finished(
        "wear",
        sheet,
        pens.values(),
        _RIGHT,
        turns=turns,
        is_shifted=any(axes.get_xlim()[0] for axes in panels),
        has_next=any(pen.colour == style.MUTED for pen in pens.values()),
        in_steps=result.grew_in_steps,
        is_log=any(axes.get_yscale() == "log" for axes in panels),
    )


def _wears(joint: str, shown: Shown) -> bool:
    """Return True if a joint wears in some stage; a failed one has no statistics."""
    joints = [stage.data.statistics.joints.get(joint) for stage in shown]
    return not all(result is not None and result.is_unworn for result in joints)


def _depth_curves(
    result: Result, shown: Shown, joint: str, sides: tuple[str, ...]
) -> list[tuple[Pen, Array]]:
    """Return the cumulative depth, m, after each wear update, and after that of the last stage."""
    worn = [(stage.pen, stage.data, ["depth"]) for stage in shown if stage.data.is_worn]
    last = shown[-1].data
    if last is result.stages[-1] and not last.failed and result.life is None:
        name = f"{result.stage_name(last.index + 1)}, not simulated"
        worn.append(
            (Pen(name, style.MUTED, (0.0, (2.0, 2.0)), 0.9), last, ["depth", "wear"])
        )
    curves = []
    for pen, stage, kinds in worn:
        maps = stage.joints[joint].arrays
        names = [f"{kind}_{side}" for side, kind in product(sides, kinds)]
        depth = np.sum([maps[name] for name in names], axis=0)
        if np.any(depth > 0.0):
            curves.append((pen, depth))
    return curves


def _draw_depth(axes: Axes, angle: Array, curves: list[tuple[Pen, Array]]) -> None:
    """Draw depths, m, over the angle, rad, from the place at which the turn is cut open."""
    peaks = [style.MICRONS * float(depth.max()) for _, depth in curves]
    start = seam(angle, [depth for _, depth in curves])
    since = (np.degrees(angle) - start) % 360.0
    order = np.argsort(since)
    for pen, depth in curves:
        pen.draw(axes, start + since[order], style.MICRONS * depth[order])
    axes.set_xlim(start, start + 360.0)
    axes.xaxis.set_major_locator(MultipleLocator(_TICKS))
    axes.xaxis.set_major_formatter(lambda place, _: f"{place % 360.0:.0f}")
    if peaks and max(peaks) > _LINEAR_RATIO * min(peaks):
        axes.set_yscale("log", nonpositive="mask", subs=style.SUBTICKS)
        axes.set_ylim(min(peaks) / 100.0, 2.0 * max(peaks))
    else:
        axes.set_ylim(0.0, None)


def seam(angle: Array, depths: list[Array]) -> float:
    """Return the angle at which to cut a full turn open, degrees, so that no lobe is cut in two.

    It is 0 if nothing is worn there, else the middle of the widest part with little
    wear. Angles are in rad, from 0 to a full turn, depths in m, shape (n,) each.
    """
    relative = [depth / depth.max(initial=1e-300) for depth in depths]
    deepest = np.max(relative, axis=0, initial=0.0)
    is_worn = deepest > max(_BARELY_WORN, float(deepest.min(initial=1.0)))
    if not is_worn.any() or not (is_worn[0] or is_worn[-1]):
        return 0.0
    worn = np.degrees(angle[is_worn])
    gaps = np.diff(worn, append=worn[0] + 360.0)
    k = int(np.argmax(gaps))
    middle = float(worn[k] + 0.5 * gaps[k])
    return 10.0 * round(middle / 10.0) % 360.0


def wear_growth(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the deepest wear of each surface over the represented cycles, if wear went in steps.

    Nothing for a life, which has its own figure, and for walls of guides alone.
    """
    grew = result.grew_in_steps and any(stage.wear_steps for stage in stages)
    joints = result.scene.loose_pins
    if result.life is not None or not grew or not joints:
        return []
    steps = list(chain(*(stage.wear_steps for stage in result.stages)))
    cycles, unit = _cycles_at_ends(steps)
    # Numbers of steps before each stage, and of all steps
    counts = (len(stage.wear_steps) for stage in result.stages)
    steps_before = list(accumulate(counts, initial=0))
    first = steps_before[stages[0].index]
    last = steps_before[stages[-1].index + 1]
    updates = []  # cycles at the end of each wear update, and its name
    for stage in stages:
        if stage.wear_steps:
            end = cycles[steps_before[stage.index + 1]]
            updates.append((end, result.stage_name(stage.index + 1)))
    marker = "." if last - first < _MARKED_STEPS else ""
    shown_cycles = cycles[first : last + 1]
    sheet, panels, _ = style.panel_list(len(joints), 2.3)
    for axes, joint in zip(panels, joints, strict=True):
        for side, pen in _SURFACES.items():
            initial = float(result.stages[0].joints[joint].depth(side).max())
            depths = [initial, *(step.max_depth[joint][side] for step in steps)]
            depth = style.MICRONS * np.array(depths[first : last + 1])
            pen.draw(axes, shown_cycles, depth, marker=marker, markersize=4.0)
        _mark_updates(axes, updates)
        axes.set_xlim(cycles[first], None)
        axes.set_ylim(0.0, None)
        axes.set_xlabel(f"represented cycles ({unit})")
        axes.set_ylabel("deepest wear (µm)")
        axes.set_title(f"joint {joint}")
    pens = _SURFACES.values()
    turns = style.maps_turn(result)
    return style.finished("growth", sheet, pens, _RIGHT, turns=turns)


def _mark_updates(axes: Axes, updates: Sequence[tuple[float, str]]) -> None:
    """Draw a line at the end of each wear update; name all of a few updates, or the last."""
    for end, _ in updates:
        axes.axvline(end, color=style.MUTED, linewidth=0.6)
    named = updates if len(updates) <= _NAMED_UPDATES else updates[-1:]
    for end, name in named:
        axes.text(
            end,
            1.02,
            name,
            transform=axes.get_xaxis_transform(),
            ha="right",
            va="bottom",
            color=style.MUTED,
        )


def _cycles_at_ends(steps: Sequence[WearStep]) -> tuple[list[float], str]:
    """Return the represented cycles at the start and after each step, and their unit."""
    total = sum(step.cycles_per_update for step in steps)
    unit = "million" if total >= LEAST_MILLION else "thousand"
    factor = unit_factor("million") * (1.0 if unit == "million" else 1e3)
    sizes = (factor * step.cycles_per_update for step in steps)
    return list(accumulate(sizes, initial=0.0)), unit


class _View(NamedTuple):
    """Enlarged part of a surface."""

    side: str
    centre: float  # middle of the part, rad
    half: float  # half width of the part, rad
    radius: float  # radius of the new surface, m
    scale: float  # radial scale over the scale along the surface
    span: float  # radial height of the drawing, m


def worn_surfaces(result: Result, shown: Shown) -> list[Drawing]:
    """Draw outline and enlargement of pin and bearing of the joints that are worn most."""
    joints = result.scene.loose_pins
    last = shown[-1].data.joints
    depths = {name: _deepest(last[name]) for name in joints}
    by_depth = sorted(joints, key=lambda name: depths[name], reverse=True)
    most_worn = by_depth[:_MAX_OUTLINES]
    drawings = []
    for joint in joints:
        worn = [stage for stage in shown if _deepest(stage.data.joints[joint]) > 0.0]
        if joint in most_worn and worn:
            drawings.append(worn_surface(result, joint, worn))
    return drawings


def _deepest(maps: JointResult) -> float:
    """Return the largest depth of both surfaces of a joint, m."""
    return max(float(maps.depth(side).max()) for side in SIDES)


def worn_surface(result: Result, joint: str, stages: Shown) -> Drawing:
    """Draw the outline and enlargement of one joint; the material of the last stage is grey."""
    bearing = result.scene.bearing(joint)
    worn = [(stage.pen, stage.data.joints[joint]) for stage in stages]
    _, last_maps = worn[-1]
    views = _views(result, joint, last_maps)
    deepest = max(_deepest(maps) for _, maps in worn)
    factor = max(1.0, style.round_down(_DRAWN_DEPTH * bearing.bearing_radius / deepest))
    scale = "to scale" if factor == 1.0 else f"enlarged {readable(factor, 1)} times"
    sheet = Sheet(figsize=(style.WIDTH, _HEIGHT))
    size = np.array([style.WIDTH, _HEIGHT, style.WIDTH, _HEIGHT])
    outline = PolarAxes(sheet, tuple(_OUTLINE / size))
    sheet.add_axes(outline)
    _draw_outline(outline, worn, factor, views)
    for view in views:
        axes = sheet.add_axes(tuple(_PROFILES[view.side] / size))
        _draw_profile(axes, worn, view)
        axes.set_xlabel(style.angle_label(result, view.side))
    sheet.text(
        0.12 / size[0],
        1.0 - 0.2 / size[1],
        f"joint {joint}",
        va="center",
        weight="bold",
    )
    middle = (_OUTLINE[0] + 0.5 * _OUTLINE[2]) / size[0]
    text = f"wear {scale}, clearance to scale"
    sheet.text(middle, 0.15 / size[1], text, ha="center", va="center")
    pens = [_NEW, *(pen for pen, _ in worn)]
    turns = style.maps_turn(result)
    (drawing,) = style.finished(
        "surface",
        sheet,
        pens,
        "upper right",
        joint=joint,
        turns=turns,
        scale=scale,
        clearance=bearing.clearance,
        deepest=deepest,
    )
    return drawing


def _views(result: Result, joint: str, maps: JointResult) -> list[_View]:
    """Return the part of each surface to enlarge; the same part of both in fixed directions."""
    depth = {side: maps.depth(side) for side in SIDES}
    turns = style.maps_turn(result)
    bearing = result.scene.bearing(joint)
    radii = (bearing.bearing_radius, bearing.bearing_radius - bearing.clearance)
    views = []
    for side, radius in zip(SIDES, radii, strict=True):
        worn = depth[side] if turns else depth["bearing"] + depth["pin"]
        deepest = float(depth[side].max()) if turns else _deepest(maps)
        centre = float(maps.angle[int(worn.argmax())])
        # The half width holds all depths above a tenth of the deepest.
        distance = (maps.angle - centre + math.pi) % (2.0 * math.pi) - math.pi
        is_deep = worn >= 0.1 * worn.max()
        reach = math.degrees(float(np.abs(distance[is_deep]).max()))
        degrees = 5.0 * math.ceil(1.2 * reach / 5.0)
        half = math.radians(min(max(degrees, 10.0), 60.0))
        _, _, width, height = _PROFILES[side]
        # Radial heights with equal scales. The smaller surface sets the scale, because
        # rounding could separate two equal views.
        span = 2.0 * half * radius * height / width
        smaller_span = 2.0 * half * min(radii) * height / width
        scale = 1.0
        if deepest > 0.0:
            scale = style.round_down(max(1.0, smaller_span / (1.12 * deepest)))
        views.append(_View(side, centre, half, radius, scale, span / scale))
    return views


def _draw_outline(
    axes: PolarAxes, worn: list[Worn], factor: float, views: list[_View]
) -> None:
    """Draw both surfaces over the full turn; wear is enlarged by ``factor``."""
    bearing, _ = views
    rim = (1.0 + 1.2 * _DRAWN_DEPTH) * bearing.radius
    around = np.linspace(0.0, 2.0 * math.pi, 361)
    _, last_maps = worn[-1]
    angle = last_maps.angle
    closed = np.append(angle, angle[0] + 2.0 * math.pi)
    for view in views:
        is_bearing = view is bearing
        for pen, maps in worn:
            depth = maps.depth(view.side)
            closed_depth = np.append(depth, depth[0])
            surface = view.radius + _OUTWARDS[view.side] * factor * closed_depth
            if maps is last_maps:
                edge = rim if is_bearing else 0.0
                axes.fill_between(closed, surface, edge, color=_MATERIAL, linewidth=0.0)
            pen.draw(axes, closed, surface, linewidth=1.0)
        _NEW.draw(axes, around, np.full_like(around, view.radius))
        marked = rim if is_bearing else 0.62 * view.radius
        sector = np.linspace(view.centre - view.half, view.centre + view.half, 50)
        axes.plot(
            sector, np.full_like(sector, marked), color=style.REFERENCE, linewidth=2.0
        )
    axes.set_rlim(0.0, 1.02 * rim)
    axes.set_rticks([])
    axes.set_thetagrids(range(0, 360, 45))
    axes.grid(visible=False)
    axes.spines["polar"].set_visible(False)
    axes.text(0.0, 0.0, "pin", ha="center", va="center")
    # Above or below the pin, whichever is farther from the wear.
    away = -math.copysign(0.5 * math.pi, math.sin(bearing.centre))
    axes.text(away, 0.5 * (bearing.radius + rim), "bearing", ha="center", va="center")


def _draw_profile(axes: Axes, worn: list[Worn], view: _View) -> None:
    """Draw the enlarged part of a surface, the depth over the angle."""
    _, last_maps = worn[-1]
    angle = np.linspace(view.centre - view.half, view.centre + view.half, 1200)
    degrees = np.degrees(angle)
    outwards = style.MICRONS * _OUTWARDS[view.side]
    far_edge = outwards * view.span
    for pen, maps in worn:
        position = outwards * Surface(maps.depth(view.side))(angle)
        if maps is last_maps:
            axes.fill_between(
                degrees, position, far_edge, color=_MATERIAL, linewidth=0.0
            )
        pen.draw(axes, degrees, position, linewidth=1.0)
    _NEW.draw(axes, degrees, np.zeros_like(degrees))
    axes.grid(visible=False)
    axes.set_ylim(*sorted((-0.1 * far_edge, 0.9 * far_edge)))
    axes.set_xlim(degrees[0], degrees[-1])
    axes.xaxis.set_major_formatter(lambda value, _: f"{value % 360.0:g}")
    symbol = "R_i" if view.side == "bearing" else "R_j"
    axes.set_ylabel(f"{view.side}, $r - {symbol}$ (µm)", parse_math=True)
    scale = "the same as" if view.scale == 1.0 else f"{readable(view.scale, 1)} times"
    title = f"radial scale {scale} that along the surface"
    axes.set_title(title, loc="center", fontsize=8.0, fontweight="normal")
