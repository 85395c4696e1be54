"""Inverse dynamics: torques of the drives of an ideal mechanism, and forces in its joints."""

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.physics.applied import applied_forces, settle_modes
from presswear.physics.ideal import IdealMotion
from presswear.physics.load_modes import place_loads
from presswear.physics.packed import pack
from presswear.tools.errors import InputError

Array = NDArray[np.float64]

_INSTANTS = 8 * 720
"""Of a cycle at which a torque is compared with its limit."""


def needed_torques(linkage: Linkage, ideal: IdealMotion, time: Array) -> Array:
    """Torques of the drives, all joints closed, at rising instants, shape (n, drives), N m.

    With inertia, weights, springs and loads: the multipliers of the drives' constraint rows.

    Parameters
    ----------
    linkage : Linkage
        The ideal one, with its loads.
    time : ndarray, shape (n,)
        s; laws of loads that depend on the way are followed from the first instant.
    """
    return _multipliers(linkage, ideal, time)[:, -len(linkage.drives) :]


def joint_forces(linkage: Linkage, ideal: IdealMotion, time: Array) -> dict[str, Array]:
    """Forces of pin joints on their first ends by name, each (n, 2), N; as ``needed_torques``."""
    multipliers = _multipliers(linkage, ideal, time)
    return {
        joint.name: multipliers[:, 2 * k : 2 * k + 2] for k, joint in enumerate(linkage.revolutes)
    }


def _multipliers(linkage: Linkage, ideal: IdealMotion, time: Array) -> Array:
    """Forces and torques that hold the constraint rows, shape (n, rows), N and N m."""
    motion, packed = ideal.at(time), pack(linkage)
    right = packed.mass * motion.acceleration
    if packed.loads is not None:
        place_loads(packed.loads, motion.position[0], motion.velocity[0])
    force = np.zeros(packed.mass.size)
    levels = zip(motion.position, motion.velocity, motion.acceleration, strict=True)
    for k, (t, level) in enumerate(zip(time, levels, strict=True)):
        settle_modes(packed, t, *level)
        applied_forces(packed, t, *level[:2], force)
        right[k] -= force
    jacobian = ideal.rows.jacobian(motion.position.reshape(time.size, -1, 3))
    return np.asarray(np.linalg.solve(jacobian.transpose(0, 2, 1), right[..., np.newaxis])[..., 0])


def check_drives(linkage: Linkage, ideal: IdealMotion) -> None:
    """InputError where a drive needs more torque than it gives, in the second cycle at speed."""
    begin = linkage.run_up_time
    time = np.linspace(begin, begin + 2.0 * ideal.period, 2 * _INSTANTS + 1)
    torques = needed_torques(linkage, ideal, time)[_INSTANTS:]
    for drive, own in zip(linkage.drives, torques.T, strict=True):
        place = int(np.abs(own).argmax())
        if drive.torque_limit is not None and not abs(own[place]) <= drive.torque_limit:
            raise InputError(
                f"torque_limit of {drive.body} = {drive.torque_limit:g} N m: the ideal motion "
                f"needs {abs(own[place]):.6g} N m, {1e3 * (time[place] - time[0]):.6g} ms into "
                "a cycle"
            )
