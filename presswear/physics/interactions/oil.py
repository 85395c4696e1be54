"""Oil between a pin and its bearing: a film without mass in series with the elastic contact.

The place e_f of the pin on a rigid film is a state. The elastic contact is stretched by
u = e - e_f, and its force F on the pin, against u, is that of the film and of the
asperities together. The film's part gives the rate of e_f in closed form.
"""

import math
from typing import NamedTuple

from presswear.physics.mixed_lubrication import DECAY
from presswear.physics.oil_film import OilFilm, film_velocity
from presswear.tools.compile import compiled

# Least gap over the clearance in the formulas of the film, far below any roughness
THINNEST = 1e-6


class OiledBearing(NamedTuple):
    """Parameters of an oiled bearing."""

    film: OilFilm
    clearance: float  # m
    asperity_size: float  # p_0 B R, N
    roughness: float  # sigma of both surfaces together, m


@compiled
def borne_by_asperities(
    eccentricity: float, half_chord: float, bearing: OiledBearing
) -> float:
    """Return the force of asperities, N, at a place of the pin on the rigid film, m.

    F = p_0 B R [sqrt(2 pi kappa sigma / c) + 2 sin s] exp((|e_f| - c) / (kappa sigma)),
    with the half angle s of the elastic arc; ``half_chord`` is sin s.
    """
    reach = DECAY * bearing.roughness
    share = math.sqrt(2.0 * math.pi * reach / bearing.clearance) + 2.0 * half_chord
    closeness = math.exp((eccentricity - bearing.clearance) / reach)
    return bearing.asperity_size * share * closeness


@compiled
def film_rate(
    place: tuple[float, float],
    force: tuple[float, float],
    speed_sum: float,
    half_chord: float,
    bearing: OiledBearing,
) -> tuple[float, float, float]:
    """Return the rate of e_f, m/s, and the force of the asperities, N.

    Parameters
    ----------
    place : tuple of float
        Place of the pin on the film, e_f, m.
    force : tuple of float
        Of film and asperities on the pin, N.
    speed_sum : float
        Speeds of pin and bearing, rad/s.
    half_chord : float
        Sine of the half angle of the elastic arc.
    bearing : OiledBearing
        Parameters.
    """
    x, y = place
    eccentricity = math.sqrt(x * x + y * y)
    size = math.sqrt(force[0] * force[0] + force[1] * force[1])
    # A centred pin moves along the force; without a force any direction serves.
    nx, ny = 1.0, 0.0
    if eccentricity > 0.0:
        nx, ny = x / eccentricity, y / eccentricity
    elif size > 0.0:
        nx, ny = -force[0] / size, -force[1] / size
    rough = borne_by_asperities(eccentricity, half_chord, bearing)
    gap = max(1.0 - eccentricity / bearing.clearance, THINNEST)
    along = force[0] * nx + force[1] * ny + rough
    across = force[1] * nx - force[0] * ny
    closing, wedge = film_velocity(gap, along, across, bearing.film)
    outwards = bearing.clearance * closing
    sideways = 0.5 * eccentricity * speed_sum - bearing.clearance * wedge
    return outwards * nx - sideways * ny, outwards * ny + sideways * nx, rough


@compiled
def film_loss(
    place: tuple[float, float],
    rate: tuple[float, float],
    force: tuple[float, float],
    speed_sum: float,
) -> float:
    """Return the power that film and asperities take from the bodies, without friction, W.

    P = -F . e_f' + (e_f x F) S / 2: the forces act on both bodies at the middle of e,
    and half of their couple about the film acts on each.
    """
    couple = place[0] * force[1] - place[1] * force[0]
    work = force[0] * rate[0] + force[1] * rate[1]
    return 0.5 * couple * speed_sum - work
