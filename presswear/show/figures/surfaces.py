"""Figures of the worn surfaces: outlines with enlarged wear, and true profiles."""

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import FuncFormatter

from presswear.linkage.surface import Surface
from presswear.results.result import Result
from presswear.results.stage import SIDES, JointResult
from presswear.show.figures.style import (
    MICRONS,
    REFERENCE,
    WIDTH,
    Array,
    Axes,
    Drawing,
    Pen,
    Sheet,
    ShownStage,
    Stages,
    angle_label,
    legend,
    maps_turn,
    round_down,
    shown_stages,
)
from presswear.tools.numbers import readable, unit_scale

_DRAWN_DEPTH = 0.25
"""Largest wear depth in an outline, part of the bearing radius."""
_MATERIAL = "0.91"
_NEW = Pen("no wear", REFERENCE, "dotted", 0.8)

# Places in inches, because the scales of the profiles follow from their sizes.
_HEIGHT = 4.3
_OUTLINE = (0.42, 0.62, 2.75, 2.75)
_PROFILES = {"bearing": (4.0, 2.45, 2.85, 1.3), "pin": (4.0, 0.5, 2.85, 1.3)}
_OUTWARDS = {"bearing": 1.0, "pin": -1.0}
"""Direction in which wear moves a surface."""

Worn = tuple[Pen, JointResult]
"""A joint with its surfaces, and the line that they are drawn with."""


@dataclass(frozen=True)
class _View:
    """The part of one surface that is enlarged.

    Attributes
    ----------
    centre, half : float
        Middle and half width, rad.
    radius : float
        Radius of the new surface, m.
    steeper : float
        Radial scale over the scale along the surface.
    """

    side: str
    centre: float
    half: float
    radius: float
    steeper: float

    @property
    def span(self) -> float:
        """Radial range of the drawing, m."""
        return _radial_range(self.side, self.half, self.radius) / self.steeper


def _radial_range(side: str, half: float, radius: float) -> float:
    """Radial range, m, of a profile drawn to one scale in both directions."""
    _, _, width, height = _PROFILES[side]
    return 2.0 * half * radius * height / width


def worn_surfaces(result: Result, stages: Stages) -> list[Drawing]:
    """Outline of pin and worn bearing, and an enlargement, of each worn joint."""
    found = []
    for joint in result.scene.clearance_joints:
        worn = [
            stage
            for stage in shown_stages(result, stages)
            if any(np.any(stage.data.joints[joint].depth(side) > 0.0) for side in SIDES)
        ]
        if worn:
            found.append(worn_surface(result, joint, worn))
    return found


def worn_surface(result: Result, joint: str, stages: list[ShownStage]) -> Drawing:
    """Outline and enlargement of one joint.

    Parameters
    ----------
    result : Result
        A run with the bearings of the joint.
    stages : list of ShownStage
        Stages with the depths to draw, the surface of the last in grey.
    """
    bearings = result.scene.bearing(joint)
    worn = [(stage.pen, stage.data.joints[joint]) for stage in stages]
    angle = worn[-1][1].angle
    views = _views(result, joint, angle, worn[-1][1])
    deepest = max(float(own.depth(side).max()) for _, own in worn for side in SIDES)
    enlarged = max(1.0, round_down(_DRAWN_DEPTH * bearings.bearing_radius / deepest))
    sheet = Sheet(figsize=(WIDTH, _HEIGHT))
    outline = PolarAxes(sheet, _place(_OUTLINE))
    sheet.add_axes(outline)
    _draw_outline(outline, angle, worn, enlarged, views)
    for side, view in views.items():
        axes = sheet.add_axes(_place(_PROFILES[side]))
        _draw_profile(axes, worn, view)
        axes.set_xlabel(angle_label(result, side))
    sheet.text(0.12 / WIDTH, 1.0 - 0.2 / _HEIGHT, f"joint {joint}", va="center", weight="bold")
    middle = (_OUTLINE[0] + 0.5 * _OUTLINE[2]) / WIDTH
    below = f"wear {_times(enlarged)}, clearance to scale"
    sheet.text(middle, 0.15 / _HEIGHT, below, ha="center", va="center")
    pens = [_NEW, *(pen for pen, _ in worn)]
    legend(sheet, pens, "upper right", columnspacing=1.2, borderaxespad=0.2)
    factor, unit = unit_scale("m", deepest)
    caption = (
        f"Pin and bearing of joint {joint}. Left: outlines with the wear depth "
        f"{_times(enlarged)}; the thick line marks the part shown on the right. Right: "
        "the true surfaces around the deepest wear, bearing above and pin below, the "
        f"{1e3 * bearings.clearance:g} mm of clearance between them left out. Deepest wear of "
        f"one surface: {readable(deepest * factor)} {unit}."
    )
    if maps_turn(result):
        caption += " Angles are on each body; the two parts shown need not face each other."
    return Drawing(f"worn-surface-{joint}.png", f"Worn surfaces at {joint}", caption, sheet)


def _times(factor: float) -> str:
    return "to scale" if factor == 1.0 else f"enlarged {readable(factor, 1)} times"


def _place(inches: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    left, bottom, width, height = inches
    return left / WIDTH, bottom / _HEIGHT, width / WIDTH, height / _HEIGHT


def _views(result: Result, joint: str, angle: Array, own: JointResult) -> dict[str, _View]:
    """The part of each surface to enlarge; the same part of both in fixed directions."""
    depth = {side: own.depth(side) for side in SIDES}
    turn = maps_turn(result)
    bearings = result.scene.bearing(joint)
    radii = (bearings.bearing_radius, bearings.bearing_radius - bearings.clearance)
    views = {}
    for side, radius in zip(SIDES, radii, strict=True):
        looked_at = depth[side] if turn else depth["bearing"] + depth["pin"]
        shown = [depth[side]] if turn else list(depth.values())
        deepest = max(float(one.max()) for one in shown)
        half = _half_width(angle, looked_at)
        # The smaller surface sets the scale, or rounding could part two equal views.
        most = _radial_range(side, half, min(radii))
        steeper = max(1.0, round_down(most / (1.12 * deepest))) if deepest > 0.0 else 1.0
        views[side] = _View(side, float(angle[int(looked_at.argmax())]), half, radius, steeper)
    return views


def _half_width(angle: Array, depth: Array) -> float:
    """Half width, rad, that holds every depth above a tenth of the deepest; 10 to 60 degrees."""
    centre = angle[int(depth.argmax())]
    away = np.abs((angle - centre + math.pi) % (2.0 * math.pi) - math.pi)
    reach = math.degrees(float(away[depth >= 0.1 * depth.max()].max()))
    return math.radians(min(max(5.0 * math.ceil(1.2 * reach / 5.0), 10.0), 60.0))


def _draw_outline(
    axes: PolarAxes, angle: Array, worn: list[Worn], enlarged: float, views: dict[str, _View]
) -> None:
    rim = (1.0 + 1.2 * _DRAWN_DEPTH) * views["bearing"].radius
    far_edge = {"bearing": rim, "pin": 0.0}
    around = np.linspace(0.0, 2.0 * math.pi, 361)
    closed = np.append(angle, angle[0] + 2.0 * math.pi)
    for side, view in views.items():
        for pen, own in worn:
            depth = own.depth(side)
            surface = view.radius + _OUTWARDS[side] * enlarged * np.append(depth, depth[0])
            if own is worn[-1][1]:
                axes.fill_between(closed, surface, far_edge[side], color=_MATERIAL, linewidth=0.0)
            pen.draw(axes, closed, surface, linewidth=1.0)
        _NEW.draw(axes, around, np.full_like(around, view.radius))
        marked = rim if side == "bearing" else 0.62 * view.radius
        sector = np.linspace(view.centre - view.half, view.centre + view.half, 50)
        axes.plot(sector, np.full_like(sector, marked), color=REFERENCE, linewidth=2.0)
    axes.set_rlim(0.0, 1.02 * rim)
    axes.set_rticks([])
    axes.set_thetagrids(range(0, 360, 45))
    axes.grid(visible=False)
    axes.spines["polar"].set_visible(False)
    axes.text(0.0, 0.0, "pin", ha="center", va="center")
    # Above or below the pin, whichever is farther from the wear.
    away = -math.copysign(0.5 * math.pi, math.sin(views["bearing"].centre))
    axes.text(away, 0.5 * (views["bearing"].radius + rim), "bearing", ha="center", va="center")


def _draw_profile(axes: Axes, worn: list[Worn], view: _View) -> None:
    angle = np.linspace(view.centre - view.half, view.centre + view.half, 1200)
    degrees = np.degrees(angle)
    outwards = MICRONS * _OUTWARDS[view.side]
    far_edge = outwards * view.span
    for pen, own in worn:
        position = outwards * Surface(own.depth(view.side))(angle)
        if own is worn[-1][1]:
            axes.fill_between(degrees, position, far_edge, color=_MATERIAL, linewidth=0.0)
        pen.draw(axes, degrees, position, linewidth=1.0)
    _NEW.draw(axes, degrees, np.zeros_like(degrees))
    axes.grid(visible=False)
    axes.set_ylim(*sorted((-0.1 * far_edge, 0.9 * far_edge)))
    axes.set_xlim(degrees[0], degrees[-1])
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value % 360.0:g}"))
    symbol = "R_i" if view.side == "bearing" else "R_j"
    axes.set_ylabel(f"{view.side}, $r - {symbol}$ (µm)")
    steeper = "the same as" if view.steeper == 1.0 else f"{readable(view.steeper, 1)} times"
    axes.set_title(f"radial scale {steeper} that along the surface", fontsize=8.0)
