"""Plane shapes: outlines of bodies, and triangles in layers, the higher ones in front."""

import math
from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage
from presswear.tools.arrays import Array

Point = Sequence[float] | Array
Colour = tuple[float, ...]  # red, green, blue, alpha, 0 to 1

SEGMENTS = 48  # of a full circle


class Shape(NamedTuple):
    """Triangles, shape (t, 3), of points, shape (n, 2), m, with one colour in a layer."""

    points: Array
    triangles: NDArray[np.int64]
    layer: int
    colour: Colour


def moved(shape: Shape, pose: Array) -> Shape:
    """Return a shape of a body in a pose: coordinates of its origin, m, and angle, rad."""
    along = direction(pose[2])
    return shape._replace(points=pose[:2] + shape.points @ np.array([along, across(along)]))


def mix(first: Colour, second: Colour, share: float) -> Colour:
    """Return ``first`` with a share, 0 to 1, of ``second``."""
    return tuple((1.0 - share) * x + share * y for x, y in zip(first, second, strict=True))


def direction(angle: float) -> Array:
    """Return the unit vector at an angle, rad."""
    return np.array([math.cos(angle), math.sin(angle)])


def points_of(linkage: Linkage, positions: Array, point: Attachment) -> Array:
    """Return the coordinates, m, of a point and the angle of its body, rad; shape (n, 3)."""
    if point.body == GROUND:
        return np.tile([point.x, point.y, 0.0], (len(positions), 1))
    base = 3 * linkage.index(point.body)
    x, y, angle = positions[:, base : base + 3].T
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([x + c * point.x - s * point.y, y + s * point.x + c * point.y, angle])


def attachments(linkage: Linkage, body: str) -> list[tuple[str, Attachment]]:
    """Return joint names and points at which a body, or the ground, is connected."""
    pairs = chain(
        ((joint.name, joint.first, joint.second) for joint in linkage.revolutes),
        ((joint.name, joint.bearing, joint.pin) for joint in linkage.clearances),
        ((spring.name, *spring.ends) for spring in linkage.springs),
    )
    return [(name, end) for name, *ends in pairs for end in ends if end.body == body]


def body_outline(linkage: Linkage, body: str, bar: float, inset: float = 0.0) -> Array:
    """Return the outline of a body in its own frame, m, shape (n, 2).

    It is a block in a guide, otherwise a bar or a plate around the joints, or around one joint and
    the mass centre. ``bar`` is the half width of a bar.
    """
    guide = next((guide for guide in linkage.guides if guide.body == body), None)
    if guide is not None:
        half = 0.5 * np.array([5.6 * bar, 4.4 * bar]) - inset
        along = direction(guide.direction - guide.angle)
        return np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half @ [along, across(along)]
    points = [(end.x, end.y) for _, end in attachments(linkage, body)]
    points += [(0.0, 0.0)] * (len(points) < 2)
    discs = np.vstack([circle(point, bar - inset) for point in points])
    return discs[ConvexHull(discs).vertices]


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
    k, count = np.arange(len(inner)), len(inner)
    following = (k + 1) % count
    quarters = [(k, count + k, count + following), (k, count + following, following)]
    return Shape(np.vstack([inner, outer]), np.hstack(quarters).T, layer, paint)


def ring(centre: Point, radius: float, width: float, layer: int, paint: Colour) -> Shape:
    """Return a circular line of some width."""
    inner, outer = (circle(centre, radius + side * width, 2 * SEGMENTS) for side in (-0.5, 0.5))
    return band(inner, outer, layer, paint)


def strokes(points: Array, width: float, layer: int, paints: Sequence[Colour]) -> list[Shape]:
    """Return the lines between successive points, shape (n, 2), one colour each."""
    normal = np.diff(points, axis=0)[:, ::-1] * (-1.0, 1.0)
    length = np.hypot(*normal.T)
    normal *= (0.5 * width / np.where(length > 0.0, length, 1.0))[:, None]
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return [
        Shape(np.array([a - n, b - n, b + n, a + n]), triangles, layer, paint)
        for a, b, n, paint in zip(points[:-1], points[1:], normal, paints, strict=True)
    ]


def line(start: Point, end: Point, width: float, layer: int, paint: Colour) -> Shape:
    """Return a straight line of some width."""
    return strokes(np.array([start, end], dtype=float), width, layer, [paint])[0]


def arrow(start: Array, vector: Array, width: float, layer: int, paint: Colour) -> list[Shape]:
    """Return an arrow from a point along a vector that is not zero."""
    length = float(np.hypot(*vector))
    head = min(4.0 * width, length)
    neck, tip = start + (1.0 - head / length) * vector, start + vector
    wings = 0.45 * head / length * across(vector)
    outline = np.array([neck - wings, tip, neck + wings])
    return [line(start, neck, width, layer, paint), filled(outline, layer, paint)]


def hatched(ends: Array, side: float, bar: float, layer: int, paint: Colour) -> list[Shape]:
    """Return a fixed edge, hatched on the left for side = 1 and on the right for -1."""
    start, end = ends
    vector = end - start
    length = float(np.hypot(*vector))
    along = vector / length
    slant = 0.9 * bar * (side * across(along) - along)
    marks = np.linspace(0.0, 1.0, max(int(length / (0.9 * bar)), 2))
    feet = start + np.outer(marks, vector)
    lines = [line(foot, foot + slant, 0.132 * bar, layer, paint) for foot in feet]
    return [line(start, end, 0.22 * bar, layer, paint), *lines]
