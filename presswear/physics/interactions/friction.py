"""Friction laws of a contact: their text in the equations, and their steady force."""

from dataclasses import dataclass
from importlib import import_module
from typing import ClassVar, Protocol

import numpy as np

from presswear.linkage.friction_law import FrictionLaw, has_state
from presswear.linkage.friction_settings import FRICTIONS, WITH_SETTINGS
from presswear.physics.friction_and_normal import (
    FRICTION_FORCES,
    fill_friction,
    friction_record,
)
from presswear.physics.interactions.friction_with_settings import (
    FrictionWithSettings,
    LawWithSettings,
)
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.interactions.user_friction import UserFrictionWithState
from presswear.tools.arrays import Array
from presswear.tools.compile import Records
from presswear.tools.errors import unknown


class FrictionText(Protocol):
    """Friction law that writes its expressions into the equations of a contact."""

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
    prefix: str  # prefix of the variables of the joint
    law: FrictionLaw
    record: Records  # dtype FRICTION
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


def _law(name: str) -> LawWithSettings:
    law: LawWithSettings = import_module(f"presswear.physics.interactions.{name}").LAW
    return law


LAWS_WITH_SETTINGS = {name: _law(name) for name in WITH_SETTINGS}
"""Friction laws of ``linkage.friction_settings`` by name: ``LAW`` of the file with this name."""

FRICTION_KERNELS = (
    *FrictionWithoutState.kernels,
    *(kernel for law in LAWS_WITH_SETTINGS.values() for kernel in law.kernels),
)


def friction_of(
    page: Page, prefix: str, joint: int, law: FrictionLaw, record: Records
) -> FrictionText:
    """Return the friction law of a joint; its variables in the text begin with ``prefix``."""
    if law.name not in FRICTIONS:
        raise unknown("friction law", law.name, FRICTIONS)
    if law.user_law is not None and has_state(law.user_law):
        return UserFrictionWithState(page, prefix, joint, law)
    functions = LAWS_WITH_SETTINGS.get(law.name)
    if functions and law.coefficient > 0.0:
        return FrictionWithSettings(page, prefix, joint, law, functions)
    return FrictionWithoutState(page, prefix, law, record)


def steady_friction(law: FrictionLaw, sliding: Array, normal: Array) -> Array:
    """Return the friction of steady sliding, N; speeds, m/s, and forces, N, are (n,)."""
    if law.user_law is not None and has_state(law.user_law):
        return UserFrictionWithState.steady_force(law, sliding, normal)
    if law.name in LAWS_WITH_SETTINGS:
        return LAWS_WITH_SETTINGS[law.name].steady_force(law, sliding, normal)
    return FrictionWithoutState.steady_force(law, sliding, normal)
