"""Equations of motion, in all coordinates or in the fewest.

In all coordinates they are of index 1 (equations 14 to 20 of the paper): M q'' + Phi_q^T lambda
= g with Phi_q q'' = gamma - 2 alpha Phi' - beta^2 Phi.  Where clearance cuts every loop that has
a freedom, the coordinates of the open tree do, and there are no constraints.

The state is y = (x, x', integrals): coordinates, rates, and as quadratures the drive
work, its absolute value, per clearance joint the rates of ``add_contacts``, and per drive its
torque and power and their squares; last, where there is any, the work of loads and dampers.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.constraints import (
    DRIVE,
    Constraints,
    Held,
    evaluate_constraints,
    project,
    solve,
)
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.drive_motion import drive_motion
from presswear.physics.forces import BRISTLE, JOINT_RATES, add_contacts
from presswear.physics.packed import Packed, applied_forces, has_work
from presswear.physics.prescribed import (
    Prescribed,
    Tree,
    begin_motion,
    drive_torques,
    forced_power,
    place_prescribed,
    subtract_inertia,
)
from presswear.physics.tree import (
    ARTICULATED,
    CARRIED,
    accelerate_links,
    arm,
    articulate,
    carry_branches,
    place_links,
    release,
)
from presswear.tools.compile import Records, compiled, copy_to, inlined

Array = NDArray[np.float64]

DRIVE_INTEGRALS = 2  # integrals before those of the joints: drive work and its absolute value, J
JOINT_INTEGRALS = JOINT_RATES  # integrals per joint: those of the rates of ``add_contacts``
TORQUE, TORQUE_SQUARE, POWER, POWER_SQUARE = range(4)
"""Integrals per drive."""
TORQUE_INTEGRALS = 4  # their number


class Hung(NamedTuple):
    """An open tree, with working space.

    Attributes
    ----------
    links : records of LINK
    prescribed : Prescribed
    bodies : records of ARTICULATED
    carried : ndarray, shape (links, CARRIED)
    balance : ndarray, shape (coordinates,)
    """

    links: Records
    prescribed: Prescribed
    bodies: Records
    carried: Array
    balance: Array


class System(NamedTuple):
    """A linkage as the kernels see it, with working space.

    Attributes
    ----------
    packed : Packed
    held : Held or None
        The constraints, of a linkage in all its coordinates.
    hung : Hung or None
        The tree, of one in the fewest.  The compiler leaves out what goes with the other.
    size : int
        Number of coordinates.
    state : ndarray, shape (5, 3 bodies)
        q, v, a and applied generalized forces of all bodies, and of a tree their axes: see
        ``place_links``.
    felt : int
        Number of components of the state, the first ones, that slopes depend on.
    contacts : records of CONTACT
    torque : ndarray, shape (drives,)
        Working space.
    first_torque : int
        Index in the state of the integrals of the first drive.
    alpha, beta : float
        Baumgarte's coefficients, 1/s.
    has_work : bool
        Whether loads or dampers do any.
    """

    packed: Packed
    held: Held | None
    hung: Hung | None
    size: int
    state: Array
    felt: int
    contacts: Records
    torque: Array
    first_torque: int
    alpha: float
    beta: float
    has_work: bool


@inlined
def bristle_place(coordinates: int, k: int) -> int:
    """Place in the state of the deflection of the bristles of joint ``k``."""
    return coordinates + DRIVE_INTEGRALS + JOINT_INTEGRALS * k + BRISTLE


@inlined
def _place(hung: Hung | None, state: Array, t: float, y: Array) -> None:
    q, v, a, _, axes = state
    n = q.shape[0]
    if hung is None:
        copy_to(q, y[:n])
        copy_to(v, y[n : 2 * n])
    else:
        n = hung.balance.shape[0]
        place_prescribed(hung.prescribed, t, q, v, a, axes)
        place_links(hung.links, y[:n], y[n : 2 * n], q, v, axes)


@inlined
def place(system: System, t: float, y: Array) -> None:
    """Fill coordinates and rates of all bodies in a state."""
    _place(system.hung, system.state, t, y)


@inlined
def _accelerate(hung: Hung | None, state: Array, slope: Array) -> None:
    _, v, a, _, axes = state
    if hung is None:
        copy_to(a, slope)
    else:
        accelerate_links(hung.links, slope, v, axes, a)


@inlined
def accelerate(system: System, slope: Array) -> None:
    """Fill accelerations of all bodies in the state placed last, from its slopes."""
    _accelerate(system.hung, system.state, slope[system.size : 2 * system.size])


@inlined
def evaluate(system: System, onset: Array, t: float, y: Array, out: Array, torques: bool) -> None:
    """Fill dy/dt, and all of the state but for accelerations; leaves multipliers behind.

    Parameters
    ----------
    torques : bool
        Whether the rates of the drives' integrals are needed.
    """
    n = system.size
    place(system, t, y)
    q, v, _, force, axes = system.state
    power = applied_forces(system.packed, t, q, v, force)
    if system.has_work:
        out[out.shape[0] - 1] = power
    rest = out[2 * n + DRIVE_INTEGRALS :]
    _meet(system.hung, system, q, v, axes)
    for k in range(system.contacts.shape[0]):
        system.contacts[k].bristle = y[bristle_place(2 * n, k)]
    add_contacts(system.packed.joints, onset, system.contacts, force, rest)
    power = _solve(system.held, system.hung, system, t, out[n : 2 * n])
    out[2 * n] = power
    out[2 * n + 1] = abs(power)
    copy_to(out[:n], y[n : 2 * n])
    if not torques:
        return
    _note_torques(system.held, system.hung, system.state, system.torque)
    for k in range(system.torque.shape[0]):
        base = system.first_torque + TORQUE_INTEGRALS * k
        torque = system.torque[k]
        power = torque * v[system.packed.driven[k]]
        out[base + TORQUE] = torque
        out[base + TORQUE_SQUARE] = torque * torque
        out[base + POWER] = power
        out[base + POWER_SQUARE] = power * power


@compiled
def rates(system: System, onset: Array, t: float, y: Array, out: Array) -> None:
    """Do what ``evaluate`` does, once for all that do it now and then."""
    evaluate(system, onset, t, y, out, True)


@inlined
def _meet(hung: Hung | None, system: System, q: Array, v: Array, axes: Array) -> None:
    """Note the contacts, from the axes where they are known."""
    if hung is None:
        note_contacts(system.packed, system.contacts, q, v)
    else:
        note_contacts(system.packed, system.contacts, q, v, axes)


@inlined
def _solve(held: Held | None, hung: Hung | None, system: System, t: float, out: Array) -> float:
    """Fill the accelerations of the coordinates; returns the power of the drives, W."""
    if held is not None:
        return _hold(held, system.alpha, system.beta, system.state, t, out)
    if hung is not None:
        return _hang(hung, system.state, out)
    return 0.0


@compiled
def _hold(held: Held, alpha: float, beta: float, state: Array, t: float, force: Array) -> float:
    """Solve for multipliers and accelerations; see ``_solve``."""
    q, v, _, applied, _ = state
    copy_to(force, applied)
    evaluate_constraints(held, t, q, v)
    damping = 2.0 * alpha
    stiffness = beta * beta
    for row in range(held.phi.shape[0]):
        right = damping * held.phi_t[row] + stiffness * held.phi[row] - held.gamma[row]
        for c in range(force.shape[0]):
            right += held.jacobian[row, c] * held.inverse_mass[c] * force[c]
        held.right[row] = right
    solve(held)
    for row in range(held.phi.shape[0]):
        multiplier = held.multipliers[row]
        for c in range(force.shape[0]):
            force[c] -= held.jacobian[row, c] * multiplier
    power = 0.0
    for i in range(held.constraints.shape[0]):
        c = held.constraints[i]
        if c.kind == DRIVE:
            power -= held.multipliers[c.row] * drive_motion(held.motions[c.drive], t)[1]
    for i in range(force.shape[0]):
        force[i] *= held.inverse_mass[i]
    return power


@inlined
def _hang(hung: Hung, state: Array, out: Array) -> float:
    """Let articulated bodies go; see ``_solve``."""
    _, v, a, force, axes = state
    carry_branches(hung.links, v, a, axes, hung.carried)
    articulate(hung.links, v, axes, hung.carried, force, hung.bodies)
    release(hung.links, hung.bodies, out, a)
    # Against the forces on prescribed bodies: what is applied there, and what branches pass on
    # at their hinges.
    power = -forced_power(hung.prescribed, v, a, force)
    for i in range(hung.links.shape[0]):
        link = hung.links[i]
        b = link.body
        power -= hung.carried[i, 0] * (force[b] - link.mass * a[b])
        power -= hung.carried[i, 1] * (force[b + 1] - link.mass * a[b + 1])
    return power


@inlined
def _note_torques(held: Held | None, hung: Hung | None, state: Array, torque: Array) -> None:
    if held is not None:
        drive = 0
        for i in range(held.constraints.shape[0]):
            if held.constraints[i].kind == DRIVE:
                torque[drive] = -held.multipliers[held.constraints[i].row]
                drive += 1
    if hung is not None:
        q, _, a, force, axes = state
        # Add to the forces on prescribed bodies those of the branches, less their inertia.
        for i in range(hung.links.shape[0] - 1, -1, -1):
            link = hung.links[i]
            b, p = link.body, link.before
            fx = force[b] - link.mass * a[b]
            fy = force[b + 1] - link.mass * a[b + 1]
            if p >= 0:
                force[p] += fx
                force[p + 1] += fy
                if link.parent < 0:
                    # Links of a branch need only the sums of forces: hinges bear no moment.
                    rx, ry = arm(link.before_x, link.before_y, axes, p)
                    force[p + 2] += rx * fy - ry * fx
        subtract_inertia(hung.prescribed.parts, a, force)
        drive_torques(hung.prescribed, q, axes, force, torque)


@compiled
def drift(held: Held | None) -> tuple[float, float]:
    """Return the largest errors of the constraints and their rates in the last evaluation."""
    position = velocity = 0.0
    if held is not None:
        for row in range(held.phi.shape[0]):
            position = max(position, abs(held.phi[row]))
            velocity = max(velocity, abs(held.phi_t[row]))
    return position, velocity


@compiled
def keep_constraints(held: Held | None, t: float, y: Array) -> None:
    """Move a state onto the constraints, where it could leave them."""
    if held is not None:
        n = held.inverse_mass.shape[0]
        project(held, t, y[:n], y[n : 2 * n])


def system_of(packed: Packed, constraints: Constraints, alpha: float, beta: float) -> System:
    """The equations of a linkage in all its coordinates; see ``System``."""
    held = constraints.held(packed.mass)
    return _system(packed, held, None, packed.mass.size, alpha, beta)


def state_size(system: System) -> int:
    """Return the number of components of the state of a system."""
    return system.first_torque + TORQUE_INTEGRALS * system.torque.size + system.has_work


def tree_system_of(packed: Packed, tree: Tree, position: Array) -> System:
    """The equations of a linkage as an open tree that starts in a position of all its bodies."""
    prescribed = tree.prescribed._replace(work=tree.prescribed.work.copy())
    begin_motion(prescribed, 0.0, position)
    count = len(tree.links)
    hung = Hung(
        links=tree.links,
        prescribed=prescribed,
        bodies=np.zeros(count, ARTICULATED),
        carried=np.zeros((count, CARRIED)),
        balance=np.zeros(tree.size),
    )
    return _system(packed, None, hung, tree.size, 0.0, 0.0)


def _system(
    packed: Packed, held: Held | None, hung: Hung | None, size: int, alpha: float, beta: float
) -> System:
    bristles = np.flatnonzero(packed.joints["friction"]["bristle_stiffness"] > 0.0)
    return System(
        packed=packed,
        held=held,
        hung=hung,
        size=size,
        state=np.zeros((5, packed.mass.size)),
        felt=max((1 + bristle_place(2 * size, int(k)) for k in bristles), default=2 * size),
        contacts=np.zeros(len(packed.joints), CONTACT),
        torque=np.zeros(packed.driven.size),
        first_torque=2 * size + DRIVE_INTEGRALS + JOINT_INTEGRALS * len(packed.joints),
        alpha=alpha,
        beta=beta,
        has_work=has_work(packed),
    )
