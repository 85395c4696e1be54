"""Equations of motion, in all coordinates or in the fewest.

In all coordinates they are of index 1 (equations 14 to 20 of the paper): M q'' + Phi_q^T lambda
= g with Phi_q q'' = gamma - 2 alpha Phi' - beta^2 Phi.  Where clearance cuts every loop that has
a freedom, the coordinates of the open tree do, and there are no constraints.

The state is y = (x, x', integrals): coordinates, rates, and as quadratures the drive
work, its absolute value, per clearance joint the rates of ``add_contacts``, and per drive its
torque and power and their squares; last, where there is any, the work of loads and dampers, and
the heat of friction in rigid joints.
"""

from typing import NamedTuple

import numpy as np

from presswear.physics.constraints import (
    Constraints,
    Held,
    evaluate_constraints,
    factor,
    multipliers_of,
)
from presswear.physics.contact import (
    CONTACT,
    note_contact,
    note_ends,
    note_radial,
    note_sliding,
    note_surfaces,
)
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
from presswear.physics.rubbing import add_friction, friction_power
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
from presswear.tools.arrays import Array
from presswear.tools.compile import PackedArguments, Records, compiled, copy_to, inlined, unpack
from presswear.tools.lanes import anywhere, where

POSITION, RATE, ACCELERATION, FORCE, AXES = range(5)  # rows of ``System.state``
NUMBERS = CONTACT.itemsize // 8  # of a contact
DRIVE_INTEGRALS = 2  # integrals before those of the joints: drive work and its absolute value, J
TORQUE, TORQUE_SQUARE, POWER, POWER_SQUARE, TORQUE_INTEGRALS = range(5)  # per drive, their number


class OpenTree(NamedTuple):
    """Open tree with working space."""

    links: Records
    prescribed: Prescribed
    bodies: Records  # of ARTICULATED
    carried: Array  # (links, CARRIED)
    size: int  # number of coordinates


class Members(NamedTuple):
    """Replicates that are computed together, and arrays of all with the lanes as last axis."""

    runs: tuple[PackedArguments, ...]  # integration of each replicate; the last in unused lanes
    used: int  # number of lanes
    time: Array  # at the start of the step on trial, s, (LANES,)
    length: Array  # of it, s; 0 where a lane waits
    scratch: Array  # power of applied forces, W, and time, s, lanes (2,)
    power: Array  # the same numbers, (2, lanes)
    state: Array  # (5, 3 bodies, lanes)
    contacts: Array  # (joints, numbers of CONTACT, lanes)


class System(NamedTuple):
    """Linkage as the kernels see it, with working space."""

    packed: Packed
    held: Held | None  # constraints, in all coordinates
    tree: OpenTree | None  # in the fewest coordinates; the compiler leaves out the other's code
    size: int  # number of coordinates
    # Rows POSITION to AXES: q, v, a, applied generalized forces, and of a tree axes, see
    # ``place_links``; (5, 3 bodies)
    state: Array
    felt: int  # number of the first components of the state, on which slopes depend
    contacts: Records
    contact_rows: Array  # the same as numbers, (joints, numbers of CONTACT)
    onset: Array  # latched closing speeds of the joints, as of ``RecorderState``
    torque: Array  # (drives,)
    first_torque: int  # index in the state of the integrals of the first drive
    alpha: float  # Baumgarte's coefficients, 1/s
    beta: float
    has_work: bool  # whether loads or dampers do work
    # One of both, the compiler leaves out the other's code
    alone: Packed | None  # of a single replicate
    members: Members | None  # of several replicates


def system_of(
    packed: Packed,
    equations: Constraints | Tree,
    position: Array,
    alpha: float = 0.0,
    beta: float = 0.0,
    onset: Array | None = None,
) -> System:
    """Return the equations of a linkage in a position of all its bodies.

    They have constraints of all coordinates, with Baumgarte's coefficients, 1/s, or those of the
    tree, whose coordinates are the fewest.  ``onset`` are the latched closing speeds; else all are
    open.
    """
    held = tree = None
    if isinstance(equations, Tree):
        prescribed = equations.prescribed._replace(work=equations.prescribed.work.copy())
        begin_motion(prescribed, 0.0, position)
        count, size = len(equations.links), equations.size
        bodies, carried = np.zeros(count, ARTICULATED), np.zeros((count, CARRIED))
        tree = OpenTree(equations.links, prescribed, bodies, carried, size)
    else:
        held, size = equations.held(packed.mass), packed.mass.size
    contacts = np.zeros(len(packed.joints), CONTACT)
    bristles = np.flatnonzero(packed.joints["friction"]["bristle_stiffness"] > 0.0)
    return System(
        packed=packed,
        held=held,
        tree=tree,
        size=size,
        state=np.zeros((5, packed.mass.size)),
        felt=max((1 + bristle_place(2 * size, int(k)) for k in bristles), default=2 * size),
        contacts=contacts,
        contact_rows=contacts.view(np.float64).reshape(len(contacts), NUMBERS),
        onset=np.zeros(len(contacts)) if onset is None else onset,
        torque=np.zeros(packed.driven.size),
        first_torque=2 * size + DRIVE_INTEGRALS + JOINT_RATES * len(packed.joints),
        alpha=alpha,
        beta=beta,
        has_work=has_work(packed),
        alone=packed,
        members=None,
    )


def state_size(system: System) -> int:
    """Return the number of components of the state of a system."""
    return load_work_place(system) + system.has_work + (system.packed.rubbing is not None)


@inlined
def load_work_place(system: System) -> int:
    """Return the place in the state of the work of loads and dampers, if there is any."""
    return system.first_torque + TORQUE_INTEGRALS * system.torque.shape[0]


@inlined
def bristle_place(coordinates: int, k: int) -> int:
    """Return the place in the state of the deflection of the bristles of joint ``k``."""
    return coordinates + DRIVE_INTEGRALS + JOINT_RATES * k + BRISTLE


@inlined
def place(tree: OpenTree | None, state: Array, t: float, y: Array) -> None:
    """Fill coordinates and rates of all bodies in a state."""
    q, v, a, _, axes = state
    n = q.shape[0]
    if tree is None:
        copy_to(q, y[:n])
        copy_to(v, y[n : 2 * n])
    else:
        place_prescribed(tree.prescribed, t, q, v, a, axes)
        place_links(tree.links, y[: tree.size], y[tree.size : 2 * tree.size], q, v, axes)


@inlined
def accelerate(tree: OpenTree | None, state: Array, slope: Array) -> None:
    """Fill accelerations of all bodies in the state placed last, from the slopes of the rates."""
    _, v, a, _, axes = state
    if tree is None:
        copy_to(a, slope)
    else:
        accelerate_links(tree.links, slope, v, axes, a)


@inlined
def evaluate(
    system: System,
    held: Held | None,
    tree: OpenTree | None,
    alone: Packed | None,
    members: Members | None,
    t: float,
    y: Array,
    out: Array,
    torques: bool,
    is_end: bool,
) -> None:
    """Fill dy/dt, and all of the state but for accelerations; leaves multipliers behind.

    ``held`` to ``members`` are those of the system, so that the compiler sees which are None.  With
    ``torques`` the rates of the drives' integrals are filled as well.  Contacts that are held open
    are filled at the end of a step only, where touchdowns are looked for.
    """
    n = system.size
    place(tree, system.state, t, y)
    q, v, a, force, axes = system.state
    power = where(False, t, 0.0)
    if members is not None:
        power = apply_forces(system, members, t, force)
        note_members(system, members, q, v, axes, is_end)
    if alone is not None:
        power = applied_forces(alone, t, q, v, force)
        for k in range(system.contacts.shape[0]):
            if is_end or is_felt(alone.joints[k], system.onset[k]):
                if tree is None:
                    note_contact(alone, k, q, v, system.contacts[k])
                else:
                    note_contact(alone, k, q, v, system.contacts[k], axes)
    if system.has_work:
        out[load_work_place(system)] = power
    for k in range(system.contacts.shape[0]):
        system.contacts[k].bristle = y[bristle_place(2 * n, k)]
    rates = out[2 * n + DRIVE_INTEGRALS :]
    add_contacts(system.packed.joints, system.onset, system.contacts, force, rates)
    if held is not None:
        coefficients = system.alpha, system.beta
        power = solve_multipliers(held, system.packed.rubbing, *coefficients, system.state, t, out)
    if tree is not None:
        carry_branches(tree.links, v, a, axes, tree.carried)
        articulate(tree.links, v, axes, tree.carried, force, tree.bodies)
        release(tree.links, tree.bodies, out[n : 2 * n], a)
        # Against the forces on prescribed bodies: what is applied there, and what branches pass
        # on at their hinges.
        power = -forced_power(tree.prescribed, v, a, force)
        for i in range(tree.links.shape[0]):
            link = tree.links[i]
            b = link.body
            power -= tree.carried[i, 0] * (force[b] - link.mass * a[b])
            power -= tree.carried[i, 1] * (force[b + 1] - link.mass * a[b + 1])
    out[2 * n] = power
    out[2 * n + 1] = abs(power)
    copy_to(out[:n], y[n : 2 * n])
    if torques:
        _fill_torques(held, tree, system.state, system.torque)
        for k in range(system.torque.shape[0]):
            base = system.first_torque + TORQUE_INTEGRALS * k
            torque = system.torque[k]
            power = torque * v[system.packed.driven[k]]
            out[base + TORQUE] = torque
            out[base + TORQUE_SQUARE] = torque * torque
            out[base + POWER] = power
            out[base + POWER_SQUARE] = power * power


@inlined
def apply_forces(system: System, members: Members, t: float, force: Array) -> float:
    """Fill the generalized forces before those of contacts; returns their power, W."""
    copy_to(force, system.packed.weight)
    members.scratch[0], members.scratch[1] = 0.0, t
    is_constant = system.packed.springs.shape[0] == 0 and not system.has_work
    for i in range(0 if is_constant else members.used):
        if members.length[i] == 0.0:
            continue
        (run,) = unpack(members.runs[i])
        q, v, _, single, _ = run.system.state
        for c in range(q.shape[0]):
            q[c], v[c] = members.state[0, c, i], members.state[1, c, i]
        now = members.power[1, i]
        members.power[0, i] = applied_forces(run.system.packed, now, q, v, single)
        for c in range(q.shape[0]):
            members.state[3, c, i] = single[c]
    return members.scratch[0]


@inlined
def is_felt(joint: Records, onset_speed: float) -> bool:
    """Return whether a slope depends on a contact: it is not held open, or it has bristles."""
    return anywhere(onset_speed >= 0.0) or joint.friction.bristle_stiffness > 0.0


@inlined
def note_members(
    system: System, members: Members, q: Array, v: Array, axes: Array, is_end: bool
) -> None:
    """Fill the contacts of all joints; those of worn surfaces one replicate after the other.

    Those that are held open in all replicates are filled at the end of a step only.
    """
    for k in range(system.contacts.shape[0]):
        joint, contact = system.packed.joints[k], system.contacts[k]
        if not (is_end or is_felt(joint, system.onset[k])):
            continue
        note_ends(joint, q, v, contact, axes)
        if joint.surface_bins == 0:
            note_radial(joint, None, contact)
            note_sliding(contact)
            continue
        for i in range(members.used):
            (run,) = unpack(members.runs[i])
            if members.length[i] != 0.0 and (is_end or is_felt(joint, run.system.onset[k])):
                single, lanes = run.system.contact_rows[k], members.contacts[k]
                for c in range(single.shape[0]):
                    single[c] = lanes[c, i]
                note_surfaces(run.system.packed, k, run.system.contacts[k])
                for c in range(single.shape[0]):
                    lanes[c, i] = single[c]


@compiled
def solve_multipliers(
    held: Held,
    rubbing: Records | None,
    alpha: float,
    beta: float,
    state: Array,
    t: float,
    slopes: Array,
) -> float:
    """Fill multipliers and accelerations; returns the power of the drives, W.

    Friction in rigid joints fills its power, too, the last of ``slopes``.
    """
    q, v, _, force, _ = state
    out = slopes[v.shape[0] : 2 * v.shape[0]]
    copy_to(out, force)
    evaluate_constraints(held, t, q, v)
    factor(held)
    multipliers_of(held, alpha, beta, out)
    if rubbing is not None:
        add_friction(held, rubbing, alpha, beta, v, out)
        slopes[slopes.shape[0] - 1] = friction_power(rubbing, v)
    for row in range(held.phi.shape[0]):
        multiplier = held.multipliers[row]
        for c in range(out.shape[0]):
            out[c] -= held.jacobian[row, c] * multiplier
    power = 0.0
    for row in range(held.constraints.shape[0]):
        drive = held.constraints[row].drive
        if drive >= 0:
            power -= held.multipliers[row] * drive_motion(held.motions[drive], t)[1]
    for i in range(out.shape[0]):
        out[i] *= held.inverse_mass[i]
    return power


@inlined
def _fill_torques(held: Held | None, tree: OpenTree | None, state: Array, torque: Array) -> None:
    """Fill the torques of the drives; adds the forces of a tree to those on prescribed bodies."""
    if held is not None:
        for row in range(held.constraints.shape[0]):
            if held.constraints[row].drive >= 0:
                torque[held.constraints[row].drive] = -held.multipliers[row]
    if tree is not None:
        q, _, a, force, axes = state
        for i in range(tree.links.shape[0] - 1, -1, -1):
            link = tree.links[i]
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
        subtract_inertia(tree.prescribed.parts, a, force)
        drive_torques(tree.prescribed, q, axes, force, torque)
