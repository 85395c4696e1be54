"""LuGre's friction law: bristles with a deflection that is a state of the contact.

Canudas de Wit, Olsson, Astrom and Lischinsky (1995). Stiffness sigma_0, 1/m, and damping
sigma_1, s/m, are per unit of normal force. c_f is the kinetic and c_s the static
coefficient of friction, v_s the Stribeck speed.
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.friction_settings import LuGreSettings
from presswear.physics.interactions.friction_with_settings import LawWithSettings
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined


class Bristles(NamedTuple):
    """Parameters of LuGre's law in kernels."""

    coefficient: float  # c_f
    static: float  # c_s
    stribeck: float  # v_s, m/s
    bristle_stiffness: float  # sigma_0, 1/m
    bristle_damping: float  # sigma_1, s/m


@inlined
def stribeck_coefficient(sliding: float, law: Records) -> float:
    """Return the coefficient of steady sliding, g = c_f + (c_s - c_f) exp(-(v / v_s)^2)."""
    ratio = sliding / law.stribeck
    return law.coefficient + (law.static - law.coefficient) * math.exp(-ratio * ratio)


@compiled
def bristle_rate(
    sliding: float, bristle: float, is_closed: bool, law: Records
) -> float:
    """Return the rate of the mean deflection z, m, of the bristles of LuGre's law, m/s.

    z' = v - sigma_0 |v| z / g in a closed contact. Bristles that touch nothing bear no
    force: sigma_0 z + sigma_1 z' = 0.
    """
    if not is_closed:
        return -law.bristle_stiffness / law.bristle_damping * bristle
    slip_coefficient = stribeck_coefficient(sliding, law)
    return sliding - law.bristle_stiffness * abs(sliding) * bristle / slip_coefficient


@compiled
def bristle_force(
    normal: float, sliding: float, bristle: float, rate: float, law: Records
) -> float:
    """Return the friction of bristles, N: -F_n (sigma_0 z + sigma_1 exp(-(v / v_s)^2) z').

    A damping that does not decrease with the speed would create energy in sliding (Olsson
    1996). ``greatest_bristle_damping`` limits sigma_1, so that the force never drives
    the sliding.
    """
    ratio = sliding / law.stribeck
    damping = law.bristle_damping * math.exp(-ratio * ratio)
    return -normal * (law.bristle_stiffness * bristle + damping * rate)


def bristles_of(law: FrictionLaw) -> Bristles:
    """Return the parameters of LuGre's law."""
    settings = law.settings or LuGreSettings()
    return Bristles(
        coefficient=law.coefficient,
        static=max(settings.static_friction or 0.0, law.coefficient),
        stribeck=settings.stribeck_speed,
        bristle_stiffness=settings.bristle_stiffness,
        bristle_damping=settings.bristle_damping,
    )


def steady_bristles(law: FrictionLaw, sliding: Array, normal: Array) -> Array:
    """Return the friction of steady sliding (z' = 0), N, shape (n,)."""
    bristles = bristles_of(law)
    ratio = sliding / bristles.stribeck
    rise = (bristles.static - bristles.coefficient) * np.exp(-ratio * ratio)
    return np.asarray(-np.sign(sliding) * normal * (bristles.coefficient + rise))


LAW = LawWithSettings(
    Bristles,
    bristles_of,
    state="bristle",
    # Bristles slip at the deflection c_s / sigma_0.
    scale=lambda bristles: bristles.static / bristles.bristle_stiffness,
    rate=bristle_rate,
    force=bristle_force,
    steady_force=steady_bristles,
)
