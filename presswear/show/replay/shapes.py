"""Shapes of a planar linkage: bodies, frame, and enlarged joints with clearance.

Shapes are triangles in layers, the higher ones in front. In an enlarged joint,
clearance and wear have the same scale, much larger than that of the radius, so that pin
and bearing touch in the drawing when they touch in the run. The wear depth is drawn
again, with a larger scale, as a band behind each surface.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_rgba
from numpy.typing import NDArray

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import CORNERS, GuideCorner, corner_ends
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.tools.arrays import Array

Point = Sequence[float] | Array
Colour = tuple[float, ...]  # red, green, blue, alpha, 0 to 1

SEGMENTS = 48  # straight segments of a full circle
# Palette of Okabe and Ito, distinguishable with every common colour blindness.
BODY_COLOURS = (
    "#D55E00",
    "#0072B2",
    "#E69F00",
    "#009E73",
    "#CC79A7",
    "#56B4E9",
    "#F0E442",
    "#777777",
)
JOINT_COLOURS = tuple(map(to_rgba, ("#0072B2", "#D55E00", "#009E73", "#CC79A7")))
INK = to_rgba("#1a1a1a")
PAPER = to_rgba("#ffffff")
STEEL = to_rgba("#c9ced6")
WORN = to_rgba("#E69F00")
FORCE = to_rgba("#c1121f")
PIN = to_rgba("#9aa5b1")
LAYER_STEP = 1e-3  # distance of two layers over the size of the mechanism
BAR = 0.017  # half width of a bar over the size of the mechanism
# Length and width of a block in a guide, in half widths of a bar
_BLOCK_LENGTH = 5.6
_BLOCK_WIDTH = 4.4
# Sizes in the drawing of an enlarged joint, part of its radius: pin, clearance with wear, band
# of the wear depth, and arrow of the largest force
PIN_SHARE = 0.34
PLAY_SHARE = 0.36
BAND_SHARE = 0.13
ARROW_SHARE = 0.55
DRAWN_BINS = 180  # bins of a wear map that are drawn
_WALL_BARS = 125  # bars that show the wear of a wall; a divisor of its bins
# Length of the bar of the deepest wear, in half widths of a bar of the mechanism
_DEEPEST_BARS = 4.0
_EDGE = 0.22  # width of the line of a wall or a foot, in half widths of a bar


class Shape(NamedTuple):
    """Triangles, shape (t, 3), of points, shape (n, 2), m, with one colour in a layer."""

    points: Array
    triangles: NDArray[np.int64]
    layer: int
    colour: Colour


def colour_of(body: int) -> str:
    """Return the colour of a body by its number."""
    return BODY_COLOURS[body % len(BODY_COLOURS)]


def moved(shape: Shape, pose: Array) -> Shape:
    """Return a shape of a body in a pose: coordinates of its origin, m, and angle, rad."""
    along = direction(pose[2])
    return shape._replace(
        points=pose[:2] + shape.points @ np.array([along, across(along)])
    )


def direction(angle: float) -> Array:
    """Return the unit vector at an angle, rad."""
    return np.array([math.cos(angle), math.sin(angle)])


def points_of(linkage: Linkage, positions: Array, point: Attachment) -> Array:
    """Return the coordinates, m, of a point and the angle of its body, rad; shape (n, 3)."""
    if point.body == GROUND:
        return np.tile([point.x, point.y, 0.0], (len(positions), 1))
    base = 3 * linkage.index(point.body)
    x, y, angle = positions[:, base : base + 3].T
    c = np.cos(angle)
    s = np.sin(angle)
    return np.column_stack(
        [x + c * point.x - s * point.y, y + s * point.x + c * point.y, angle]
    )


def loose_pins(linkage: Linkage) -> list[ClearanceJoint]:
    """Return the pin joints with clearance, which come before the corners of slides."""
    return [joint for joint in linkage.clearances if not isinstance(joint, GuideCorner)]


def guides_of(linkage: Linkage) -> tuple[Guide, ...]:
    """Return all guides, with and without clearance."""
    return (*linkage.guides, *linkage.loose_guides)


def slots_of(linkage: Linkage, body: str) -> list[Guide]:
    """Return the guides that a body carries."""
    return [guide for guide in guides_of(linkage) if guide.on == body]


def slot_outline(linkage: Linkage, positions: Array, guide: Guide, bar: float) -> Array:
    """Return the space that a block needs in the body that carries its guide, m, shape (4, 2).

    It is a rectangle in the axes of this body, around the block in all its positions. A
    slot whose block has a length and a width is to scale, with its clearance.
    """
    lines = points_of(linkage, positions, Attachment(guide.on, guide.x, guide.y))
    gaps = points_of(linkage, positions, Attachment(guide.body, 0.0, 0.0)) - lines
    angles = guide.direction + lines[:, 2]
    travel = gaps[:, 0] * np.cos(angles) + gaps[:, 1] * np.sin(angles)
    half = _half_size_of(guide, bar)
    if guide.length is not None:
        half += [bar, clearances_of(linkage).get(guide.name, 0.0)]
    half_length, half_width = half
    low = travel.min() - half_length
    high = travel.max() + half_length
    x = np.array([low, high, high, low])
    y = half_width * np.array([-1.0, -1.0, 1.0, 1.0])
    corners = np.column_stack([x, y])
    along = direction(guide.direction)
    return np.array([guide.x, guide.y]) + corners @ [along, across(along)]


def _half_size_of(guide: Guide, bar: float) -> Array:
    """Return half the length and half the width of the block in a guide, m, shape (2,)."""
    length = guide.length or _BLOCK_LENGTH * bar
    width = guide.width or _BLOCK_WIDTH * bar
    return np.array([0.5 * length, 0.5 * width])


def clearances_of(linkage: Linkage) -> dict[str, float]:
    """Return the clearance of each guide that has one, m, by its name."""
    return {corner.guide.name: corner.clearance for corner in linkage.corners}


def slide_corners(guide: Guide) -> list[Attachment]:
    """Return the corners of a slide, in turn around it; none without a length and a width."""
    if guide.length is None or guide.width is None:
        return []
    corners = []
    for name in ("left front", "left back", "right back", "right front"):
        _, corner = corner_ends(guide, *CORNERS[name])
        corners.append(corner)
    return corners


def attachments(linkage: Linkage, body: str) -> list[Attachment]:
    """Return the points at which a body, or the ground, is connected."""
    ends: list[Attachment] = []
    for joint in linkage.revolutes:
        ends += [joint.first, joint.second]
    for pin in loose_pins(linkage):
        ends += [pin.bearing, pin.pin]
    for spring in linkage.springs:
        ends += spring.ends
    return [end for end in ends if end.body == body]


def body_outline(linkage: Linkage, body: str, bar: float, inset: float = 0.0) -> Array:
    """Return the outline of a body in its own frame, m, shape (n, 2).

    It is a block in a guide, with the joints outside of it, otherwise a bar or a plate
    around the joints, or around one joint and the mass centre. A slide with a length
    and a width is to scale. ``bar`` is the half width of a bar.
    """
    points = [(end.x, end.y) for end in attachments(linkage, body)]
    guides = [guide for guide in guides_of(linkage) if guide.body == body]
    outline = np.zeros((0, 2))
    if guides:
        guide = guides[0]
        half = _half_size_of(guide, bar) - inset
        along = direction(guide.direction - guide.angle)
        corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        outline = corners @ [along, across(along)]
        inside = half.max() if guide.length is None else half.min()
        points = [point for point in points if math.hypot(*point) > inside]
        if not points:
            return outline
    elif len(points) < 2:
        points.append((0.0, 0.0))
    discs = np.vstack([outline, *(circle(point, bar - inset) for point in points)])
    return convex_hull(discs)


def convex_hull(points: Array) -> Array:
    """Return the corners of the convex hull of points, (n, 2), counterclockwise.

    Andrew's monotone chain; ``scipy.spatial`` would be slow to import.
    """
    ordered = np.unique(points, axis=0).tolist()

    def chain(points: list[list[float]]) -> list[list[float]]:
        corners: list[list[float]] = []
        for x, y in points:
            while len(corners) > 1:
                (x0, y0), (x1, y1) = corners[-2:]
                if (x1 - x0) * (y - y0) > (y1 - y0) * (x - x0):
                    break
                corners.pop()
            corners.append([x, y])
        return corners[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))


def across(vector: Array) -> Array:
    """Return a vector turned left by a right angle."""
    return np.array([-vector[1], vector[0]])


def circle(centre: Point, radius: float, segments: int = SEGMENTS) -> Array:
    """Return points on a circle, shape (segments, 2)."""
    angle = np.linspace(0.0, 2.0 * math.pi, segments, endpoint=False)
    return np.asarray(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def filled(outline: Array, layer: int, paint: Colour) -> Shape:
    """Return the inside of an outline, shape (n, 2), that is star-shaped about its mean point."""
    k = np.arange(len(outline))
    triangles = np.column_stack([np.zeros_like(k), 1 + k, 1 + (k + 1) % len(k)])
    return Shape(np.vstack([outline.mean(axis=0), outline]), triangles, layer, paint)


def band(inner: Array, outer: Array, layer: int, paint: Colour) -> Shape:
    """Return the area between two closed lines, shape (n, 2) each."""
    k = np.arange(len(inner))
    count = len(inner)
    following = (k + 1) % count
    quarters = [(k, count + k, count + following), (k, count + following, following)]
    return Shape(np.vstack([inner, outer]), np.hstack(quarters).T, layer, paint)


def ring(
    centre: Point, radius: float, width: float, layer: int, paint: Colour
) -> Shape:
    """Return a circular line of some width."""
    inner = circle(centre, radius - 0.5 * width, 2 * SEGMENTS)
    outer = circle(centre, radius + 0.5 * width, 2 * SEGMENTS)
    return band(inner, outer, layer, paint)


def segments(
    points: Array, width: float, layer: int, paints: Sequence[Colour]
) -> list[Shape]:
    """Return the lines between successive points, shape (n, 2), one colour each."""
    normal = np.diff(points, axis=0)[:, ::-1] * (-1.0, 1.0)
    length = np.hypot(*normal.T)
    normal *= (0.5 * width / np.where(length > 0.0, length, 1.0))[:, None]
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    lines = []
    for a, b, n, paint in zip(points[:-1], points[1:], normal, paints, strict=True):
        corners = np.array([a - n, b - n, b + n, a + n])
        lines.append(Shape(corners, triangles, layer, paint))
    return lines


def line(start: Point, end: Point, width: float, layer: int, paint: Colour) -> Shape:
    """Return a straight line of some width."""
    points = np.array([start, end], dtype=float)
    (shape,) = segments(points, width, layer, [paint])
    return shape


def arrow(
    start: Array, vector: Array, width: float, layer: int, paint: Colour
) -> list[Shape]:
    """Return an arrow from a point along a vector that is not zero."""
    length = float(np.hypot(*vector))
    head = min(4.0 * width, length)
    neck = start + (1.0 - head / length) * vector
    tip = start + vector
    wings = 0.45 * head / length * across(vector)
    outline = np.array([neck - wings, tip, neck + wings])
    return [line(start, neck, width, layer, paint), filled(outline, layer, paint)]


def hatched(ends: Array, side: float, bar: float) -> list[Shape]:
    """Return an edge of the frame, hatched on the left for side = 1 and on the right for -1."""
    start, end = ends
    vector = end - start
    length = float(np.hypot(*vector))
    along = vector / length
    slant = 0.9 * bar * (side * across(along) - along)
    marks = np.linspace(0.0, 1.0, max(int(length / (0.9 * bar)), 2))
    feet = start + np.outer(marks, vector)
    lines = [line(foot, foot + slant, 0.132 * bar, 1, INK) for foot in feet]
    return [line(start, end, _EDGE * bar, 1, INK), *lines]


def mix(first: Colour, second: Colour, share: float) -> Colour:
    """Return ``first`` with a share, 0 to 1, of ``second``."""
    pairs = zip(first, second, strict=True)
    return tuple((1.0 - share) * x + share * y for x, y in pairs)


def bounding_box(linkage: Linkage, positions: Array) -> tuple[Array, Array]:
    """Return the lowest and highest x, y, m, of a moving linkage with a margin."""
    ends = attachments(linkage, GROUND)
    for body in linkage.bodies:
        ends += attachments(linkage, body.name)
        ends.append(Attachment(body.name, 0.0, 0.0))
    for guide in guides_of(linkage):
        ends += slide_corners(guide)
    points = np.vstack([points_of(linkage, positions, point)[:, :2] for point in ends])
    low = points.min(axis=0)
    high = points.max(axis=0)
    margin = 0.09 * float(np.hypot(*(high - low)))
    return low - margin, high + margin


def body_shapes(
    linkage: Linkage, positions: Array, number: int, bar: float
) -> list[Shape]:
    """Return a body in its own frame with its holes, slots, mass centre and bearings."""
    body = linkage.bodies[number].name
    fill = to_rgba(colour_of(number))
    edge = mix(fill, INK, 0.55)
    drawn = [filled(circle((0.0, 0.0), 0.16 * bar, 12), 39, edge)]
    for inset, z, paint in ((0.0, 4, edge), (0.22 * bar, 5, fill)):
        outline = body_outline(linkage, body, bar, inset)
        drawn.append(filled(outline, 3 * number + z, paint))
    for guide in slots_of(linkage, body):
        corners = slot_outline(linkage, positions, guide, bar)
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            drawn.append(line(start, end, _EDGE * bar, 3 * number + 6, edge))
    bearings = {joint.bearing: k for k, joint in enumerate(linkage.clearances)}
    for end in attachments(linkage, body):
        centre = (end.x, end.y)
        drawn.append(filled(circle(centre, 0.55 * bar, 24), 40, INK))
        drawn.append(filled(circle(centre, 0.35 * bar, 24), 41, PAPER))
        if end in bearings:
            paint = JOINT_COLOURS[bearings[end] % len(JOINT_COLOURS)]
            drawn.append(ring(centre, 1.35 * bar, 0.5 * bar, 3 * number + 6, paint))
    return drawn


def frame_shapes(linkage: Linkage, positions: Array, bar: float) -> list[Shape]:
    """Return the pedestals of the ground joints and the guides along the path of their bodies."""
    drawn: list[Shape] = []
    for point in attachments(linkage, GROUND):
        centre = np.array([point.x, point.y])
        foot = centre - [0.0, 3.4 * bar]
        side = np.array([2.2 * bar, 0.0])
        drawn.append(filled(np.array([centre, foot - side, foot + side]), 1, STEEL))
        drawn.append(filled(circle(centre, 1.3 * bar), 2, STEEL))
        ends = np.array([foot - 1.3 * side, foot + 1.3 * side])
        drawn += hatched(ends, -1.0, bar)
    clearances = clearances_of(linkage)
    for guide in guides_of(linkage):
        if guide.is_moving:
            continue
        along = direction(guide.direction)
        base = np.array([guide.x, guide.y])
        places = points_of(linkage, positions, Attachment(guide.body, 0.0, 0.0))
        travel = (places[:, :2] - base) @ along
        reach = max(4.0 * bar, 0.5 * (guide.length or 0.0) + bar)
        ends = base + np.outer([travel.min() - reach, travel.max() + reach], along)
        half = 2.35 * bar
        if guide.width is not None:  # to scale, beside the edge of the line
            wall = 0.5 * guide.width + clearances.get(guide.name, 0.0)
            half = wall + 0.5 * _EDGE * bar
        for sign in (-1.0, 1.0):
            drawn += hatched(ends + sign * half * across(along), sign, bar)
    return drawn


def wall_factor(depth: float, bar: float) -> float:
    """Return the factor by which the wear of walls is enlarged; 0 without wear.

    ``depth`` is the greatest wear depth, and ``bar`` the half width of a bar, m.
    """
    return two_digits(_DEEPEST_BARS * bar / depth) if depth > 0.0 else 0.0


def worn_walls(linkage: Linkage, factor: float, body: str = GROUND) -> list[Shape]:
    """Return the worn profiles of the walls that a body or the frame carries.

    Their depth is drawn times a factor. A bar has the greatest depth of its bins, because
    a trench may be narrower than it.
    """
    drawn: list[Shape] = []
    corners = [corner for corner in linkage.corners if corner.guide.on == body]
    walls = {(corner.guide.name, corner.side): corner for corner in corners}
    for corner in walls.values():
        guide = corner.guide
        surface = corner.bearing_surface
        wall = corner.wall
        if wall is None or guide.width is None or not surface.is_worn:
            continue
        depths = surface.depth.reshape(_WALL_BARS, -1).max(axis=1)
        ends = wall.start + np.linspace(0.0, wall.length, _WALL_BARS + 1)
        along = direction(guide.direction)
        outwards = corner.side * across(along)
        edge = 0.5 * guide.width + corner.clearance
        base = np.array([guide.x, guide.y]) + edge * outwards
        for start, end, depth in zip(ends[:-1], ends[1:], depths, strict=True):
            near = base + np.outer([start, end], along)
            far = near[::-1] + factor * depth * outwards
            drawn.append(filled(np.vstack([near, far]), 39, FORCE))
    return drawn


def two_digits(value: float) -> float:
    """Return a positive value rounded down to two digits."""
    unit: float = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / unit) * unit
