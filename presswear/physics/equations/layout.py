"""Places in the state of the equations of motion.

Behind coordinates and rates follow the states of interactions, such as the deflection
of bristles, then integrals: the energies of the ledger, two doses of wear of each
clearance joint, and four integrals of each drive.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from presswear.tools.arrays import Array

# Energies of the ledger, J: work of all drives, its absolute value, of loads less that
# which dampers take; lost in contacts and in friction, and made by the normal law
ENERGIES = (
    "drive_work",
    "drive_exchange",
    "load_work",
    "contact_loss",
    "friction_loss",
    "made",
)
DRIVE_WORK, DRIVE_EXCHANGE, LOAD_WORK, CONTACT_LOSS, FRICTION_LOSS, MADE = range(6)
# Doses of wear of a joint: F_n ds, N m, and p ds, N/m
DOSES = ("work", "pressure")
WORK, PRESSURE = range(2)
DOSE_COUNT = len(DOSES)
# Integrals of a drive over time: of torque and power, and of their squares, SI units
TORQUE, TORQUE_SQUARE, POWER, POWER_SQUARE, TORQUE_INTEGRALS = range(5)


class State(NamedTuple):
    """State of an interaction with a rate, a length."""

    name: str  # in the text
    scale: float  # change that matters, m
    joint: int = -1  # number of the clearance joint whose contact changes its rate
    # its initial value from the positions of all bodies, m; None: zero
    at_start: Callable[[Array], float] | None = None


def initial_states(states: Sequence[State], position: Array) -> Array:
    """Return the initial values of states, m, from the positions of all bodies, (3 bodies,)."""
    values = [
        0.0 if state.at_start is None else state.at_start(position) for state in states
    ]
    return np.array(values, float)


class Layout(NamedTuple):
    """Places of the parts of a state; kernels read it, too."""

    coordinates: int  # number of coordinates, and of their rates
    first_state: int  # of interactions
    first_energy: int
    first_dose: int
    first_torque: int
    size: int


def layout_of(coordinates: int, states: int, joints: int, drives: int) -> Layout:
    """Return the layout for so many coordinates, states of interactions, joints and drives."""
    first_state = 2 * coordinates
    first_energy = first_state + states
    first_dose = first_energy + len(ENERGIES)
    first_torque = first_dose + DOSE_COUNT * joints
    size = first_torque + TORQUE_INTEGRALS * drives
    return Layout(
        coordinates, first_state, first_energy, first_dose, first_torque, size
    )
