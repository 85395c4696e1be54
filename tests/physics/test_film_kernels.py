"""Oil film of a plain bearing: published tables, and velocity as the inverse of force."""

import math

import numpy as np
import pytest

from presswear.physics.oil_film import (
    film_force,
    film_of,
    film_velocity,
    rotation_slope,
    squeeze_number,
)

# Sommerfeld numbers of DIN 31652 for finite width and a film over 180 degrees, by width
# over diameter and relative eccentricity
TABLE = {
    1.0: {0.5: 0.8903, 0.9: 8.4352, 0.99: 107.79},
    0.5: {0.5: 0.3124, 0.9: 5.0881, 0.99: 93.79},
    0.25: {0.5: 0.0888, 0.9: 2.1595, 0.99: 70.04},
}
BUSH = film_of(width=0.08, bearing_radius=0.045, clearance=5e-5, viscosity=0.1)


@pytest.mark.parametrize("ratio", TABLE)
def test_sommerfeld_numbers_are_those_of_tables(ratio):
    for eccentricity, number in TABLE[ratio].items():
        computed = eccentricity * rotation_slope(1.0 - eccentricity, ratio)
        assert computed == pytest.approx(number, rel=0.07)


def test_film_and_parallel_dampers_add_up_to_the_force():
    random = np.random.default_rng(6)
    for _ in range(100):
        gap = 10.0 ** random.uniform(-6.0, 0.0)
        force = random.normal(size=2)
        along, across = BUSH.size * 10.0 ** random.uniform(-3.0, 6.0, 2)
        damping = along, across
        rate, half_wedge = film_velocity(gap, force[0], force[1], BUSH, damping)
        film = film_force(gap, rate, 2.0 * half_wedge / (1.0 - gap), BUSH)
        dampers = np.array([-along * rate, across * half_wedge])
        assert film + dampers == pytest.approx(force, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("eccentricity", [0.1, 0.5, 0.85, 0.95])
def test_squeeze_numbers_are_those_of_the_printed_formula(eccentricity):
    """Compare with Butenschoen's formula as printed, from which the kernel differs in form."""
    b = BUSH.width_ratio
    a8 = 0.70038 + 3.2415 * b - 12.2486 * b**2 + 18.895 * b**3 - 9.3561 * b**4
    a9 = -0.999935 + 0.0157434 * b - 0.74224 * b**2 + 0.42278 * b**3 - 0.368928 * b**4
    for is_closing in (True, False):
        x = eccentricity if is_closing else -eccentricity
        printed = (0.5 * math.pi - 0.5 * math.acos(x)) * (1.0 + 2.0 * x * x)
        printed += 1.5 * x * math.sqrt(1.0 - x * x)
        printed *= 4.0 * b * b * (1.0 - x * x) ** -2.5 * a8 * (1.0 - x) / (-a9 - x)
        number = squeeze_number(1.0 - eccentricity, is_closing, b)
        assert number == pytest.approx(printed, rel=1e-11)


def test_an_opening_film_resists_little_however_thin_it_is():
    """Near x = -1 the pressure term of the squeeze number goes as 2/15 (1 - x^2)^2.5.

    The number divides this term by (1 - x^2)^2.5, so that its limit is finite.
    """
    limit = squeeze_number(1e-12, False, 0.5) / squeeze_number(1e-9, False, 0.5)
    assert limit == pytest.approx(1.0, abs=1e-8)
    assert squeeze_number(1e-9, True, 0.5) > 1e12 * squeeze_number(1e-9, False, 0.5)
