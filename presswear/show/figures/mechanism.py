"""The mechanism at an instant, labelled: bodies, joints, mass centres, drives, loads, angles."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.patches import FancyArrowPatch, Polygon

from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import AnyLoad, Force, Load
from presswear.results.result import Result
from presswear.scene.scene import Scene
from presswear.show.figures.style import (
    LINES,
    MUTED,
    WIDTH,
    Array,
    Axes,
    Drawing,
    Sheet,
    Stages,
)
from presswear.tools.numbers import readable

_HEIGHTS = (3.2, 6.4)
"""Least and greatest of the figure, inches."""
_EDGES = 0.65, 0.55
"""Of the figure beside and below what is drawn, inches."""
_INSTANTS = 361
"""At which the paths of the joints are drawn."""
_LOAD = "tab:red"
_WINDINGS = 10
"""Of a spring."""
_MARGIN = 0.16
"""Around everything that moves, part of its size."""
_LETTER, _LINE = 5.0, 11.0
"""Width of a letter and height of a line of text, points, about."""
_SIDES = (45, 0, 315, 135, 180, 225, 90, 270)
"""Where a label may stand, degrees from the right, counterclockwise."""
_RINGS = 3
"""Distances at which it may."""
_BETWEEN = 40
"""Points along a line that labels keep away from."""


class Canvas:
    """Axes with texts beside what they name, each where it hides least of what is drawn.

    Parameters
    ----------
    axes : Axes
    scale : float
        Points of the printed figure in a metre of the mechanism, about.
    """

    def __init__(self, axes: Axes, scale: float) -> None:
        self.axes, self._scale = axes, scale
        self._texts: list[tuple[str, Array, float, dict[str, Any]]] = []
        self._taken: list[tuple[float, float, float]] = []

    def avoid(self, points: Array, radius: float) -> None:
        """Keep texts away from points, shape (n, 2), m, by a radius in points of print."""
        self._taken += [(x, y, radius) for x, y in self._scale * points]

    def add(self, text: str, place: Array, gap: float, **look: Any) -> None:
        """Put a text beside a place, m, at a gap in points of print."""
        self._texts.append((text, place, gap, look))

    def draw(self) -> None:
        """Place them, one after the other, when all that they keep away from is known."""
        for text, place, gap, look in self._texts:
            lines = text.split("\n")
            box = np.array([_LETTER * max(map(len, lines)), _LINE * len(lines)])
            found = [
                (self._hidden(middle, 0.5 * box) + 0.3 * far + 0.01 * k, k, far, middle)
                for far in range(_RINGS)
                for k, middle in enumerate(self._around(place, gap + _LINE * far, 0.5 * box))
            ]
            *_, middle = min(found, key=lambda own: own[:3])
            x, y = middle / self._scale
            self.axes.text(x, y, text, ha="center", va="center", zorder=9, **look)
            count = math.ceil(box[0] / _LINE)
            across = ((np.arange(count) + 0.5) / count - 0.5) * box[0]
            for row in range(len(lines)):
                y = middle[1] + 0.5 * box[1] - (row + 0.5) * _LINE
                self._taken += [(middle[0] + x, y, 0.5 * _LINE) for x in across]

    def _around(self, place: Array, gap: float, half: Array) -> Iterator[Array]:
        """Middles of a text around a place, points of print; to the upper right first."""
        for degrees in _SIDES:
            away = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
            yield self._scale * place + gap * away + half * np.clip(1.5 * away, -1.0, 1.0)

    def _hidden(self, middle: Array, half: Array) -> float:
        """How much a text would hide, part of its height each."""
        if not self._taken:
            return 0.0
        taken = np.array(self._taken)
        off = np.maximum(np.abs(taken[:, :2] - middle) - half, 0.0)
        return float(np.maximum(taken[:, 2] - np.hypot(*off.T), 0.0).sum()) / _LINE


def _along(corners: Array) -> Array:
    """Points along a closed line of corners, shape (n, 2)."""
    part = np.linspace(0.0, 1.0, _BETWEEN)[:, np.newaxis]
    pairs = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    return np.vstack([one + part * (other - one) for one, other in pairs])


def mechanism(result: Result, stages: Stages) -> list[Drawing]:
    """The mechanism of a result at the start; see ``labelled``."""
    return [labelled(result.scene)]


def labelled(scene: Scene, time: float = 0.0) -> Drawing:
    """Draw the mechanism of a scene at an instant, s, its joints closed."""
    linkage = scene.base_linkage
    period = scene.mechanism.period
    # A whole cycle, behind the run-up.
    times = np.append(time, scene.run_up + np.linspace(0.0, period, _INSTANTS))
    position = scene.ideal.at(times).position
    ends = [(joint.name, end) for joint in linkage.revolutes for end in (joint.first, joint.second)]
    paths = {name: _path(linkage, position, end) for name, end in ends}
    centres = [_path(linkage, position, Attachment(b.name, 0.0, 0.0)) for b in linkage.bodies]
    hung = [_path(linkage, position, end) for own in linkage.springs for end in own.ends]
    everything = np.vstack([*paths.values(), *centres, *hung])
    size = float(np.hypot(*np.ptp(everything, axis=0)))
    low, high = everything.min(axis=0) - _MARGIN * size, everything.max(axis=0) + _MARGIN * size
    wide, tall = high - low
    height = min(max((WIDTH - _EDGES[0]) * tall / wide + _EDGES[1], _HEIGHTS[0]), _HEIGHTS[1])
    sheet = Sheet(figsize=(WIDTH, height), layout="constrained")
    axes = sheet.subplots()
    scale = 72.0 * min((WIDTH - _EDGES[0]) / wide, (height - _EDGES[1]) / tall)
    canvas = Canvas(axes, scale)
    for path in paths.values():
        axes.plot(*path[1:].T, color=MUTED, linewidth=0.5, zorder=1)
    for joints in _together({name: path[0] for name, path in paths.items()}, size):
        _draw_joints(canvas, scene, joints, paths[joints[0]][0])
    for name, end in ends:
        if end.body == GROUND:
            axes.plot(*paths[name][0], marker=(3, 0, 0), markersize=15, color="0.8", zorder=0)
    for guide in linkage.guides:
        along = np.array([math.cos(guide.direction), math.sin(guide.direction)])
        middle = centres[linkage.index(guide.body)][0]
        line = middle + np.outer([-0.25 * size, 0.25 * size], along)
        axes.plot(*line.T, color="0.3", linewidth=0.9, linestyle=(0.0, (5.0, 2.0)), zorder=0)
    for place, body in enumerate(linkage.bodies):
        colour = LINES[place % len(LINES)][0]
        points = [_path(linkage, position, end)[0] for _, end in ends if end.body == body.name]
        _draw_body(canvas, body.name, points, centres[place][0], size, colour)
        angle = position[0, 3 * place + 2]
        tip = centres[place][0] + 0.07 * size * np.array([math.cos(angle), math.sin(angle)])
        _arrow(canvas, centres[place][0], tip, colour)
    for drive in linkage.drives:
        hinge = next((end for _, end in ends if end.body == drive.body), None)
        if hinge is not None:
            _draw_drive(canvas, _path(linkage, position, hinge)[0], drive.mean_speed, size)
    for spring in linkage.springs:
        one, other = (_path(linkage, position, end)[0] for end in spring.ends)
        _draw_spring(canvas, spring.name, one, other)
    for load in linkage.loads:
        point = load.attachment if isinstance(load, Force) else Attachment(load.body, 0.0, 0.0)
        _draw_load(canvas, load, _path(linkage, position, point)[0], size)
    probe = linkage.output
    watched = _path(linkage, position, Attachment(probe.body, probe.x, probe.y))[0]
    along = np.array([math.cos(probe.direction), math.sin(probe.direction)])
    _arrow(canvas, watched, watched + 0.14 * size * along, "black", linewidth=1.6)
    canvas.draw()
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
        axis.set_major_formatter(lambda value, place: f"{1e3 * value:.4g}")
        axis.set_label_text(f"{name} (mm)")
    caption = (
        f"{linkage.name}, all joints closed, {readable(1e3 * time)} ms after the start; one cycle "
        f"takes {readable(1e3 * period)} ms. Circles: pin joints, those with clearance ringed; "
        "triangles: on the frame; dashed: guides. A cross is a mass centre; the thin arrow from it "
        "is the body's x axis, whose angle counts counterclockwise from the right. Bent arrows: "
        "drives; the thick black arrow: what is watched, along its direction. "
        f"{'Zigzag: springs. ' if linkage.springs else ''}"
        f"{'Red: loads, along the directions in which they count. ' if linkage.loads else ''}"
        "Grey: the paths of the joints."
    )
    return Drawing("mechanism.png", "The mechanism", caption, sheet)


def _path(linkage: Linkage, position: Array, end: Attachment) -> Array:
    """Places of a point at all instants, shape (n, 2), m."""
    if end.body == GROUND:
        return np.tile([end.x, end.y], (len(position), 1))
    column = 3 * linkage.index(end.body)
    x, y, angle = position[:, column : column + 3].T
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack([x + cosine * end.x - sine * end.y, y + sine * end.x + cosine * end.y])


def _together(places: Mapping[str, Array], size: float) -> list[list[str]]:
    """Names of what lies at one place, part of the drawing, in their order."""
    found: list[list[str]] = []
    for name, place in places.items():
        near = (own for own in found if np.abs(places[own[0]] - place).max() < 0.01 * size)
        own = next(near, None)
        found.append([name]) if own is None else own.append(name)
    return found


def _draw_joints(canvas: Canvas, scene: Scene, names: Sequence[str], place: Array) -> None:
    """The pin joints at one place, their names in one text."""
    loose = [name for name in names if name in scene.clearance_joints]
    if loose:
        canvas.axes.plot(
            *place, "o", markersize=11, markerfacecolor="none", color="black", zorder=5
        )
    canvas.axes.plot(*place, "o", markersize=5, markerfacecolor="white", color="black", zorder=6)
    words = [", ".join(names)]
    for name in loose:
        of = f" of {name}" if len(names) > 1 else ""
        words.append(f"c{of} = {1e3 * scene.bearing(name).clearance:g} mm")
    canvas.avoid(place[np.newaxis], 9.0 if loose else 5.0)
    canvas.add("\n".join(words), place, 9.0 if loose else 6.0, weight="bold")


def _draw_body(
    canvas: Canvas,
    name: str,
    points: list[Array],
    centre: Array,
    size: float,
    colour: str,
) -> None:
    """A bar between two joints, a plate between more, a block around one."""
    distinct: list[Array] = []
    for point in points:
        if all(np.abs(point - other).max() > 1e-6 * size for other in distinct):
            distinct.append(point)
    corners = np.array([*distinct, centre] if len(distinct) == 1 else distinct or [centre])
    if len(distinct) > 2:
        around = np.arctan2(*(corners - corners.mean(axis=0)).T[::-1])
        canvas.axes.add_patch(
            Polygon(
                corners[np.argsort(around)],
                facecolor=colour,
                edgecolor=colour,
                alpha=0.35,
                linewidth=3.0,
                joinstyle="round",
            )
        )
    elif np.ptp(corners, axis=0).max() > 1e-9 * size:
        canvas.axes.plot(
            *corners.T, color=colour, linewidth=5.0, alpha=0.45, solid_capstyle="round"
        )
    else:
        canvas.axes.plot(*centre, "s", markersize=16, color=colour, alpha=0.35)
        canvas.avoid(centre[np.newaxis], 8.0)
    canvas.axes.plot(*centre, "+", markersize=7, color=colour, zorder=4)
    canvas.avoid(_along(corners), 3.0)
    canvas.add(name, centre, 8.0, color=colour)


def _arrow(canvas: Canvas, start: Array, end: Array, colour: str, linewidth: float = 0.8) -> None:
    canvas.avoid(_along(np.array([start, end])), 3.0)
    canvas.axes.add_patch(
        FancyArrowPatch(
            tuple(start), tuple(end), arrowstyle="-|>", mutation_scale=8, shrinkA=0, shrinkB=0,
            color=colour, linewidth=linewidth, zorder=8,
        )
    )  # fmt: skip


def _draw_spring(canvas: Canvas, name: str, one: Array, other: Array) -> None:
    """A zigzag between the ends of a spring."""
    part = np.linspace(0.0, 1.0, 4 * _WINDINGS + 1)
    across = np.array([other[1] - one[1], one[0] - other[0]])
    swing = 0.03 * np.sin(2.0 * math.pi * _WINDINGS * part) * (np.abs(part - 0.5) < 0.4)
    line = one + np.outer(part, other - one) + np.outer(swing, across)
    canvas.axes.plot(*line.T, color=MUTED, linewidth=1.0, zorder=2)
    canvas.avoid(_along(np.array([one, other])), 4.0)
    canvas.add(name, 0.5 * (one + other), 9.0, color=MUTED)


def _draw_load(canvas: Canvas, load: AnyLoad, place: Array, size: float) -> None:
    """An arrow that ends where a force acts, along it; a bent one for a moment."""
    direction, moment = None, 1.0
    if isinstance(load, Force):
        direction = load.direction
    elif isinstance(load, Load):
        direction = math.atan2(load.y, load.x) if load.x or load.y else None
        moment = load.moment
    if direction is not None:
        along = np.array([math.cos(direction), math.sin(direction)])
        _arrow(canvas, place - 0.19 * size * along, place, _LOAD, 1.4)
    if not isinstance(load, Force) and moment:
        _bent_arrow(canvas, place, moment, 0.045 * size, _LOAD)


def _bent_arrow(canvas: Canvas, place: Array, sense: float, radius: float, colour: str) -> None:
    """An arrow around a place; counterclockwise where the sense is above zero."""
    around = np.radians(np.linspace(200.0, 340.0, 30))
    arc = place + radius * np.column_stack([np.cos(around), np.sin(around)])
    arc = arc if sense > 0.0 else arc[::-1]
    canvas.avoid(arc, 3.0)
    canvas.axes.plot(*arc.T, color=colour, linewidth=1.1, zorder=6)
    _arrow(canvas, arc[-2], arc[-1], colour, 1.1)


def _draw_drive(canvas: Canvas, hinge: Array, speed: float, size: float) -> None:
    """A bent arrow around the hinge, in the sense in which the drive turns."""
    _bent_arrow(canvas, hinge, speed, 0.06 * size, "black")
    below = hinge - [0.0, 0.06 * size]
    canvas.add(f"{abs(speed):.4g} rad/s", below, 4.0)
