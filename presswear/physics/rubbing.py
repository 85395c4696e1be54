"""Friction moments of rigid pin joints: the friction law at the joint force and the relative spin.

With the joint force F, the radius r of the bearing, the spin omega of the pin relative to
the bearing and the friction law F_t, the moment on the pin is r F_t(r omega, |F|). With the
ramp it is -c_f c_d |F| r sign(omega), with the friction coefficient c_f and the dynamic
correction c_d.
"""

import math

from presswear.physics.constraints import ConstraintSystem, multipliers_of
from presswear.physics.friction_and_normal import friction_force
from presswear.physics.packed import RUBBING
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

# Largest change of friction moments in the last iteration, over the largest moment
FRICTION_TOL = 1e-12
MAX_ITERATIONS = 100  # repeated substitutions


@inlined
def relative_spin(joint: Records, v: Array) -> float:
    """Return the spin of the pin relative to the bearing, rad/s, of a record of RUBBING."""
    spin = 0.0
    if joint.pin_body >= 0:
        spin += v[joint.pin_body + 2]
    if joint.bearing_body >= 0:
        spin -= v[joint.bearing_body + 2]
    return spin


@lazily_compiled(0, RUBBING, 1, 0)
def friction_moment(joint: Records, v: Array, joint_force: float) -> float:
    """Return the friction moment on the pin, N m, under a joint force, N."""
    radius = joint.bearing_radius
    return radius * friction_force(
        radius * relative_spin(joint, v), joint_force, joint.friction
    )


@compiled
def friction_power(rubbing: Records, v: Array) -> float:
    """Return the power that the present moments turn into heat, W."""
    power = 0.0
    for k in range(rubbing.shape[0]):
        power -= rubbing[k].moment * relative_spin(rubbing[k], v)
    return power


@compiled
def add_friction(
    constraints: ConstraintSystem,
    rubbing: Records,
    alpha: float,
    beta: float,
    v: Array,
    force: Array,
) -> None:
    """Add the friction moments of rigid joints to generalized forces, and solve again.

    The moments depend on the joint forces, which are multipliers, and the joint forces
    on the moments. Repeated substitution converges if c_f r is small against the levers
    of the joint forces. If it does not converge, the forces are NaN, which ends the run.
    """
    for k in range(rubbing.shape[0]):
        rubbing[k].moment = 0.0
    for _ in range(MAX_ITERATIONS):
        change = 0.0
        greatest = 0.0
        for k in range(rubbing.shape[0]):
            joint = rubbing[k]
            x = constraints.multipliers[joint.row]
            y = constraints.multipliers[joint.row + 1]
            moment = friction_moment(joint, v, math.sqrt(x * x + y * y))
            difference = moment - joint.moment
            joint.moment = moment
            if joint.pin_body >= 0:
                force[joint.pin_body + 2] += difference
            if joint.bearing_body >= 0:
                force[joint.bearing_body + 2] -= difference
            change = max(change, abs(difference))
            greatest = max(greatest, abs(moment))
        if change <= FRICTION_TOL * greatest:
            return
        multipliers_of(constraints, alpha, beta, force)
    for c in range(force.shape[0]):
        force[c] = math.nan
