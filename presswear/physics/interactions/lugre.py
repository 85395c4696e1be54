"""LuGre's friction law: bristles with a deflection that is a state of the contact.

Stiffness and damping are per unit of normal force (Canudas de Wit, Olsson, Astrom and
Lischinsky, 1995).
"""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from presswear.linkage.laws import FrictionLaw
from presswear.physics.equations.layout import State
from presswear.physics.interactions.page import Kernels, Page
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined
from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.quantities import written
from presswear.tools.serialize import Checked

# Bristles make the steps of explicit methods short: a pin that slides by d takes about
# 0.3 d / z steps, with the deflection z, m, at which bristles slip, and a flight of t
# about 0.3 t / tau, with the time tau, s, in which bristles relax.
LEAST_SLIP = 1e-8  # m; a cycle of a four-bar then takes 240,000 steps
LEAST_RELAXATION = 1e-6  # s


@dataclass(frozen=True)
class LuGreSettings(Checked):
    """Settings of a bearing that LuGre's law reads beside the friction coefficient c_f."""

    static_friction: float | None = quantity(
        None, "", 0.0, 2.0, "chosen", "c_s of friction_law = lugre; default: c_f"
    )
    stribeck_speed: float = quantity(
        1e-3, "m/s", 1e-6, 1.0, "chosen", "v_s of friction_law = lugre: from c_s to c_f"
    )
    bristle_stiffness: float = quantity(
        1e5,
        "1/m",
        1e2,
        1e7,
        "chosen",
        "sigma_0 of friction_law = lugre, per unit of force",
    )
    bristle_damping: float = quantity(
        10.0,
        "s/m",
        1e-2,
        1e4,
        "chosen",
        "sigma_1 of friction_law = lugre, per unit of force",
    )


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


def greatest_bristle_damping(
    coefficient: float, static: float, stribeck: float
) -> float:
    """Return the greatest sigma_1, s/m, with which LuGre's friction never drives the sliding.

    Bristles that are bent fully, sigma_0 z = c_s, and then slide at a speed v resist
    with c_s + sigma_1 exp(-(v/v_s)^2) v (1 - c_s/g(v)) per unit of normal force.
    Bristles bent less resist at any speed if these do, because the force is linear in z
    and at z = 0 it resists.
    """
    x = np.linspace(0.0, 6.0, 6001)  # v / v_s; above 6 the exponential is below 1e-15
    part = np.exp(-x * x)
    level = coefficient + (static - coefficient) * part  # g
    steepest = float((part * x * (static / level - 1.0)).max()) * stribeck
    return static / steepest if steepest > 0.0 else math.inf


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

    name: ClassVar[str] = "lugre"
    meaning: ClassVar[str] = (
        "bristles that hold and slip, with a state (Canudas de Wit and others)"
    )
    settings: ClassVar[type[LuGreSettings]] = LuGreSettings
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

    @staticmethod
    def check(settings: LuGreSettings, friction: float) -> None:
        """Raise InputError if bristles are too stiff for time steps, or create energy."""
        stiffness = settings.bristle_stiffness
        damping = settings.bristle_damping
        static = settings.static_friction
        if static is not None and static < friction:
            raise InputError(
                f"static_friction = {static:g}: allowed is {friction:g}, the friction, up to 2"
            )
        if friction == 0.0:
            return
        highest = friction / LEAST_SLIP
        if stiffness > 1.001 * highest:
            raise InputError(
                f"bristle_stiffness = {stiffness:g} 1/m: with friction = {friction:g} allowed "
                f"is up to {highest:.4g} 1/m, with which bristles slip at a deflection of "
                f"{1e9 * LEAST_SLIP:g} nm; 1e5 1/m is usual"
            )
        lowest = stiffness * LEAST_RELAXATION
        if damping < 0.999 * lowest:
            raise InputError(
                f"bristle_damping = {damping:g} s/m: with bristle_stiffness = {stiffness:g} 1/m "
                f"allowed is from {lowest:.4g} s/m, with which bristles relax within "
                f"{1e6 * LEAST_RELAXATION:g} us"
            )
        if static is None:
            return
        highest = greatest_bristle_damping(friction, static, settings.stribeck_speed)
        if damping > highest:
            speed = written(settings.stribeck_speed, "m/s")
            raise InputError(
                f"bristle_damping = {damping:g} s/m: with friction = "
                f"{friction:g}, static_friction = {static:g} and "
                f"stribeck_speed = {speed} allowed is up to {0.999 * highest:.4g} s/m; "
                "more drives the sliding and creates energy"
            )
