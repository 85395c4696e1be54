"""Inverse dynamics: joint forces and drive torques of the ideal motion."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.clearance_joint import Bushing
from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import OverPosition, OverTime
from presswear.linkage.loads import Force, Moment
from presswear.linkage.points import GROUND
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.ideal import IdealMotion, Motion
from presswear.physics.interactions.friction import steady_friction
from presswear.physics.packed import pack
from presswear.physics.packed_loads import load_forces, pack_loads
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.quantities import written

# Instants of a cycle at which a torque is compared with its limit: 16 in a degree
_INSTANTS = 8 * 720
# Largest change of friction moments in the last iteration, over the largest moment
FRICTION_TOL = 1e-12
MAX_ITERATIONS = 50  # iterations of Newton's method for friction moments


def needed_torques(
    linkage: Linkage, ideal: IdealMotion, time: Array, bushings: Sequence[Bushing] = ()
) -> Array:
    """Return the torques of the drives with all joints closed, shape (n, drives), N m.

    They are the multipliers of the constraint rows of the drives, with inertia, weights,
    springs, loads and the friction of ``bushings``; see ``forces_in_motion``.
    """
    return constraint_forces(linkage, ideal, time, bushings)[:, -len(linkage.drives) :]


def constraint_forces(
    linkage: Linkage, ideal: IdealMotion, time: Array, bushings: Sequence[Bushing] = ()
) -> Array:
    """Return the forces that hold the constraint rows at times, s; see ``forces_in_motion``."""
    return forces_in_motion(linkage, ideal, ideal.at(time), bushings)


def forces_in_motion(
    linkage: Linkage,
    ideal: IdealMotion,
    motion: Motion,
    bushings: Sequence[Bushing] = (),
) -> Array:
    """Return the forces and torques that hold the constraint rows, shape (n, rows), N and N m.

    ``motion`` is ``ideal`` at some instants. The modes of loads are followed from the
    first of these instants on.

    Parameters
    ----------
    bushings : sequence of ClearanceJoint or Revolute
        Bearings whose friction acts in the rigid joints of the same name. The moment
        mu F r is opposite to the relative angular velocity; F is the joint force and r
        the radius of the bearing. The sliding speed is r times the relative angular
        velocity.

    Raises
    ------
    RunFailed
        If friction blocks the motion: no forces are in equilibrium.
    """
    packed = pack(linkage)
    needed = packed.mass * motion.acceleration
    needed -= packed.weight
    states = np.array([motion.position, motion.velocity, motion.acceleration])
    needed -= load_forces(packed.loads, motion.time, states)
    if linkage.springs:
        without_loads = replace(linkage, loads=linkage.constant_loads)
        forces = BodyForces(
            without_loads, packed._replace(loads=pack_loads(without_loads))
        )
        for k, t in enumerate(motion.time):
            needed[k] -= forces(t, motion.position[k], motion.velocity[k])
    body_positions = motion.position.reshape(motion.time.size, -1, 3)
    forces_of = partial(ideal.rows.forces, body_positions)
    reactions = forces_of(needed[..., np.newaxis])[..., 0]
    rubbing = [joint for joint in bushings if joint.friction.coefficient > 0.0]
    if not rubbing:
        return reactions
    return _Friction(linkage, motion, rubbing, forces_of).with_friction(reactions)


def relative_spins(
    linkage: Linkage, motion: Motion, joints: Sequence[Bushing]
) -> tuple[NDArray[np.int64], Array]:
    """Return columns of the angles of pins and bearings, and relative angular velocities, rad/s.

    The shapes are (joints, 2), with -1 for the frame, and (joints, n).
    """
    columns = np.full((len(joints), 2), -1, np.int64)
    for k, joint in enumerate(joints):
        for side, end in enumerate((joint.pin, joint.bearing)):
            if end.body != GROUND:
                columns[k, side] = 3 * linkage.index(end.body) + 2
    # The last column is that of the frame.
    at_rest = np.zeros((motion.time.size, 1))
    velocity = np.concatenate([motion.velocity, at_rest], axis=1).T
    return columns, velocity[columns[:, 0]] - velocity[columns[:, 1]]


class _Friction:
    """Friction moments of rigid pin joints in the ideal motion, and the changed joint forces.

    The moments depend on the joint forces, and the joint forces on the moments. Newton's
    method solves m = c |F_0 - D m| for the moments m. c is the moment of a joint force
    of 1 N, F_0 are the forces without friction, and D are the forces of unit moments.
    """

    def __init__(
        self,
        linkage: Linkage,
        motion: Motion,
        joints: Sequence[Bushing],
        forces_of: Callable[[Array], Array],
    ) -> None:
        self._joints = joints
        self._motion = motion
        columns, self._spin = relative_spins(linkage, motion, joints)
        names = [revolute.name for revolute in linkage.revolutes]
        self._rows = np.array([2 * names.index(joint.name) for joint in joints])
        coordinates = 3 * len(linkage.bodies)
        units = np.zeros((coordinates, len(joints)))
        for k, (pin, bearing) in enumerate(columns):
            if pin >= 0:
                units[pin, k] += 1.0
            if bearing >= 0:
                units[bearing, k] -= 1.0
        shape = (motion.time.size, coordinates, len(joints))
        # Change of all multipliers by unit moments on the pins, (n, rows, joints)
        self._changes = forces_of(np.broadcast_to(units, shape))

    def _moments_of(self, size: Array) -> Array:
        """Return the moments on the pins under joint forces, (n, joints), N and N m."""
        moments = np.zeros_like(size)
        for k, joint in enumerate(self._joints):
            radius = joint.bearing_radius
            normal = np.ascontiguousarray(size[:, k])
            sliding = radius * self._spin[k]
            friction = steady_friction(joint.friction, sliding, normal)
            moments[:, k] = radius * friction
        return moments

    def with_friction(self, reactions: Array) -> Array:
        """Return multipliers with friction from those without, (n, rows)."""
        pairs = self._rows[:, np.newaxis] + np.arange(2)
        changes = self._changes[:, pairs]  # (n, joints, 2, joints)
        size = np.linalg.norm(reactions[:, pairs], axis=2)
        moments = self._moments_of(size)
        for _ in range(MAX_ITERATIONS):
            total = reactions - np.einsum("nrj,nj->nr", self._changes, moments)
            force = total[:, pairs]
            size = np.linalg.norm(force, axis=2)
            friction = self._moments_of(size)
            error = moments - friction
            scale = np.abs(friction).max(axis=1, initial=0.0, keepdims=True)
            if np.all(np.abs(error) <= FRICTION_TOL * scale):
                return np.asarray(total)
            # Moment of 1 N, and direction of the joint force; 0 for a force of zero
            per_force = _quotient(friction, size)
            direction = _quotient(force, size[..., np.newaxis])
            size_changes = np.einsum("nkc,nkcj->nkj", direction, changes)
            slope = per_force[..., np.newaxis] * size_changes
            matrix = np.eye(len(self._joints)) + slope
            moments = moments - np.linalg.solve(matrix, error[..., np.newaxis])[..., 0]
        worst = int((np.abs(error) - FRICTION_TOL * scale).max(axis=1).argmax())
        raise RunFailed(
            f"friction blocks the motion of rigid joints at t = {self._motion.time[worst]:.6g} s: "
            "no joint forces hold it"
        )


def _quotient(dividend: Array, divisor: Array) -> Array:
    """Return a quotient of arrays, 0 where the divisor is 0."""
    zeros = np.zeros_like(dividend)
    return np.divide(dividend, divisor, out=zeros, where=divisor > 0.0)


def friction_corners(
    linkage: Linkage, ideal: IdealMotion, time: Array, bushings: Sequence[Bushing]
) -> Array:
    """Return the instants at which friction in rigid joints has a corner, shape (k,), s.

    At a corner the sliding speed passes an end of the ramp. ``time``, s, must resolve
    the motion.
    """
    rubbing = [joint for joint in bushings if joint.friction.coefficient > 0.0]
    instants = [np.zeros(0)]
    _, spins = relative_spins(linkage, ideal.at(time), rubbing)
    for joint, spin in zip(rubbing, spins, strict=True):
        law = joint.friction
        for corner in (-law.upper, -law.lower, law.lower, law.upper):
            excess = joint.bearing_radius * spin - corner
            k = np.flatnonzero(excess[1:] * excess[:-1] < 0.0)
            slope = np.diff(excess)[k]
            instants.append(time[k] - excess[k] * np.diff(time)[k] / slope)
    return np.concatenate(instants)


def load_corners(linkage: Linkage, ideal: IdealMotion, time: Array) -> Array:
    """Return the instants at which the table of a load has a corner in the ideal motion.

    The shape is (k,), s. Instants are between the first and the last of ``time``, s,
    which must resolve the motion.
    """
    if not linkage.loads_with_law:
        return np.zeros(0)
    from scipy.interpolate import CubicHermiteSpline  # slow to import

    motion = ideal.at(time)
    corners = [np.zeros(0)]
    for load in linkage.loads_with_law:
        if isinstance(load.law, OverTime):
            period = linkage.period if load.law.period is None else load.law.period
            turns = time[-1] / period if period > 0.0 else 0.0
            starts = period * np.arange(turns + 1.0)
            for node, _ in load.law.table:
                corners.append(starts + node)
        elif isinstance(load.law, OverPosition):
            place, speed = _load_motion(linkage, motion, load)
            curve = CubicHermiteSpline(time, place - load.law.zero, speed)
            for node, _ in load.law.table:
                instants = curve.solve(node, discontinuity=False, extrapolate=False)
                corners.append(instants)
    instants = np.concatenate(corners)
    return np.asarray(instants[(instants >= time[0]) & (instants <= time[-1])])


def _load_motion(
    linkage: Linkage, motion: Motion, load: Force | Moment
) -> tuple[Array, Array]:
    """Return position and speed along a load, shape (n,), m and m/s or rad and rad/s."""
    if isinstance(load, Force):
        along = motion.of_point(linkage, load.attachment, load.direction)
        return along[:, 0], along[:, 1]
    column = 3 * linkage.index(load.body) + 2
    return motion.position[:, column], motion.velocity[:, column]


def check_drives(
    linkage: Linkage, ideal: IdealMotion, bushings: Sequence[Bushing] = ()
) -> None:
    """Raise InputError if a drive needs more than its torque limit in the second cycle.

    Drives with a motor are not checked, because a servo saturates at its limit. Joints
    are rigid, with the friction of ``bushings``; see ``forces_in_motion``.
    """
    start = linkage.run_up_time
    time = np.linspace(start, start + 2.0 * ideal.period, 2 * _INSTANTS + 1)
    time = np.union1d(time, load_corners(linkage, ideal, time))
    time = np.union1d(time, friction_corners(linkage, ideal, time, bushings))
    # The modes of loads are followed through the first cycle.
    is_second = time >= start + ideal.period
    torques = needed_torques(linkage, ideal, time, bushings)[is_second]
    time = time[is_second]
    for drive, torque in zip(linkage.drives, torques.T, strict=True):
        if drive.torque_limit is None or drive.motor is not None:
            continue
        k = int(np.abs(torque).argmax())
        peak = abs(torque[k])
        if not peak <= drive.torque_limit:  # NaN is refused, too
            angle = 360.0 * (time[k] - start) / ideal.period % 360.0
            raise InputError(
                f"torque_limit of {drive.body} = {written(drive.torque_limit, 'N m')}: the ideal "
                f"motion needs {written(peak, 'N m')}, at {angle:.4g} degrees of a cycle"
            )
