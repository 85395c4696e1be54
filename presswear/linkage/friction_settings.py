"""Settings of friction laws beyond a coefficient and a ramp, and the names of all laws.

They are fields of a bearing. What the laws compute is in ``physics.interactions``.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.quantities import written
from presswear.tools.serialize import Checked

# Bristles make the steps of explicit methods short: a pin that slides by d takes about
# 0.3 d / z steps, with the deflection z, m, at which bristles slip, and a flight of t
# about 0.3 t / tau, with the time tau, s, in which bristles relax.
LEAST_SLIP = 1e-8  # m; a cycle of a four-bar then takes 240,000 steps
LEAST_RELAXATION = 1e-6  # s
# Part by which a setting may miss a limit, which is printed in four digits
_LIMIT_TOL = 1e-3


def greatest_bristle_damping(
    coefficient: float, static: float, stribeck: float
) -> float:
    """Return the greatest sigma_1, s/m, with which LuGre's friction never drives the sliding.

    Fully bent bristles, sigma_0 z = c_s, that slide at a speed v resist with c_s +
    sigma_1 exp(-(v/v_s)^2) v (1 - c_s/g(v)) per unit of normal force. If this is
    positive, less bent bristles resist, too: the force is linear in z, and positive at
    z = 0.
    """
    if static <= coefficient:
        return math.inf
    x = np.linspace(0.0, 6.0, 6001)  # v / v_s; above 6 the exponential is below 1e-15
    decay = np.exp(-x * x)
    level = coefficient + (static - coefficient) * decay  # g
    steepest = float((decay * x * (static / level - 1.0)).max()) * stribeck
    return static / steepest


@dataclass(frozen=True)
class LawSettings(Checked):
    """Settings of a friction law, with its name and meaning.

    The law is in the file of ``physics.interactions`` with this name.
    """

    law: ClassVar[str]
    meaning: ClassVar[str]

    def check(self, friction: float) -> None:
        """Raise InputError for settings that do not fit the friction coefficient."""


@dataclass(frozen=True)
class LuGreSettings(LawSettings):
    """Settings of a bearing that LuGre's law reads beside the friction coefficient c_f."""

    static_friction: float | None = quantity(
        None, "", 0.0, 2.0, "chosen", "c_s of friction_law = lugre; default: c_f"
    )
    stribeck_speed: float = quantity(
        1e-3, "m/s", 1e-6, 1.0, "chosen", "v_s of friction_law = lugre: from c_s to c_f"
    )
    bristle_stiffness: float = quantity(
        1e5,
        unit="1/m",
        low=1e2,
        high=1e7,
        origin="chosen",
        text="sigma_0 of friction_law = lugre, per unit of force",
    )
    bristle_damping: float = quantity(
        10.0,
        unit="s/m",
        low=1e-2,
        high=1e4,
        origin="chosen",
        text="sigma_1 of friction_law = lugre, per unit of force",
    )

    law: ClassVar[str] = "lugre"
    meaning: ClassVar[str] = (
        "bristles that hold and slip, with a state (Canudas de Wit and others)"
    )

    def check(self, friction: float) -> None:
        """Raise InputError if bristles are too stiff for time steps, or create energy."""
        stiffness = self.bristle_stiffness
        damping = self.bristle_damping
        static = self.static_friction
        if static is not None and static < friction:
            raise InputError(
                f"static_friction = {static:g}: allowed is {friction:g}, the friction, up to 2"
            )
        if friction == 0.0:
            return
        highest = friction / LEAST_SLIP
        if stiffness > (1.0 + _LIMIT_TOL) * highest:
            raise InputError(
                f"bristle_stiffness = {stiffness:g} 1/m: with friction = {friction:g} allowed "
                f"is up to {highest:.4g} 1/m, with which bristles slip at a deflection of "
                f"{1e9 * LEAST_SLIP:g} nm; 1e5 1/m is usual"
            )
        lowest = stiffness * LEAST_RELAXATION
        if damping < (1.0 - _LIMIT_TOL) * lowest:
            raise InputError(
                f"bristle_damping = {damping:g} s/m: with bristle_stiffness = {stiffness:g} 1/m "
                f"allowed is from {lowest:.4g} s/m, with which bristles relax within "
                f"{1e6 * LEAST_RELAXATION:g} us"
            )
        if static is None:
            return
        highest = greatest_bristle_damping(friction, static, self.stribeck_speed)
        if damping > highest:
            speed = written(self.stribeck_speed, "m/s")
            allowed = (1.0 - _LIMIT_TOL) * highest
            raise InputError(
                f"bristle_damping = {damping:g} s/m: with friction = "
                f"{friction:g}, static_friction = {static:g} and "
                f"stribeck_speed = {speed} allowed is up to {allowed:.4g} s/m; "
                "more drives the sliding and creates energy"
            )


WITH_SETTINGS: Mapping[str, type[LawSettings]] = {LuGreSettings.law: LuGreSettings}
"""Settings by the name of their law."""

WITHOUT_SETTINGS: Mapping[str, str] = {
    "ramp": "Coulomb's with the paper's ramp from v_0 to v_1 (equation 9)",
    "threlfall": "(1 - exp(-3 v_t / v_1)) of Coulomb's up to v_1, 1 - exp(-3) above (Threlfall)",
}
"""Meanings of laws without settings by name."""

FRICTIONS: Mapping[str, str] = {
    **WITHOUT_SETTINGS,
    **{name: kind.meaning for name, kind in WITH_SETTINGS.items()},
}
"""Meanings of all friction laws by name."""


@dataclass(frozen=True)
class FrictionSettings(LuGreSettings):
    """Settings of all laws of ``WITH_SETTINGS``, which are fields of a bearing."""


def friction_settings(name: str, bearing: FrictionSettings) -> Any:
    """Return the settings of a bearing that its law reads; None for a law without settings."""
    if name not in WITH_SETTINGS:
        return None
    kind = WITH_SETTINGS[name]
    return kind(**{item.name: getattr(bearing, item.name) for item in fields(kind)})
