"""LuGre's friction law: bristles with a deflection that is a state of the contact.

Stiffness and damping are per unit of normal force (Canudas de Wit, Olsson, Astrom and
Lischinsky, 1995).
"""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.friction_settings import LuGreSettings
from presswear.physics.equations.layout import State
from presswear.physics.interactions.page import Kernels, Page
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


@dataclass
class LuGre:
    """LuGre's friction in the text of a contact."""

    page: Page
    prefix: str  # of the joint
    joint: int  # its number
    law: FrictionLaw
    sliding: str = ""

    kernels: ClassVar[Kernels] = (Bristles, bristle_rate, bristle_force)
    has_state: ClassVar[bool] = True

    @property
    def _law(self) -> str:
        """Parameters of the law."""
        numbers = (
            self.page.text.parameter(f"{self.prefix}_friction_{word}", number)
            for word, number in bristles_of(self.law)._asdict().items()
        )
        return f"Bristles({', '.join(numbers)})"

    def write_state(self, sliding: str, is_closed: str) -> None:
        """Write the rate of the deflection of the bristles."""
        text, bristles = self.page.text, bristles_of(self.law)
        name = f"{self.prefix}_bristle"
        # Bristles slip at the deflection c_s / sigma_0.
        scale = bristles.static / bristles.bristle_stiffness
        place = self.page.add_state(State(name, scale, self.joint))
        self.sliding = sliding
        bristle = text.let(name, f"y[{place}]")
        rate = f"bristle_rate({sliding}, {bristle}, {is_closed}, {self._law})"
        text.write(f"out[{place}] = {text.let(f'{name}_rate', rate)}")

    def force(self, normal: str) -> str:
        """Return the call of the law."""
        name = f"{self.prefix}_bristle"
        return (
            f"bristle_force({normal}, {self.sliding}, {name}, {name}_rate, {self._law})"
        )

    @staticmethod
    def steady_force(law: FrictionLaw, sliding: Array, normal: Array) -> Array:
        """Return the friction of steady sliding, N, shape (n,): that of z' = 0."""
        bristles = bristles_of(law)
        ratio = sliding / bristles.stribeck
        rise = (bristles.static - bristles.coefficient) * np.exp(-ratio * ratio)
        return np.asarray(-np.sign(sliding) * normal * (bristles.coefficient + rise))
