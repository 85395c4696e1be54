"""Places of the integrals in the state of the equations, behind coordinates and rates.

They are the work of the drives and its absolute value, six integrals of each clearance joint
(``forces.JOINT_RATES``), four of each drive, and the work of loads and dampers if there is any.
"""

from presswear.physics.forces import BRISTLE, JOINT_RATES
from presswear.tools.compile import inlined

DRIVE_WORK, DRIVE_EXCHANGE, DRIVE_INTEGRALS = range(3)  # of all drives, J, and their number
TORQUE, TORQUE_SQUARE, POWER, POWER_SQUARE, TORQUE_INTEGRALS = range(5)  # per drive, their number


@inlined
def bristle_place(coordinates: int, k: int) -> int:
    """Return the place in the state of the deflection of the bristles of joint ``k``.

    ``coordinates`` is the number of coordinates and rates.
    """
    return coordinates + DRIVE_INTEGRALS + JOINT_RATES * k + BRISTLE
