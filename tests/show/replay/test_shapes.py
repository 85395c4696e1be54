"""Shapes: areas in closed form, hulls that hold their points."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.show.replay.shapes import (
    Shape,
    around,
    arrow,
    band,
    box,
    circle,
    colour,
    filled,
    graphics,
    mixed,
    ring,
    strokes,
)

INK = colour("#336699")
COORDINATE = st.floats(-1.0, 1.0).map(lambda x: round(x, 3))


def area(shape: Shape) -> float:
    """Sum of the areas of all triangles, those wound clockwise counted as negative."""
    a, b, c = (shape.points[shape.triangles[:, i], :2] for i in range(3))
    cross = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    return float(0.5 * cross.sum())


def rounded(points: NDArray[np.float64], radius: float) -> Shape:
    return filled(around(points, radius), 0.0, INK)


def test_areas_are_those_of_the_closed_forms() -> None:
    r, length = 0.2, 0.7
    disc = math.pi * r**2
    assert area(rounded(np.zeros((1, 2)), r)) == pytest.approx(disc, rel=5e-3)
    bar = rounded(np.array([[0.0, 0.0], [length, 0.0]]), r)
    assert area(bar) == pytest.approx(disc + 2.0 * r * length, rel=5e-3)
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    plate = rounded(corners, r)
    assert area(plate) == pytest.approx(0.5 + r * (2.0 + math.sqrt(2.0)) + disc, rel=5e-3)
    between = band(circle((0, 0), 0.5, 400), circle((0, 0), 0.8, 400), 0.0, INK)
    assert area(between) == pytest.approx(math.pi * (0.64 - 0.25), rel=1e-3)
    assert area(ring((1.0, 2.0), 0.5, 0.02, 0.0, INK)) == pytest.approx(math.pi * 0.02, rel=5e-3)
    assert area(filled(box((3.0, 1.0), (0.3, 0.2), 0.7), 0.0, INK)) == pytest.approx(0.06)


@given(st.lists(st.tuples(COORDINATE, COORDINATE), min_size=1, max_size=30))
def test_an_outline_is_convex_and_as_far_from_its_points_as_asked(
    points: list[tuple[float, float]],
) -> None:
    radius = 0.3
    outline = around(np.array(points), radius)
    edges = np.roll(outline, -1, axis=0) - outline
    # Edges cut a little off the discs.
    least = radius * math.cos(math.pi / 48) * np.hypot(*edges.T)
    for point in points:
        away = np.array(point) - outline
        assert (edges[:, 0] * away[:, 1] - edges[:, 1] * away[:, 0] - least).min() >= -1e-12
    apart = np.hypot(*(outline[:, None] - np.array(points)).T)
    assert apart.min(axis=0) == pytest.approx(radius)


def test_lines_have_their_width_and_an_arrow_its_tip() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]])
    pieces = strokes(points, 0.01, 0.0, [INK, INK])
    assert [abs(area(piece)) for piece in pieces] == pytest.approx([0.01, 0.02])
    start, along = np.array([1.0, 1.0]), np.array([0.3, 0.4])
    tip = np.vstack([shape.points for shape in arrow(start, along, 0.01, 0.0, INK)])
    assert ((tip[:, :2] - start) @ along / 0.25).max() == pytest.approx(1.0)
    assert arrow(start, np.zeros(2), 0.01, 0.0, INK) == []
    # Points that coincide make no line, and no division by zero.
    assert np.isfinite(strokes(np.zeros((2, 2)), 0.01, 0.0, [INK])[0].points).all()


def corners(data: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    return data["points"].reshape(-1, 3)[data["triangles"].reshape(-1, 3)]


def test_graphics_keep_every_shape_with_its_colour() -> None:
    red, blue = colour("#ff0000"), colour("#0000ff")
    shapes = [
        filled(circle((0.0, 0.0), 0.1), 0.5, red),
        filled(box((3.0, 0.0), (1.0, 1.0), 0.0), 0.7, blue),
    ]
    data = graphics(shapes)
    drawn = corners(data)
    apart = np.vstack([shape.points[shape.triangles] for shape in shapes])
    assert np.array_equal(drawn[..., :2], apart)
    colours = data["colors"].reshape(-1, 4)[data["triangles"].reshape(-1, 3)]
    assert np.array_equal(colours[drawn[..., 2] == 0.5], np.tile(red, (3 * len(drawn) - 12, 1)))
    assert np.array_equal(colours[drawn[..., 2] == 0.7], np.tile(blue, (12, 1)))


def test_colours_mix() -> None:
    assert colour("#ff8000") == (1.0, 128 / 255, 0.0, 1.0)
    assert mixed((0.0, 0.0, 0.0, 1.0), (1.0, 0.5, 0.0, 1.0), 0.5) == (0.5, 0.25, 0.0, 1.0)
