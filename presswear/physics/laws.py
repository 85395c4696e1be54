"""Contact forces of a pin on its bearing, compiled; see ``presswear.linkage.laws``."""

import math
from dataclasses import fields

import numpy as np

from presswear.linkage.laws import FrictionLaw
from presswear.tools.compiled import Records, compiled

FRICTION = np.dtype([(item.name, np.float64) for item in fields(FrictionLaw)])
"""A law of friction as the kernels see it, by the names of its fields."""

ONSET_SPEED_FLOOR = 1e-6
"""Smallest closing speed used in the damping term, m/s.

The damping term divides by the closing speed at touchdown, which goes to zero
where a pin grazes; below this speed the kinetic energy of a gram is 5e-16 J.
"""


@compiled
def elastic_force(penetration: float, stiffness: float, exponent: float) -> float:
    """Elastic contact force K delta^n, N; zero when open."""
    if penetration <= 0.0:
        return 0.0
    # n = 3/2 is by far the most common; a square root is cheaper than a power.
    if exponent == 1.5:
        return stiffness * penetration * math.sqrt(penetration)
    return stiffness * penetration**exponent


@compiled
def damped_force(elastic: float, rate: float, onset_speed: float, damping: float) -> float:
    """Elastic force with its damping, N (equation 8); never adhesive."""
    force = elastic * (1.0 + damping * rate / onset_speed)
    return force if force > 0.0 else 0.0


@compiled
def normal_force(
    penetration: float,
    rate: float,
    onset_speed: float,
    stiffness: float,
    exponent: float,
    damping: float,
) -> float:
    """Normal contact force, N (equation 8); zero when open, never adhesive.

    Parameters
    ----------
    penetration, rate : float
        delta, m, and its time derivative, m/s.
    onset_speed : float
        Closing speed at touchdown delta_dot_0, m/s, above zero.
    stiffness, exponent, damping : float
        K, N/m^n; n; chi.
    """
    elastic = elastic_force(penetration, stiffness, exponent)
    return damped_force(elastic, rate, onset_speed, damping)


@compiled
def friction_ramp(speed: float, lower: float, upper: float) -> float:
    """Dynamic correction c_d in 0 .. 1 (equation 9) for a sliding speed, m/s."""
    magnitude = abs(speed)
    if magnitude <= lower:
        return 0.0
    if magnitude >= upper:
        return 1.0
    return (magnitude - lower) / (upper - lower)


@compiled
def friction_force(sliding: float, normal: float, law: Records) -> float:
    """Friction force along t, N: -c_f c_d F_n sign(v_t) (equation 9).

    Parameters
    ----------
    sliding : float
        v_t, m/s.
    normal : float
        F_n, N.
    law : record of FRICTION
    """
    ramp = friction_ramp(sliding, law.lower, law.upper)
    return -math.copysign(law.coefficient * ramp * normal, sliding)
