"""Orbits of a pin on its film: steady states, squeeze, and loads without a wedge.

The numbers of the first tests are those of an independent program (DOP853).
"""

import cmath
import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from presswear.physics.oil_film import film_of
from presswear.results.film_orbit import (
    FilmLoad,
    FilmOrbit,
    periodic_orbit,
    stretched_rate,
)
from presswear.tools.arrays import Array

BUSH = film_of(width=0.08, bearing_radius=0.045, clearance=5e-5, viscosity=0.1)


def orbit_from_the_centre(
    load: Callable[[float], complex],
    speeds: float,
    duration: float,
    events: Callable[[float, Array], float] | None = None,
) -> tuple[float, complex]:
    """Return the time and the eccentricity over the clearance at the end, or at an event."""

    def rate(time: float, state: Array) -> tuple[float, float]:
        film = -load(time)
        return stretched_rate(state, (film.real, film.imag), speeds, BUSH)

    solution = solve_ivp(
        rate,
        (0.0, duration),
        np.zeros(2),
        "DOP853",
        events=events,
        rtol=1e-11,
        atol=1e-13,
    )
    state = complex(*solution.y[:, -1])
    return float(solution.t[-1]), -math.expm1(-abs(state)) * state / abs(state)


def test_steady_rotation_under_a_constant_load():
    _, place = orbit_from_the_centre(lambda time: -2440.0j, 6.28, 20.0)
    assert abs(place) == pytest.approx(0.4917858209, abs=1e-10)
    ahead = math.degrees(cmath.phase(place / -1.0j))
    assert ahead == pytest.approx(58.0543735, abs=1e-7)


def test_a_load_that_turns_with_the_bearing_has_the_wedge_behind_it():
    speed = 6.28
    end, place = orbit_from_the_centre(
        lambda time: 5000.0 * cmath.exp(1j * speed * time), speed, 20.0
    )
    assert abs(place) == pytest.approx(0.6578239676, abs=1e-9)
    behind = -math.degrees(cmath.phase(place * cmath.exp(-1j * speed * end)))
    assert behind == pytest.approx(45.775299, abs=1e-6)


@pytest.mark.parametrize(
    ("eccentricity", "time"), [(0.5, 67.849038761e-3), (0.9, 560.63531771e-3)]
)
def test_squeeze_without_rotation(eccentricity, time):
    def reached(_: float, state: Array) -> float:
        return math.hypot(*state) + math.log(1.0 - eccentricity)

    setattr(reached, "terminal", True)  # noqa: B010
    end, _ = orbit_from_the_centre(lambda _: 20e3, 0.0, 1.0, reached)
    assert end == pytest.approx(time, rel=1e-10)


def repeated(force: Array, speed_sum: float = 0.0) -> FilmOrbit:
    """Return the orbit under a force on the pin in a cycle of 1 s."""
    time = np.linspace(0.0, 1.0, force.size)
    load = FilmLoad(time, -force, np.full(force.size, speed_sum))
    return periodic_orbit(load, BUSH)


def test_a_load_at_half_the_speed_has_no_wedge():
    """The film falls from cycle to cycle as under a load that rests, and never closes."""
    turns = np.exp(2j * math.pi * np.linspace(0.0, 1.0, 721))
    turning = repeated(2000.0 * turns, 4.0 * math.pi)
    resting = repeated(np.full(721, 2000.0 + 0.0j))
    assert not turning.is_closed
    assert turning.gap == pytest.approx(resting.gap, rel=2e-3)
    assert np.isfinite(turning.place).all()
    full_speed = repeated(2000.0 * turns, 2.0 * math.pi)
    assert full_speed.is_closed
    assert full_speed.gap.min() > 50.0 * turning.gap.min()


def test_a_load_through_zero_squeezes_from_both_sides():
    phase = 2.0 * math.pi * np.linspace(0.0, 1.0, 721)
    orbit = repeated(np.asarray(20e3 * np.cos(phase) + 0.0j))
    assert orbit.is_closed
    assert orbit.place.real.max() == pytest.approx(-orbit.place.real.min(), rel=0.02)
    assert np.abs(orbit.place.imag).max() < 1e-6


def test_without_a_load_the_pin_stays_in_the_centre():
    orbit = repeated(np.zeros(10), 5.0)
    assert orbit.is_closed
    assert orbit.gap == pytest.approx(np.ones(10))


def test_a_film_under_a_long_dwell_has_no_end_at_zero():
    orbit = repeated(np.full(50, 1e9 + 0.0j))
    assert np.isfinite(orbit.place).all()
    assert 0.0 < orbit.gap.min() < 2e-5
