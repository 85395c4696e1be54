"""Equations of motion, in all coordinates or in those of an open tree.

In all coordinates the equations have index 1 (equations 14 to 20 of the paper):
M q'' + Phi_q^T lambda = g with Phi_q q'' = gamma - 2 alpha Phi' - beta^2 Phi.
If clearance cuts every loop that has a freedom, the coordinates of the open tree suffice,
and there are no constraints. The equations of the tree are written for the linkage
(``physics.equations``) and called by the address of their machine code. In all
coordinates the forces on the bodies are written and called in this way.

The state is y = (x, x', states of interactions, integrals), see
``physics.equations.layout``.
"""

from typing import NamedTuple

from presswear.physics.constraints import (
    Constraints,
    ConstraintSystem,
    evaluate_constraints,
    factor,
    multipliers_of,
)
from presswear.physics.drive_motion import drive_motion
from presswear.physics.equations.function import (
    FORCE,
    RATES,
    Model,
    Written,
    fill,
    written,
)
from presswear.physics.equations.layout import (
    DRIVE_EXCHANGE,
    DRIVE_WORK,
    FRICTION_LOSS,
    POWER,
    POWER_SQUARE,
    TORQUE,
    TORQUE_INTEGRALS,
    TORQUE_SQUARE,
    Layout,
)
from presswear.physics.equations.writer import Equations
from presswear.physics.packed import Packed, drive_rate
from presswear.physics.rubbing import add_friction, friction_power
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, copy_to, inlined


class System(NamedTuple):
    """Linkage in the form that kernels read, with working space."""

    packed: Packed
    constraints: ConstraintSystem | None  # in all coordinates
    equations: Written  # with constraints these are the forces on all bodies
    layout: Layout  # places of the parts of the state
    # Coordinates, rates, accelerations and applied forces of all bodies, each (3 bodies,)
    q: Array
    v: Array
    a: Array
    force: Array
    contacts: Records
    has_abrupt: bool  # the force of a joint begins with a jump
    alpha: float  # Baumgarte's coefficients, 1/s
    beta: float


def system_of(
    packed: Packed,
    equations: Equations,
    model: Model,
    constraints: Constraints | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
) -> System:
    """Return the equations of a linkage; ``model`` holds the arrays that they fill.

    With constraints, ``equations`` are the forces on all bodies; Baumgarte's
    coefficients are 1/s.
    """
    return System(
        packed=packed,
        constraints=None if constraints is None else constraints.system(packed.mass),
        equations=written(equations, model),
        layout=equations.layout,
        q=model.bodies[0],
        v=model.bodies[1],
        a=model.bodies[2],
        force=model.bodies[FORCE],
        contacts=model.contact_records,
        has_abrupt=bool(packed.joints["normal"]["abrupt"].any()),
        alpha=alpha,
        beta=beta,
    )


@inlined
def evaluate(
    system: System,
    constraints: ConstraintSystem | None,
    t: float,
    y: Array,
    out: Array,
    level: int,
) -> None:
    """Fill dy/dt, at level END also the motion and the contacts, and the multipliers.

    ``constraints`` is the field of ``system``. It is a parameter, so that the compiler
    knows if it is None.
    """
    if constraints is None:
        fill(system.equations, t, y, out, level)
    else:
        evaluate_constrained(system, constraints, t, y, out, level)


@inlined
def evaluate_forces(system: System, t: float, y: Array, out: Array, level: int) -> None:
    """Fill coordinates, rates, forces and contacts of a linkage with constraints."""
    q = system.q
    v = system.v
    n = system.layout.coordinates
    copy_to(q, y[:n])
    copy_to(v, y[n : 2 * n])
    fill(system.equations, t, y, out, level)


@compiled
def evaluate_constrained(
    system: System,
    constraints: ConstraintSystem,
    t: float,
    y: Array,
    out: Array,
    level: int,
) -> None:
    """Fill dy/dt, the motion and the contacts of a linkage with constraints."""
    packed = system.packed
    layout = system.layout
    n = layout.coordinates
    energies = out[layout.first_energy : layout.first_wear_integral]
    # Without friction in contacts and without motors the forces do not fill these rates.
    energies[FRICTION_LOSS] = 0.0
    energies[DRIVE_WORK] = 0.0
    energies[DRIVE_EXCHANGE] = 0.0
    evaluate_forces(system, t, y, out, level)
    v = system.v
    a = system.a
    force = system.force
    for i in range(n):
        force[i] += packed.weight[i]
    power, heat = solve_multipliers(system, constraints, packed.rubbing, t, out)
    copy_to(out[:n], v)
    copy_to(a, out[n : 2 * n])
    if level >= RATES:
        energies[DRIVE_WORK] += power
        energies[DRIVE_EXCHANGE] += abs(power)
        energies[FRICTION_LOSS] += heat
    for row in range(constraints.records.shape[0]):
        drive = constraints.records[row].drive
        if drive >= 0:
            torque = -constraints.multipliers[row]
            base = layout.first_torque + TORQUE_INTEGRALS * drive
            power = torque * drive_rate(packed.driven, constraints.motions, drive, t, v)
            out[base + TORQUE] = torque
            out[base + TORQUE_SQUARE] = torque * torque
            out[base + POWER] = power
            out[base + POWER_SQUARE] = power * power


@compiled
def solve_multipliers(
    system: System,
    constraints: ConstraintSystem,
    rubbing: Records,
    t: float,
    slopes: Array,
) -> tuple[float, float]:
    """Fill multipliers and accelerations.

    ``slopes`` is dy/dt. Return the power of the drives and the heat from friction in
    rigid joints, W.
    """
    q = system.q
    v = system.v
    alpha = system.alpha
    beta = system.beta
    out = slopes[v.shape[0] : 2 * v.shape[0]]
    copy_to(out, system.force)
    evaluate_constraints(constraints, t, q, v)
    factor(constraints)
    multipliers_of(constraints, alpha, beta, out)
    add_friction(constraints, rubbing, alpha, beta, v, out)
    heat = friction_power(rubbing, v)
    for row in range(constraints.phi.shape[0]):
        multiplier = constraints.multipliers[row]
        for c in range(out.shape[0]):
            out[c] -= constraints.jacobian[row, c] * multiplier
    power = 0.0
    for row in range(constraints.records.shape[0]):
        drive = constraints.records[row].drive
        if drive >= 0 and not constraints.records[row].geared:
            _, speed, _ = drive_motion(constraints.motions[drive], t)
            power -= constraints.multipliers[row] * speed
    for i in range(out.shape[0]):
        out[i] *= constraints.inverse_mass[i]
    return power, heat
