"""Equilibrium of a linkage at rest, its drives held: pins loose in their bearings under a load.

Nothing rubs, and of a normal law at rest its elastic force is left.  Weight, springs and
constant loads act; loads with a law of their own do not.  The linkage creeps from its ideal
position against a drag in proportion to its masses, in implicit steps of time: short ones carry
pins across their clearance, where nothing holds them, and long ones are those of Newton's
method.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import Revolute
from presswear.linkage.linkage import Linkage
from presswear.physics.applied import applied_forces
from presswear.physics.assembly import ROUND_OFF
from presswear.physics.bottom import bottom_of
from presswear.physics.constraints import constraints_of, lever
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.forces import JOINT_RATES, add_contacts, note_forces
from presswear.physics.ideal import ideal_motion
from presswear.physics.packed import pack
from presswear.tools.compile import Records
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.quantities import Quantity

Array = NDArray[np.float64]

LEAST_PULL, PULL_OVER_WEIGHT = 100.0, 10.0
"""Force by which a total clearance is told where none is given, N, and over the weight."""
_FORCE = Quantity("N", -1e9, 1e9, "", "on the watched point along its direction")
_SIZE = Quantity("N", 0.0, 1e9, "", "on the watched point, either way", open_low=True)

BALANCED = 1e-11
"""Part of the forces that may be left at rest: of a penetration as much."""
_STEPS = 2000
"""Most steps."""
_FIRST = 1e-6
"""First step, s^2: against a unit drag a mass moves by its acceleration times that."""
_STRIDE = 0.25
"""Longest way of a pin in a step, part of its clearance, or of how far it is out of the middle."""
_NEAR = 0.1
"""Part of that from which on the next step is chosen by it."""
_WORSE = 2.0
"""Growth of what is not balanced by which a step is refused."""
_LONGER, _SHORTER = 8.0, 0.2
"""What comes of a step that was taken, or refused, in the next."""
_PROBE = 1e-9
"""Way over which forces are differenced, part of the size of the linkage."""


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
        """Scaled forces on the bodies without those of contacts."""
        force = np.empty_like(self._still)
        applied_forces(self._packed, self._time, q, self._still, force)
        probe, i = self._probe, self._place
        x, y = lever(i, probe.x, probe.y, q)
        fx, fy = (self._pull * part(probe.direction) for part in (math.cos, math.sin))
        force[i : i + 3] += fx, fy, x * fy - y * fx
        return force / self.scale

    def free(self, q: Array) -> Array:
        """Directions that the joints leave free, scaled, orthonormal, shape (n, free)."""
        _, _, right = np.linalg.svd(self._jacobian(q)[1])
        return np.asarray(right[self._constraints.rows :].T)

    def _jacobian(self, q: Array) -> tuple[Array, Array]:
        phi, _, _, jacobian = self._constraints.evaluate(self._time, q, self._still)
        return phi, jacobian / self.scale

    def moved(self, q: Array, step: Array) -> Array:
        """The position a scaled step away, the joints closed."""
        q = q + step / self.scale
        for _ in range(4):
            phi, jacobian = self._jacobian(q)
            if float(np.abs(phi).max(initial=0.0)) <= ROUND_OFF * self._size:
                break
            q = q - np.linalg.lstsq(jacobian, phi, rcond=None)[0] / self.scale
        return q

    def unbalanced(self, q: Array, basis: Array) -> Array:
        """Forces along some directions, as far as they are free here, shape (free,)."""
        force = self.given(q) * self.scale
        note_contacts(self._packed, self.contacts, q, self._still)
        note_forces(self._packed.joints, self._onset, self.contacts)
        add_contacts(self._packed.joints, self._onset, self.contacts, force, self._rates)
        own = self.free(q)
        return np.asarray(basis.T @ (own @ (own.T @ (force / self.scale))))

    def stiffness(self, q: Array, basis: Array) -> Array:
        """How the forces fall along the directions, by central differences."""
        columns = []
        for direction in basis.T:
            step = _PROBE * self._size / float(np.abs(direction / self.scale).max()) * direction
            ahead, behind = (
                self.unbalanced(self.moved(q, sign * step), basis) for sign in (1.0, -1.0)
            )
            columns.append((behind - ahead) / (2.0 * float(np.linalg.norm(step))))
        return np.column_stack(columns)

    def is_still(self, basis: Array, stiffness: Array, left: Array) -> bool:
        """True where a step of Newton's method would be round-off, and balance what is left."""
        way = np.linalg.lstsq(stiffness, left, rcond=1e-12)[0]
        far = float(np.abs(basis @ way / self.scale).max())
        rest = float(np.linalg.norm(left - stiffness @ way))
        return far <= ROUND_OFF * self._size and rest <= 0.5 * float(np.linalg.norm(left))

    def pins(self) -> Array:
        """Pin centres from bearing centres as they were noted last, shape (joints, 2), m."""
        names = ("eccentricity_x", "eccentricity_y")
        return np.column_stack([self.contacts[name] for name in names])


def closed(linkage: Linkage) -> Linkage:
    """The linkage with ideal joints in place of those with clearance."""
    pins = (Revolute(own.name, own.bearing, own.pin) for own in linkage.clearances)
    return replace(linkage, joints=(*linkage.joints, *pins), clearances=())


def equilibrium(linkage: Linkage, time: float, force: float = 0.0) -> Equilibrium:
    """A linkage at rest, its drives held where they are at a time.

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
    clearance = np.array([own.clearance for own in linkage.clearances])
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
        found = held.unbalanced(there, basis)
        allowed = _STRIDE * np.maximum(clearance, np.hypot(*before.T))
        part = float((np.hypot(*(held.pins() - before).T) / allowed).max())
        if part > 1.0 or not float(np.linalg.norm(found)) < _WORSE * off:
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
    """Heights at bottom dead centre under static forces, the drives held there, shape (n,), m.

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
    """Force by which a total clearance is told where none is given, N: no weight bears it."""
    weight = abs(linkage.gravity) * sum(body.mass for body in linkage.bodies)
    return max(LEAST_PULL, PULL_OVER_WEIGHT * weight)


def total_clearance(linkage: Linkage, force: float | None = None) -> float:
    """Total clearance at bottom dead centre, m: JIS B 6402's, above and below the connection.

    The watched body is pulled up and down, the drives held: what its heights differ by is the
    play of all joints on the way of the load, worn surfaces included, and what they give under
    the force.  Weight acts, so that the force has to be larger than what hangs.

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
    """Rise of bottom dead centre from one static load to another, m, the drives held there.

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
