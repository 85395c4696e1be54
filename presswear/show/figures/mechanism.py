"""Labelled drawing of a mechanism: bodies, joints, mass centres, drives, springs, loads, paths."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.patches import FancyArrowPatch, Polygon

from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import AnyLoad, Force, Load
from presswear.results.result import Result
from presswear.scene.scene import Scene
from presswear.show.figures import style
from presswear.show.figures.style import Array, Axes, Drawing, Stages
from presswear.show.replay.clip import points_of

_HEIGHTS = (3.2, 6.4)  # least and greatest height of the figure, inches
_EDGES = 0.65, 0.55  # width and height of the figure beside the axes, inches
_INSTANTS = 361  # instants of the paths of the joints
_LOAD = "tab:red"
_WINDINGS = 10  # of a spring
_MARGIN = 0.16  # around everything that moves, relative to its size
_UP, _LEFT = np.array([0.0, 1.0]), np.array([-1.0, 0.0])


def draw_mechanism(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the mechanism of a result at the start; see ``labelled``."""
    return [labelled(result.scene)]


def labelled(scene: Scene, time: float = 0.0) -> Drawing:
    """Draw the mechanism of a scene at a time, s, with closed joints."""
    linkage, period = scene.base_linkage, scene.mechanism.period
    # A full cycle after the run-up.
    times = np.append(time, scene.run_up + np.linspace(0.0, period, _INSTANTS))
    position = scene.ideal.at(times).position
    ends = [(joint.name, end) for joint in linkage.revolutes for end in (joint.first, joint.second)]
    paths = {name: points_of(linkage, position, end)[:, :2] for name, end in ends}
    origins = {body.name: Attachment(body.name, 0.0, 0.0) for body in linkage.bodies}
    centres = {name: points_of(linkage, position, end)[:, :2] for name, end in origins.items()}
    hung = [points_of(linkage, position, end)[:, :2] for s in linkage.springs for end in s.ends]
    everything = np.vstack([*paths.values(), *centres.values(), *hung])
    size = float(np.hypot(*np.ptp(everything, axis=0)))
    low, high = everything.min(axis=0) - _MARGIN * size, everything.max(axis=0) + _MARGIN * size
    wide, tall = high - low
    height = min(max((style.WIDTH - _EDGES[0]) * tall / wide + _EDGES[1], _HEIGHTS[0]), _HEIGHTS[1])
    sheet, ((axes,),) = style.panels(1, 1, height)
    for path in paths.values():
        axes.plot(*path[1:].T, color=style.MUTED, linewidth=0.5, zorder=1)
    output = linkage.output
    along = _direction(output.direction)
    place = points_of(linkage, position, Attachment(output.body, output.x, output.y))[0, :2]
    _arrow(axes, place, place + 0.14 * size * along, "black", linewidth=1.6)
    _draw_joints(axes, scene, ends, {name: path[0] for name, path in paths.items()}, centres, size)
    for number, body in enumerate(linkage.bodies):
        points = [paths[name][0] for name, end in ends if end.body == body.name]
        colour = style.LINES[number % len(style.LINES)][0]
        angle = position[0, 3 * number + 2]
        _draw_body(axes, body.name, points, centres[body.name][0], angle, size, colour)
    _draw_guides_and_forces(axes, linkage, position, centres, size)
    for drive in linkage.drives:
        hinge = next((paths[name][0] for name, end in ends if end.body == drive.body), None)
        if hinge is not None:
            _bent_arrow(axes, hinge, drive.mean_speed, 0.06 * size, "black")
            # Below the arrow, on the side that the body does not reach.
            side = 1.0 if centres[drive.body][0][0] < hinge[0] - 1e-6 * size else -1.0
            corner = hinge + 0.06 * size * np.array([0.5 * side, -0.87])
            text = f"{abs(drive.mean_speed):.4g} rad/s"
            _label(axes, text, corner, np.array([side, -1.0]), 5.0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
        axis.set_major_formatter(lambda value, place: f"{1e3 * value:.4g}")
        axis.set_label_text(f"{name} (mm)")
    times_ms: dict[str, Any] = {"time": 1e3 * time, "period": 1e3 * period}
    return style.finished("mechanism", sheet, linkage=linkage, **times_ms)[0]


def _direction(angle: float) -> Array:
    return np.array([math.cos(angle), math.sin(angle)])


def _unit(vector: Array) -> Array:
    length = float(np.hypot(*vector))
    return vector / length if length > 0.0 else vector


def _label(axes: Axes, text: str, place: Array, direction: Array, gap: float, **look: Any) -> None:
    """Write a text beside a place, at a gap in points in a direction."""
    x, y = gap * _unit(direction)
    horizontal = "left" if x > 0.4 * gap else "right" if x < -0.4 * gap else "center"
    vertical = "bottom" if y > 0.4 * gap else "top" if y < -0.4 * gap else "center"
    axes.annotate(
        text, tuple(place), xytext=(x, y), textcoords="offset points", ha=horizontal, va=vertical,
        multialignment="center", zorder=9, **look,
    )  # fmt: skip


def _draw_joints(
    axes: Axes,
    scene: Scene,
    ends: list[tuple[str, Attachment]],
    places: Mapping[str, Array],
    centres: Mapping[str, Array],
    size: float,
) -> None:
    """Draw the pin joints; joints at one place share a label, away from their bodies."""
    groups: list[list[str]] = []
    for name, place in places.items():
        near = (g for g in groups if np.abs(places[g[0]] - place).max() < 0.01 * size)
        group = next(near, None)
        groups.append([name]) if group is None else group.append(name)
    output = scene.base_linkage.output
    for names in groups:
        place = places[names[0]]
        bodies = {end.body for name, end in ends if name in names}
        loose = [name for name in names if name in scene.clearance_joints]
        arms = [_unit(centres[body][0] - place) for body in sorted(bodies - {GROUND})]
        if output.body in bodies:
            arms.append(_direction(output.direction))
        if GROUND in bodies:
            axes.plot(*place, marker=(3, 0, 0), markersize=15, color="0.8", zorder=0)
        if loose:
            axes.plot(*place, "o", markersize=11, fillstyle="none", color="black", zorder=5)
        axes.plot(*place, "o", markersize=5, markerfacecolor="white", color="black", zorder=6)
        lines = [", ".join(names)]
        for name in loose:
            of_joint = f" of {name}" if len(names) > 1 else ""
            lines.append(f"c{of_joint} = {1e3 * scene.bearing(name).clearance:g} mm")
        direction = _free_direction(arms, GROUND in bodies)
        is_block = any(np.abs(centres[b][0] - place).max() < 1e-9 * size for b in bodies - {GROUND})
        gap = 12.0 if is_block else 9.0 if loose else 7.0
        _label(axes, "\n".join(lines), place, direction, gap, weight="bold")


def _free_direction(arms: list[Array], on_frame: bool) -> Array:
    """Return the direction of a label away from the arms that leave a joint."""
    total = np.sum(arms, axis=0) if arms else -_UP
    if on_frame:  # beside the hinge, because a drive is drawn below it
        return -_LEFT if total[0] < -1e-6 else _LEFT
    if np.hypot(*total) > 0.3:
        return np.asarray(-total)
    across = np.array([-arms[0][1], arms[0][0]])
    return across * (1.0 if across @ (_UP - 0.5 * _LEFT) >= 0.0 else -1.0)


def _draw_body(
    axes: Axes,
    name: str,
    points: list[Array],
    centre: Array,
    angle: float,
    size: float,
    colour: str,
) -> None:
    """Draw a bar between two joints, a plate between more or a block around one."""
    distinct: list[Array] = []
    for point in points:
        if all(np.abs(point - corner).max() > 1e-6 * size for corner in distinct):
            distinct.append(point)
    corners = np.array([*distinct, centre] if len(distinct) == 1 else distinct or [centre])
    direction = _UP
    if len(distinct) > 2:
        around = np.arctan2(*(corners - corners.mean(axis=0)).T[::-1])
        outline = corners[np.argsort(around)]
        look: dict[str, Any] = {"alpha": 0.35, "linewidth": 3.0, "joinstyle": "round"}
        axes.add_patch(Polygon(outline, facecolor=colour, edgecolor=colour, **look))
    elif np.ptp(corners, axis=0).max() > 1e-9 * size:
        axes.plot(*corners.T, color=colour, linewidth=5.0, alpha=0.45, solid_capstyle="round")
        x, y = _unit(corners[1] - corners[0])
        across = np.array([-y, x])
        # Above a bar, or to the right of an upright one.
        is_away = across[1] >= 0.0 if abs(across[1]) > 0.2 else across[0] >= 0.0
        direction = across if is_away else -across
    else:
        axes.plot(*centre, "s", markersize=16, color=colour, alpha=0.35)
        direction = _LEFT - _UP
    axes.plot(*centre, "+", markersize=7, color=colour, zorder=4)
    tip = centre + 0.07 * size * _direction(angle)
    _arrow(axes, centre, tip, colour)
    _label(axes, name, centre, direction, 12.0 if len(corners) == 1 else 7.0, color=colour)


def _draw_guides_and_forces(
    axes: Axes, linkage: Linkage, position: Array, centres: Mapping[str, Array], size: float
) -> None:
    """Draw guides as dashed lines, springs as zigzags and loads as red arrows."""
    for guide in linkage.guides:
        along = _direction(guide.direction)
        line = centres[guide.body][0] + np.outer([-0.25 * size, 0.25 * size], along)
        axes.plot(*line.T, color="0.3", linewidth=0.9, linestyle=(0.0, (5.0, 2.0)), zorder=0)
    for spring in linkage.springs:
        first, second = (points_of(linkage, position, end)[0, :2] for end in spring.ends)
        part = np.linspace(0.0, 1.0, 4 * _WINDINGS + 1)
        across = np.array([second[1] - first[1], first[0] - second[0]])
        swing = 0.03 * np.sin(2.0 * math.pi * _WINDINGS * part) * (np.abs(part - 0.5) < 0.4)
        line = first + np.outer(part, second - first) + np.outer(swing, across)
        axes.plot(*line.T, color=style.MUTED, linewidth=1.0, zorder=2)
        _label(axes, spring.name, 0.5 * (first + second), -across, 9.0, color=style.MUTED)
    for load in linkage.loads:
        point = load.attachment if isinstance(load, Force) else Attachment(load.body, 0.0, 0.0)
        _draw_load(axes, load, points_of(linkage, position, point)[0, :2], size)


def _draw_load(axes: Axes, load: AnyLoad, place: Array, size: float) -> None:
    """Draw a force as an arrow to its point and a moment as a bent arrow."""
    direction, moment = None, 1.0
    if isinstance(load, Force):
        direction = load.direction
    elif isinstance(load, Load):
        direction = math.atan2(load.y, load.x) if load.x or load.y else None
        moment = load.moment
    if direction is not None:
        along = _direction(direction)
        _arrow(axes, place - 0.19 * size * along, place, _LOAD, 1.4)
    if not isinstance(load, Force) and moment:
        _bent_arrow(axes, place, moment, 0.045 * size, _LOAD)


def _arrow(axes: Axes, start: Array, end: Array, colour: str, linewidth: float = 0.8) -> None:
    axes.add_patch(
        FancyArrowPatch(
            tuple(start), tuple(end), arrowstyle="-|>", mutation_scale=8, shrinkA=0, shrinkB=0,
            color=colour, linewidth=linewidth, zorder=8,
        )
    )  # fmt: skip


def _bent_arrow(axes: Axes, place: Array, sense: float, radius: float, colour: str) -> None:
    """Draw an arrow below and around a place, counterclockwise for a positive sense."""
    around = np.radians(np.linspace(215.0, 325.0, 30))
    arc = place + radius * np.column_stack([np.cos(around), np.sin(around)])
    arc = arc if sense > 0.0 else arc[::-1]
    axes.plot(*arc.T, color=colour, linewidth=1.1, zorder=6)
    _arrow(axes, arc[-2], arc[-1], colour, 1.1)
