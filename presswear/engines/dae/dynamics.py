"""Equations of motion, in all coordinates or in the fewest.

In all coordinates they are of index 1 (equations 14 to 20 of the paper): M q'' + Phi_q^T lambda
= g with Phi_q q'' = gamma - 2 alpha Phi' - beta^2 Phi.  Where clearance cuts every loop that has
a freedom, the coordinates of the open tree do, and there are no constraints. These equations are
written for the linkage (``physics.equations``) and called by the address of their machine code,
as are the forces on all bodies in the other case.

The state is y = (x, x', integrals): coordinates, rates, and as quadratures the drive
work, its absolute value, per clearance joint its losses and wear, and per drive its torque and
power and their squares; last, where there is any, the work of loads and dampers, and the heat of
friction in rigid joints (``physics.equations.integrals``).
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
from presswear.physics.drive_motion import drive_motion
from presswear.physics.equations.function import Model, Written, fill, written
from presswear.physics.equations.integrals import (
    POWER,
    POWER_SQUARE,
    TORQUE,
    TORQUE_INTEGRALS,
    TORQUE_SQUARE,
    Layout,
    bristle_place,
)
from presswear.physics.equations.writer import Equations
from presswear.physics.packed import Packed
from presswear.physics.rubbing import add_friction, friction_power
from presswear.tools.arrays import Array
from presswear.tools.compile import (
    Records,
    compiled,
    copy_to,
    inlined,
)


class System(NamedTuple):
    """Linkage as the kernels see it, with working space."""

    packed: Packed
    held: Held | None  # constraints, in all coordinates
    equations: Written  # where there are constraints, the forces on all bodies
    size: int  # number of coordinates
    # Rows POSITION to FORCE: q, v, a, applied generalized forces, and room; (5, 3 bodies)
    state: Array
    felt: int  # number of the first components of the state, on which slopes depend
    checked: int  # number of the first components of the state that hold all with an error
    contacts: Records
    first_torque: int  # index in the state of the integrals of the first drive
    alpha: float  # Baumgarte's coefficients, 1/s
    beta: float
    has_work: bool  # whether loads or dampers do work


def system_of(
    packed: Packed,
    equations: Equations,
    model: Model,
    constraints: Constraints | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
) -> System:
    """Return the equations of a linkage; ``model`` holds the arrays that they fill.

    With constraints, ``equations`` are the forces on all bodies; Baumgarte's coefficients are 1/s.
    """
    size = equations.chain.size
    layout = Layout.of(size, packed)
    return System(
        packed=packed,
        held=None if constraints is None else constraints.held(packed.mass),
        equations=written(equations, model),
        size=size,
        state=model.bodies,
        felt=_felt(packed, size),
        checked=_checked(packed, layout),
        contacts=model.contact_records,
        first_torque=layout.first_torque,
        alpha=alpha,
        beta=beta,
        has_work=layout.has_work,
    )


def _felt(packed: Packed, size: int) -> int:
    """Return the number of the first components of the state on which slopes depend."""
    bristles = np.flatnonzero(packed.joints["friction"]["bristle_stiffness"] > 0.0)
    return max((1 + bristle_place(2 * size, int(k)) for k in bristles), default=2 * size)


def _checked(packed: Packed, layout: Layout) -> int:
    """Return the number of the first components of the state that hold all with an error."""
    joints = packed.joints
    is_more = joints["normal"]["abrupt"] | (joints["friction"]["bristle_stiffness"] > 0.0)
    return layout.first_torque if is_more.any() else layout.drive_work


def state_size(system: System) -> int:
    """Return the number of components of the state of a system."""
    return load_work_place(system) + system.has_work + (system.packed.rubbing is not None)


@inlined
def load_work_place(system: System) -> int:
    """Return the place in the state of the work of loads and dampers, if there is any."""
    return system.first_torque + TORQUE_INTEGRALS * system.packed.driven.shape[0]


@inlined
def evaluate(system: System, held: Held | None, t: float, y: Array, out: Array, level: int) -> None:
    """Fill dy/dt, and at level END the motion and the contacts; leaves multipliers behind.

    ``held`` is that of the system, so that the compiler sees whether it is None.
    """
    if held is None:
        fill(system.equations, t, y, out, level)
    else:
        evaluate_held(system, held, t, y, out, level)


@inlined
def place_held(system: System, t: float, y: Array, out: Array, level: int) -> None:
    """Fill coordinates, rates, forces and contacts of a linkage with constraints."""
    q, v, _, _, _ = system.state
    n = system.size
    copy_to(q, y[:n])
    copy_to(v, y[n : 2 * n])
    fill(system.equations, t, y, out, level)


@compiled
def evaluate_held(system: System, held: Held, t: float, y: Array, out: Array, level: int) -> None:
    """Fill dy/dt, the motion and the contacts of a linkage with constraints."""
    place_held(system, t, y, out, level)
    _, v, a, force, _ = system.state
    packed, n = system.packed, system.size
    for i in range(n):
        force[i] += packed.weight[i]
    coefficients = system.alpha, system.beta
    power = solve_multipliers(held, packed.rubbing, *coefficients, system.state, t, out)
    out[2 * n] = power
    out[2 * n + 1] = abs(power)
    copy_to(out[:n], v)
    copy_to(a, out[n : 2 * n])
    for row in range(held.constraints.shape[0]):
        drive = held.constraints[row].drive
        if drive >= 0:
            torque = -held.multipliers[row]
            base = system.first_torque + TORQUE_INTEGRALS * drive
            power = torque * v[packed.driven[drive]]
            out[base + TORQUE] = torque
            out[base + TORQUE_SQUARE] = torque * torque
            out[base + POWER] = power
            out[base + POWER_SQUARE] = power * power


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
