"""Oil film of a plain bearing: wedge and squeeze in closed form.

The formulas are fits to solutions of the Reynolds equation for bearings of finite width
without negative pressure (Butenschoen, Das hydrodynamische, zylindrische Gleitlager
endlicher Breite unter instationaerer Belastung, 1976). A film has no mass: the place of
the pin in the bearing is a state, and the force gives its velocity.

The place is the vector e from the centre of the bearing to that of the pin, over the
clearance c, with the direction n = e / |e| and t = n turned by +90 degrees. Its length
is 1 - g, with the relative gap g, which is the least film over c. A thin film keeps all
digits of g.
"""

import math
from typing import NamedTuple

from presswear.linkage.oil import MAX_FILM_WIDTH, MIN_FILM_WIDTH
from presswear.physics.rotation import cos_sin
from presswear.tools.compile import compiled

_SMALL = 1.0  # rad, below which a series has more digits than the closed form
# (-1)^k (k - 1) / (2 (2 k + 1)!) from k = 2: factors of double^(2 k + 1) in the series
_SERIES = tuple(
    (-1) ** k * (k - 1) / (2.0 * math.factorial(2 * k + 1)) for k in range(2, 10)
)


NO_DAMPING = 0.0, 0.0  # along n and t, N s; see ``film_velocity``


class OilFilm(NamedTuple):
    """Parameters of a film."""

    width_ratio: float  # width over diameter, b
    size: float  # A = B d eta / psi^2, N s


def film_of(
    width: float, bearing_radius: float, clearance: float, viscosity: float
) -> OilFilm:
    """Return the parameters of a film; the width over diameter is limited to that of the fits.

    Parameters
    ----------
    width, bearing_radius, clearance : float
        Dimensions of the bearing, m.
    viscosity : float
        Dynamic viscosity, Pa s.
    """
    diameter = 2.0 * bearing_radius
    relative_clearance = clearance / bearing_radius
    size = width * diameter * viscosity / relative_clearance**2
    return OilFilm(min(max(width / diameter, MIN_FILM_WIDTH), MAX_FILM_WIDTH), size)


@compiled
def rotation_slope(gap: float, width_ratio: float) -> float:
    """Return So_rot / eps of a turning pin, with So_rot = F psi^2 / (B d eta omega).

    Parameters
    ----------
    gap : float
        Least film over the clearance, above 0 and up to 1.
    width_ratio : float
        Width over diameter b. The fit lies within 7 % of tables for 1/8 to 1.
    """
    b = width_ratio
    e = 1.0 - gap
    a1 = 1.1642 + b * (-1.9456 + b * (7.1161 + b * (-10.1073 + b * 5.0141)))
    a2 = -1.000026 - b * (0.023634 + b * (0.4215 + b * (0.038817 + b * 0.090551)))
    one_minus_square = gap * (1.0 + e)  # 1 - e^2
    root = math.sqrt(math.pi * math.pi * one_minus_square + 16.0 * e * e)
    denominator = 2.0 * one_minus_square * one_minus_square
    return b * b / denominator * root * a1 * gap / (-a2 - e)


@compiled
def squeeze_number(gap: float, is_closing: bool, width_ratio: float) -> float:
    """Return the Sommerfeld number So_sq = F psi^2 / (B d eta eps') of a pin that moves along n.

    A closing film presses at the narrow side, an opening one at the wide side, because
    there is no negative pressure.
    """
    b = width_ratio
    e = 1.0 - gap
    x = e if is_closing else -e
    a8 = 0.70038 + b * (3.2415 + b * (-12.2486 + b * (18.895 - b * 9.3561)))
    a9 = -0.999935 + b * (0.0157434 + b * (-0.74224 + b * (0.42278 - b * 0.368928)))
    root = math.sqrt(gap * (1.0 + e))  # sqrt(1 - x^2)
    square = root * root
    pressure = _squeeze_pressure(x, root) / (square * square * root)
    narrow = gap if is_closing else 1.0 + e  # 1 - x
    return 4.0 * b * b * pressure * a8 * narrow / (-a9 - x)


@compiled
def _squeeze_pressure(x: float, root: float) -> float:
    """Return (pi/2 - acos(x)/2) (1 + 2 x^2) + 1.5 x sqrt(1 - x^2).

    ``root`` is sqrt(1 - x^2).
    """
    angle = math.atan2(root, -x)
    double = 2.0 * angle
    if double > _SMALL:
        return 0.5 * angle * (1.0 + 2.0 * x * x) + 1.5 * x * root
    # The terms cancel to order 5 in the angle.
    square = double * double
    series = _SERIES[-1]
    for k in range(2, len(_SERIES) + 1):
        series = _SERIES[-k] + square * series
    return square * square * double * series


@compiled
def attitude(gap: float, width_ratio: float) -> float:
    """Return the angle beta from the force of a turning pin's film to -n, rad."""
    b = width_ratio
    e = 1.0 - gap
    a3 = 1.152624 - 0.104565 * b
    a4 = -2.5905 + 0.798745 * b
    a5 = 8.73393 - 2.3291 * b
    a6 = -13.3414 + 3.424337 * b
    a7 = 6.6294 - 1.591732 * b
    shape = a3 + e * (a4 + e * (a5 + e * (a6 + e * a7)))
    one_minus_square = gap * (1.0 + e)  # 1 - e^2
    return math.atan2(math.pi * math.sqrt(one_minus_square), 2.0 * e) * shape


@compiled
def film_force(
    gap: float, rate: float, wedge_speed: float, film: OilFilm
) -> tuple[float, float]:
    """Return the force of the film on the pin along n and t, N.

    Parameters
    ----------
    gap : float
        Least film over the clearance.
    rate : float
        Rate of the relative eccentricity, eps', 1/s.
    wedge_speed : float
        Speeds of pin and bearing less twice that of n, rad/s.
    film : OilFilm
        Parameters of the film.
    """
    cosine, sine = cos_sin(attitude(gap, film.width_ratio))
    slope = rotation_slope(gap, film.width_ratio)
    rotation = film.size * wedge_speed * (1.0 - gap) * slope
    squeeze = film.size * rate * squeeze_number(gap, rate > 0.0, film.width_ratio)
    along = -abs(rotation) * cosine - squeeze
    across = rotation * sine
    return along, across


@compiled
def film_velocity(
    gap: float,
    along: float,
    across: float,
    film: OilFilm,
    damping: tuple[float, float],
) -> tuple[float, float]:
    """Return eps' and half of eps times the wedge speed, 1/s, from the force on the pin, N.

    The inverse of ``film_force``. With the sum S of the speeds of pin and bearing the
    pin moves along t at eps gamma' = eps S / 2 - (second result), also at eps = 0,
    where both are finite.

    Parameters
    ----------
    gap : float
        Least film over the clearance.
    along, across : float
        Force of the film on the pin along n and t, N.
    film : OilFilm
        Parameters of the film.
    damping : tuple of float
        Of dampers beside the film, along n and t, N s: their forces over the two rates.
    """
    b = film.width_ratio
    cosine, sine = cos_sin(attitude(gap, b))
    resistance = 2.0 * film.size * rotation_slope(gap, b) * sine
    wedge = across / (resistance + damping[1])
    # A |Omega| So_rot = |F_t| / sin(beta)
    squeeze = -along - abs(wedge) * resistance * cosine / sine
    number = squeeze_number(gap, squeeze > 0.0, b)
    return squeeze / (film.size * number + damping[0]), wedge
