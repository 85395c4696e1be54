"""Compiled normal and friction forces of a pin on its bearing.

See ``linkage.normal_law`` and ``linkage.friction_law`` for their settings.

The default laws are part of the kernels. Others and user laws are called by the address
of their machine code, so that no kernel is compiled again for them.
"""

import math
from typing import Any

import numpy as np

from presswear.linkage.friction_law import FRICTION_PARAMETERS, FrictionLaw, has_state
from presswear.linkage.normal_law import NORMAL_PARAMETERS, NormalLaw
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, address_of, call, compiled, floats, inlined
from presswear.tools.compiled_law import compile_function

# Numbers of laws that are part of the kernels, in place of addresses. INLINE is the
# power law, and the ramp of friction.
INLINE = 0
ROUND_FOUNDATION = 1
# Kinds of damping: a factor of the elastic force, a force beside it, that of a user law
FACTOR, VISCOUS, USER = range(3)

# Normal law for the kernels
NORMAL = np.dtype(
    [
        *floats("stiffness", "exponent", "damping", "clearance"),
        # address of a function of NORMAL_PARAMETERS, whose force is elastic at rest
        ("address", np.int64),
        ("kind", np.int64),  # kind of damping
        # power law with which the time of a contact is estimated
        *floats("estimated_stiffness", "estimated_exponent"),
        ("abrupt", np.bool_),  # the force begins with a jump
    ]
)

# Friction law for the kernels
FRICTION = np.dtype(
    [
        *floats("coefficient", "lower", "upper"),
        ("force", np.int64),  # address of a function of FRICTION_PARAMETERS
    ]
)

# Quadrature of the energy of elastic forces that have no closed form
_gauss_points, _gauss_weights = np.polynomial.legendre.leggauss(16)
ABSCISSAE = tuple(map(float, _gauss_points))
WEIGHTS = tuple(map(float, _gauss_weights))

# Smallest closing speed used in the damping term, m/s. The damping term divides by the
# closing speed at touchdown, which goes to zero where a pin grazes; below this speed
# the kinetic energy of a gram is 5e-16 J.
ONSET_SPEED_FLOOR = 1e-6


@inlined
def elastic_force(penetration: float, stiffness: float, exponent: float) -> float:
    """Return the elastic contact force K delta^n, N; zero when open."""
    if penetration <= 0.0:
        return 0.0
    # n = 3/2 and 1 are by far the most common, and cheaper without a power.
    if exponent == 1.5:
        return stiffness * penetration * math.sqrt(penetration)
    if exponent == 1.0:
        return stiffness * penetration
    return float(stiffness * penetration**exponent)


@compiled
def liu_force(
    penetration: float,
    rate: float,
    onset_speed: float,
    stiffness: float,
    exponent: float,
    damping: float,
    clearance: float,
) -> float:
    """Return the elastic force of a conforming pin, N: K delta^1.5 / sqrt(1 + delta / c).

    With K of ``linkage.normal_law.liu_stiffness`` it is (pi / 2) delta E* b sqrt(delta / (2
    (c + delta))) of Liu, Zhang and Yang (2007).
    """
    return (
        stiffness
        * penetration
        * math.sqrt(penetration / (1.0 + penetration / clearance))
    )


def _power_series(count: int) -> tuple[Array, Array]:
    """Return coefficients of g and h of ``round_foundation`` in powers of u.

    d(s - (1 - 2 u) sin s)/du = 8 sqrt(u (1 - u)) gives g. The second derivative of
    (1 + 2 (1 - 2 u)^2) s - 3 (1 - 2 u) sin s is 16 s = 32 asin(sqrt(u)), which gives h.
    """
    n = np.arange(1, count)
    root = np.cumprod([1.0, *((n - 1.5) / n)])  # coefficients of sqrt(1 - u)
    angle = np.cumprod([1.0, *((n - 0.5) / n)])  # coefficients of 1 / sqrt(1 - u)
    n = np.arange(count)
    force = 1.5 * root / (n + 1.5)
    energy = 3.75 * angle / ((2 * n + 1) * (n + 1.5) * (n + 2.5))
    return force, energy


def _polynomials(degree: int) -> list[tuple[float, ...]]:
    """Return coefficients of g and h in x = (delta - sqrt(2) c) / (delta + sqrt(2) c), from x^0.

    For all penetrations x lies between -1 and 1. Interpolation at the points of
    Chebyshev converges as 11.6^-degree, because g and h are singular at u = 1 only, and
    u is below 1/2.
    """
    results = []
    for series in _power_series(60):
        polynomial = np.polynomial.Polynomial(series)

        def at(x: Array, function: np.polynomial.Polynomial = polynomial) -> Array:
            ratio = math.sqrt(2.0) * (1.0 + x)  # delta (1 - x) / c
            return np.asarray(function(0.5 * ratio / (1.0 - x + ratio)))

        chebyshev = np.polynomial.Chebyshev.interpolate(at, degree)
        results.append(
            tuple(map(float, chebyshev.convert(kind=np.polynomial.Polynomial).coef))
        )
    return results


# Even degree; the error is 6e-15
ROUND_FORCE, ROUND_ENERGY = _polynomials(12)


@inlined
def polynomial(coefficients: tuple[float, ...], x: float) -> float:
    """Return a polynomial of even degree from its coefficients, the constant first."""
    # Even and odd terms are summed separately, because two short chains of products take
    # less time than a long chain.
    square = x * x
    last = len(coefficients) - 1
    even = coefficients[last]
    odd = coefficients[last - 1]
    for i in range(1, last // 2):
        even = even * square + coefficients[last - 2 * i]
        odd = odd * square + coefficients[last - 2 * i - 1]
    return even * square + coefficients[0] + x * odd


@inlined
def round_foundation(
    penetration: float, stiffness: float, clearance: float
) -> tuple[float, float]:
    """Return force, N, and energy, J, of a round pin on an elastic foundation, if it is closed.

    The overlap e cos(x) - c with e = c + delta is positive up to s, cos s = c / e. Its
    integrals give F = k_w b R (e s - c sin s) = K delta sqrt(delta c / e) g(u) and U =
    k_w b R / 2 [(e^2 + 2 c^2) s - 3 e c sin s] = 2/5 K delta^2 sqrt(delta c / e) h(u)
    with u = sin^2(s / 2) = delta / (2 e). g and h are 1 at u = 0. They are polynomials
    here, because the differences in F and U lose their digits at small u.
    """
    reach = max(penetration, 0.0)
    # K delta sqrt(delta c / e)
    small_angle_force = (
        stiffness * reach * math.sqrt(reach * clearance / (clearance + reach))
    )
    scale = math.sqrt(2.0) * clearance
    x = (reach - scale) / (reach + scale)
    force = small_angle_force * polynomial(ROUND_FORCE, x)
    energy = 0.4 * reach * small_angle_force * polynomial(ROUND_ENERGY, x)
    return force, energy


# Elastic forces of NORMAL_PARAMETERS by name, or the number of a law in the kernels
ELASTICITIES: dict[str, Any] = {
    "power": INLINE,
    "liu": liu_force,
    "foundation": ROUND_FOUNDATION,
}


@inlined
def elastic_at(law: Records, penetration: float) -> float:
    """Return the elastic force, N, at a penetration, m, by a record of NORMAL."""
    if law.address == INLINE:
        return elastic_force(penetration, law.stiffness, law.exponent)
    if law.address == ROUND_FOUNDATION:
        force, _ = round_foundation(penetration, law.stiffness, law.clearance)
        return force
    if penetration <= 0.0:
        return 0.0
    numbers = (law.stiffness, law.exponent, law.damping, law.clearance)
    return call(law.address, (penetration, 0.0, 1.0, *numbers))


@inlined
def elastic_of(law: Records, penetration: float) -> tuple[float, float]:
    """Return the elastic force, N, and its energy, J, at a penetration, m."""
    if not penetration > 0.0:
        return 0.0, 0.0
    if law.address == ROUND_FOUNDATION:
        return round_foundation(penetration, law.stiffness, law.clearance)
    elastic = elastic_at(law, penetration)
    if law.address == INLINE:
        return elastic, elastic * penetration / (law.exponent + 1.0)
    energy = 0.0
    for i in range(len(ABSCISSAE)):
        # Integrate over the root of the penetration, in which nearly all laws are smooth.
        x = 0.5 * (1.0 + ABSCISSAE[i])
        energy += WEIGHTS[i] * x * elastic_at(law, penetration * x * x)
    return elastic, energy * penetration


@inlined
def normal_force(
    law: Records, elastic: float, penetration: float, rate: float, onset_speed: float
) -> float:
    """Return the normal contact force, N, from its elastic part, N; never adhesive.

    ``penetration`` is delta, m, ``rate`` the closing speed in the damping term, m/s, and
    ``onset_speed`` the closing speed at touchdown delta_dot_0, m/s, above zero.
    """
    if law.kind == FACTOR:  # equation 8
        return max(elastic * (1.0 + law.damping * rate / onset_speed), 0.0)
    if law.kind == VISCOUS:  # Kelvin and Voigt; ``damping`` is D, N s/m
        return max(elastic + law.damping * rate, 0.0)
    numbers = (law.stiffness, law.exponent, law.damping, law.clearance)
    force = call(law.address, (penetration, rate, onset_speed, *numbers))
    # NaN is returned as it is, and ends the run.
    return 0.0 if force < 0.0 else force


@compiled
def corner_ahead(sliding: float, sense: float, law: Records) -> float:
    """Return the next corner of the friction ramp, m/s, upwards or, by a sense of -1, downwards."""
    nearest = math.inf
    if law.force == INLINE and law.coefficient > 0.0:
        for corner in (-law.upper, -law.lower, law.lower, law.upper):
            distance = sense * (corner - sliding)
            # A ramp that begins at rest is straight there.
            if distance > 0.0 and corner != 0.0:
                nearest = min(nearest, distance)
    return sliding + sense * nearest


@compiled
def threlfall_friction(
    sliding: float, normal: float, coefficient: float, lower: float, upper: float
) -> float:
    """Return the friction, N: -c_f F_n (1 - exp(-3 v / v_1)), v up to v_1 (Threlfall 1978)."""
    fraction = -math.expm1(-3.0 * min(abs(sliding) / upper, 1.0))
    return -math.copysign(coefficient * fraction * normal, sliding)


@inlined
def ramp_friction(
    sliding: float, normal: float, coefficient: float, lower: float, upper: float
) -> float:
    """Return the friction force along t, N: -c_f c_d F_n sign(v_t) (equation 9).

    The dynamic correction c_d rises from 0 at the lower speed to 1 at the upper.
    """
    speed = abs(sliding)
    ramp = max((speed - lower) / (upper - lower), 0.0) if speed < upper else 1.0
    return -math.copysign(coefficient * ramp * normal, sliding)


# Friction forces of FRICTION_PARAMETERS by name
FRICTION_FORCES: dict[str, Any] = {
    "ramp": ramp_friction,
    "threlfall": threlfall_friction,
}


@inlined
def friction_force(sliding: float, normal: float, law: Records) -> float:
    """Return the friction force along t, N, by a record of FRICTION."""
    if law.force == INLINE:
        return ramp_friction(sliding, normal, law.coefficient, law.lower, law.upper)
    return call(law.force, (sliding, normal, law.coefficient, law.lower, law.upper))


@compiled
def fill_friction(law: Records, sliding: Array, normal: Array, force: Array) -> None:
    """Fill friction forces, N, at sliding speeds, m/s, under normal forces, N; shape (n,)."""
    for i in range(sliding.shape[0]):
        force[i] = friction_force(sliding[i], normal[i], law)


# Penetrations over the clearance through which the power law of a user law is fitted
POWER_LAW_RANGE = 1e-4, 1e-2
# Smallest ratio of the force to the elastic force at touchdown of a law that begins with a
# jump
ABRUPT = 1e3
TOUCHDOWN_DEPTH = 1e-9  # penetration at touchdown over the clearance


def normal_record(law: NormalLaw, clearance: float) -> Records:
    """Return a normal law as a record of NORMAL, for a clearance, m."""
    record = np.zeros(1, NORMAL).view(np.recarray)[0]
    record["stiffness"] = law.stiffness
    record["exponent"] = law.exponent
    record["estimated_stiffness"] = law.stiffness
    record["estimated_exponent"] = law.exponent
    record["damping"] = law.damping
    record["clearance"] = clearance
    force: Any = ELASTICITIES[law.elasticity]
    if law.viscosity > 0.0:
        record["damping"] = law.viscosity
        record["kind"] = VISCOUS
    if law.user_law is not None:
        force = compile_function(law.user_law, NORMAL_PARAMETERS)
        record["kind"] = USER
    if not isinstance(force, int):
        force = address_of(force, len(NORMAL_PARAMETERS))
    record["address"] = force
    if law.user_law is not None:
        first, last = (fraction * clearance for fraction in POWER_LAW_RANGE)
        low, _ = elastic_of(record, first)
        high, _ = elastic_of(record, last)
        exponent = math.log(high / low) / math.log(last / first)
        record["estimated_exponent"] = exponent
        record["estimated_stiffness"] = high / last**exponent
    if record["kind"] != FACTOR:
        depth = TOUCHDOWN_DEPTH * clearance
        elastic, _ = elastic_of(record, depth)
        force_at_touchdown = normal_force(record, elastic, depth, 1.0, 1.0)
        record["abrupt"] = force_at_touchdown > ABRUPT * elastic
    return record


def friction_record(law: FrictionLaw) -> Records:
    """Return a friction law as a record of FRICTION."""
    record = np.zeros(1, FRICTION)[0]
    record["coefficient"] = law.coefficient
    record["lower"] = law.lower
    record["upper"] = law.upper
    force: Any = FRICTION_FORCES.get(law.name)
    if law.user_law is not None and not has_state(law.user_law):
        force = compile_function(law.user_law, FRICTION_PARAMETERS)
    if force in (None, ramp_friction):
        record["force"] = INLINE
    else:
        record["force"] = address_of(force, len(FRICTION_PARAMETERS))
    return record
