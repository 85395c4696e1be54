"""Figures of guides with clearance: tilt of the slide, paths of its corners, wear of its walls."""

from collections.abc import Sequence
from functools import partial
from itertools import chain, product

from presswear.linkage.guide_corner import CORNERS, WALLS, largest_tilt
from presswear.linkage.joints import Guide
from presswear.results.corners import corner_paths, tilt_series
from presswear.results.guide_tilt import ALLOWED_TILT
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing, Pen, Shown
from presswear.show.figures.window import draw_with_moments, sampled
from presswear.tools.arrays import Array
from presswear.tools.numbers import unit_scale

_LARGEST = Pen("greatest tilt between rigid walls", style.REFERENCE, (0.0, (4.0, 2.0)))
_ALLOWED = Pen("limit that press makers ask for", style.MUTED, "dotted", 1.2)
_WALL = Pen("walls", style.REFERENCE, width=1.0)
_WALL_DASHES = {"left": "solid", "right": "dashed"}
# Quantities of the walls in a stage: method that returns them, factor from SI, label
_WALL_QUANTITIES = (
    (StageResult.wall_wear, 1e12, "depth per million\nstrokes (µm)"),
    (StageResult.wall_depth, 1e6, "depth of the wall\nin the stage (µm)"),
)
_ENDS = ("front", "back")  # ends of a slide along its guide
_PATH_WIDTH = 0.5  # width of the line of a path, points
# Half of the width of a panel of paths, in clearances, if no path is wider
_EDGE = 1.35
_ROOM = 1.06  # half of the width of a panel over the farthest place of a path


def tilt_over_angle(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the tilt of the slide in each guide with clearance over the crank angle."""
    guides = result.scene.loose_guides
    shown, window = sampled(result, moving)
    sheet, panels, zones = window.rows(len(guides), 0.6 + 2.4 * len(guides))
    marks: dict[str, str] = {}
    for axes, guide in zip(panels, guides, strict=True):
        tilt = partial(_tilt, guide=guide)
        marks |= draw_with_moments(axes, result, shown, moving, tilt, window)
        _draw_limits(axes, result, guide)
        axes.set_ylabel(f"tilt in {guide.name}\n(µm/m)")
    window.label(panels, zones)
    pens = [*(stage.pen for stage in shown), _LARGEST]
    if not all(guide.is_moving for guide in guides):
        pens.append(_ALLOWED)
    return style.finished("tilt", sheet, pens, window=window, marks=marks.values())


def _tilt(stage: StageResult, guide: Guide) -> Array:
    """Return the tilt of the slide in a guide over time, um/m."""
    return 1e6 * tilt_series(stage, guide)


def _draw_limits(axes: Axes, result: Result, guide: Guide) -> None:
    """Draw the greatest tilt between rigid walls, and the tilt that press makers allow."""
    largest = 1e6 * largest_tilt(guide, result.scene.bearing(guide.name).clearance)
    limits = [(_LARGEST, largest)]
    if not guide.is_moving:
        limits.append((_ALLOWED, 1e6 * ALLOWED_TILT))
    for sign in (-1.0, 1.0):
        for pen, size in limits:
            axes.axhline(sign * size, **pen.line_style)


def corner_trajectories(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the paths of the corners of each slide between the walls over the stroke."""
    shown, window = sampled(result, moving)
    drawings = []
    for guide in result.scene.loose_guides:
        clearance = result.scene.bearing(guide.name).clearance
        factor, unit = unit_scale("m", clearance)
        sheet, (row,) = style.panels(1, 2, 3.6, sharex=True, sharey=True)
        widest = _draw_paths(row, shown, guide, factor)
        edge = factor * max(_EDGE * clearance, _ROOM * widest)
        for axes, end in zip(row, _ENDS, strict=True):
            for sign in (-1.0, 1.0):
                axes.axvline(sign * factor * clearance, **_WALL.line_style)
            axes.set_title(f"{end} corners")
            axes.set_xlim(-edge, edge)
            axes.set_xlabel(f"way across the guide, to the right ({unit})")
        row[0].set_ylabel(f"displacement of {result.scene.output} (mm)")
        pens = [*(stage.pen for stage in shown), _WALL]
        drawings += style.finished(
            "corners",
            sheet,
            pens,
            scene=result.scene,
            guide=guide,
            window=window,
            clearance=clearance,
        )
    return drawings


def _draw_paths(
    panels: Sequence[Axes], shown: Shown, guide: Guide, factor: float
) -> float:
    """Draw the paths of the corners at each end of a slide; return the farthest place, m.

    ``factor`` is the unit of the drawing over metres.
    """
    widest = 0.0
    for stage in shown:
        paths = corner_paths(stage.data, guide)
        for name in CORNERS:
            path = paths[name]
            widest = max(widest, float(abs(path).max()))
            for axes, end in zip(panels, _ENDS, strict=True):
                if name.endswith(end):
                    axes.plot(
                        -factor * path,  # positive to the left
                        1e3 * stage.data.displacement,
                        color=stage.pen.colour,
                        linewidth=_PATH_WIDTH,
                    )
    return widest


def wall_wear(result: Result, shown: Shown) -> list[Drawing]:
    """Draw wear rate and depth of both walls of each guide along its length."""
    stages = [stage for stage in shown if stage.data.statistics.walls]
    walls_of_stages = [stage.data.statistics.walls for stage in stages]
    names = list(dict.fromkeys(chain(*walls_of_stages)))
    if not names:
        return []
    worn_depths = []
    for stage, name in product(stages, names):
        _, depth = stage.data.wall_depth(name)
        worn_depths.append(depth)
    is_worn = any(depth.any() for depth in worn_depths)
    quantities = _WALL_QUANTITIES if is_worn else _WALL_QUANTITIES[:1]
    pairs = list(product(names, quantities))
    sheet, panels, _ = style.panel_list(len(pairs), 2.4, 1)
    for axes, (name, quantity) in zip(panels, pairs, strict=True):
        method, factor, label = quantity
        for stage in stages:
            place, depths = method(stage.data, name)
            _draw_walls(axes, stage.pen, place, factor * depths)
        axes.set_ylim(bottom=0.0)
        axes.set_xlabel(f"place along {name} (mm)")
        axes.set_ylabel(label)
    walls = [
        Pen(f"{side} wall", style.REFERENCE, dashes)
        for side, dashes in _WALL_DASHES.items()
    ]
    pens = [*(stage.pen for stage in stages), *walls]
    return style.finished("walls", sheet, pens, guides=names, is_worn=is_worn)


def _draw_walls(axes: Axes, pen: Pen, place: Array, depths: Array) -> None:
    """Draw the depths in the bins of both walls, (2, bins), over their places, m."""
    for side, depth in zip(WALLS, depths, strict=True):
        axes.step(
            1e3 * place,
            depth,
            where="mid",
            color=pen.colour,
            linestyle=_WALL_DASHES[side],
        )
