"""Plane shapes as triangles for Exudyn's renderer; z only decides which shape covers another."""

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import to_rgba
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()
from exudyn.graphics import FromPointsAndTrigs  # noqa: E402  (after the choice of the module)

Array = NDArray[np.float64]
Point = Sequence[float] | Array
Colour = tuple[float, float, float, float]

SEGMENTS = 48  # of a full circle


class Shape(NamedTuple):
    """Triangles, shape (t, 3), of points, shape (n, 2), m, with one colour and height z, m."""

    points: Array
    triangles: NDArray[np.int64]
    z: float
    colour: Colour


def colour(code: str) -> Colour:
    """Return a colour, red, green, blue, alpha, 0 to 1, from its code ``#rrggbb``."""
    return to_rgba(code)


def mix(first: Colour, second: Colour, share: float) -> Colour:
    """Return ``first`` with a share, 0 to 1, of ``second``."""
    r, g, b, a = ((1.0 - share) * x + share * y for x, y in zip(first, second, strict=True))
    return r, g, b, a


def circle(centre: Point, radius: float, segments: int = SEGMENTS) -> Array:
    """Return points on a circle, shape (segments, 2)."""
    angle = np.linspace(0.0, 2.0 * math.pi, segments, endpoint=False)
    return np.asarray(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def rectangle(size: Point, angle: float) -> Array:
    """Return the corners of a rectangle about the origin, turned by an angle, rad."""
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.asarray(size)
    c, s = math.cos(angle), math.sin(angle)
    return corners @ np.array([[c, s], [-s, c]])


def rounded_hull(points: Array, radius: float) -> Array:
    """Return the outline of the convex hull of discs about points: a disc, a bar, a plate."""
    discs = np.vstack([circle(point, radius) for point in points])
    return discs[ConvexHull(discs).vertices]


def filled(outline: Array, z: float, paint: Colour) -> Shape:
    """Return the inside of an outline, shape (n, 2), that is star-shaped about its mean point."""
    k = np.arange(len(outline))
    triangles = np.column_stack([np.zeros_like(k), 1 + k, 1 + (k + 1) % len(k)])
    return Shape(np.vstack([outline.mean(axis=0), outline]), triangles, z, paint)


def band(inner: Array, outer: Array, z: float, paint: Colour) -> Shape:
    """Return the area between two closed lines, shape (n, 2) each."""
    count = len(inner)
    k = np.arange(count)
    following = (k + 1) % count
    triangles = [[k, count + k, count + following], [k, count + following, following]]
    corners = np.moveaxis(np.array(triangles), 1, 2).reshape(-1, 3)
    return Shape(np.vstack([inner, outer]), corners, z, paint)


def ring(centre: Point, radius: float, width: float, z: float, paint: Colour) -> Shape:
    """Return a circular line of some width."""
    inner, outer = (circle(centre, radius + side * width, 2 * SEGMENTS) for side in (-0.5, 0.5))
    return band(inner, outer, z, paint)


def strokes(points: Array, width: float, z: float, paints: Sequence[Colour]) -> list[Shape]:
    """Return the lines between successive points, shape (n, 2), one colour each."""
    normal = np.diff(points, axis=0)[:, ::-1] * (-1.0, 1.0)
    length = np.hypot(*normal.T)
    normal *= (0.5 * width / np.where(length > 0.0, length, 1.0))[:, None]
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return [
        Shape(np.array([a - n, b - n, b + n, a + n]), triangles, z, paint)
        for a, b, n, paint in zip(points[:-1], points[1:], normal, paints, strict=True)
    ]


def line(start: Point, end: Point, width: float, z: float, paint: Colour) -> Shape:
    """Return a straight line of some width."""
    return strokes(np.array([start, end], dtype=float), width, z, [paint])[0]


def arrow(start: Array, vector: Array, width: float, z: float, paint: Colour) -> list[Shape]:
    """Return an arrow from a point along a vector that is not zero."""
    length = float(np.hypot(*vector))
    head = min(4.0 * width, length)
    direction = vector / length
    wings = 0.45 * head * np.array([-direction[1], direction[0]])
    neck, tip = start + (length - head) * direction, start + vector
    return [
        line(start, neck, width, z, paint),
        filled(np.array([neck - wings, tip, neck + wings]), z, paint),
    ]


def graphics(shapes: Iterable[Shape]) -> dict[str, Any]:
    """Return shapes as one triangle list of Exudyn."""
    each = list(shapes)
    counts = [len(shape.points) for shape in each]
    starts = np.cumsum([0, *counts[:-1]])
    points = np.vstack([np.insert(shape.points, 2, shape.z, axis=1) for shape in each])
    triangles = [shape.triangles + start for shape, start in zip(each, starts, strict=True)]
    colours = np.repeat([shape.colour for shape in each], counts, axis=0)
    normals = np.tile([0.0, 0.0, 1.0], len(points))
    data: dict[str, Any] = FromPointsAndTrigs(points, np.vstack(triangles), colours, normals)
    return data


def text(point: Point, words: str, z: float, size: float, paint: Colour) -> dict[str, Any]:
    """Return a text that starts at a point, with letters of a size in pixels."""
    position = [float(point[0]), float(point[1]), z]
    look = {"position": position, "color": list(paint), "fontSize": size}
    return {"type": "Text", "text": words, **look}
