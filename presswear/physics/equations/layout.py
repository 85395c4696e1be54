"""Order of the numbers in the state vector of the equations of motion.

First come the coordinates, then their rates, then the states of interactions, such as
the deflection of bristles. Integrals over time are last: the energies of the ledger,
two wear integrals of each clearance joint, and four integrals of each drive.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from presswear.tools.arrays import Array

# Energies of the ledger, J
ENERGIES = (
    "drive_work",  # work of all drives
    "drive_exchange",  # integral of the absolute power of all drives
    "load_work",  # work of loads with a law, less the losses in dampers
    "contact_loss",
    "friction_loss",
    "created",  # created by normal forces that have no potential
)
DRIVE_WORK, DRIVE_EXCHANGE, LOAD_WORK, CONTACT_LOSS, FRICTION_LOSS, CREATED = range(6)
# Wear integrals of a joint: integrals of F_n ds, N m, and of p ds, N/m, with the normal force
# F_n, the pressure p and the sliding distance s
WEAR_INTEGRAL_NAMES = ("work", "pressure")
WORK, PRESSURE = range(2)
WEAR_INTEGRAL_COUNT = len(WEAR_INTEGRAL_NAMES)
# Integrals of a drive over time: torque, its square, power, its square; SI units
TORQUE, TORQUE_SQUARE, POWER, POWER_SQUARE, TORQUE_INTEGRALS = range(5)


class State(NamedTuple):
    """Continuous state of an interaction: a length whose rate the engines integrate."""

    name: str  # name of its variable in the equations
    scale: float  # smallest change that matters, m
    # number of the clearance joint whose touchdown changes the rate; -1: none
    joint: int = -1
    # returns the initial value, m, from the positions of all bodies; None: zero
    at_start: Callable[[Array], float] | None = None


def initial_states(states: Sequence[State], position: Array) -> Array:
    """Return the initial values of states, m, from the positions of all bodies, (3 bodies,)."""
    values = np.zeros(len(states))
    for i, state in enumerate(states):
        if state.at_start is not None:
            values[i] = state.at_start(position)
    return values


class Layout(NamedTuple):
    """Indices at which groups of numbers begin in the state vector; kernels read it, too."""

    coordinates: int  # number of coordinates, and also of their rates
    first_state: int  # index of the first state of an interaction
    first_energy: int
    first_wear_integral: int
    first_torque: int  # index of the first integral of a drive
    size: int  # length of the state vector


def layout_of(coordinates: int, states: int, joints: int, drives: int) -> Layout:
    """Return the layout from the numbers of coordinates, states, joints and drives."""
    first_state = 2 * coordinates
    first_energy = first_state + states
    first_wear_integral = first_energy + len(ENERGIES)
    first_torque = first_wear_integral + WEAR_INTEGRAL_COUNT * joints
    size = first_torque + TORQUE_INTEGRALS * drives
    return Layout(
        coordinates, first_state, first_energy, first_wear_integral, first_torque, size
    )
