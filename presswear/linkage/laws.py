"""Contact laws: normal force and friction between pin and bearing.

Most normal laws have the form

    F_n = F_e(delta) (1 + chi delta_dot / delta_dot_0),   F_n >= 0,

with a damping factor ``chi`` that follows from the nominal restitution (equation 8 of
the paper: chi = 3/4 (1 - ce^2), Lankarani and Nikravesh) and an elastic force F_e, as a
rule K delta^n. Kelvin and Voigt's adds D delta_dot to it. A user law is a function that
returns the whole force; its elastic part is its value at rest.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.serialize import Checked
from presswear.tools.user_function import UserFunction

StiffnessReading = Literal["paper", "refined"]
Elasticity = Literal["power", "liu", "foundation"]
# widths over diameter for which the formulas of the oil film hold
NARROWEST, WIDEST = 0.125, 1.0
OILED_CLEARANCE = 5e-3  # greatest clearance over radius of an oiled joint
# wear over the clearance up to which the film has the shape of new surfaces
OILED_WEAR = 0.2
OILED_DAMPING = "Antypov and Elliott (2011)"  # of the contact under a film; its source
# m and Pa, at which user wear laws are checked
WEAR_DEPTHS = 0.0, 1e-7, 1e-6, 1e-5, 1e-4
WEAR_PRESSURES = 1e5, 1e6, 1e7, 1e8


def lankarani_nikravesh_damping(restitution: float) -> float:
    """Return the damping factor chi = 3/4 (1 - ce^2)."""
    return 0.75 * (1.0 - restitution**2)


def damping_ratio(restitution: float) -> float:
    """Return zeta of a linear oscillator that leaves its contact with this restitution."""
    if restitution == 0.0:
        return 1.0
    decrement = math.log(1.0 / restitution)
    return decrement / math.hypot(math.pi, decrement)


class Damping(NamedTuple):
    """Damping factor chi as a function of the nominal restitution."""

    title: str  # source
    # restitution below which the factor is infinite, or too large to compute with
    least: float
    factor: Callable[[float], float]  # chi of a restitution


KELVIN_VOIGT = "kelvin-voigt"
DAMPINGS: Mapping[str, Damping] = {
    "lankarani-nikravesh": Damping(
        "Lankarani and Nikravesh (1990)", 0.0, lankarani_nikravesh_damping
    ),
    "hunt-crossley": Damping(
        "Hunt and Crossley (1975)", 0.0, lambda e: 1.5 * (1.0 - e)
    ),
    "herbert-mcwhannell": Damping(
        "Herbert and McWhannell (1977)",
        0.0,
        lambda e: 6.0 * (1.0 - e) / ((2.0 * e - 1.0) ** 2 + 3.0),
    ),
    "gonthier": Damping("Gonthier and others (2004)", 0.01, lambda e: (1.0 - e**2) / e),
    "flores": Damping("Flores and others (2011)", 0.01, lambda e: 1.6 * (1.0 - e) / e),
    KELVIN_VOIGT: Damping("Kelvin and Voigt", 0.0, lambda e: 0.0),
}
"""Normal laws by name; the last takes a coefficient of viscous damping instead of a factor."""

NORMAL_PARAMETERS = (
    "penetration",
    "rate",
    "onset_speed",
    "stiffness",
    "exponent",
    "damping",
    "clearance",
)
"""Parameters of a user normal law: m, m/s, m/s; N/m^n, -, -, m."""

FRICTION_PARAMETERS = ("sliding", "normal", "coefficient", "lower_speed", "upper_speed")
"""Parameters of a user friction law: m/s, N, -, m/s, m/s."""


STATE_PARAMETERS = (*FRICTION_PARAMETERS, "state")
"""Parameters of a user friction law with a state, m."""

RATE_PARAMETERS = ("sliding", *FRICTION_PARAMETERS[2:], "state", "closed")
"""Parameters of the rate of this state, m/s; ``closed`` is 1 in contact and 0 in flight."""

STATE_SCALE = 1e-6  # m, of the state of a law without the number ``scale``

ARCHARD = "archard"
WEAR_PARAMETERS = ("depth", "load_distance", "pressure", "coefficient")
"""Parameters of a user wear law: m, N/m, Pa, 1/Pa."""


def hertz_stiffness(
    bearing_radius: float,
    pin_radius: float,
    compliance: float,
    reading: StiffnessReading,
) -> float:
    """Return the contact stiffness K, N/m^1.5, from the sum of (1 - nu^2) / E of both, 1/Pa.

    ``paper`` takes sqrt(R_i R_j / (R_i + R_j)) as printed below equation 8, which is
    two spheres side by side. ``refined`` takes the pin in a hole, with R_i - R_j under
    the root.
    """
    combined = (
        bearing_radius + pin_radius
        if reading == "paper"
        else bearing_radius - pin_radius
    )
    return 4.0 / (3.0 * compliance) * math.sqrt(bearing_radius * pin_radius / combined)


def liu_stiffness(width: float, clearance: float, compliance: float) -> float:
    """Return K, N/m^1.5, with which ``liu_force`` is the law of Liu, Zhang and Yang (2007).

    They print F = (pi / 2) delta E* b sqrt(delta / (2 (c + delta))), so that small
    contacts have K = pi b E* / (2 sqrt(2 c)). 1 / E* is the compliance, the sum of (1 -
    nu^2) / E of both, 1/Pa.
    """
    return math.pi * width / (2.0 * compliance * math.sqrt(2.0 * clearance))


def delivered_restitution(damping: float) -> float:
    """Return the restitution e' that a law with damping factor chi delivers.

    Solves (1 + e') chi = ln[(1 + chi) / (1 - chi e')], which holds for any n, K
    and mass: Lankarani-Nikravesh at a nominal 0.9 delivers 0.913.
    """
    if damping <= 0.0:
        return 1.0

    def excess(restitution: float) -> float:
        if damping < 0.1:
            # The logarithm cancels against its argument: its series over chi^2.
            return sum(
                damping ** (k - 2) / k * ((-1.0) ** k - restitution**k)
                for k in range(2, 22)
            )
        return (1.0 + restitution) * damping - math.log(
            (1.0 + damping) / (1.0 - damping * restitution)
        )

    # excess(0) > 0; the only other root lies below both 1 and the pole at 1 / chi,
    # and for a large chi closer to the pole than numbers can tell.
    highest = min(1.0, (1.0 - 1e-15) / damping)
    if excess(highest) > 0.0:
        return highest
    lowest = 0.0
    while lowest < (middle := 0.5 * (lowest + highest)) < highest:
        lowest, highest = (
            (middle, highest) if excess(middle) > 0.0 else (lowest, middle)
        )
    return lowest


def greatest_penetration(
    mass: float, speed: float, stiffness: float, exponent: float, damping: float
) -> float:
    """Return the greatest penetration of a free impact, m (closed form for the laws above)."""
    energy = (exponent + 1.0) * mass * speed**2 / stiffness
    # chi -> 0 of (chi - ln(1 + chi)) / chi^2 is 1/2; the quotient cancels before that.
    if damping > 1e-5:
        loss_factor = (damping - math.log1p(damping)) / damping**2
    else:
        loss_factor = 0.5 - damping / 3.0
    return float((energy * loss_factor) ** (1.0 / (exponent + 1.0)))


@dataclass(frozen=True)
class NormalLaw(Checked):
    """Normal contact law of one joint.

    Attributes
    ----------
    elasticity : {"power", "liu", "foundation"}
        F_e of a round joint: K delta^n; K delta^1.5 / sqrt(1 + delta / c), which Liu
        and others (2007) fitted to cylinders that conform; the elastic foundation's,
        over all of the arc.
    user_law : UserFunction or None
        The whole force, N, as a function of NORMAL_PARAMETERS, in place of all these.
    """

    stiffness: float  # K, N/m^n
    exponent: float = 1.5  # n
    damping: float = 0.0  # chi, from the nominal restitution
    viscosity: float = 0.0  # D of Kelvin and Voigt's law, N s/m
    elasticity: Elasticity = "power"
    user_law: UserFunction | None = None


@dataclass(frozen=True)
class FrictionLaw(Checked):
    """Friction law of one joint: a named law, or a user function of FRICTION_PARAMETERS.

    The names are those of ``physics.interactions.friction.FRICTIONS``.
    """

    coefficient: float = 0.0  # c_f; 0: none, whatever the law
    lower: float = 1e-4  # v_0, m/s: no friction below
    upper: float = 1e-3  # v_1, m/s: full friction above
    name: str = "ramp"
    user_law: UserFunction | None = None  # force along the sliding, N
    settings: Any = None  # of a law with settings, such as LuGreSettings


def check_normal(key: str, law: UserFunction, values: Mapping[str, float]) -> None:
    """Raise InputError where a user normal law gives no number, pulls, or creates energy."""

    def force(penetration: float, rate: float, onset_speed: float) -> float:
        state = {"penetration": penetration, "rate": rate, "onset_speed": onset_speed}
        return law.number(key, NORMAL_PARAMETERS, {**values, **state})

    for part in (1e-6, 1e-4, 1e-2):
        penetration = part * values["clearance"]
        for onset in (1e-4, 1e-3, 1e-2, 0.05, 0.2, 1.0, 5.0):
            rest = force(penetration, 0.0, onset)
            label = f"{key}: {law.name} at penetration = {penetration:g} m"
            if not rest > 0.0:
                raise InputError(
                    f"{label} gives {rest:g} N at rest: it must push, above 0 N"
                )
            if rest != force(penetration, 0.0, 0.1):
                raise InputError(
                    f"{label} gives a force at rest that depends on onset_speed"
                )
            for rate in (0.1 * onset, 0.5 * onset, onset):
                closing, opening = (
                    force(penetration, side * rate, onset) for side in (1.0, -1.0)
                )
                if closing < rest or opening > rest:
                    raise InputError(
                        f"{label} makes energy: it gives {closing:g} N where it closes at {rate:g} "
                        f"m/s, {rest:g} N at rest, {opening:g} N where it opens"
                    )


def has_state(law: UserFunction) -> bool:
    """Return whether a user friction law has a state."""
    return "state" in law.parameters("friction_law", STATE_PARAMETERS)


def rate_of(law: UserFunction) -> UserFunction:
    """Return the function of RATE_PARAMETERS that is the rate of the state of a law."""
    rate = UserFunction(f"{law.name}_rate", law.source)
    names = {one.name for one in rate.numbers("friction_law", RATE_PARAMETERS)}
    values = {name: value for name, value in law.values if name in names}
    return rate.with_values("friction_law", values, RATE_PARAMETERS)


def state_scale(law: UserFunction) -> float:
    """Return a change of the state that matters, m: the number ``scale`` of a law."""
    settings = law.settings("friction_law", STATE_PARAMETERS)
    values = {number.name: value for number, value in settings}
    return values.get("scale", STATE_SCALE)


def steady_state(key: str, law: UserFunction, values: Mapping[str, float]) -> float:
    """Return the state of steady sliding, m, between -1 and 1 m, by bisection."""
    rate = rate_of(law)

    def slope(state: float) -> float:
        point = {**values, "state": state, "closed": 1.0}
        return rate.number(key, RATE_PARAMETERS, point)

    low, high = -1.0, 1.0
    if not slope(low) >= 0.0 >= slope(high):
        raise InputError(
            f"{key}: {rate.name} must fall with the state, from above 0 at -1 m to below 0 at 1 m"
        )
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slope(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)


def check_friction(key: str, law: UserFunction, values: Mapping[str, float]) -> None:
    """Raise InputError where a user friction law gives no number, creates energy or jumps."""
    for speed in (
        0.1 * values["upper_speed"],
        values["upper_speed"],
        0.01,
        0.1,
        0.4,
        1.0,
        4.0,
    ):
        for sliding in (speed, -speed):
            state = {**values, "sliding": sliding, "normal": 100.0}
            if has_state(law):
                state["state"] = steady_state(key, law, state)
            force = law.number(key, STATE_PARAMETERS, state)
            if force * sliding > 0.0:
                fault = (
                    f"it gives {force:g} N where the surfaces slide at {sliding:g} m/s"
                )
                remedy = "a force against the sliding has the other sign"
                raise InputError(f"{key}: {law.name} makes energy: {fault}; {remedy}")
    if has_state(law):
        return  # which keeps the force from jumping
    if jump := law.jump("sliding", {**values, "normal": 100.0}):
        place, below, above = jump
        fault = (
            f"{law.name} jumps from {below:g} to {above:g} N at sliding = {place:g} m/s"
        )
        raise InputError(
            f"{key}: {fault}: it must be continuous; use tanh(sliding / upper_speed)"
        )


def check_wear(key: str, law: UserFunction, coefficient: float) -> None:
    """Raise InputError where a user wear law gives no positive coefficient, or no product.

    The pressure is that of each step, and depth and load distance are those of a wear
    update. A coefficient of both is therefore a product of a function of each.
    """
    used = law.parameters(key, WEAR_PARAMETERS)
    if {"pressure", "load_distance"} <= {*used}:
        raise InputError(
            f"{key}: {law.name} uses pressure and load_distance; allowed is pressure and depth, "
            "or load_distance and depth"
        )

    def size(depth: float, load_distance: float, pressure: float) -> float:
        values = depth, load_distance, pressure, coefficient
        state = dict(zip(WEAR_PARAMETERS, values, strict=True))
        result = law.number(key, WEAR_PARAMETERS, state)
        if not result > 0.0:
            place = ", ".join(f"{name} = {state[name]:g}" for name in used)
            raise InputError(
                f"{key}: {law.name} gives {result:g} 1/Pa at {place}: must be above 0"
            )
        return result

    for depth in WEAR_DEPTHS:
        for pressure in WEAR_PRESSURES:
            for load_distance in (0.0, depth / coefficient):
                worn = size(depth, load_distance, pressure)
            expected = size(depth, 0.0, WEAR_PRESSURES[0]) * size(0.0, 0.0, pressure)
            product = worn * size(0.0, 0.0, WEAR_PRESSURES[0])
            if "pressure" in used and abs(product - expected) > 1e-9 * expected:
                raise InputError(
                    f"{key}: {law.name} must be a function of depth times a function of pressure"
                )


@dataclass(frozen=True)
class Materials(Checked):
    """Elasticity and wear of a pin and a bearing as a pair."""

    youngs_modulus: float = quantity(
        200e9, "Pa", 1e9, 1e12, "paper", "E of pin and bearing"
    )
    bearing_modulus: float | None = quantity(
        None, "Pa", 1e9, 1e12, "chosen", "E of the bearing; default: the pin's"
    )
    poisson_ratio: float = quantity(0.3, "", 0.0, 0.5, "paper", "nu of pin and bearing")
    wear_coefficient: float = quantity(
        1.2e-15,
        unit="1/Pa",
        low=0.0,
        high=1e-9,
        origin="assumed",
        text="K_d of pin and bearing together; measured ones differ by powers of ten",
    )
    bearing_share: float = quantity(
        0.5, "", 0.0, 1.0, "paper", "fraction of the wear depth at the bearing"
    )
    wear_scatter: float = quantity(
        0.5, "", 0.0, 2.0, "literature", "coefficient of variation of K_d (Podra 1999)"
    )
    running_in: float = quantity(
        1.0,
        unit="",
        low=0.01,
        high=1e4,
        origin="assumed",
        text="K_d of new surfaces over that of surfaces that have run in; 1: constant",
    )
    running_in_depth: float | None = quantity(
        None,
        unit="m",
        low=1e-9,
        high=1e-3,
        origin="assumed",
        text="worn depth over which running-in fades to 1/e; default: the roughness",
    )
    pressure_exponent: float = quantity(
        1.0,
        unit="",
        low=0.3,
        high=3.0,
        origin="assumed",
        text="m: wear grows as the pressure to this power; 1: Archard's law",
    )
    pressure_reference: float = quantity(
        10e6,
        unit="Pa",
        low=1e3,
        high=1e10,
        origin="assumed",
        text="pressure at which K_d holds, with a pressure_exponent other than 1",
    )

    @property
    def compliance(self) -> float:
        """Sum of (1 - nu^2) / E of both, 1/Pa."""
        moduli = self.youngs_modulus, self.bearing_modulus or self.youngs_modulus
        return sum((1.0 - self.poisson_ratio**2) / modulus for modulus in moduli)


def _steels(pin: float, bearing: float) -> Materials:
    """Return steels with the wear coefficients of both, 1/Pa."""
    total = pin + bearing
    return Materials(wear_coefficient=total, bearing_share=bearing / total)


# Numbers of the wear law that no listed pair states
UNLISTED = (
    "wear_scatter",
    "running_in",
    "running_in_depth",
    "pressure_exponent",
    "pressure_reference",
)
# Beside the paper's pair: stainless steels, rods in bores in water, after code_aster's
# data bank of POST_USURE (``usuban``, GRAPPE_ALESAGE). Pin first.
MATERIALS: dict[str, Materials] = {
    "paper": Materials(),
    "304L-304L": _steels(10e-15, 15e-15),
    "316L-304L": _steels(10e-15, 5e-15),
    "nitrided-304L": _steels(0.1e-15, 70e-15),
    "chromed-304L": _steels(0.1e-15, 50e-15),
}


def listed_pair(pair: Materials) -> str:
    """Return the name of the listed pair with the same numbers, or nothing.

    Numbers that no listed pair states are not compared.
    """
    stated = {key: getattr(pair, key) for key in UNLISTED}
    names = (name for name, one in MATERIALS.items() if replace(one, **stated) == pair)
    return next(names, "")
