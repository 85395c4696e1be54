"""Labelled drawing of a mechanism: bodies, joints, mass centres, drives, springs, loads, paths."""

import math
from collections.abc import Mapping
from itertools import combinations
from typing import Any

import matplotlib
import numpy as np
from matplotlib.patches import FancyArrowPatch, Polygon

from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force, Load
from presswear.scene.scene import Scene
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing
from presswear.show.replay.shapes import across, attachments, body_outline, points_of
from presswear.show.replay.shapes import direction as direction_at
from presswear.tools.arrays import Array

_HEIGHTS = (3.2, 5.2)  # least and greatest height of the figure, inches
_EDGES = 0.75, 0.55  # width and height of the figure beside the axes, inches
_INSTANTS = 361  # instants of the paths of the joints
_LOAD = "tab:red"
_WINDINGS = 10  # of a spring
_MARGIN = 0.16  # around everything that moves, relative to its size
_ON_AXIS = 0.7  # cosine from which a label lies on the x axis of its body
_ROOM = 0.05  # between a label and other bodies, relative to the same size
_BAR = 0.007  # half width of a bar, relative to the same size
_MANY_LABELS = 3  # joints with the same clearance, above which it is in the caption
_SLIMMEST = 0.6  # width over height, at least
_UP, _LEFT = np.array([0.0, 1.0]), np.array([-1.0, 0.0])


@matplotlib.rc_context(style.SETTINGS)
def labelled(scene: Scene, time: float = 0.0) -> Drawing:
    """Draw the mechanism of a scene at a time, s, with closed joints."""
    linkage, period = scene.base_linkage, scene.mechanism.period
    # A full cycle after the run-up.
    times = np.append(time, scene.run_up + np.linspace(0.0, period, _INSTANTS))
    position = scene.ideal.at(times).position

    def moving(point: Attachment) -> Array:
        return points_of(linkage, position, point)[:, :2]

    ends = [(joint.name, end) for joint in linkage.revolutes for end in (joint.first, joint.second)]
    paths = {name: moving(end) for name, end in ends}
    origins = {body.name: moving(Attachment(body.name, 0.0, 0.0)) for body in linkage.bodies}
    hung = [moving(end) for spring in linkage.springs for end in spring.ends]
    everything = np.vstack([*paths.values(), *origins.values(), *hung])
    size = float(np.hypot(*np.ptp(everything, axis=0)))
    low, high = everything.min(axis=0) - _MARGIN * size, everything.max(axis=0) + _MARGIN * size
    wide, tall = high - low
    room = max(_SLIMMEST * tall - wide, 0.0)  # for the labels of an upright mechanism
    low[0], high[0], wide = low[0] - 0.5 * room, high[0] + 0.5 * room, wide + room
    height = min(max((style.WIDTH - _EDGES[0]) * tall / wide + _EDGES[1], _HEIGHTS[0]), _HEIGHTS[1])
    sheet, ((axes,),) = style.panels(1, 1, height)
    for path in paths.values():
        axes.plot(*path[1:].T, color=style.MUTED, linewidth=0.5, zorder=1)
    output = linkage.output
    place = moving(Attachment(output.body, output.x, output.y))[0]
    along = 0.14 * size * direction_at(output.direction)
    _arrow(axes, place, place + along, "black", 1.6)
    centres = {name: path[0] for name, path in origins.items()}
    _draw_joints(axes, scene, ends, {name: path[0] for name, path in paths.items()}, centres, size)
    for number in range(len(linkage.bodies)):
        _draw_body(axes, linkage, number, position[:1], size)
    _draw_guides_and_forces(axes, linkage, position[:1], centres, size)
    for drive in linkage.drives:
        hinge = next((paths[name][0] for name, end in ends if end.body == drive.body), None)
        if hinge is not None:
            _bent_arrow(axes, hinge, drive.mean_speed, 0.06 * size, "black")
            # Below the arrow, on the side that the body does not reach.
            side = 1.0 if centres[drive.body][0] < hinge[0] - 1e-6 * size else -1.0
            corner = hinge + 0.06 * size * np.array([0.5 * side, -0.87])
            text = f"{abs(drive.mean_speed) * 30.0 / math.pi:.4g} rpm"
            _label(axes, text, corner, np.array([side, -1.0]), 5.0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    scale = (height - _EDGES[1]) * sheet.dpi / tall  # pixels per m
    boxes: list[Array] = []  # of the labels, corners in pixels from the origin
    for text in axes.texts:
        around = text.get_window_extent().get_points() - axes.transData.transform(text.xy)
        box = scale * np.array(text.xy) + around
        for placed in boxes:
            if np.all(box[0] < placed[1]) and np.all(placed[0] < box[1]):  # move it up or down
                is_above = box[:, 1].sum() > placed[:, 1].sum()
                shift = placed[1, 1] - box[0, 1] + 2 if is_above else placed[0, 1] - box[1, 1] - 2
                box[:, 1] += shift
                text.xyann = (text.xyann[0], text.xyann[1] + 72.0 / sheet.dpi * shift)
        boxes.append(box)
        low[0], high[0] = min(low[0], box[0, 0] / scale), max(high[0], box[1, 0] / scale)
    axes.set_xlim(low[0], high[0])
    width = (height - _EDGES[1]) * (high[0] - low[0]) / tall + _EDGES[0]
    sheet.set_figwidth(min(max(width, _HEIGHTS[0]), style.WIDTH))
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
        axis.set_major_formatter(lambda value, place: f"{1e3 * value:.4g}")
        axis.set_label_text(f"{name} (mm)")
    content: dict[str, Any] = {"linkage": linkage, "time": 1e3 * time, "period": 1e3 * period}
    content["clearance"] = _common_clearance(scene)
    return style.finished("mechanism", sheet, **content)[0]


def _common_clearance(scene: Scene) -> float | None:
    """Return the clearance of all joints if many have the same, m: the caption states it."""
    sizes = {scene.bearing(name).clearance for name in scene.clearance_joints}
    many = len(scene.clearance_joints) > _MANY_LABELS
    return sizes.pop() if many and len(sizes) == 1 else None


def _unit(vector: Array) -> Array:
    length = float(np.hypot(*vector))
    return vector / length if length > 0.0 else vector


def _label(axes: Axes, text: str, place: Array, direction: Array, gap: float, **look: Any) -> None:
    """Write a text beside a place, at a gap in points in a direction."""
    x, y = gap * _unit(direction)
    horizontal = "left" if x > 0.4 * gap else "right" if x < -0.4 * gap else "center"
    vertical = "bottom" if y > 0.4 * gap else "top" if y < -0.4 * gap else "center"
    look |= {"multialignment": "center", "zorder": 9, "ha": horizontal, "va": vertical}
    axes.annotate(text, tuple(place), xytext=(x, y), textcoords="offset points", **look)


def _draw_joints(
    axes: Axes,
    scene: Scene,
    ends: list[tuple[str, Attachment]],
    places: Mapping[str, Array],
    centres: Mapping[str, Array],
    size: float,
) -> None:
    """Draw the pin joints; joints at one place share a label, away from their bodies."""
    groups: dict[tuple[float, ...], list[str]] = {}
    for name, place in places.items():
        groups.setdefault(tuple(np.round(place / (0.01 * size))), []).append(name)
    output = scene.base_linkage.output
    for names in groups.values():
        place = places[names[0]]
        bodies = {end.body for name, end in ends if name in names}
        loose = [name for name in names if name in scene.clearance_joints]
        arms = [_unit(centres[body] - place) for body in sorted(bodies - {GROUND})]
        if output.body in bodies:
            arms.append(direction_at(output.direction))
        if GROUND in bodies:
            axes.plot(*place, marker=(3, 0, 0), markersize=15, color="0.8", zorder=0)
        if loose:
            axes.plot(*place, "o", markersize=11, fillstyle="none", color="black", zorder=5)
        axes.plot(*place, "o", markersize=5, markerfacecolor="white", color="black", zorder=6)
        lines = [", ".join(names)]
        for name in loose if _common_clearance(scene) is None else ():
            of_joint = f" of {name}" if len(names) > 1 else ""
            lines.append(f"c{of_joint} = {1e3 * scene.bearing(name).clearance:g} mm")
        is_block = any(
            np.abs(centres[body] - place).max() < 1e-9 * size for body in bodies - {GROUND}
        )
        gap = 12.0 if is_block else 9.0 if loose else 7.0
        direction = _free_direction(arms, GROUND in bodies)
        _label(axes, "\n".join(lines), place, direction, gap, weight="bold")


def _free_direction(arms: list[Array], on_frame: bool) -> Array:
    """Return the direction of a label away from the arms that leave a joint."""
    total = np.sum(arms, axis=0) if arms else -_UP
    if on_frame:  # beside the hinge, because a drive is drawn below it
        return -_LEFT if total[0] < -1e-6 else _LEFT
    if np.hypot(*total) > 0.3:
        return np.asarray(-total)
    beside = across(arms[0])
    return beside * (1.0 if beside @ (_UP - 0.5 * _LEFT) >= 0.0 else -1.0)


def _draw_body(axes: Axes, linkage: Linkage, number: int, position: Array, size: float) -> None:
    """Draw a body with its mass centre, its x axis and its name."""
    name, (colour, _) = linkage.bodies[number].name, style.LINES[number % len(style.LINES)]
    outline = body_outline(linkage, name, _BAR * size)
    pose = position[0, 3 * number : 3 * number + 3]
    centre, along = pose[:2], direction_at(pose[2])
    turn = np.array([along, across(along)])
    axes.add_patch(
        Polygon(centre + outline @ turn, facecolor=colour, edgecolor=colour, alpha=0.4, zorder=2)
    )
    axes.plot(*centre, "+", markersize=7, color=colour, zorder=4)
    _arrow(axes, centre, centre + 0.07 * size * along, colour)
    # The name is beside a block, outside of the longest edge of a plate, or beside a bar.
    ends = [(end.x, end.y) for _, end in attachments(linkage, name)]
    corners = np.unique([*ends, (0.0, 0.0)] if len(set(ends)) == 1 else ends, axis=0)
    place, direction, gap = centre, _LEFT - _UP, 12.0
    if len(corners) > 1 and not any(guide.body == name for guide in linkage.guides):
        around = corners - corners.mean(axis=0)
        corners = corners[np.argsort(np.arctan2(*around.T))] @ turn
        edges = np.roll(corners, -1, axis=0) - corners
        k = int(np.hypot(*edges.T).argmax())
        x, y = direction = _unit(across(edges[k]))
        is_plate, gap = len(corners) > 2, 7.0
        place = centre + corners[k] + 0.5 * edges[k] if is_plate else centre
        if is_plate:
            inwards = corners.mean(axis=0) - corners[k] - 0.5 * edges[k]
            direction = -direction if direction @ inwards > 0.0 else direction
        else:
            if (y if abs(y) > 0.2 else x) < 0.0:
                direction = -direction
            near, far = (
                _room(linkage, name, position, place, s * direction, size) for s in (1, -1)
            )
            is_close = near < min(far, _ROOM * size)
            is_on_axis = direction @ along > _ON_AXIS and far > _ROOM * size
            direction = -direction if is_close or is_on_axis else direction
    _label(axes, name, place, direction, gap, color=colour)


def _room(
    linkage: Linkage, name: str, position: Array, place: Array, side: Array, size: float
) -> float:
    """Return the distance, m, of a label beside a place of a body from all other bodies."""
    label, part = place + side * (0.09 * size, 0.04 * size), np.linspace(0.0, 1.0, 21)[:, None]
    distances = [math.inf]
    for body in linkage.bodies:
        joined = attachments(linkage, body.name) if body.name != name else []
        ends = [points_of(linkage, position, end)[0, :2] for _, end in joined]
        for first, second in combinations(ends, 2):
            distances.append(np.hypot(*(first + part * (second - first) - label).T).min())
    return float(min(distances))


def _draw_guides_and_forces(
    axes: Axes, linkage: Linkage, position: Array, centres: Mapping[str, Array], size: float
) -> None:
    """Draw guides as dashed lines, springs as zigzags and loads as red arrows."""
    for guide in linkage.guides:
        ends = np.outer([-0.25 * size, 0.25 * size], direction_at(guide.direction))
        line = centres[guide.body] + ends
        axes.plot(*line.T, color="0.3", linewidth=0.9, linestyle=(0.0, (5.0, 2.0)), zorder=0)
    for spring in linkage.springs:
        first, second = (points_of(linkage, position, end)[0, :2] for end in spring.ends)
        part = np.linspace(0.0, 1.0, 4 * _WINDINGS + 1)
        swing = 0.03 * np.sin(2.0 * math.pi * _WINDINGS * part) * (np.abs(part - 0.5) < 0.4)
        beside = across(second - first)
        line = first + np.outer(part, second - first) - np.outer(swing, beside)
        axes.plot(*line.T, color=style.MUTED, linewidth=1.0, zorder=2)
        _label(axes, spring.name, 0.5 * (first + second), beside, 9.0, color=style.MUTED)
    for load in linkage.loads:
        point = load.attachment if isinstance(load, Force) else Attachment(load.body, 0.0, 0.0)
        place = points_of(linkage, position, point)[0, :2]
        direction, moment = None, 1.0
        if isinstance(load, Force):
            direction, moment = load.direction, 0.0
        elif isinstance(load, Load):
            direction = math.atan2(load.y, load.x) if load.x or load.y else None
            moment = load.moment
        if direction is not None:  # an arrow to the point; a moment is a bent arrow
            _arrow(axes, place - 0.19 * size * direction_at(direction), place, _LOAD, 1.4)
        if moment:
            _bent_arrow(axes, place, moment, 0.045 * size, _LOAD)


def _arrow(axes: Axes, start: Array, end: Array, colour: str, linewidth: float = 0.8) -> None:
    look: dict[str, Any] = {"color": colour, "linewidth": linewidth, "shrinkA": 0, "shrinkB": 0}
    ends = tuple(start), tuple(end)
    axes.add_patch(FancyArrowPatch(*ends, arrowstyle="-|>", mutation_scale=8, zorder=8, **look))


def _bent_arrow(axes: Axes, place: Array, sense: float, radius: float, colour: str) -> None:
    """Draw an arrow below and around a place, counterclockwise for a positive sense."""
    around = np.radians(np.linspace(215.0, 325.0, 30))
    arc = place + radius * np.column_stack([np.cos(around), np.sin(around)])
    arc = arc if sense > 0.0 else arc[::-1]
    axes.plot(*arc.T, color=colour, linewidth=1.1, zorder=6)
    _arrow(axes, arc[-2], arc[-1], colour, 1.1)
