"""A film without mass in series with an elastic contact: steady states, squeeze, losses.

The numbers are those of an independent program (DOP853).
"""

import cmath
import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from presswear.linkage.normal_law import damping_ratio
from presswear.physics.interactions.oil import (
    OiledBearing,
    contact_damping,
    film_velocity_of,
)
from presswear.physics.mixed_lubrication import DECAY
from presswear.physics.oil_film import film_force, film_of

CLEARANCE = 5e-5
FILM = film_of(width=0.08, bearing_radius=0.045, clearance=CLEARANCE, viscosity=0.1)
SMOOTH = OiledBearing(FILM, CLEARANCE, 0.0, 1e-6)
UNDAMPED = 0.0, 0.0, 0.0  # chord, damping, relaxation time


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
        vx, vy, _ = film_velocity_of((place[0], place[1]), parts, UNDAMPED, known)
        return vx - 0.5 * speeds * place[1], vy + 0.5 * speeds * place[0]

    def half(_: float, place: tuple[float, float]) -> float:
        return math.hypot(*place) - 0.5 * CLEARANCE

    run = solve_ivp(
        rate, (0.0, duration), (0.0, 0.0), "LSODA", rtol=1e-10, atol=1e-16, events=half
    )
    times = run.t_events[0]
    return complex(*run.y[:, -1]) / CLEARANCE, times[0] if times.size else math.inf


def test_gap_of_a_long_dwell_falls_and_stays_open():
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
    # N; the products of forces near 1e-308 N round off by more than 1e-12
    st.just(0.0) | st.floats(1e-9, 1e5),
)
def test_velocity_inverts_the_force_of_the_film(eccentricity, angle, size):
    place = CLEARANCE * eccentricity
    force = cmath.rect(size, angle)
    parts = force.real, force.imag
    vx, vy, _ = film_velocity_of((place, 0.0), parts, UNDAMPED, SMOOTH)
    wedge_speed = -2.0 * vy / place
    film = film_force(1.0 - eccentricity, vx / CLEARANCE, wedge_speed, FILM)
    assert math.dist(film, parts) <= 1e-12 * size
    # A film that closes takes power; one that opens may give some from 0.66 on.
    assert vx < 0.0 or parts[0] * vx + parts[1] * vy <= 0.0


@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
@pytest.mark.parametrize("speed", [1e-3, 1.0])
@pytest.mark.parametrize("restitution", [0.5, 0.8])
def test_a_contact_without_film_has_its_restitution_at_any_speed(
    restitution, speed, exponent
):
    mass, stiffness = 20.0, 1e9
    ratio = damping_ratio(restitution)

    def rates(_: float, state: tuple[float, float]) -> tuple[float, float]:
        depth = max(state[0], 0.0)
        elastic = stiffness * depth**exponent
        energy = elastic * depth / (exponent + 1.0)
        damping, _ = contact_damping(elastic, energy, mass, ratio)
        return state[1], -(elastic + damping * state[1]) / mass

    def parted(_: float, state: tuple[float, float]) -> float:
        return state[0]

    setattr(parted, "terminal", True)  # noqa: B010
    setattr(parted, "direction", -1.0)  # noqa: B010
    depth = (speed**2 * mass / stiffness) ** (1.0 / (exponent + 1.0))
    run = solve_ivp(
        rates,
        (0.0, 10.0 * depth / speed),
        (0.0, speed),
        "DOP853",
        events=parted,
        rtol=1e-10,
        atol=1e-10 * depth,
    )
    assert -run.y[1, -1] / speed == pytest.approx(restitution, rel=1e-4)


def test_asperities_relax_as_slowly_as_the_contact():
    """The film opens at F_a / (D + tau F_a / (kappa sigma)), because oil hardly resists."""
    thin = FILM._replace(size=1e-12)
    bearing = OiledBearing(thin, CLEARANCE, 1e9, 1e-6)
    place = 0.98 * CLEARANCE
    time, damping = 1e-5, 1e3
    contact = 0.0, damping, time
    vx, _, rough = film_velocity_of((place, 0.0), (0.0, 0.0), contact, bearing)
    resistance = damping + time * rough / (DECAY * bearing.roughness)
    assert vx == pytest.approx(-rough / resistance, rel=1e-6)
