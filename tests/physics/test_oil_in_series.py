"""A film without mass in series with an elastic contact: steady states, squeeze, losses.

The numbers are those of an independent program (DOP853).
"""

import cmath
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from presswear.physics.interactions.oil import OiledBearing, film_loss, film_rate
from presswear.physics.mixed_lubrication import DECAY
from presswear.physics.oil_film import film_force, film_of

CLEARANCE = 5e-5
FILM = film_of(width=0.08, bearing_radius=0.045, clearance=CLEARANCE, viscosity=0.1)
SMOOTH = OiledBearing(FILM, CLEARANCE, 0.0, 1e-6)


def film_under(
    load: Callable[[float], complex],
    speeds: float,
    duration: float,
    bearing: OiledBearing | None = None,
) -> tuple[complex, float]:
    """Return eccentricity over clearance at the end, and the time of eccentricity 0.5."""

    def rate(time: float, place: tuple[float, float]) -> tuple[float, float]:
        force = -load(time)
        parts = force.real, force.imag
        known = bearing or SMOOTH
        vx, vy, _ = film_rate((place[0], place[1]), parts, speeds, 0.0, known)
        return vx, vy

    def half(_: float, place: tuple[float, float]) -> float:
        return math.hypot(*place) - 0.5 * CLEARANCE

    run = solve_ivp(
        rate, (0.0, duration), (0.0, 0.0), "LSODA", rtol=1e-10, atol=1e-16, events=half
    )
    times = run.t_events[0]
    return complex(*run.y[:, -1]) / CLEARANCE, times[0] if times.size else math.inf


def test_steady_rotation_and_squeeze() -> None:
    place, _ = film_under(lambda _: -2440.0j, 6.28, 20.0)
    assert abs(place) == pytest.approx(0.4917858209, abs=1e-9)
    ahead = math.degrees(cmath.phase(place / -1.0j))
    assert ahead == pytest.approx(58.0543735, abs=1e-6)
    _, time = film_under(lambda _: 20e3, 0.0, 0.1)
    assert time == pytest.approx(67.849038761e-3, rel=1e-9)


def test_load_that_turns_with_the_bearing() -> None:
    duration = 20.0
    place, _ = film_under(lambda t: cmath.rect(5e3, 6.28 * t), 6.28, duration)
    assert abs(place) == pytest.approx(0.6578239676, abs=1e-8)
    behind = math.degrees(cmath.phase(cmath.rect(1.0, 6.28 * duration) / place))
    assert behind == pytest.approx(45.775299, abs=1e-5)


def test_gap_of_a_long_dwell_falls_and_stays_open() -> None:
    """The load stands still and nothing turns; asperities bear it in the end."""
    rough = SMOOTH._replace(asperity_size=50e6 * 0.08 * 0.045, roughness=0.42e-6)
    smooth, _ = film_under(lambda _: 20e3, 0.0, 50.0)
    held, _ = film_under(lambda _: 20e3, 0.0, 5e3, rough)
    reach = DECAY * rough.roughness
    share = math.sqrt(2.0 * math.pi * reach / CLEARANCE)
    gap = reach / CLEARANCE * math.log(rough.asperity_size * share / 20e3)
    assert 0.0 < 1.0 - abs(smooth) < 0.5 * gap
    assert 1.0 - abs(held) == pytest.approx(gap, rel=1e-3)


@given(
    st.floats(0.01, 0.99),
    st.floats(-math.pi, math.pi),
    st.floats(0.0, 1e5),
    st.floats(-100.0, 100.0),
)
def test_rate_inverts_the_force_of_the_film(
    eccentricity: float, angle: float, size: float, speeds: float
) -> None:
    place = CLEARANCE * eccentricity
    force = cmath.rect(size, angle)
    vx, vy, _ = film_rate((place, 0.0), (force.real, force.imag), speeds, 0.0, SMOOTH)
    wedge_speed = speeds - 2.0 * vy / place
    parts = film_force(1.0 - eccentricity, vx / CLEARANCE, wedge_speed, FILM)
    # Digits that cancel where the pin turns with half the speeds are lost.
    lost = 1e-9 * FILM.size * abs(speeds)
    assert np.hypot(*np.subtract(parts, (force.real, force.imag))) <= 1e-9 * size + lost
    assert film_loss((place, 0.0), (vx, vy), (force.real, force.imag), speeds) >= (
        -1e-9 * (size * CLEARANCE * (abs(speeds) + np.hypot(vx, vy) / CLEARANCE))
    )
