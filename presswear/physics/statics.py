"""Linkages at rest under a load, and inverse dynamics of the ideal motion."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Bushing
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force, OverPosition, OverTime
from presswear.physics.assembly import ROUND_OFF
from presswear.physics.constraints import constraints_of, lever
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.friction_and_normal import friction_force, friction_record
from presswear.physics.ideal import IdealMotion, Motion, bottom_of, ideal_motion
from presswear.physics.interactions.lugre import stribeck_coefficient
from presswear.physics.loads import place_loads, settle_loads
from presswear.physics.packed import pack
from presswear.physics.touchdown import HELD_OPEN
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.quantities import Quantity, written
from presswear.tools.serialize import checked_arguments

_INSTANTS = 8 * 720  # of a cycle at which a torque is compared with its limit
# change of friction moments in the last iteration, part of the greatest
FRICTION_TOL = 1e-12
MAX_ITERATIONS = 50  # of Newton's method for them


def needed_torques(
    linkage: Linkage, ideal: IdealMotion, time: Array, bushings: Sequence[Bushing] = ()
) -> Array:
    """Return the torques of the drives, all joints closed, shape (n, drives), N m.

    With inertia, weights, springs and loads, and with the friction of ``bushings``: the
    multipliers of the drives' constraint rows; see ``constraint_forces``.
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

    Laws of loads that depend on the way are followed from the first instant of
    ``motion``, which is ``ideal`` at some instants.

    Parameters
    ----------
    bushings : sequence of ClearanceJoint or Revolute
        Bearings of pin joints of the same name, whose friction acts in the rigid
        joints: a moment mu F r against the relative spin, with the joint force F, the
        radius r of the bearing and the friction law at the sliding speed r times the
        relative spin.

    Raises
    ------
    RunFailed
        If friction blocks the motion, so that no forces hold it.
    """
    packed = pack(linkage)
    right = packed.mass * motion.acceleration
    if packed.loads is not None:
        place_loads(packed.loads, motion.position[0], motion.velocity[0])
    right -= packed.weight
    if linkage.springs or linkage.live_loads:
        forces = BodyForces(linkage, packed)
        levels = zip(motion.position, motion.velocity, motion.acceleration, strict=True)
        for k, (t, (q, v, a)) in enumerate(zip(motion.time, levels, strict=True)):
            settle_loads(packed.loads, t, q, v, a)
            right[k] -= forces(t, q, v)
    forces_of = partial(
        ideal.rows.forces, motion.position.reshape(motion.time.size, -1, 3)
    )
    reactions = forces_of(right[..., np.newaxis])[..., 0]
    rubbing = [joint for joint in bushings if joint.friction.coefficient > 0.0]
    return (
        _Friction(linkage, motion, rubbing, forces_of).with_friction(reactions)
        if rubbing
        else reactions
    )


@compiled
def fill_steady_friction(
    law: Records, sliding: Array, normal: Array, force: Array
) -> None:
    """Fill the friction, N, of steady sliding at speeds, m/s, under normal forces, N; shape (n,).

    LuGre's law has the deflection at which it stays: z' = 0.
    """
    for i in range(sliding.shape[0]):
        if law.bristle_stiffness > 0.0:
            size = normal[i] * stribeck_coefficient(sliding[i], law)
            force[i] = -math.copysign(size, sliding[i]) if sliding[i] != 0.0 else 0.0
        else:
            force[i] = friction_force(sliding[i], normal[i], law)


def relative_spins(
    linkage: Linkage, motion: Motion, joints: Sequence[Bushing]
) -> tuple[NDArray[np.int64], Array]:
    """Return the columns of the angles of pins and bearings, and their relative spin, rad/s.

    Shapes (joints, 2), -1 for the frame, and (joints, n).
    """
    places = [
        [-1 if end.body == GROUND else 3 * linkage.index(end.body) + 2 for end in ends]
        for ends in ((joint.pin, joint.bearing) for joint in joints)
    ]
    columns = np.array(places, np.int64).reshape(-1, 2)
    spins = np.concatenate([motion.velocity, np.zeros((motion.time.size, 1))], axis=1).T
    return columns, spins[columns[:, 0]] - spins[columns[:, 1]]


class _Friction:
    """Friction moments of rigid pin joints in the ideal motion, and the forces that they change.

    The moments depend on the joint forces and the joint forces on the moments. Newton's
    method solves for the moments m = c |F_0 - D m|, with the moment c of a joint force
    of 1 N, the forces F_0 without friction, and those of unit moments D.
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
        names = [one.name for one in linkage.revolutes]
        self._rows = np.array([2 * names.index(joint.name) for joint in joints])
        units = np.zeros((linkage_size := 3 * len(linkage.bodies), len(joints)))
        for k, (pin, bearing) in enumerate(columns):
            if pin >= 0:
                units[pin, k] += 1.0
            if bearing >= 0:
                units[bearing, k] -= 1.0
        shape = (motion.time.size, linkage_size, len(joints))
        # Change of all multipliers by unit moments on the pins, (n, rows, joints)
        self._changes = forces_of(np.broadcast_to(units, shape))

    def _moments_of(self, size: Array) -> Array:
        """Return the moments on the pins under joint forces, (n, joints), N and N m."""
        moments = np.zeros_like(size)
        for k, joint in enumerate(self._joints):
            record = friction_record(joint.friction)
            radius = joint.bearing_radius
            friction = np.zeros(size.shape[0])
            normal = np.ascontiguousarray(size[:, k])
            fill_steady_friction(record, radius * self._spin[k], normal, friction)
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
            # No direction of a force that vanishes
            per_force = np.divide(
                friction, size, out=np.zeros_like(friction), where=size > 0.0
            )
            unit = np.divide(
                force,
                size[..., np.newaxis],
                out=np.zeros_like(force),
                where=size[..., None] > 0.0,
            )
            slope = per_force[..., np.newaxis] * np.einsum(
                "nkc,nkcj->nkj", unit, changes
            )
            matrix = np.eye(len(self._joints)) + slope
            moments = moments - np.linalg.solve(matrix, error[..., np.newaxis])[..., 0]
        worst = int((np.abs(error) - FRICTION_TOL * scale).max(axis=1).argmax())
        raise RunFailed(
            f"friction blocks the motion of rigid joints at t = {self._motion.time[worst]:.6g} s: "
            "no joint forces hold it"
        )


def friction_corners(
    linkage: Linkage, ideal: IdealMotion, time: Array, bushings: Sequence[Bushing]
) -> Array:
    """Return the instants at which friction in rigid joints has a corner, shape (k,), s.

    The sliding speed passes a corner of the ramp, between some times, s, that resolve
    the motion.
    """
    rubbing = [joint for joint in bushings if joint.friction.coefficient > 0.0]
    instants = [np.zeros(0)]
    _, spins = relative_spins(linkage, ideal.at(time), rubbing)
    for joint, spin in zip(rubbing, spins, strict=True):
        law = joint.friction
        for corner in (-law.upper, -law.lower, law.lower, law.upper):
            ahead = joint.bearing_radius * spin - corner
            k = np.flatnonzero(ahead[1:] * ahead[:-1] < 0.0)
            instants.append(time[k] - ahead[k] * np.diff(time)[k] / np.diff(ahead)[k])
    return np.concatenate(instants)


def load_corners(linkage: Linkage, ideal: IdealMotion, time: Array) -> Array:
    """Return the instants at which the table of a load has a corner in the ideal motion.

    Shape (k,), s, between the first and the last of some times, s, that resolve the
    motion.
    """
    if not linkage.live_loads:
        return np.zeros(0)
    from scipy.interpolate import CubicHermiteSpline  # slow to import

    motion = ideal.at(time)
    corners = [np.zeros(0)]
    for load in linkage.live_loads:
        if isinstance(load.law, OverTime):
            period = linkage.period if load.law.period is None else load.law.period
            last = time[-1] / period if period > 0.0 else 0.0
            turns = period * np.arange(last + 1.0)
            corners += [node + turns for node, _ in load.law.table]
        elif isinstance(load.law, OverPosition):
            if isinstance(load, Force):
                place, speed, _ = motion.of_point(
                    linkage, load.attachment, load.direction
                ).T
            else:
                column = 3 * linkage.index(load.body) + 2
                place = motion.position[:, column]
                speed = motion.velocity[:, column]
            curve = CubicHermiteSpline(time, place - load.law.zero, speed)
            corners += [curve.solve(node, False, False) for node, _ in load.law.table]
    instants = np.concatenate(corners)
    return np.asarray(instants[(instants >= time[0]) & (instants <= time[-1])])


def check_drives(
    linkage: Linkage, ideal: IdealMotion, bushings: Sequence[Bushing] = ()
) -> None:
    """Raise InputError where a drive needs more than its torque limit in the second cycle.

    The limit of a motor is no fault: a servo saturates there.

    Joints are rigid, with the friction of ``bushings``; see ``constraint_forces``.
    """
    start = linkage.run_up_time
    time = np.linspace(start, start + 2.0 * ideal.period, 2 * _INSTANTS + 1)
    corners = load_corners(linkage, ideal, time)
    time = np.union1d(
        np.union1d(time, corners), friction_corners(linkage, ideal, time, bushings)
    )
    is_second = time >= start + ideal.period
    torques = needed_torques(linkage, ideal, time, bushings)[is_second]
    second = time[is_second]
    for drive, item in zip(linkage.drives, torques.T, strict=True):
        place = int(np.abs(item).argmax())
        if (
            drive.torque_limit is not None
            and drive.motor is None
            and not abs(item[place]) <= drive.torque_limit
        ):
            raise InputError(
                f"torque_limit of {drive.body} = {written(drive.torque_limit, 'N m')}: the ideal "
                f"motion needs {written(abs(item[place]), 'N m')}, at "
                f"{360.0 * (second[place] - start) / ideal.period % 360.0:.4g} degrees of a cycle"
            )


# Least default force for a total clearance, N, and over the weight
LEAST_PULL = 100.0
PULL_OVER_WEIGHT = 10.0
CARRYING = 0.1  # part of the largest force by a pull, above which a joint carries it
_FORCE = Quantity("N", -1e9, 1e9, "", "on the output point along its direction")
_SIZE = Quantity("N", 0.0, 1e9, "", "on the output point, either way", open_low=True)
MAX_UNBALANCED = 1e-8  # part of the joint forces that a solution may leave


class Equilibrium(NamedTuple):
    """Linkage at rest: position, height of the output point, m, and contacts with forces."""

    position: Array
    height: float
    contacts: Records


class _Rest:
    """Position and unbalanced forces of a linkage as functions of the offsets in its joints.

    Those are the eccentricities of the pins of clearance joints, then of elastic ones,
    two for each, and the stretches of elastic guides.

    The drives are held and the output point is pulled. The offsets are added to the
    rows of the linkage with ideal joints, whose multipliers under all forces are
    unbalanced in these rows.
    """

    def __init__(self, linkage: Linkage, time: float, pull: float) -> None:
        # At rest a guide with clearance is ideal, and the oil is squeezed out.
        linkage = linkage.without_motors.with_closed_guides.without_oil
        self.ideal = ideal_motion(linkage.ideal, linkage.period)
        if self.ideal.rows.repeated:
            raise InputError(
                f"{linkage.name}: joints hold a body more than once; a total clearance or a "
                "deflection needs a linkage whose ideal joints hold each body just once"
            )
        self.position = self.ideal.at(np.array([time])).position[0]
        self.packed = pack(replace(linkage, loads=linkage.dead_loads))
        self.tolerance = ROUND_OFF * self.ideal.rows.size
        self._onset = np.zeros(len(linkage.clearances))
        resting = replace(linkage, loads=linkage.dead_loads)
        self._forces = BodyForces(resting, self.packed, self._onset)
        self.contacts = self._forces.contacts
        self._linkage = linkage
        self._time = time
        self._pull = pull
        self._rows = constraints_of(linkage.ideal)
        self.offset_rows = _offset_rows(linkage)
        self._still = np.zeros(self.position.size)

    def equilibrium(self) -> Equilibrium:
        """Return the present position with its contacts."""
        q = self.position[np.newaxis]
        still = self._still[np.newaxis]
        height = Motion(np.array([self._time]), q, still, still).output(self._linkage)[
            0, 0
        ]
        return Equilibrium(self.position, float(height), self.contacts)

    def move(self, offsets: Array) -> None:
        """Move all bodies to offsets in the joints, shape (joints, 2), m.

        Of a guide the first is its stretch, and the second stands for nothing.
        """
        is_row = self.offset_rows >= 0
        for _ in range(20):
            phi, _, _, jacobian = self._rows.evaluate(
                self._time, self.position, self._still
            )
            phi[self.offset_rows[is_row]] += offsets[is_row]
            self.position = self.position - np.linalg.solve(jacobian, phi)
            if float(np.abs(phi).max()) <= self.tolerance:
                break
        self._forces(self._time, self.position, self._still)  # fills the contacts

    def unbalanced(self, with_contacts: bool = True) -> Array:
        """Return the forces that push joints out of the middle, shape (joints, 2), N."""
        q = self.position
        output = self._linkage.output
        i = 3 * self._linkage.index(output.body)
        self._onset[:] = 0.0 if with_contacts else HELD_OPEN
        force = self.packed.weight + self._forces(self._time, q, self._still)
        x, y = lever(i, output.x, output.y, q)
        fx = self._pull * math.cos(output.direction)
        fy = self._pull * math.sin(output.direction)
        force[i : i + 3] += fx, fy, x * fy - y * fx
        jacobian = self._rows.evaluate(self._time, q, self._still)[3]
        reactions = -np.linalg.solve(jacobian.T, force)
        return np.where(self.offset_rows >= 0, reactions[self.offset_rows], 0.0)


def _offset_rows(linkage: Linkage) -> NDArray[np.int64]:
    """Return the constraint rows in which joints have offsets, (joints, 2); -1 for none.

    The rows are those of the closed linkage: its pins come first, with the loose and
    the elastic ones behind the others, and then the guides.
    """
    first = 2 * len(linkage.revolutes)
    pins = len(linkage.clearances) + len(linkage.elastic_pins)
    rows = [[first + 2 * k, first + 2 * k + 1] for k in range(pins)]
    end = first + 2 * pins
    for guide in linkage.ideal.guides:
        end += guide.rows
        if guide.stiffness is not None:
            rows.append([end - 1, -1])
    return np.array(rows, np.int64).reshape(-1, 2)


def _reach(linkage: Linkage, joints: Records, size: Array) -> tuple[Array, Array]:
    """Return the clearances of joints, and how far forces, N, press or stretch them, m."""
    law = joints["normal"]
    elastic = linkage.elastic_joints
    stiffness = [*law["estimated_stiffness"], *(one.stiffness for one in elastic)]
    exponent = [*law["estimated_exponent"], *np.ones(len(elastic))]
    clearance = np.array([*joints["clearance"], *np.zeros(len(elastic))])
    return clearance, (size / np.array(stiffness)) ** (1.0 / np.array(exponent))


def equilibrium(linkage: Linkage, time: float, force: float = 0.0) -> Equilibrium:
    """Return a linkage at rest, its drives held as at a time, s, its output point pulled, N."""
    from scipy.optimize import root  # slow to import

    rest = _Rest(linkage, time, force)
    needed = rest.unbalanced(with_contacts=False)
    size = np.hypot(*needed.T)
    # A joint without a force stays in the middle.
    loaded = size > 1e-9 * max(float(size.max(initial=0.0)), 1e-9)
    offsets = np.zeros_like(needed)
    if not loaded.any():
        rest.move(offsets)
        return rest.equilibrium()
    direction = needed[loaded] / size[loaded, np.newaxis]
    distance, depth = _reach(linkage, rest.packed.joints, size)
    for _ in range(3):  # to the bottom of a worn surface
        offsets[loaded] = (direction.T * distance[loaded]).T
        rest.move(offsets)
        stretch = np.hypot(*offsets[len(rest.contacts) :].T)
        distance += depth - np.concatenate([rest.contacts["penetration"], stretch])
    depth = depth[loaded]
    # A guide has one offset.
    unknown = loaded[:, np.newaxis] & (rest.offset_rows >= 0)
    scale = np.broadcast_to(size[:, np.newaxis], unknown.shape)[unknown]

    def residual(x: Array) -> Array:
        offsets[unknown] = x
        rest.move(offsets)
        return np.asarray(rest.unbalanced()[unknown] / scale)

    start = offsets[unknown]
    solution = root(residual, start, tol=1e-15, options={"maxfev": 4000})
    left = float(np.abs(residual(solution.x)).max())
    # A small penetration is known to round-off of the position only.
    if not (left <= MAX_UNBALANCED or left * depth.max() <= rest.tolerance):
        raise RunFailed(
            f"{linkage.name} does not come to rest under {force:g} N: {left:.3g} of its joint "
            "forces are not balanced"
        )
    return rest.equilibrium()


def _instant_of_bottom(linkage: Linkage) -> float:
    bottom = bottom_of(ideal_motion(linkage.ideal, linkage.period))
    if bottom is None:
        raise InputError(
            f"{linkage.name} has no bottom dead centre: its output point stands still"
        )
    return linkage.run_up_time + linkage.period + bottom.time


def heights_at_bottom(linkage: Linkage, forces: Sequence[float]) -> Array:
    """Return heights at bottom dead centre under static forces, m, the drives held there."""
    time = _instant_of_bottom(linkage)
    return np.array([equilibrium(linkage, time, force).height for force in forces])


def least_pull(linkage: Linkage) -> float:
    """Return the pull, N, above which the joints that carry it change sides at bottom dead centre.

    The force of an ideal joint is that of the weight, springs and constant loads, and a
    part of the pull. Joints that carry less than ``CARRYING`` of the largest part are
    left out.
    """
    time = _instant_of_bottom(linkage)
    still, pulled = (
        _Rest(linkage, time, pull).unbalanced(False) for pull in (0.0, 1.0)
    )
    part = pulled - still
    size = np.hypot(*part.T)
    carries = size > CARRYING * float(size.max(initial=0.0))
    along = np.abs((still * part).sum(axis=1))[carries] / size[carries] ** 2
    return float(along.max(initial=0.0))


def pull_of(linkage: Linkage) -> float:
    """Return the default force for a total clearance, N: more than the weight."""
    weight = abs(linkage.gravity) * sum(body.mass for body in linkage.bodies)
    return max(LEAST_PULL, PULL_OVER_WEIGHT * weight)


@checked_arguments
def total_clearance(linkage: Linkage, force: float | None = None) -> float:
    """Return the total clearance at bottom dead centre, m (JIS B 6402).

    The output body is pulled up and down with fixed drives. The difference of its
    heights contains the clearance, wear and elastic deflection of all loaded joints.
    Weight acts too, so that the force must be larger than the weight that the joints
    carry.

    Parameters
    ----------
    linkage : Linkage
        With clearance; on the surfaces of a stage it is
        ``scene.linkage(stage.surfaces)``.
    force : float or None
        Pull in both directions, N; None: 100 N, or ten times the weight if that is
        more.

    Raises
    ------
    InputError
        If the force is out of range or below ``least_pull``, or the output point does
        not move.
    RunFailed
        If no static equilibrium is found.
    """
    if force is None:
        force = pull_of(linkage)
    else:
        force = float(_SIZE.convert("force", force))
        least = least_pull(linkage)
        if force <= least:
            carried = f"allowed is above {written(least, 'N')}, the weight that the joints carry"
            raise InputError(f"force = {written(force, 'N')}: {carried}")
    up, down = heights_at_bottom(linkage, (force, -force))
    return float(up - down)


@checked_arguments
def deflection(linkage: Linkage, force: float, idle: float = 0.0) -> float:
    """Return the rise of bottom dead centre between two static loads, m, with fixed drives.

    ``force`` and ``idle`` act on the output point along its direction, N. Without
    ``idle`` only the weight acts. Errors are those of ``total_clearance``.
    """
    force, idle = (
        float(_FORCE.convert(*one)) for one in (("force", force), ("idle", idle))
    )
    loaded, unloaded = heights_at_bottom(linkage, (force, idle))
    return float(loaded - unloaded)
