"""Periodic orbit of a pin on its oil film, from the force and the speeds in a cycle.

The pin has no mass: the force gives its velocity in the film. The state is the vector
s = -ln(g) n with the relative gap g and the direction n of the eccentricity. A thin
film keeps its digits, and a gap stays above zero however long the force lasts.
"""

import math
from dataclasses import dataclass

import numpy as np

from presswear.physics.oil_film import NO_DAMPING, OilFilm, film_velocity
from presswear.tools.arrays import Array

_MAX_CYCLES = 60  # a dwell without rotation never closes: its film falls as 1 / time^2
_CLOSED = 1e-3  # largest relative change of the gap in a cycle of a closed orbit
_MAX_EVALUATIONS = 100_000  # a second; an orbit has about 500 to 3000 in a cycle
_TOLERANCE = 1e-5  # tolerance of the integrator for -ln(g)
_LEAST_STEPS = 100  # steps of a cycle, at least: a longer step may jump over short work
# Least gap, far below any roughness: at a smaller one, thin oil that opens again would
# move the pin within a time that is round-off of the time in the cycle.
_THINNEST = 1e-5


@dataclass(frozen=True)
class FilmLoad:
    """Force and speeds of a joint in a cycle, whose last instant is the first of the next."""

    time: Array  # s, shape (n,)
    force: Array  # force of the film on the pin, x + 1j y, N
    speed_sum: Array  # speeds of pin and bearing, rad/s


@dataclass(frozen=True)
class FilmOrbit:
    """Places of a pin in a cycle, at the times of its load."""

    gap: Array  # least film over the clearance, shape (n,)
    place: Array  # eccentricity over the clearance, x + 1j y
    is_closed: bool  # the cycle repeats itself

    @property
    def cycles_text(self) -> str:
        """Words on an orbit that does not close."""
        return f"after {_MAX_CYCLES} cycles"


def film_power(load: FilmLoad, orbit: FilmOrbit, film: OilFilm) -> Array:
    """Return the power that wedge and squeeze take, over the clearance, N/s, shape (n,).

    The film takes -F . e' + (e x F) S / 2 with the sum S of the speeds, because half of
    the couple of its forces acts on the pin and half on the bearing. In the film's own
    rates that is c (F_t eps Omega / 2 - F_n eps').
    """
    size = np.abs(orbit.place)
    direction = np.divide(
        orbit.place, size, out=np.ones_like(orbit.place), where=size > 0.0
    )
    on_film = load.force * direction.conj()
    gaps = np.maximum(orbit.gap, _THINNEST).tolist()
    power = []
    for gap, force in zip(gaps, on_film.tolist(), strict=True):
        closing, wedge = film_velocity(gap, force.real, force.imag, film, NO_DAMPING)
        power.append(force.imag * wedge - force.real * closing)
    return np.array(power)


class OrbitTooStiff(Exception):
    """The force changes much more slowly than a film of so little viscosity follows it."""


def periodic_orbit(load: FilmLoad, film: OilFilm) -> FilmOrbit:
    """Return the orbit of a pin that starts centred and repeats the cycle until it closes.

    Raises
    ------
    OrbitTooStiff
        If the film is much thinner than any roughness under most of the load: closing
        is then slower than opening by many powers of ten.
    """
    from scipy.integrate import solve_ivp  # slow to import

    time = load.time - load.time[0]
    series = load.force.real, load.force.imag, load.speed_sum

    evaluations = 0

    def rate(now: float, state: Array) -> tuple[float, float]:
        nonlocal evaluations
        evaluations += 1
        if evaluations > _MAX_EVALUATIONS:
            raise OrbitTooStiff
        x, y, speeds = (float(np.interp(now, time, values)) for values in series)
        return stretched_rate(state, (x, y), speeds, film)

    start = np.zeros(2)
    previous = np.full(time.size, math.inf)
    # At an error of 1e-4 LSODA takes 180 to 370 steps in a cycle of the press of 250 kN and
    # in those of slider-cranks, with 400 to 830 evaluations. DOP853 takes 30 to 140 steps
    # with 710 to 2800 evaluations, Radau 80 to 210 steps with 930 to 2200.
    for _ in range(_MAX_CYCLES):
        solution = solve_ivp(
            rate,
            (0.0, time[-1]),
            start,
            method="LSODA",
            t_eval=time,
            max_step=time[-1] / _LEAST_STEPS,
            rtol=_TOLERANCE,
            atol=_TOLERANCE,
        )
        if not solution.success:
            raise OrbitTooStiff(solution.message)
        start = solution.y[:, -1]
        stretched = np.hypot(*solution.y)
        change = float(np.abs(stretched - previous).max())
        if change <= _CLOSED:
            break
        previous = stretched
    direction = np.arctan2(solution.y[1], solution.y[0])
    place = -np.expm1(-stretched) * np.exp(1j * direction)
    return FilmOrbit(np.exp(-stretched), place, change <= _CLOSED)


def stretched_rate(
    state: Array, force: tuple[float, float], speed_sum: float, film: OilFilm
) -> tuple[float, float]:
    """Return the rate of s = -ln(g) n, 1/s, under a force of the film on the pin, N.

    A centred pin moves along the force.
    """
    x = float(state[0])
    y = float(state[1])
    length = math.hypot(x, y)
    eccentricity = -math.expm1(-length)
    if eccentricity > 0.0:
        nx = x / length
        ny = y / length
        stretch = length / eccentricity
    else:
        size = math.hypot(*force) or 1.0
        nx = -force[0] / size
        ny = -force[1] / size
        stretch = 1.0
    gap = max(math.exp(-length), _THINNEST)
    along = force[0] * nx + force[1] * ny
    across = force[1] * nx - force[0] * ny
    closing, wedge = film_velocity(gap, along, across, film, NO_DAMPING)
    is_thinnest = gap == _THINNEST
    outwards = 0.0 if is_thinnest and closing > 0.0 else closing / gap
    sideways = (0.5 * eccentricity * speed_sum - wedge) * stretch
    return outwards * nx - sideways * ny, outwards * ny + sideways * nx
