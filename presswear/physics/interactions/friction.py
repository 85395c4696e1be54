"""Friction laws of a contact: their names, their settings, and their text in the equations."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Protocol

import numpy as np

from presswear.linkage.laws import FrictionLaw
from presswear.physics.friction_and_normal import (
    FRICTION_FORCES,
    fill_friction,
    friction_record,
)
from presswear.physics.interactions.lugre import LuGre, LuGreSettings
from presswear.physics.interactions.page import Kernels, Page
from presswear.tools.arrays import Array
from presswear.tools.compile import Records
from presswear.tools.errors import unknown


class FrictionText(Protocol):
    """Friction law that writes its expressions into the equations of a contact."""

    kernels: ClassVar[Kernels]  # compiled functions that the text calls
    has_state: ClassVar[bool]  # the law has a state, which changes in open joints, too

    def write_state(self, sliding: str, is_closed: str) -> None:
        """Write the rate of the state; both arguments are expressions."""
        ...

    def force(self, normal: str) -> str:
        """Return the friction force along the tangent, under a normal force."""
        ...


@dataclass
class FrictionWithoutState:
    """Friction law as a function of FRICTION_PARAMETERS: a named law or a user law."""

    page: Page
    prefix: str  # of the joint
    law: FrictionLaw
    record: Records  # of FRICTION
    sliding: str = ""

    kernels: ClassVar[Kernels] = tuple(FRICTION_FORCES.values())
    has_state: ClassVar[bool] = False

    def write_state(self, sliding: str, is_closed: str) -> None:
        """Store the sliding speed for ``force``."""
        self.sliding = sliding

    def force(self, normal: str) -> str:
        """Return the call of the law."""
        text = self.page.text
        law = self.law
        parameters = (
            text.parameter(f"{self.prefix}_friction_coefficient", law.coefficient),
            text.parameter(f"{self.prefix}_lower_speed", law.lower),
            text.parameter(f"{self.prefix}_upper_speed", law.upper),
        )
        arguments = ", ".join((self.sliding, normal, *parameters))
        if law.user_law is None:
            return f"{FRICTION_FORCES[law.name].__name__}({arguments})"
        address = text.parameter(f"{self.prefix}_friction_law", self.record["force"])
        return f"call(int({address}), ({arguments}))"

    @staticmethod
    def steady_force(law: FrictionLaw, sliding: Array, normal: Array) -> Array:
        """Return the friction at sliding speeds, N, shape (n,)."""
        force = np.zeros_like(normal)
        fill_friction(friction_record(law), sliding, normal, force)
        return force


class FrictionWithSettings(FrictionText, Protocol):
    """Friction law of joints with clearance that has settings, and perhaps a state."""

    name: ClassVar[str]
    meaning: ClassVar[str]  # in help texts
    settings: ClassVar[type[Any]]  # data class whose fields become fields of a bearing

    def __init__(self, page: Page, prefix: str, joint: int, law: FrictionLaw) -> None:
        """Take the page, the beginning of names, the number of the joint, and the law."""
        ...

    @staticmethod
    def steady_force(law: FrictionLaw, sliding: Array, normal: Array) -> Array:
        """Return the friction of steady sliding, N; speeds, m/s, and forces, N, are (n,)."""
        ...

    @staticmethod
    def check(settings: Any, friction: float) -> None:
        """Raise InputError for settings that do not fit the friction coefficient."""
        ...


WITH_SETTINGS: Mapping[str, type[FrictionWithSettings]] = {
    law.name: law for law in (LuGre,)
}
"""Friction laws with settings by name."""


@dataclass(frozen=True)
class FrictionSettings(LuGreSettings):
    """Settings of all laws of ``WITH_SETTINGS``, which are fields of a bearing."""


FRICTIONS: Mapping[str, str] = {
    "ramp": "Coulomb's with the paper's ramp from v_0 to v_1 (equation 9)",
    "threlfall": "(1 - exp(-3 v_t / v_1)) of Coulomb's up to v_1, 1 - exp(-3) above (Threlfall)",
    **{name: law.meaning for name, law in WITH_SETTINGS.items()},
}
"""Friction laws by name."""
FRICTION_KERNELS = (
    *FrictionWithoutState.kernels,
    *(kernel for law in WITH_SETTINGS.values() for kernel in law.kernels),
)


def settings_of(name: str, bearing: FrictionSettings) -> Any:
    """Return the settings of a bearing that its law reads; None for a law without settings."""
    if name not in WITH_SETTINGS:
        return None
    kind = WITH_SETTINGS[name].settings
    return kind(**{item.name: getattr(bearing, item.name) for item in fields(kind)})


def friction_of(
    page: Page, prefix: str, joint: int, law: FrictionLaw, record: Records
) -> FrictionText:
    """Return the friction law of a joint; its variables in the text begin with ``prefix``."""
    if law.name not in FRICTIONS:
        raise unknown("friction law", law.name, FRICTIONS)
    if law.name in WITH_SETTINGS and law.coefficient > 0.0:
        return WITH_SETTINGS[law.name](page, prefix, joint, law)
    return FrictionWithoutState(page, prefix, law, record)


def steady_friction(law: FrictionLaw, sliding: Array, normal: Array) -> Array:
    """Return the friction of steady sliding, N; speeds, m/s, and forces, N, are (n,)."""
    if law.name in WITH_SETTINGS:
        return WITH_SETTINGS[law.name].steady_force(law, sliding, normal)
    return FrictionWithoutState.steady_force(law, sliding, normal)
