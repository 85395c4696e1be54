"""Linkages at rest under a load: equilibrium, total clearance and deflection."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.joints import rows_of_joints
from presswear.linkage.linkage import Linkage
from presswear.physics.constraint_rows import ROUND_OFF
from presswear.physics.constraints import constraints_of, lever
from presswear.physics.dead_centre import bottom_of
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.ideal import Motion, ideal_motion
from presswear.physics.packed import pack
from presswear.physics.touchdown import HELD_OPEN
from presswear.tools.arguments import checked_arguments
from presswear.tools.arrays import Array
from presswear.tools.compile import Records
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.quantities import Quantity, written

# Default force for a total clearance: least value, N, and ratio to the weight
LEAST_PULL = 100.0
PULL_OVER_WEIGHT = 10.0
# Least force by a pull in a joint that carries it, over the largest force in a joint
CARRYING = 0.1
_FORCE = Quantity("N", -1e9, 1e9, "", "on the output point along its direction")
_SIZE = Quantity("N", 0.0, 1e9, "", "on the output point, either way", open_low=True)
MAX_UNBALANCED = 1e-8  # largest unbalanced force of a solution, over the joint force
# Finite-difference step of an offset, part of the deepest penetration
DIFFERENCE = 1e-5


class Equilibrium(NamedTuple):
    """Linkage at rest: position, height of the output point, m, and contacts with forces."""

    position: Array
    height: float
    contacts: Records


class _Rest:
    """Position and unbalanced forces of a linkage as functions of the offsets in its joints.

    Offsets are the eccentricities of the pins of clearance joints, then of elastic pins,
    two for each, and the stretches of elastic guides. The drives are fixed and the
    output point is pulled. The offsets are added to the constraint rows of the linkage
    with ideal joints. The unbalanced forces are the multipliers of these rows under all
    forces.
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
        resting = replace(linkage, loads=linkage.constant_loads)
        self.packed = pack(resting)
        self.tolerance = ROUND_OFF * self.ideal.rows.size
        self._onset = np.zeros(len(linkage.clearances))
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
        motion = Motion(np.array([self._time]), q, still, still)
        height = float(motion.output(self._linkage)[0, 0])
        return Equilibrium(self.position, height, self.contacts)

    def move(self, offsets: Array) -> None:
        """Move all bodies to offsets in the joints, shape (joints, 2), m.

        The first offset of a guide is its stretch; its second offset is not used.
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
        """Return the unbalanced forces at the offsets, shape (joints, 2), N."""
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

    The rows are those of the linkage with ideal joints: rigid pins, clearance joints,
    elastic pins, and guides, in this order.
    """
    first = 2 * len(linkage.revolutes)
    pins = len(linkage.clearances) + len(linkage.elastic_pins)
    rows = [[first + 2 * k, first + 2 * k + 1] for k in range(pins)]
    end = first + 2 * pins
    guides = linkage.ideal.guides
    for guide, count in zip(guides, rows_of_joints(guides), strict=True):
        end += count
        if guide.stiffness is not None:
            rows.append([end - 1, -1])
    return np.array(rows, np.int64).reshape(-1, 2)


def _reach(linkage: Linkage, joints: Records, size: Array) -> tuple[Array, Array]:
    """Return clearances of joints, and their penetrations or stretches under forces, N, in m."""
    law = joints["normal"]
    elastic = linkage.elastic_joints
    stiffness = [*law["estimated_stiffness"], *(joint.stiffness for joint in elastic)]
    exponent = [*law["estimated_exponent"], *np.ones(len(elastic))]
    clearance = np.array([*joints["clearance"], *np.zeros(len(elastic))])
    return clearance, (size / np.array(stiffness)) ** (1.0 / np.array(exponent))


def _estimated_offsets(
    at_rest: _Rest, direction: Array, clearance: Array, depth: Array
) -> Array:
    """Move the joints near their equilibrium; return the offsets, (joints, 2), m.

    ``direction`` holds the unit vectors of the joint forces, (joints, 2). Wear adds to
    the clearance, so that three steps bring each pin to its penetration ``depth``, m.
    """
    distance = clearance.copy()
    for _ in range(3):
        offsets = direction * distance[:, np.newaxis]
        at_rest.move(offsets)
        stretch = np.hypot(*offsets[len(at_rest.contacts) :].T)
        distance += depth - np.concatenate([at_rest.contacts["penetration"], stretch])
    return offsets


def equilibrium(linkage: Linkage, time: float, force: float = 0.0) -> Equilibrium:
    """Return a linkage at rest under a force on its output point, N, with fixed drives."""
    from scipy.optimize import root  # slow to import

    at_rest = _Rest(linkage, time, force)
    needed = at_rest.unbalanced(with_contacts=False)
    size = np.hypot(*needed.T)
    # A joint without a force has no offset.
    loaded = size > 1e-9 * max(float(size.max(initial=0.0)), 1e-9)
    direction = np.zeros_like(needed)
    if not loaded.any():
        at_rest.move(direction)
        return at_rest.equilibrium()
    direction[loaded] = needed[loaded] / size[loaded, np.newaxis]
    clearance, depth = _reach(linkage, at_rest.packed.joints, size)
    offsets = _estimated_offsets(at_rest, direction, clearance, depth)
    # A guide has one offset.
    unknown = loaded[:, np.newaxis] & (at_rest.offset_rows >= 0)
    scale = np.broadcast_to(size[:, np.newaxis], unknown.shape)[unknown]
    start = offsets[unknown]
    deepest = float(depth[loaded].max())

    def residual(x: Array) -> Array:
        offsets[unknown] = start + deepest * (x - 1.0)
        at_rest.move(offsets)
        return np.asarray(at_rest.unbalanced()[unknown] / scale)

    # ``root`` differences over a part of each unknown, so that none may be zero: x
    # starts at ones.
    options = {"maxfev": 4000, "eps": DIFFERENCE**2}
    solution = root(residual, np.ones_like(start), tol=1e-15, options=options)
    unbalanced = float(np.abs(residual(solution.x)).max())
    # The error of a small penetration is the round-off of the position.
    if not (unbalanced <= MAX_UNBALANCED or unbalanced * deepest <= at_rest.tolerance):
        raise RunFailed(
            f"{linkage.name} does not come to rest under {force:g} N: {unbalanced:.3g} of its "
            "joint forces are not balanced"
        )
    return at_rest.equilibrium()


def _instant_of_bottom(linkage: Linkage) -> float:
    bottom = bottom_of(ideal_motion(linkage.ideal, linkage.period))
    if bottom is None:
        raise InputError(
            f"{linkage.name} has no bottom dead centre: its output point stands still"
        )
    return linkage.run_up_time + linkage.period + bottom.time


def heights_at_bottom(linkage: Linkage, forces: Sequence[float]) -> Array:
    """Return heights at bottom dead centre under static forces, m, with fixed drives."""
    time = _instant_of_bottom(linkage)
    return np.array([equilibrium(linkage, time, force).height for force in forces])


def least_pull(linkage: Linkage) -> float:
    """Return the pull at bottom dead centre, N, above which it determines the side of each pin.

    The force of an ideal joint is that of weight, springs and constant loads, plus that
    of the pull. Joints in which a pull has less than ``CARRYING`` of its largest force
    are left out.
    """
    time = _instant_of_bottom(linkage)
    without_pull = _Rest(linkage, time, 0.0).unbalanced(with_contacts=False)
    with_pull = _Rest(linkage, time, 1.0).unbalanced(with_contacts=False)
    per_pull = with_pull - without_pull  # force of a pull of 1 N
    size = np.hypot(*per_pull.T)
    carries = size > CARRYING * float(size.max(initial=0.0))
    projection = np.abs((without_pull * per_pull).sum(axis=1))
    pull = projection[carries] / size[carries] ** 2
    return float(pull.max(initial=0.0))


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
    force = float(_FORCE.convert("force", force))
    idle = float(_FORCE.convert("idle", idle))
    loaded, unloaded = heights_at_bottom(linkage, (force, idle))
    return float(loaded - unloaded)
