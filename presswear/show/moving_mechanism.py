"""One stroke of the mechanism as an SVG that a slider moves, with its clearances enlarged.

Places are those of the film of the last stage. The clearance of each joint is drawn
beside the mechanism, much larger than the radii, as in the replay.
"""

import json
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from markupsafe import Markup, escape
from numpy.typing import NDArray

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND
from presswear.linkage.surface import bin_centres
from presswear.recording.film import Film
from presswear.results.result import Result
from presswear.show.figures.style import Pen, ShownStage
from presswear.show.figures.window import sampled
from presswear.show.replay import shapes
from presswear.show.replay.clip import NORMAL, TANGENTIAL, X, Y
from presswear.show.words import in_words_of
from presswear.tools.arrays import Array
from presswear.tools.numbers import quantity_text

FRAMES = 120  # pictures of a stroke
MOST_JOINTS = 4  # enlarged joints: those with the largest forces of a stroke
_WIDTH = 420.0  # greatest width of the mechanism, in units of the picture
_HEIGHT = 340.0  # height of the picture
# Radius of the circle of an enlarged bearing, relative to the height of a joint
_CIRCLE = 0.4
_PIN = 0.55  # radius of an enlarged pin, relative to the radius of the circle
_ARROW = 0.9  # length of the arrow of the largest force, relative to the same radius
_LEAST_FORCE = 1e-300  # N, avoids a division by zero
_INK = "#1a1a1a"
_OUTLINE = 120  # points of the outline of a worn surface


class MovingMechanism(NamedTuple):
    """Picture that a slider moves: ``svg`` element, poses of each frame as JSON, and caption."""

    svg: Markup
    frames: str
    frame_count: int
    caption: str


class _Drawing(NamedTuple):
    """Scale and place of a mechanism in the picture."""

    scale: float  # units of the picture per m
    low: Array  # lower left corner of the mechanism, (2,), m
    size: Array  # width and height, (2,), units of the picture


def moving_mechanism(result: Result) -> MovingMechanism | None:
    """Return a stroke of the last stage as a picture that moves; None where none is recorded."""
    sound = [stage for stage in result.stages if not stage.failed]
    stages = [stage for stage in sound if stage.read_film and stage.time.size]
    if not stages:
        return None
    stage = stages[-1]
    scene = result.scene
    _, window = sampled(result, [ShownStage(stage, Pen("", _INK))])
    film = _frames_of(stage.film, window.start, window.start + window.period)
    if film is None:
        return None
    linkage = scene.linkage(stage.surfaces)
    drawing = _drawing_of(linkage, film)
    joints = _largest_joints(linkage, film)
    enlarged = {k: _factor(linkage, film, k, len(joints)) for k in joints}
    frames = {
        "bodies": _poses(linkage, film, drawing).tolist(),
        "joints": _places(linkage, film, enlarged).tolist(),
        "numbers": _numbers(film, window.period, window.run_up, joints).tolist(),
        "names": [window.phase, *(linkage.clearances[k].name for k in joints)],
    }
    stage_name = result.stage_name(stage.index)
    text = f"One stroke of the stage “{stage_name}”; its control moves it."
    if joints:
        clearances = []
        for k in joints:
            joint = linkage.clearances[k]
            clearances.append(f"{joint.name} {quantity_text(joint.clearance, 'm')}")
        gaps = ", ".join(clearances)
        text += f" The dashed circles have the radius of the new clearance, much enlarged: {gaps}. "
        text += "Wear is enlarged as much. The dot is the centre of the pin. Red: force of the "
        text += "pin on its bearing; the length of the arrow grows as the square root of the force."
    caption = in_words_of(scene, text)
    return MovingMechanism(
        _svg(linkage, film, drawing, enlarged),
        json.dumps(frames, ensure_ascii=False, separators=(",", ":")),
        len(film.time),
        caption,
    )


def _frames_of(film: Film, start: float, end: float) -> Film | None:
    """Return ``FRAMES`` evenly spaced frames between two times, s; None if it has no such time."""
    if not film.time[0] <= start < end <= film.time[-1] + 0.01 * (end - start):
        return None
    times = np.linspace(start, end, FRAMES)
    rows = np.searchsorted(film.time, times).clip(0, film.time.size - 1)
    return Film(film.time[rows], film.position[rows], film.joints[rows])


def _largest_joints(linkage: Linkage, film: Film) -> list[int]:
    """Return the indices of the pins with the largest forces, in increasing order."""
    pins = range(len(shapes.loose_pins(linkage)))
    forces = film.joints[:, :, NORMAL].max(axis=0)
    by_force = sorted(pins, key=lambda k: -forces[k])
    return sorted(by_force[:MOST_JOINTS])


def _drawing_of(linkage: Linkage, film: Film) -> _Drawing:
    """Return the scale of a mechanism with which all its places fit into the picture."""
    low, high = shapes.bounding_box(linkage, film.position)
    scale = float(min(np.array([_WIDTH, _HEIGHT]) / (high - low)))
    return _Drawing(scale, low, scale * (high - low))


def _poses(linkage: Linkage, film: Film, drawing: _Drawing) -> Array:
    """Return places, units, and angles, degrees, of the bodies, shape (n, 3 bodies)."""
    poses = film.position.reshape(len(film.time), -1, 3).copy()
    poses[..., :2] = drawing.scale * (poses[..., :2] - drawing.low)
    poses[..., 2] = np.degrees(poses[..., 2])
    return np.asarray(poses.round(1).reshape(len(film.time), -1))


def _radius(count: int) -> float:
    """Return the radius of the circles of enlarged clearances, units of the picture."""
    return _CIRCLE * _HEIGHT / max(count, 2)


def _eccentricity(linkage: Linkage, film: Film, k: int) -> Array:
    """Return the places of a pin in its bearing, shape (n, 2), m."""
    joint = linkage.clearances[k]
    bearing = shapes.points_of(linkage, film.position, joint.bearing)[:, :2]
    pin = shapes.points_of(linkage, film.position, joint.pin)[:, :2]
    return np.asarray(pin - bearing)


def _factor(linkage: Linkage, film: Film, k: int, count: int) -> float:
    """Return the scale of an enlarged clearance, units of the picture per m.

    The worn bearing, and the pin at its farthest place, are within the circle of ``_radius``.
    """
    joint = linkage.clearances[k]
    worn = joint.clearance + float(joint.bearing_surface.depth.max(initial=0.0))
    farthest = float(np.hypot(*_eccentricity(linkage, film, k).T).max())
    return (1.0 - _PIN) * _radius(count) / max(worn, farthest)


def _places(linkage: Linkage, film: Film, enlarged: Mapping[int, float]) -> Array:
    """Return the place of each pin centre and the arrow of its force, shape (n, 4 joints).

    Both have x and y in units of the picture. The place is relative to the centre of the
    bearing, and the arrow to the centre of the pin. ``enlarged`` has the scale of each joint
    by its index.
    """
    radius = _radius(len(enlarged))
    result = np.zeros((len(film.time), len(enlarged), 4))
    for column, (k, factor) in enumerate(enlarged.items()):
        result[:, column, :2] = factor * _eccentricity(linkage, film, k)
        row = film.joints[:, k]
        normal = row[:, [X, Y]]
        across = np.column_stack([-normal[:, 1], normal[:, 0]])
        force = row[:, [NORMAL]] * normal - row[:, [TANGENTIAL]] * across
        size = np.hypot(*force.T)
        largest = max(float(size.max()), _LEAST_FORCE)
        length = _ARROW * radius * np.sqrt(size / largest)
        scale = length / np.maximum(size, _LEAST_FORCE)
        result[:, column, 2:] = force * scale[:, np.newaxis]
    return np.asarray(result.round(1).reshape(len(film.time), -1))


def _numbers(
    film: Film, period: float, run_up: float, joints: list[int]
) -> NDArray[np.int64]:
    """Return the phase, degrees, and the normal forces, N, of each frame, (n, 1 + joints)."""
    turns = (film.time - 0.5 * run_up) / period
    degrees = np.round(360.0 * turns) % 360.0
    forces = film.joints[:, joints, NORMAL].round()
    return np.column_stack([degrees, forces]).astype(np.int64)


def _svg(
    linkage: Linkage, film: Film, drawing: _Drawing, enlarged: Mapping[int, float]
) -> Markup:
    """Return the picture with all bodies at their origin, upright by a flip of its y axis."""
    radius = _radius(len(enlarged))
    width = drawing.size[0]
    if enlarged:
        width += 2.0 * radius + 70.0
    parts = [
        f'<svg viewBox="0 0 {width:.0f} {_HEIGHT:.0f}" role="img" aria-label="mechanism">',
        f'<g transform="matrix(1 0 0 -1 0 {_HEIGHT:.0f})">',
        *_frame_parts(linkage, film, drawing),
        *_body_parts(linkage, film, drawing),
        "</g>",
    ]
    middle = drawing.size[0] + radius + 50.0
    for column, (k, factor) in enumerate(enlarged.items()):
        centre = _HEIGHT * (column + 0.5) / max(len(enlarged), 2)
        joint = linkage.clearances[k]
        gap = factor * joint.clearance
        pin_radius = _PIN * radius
        bearing = _outline(linkage, joint, "bearing", pin_radius + gap, factor)
        pin = _outline(linkage, joint, "pin", pin_radius, factor)
        parts += [
            f'<g transform="matrix(1 0 0 -1 {middle:.0f} {centre:.0f})">{bearing}',
            f'<circle r="{gap:.1f}" fill="none" stroke="#555" stroke-dasharray="3 2"/>',
            f'<g class="pin">{pin}<circle r="2" fill="{_INK}"/>',
            '<line stroke="#c1121f" stroke-width="2.5"/></g></g>',
            f'<text x="{middle - radius - 8.0:.0f}" y="{centre - 0.7 * radius:.0f}" ',
            f'text-anchor="end" font-weight="600">{escape(joint.name)}</text>',
        ]
    return Markup("".join([*parts, "</svg>"]))


def _outline(
    linkage: Linkage, joint: ClearanceJoint, side: str, radius: float, factor: float
) -> str:
    """Return the outline of a bearing or a pin, whose wear is enlarged as the clearance is.

    ``radius`` is that of the unworn surface, units of the picture. A worn outline turns
    with its body.
    """
    is_pin = side == "pin"
    surface = joint.pin_surface if is_pin else joint.bearing_surface
    fill = "#9aa5b1" if is_pin else "#eef0f3"
    opacity = 0.6 if is_pin else 1.0
    style = f'fill="{fill}" fill-opacity="{opacity}" stroke="{_INK}"'
    count = surface.depth.size
    if not count:
        return f'<circle r="{radius:.1f}" {style}/>'
    rows = slice(None, None, max(count // _OUTLINE, 1))
    worn = factor * surface.depth[rows]
    distance = radius - worn if is_pin else radius + worn
    angle = bin_centres(count)[rows]
    points = distance[:, np.newaxis] * np.column_stack([np.cos(angle), np.sin(angle)])
    body = (joint.pin if is_pin else joint.bearing).body
    turning = ""
    if joint.map_frame == "body" and body != GROUND:
        turning = f' class="outline" data-body="{linkage.index(body)}"'
    return f'<path d="{_path(points)}" {style}{turning}/>'


def _body_parts(linkage: Linkage, film: Film, drawing: _Drawing) -> list[str]:
    """Return the outline of each body with its holes and slots."""
    parts = []
    bar = shapes.BAR * float(np.hypot(*drawing.size)) / drawing.scale
    for k, body in enumerate(linkage.bodies):
        colour = shapes.colour_of(k)
        outline = drawing.scale * shapes.body_outline(linkage, body.name, 0.7 * bar)
        style = f'fill="{colour}" fill-opacity="0.45" stroke="{colour}"'
        shown = f'<path d="{_path(outline)}" {style}/>'
        for guide in shapes.slots_of(linkage, body.name):
            slot = shapes.slot_outline(linkage, film.position, guide, 0.7 * bar)
            path = _path(drawing.scale * slot)
            shown += f'<path d="{path}" fill="none" stroke="{colour}"/>'
        for end in shapes.attachments(linkage, body.name):
            x = drawing.scale * end.x
            y = drawing.scale * end.y
            shown += f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2"/>'
        parts.append(f'<g class="body">{shown}</g>')
    return parts


def _frame_parts(linkage: Linkage, film: Film, drawing: _Drawing) -> list[str]:
    """Return the joints of the frame and the guides."""
    parts = []
    for point in shapes.attachments(linkage, GROUND):
        x, y = drawing.scale * (np.array([point.x, point.y]) - drawing.low)
        triangle = np.array([[x, y], [x - 7.0, y - 11.0], [x + 7.0, y - 11.0]])
        parts.append(f'<path d="{_path(triangle)}" fill="#c9ced6" stroke="#555"/>')
    for guide in shapes.guides_of(linkage):
        if guide.is_moving:
            continue
        k = linkage.index(guide.body)
        places = film.position[:, 3 * k : 3 * k + 2]
        along = shapes.direction(guide.direction)
        travel = (places - places[0]) @ along
        ends = places[0] + np.outer([travel.min(), travel.max()], along)
        ends = drawing.scale * (ends - drawing.low) + np.outer([-14.0, 14.0], along)
        parts.append(
            f'<path d="{_path(ends)}" stroke="#555" stroke-dasharray="6 3" fill="none"/>'
        )
    return parts


def _path(points: Array) -> str:
    """Return a closed polygon as the data of an SVG path."""
    places = [f"{x:.1f} {y:.1f}" for x, y in points.tolist()]
    return f"M{'L'.join(places)}z"
