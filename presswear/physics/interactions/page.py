"""Page on which interactions write their terms of the equations of motion."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol, Self

from presswear.linkage.linkage import Linkage
from presswear.physics.equations.chain import Chain
from presswear.physics.equations.layout import (
    ENERGIES,
    TORQUE_INTEGRALS,
    WEAR_INTEGRAL_NAMES,
    Layout,
    State,
    layout_of,
)
from presswear.physics.equations.text import Text, square, total
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array

Kernels = tuple[Callable[..., Any], ...]


@dataclass
class Page:
    """Equations of motion while they are being written."""

    text: Text
    chain: Chain
    states: list[State] = field(default_factory=list)  # states of interactions
    # expressions of powers, W, by energy of ENERGIES
    powers: dict[str, list[str]] = field(
        default_factory=lambda: {name: [] for name in ENERGIES}
    )
    # expression of a rate, by number of the joint and name in WEAR_INTEGRAL_NAMES
    wear_rates: dict[tuple[int, str], str] = field(default_factory=dict)
    # expressions of torque and power of a motor, by the number of its drive
    torques: dict[int, tuple[str, str]] = field(default_factory=dict)

    def add_state(self, state: State) -> int:
        """Declare a state of an interaction; return its index in ``y`` and in ``out``."""
        self.states.append(state)
        return 2 * self.chain.size + len(self.states) - 1

    def add_power(self, energy: str, expression: str) -> None:
        """Add a power, W, to one of ENERGIES."""
        self.powers[energy].append(expression)

    def set_wear_rate(self, joint: int, integral: str, expression: str) -> None:
        """Set the rate of an integral in WEAR_INTEGRAL_NAMES of a joint."""
        self.wear_rates[joint, integral] = expression

    def set_torque(self, drive: int, torque: str, power: str) -> None:
        """Set the torque of a motor, N m, and its power, W, by the number of its drive."""
        self.torques[drive] = torque, power
        self.add_power("drive_work", power)
        self.add_power("drive_exchange", f"abs({power})")

    @property
    def layout(self) -> Layout:
        """Layout of the state vector with the states that have been declared so far."""
        linkage = self.chain.linkage
        return layout_of(
            coordinates=self.chain.size,
            states=len(self.states),
            joints=len(linkage.clearances),
            drives=len(linkage.drives),
        )

    @property
    def has_rates(self) -> bool:
        """True if there is a rate to write."""
        return bool(self.wear_rates or self.torques) or any(self.powers.values())

    def write_rates(self) -> None:
        """Write the rates of all integrals; an energy without powers has the rate zero."""
        layout = self.layout
        for i, powers in enumerate(self.powers.values()):
            if powers:
                self.text.write(f"out[{layout.first_energy + i}] = {total(*powers)}")
        for (joint, integral), rate in self.wear_rates.items():
            first = layout.first_wear_integral + len(WEAR_INTEGRAL_NAMES) * joint
            index = first + WEAR_INTEGRAL_NAMES.index(integral)
            self.text.write(f"out[{index}] = {rate}")
        for drive, (torque, power) in self.torques.items():
            write_torque(self.text, layout, drive, torque, power)


def write_torque(
    text: Text, layout: Layout, drive: int, torque: str, power: str
) -> None:
    """Write the rates of the integrals of the torque of a drive and of its power."""
    first = layout.first_torque + TORQUE_INTEGRALS * drive
    for i, rate in enumerate((torque, square(torque), power, square(power))):
        text.write(f"out[{first + i}] = {rate}")


class Interaction(Protocol):
    """Forces between two bodies, or on one body."""

    kernels: ClassVar[Kernels]  # compiled functions that its text calls

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all interactions of this kind in a linkage; ``packed`` is the packed linkage."""
        ...

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies on which it acts, including the frame."""
        ...

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return the energy stored by all interactions of this kind, J, from all positions."""
        ...

    def write(self, page: Page) -> None:
        """Write forces and moments on the bodies; declare states, powers and rates of wear.

        Rates of integrals are only needed at level RATES, recorded quantities only at
        level END.
        """
        ...
