"""Labelled drawing of a mechanism: bodies, joints, mass centres, drives, springs, loads, paths."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.patches import FancyArrowPatch, Polygon
from matplotlib.patheffects import withStroke

from presswear.linkage.drives import LinearDrive
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force, Load
from presswear.linkage.points import GROUND, Attachment
from presswear.scene.scene import Scene
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing
from presswear.show.replay.shapes import (
    across,
    body_outline,
    colour_of,
    points_of,
    slide_corners,
    slot_outline,
    slots_of,
)
from presswear.show.replay.shapes import direction as direction_at
from presswear.tools.arrays import Array

_HEIGHTS = (3.2, 5.2)  # least and greatest height of the figure, inches
_EDGES = 0.95, 0.63  # width and height of the margins around the axes, inches
_INSTANTS = 361  # instants of the paths of the joints
_LOAD = "tab:red"
_WINDINGS = 10  # windings of a spring
_MARGIN = 0.16  # around everything that moves, relative to its size
_BAR = 0.007  # half width of a bar, relative to the same size
_LEGEND_COLUMNS = 2
_LEGEND_ROW = 0.22  # inches
# Number of joints above which the caption states a common clearance, not the labels
_MANY_LABELS = 3
_NEAR_LINE = 0.02  # distance of a joint from the line of a guide, part of the size
_SLIMMEST = 0.6  # least width over height of the axes


class _Label(NamedTuple):
    text: str
    place: Array  # (2,), m
    gap: float  # distance of the text from the place, points
    direction: Array  # direction from the place to the text, (2,)
    style: dict[str, Any]  # style of the text


@matplotlib.rc_context(style.SETTINGS)
def labelled(scene: Scene, time: float = 0.0) -> Drawing:
    """Draw the mechanism of a scene at a time, s, with closed joints."""
    linkage = scene.base_linkage
    period = scene.mechanism.period
    # A full cycle after the run-up.
    times = np.append(time, scene.run_up + np.linspace(0.0, period, _INSTANTS))
    position = scene.ideal.at(times).position
    ends = _ends_of_joints(linkage)
    paths = {name: _path(linkage, position, end) for name, end in ends}
    low, high, size = _limits(linkage, position, paths)
    wide, tall = high - low
    rows = math.ceil(len(linkage.bodies) / _LEGEND_COLUMNS)
    edges = _EDGES[1] + _LEGEND_ROW * rows
    height = (style.WIDTH - _EDGES[0]) * tall / wide + edges
    height = min(max(height, _HEIGHTS[0]), _HEIGHTS[1])
    sheet, ((axes,),) = style.panels(1, 1, height)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    labels = _draw_parts(axes, scene, position, paths, size)
    scale = 72.0 * (height - edges) / tall  # points per m
    boxes = _write(axes, labels, scale) / scale
    # Widen the axes for the labels, and the figure so that the scale remains.
    low[0] = boxes[:, 0, 0].min(initial=low[0])
    high[0] = boxes[:, 1, 0].max(initial=high[0])
    axes.set_xlim(low[0], high[0])
    width = (height - edges) * (high[0] - low[0]) / tall + _EDGES[0]
    legend = sheet.legend(loc="outside upper center", ncols=_LEGEND_COLUMNS)
    names = legend.get_window_extent().width / sheet.dpi
    sheet.set_figwidth(min(max(width, names, _HEIGHTS[0]), style.WIDTH))
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
        axis.set_major_formatter(lambda value, place: f"{1e3 * value:.4g}")
        axis.set_label_text(f"{name} (mm)")
    (drawing,) = style.finished(
        "mechanism",
        sheet,
        linkage=linkage,
        time=1e3 * time,
        period=1e3 * period,
        clearance=_common_clearance(scene),
    )
    return drawing


def _path(linkage: Linkage, position: Array, point: Attachment) -> Array:
    """Return the path of a point from positions, (n, 3 bodies); shape (n, 2), m."""
    return points_of(linkage, position, point)[:, :2]


def _ends_of_joints(linkage: Linkage) -> list[tuple[str, Attachment]]:
    """Return the name of a pin joint and one of its ends, for all ends."""
    ends = []
    for joint in linkage.revolutes:
        ends += [(joint.name, joint.first), (joint.name, joint.second)]
    return ends


def _limits(
    linkage: Linkage, position: Array, paths: Mapping[str, Array]
) -> tuple[Array, Array, float]:
    """Return the lower left and upper right corner of the axes, (2,), and the size, m.

    The size is the diagonal of the rectangle around everything that moves.
    """
    points = [Attachment(body.name, 0.0, 0.0) for body in linkage.bodies]
    for spring in linkage.springs:
        points += spring.ends
    for guide in linkage.guides:
        points += slide_corners(guide)
    other_paths = [_path(linkage, position, point) for point in points]
    everything = np.vstack([*paths.values(), *other_paths])
    size = float(np.hypot(*np.ptp(everything, axis=0)))
    low = everything.min(axis=0) - _MARGIN * size
    high = everything.max(axis=0) + _MARGIN * size
    wide, tall = high - low
    # Labels of an upright mechanism need room on both sides.
    room = max(_SLIMMEST * tall - wide, 0.0)
    low[0] -= 0.5 * room
    high[0] += 0.5 * room
    return low, high, size


def _draw_parts(
    axes: Axes,
    scene: Scene,
    position: Array,
    paths: Mapping[str, Array],
    size: float,
) -> list[_Label]:
    """Draw all parts of the mechanism and return their labels.

    ``position`` has the shape (n, 3 bodies). Its first row is the drawn position, the
    others give the travel of the blocks in slots.
    """
    linkage = scene.base_linkage
    drawn = position[:1]
    for path in paths.values():
        axes.plot(*path[1:].T, color=style.MUTED, linewidth=0.5, zorder=1)
    output = linkage.output
    (place,) = _path(linkage, drawn, Attachment(output.body, output.x, output.y))
    tip = place + 0.14 * size * direction_at(output.direction)
    _arrow(axes, place, tip, "black", 1.6)
    ends = _ends_of_joints(linkage)
    joints = {name: path[0] for name, path in paths.items()}
    labels = _draw_joints(axes, scene, ends, joints, drawn, size)
    hinges: dict[str, Array] = {}  # first joint of each body, (2,), m
    for name, end in ends:
        hinges.setdefault(end.body, joints[name])
    _draw_drives(axes, linkage, drawn, hinges, size)
    for k in range(len(linkage.bodies)):
        _draw_body(axes, linkage, k, drawn, size)
        _draw_slots(axes, linkage, k, position, size)
    _draw_guides(axes, linkage, drawn, size)
    labels += _draw_springs(axes, linkage, drawn)
    _draw_loads(axes, linkage, drawn, size)
    return labels


def _draw_drives(
    axes: Axes,
    linkage: Linkage,
    position: Array,
    hinges: Mapping[str, Array],
    size: float,
) -> None:
    """Draw an arrow for each drive, along its guide or about the hinge of its body.

    ``position`` has the shape (1, 3 bodies), and ``size`` is that of the mechanism, m.
    """
    for drive in linkage.drives:
        if isinstance(drive, LinearDrive):
            body = Attachment(drive.body, 0.0, 0.0)
            start = points_of(linkage, position, body)[0, :2]
            guide = linkage.guide_of(drive)
            carrier = Attachment(guide.on, 0.0, 0.0)
            turn = points_of(linkage, position, carrier)[0, 2]
            along = direction_at(guide.direction + turn)
            _arrow(axes, start, start + 0.1 * size * along, "black", 1.1)
        elif drive.body in hinges:
            hinge = hinges[drive.body]
            _bent_arrow(axes, hinge, drive.mean_speed, 0.06 * size, "black")


def _write(axes: Axes, labels: list[_Label], scale: float) -> Array:
    """Write the labels beside their places; return their boxes, (n, 2, 2), points.

    The scale is in points per metre. Boxes are lower left and upper right corners. A
    label that would cover another one is on another side of its place.
    """
    boxes: list[Array] = []
    for text, place, gap, direction, text_style in labels:
        note = axes.annotate(
            text,
            tuple(place),
            (0, 0),
            textcoords="offset points",
            zorder=9,
            **text_style,
        )
        note.set(ha="center", va="center", multialignment="center")
        note.set_path_effects([withStroke(linewidth=2.5, foreground="white")])
        half = 36.0 / axes.figure.dpi * np.array(note.get_window_extent().size)
        first = direction / np.hypot(*direction)
        for side in (first, -first, across(first), -across(first)):
            offset = gap * side + half * side / np.abs(side).max()
            centre = scale * place + offset
            box = np.array([centre - half, centre + half])
            if not any(_overlap(box, earlier) for earlier in boxes):
                break
        note.xyann = tuple(offset)
        boxes.append(box)
    return np.reshape(boxes, (-1, 2, 2))


def _overlap(first: Array, second: Array) -> bool:
    """Return whether two boxes, lower left and upper right corners, have a common place."""
    return bool(np.all((first[0] < second[1]) & (second[0] < first[1])))


def _free_direction(lines: Sequence[Array]) -> Array:
    """Return the middle of the widest angle between lines that meet at a joint, (2,)."""
    angles = np.sort([math.atan2(line[1], line[0]) for line in lines if line.any()])
    if not angles.size:
        return np.array([0.0, 1.0])
    gaps = np.diff(angles, append=angles[0] + 2.0 * math.pi)
    widest = int(np.argmax(np.round(gaps, 6)))
    return direction_at(angles[widest] + 0.5 * gaps[widest])


def _common_clearance(scene: Scene) -> float | None:
    """Return the clearance that many joints have in common, m; None otherwise."""
    sizes = {scene.bearing(name).clearance for name in scene.loose_pins}
    if len(scene.loose_pins) <= _MANY_LABELS or len(sizes) > 1:
        return None
    return sizes.pop()


def _draw_joints(
    axes: Axes,
    scene: Scene,
    ends: list[tuple[str, Attachment]],
    places: Mapping[str, Array],
    position: Array,
    size: float,
) -> list[_Label]:
    """Draw the pin joints; joints at one place share a label."""
    groups: dict[tuple[float, ...], list[str]] = {}
    for name, place in places.items():
        cell = tuple(np.round(place / (0.01 * size)))
        groups.setdefault(cell, []).append(name)
    labels = []
    linkage = scene.base_linkage
    output = linkage.output
    for names in groups.values():
        place = places[names[0]]
        bodies = {end.body for name, end in ends if name in names}
        loose = [name for name in names if name in scene.loose_pins]
        _draw_pin(axes, place, is_on_ground=GROUND in bodies, is_loose=bool(loose))
        bodies -= {GROUND}
        neighbours = {name for name, end in ends if end.body in bodies} - set(names)
        bars = [places[name] - place for name in sorted(neighbours)]
        if output.body in bodies:
            bars.append(direction_at(output.direction))
        bars += _guides_through(linkage, position, place, size)
        text = _label_text(scene, names, loose)
        gap = 9.0 if loose else 7.0
        direction = _free_direction(bars)
        labels.append(_Label(text, place, gap, direction, {"weight": "bold"}))
    return labels


def _draw_pin(axes: Axes, place: Array, is_on_ground: bool, is_loose: bool) -> None:
    """Draw a pin, with a triangle on the ground and a circle around a clearance."""
    if is_on_ground:
        axes.plot(*place, marker=(3, 0, 0), markersize=15, color="0.8", zorder=0)
    if is_loose:
        axes.plot(*place, "o", markersize=11, fillstyle="none", color="black", zorder=5)
    axes.plot(
        *place, "o", markersize=5, markerfacecolor="white", color="black", zorder=6
    )


def _label_text(scene: Scene, names: list[str], loose: list[str]) -> str:
    """Return the names of joints at one place, and the clearances of the loose joints."""
    lines = [", ".join(names)]
    if _common_clearance(scene) is None:
        for name in loose:
            of_joint = f" of {name}" if len(names) > 1 else ""
            lines.append(f"c{of_joint} = {1e3 * scene.bearing(name).clearance:g} mm")
    return "\n".join(lines)


def _guides_through(
    linkage: Linkage, position: Array, place: Array, size: float
) -> list[Array]:
    """Return both directions of each guide whose line passes a joint, (2,)."""
    directions = []
    for guide in linkage.guides:
        body = points_of(linkage, position, Attachment(guide.body, 0.0, 0.0))[0, :2]
        carrier = points_of(linkage, position, Attachment(guide.on, 0.0, 0.0))[0, 2]
        along = direction_at(guide.direction + carrier)
        if abs(float((place - body) @ across(along))) < _NEAR_LINE * size:
            directions += [along, -along]
    return directions


def _draw_body(
    axes: Axes, linkage: Linkage, number: int, position: Array, size: float
) -> None:
    """Draw a body with its mass centre and its x axis; its name is in the legend."""
    name = linkage.bodies[number].name
    colour = colour_of(number)
    outline = body_outline(linkage, name, _BAR * size)
    pose = position[0, 3 * number : 3 * number + 3]
    centre = pose[:2]
    along = direction_at(pose[2])
    turn = np.array([along, across(along)])
    label = _legend_text(linkage, name)
    face: dict[str, Any] = {"facecolor": colour, "edgecolor": colour, "alpha": 0.4}
    axes.add_patch(Polygon(centre + outline @ turn, zorder=2, label=label, **face))
    axes.plot(*centre, "+", markersize=7, color=colour, zorder=4)
    _arrow(axes, centre, centre + 0.07 * size * along, colour)


def _draw_slots(
    axes: Axes, linkage: Linkage, number: int, position: Array, size: float
) -> None:
    """Draw the guides that a body carries over the travel of their blocks."""
    name = linkage.bodies[number].name
    colour = colour_of(number)
    for guide in slots_of(linkage, name):
        corners = slot_outline(linkage, position, guide, _BAR * size)
        points = [Attachment(name, x, y) for x, y in corners.tolist()]
        outline = np.vstack([_path(linkage, position[:1], point) for point in points])
        edge: dict[str, Any] = {
            "facecolor": "none",
            "edgecolor": colour,
            "linewidth": 1.0,
        }
        axes.add_patch(Polygon(outline, zorder=3, **edge))


def _legend_text(linkage: Linkage, body: str) -> str:
    """Return the name of a body, with the mean speed of its drive, if it turns on."""
    speeds = [drive.mean_speed for drive in linkage.drives if drive.body == body]
    if not speeds:
        return body
    if speeds[0] == 0.0:
        return f"{body}, driven to and fro"
    return f"{body}, {abs(speeds[0]) * 30.0 / math.pi:.4g} rpm"


def _draw_guides(axes: Axes, linkage: Linkage, position: Array, size: float) -> None:
    """Draw fixed guides as dashed lines, with their walls."""
    for guide in linkage.guides:
        if guide.is_moving:
            continue
        along = direction_at(guide.direction)
        ends = np.outer([-0.25 * size, 0.25 * size], along)
        line = _path(linkage, position, Attachment(guide.body, 0.0, 0.0)) + ends
        axes.plot(
            *line.T, color="0.3", linewidth=0.9, linestyle=(0.0, (5.0, 2.0)), zorder=0
        )
        if guide.length is not None and guide.width is not None:
            half = 0.5 * guide.width * across(along)
            for wall in (line - half, line + half):
                axes.plot(*wall.T, color="0.3", linewidth=1.6, zorder=0)


def _draw_springs(axes: Axes, linkage: Linkage, position: Array) -> list[_Label]:
    """Draw springs as zigzags; return their labels."""
    labels = []
    fraction = np.linspace(0.0, 1.0, 4 * _WINDINGS + 1)
    is_wound = np.abs(fraction - 0.5) < 0.4
    swing = 0.03 * np.sin(2.0 * math.pi * _WINDINGS * fraction) * is_wound
    for spring in linkage.springs:
        first, second = (_path(linkage, position, end)[0] for end in spring.ends)
        normal = across(second - first)
        line = first + np.outer(fraction, second - first) - np.outer(swing, normal)
        axes.plot(*line.T, color=style.MUTED, linewidth=1.0, zorder=2)
        middle = 0.5 * (first + second)
        labels.append(_Label(spring.name, middle, 9.0, normal, {"color": style.MUTED}))
    return labels


def _draw_loads(axes: Axes, linkage: Linkage, position: Array, size: float) -> None:
    """Draw forces as red arrows to their points, moments as bent arrows."""
    for load in linkage.loads:
        point = Attachment(load.body, 0.0, 0.0)
        direction = None
        moment = 1.0
        if isinstance(load, Force):
            point = load.attachment
            direction = load.direction
            moment = 0.0
        elif isinstance(load, Load):
            moment = load.moment
            if load.x or load.y:
                direction = math.atan2(load.y, load.x)
        (place,) = _path(linkage, position, point)
        if direction is not None:
            start = place - 0.19 * size * direction_at(direction)
            _arrow(axes, start, place, _LOAD, 1.4)
        if moment:
            _bent_arrow(axes, place, moment, 0.045 * size, _LOAD)


def _arrow(
    axes: Axes, start: Array, end: Array, colour: str, linewidth: float = 0.8
) -> None:
    patch = FancyArrowPatch(
        tuple(start),
        tuple(end),
        arrowstyle="-|>",
        mutation_scale=8,
        zorder=8,
        color=colour,
        linewidth=linewidth,
        shrinkA=0,
        shrinkB=0,
    )
    axes.add_patch(patch)


def _bent_arrow(
    axes: Axes, place: Array, sense: float, radius: float, colour: str
) -> None:
    """Draw an arrow below and around a place, counterclockwise for a positive sense."""
    around = np.radians(np.linspace(215.0, 325.0, 30))
    arc = place + radius * np.column_stack([np.cos(around), np.sin(around)])
    if sense <= 0.0:
        arc = arc[::-1]
    axes.plot(*arc.T, color=colour, linewidth=1.1, zorder=6)
    _arrow(axes, arc[-2], arc[-1], colour, 1.1)
