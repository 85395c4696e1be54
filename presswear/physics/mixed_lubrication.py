"""Mixed lubrication: the force of asperities through a thin film, and the shear of the oil.

Asperities bear as in the theory of Greenwood and Tripp, with an exponential of the film
in place of their integral.
"""

import math
from typing import NamedTuple

from presswear.tools.compile import compiled

DECAY = 0.42  # kappa: the force falls by 1/e over kappa sigma of film; assumed
ASPERITY_PRESSURE = 50e6  # p_0, Pa; assumed


class Asperities(NamedTuple):
    """Asperities of a pin and its bearing."""

    pressure: float  # p_0, Pa
    roughness: float  # sigma of both surfaces together, sqrt(2) R_q, m


@compiled
def asperity_force(
    film: float, clearance: float, area: float, asperities: Asperities
) -> float:
    """Return the force of asperities on a rigid pin, N.

    F = p_0 B R sqrt(2 pi kappa sigma / c) exp(-film / (kappa sigma)).

    Parameters
    ----------
    film, clearance : float
        Least thickness of the film, and radial clearance c, m.
    area : float
        Width times radius of the bearing, B R, m^2.
    asperities : Asperities
        Pressure and height of the asperities.
    """
    reach = DECAY * asperities.roughness
    share = math.sqrt(2.0 * math.pi * reach / clearance)
    return asperities.pressure * area * share * math.exp(-film / reach)


@compiled
def shear_moment(
    gap: float, spin: float, viscosity: float, bearing: tuple[float, float, float]
) -> float:
    """Return the moment with which sheared oil resists the spin of a pin, N m.

    M = 2 pi eta B R^3 omega / (c sqrt(1 - eps^2)), the mean of the moments on pin and
    bearing.

    Parameters
    ----------
    gap : float
        Least film over the clearance, 1 - eps.
    spin : float
        Speed of the pin less that of the bearing, rad/s.
    viscosity : float
        Dynamic viscosity, Pa s.
    bearing : tuple of float
        Width, radius and radial clearance, m.
    """
    width, radius, clearance = bearing
    root = math.sqrt(gap * (2.0 - gap))
    area = 2.0 * math.pi * radius * width
    return viscosity * spin * area * radius * radius / (clearance * root)
