"""LuGre's friction law: bristles with a deflection that is a state of the contact.

Stiffness and damping are per unit of normal force (Canudas de Wit, Olsson, Astrom and
Lischinsky, 1995).
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

    coefficient: float
    static: float
    stribeck: float
    bristle_stiffness: float
    bristle_damping: float


@inlined
def stribeck_coefficient(sliding: float, law: Records) -> float:
    """Return the friction coefficient g of LuGre's law in steady sliding at a speed, m/s."""
    ratio = sliding / law.stribeck
    return law.coefficient + (law.static - law.coefficient) * math.exp(-ratio * ratio)


@compiled
def bristle_rate(
    sliding: float, bristle: float, is_closed: bool, law: Records
) -> float:
    """Return the rate of the mean deflection z, m, of the bristles of LuGre's law, m/s.

    z' = v - sigma_0 |v| z / g, g = c_f + (c_s - c_f) exp(-(v / v_s)^2) (Canudas de Wit,
    Olsson, Astrom and Lischinsky, 1995), all per unit of normal force. Bristles that
    touch nothing bear no force: sigma_0 z + sigma_1 z' = 0.
    """
    free = -law.bristle_stiffness / law.bristle_damping * bristle
    slip_coefficient = stribeck_coefficient(sliding, law)
    closed = sliding - law.bristle_stiffness * abs(sliding) * bristle / slip_coefficient
    return closed if is_closed else free


@compiled
def bristle_force(
    normal: float, sliding: float, bristle: float, rate: float, law: Records
) -> float:
    """Return the friction of bristles, N: -F_n (sigma_0 z + sigma_1 exp(-(v / v_s)^2) z').

    Damping that did not fade would make energy in steady sliding (Olsson 1996). Where z
    changes, ``greatest_bristle_damping`` keeps the force from driving the sliding.
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
    """Return the friction of steady sliding, N, shape (n,): that of z' = 0."""
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
