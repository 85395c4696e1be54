"""Places of coordinates, rates and integrals in the state of the equations.

Behind coordinates and rates follow the work of the drives and its absolute value, the integrals of
each clearance joint (``forces.JOINT_RATES``), four of each drive, and the work of loads and dampers
if there is any.
"""

from dataclasses import dataclass

from presswear.physics.forces import BRISTLE, JOINT_RATES
from presswear.physics.packed import Packed, has_work
from presswear.tools.compile import inlined

DRIVE_WORK, DRIVE_EXCHANGE, DRIVE_INTEGRALS = range(3)  # of all drives, J, and their number
TORQUE, TORQUE_SQUARE, POWER, POWER_SQUARE, TORQUE_INTEGRALS = range(5)  # per drive, their number


@dataclass(frozen=True)
class Layout:
    """Places of the parts of a state."""

    coordinates: int
    joints: int
    drives: int
    has_work: bool  # loads or dampers do work

    @staticmethod
    def of(coordinates: int, packed: Packed) -> "Layout":
        """Return the layout of a linkage."""
        return Layout(coordinates, len(packed.joints), packed.driven.size, has_work(packed))

    @property
    def drive_work(self) -> int:
        """Place of the work of all drives, before that of its absolute value."""
        return 2 * self.coordinates

    @property
    def first_joint(self) -> int:
        """Place of the first integral of the first joint."""
        return self.drive_work + DRIVE_INTEGRALS

    @property
    def first_torque(self) -> int:
        """Place of the first integral of the first drive."""
        return self.first_joint + JOINT_RATES * self.joints

    @property
    def load_work(self) -> int:
        """Place of the work of loads and dampers."""
        return self.first_torque + TORQUE_INTEGRALS * self.drives

    @property
    def size(self) -> int:
        """Number of components."""
        return self.load_work + self.has_work


@inlined
def bristle_place(coordinates: int, k: int) -> int:
    """Return the place in the state of the deflection of the bristles of joint ``k``.

    ``coordinates`` is the number of coordinates and rates.
    """
    return coordinates + DRIVE_INTEGRALS + JOINT_RATES * k + BRISTLE
