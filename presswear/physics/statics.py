"""Linkages at rest under a load, and inverse dynamics of the ideal motion."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import Revolute
from presswear.linkage.linkage import Linkage
from presswear.physics.assembly import ROUND_OFF
from presswear.physics.constraints import constraints_of, lever
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.forces import JOINT_RATES, add_contacts, note_forces
from presswear.physics.ideal import IdealMotion, bottom_of, ideal_motion
from presswear.physics.loads import place_loads
from presswear.physics.packed import applied_forces, pack, settle_modes
from presswear.tools.compile import Records
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.quantities import Quantity

Array = NDArray[np.float64]

_INSTANTS = 8 * 720  # of a cycle at which a torque is compared with its limit


def needed_torques(linkage: Linkage, ideal: IdealMotion, time: Array) -> Array:
    """Return the torques of the drives, all joints closed, shape (n, drives), N m.

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
    """Return the forces of pin joints on their first ends by name, each (n, 2), N."""
    multipliers = _multipliers(linkage, ideal, time)
    return {
        joint.name: multipliers[:, 2 * k : 2 * k + 2] for k, joint in enumerate(linkage.revolutes)
    }


def _multipliers(linkage: Linkage, ideal: IdealMotion, time: Array) -> Array:
    """Return the forces and torques that hold the constraint rows, shape (n, rows), N and N m."""
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
    """Raise InputError where a drive needs more than its torque limit in the second cycle."""
    start = linkage.run_up_time
    time = np.linspace(start, start + 2.0 * ideal.period, 2 * _INSTANTS + 1)
    torques = needed_torques(linkage, ideal, time)[_INSTANTS:]
    for drive, item in zip(linkage.drives, torques.T, strict=True):
        place = int(np.abs(item).argmax())
        if drive.torque_limit is not None and not abs(item[place]) <= drive.torque_limit:
            raise InputError(
                f"torque_limit of {drive.body} = {drive.torque_limit:g} N m: the ideal motion "
                f"needs {abs(item[place]):.6g} N m, {1e3 * (time[place] - time[0]):.6g} ms into "
                "a cycle"
            )


# Force by which a total clearance is told where none is given, N, and over the weight
LEAST_PULL, PULL_OVER_WEIGHT = 100.0, 10.0
_FORCE = Quantity("N", -1e9, 1e9, "", "on the watched point along its direction")
_SIZE = Quantity("N", 0.0, 1e9, "", "on the watched point, either way", open_low=True)

BALANCED = 1e-11  # part of the forces that may be left at rest: of a penetration as much
_STEPS = 2000  # most steps
_FIRST = 1e-6  # first step, s^2: against a unit drag a mass moves by its acceleration times that
# Longest way of a pin in a step, part of its clearance, or of how far it is out of the middle
_STRIDE = 0.25
_NEAR = 0.1  # part of that from which on the next step is chosen by it
_WORSE = 2.0  # growth of what is not balanced by which a step is refused
_LONGER, _SHORTER = 8.0, 0.2  # what comes of a step that was taken, or refused, in the next
_PROBE = 1e-9  # way over which forces are differenced, part of the size of the linkage


@dataclass(frozen=True)
class Equilibrium:
    """A linkage at rest.

    Attributes
    ----------
    position : ndarray, shape (3 bodies,)
    height : float
        Of the watched coordinate, m, in the axes of the frame.
    contacts : records of CONTACT, shape (joints,)
        Pins in their bearings, with their forces.
    """

    position: Array
    height: float
    contacts: Records


class _Held:
    """A linkage whose drives are held, pulled at the watched point.

    Coordinates are scaled by the root of their masses, so that a unit of drag is one of each.
    """

    def __init__(self, linkage: Linkage, time: float, force: float, size: float) -> None:
        self._packed = pack(replace(linkage, loads=linkage.dead_loads))
        self._constraints = constraints_of(linkage)
        self._time, self._pull = time, force
        self._probe = linkage.output
        self._place = 3 * linkage.index(linkage.output.body)
        self._still = np.zeros(self._packed.mass.size)
        self._onset = np.zeros(len(linkage.clearances))
        self._rates = np.zeros(JOINT_RATES * len(linkage.clearances))
        self.scale = np.sqrt(self._packed.mass)
        self.contacts = np.zeros(len(linkage.clearances), CONTACT)
        self._size = size

    def height(self, q: Array) -> float:
        """Place of the watched point along its direction, m."""
        probe, i = self._probe, self._place
        x, y = lever(i, probe.x, probe.y, q)
        return math.cos(probe.direction) * (q[i] + x) + math.sin(probe.direction) * (q[i + 1] + y)

    def given(self, q: Array) -> Array:
        """Return the scaled forces on the bodies without those of contacts."""
        force = np.empty_like(self._still)
        applied_forces(self._packed, self._time, q, self._still, force)
        probe, i = self._probe, self._place
        x, y = lever(i, probe.x, probe.y, q)
        fx, fy = (self._pull * part(probe.direction) for part in (math.cos, math.sin))
        force[i : i + 3] += fx, fy, x * fy - y * fx
        return force / self.scale

    def free(self, q: Array) -> Array:
        """Return the scaled directions that the joints leave free, orthonormal, shape (n, free)."""
        _, _, right = np.linalg.svd(self._jacobian(q)[1])
        return np.asarray(right[self._constraints.rows :].T)

    def _jacobian(self, q: Array) -> tuple[Array, Array]:
        phi, _, _, jacobian = self._constraints.evaluate(self._time, q, self._still)
        return phi, jacobian / self.scale

    def moved(self, q: Array, step: Array) -> Array:
        """Return the position a scaled step away, the joints closed."""
        q = q + step / self.scale
        for _ in range(4):
            phi, jacobian = self._jacobian(q)
            if float(np.abs(phi).max(initial=0.0)) <= ROUND_OFF * self._size:
                break
            q = q - np.linalg.lstsq(jacobian, phi, rcond=None)[0] / self.scale
        return q

    def unbalanced(self, q: Array, basis: Array) -> Array:
        """Return the forces along some directions, as far as they are free here, shape (free,)."""
        force = self.given(q) * self.scale
        note_contacts(self._packed, self.contacts, q, self._still)
        note_forces(self._packed.joints, self._onset, self.contacts)
        add_contacts(self._packed.joints, self._onset, self.contacts, force, self._rates)
        item = self.free(q)
        return np.asarray(basis.T @ (item @ (item.T @ (force / self.scale))))

    def stiffness(self, q: Array, basis: Array) -> Array:
        """Return the stiffness along the directions, by central differences."""
        columns = []
        for direction in basis.T:
            step = _PROBE * self._size / float(np.abs(direction / self.scale).max()) * direction
            ahead, behind = (
                self.unbalanced(self.moved(q, sign * step), basis) for sign in (1.0, -1.0)
            )
            columns.append((behind - ahead) / (2.0 * float(np.linalg.norm(step))))
        return np.column_stack(columns)

    def is_still(self, basis: Array, stiffness: Array, left: Array) -> bool:
        """Return whether a Newton step would be round-off and balance the rest."""
        way = np.linalg.lstsq(stiffness, left, rcond=1e-12)[0]
        far = float(np.abs(basis @ way / self.scale).max())
        rest = float(np.linalg.norm(left - stiffness @ way))
        return far <= ROUND_OFF * self._size and rest <= 0.5 * float(np.linalg.norm(left))

    def pins(self) -> Array:
        """Return the last eccentricities, shape (joints, 2), m."""
        names = ("eccentricity_x", "eccentricity_y")
        return np.column_stack([self.contacts[name] for name in names])


def closed(linkage: Linkage) -> Linkage:
    """Return the linkage with ideal joints in place of those with clearance."""
    pins = (Revolute(item.name, item.bearing, item.pin) for item in linkage.clearances)
    return replace(linkage, joints=(*linkage.joints, *pins), clearances=())


def equilibrium(linkage: Linkage, time: float, force: float = 0.0) -> Equilibrium:
    """Return a linkage at rest, its drives held where they are at a time.

    Parameters
    ----------
    time : float
        Since the start, s.
    force : float
        On the watched point along its direction, N.

    Raises
    ------
    RunFailed
        Where it does not come to rest.
    """
    ideal = ideal_motion(closed(linkage), linkage.period)
    q = ideal.at(np.array([time])).position[0]
    held = _Held(linkage, time, force, ideal.rows.size)
    basis = held.free(q)
    if not basis.size:
        return Equilibrium(q, held.height(q), held.contacts)
    clearance = np.array([item.clearance for item in linkage.clearances])
    left, before = held.unbalanced(q, basis), held.pins()
    stiffness = held.stiffness(q, basis)
    step = _FIRST
    for _ in range(_STEPS):
        off = float(np.linalg.norm(left))
        if off <= BALANCED * float(np.linalg.norm(held.given(q))) or held.is_still(
            basis, stiffness, left
        ):
            held.unbalanced(q, basis)
            return Equilibrium(q, held.height(q), held.contacts)
        way = np.linalg.solve(np.eye(left.size) / step + stiffness, left)
        there = held.moved(q, basis @ way)
        residual = held.unbalanced(there, basis)
        allowed = _STRIDE * np.maximum(clearance, np.hypot(*before.T))
        part = float((np.hypot(*(held.pins() - before).T) / allowed).max())
        if part > 1.0 or not float(np.linalg.norm(residual)) < _WORSE * off:
            step *= 0.9 / part if part > 1.0 else _SHORTER
            continue
        q, before = there, held.pins()
        basis = held.free(q)
        left, stiffness = held.unbalanced(q, basis), held.stiffness(q, basis)
        # Where steps are short, ways are as long as they are.
        step *= min(_LONGER, max(0.9 / part, 1.0)) if part > _NEAR else _LONGER
    raise RunFailed(
        f"{linkage.name} does not come to rest under {force:g} N: {off:.3g} of its forces are "
        f"left after {_STEPS} steps"
    )


def heights_at_bottom(linkage: Linkage, forces: Sequence[float]) -> Array:
    """Return heights at bottom dead centre under static forces, m, the drives held there.

    Raises
    ------
    InputError
        Where the watched coordinate stands.
    RunFailed
        Where the linkage does not come to rest.
    """
    bottom = bottom_of(ideal_motion(closed(linkage), linkage.period))
    if bottom is None:
        raise InputError(f"{linkage.name} has no bottom dead centre: what it watches stands still")
    time = linkage.run_up_time + linkage.period + bottom.time
    return np.array([equilibrium(linkage, time, force).height for force in forces])


def pull_of(linkage: Linkage) -> float:
    """Return the default force for a total clearance, N: more than the weight."""
    weight = abs(linkage.gravity) * sum(body.mass for body in linkage.bodies)
    return max(LEAST_PULL, PULL_OVER_WEIGHT * weight)


def total_clearance(linkage: Linkage, force: float | None = None) -> float:
    """Return the total clearance at bottom dead centre, m (JIS B 6402).

    The watched body is pulled up and down, the drives held: what its heights differ by is the
    play of all joints on the way of the load, worn surfaces included, and what they give under
    the force. Weight acts, so that the force has to be larger than what hangs.

    Parameters
    ----------
    linkage : Linkage
        With clearance; on the surfaces of a stage it is ``scene.linkage(stage.surfaces)``.
    force : float or None
        By which it is pulled either way, N; None: 100 N, or ten times the weight of all bodies
        where that is more.

    Raises
    ------
    InputError
        For a force out of range, and where the watched coordinate stands.
    RunFailed
        Where the linkage does not come to rest.
    """
    force = pull_of(linkage) if force is None else force
    _SIZE.check("force", force)
    up, down = heights_at_bottom(linkage, (force, -force))
    return float(up - down)


def deflection(
    linkage: Linkage,
    force: Annotated[float, _FORCE],
    idle: Annotated[float, _FORCE] = 0.0,
) -> float:
    """Return the rise of bottom dead centre between two static loads, m, the drives held there.

    Parameters
    ----------
    linkage : Linkage
        As in ``total_clearance``.
    force, idle : float
        On the watched point along its direction, N; without the latter the linkage hangs by its
        weight.

    Raises
    ------
    InputError
        For a force out of range, and where the watched coordinate stands.
    RunFailed
        Where the linkage does not come to rest.
    """
    loaded, unloaded = heights_at_bottom(linkage, (force, idle))
    return float(loaded - unloaded)
