"""Worn surfaces: a smooth periodic profile that stays between its neighbours."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal

from presswear.linkage.surface import Surface, bin_centres, monotone_slopes
from presswear.physics.worn_map import BEARING, bin_of, pack_rows, parts_of
from presswear.physics.worn_map import profile as packed_profile

TURN = 2.0 * math.pi
ROUND_OFF = 8 * np.finfo(float).eps

# Depths of a worn press span decades; zeros make flats and steps.
depth_values = st.just(0.0) | st.floats(1e-12, 1e-2)
depths = st.integers(1, 40).flatmap(
    lambda m: arrays(np.float64, m, elements=depth_values)
)


def profile(surface: Surface, angle: float) -> tuple[float, float, float]:
    """Depth, slope and second derivative as the kernels have them."""
    bins = surface.depth.size
    nodes = bins * parts_of(bins) if bins else 0
    return packed_profile(
        pack_rows(surface, Surface(), max(bins, 1)), BEARING, nodes, angle
    )


@given(depths)
def test_passes_through_the_bin_centres(depth):
    surface = Surface(depth)
    count = depth.size
    centres = bin_centres(count)
    # A centre is a rounded angle: its position within the bin is off by an ulp of the
    # turn.
    tolerance = depth.max() * count * ROUND_OFF
    assert_allclose(surface(centres), depth, rtol=0.0, atol=tolerance)
    slopes = [profile(surface, float(angle))[1] for angle in centres]
    tolerance *= 12.0 * count / TURN
    assert_allclose(slopes, surface.slope, rtol=0.0, atol=tolerance)


@given(depths, st.floats(-50.0, 50.0))
def test_stays_between_its_neighbours(depth, angle):
    value = profile(Surface(depth), angle)[0]
    position = angle * depth.size / TURN - 0.5
    left = math.floor(position)
    # On a knot, rounding may place the angle in either interval.
    is_inside = min(position - left, left + 1 - position) > 1e-9
    near = [
        depth[(left + k) % depth.size] for k in ((0, 1) if is_inside else (-1, 0, 1, 2))
    ]
    rounding = ROUND_OFF * max(near)
    assert min(near) - rounding <= value <= max(near) + rounding


def test_slope_and_curvature_are_derivatives_inside_an_interval():
    surface = Surface(np.array([0.0, 1e-6, 3e-6, 2e-6, 2e-6, 5e-6, 1e-6, 0.5e-6]))
    for angle in map(float, [*(bin_centres(8) + 0.3), *(bin_centres(8) - 0.1)]):

        def quotient(level: int, step: float, angle: float = angle) -> float:
            ends = (profile(surface, angle + d)[level] for d in (step, -step))
            return (next(ends) - next(ends)) / (2.0 * step)

        # Third derivative below 12 * 5e-6 / (TURN / 8)^3 = 1.3e-4: error below 2e-13.
        slope = profile(surface, angle)[1]
        assert slope == pytest.approx(quotient(0, 1e-4), abs=1e-12)
        # The slope is a parabola there: a central difference has no truncation error.
        curved = profile(surface, angle)[2]
        assert curved == pytest.approx(quotient(1, 1e-3), abs=1e-14)
    assert profile(Surface(), 1.0) == (0.0, 0.0, 0.0)


def test_halfway_up_a_step_and_at_an_extremum_by_hand():
    # Secants 1 and 2 per bin: harmonic mean 4/3.
    slopes = monotone_slopes(np.array([0.0, 1.0, 3.0, 3.0, 0.0, 0.0])) * TURN / 6.0
    assert_allclose(slopes, [0.0, 4.0 / 3.0, 0.0, 0.0, 0.0, 0.0], rtol=1e-14)
    # Halfway up a symmetric step between flats: half the height, slope 3/2 per bin.
    surface = Surface(np.array([0.0, 0.0, 2.0, 2.0]))
    value, slope, _ = profile(surface, math.pi)
    assert value == pytest.approx(1.0, rel=1e-14)
    assert slope == pytest.approx(1.5 * 2.0 / (0.5 * math.pi), rel=1e-14)


@given(
    st.integers(1, 100_000),
    st.floats(0.0, 1.0, exclude_max=True),
    st.floats(0.001, 0.999),
    st.integers(-1000, 1000),
)
def test_a_bin_covers_its_part_of_a_turn(count, place, part, turns):
    index = int(place * count)
    # An angle of a thousand turns is rounded to 1e-12, a bin may be 6e-5 wide.
    assert bin_of((index + part) * TURN / count + turns * TURN, count) == index


def test_surfaces_are_read_only_copies():
    """A linkage is data; comparing two must not fail on the arrays inside."""
    depth = np.array([1e-6, 0.0, 2e-6])
    surface = Surface(depth)
    assert surface == Surface(depth) != Surface()
    depth[:] = 5.0
    assert_array_equal(surface.depth, [1e-6, 0.0, 2e-6])
    for stored in (surface.depth, surface.slope):
        with pytest.raises(ValueError, match="read-only"):
            stored[0] = 1.0


@pytest.mark.parametrize(
    "bad",
    [
        np.zeros((2, 3)),
        np.array(1.0),
        np.array([0.0, math.nan]),
        np.array([math.inf, 0.0]),
    ],
)
def test_refuses_what_is_no_profile(bad):
    with pytest.raises(ValueError, match="one-dimensional array of numbers"):
        Surface(bad)
