"""Contact laws: normal force and friction between pin and bearing.

Every normal law here has the form

    F_n = K delta^n (1 + chi delta_dot / delta_dot_0),   F_n >= 0,

with the damping factor ``chi`` fixed by the nominal restitution (equation 8 of
the paper: chi = 3/4 (1 - ce^2), Lankarani and Nikravesh).  The friction law is
the paper's equation 9.
"""

import math
from dataclasses import dataclass
from typing import Literal

StiffnessReading = Literal["paper", "refined"]


def lankarani_nikravesh_damping(restitution: float) -> float:
    """Damping factor chi = 3/4 (1 - ce^2)."""
    return 0.75 * (1.0 - restitution**2)


def hertz_stiffness(
    bearing_radius: float,
    pin_radius: float,
    youngs_modulus: float,
    poisson_ratio: float,
    reading: StiffnessReading,
) -> float:
    """Contact stiffness K, N/m^1.5, for a pin and a bearing of the same material.

    ``paper`` takes sqrt(R_i R_j / (R_i + R_j)) as printed below equation 8, which
    is two spheres side by side.  ``refined`` takes the conforming pair: a pin in a
    hole has R_i - R_j under the root.
    """
    compliance = (1.0 - poisson_ratio**2) / youngs_modulus
    combined = bearing_radius + pin_radius if reading == "paper" else bearing_radius - pin_radius
    return 4.0 / (6.0 * compliance) * math.sqrt(bearing_radius * pin_radius / combined)


def delivered_restitution(damping: float) -> float:
    """Restitution e' that a law with damping factor chi gives back.

    Solves (1 + e') chi = ln[(1 + chi) / (1 - chi e')], which holds for any n, K
    and mass: Lankarani-Nikravesh at a nominal 0.9 delivers 0.913.
    """
    if damping <= 0.0:
        return 1.0

    def excess(restitution: float) -> float:
        if damping < 0.1:
            # The logarithm cancels against its argument: its series over chi^2.
            return sum(
                damping ** (k - 2) / k * ((-1.0) ** k - restitution**k) for k in range(2, 22)
            )
        return (1.0 + restitution) * damping - math.log(
            (1.0 + damping) / (1.0 - damping * restitution)
        )

    # excess(0) > 0; the only other root lies below both 1 and the pole at 1 / chi,
    # and for a large chi closer to the pole than numbers can tell.
    highest = min(1.0, (1.0 - 1e-15) / damping)
    if excess(highest) > 0.0:
        return highest
    from scipy.optimize import brentq  # slow to import

    return float(brentq(excess, 0.0, highest, xtol=1e-15, rtol=1e-14))


def greatest_penetration(
    mass: float, speed: float, stiffness: float, exponent: float, damping: float
) -> float:
    """Greatest penetration of a free impact, m (closed form for the laws above)."""
    energy = (exponent + 1.0) * mass * speed**2 / stiffness
    # chi -> 0 of (chi - ln(1 + chi)) / chi^2 is 1/2; the quotient cancels before that.
    if damping > 1e-5:
        lost = (damping - math.log1p(damping)) / damping**2
    else:
        lost = 0.5 - damping / 3.0
    return float((energy * lost) ** (1.0 / (exponent + 1.0)))


@dataclass(frozen=True)
class NormalLaw:
    """Normal contact of one joint: K delta^n (1 + chi delta_dot / delta_dot_0).

    Attributes
    ----------
    stiffness : float
        K, N/m^n.
    exponent : float
        n.
    damping : float
        chi, from the nominal restitution.
    """

    stiffness: float
    exponent: float = 1.5
    damping: float = 0.0


@dataclass(frozen=True)
class FrictionLaw:
    """Coulomb friction with the paper's ramp.

    Attributes
    ----------
    coefficient : float
        c_f.
    lower, upper : float
        v_0 and v_1, m/s: no friction below, full friction above.
    """

    coefficient: float = 0.0
    lower: float = 1e-4
    upper: float = 1e-3
