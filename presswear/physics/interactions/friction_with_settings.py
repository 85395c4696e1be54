"""Friction laws with settings and a state: their functions, and their text in a contact."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from presswear.linkage.friction_law import FrictionLaw
from presswear.physics.equations.layout import State
from presswear.physics.interactions.page import Kernels, Page
from presswear.tools.arrays import Array


class LawWithSettings(NamedTuple):
    """A friction law with settings and a state, such as the deflection of bristles."""

    numbers: type  # named tuple of the numbers that both kernels read
    numbers_of: Callable[[FrictionLaw], Any]  # returns this tuple
    state: str  # name of the state in the equations
    # smallest change of the state that matters, m, as a function of the numbers
    scale: Callable[[Any], float]
    # rate of the state, m/s: kernel of sliding, state, is_closed and the numbers
    rate: Callable[..., float]
    # force along the sliding, N, negative at a positive speed: kernel of normal force,
    # sliding, state, rate of the state and the numbers
    force: Callable[..., float]
    # friction of steady sliding, N, of law, sliding and normal force, both (n,)
    steady_force: Callable[[FrictionLaw, Array, Array], Array]

    @property
    def kernels(self) -> Kernels:
        """Functions that the text calls."""
        return self.numbers, self.rate, self.force


@dataclass
class FrictionWithSettings:
    """Friction law with settings and a state in the text of a contact."""

    page: Page
    prefix: str  # prefix of the variables of the joint
    joint: int  # index among the clearance joints
    law: FrictionLaw
    functions: LawWithSettings
    sliding: str = ""

    has_state: ClassVar[bool] = True

    @property
    def _state(self) -> str:
        """Name of the state in the text."""
        return f"{self.prefix}_{self.functions.state}"

    @property
    def _numbers(self) -> str:
        """Text that makes the named tuple of the numbers of the law."""
        numbers = self.functions.numbers_of(self.law)
        names = (
            self.page.text.parameter(f"{self.prefix}_friction_{word}", number)
            for word, number in numbers._asdict().items()
        )
        return f"{type(numbers).__name__}({', '.join(names)})"

    def write_state(self, sliding: str, is_closed: str) -> None:
        """Write the rate of the state."""
        self.sliding = sliding
        text = self.page.text
        functions = self.functions
        name = self._state
        scale = functions.scale(functions.numbers_of(self.law))
        place = self.page.add_state(State(name, scale, self.joint))
        state = text.let(name, f"y[{place}]")
        arguments = f"{sliding}, {state}, {is_closed}, {self._numbers}"
        rate = text.let(f"{name}_rate", f"{functions.rate.__name__}({arguments})")
        text.write(f"out[{place}] = {rate}")

    def force(self, normal: str) -> str:
        """Return the call of the law."""
        arguments = f"{normal}, {self.sliding}, {self._state}, {self._state}_rate"
        return f"{self.functions.force.__name__}({arguments}, {self._numbers})"
