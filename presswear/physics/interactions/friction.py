"""Friction laws of a contact in the written equations."""

from dataclasses import dataclass
from typing import ClassVar, Protocol

from presswear.linkage.laws import FrictionLaw
from presswear.physics.friction_and_normal import FRICTION_FORCES
from presswear.physics.interactions.lugre import LuGre
from presswear.physics.interactions.page import Kernels, Page
from presswear.tools.compile import Records


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


def friction_of(
    page: Page, prefix: str, joint: int, law: FrictionLaw, record: Records
) -> FrictionText:
    """Return the friction law of a joint; its variables in the text begin with ``prefix``."""
    if record["bristle_stiffness"] > 0.0:
        return LuGre(page, prefix, joint, record)
    return FrictionWithoutState(page, prefix, law, record)


FRICTION_KERNELS = (*FrictionWithoutState.kernels, *LuGre.kernels)
