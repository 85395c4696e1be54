"""Flat shapes as triangles, for Exudyn's renderer.

Everything lies in planes parallel to x, y; ``z`` only says what covers what.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = Sequence[float] | Array
Colour = tuple[float, float, float, float]

_ARC = 48
"""Pieces of a full circle."""


def colour(code: str) -> Colour:
    """A colour from its hexadecimal code, ``#rrggbb``."""
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue, 1.0


def mixed(one: Colour, other: Colour, part: float) -> Colour:
    """``one`` with a part 0 .. 1 of ``other``."""
    r, g, b, a = ((1.0 - part) * x + part * y for x, y in zip(one, other, strict=True))
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
        Red, green, blue, alpha, 0 .. 1.
    """

    points: Array
    triangles: NDArray[np.int64]
    z: float
    colour: Colour


def circle(centre: Point, radius: float, pieces: int = _ARC) -> Array:
    """Points on a circle, shape (pieces, 2)."""
    angle = np.linspace(0.0, 2.0 * math.pi, pieces, endpoint=False)
    return np.column_stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)])


def filled(outline: Array, z: float, paint: Colour) -> Shape:
    """The inside of an outline that its mean point sees whole, shape (n, 2)."""
    count = len(outline)
    points = np.vstack([outline.mean(axis=0), outline])
    own = np.arange(count)
    triangles = np.column_stack([np.zeros(count, int), 1 + own, 1 + (own + 1) % count])
    return Shape(points, triangles, z, paint)


def hull(points: Array) -> Array:
    """Convex hull, counter-clockwise (Andrew's monotone chain)."""
    order = sorted({(float(x), float(y)) for x, y in points})
    if len(order) < 3:
        return np.array(order)

    def chain(ordered: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
        kept: list[tuple[float, float]] = []
        for x, y in ordered:
            while len(kept) > 1:
                (ax, ay), (bx, by) = kept[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                kept.pop()
            kept.append((x, y))
        return kept[:-1]

    return np.array(chain(order) + chain(reversed(order)))


def around(points: Array, radius: float) -> Array:
    """Outline of all within a radius of the convex hull of points: a disc, a bar, a plate."""
    return hull(np.vstack([circle(point, radius) for point in points]))


def band(inner: Array, outer: Array, z: float, paint: Colour) -> Shape:
    """Area between two closed lines of equally many points, shape (n, 2) each."""
    count = len(inner)
    own = np.arange(count)
    following = (own + 1) % count
    triangles = np.vstack(
        [
            np.column_stack([own, count + own, count + following]),
            np.column_stack([own, count + following, following]),
        ]
    )
    return Shape(np.vstack([inner, outer]), triangles, z, paint)


def ring(centre: Point, radius: float, width: float, z: float, paint: Colour) -> Shape:
    """A circular line of some width."""
    inner, outer = (circle(centre, radius + half * width, 2 * _ARC) for half in (-0.5, 0.5))
    return band(inner, outer, z, paint)


def strokes(points: Array, width: float, z: float, paints: Sequence[Colour]) -> list[Shape]:
    """The lines between neighbouring points, shape (n, 2), one colour each."""
    across = np.diff(points, axis=0)[:, ::-1] * (-1.0, 1.0)
    length = np.hypot(*across.T)
    across *= (0.5 * width / np.where(length > 0.0, length, 1.0))[:, None]
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return [
        Shape(np.array([a - n, b - n, b + n, a + n]), triangles, z, paint)
        for a, b, n, paint in zip(points[:-1], points[1:], across, paints, strict=True)
    ]


def line(start: Point, end: Point, width: float, z: float, p: Colour) -> Shape:
    """A straight line of some width."""
    return strokes(np.array([start, end], dtype=float), width, z, [p])[0]


def arrow(start: Array, along: Array, width: float, z: float, paint: Colour) -> list[Shape]:
    """An arrow from a point, shape (2,), along a vector; nothing where that has no length."""
    length = float(np.hypot(*along))
    if length == 0.0:
        return []
    head = min(4.0 * width, length)
    ahead = along / length
    side = np.array([-ahead[1], ahead[0]])
    neck, tip = start + (length - head) * ahead, start + along
    wings = 0.45 * head * side
    return [
        line(start, neck, width, z, paint),
        filled(np.array([neck - wings, tip, neck + wings]), z, paint),
    ]


def box(centre: Point, size: Point, angle: float) -> Array:
    """Corners of a rectangle that is turned by an angle, rad; shape (4, 2)."""
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.asarray(size)
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(centre) + corners @ np.array([[c, s], [-s, c]])


def graphics(shapes: Iterable[Shape]) -> dict[str, Any]:
    """Shapes as one piece of Exudyn's graphics data."""
    given = list(shapes)
    counts = [len(shape.points) for shape in given]
    starts = np.cumsum([0, *counts[:-1]])
    triangles = [shape.triangles + start for shape, start in zip(given, starts, strict=True)]
    points = np.vstack([np.insert(shape.points, 2, shape.z, axis=1) for shape in given])
    paints = np.repeat([shape.colour for shape in given], counts, axis=0)
    return {
        "type": "TriangleList",
        "points": points.ravel(),
        "colors": paints.ravel(),
        "normals": np.tile([0.0, 0.0, 1.0], len(points)),
        "triangles": np.vstack(triangles).ravel(),
    }


def text(place: Point, words: str, z: float, size: float, paint: Colour) -> dict[str, Any]:
    """Words that begin at a place, of a size in pixels."""
    return {
        "type": "Text",
        "text": words,
        "position": [float(place[0]), float(place[1]), z],
        "color": list(paint),
        "fontSize": size,
    }
