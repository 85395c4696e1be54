"""Plane shapes as triangles for Exudyn's renderer; z only decides which shape covers another."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()
from exudyn.graphics import FromPointsAndTrigs  # noqa: E402  (after the choice of the module)

Array = NDArray[np.float64]
Point = Sequence[float] | Array
Colour = tuple[float, float, float, float]

SEGMENTS = 48  # of a full circle


def colour(code: str) -> Colour:
    """Return a colour from its hexadecimal code, ``#rrggbb``."""
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue, 1.0


def mix(first: Colour, second: Colour, share: float) -> Colour:
    """Return ``first`` with a share, 0 to 1, of ``second``."""
    r, g, b, a = ((1.0 - share) * x + share * y for x, y in zip(first, second, strict=True))
    return r, g, b, a


@dataclass(frozen=True)
class Shape:
    """Triangles of one colour in a plane of height z.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        m.
    triangles : ndarray of int, shape (t, 3)
    z : float
        m.
    colour : tuple
        Red, green, blue, alpha, 0 to 1.
    """

    points: Array
    triangles: NDArray[np.int64]
    z: float
    colour: Colour


def circle(centre: Point, radius: float, segments: int = SEGMENTS) -> Array:
    """Return points on a circle, shape (segments, 2)."""
    angle = np.linspace(0.0, 2.0 * math.pi, segments, endpoint=False)
    return np.column_stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)])


def filled(outline: Array, z: float, paint: Colour) -> Shape:
    """Return the inside of an outline, shape (n, 2), that is star-shaped about its mean point."""
    k = np.arange(len(outline))
    triangles = np.column_stack([np.zeros_like(k), 1 + k, 1 + (k + 1) % len(k)])
    return Shape(np.vstack([outline.mean(axis=0), outline]), triangles, z, paint)


def rounded_hull(points: Array, radius: float) -> Array:
    """Return the outline of the convex hull of discs about points: a disc, a bar, a plate."""
    discs = np.vstack([circle(point, radius) for point in points])
    return discs[ConvexHull(discs).vertices]


def band(inner: Array, outer: Array, z: float, paint: Colour) -> Shape:
    """Return the area between two closed lines, shape (n, 2) each."""
    count = len(inner)
    k = np.arange(count)
    following = (k + 1) % count
    triangles = np.vstack(
        [
            np.column_stack([k, count + k, count + following]),
            np.column_stack([k, count + following, following]),
        ]
    )
    return Shape(np.vstack([inner, outer]), triangles, z, paint)


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
    """Return an arrow from a point along a vector; nothing for a zero vector."""
    length = float(np.hypot(*vector))
    if length == 0.0:
        return []
    head = min(4.0 * width, length)
    direction = vector / length
    normal = np.array([-direction[1], direction[0]])
    neck, tip = start + (length - head) * direction, start + vector
    wings = 0.45 * head * normal
    return [
        line(start, neck, width, z, paint),
        filled(np.array([neck - wings, tip, neck + wings]), z, paint),
    ]


def rectangle(size: Point, angle: float) -> Array:
    """Return the corners of a rectangle about the origin, turned by an angle, rad."""
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.asarray(size)
    c, s = math.cos(angle), math.sin(angle)
    return corners @ np.array([[c, s], [-s, c]])


def graphics(shapes: Iterable[Shape]) -> dict[str, Any]:
    """Return shapes as one triangle list of Exudyn."""
    each = list(shapes)
    counts = [len(shape.points) for shape in each]
    starts = np.cumsum([0, *counts[:-1]])
    points = np.vstack([np.insert(shape.points, 2, shape.z, axis=1) for shape in each])
    data: dict[str, Any] = FromPointsAndTrigs(
        points,
        np.vstack([shape.triangles + start for shape, start in zip(each, starts, strict=True)]),
        np.repeat([shape.colour for shape in each], counts, axis=0),
        np.tile([0.0, 0.0, 1.0], len(points)),
    )
    return data


def text(point: Point, words: str, z: float, size: float, paint: Colour) -> dict[str, Any]:
    """Return a text that starts at a point, with letters of a size in pixels."""
    return {
        "type": "Text",
        "text": words,
        "position": [float(point[0]), float(point[1]), z],
        "color": list(paint),
        "fontSize": size,
    }
