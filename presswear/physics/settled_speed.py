"""Speed at which a motor settles, from which a run starts."""

import math
from collections.abc import Sequence

import numpy as np

from presswear.linkage.clearance_joint import Bushing
from presswear.linkage.drives import Drive
from presswear.linkage.linkage import Linkage
from presswear.linkage.motor import Motor
from presswear.physics.ideal import IdealMotion
from presswear.physics.inverse_dynamics import load_corners, needed_torques
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.quantities import written

# Instants of the cycle over which a torque is averaged, without corners of loads
_INSTANTS = 2880
# Instants of the first cycle, at whose end the loads have their modes
_INSTANTS_BEFORE = 360


def settled_rate(
    linkage: Linkage, ideal: IdealMotion, bushings: Sequence[Bushing] = ()
) -> float:
    """Return the settled speed of the leader over its nominal speed.

    At the settled speed the motor gives the mean torque of the ideal inverse dynamics,
    so that T omega equals the mean power at this speed. A free crank and a user law
    start at the nominal speed. Where friction blocks the motion of rigid joints, the
    torque is that without friction.

    Parameters
    ----------
    bushings : sequence of ClearanceJoint or Revolute
        Bearings whose friction acts in the rigid joints.

    Raises
    ------
    InputError
        If the motor is too weak.
    """
    leader = linkage.leader
    if leader is None or leader.motor is None or not leader.motor.has_slip:
        return 1.0
    number = linkage.drives.index(leader)
    try:
        torque = mean_torque(linkage, ideal, number, bushings)
    except RunFailed:
        torque = mean_torque(linkage, ideal, number)
    torque *= math.copysign(1.0, leader.speed)
    slip = slip_at(leader.motor, torque, leader)
    return (1.0 - slip) * leader.no_load_speed / leader.speed


def mean_torque(
    linkage: Linkage,
    ideal: IdealMotion,
    number: int,
    bushings: Sequence[Bushing] = (),
) -> float:
    """Return the mean torque of a drive in the second cycle of the ideal motion, N m."""
    start = linkage.run_up_time
    second = start + ideal.period
    before = np.linspace(start, second, _INSTANTS_BEFORE, endpoint=False)
    time = np.append(before, np.linspace(second, second + ideal.period, _INSTANTS + 1))
    time = np.union1d(time, load_corners(linkage, ideal, time))
    torque = needed_torques(linkage, ideal, time, bushings)[:, number]
    is_second = time >= second
    work = np.trapezoid(torque[is_second], time[is_second])
    return float(work / ideal.period)


def slip_at(motor: Motor, torque: float, drive: Drive) -> float:
    """Return the slip at which a motor gives a torque on the body of its drive, N m.

    Kloss's equation has two solutions. The result is the slip below breakdown, at which
    the motor runs stably.

    Raises
    ------
    InputError
        If the torque is at or above the largest torque of the motor.
    """
    assert motor.torque is not None
    rated = motor.ratio * motor.torque
    ratio = torque / rated
    greatest = motor.breakdown or 1.0 / motor.slip
    if abs(ratio) >= greatest:
        raise InputError(
            f"torque of the motor of {drive.body} = {written(motor.torque, 'N m')}: the ideal "
            f"motion needs {written(torque, 'N m')} in the mean at {drive.body}, and the motor "
            f"gives {written(greatest * rated, 'N m')} there at most; a larger torque or ratio "
            "is needed"
        )
    if motor.breakdown_slip is None:
        return motor.slip * ratio
    root = greatest + math.sqrt(greatest * greatest - ratio * ratio)
    return motor.breakdown_slip * ratio / root
