"""The mechanism at an instant, labelled: bodies, joints, mass centres, drives, loads, angles."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.patches import FancyArrowPatch, Polygon

from presswear.linkage.elements import GROUND, Attachment, Linkage
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

_HEIGHT = 5.2
"""Of the figure, inches."""
_INSTANTS = 361
"""At which the paths of the joints are drawn."""
_LOAD = "tab:red"
_WINDINGS = 10
"""Of a spring."""
_MARGIN = 0.16
"""Around everything that moves, part of its size."""


def mechanism(result: Result, stages: Stages) -> list[Drawing]:
    """The mechanism of a result at the start; see ``labelled``."""
    return [labelled(result.scene)]


def labelled(scene: Scene, time: float = 0.0) -> Drawing:
    """Draw the mechanism of a scene at an instant, s, its joints closed."""
    linkage = scene.mechanism.linkage()
    period = scene.mechanism.period
    # A whole cycle, behind the run-up.
    times = np.append(time, scene.run_up + np.linspace(0.0, period, _INSTANTS))
    position = scene.ideal.at(times).position
    sheet = Sheet(figsize=(WIDTH, _HEIGHT), layout="constrained")
    axes = sheet.subplots()
    ends = [(joint.name, end) for joint in linkage.revolutes for end in (joint.first, joint.second)]
    paths = {name: _path(linkage, position, end) for name, end in ends}
    centres = [_path(linkage, position, Attachment(b.name, 0.0, 0.0)) for b in linkage.bodies]
    hung = [_path(linkage, position, end) for own in linkage.springs for end in own.ends]
    everything = np.vstack([*paths.values(), *centres, *hung])
    size = float(np.hypot(*np.ptp(everything, axis=0)))
    for path in paths.values():
        axes.plot(*path[1:].T, color=MUTED, linewidth=0.5, zorder=1)
    for joints in _together({name: path[0] for name, path in paths.items()}, size):
        _draw_joints(axes, scene, joints, paths[joints[0]][0], size)
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
        _draw_body(axes, body.name, points, centres[place][0], size, colour)
        angle = position[0, 3 * place + 2]
        tip = centres[place][0] + 0.07 * size * np.array([math.cos(angle), math.sin(angle)])
        _arrow(axes, centres[place][0], tip, colour)
    for drive in linkage.drives:
        hinge = next((end for _, end in ends if end.body == drive.body), None)
        if hinge is not None:
            _draw_drive(axes, _path(linkage, position, hinge)[0], drive.mean_speed, size)
    for spring in linkage.springs:
        one, other = (_path(linkage, position, end)[0] for end in spring.ends)
        _draw_spring(axes, spring.name, one, other)
    for load in linkage.loads:
        point = load.point if isinstance(load, Force) else f"{load.body}.centre"
        _draw_load(axes, load, _path(linkage, position, linkage.point(point, "loads"))[0], size)
    probe = linkage.probe
    watched = _path(linkage, position, Attachment(probe.body, probe.x, probe.y))[0]
    along = np.array([math.cos(probe.direction), math.sin(probe.direction)])
    _arrow(axes, watched, watched + 0.14 * size * along, "black", linewidth=1.6)
    low, high = everything.min(axis=0) - _MARGIN * size, everything.max(axis=0) + _MARGIN * size
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


def _draw_joints(axes: Axes, scene: Scene, names: Sequence[str], place: Array, size: float) -> None:
    """The pin joints at one place, their names in one text."""
    loose = [name for name in names if name in scene.clearance_joints]
    if loose:
        axes.plot(*place, "o", markersize=11, markerfacecolor="none", color="black", zorder=5)
    axes.plot(*place, "o", markersize=5, markerfacecolor="white", color="black", zorder=6)
    words = [", ".join(names)]
    for name in loose:
        of = f" of {name}" if len(names) > 1 else ""
        words.append(f"c{of} = {1e3 * scene.bearing(name).clearance:g} mm")
    x, y = place + 0.022 * size
    axes.text(x, y, "\n".join(words), weight="bold", zorder=7)


def _draw_body(
    axes: Axes,
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
        axes.add_patch(
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
        axes.plot(*corners.T, color=colour, linewidth=5.0, alpha=0.45, solid_capstyle="round")
    else:
        axes.plot(*centre, "s", markersize=16, color=colour, alpha=0.35)
    axes.plot(*centre, "+", markersize=7, color=colour, zorder=4)
    axes.annotate(
        name,
        (centre[0], centre[1]),
        xytext=(7, -11),
        textcoords="offset points",
        color=colour,
        zorder=7,
    )


def _arrow(axes: Axes, start: Array, end: Array, colour: str, linewidth: float = 0.8) -> None:
    axes.add_patch(
        FancyArrowPatch(
            tuple(start), tuple(end), arrowstyle="-|>", mutation_scale=8, shrinkA=0, shrinkB=0,
            color=colour, linewidth=linewidth, zorder=8,
        )
    )  # fmt: skip


def _draw_spring(axes: Axes, name: str, one: Array, other: Array) -> None:
    """A zigzag between the ends of a spring."""
    part = np.linspace(0.0, 1.0, 4 * _WINDINGS + 1)
    across = np.array([other[1] - one[1], one[0] - other[0]])
    length = max(float(np.hypot(*across)), 1e-300)
    swing = 0.03 * np.sin(2.0 * math.pi * _WINDINGS * part) * (np.abs(part - 0.5) < 0.4)
    line = one + np.outer(part, other - one) + np.outer(swing, across)
    axes.plot(*line.T, color=MUTED, linewidth=1.0, zorder=2)
    axes.annotate(
        name,
        tuple(0.5 * (one + other)),
        xytext=tuple(9.0 * across / length),
        textcoords="offset points",
        color=MUTED,
        zorder=7,
    )


def _draw_load(axes: Axes, load: AnyLoad, place: Array, size: float) -> None:
    """An arrow that ends where a force acts, along it; a bent one for a moment."""
    direction, moment = None, 1.0
    if isinstance(load, Force):
        direction = load.direction
    elif isinstance(load, Load):
        direction = math.atan2(load.y, load.x) if load.x or load.y else None
        moment = load.moment
    if direction is not None:
        along = np.array([math.cos(direction), math.sin(direction)])
        _arrow(axes, place - 0.19 * size * along, place, _LOAD, 1.4)
    if not isinstance(load, Force) and moment:
        _bent_arrow(axes, place, moment, 0.045 * size, _LOAD)


def _bent_arrow(axes: Axes, place: Array, sense: float, radius: float, colour: str) -> None:
    """An arrow around a place; counterclockwise where the sense is above zero."""
    around = np.radians(np.linspace(200.0, 340.0, 30))
    arc = place + radius * np.column_stack([np.cos(around), np.sin(around)])
    arc = arc if sense > 0.0 else arc[::-1]
    axes.plot(*arc.T, color=colour, linewidth=1.1, zorder=6)
    _arrow(axes, arc[-2], arc[-1], colour, 1.1)


def _draw_drive(axes: Axes, hinge: Array, speed: float, size: float) -> None:
    """A bent arrow around the hinge, in the sense in which the drive turns."""
    _bent_arrow(axes, hinge, speed, 0.06 * size, "black")
    axes.annotate(
        f"{abs(speed):.4g} rad/s", (hinge[0], hinge[1] - 0.065 * size), ha="center", va="top"
    )
