"""User friction law with a state: a length, such as the deflection of bristles.

The law has the parameter ``state``, and the function with its name and ``_rate`` in the
same text returns the rate of the state.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from presswear.linkage.friction_law import (
    RATE_PARAMETERS,
    STATE_PARAMETERS,
    FrictionLaw,
    rate_of,
    state_scale,
    steady_state,
)
from presswear.physics.equations.layout import State
from presswear.physics.interactions.page import Page
from presswear.tools.arrays import Array
from presswear.tools.compile import address_of
from presswear.tools.compiled_law import compile_function
from presswear.tools.user_function import UserFunction


@dataclass
class UserFrictionWithState:
    """User law of STATE_PARAMETERS in the text of a contact."""

    page: Page
    prefix: str  # prefix of the variables of the joint
    joint: int  # its number
    law: FrictionLaw
    sliding: str = ""

    has_state: ClassVar[bool] = True

    @property
    def _function(self) -> UserFunction:
        assert self.law.user_law is not None
        return self.law.user_law

    @property
    def _numbers(self) -> str:
        """Coefficient and speeds of the law."""
        numbers = {
            "friction_coefficient": self.law.coefficient,
            "lower_speed": self.law.lower,
            "upper_speed": self.law.upper,
        }
        text = self.page.text
        return ", ".join(
            text.parameter(f"{self.prefix}_{word}", number)
            for word, number in numbers.items()
        )

    def _address(self, word: str, law: UserFunction, names: tuple[str, ...]) -> str:
        address = address_of(compile_function(law, names), len(names))
        name = self.page.text.parameter(f"{self.prefix}_{word}", float(address))
        return f"int({name})"

    def write_state(self, sliding: str, is_closed: str) -> None:
        """Write the rate of the state."""
        text = self.page.text
        name = f"{self.prefix}_state"
        scale = state_scale(self._function)
        place = self.page.add_state(State(name, scale, self.joint))
        self.sliding = sliding
        state = text.let(name, f"y[{place}]")
        rate = rate_of(self._function)
        address = self._address("friction_rate", rate, RATE_PARAMETERS)
        closed = f"1.0 if {is_closed} else 0.0"
        arguments = f"{sliding}, {self._numbers}, {state}, {closed}"
        text.write(f"out[{place}] = call({address}, ({arguments}))")

    def force(self, normal: str) -> str:
        """Return the call of the law."""
        address = self._address("friction_law", self._function, STATE_PARAMETERS)
        state = f"{self.prefix}_state"
        return f"call({address}, ({self.sliding}, {normal}, {self._numbers}, {state}))"

    @staticmethod
    def steady_force(law: FrictionLaw, sliding: Array, normal: Array) -> Array:
        """Return the friction of steady sliding, N, shape (n,), where the state is constant."""
        function = law.user_law
        assert function is not None
        numbers = {
            "coefficient": law.coefficient,
            "lower_speed": law.lower,
            "upper_speed": law.upper,
        }
        forces = []
        for speed, load in zip(sliding, normal, strict=True):
            state = {**numbers, "sliding": float(speed), "normal": float(load)}
            state["state"] = steady_state("friction_law", function, state)
            forces.append(function.evaluate("friction_law", STATE_PARAMETERS, state))
        return np.array(forces)
