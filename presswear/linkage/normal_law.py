"""Normal force between pin and bearing.

Most normal laws have the form

    F_n = F_e(delta) (1 + chi delta_dot / delta_dot_0),   F_n >= 0,

with a damping factor ``chi`` that follows from the nominal restitution (equation 8 of
the paper: chi = 3/4 (1 - ce^2), Lankarani and Nikravesh) and an elastic force F_e, as a
rule K delta^n. Kelvin and Voigt's adds D delta_dot to it. A user law is a function that
returns the whole force; its elastic part is its value at rest.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from presswear.tools.errors import InputError
from presswear.tools.serialize import Checked
from presswear.tools.user_function import UserFunction

StiffnessReading = Literal["paper", "refined", "conforming"]
Elasticity = Literal["power", "liu", "foundation"]


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


def hertz_stiffness(
    bearing_radius: float,
    pin_radius: float,
    compliance: float,
    reading: StiffnessReading,
) -> float:
    """Return the contact stiffness K, N/m^1.5, from the sum of (1 - nu^2) / E of both, 1/Pa.

    ``paper`` takes sqrt(R_i R_j / (R_i + R_j)) as printed below equation 8, which is
    two spheres side by side. Other readings take the pin in a hole, with R_i - R_j under
    the root.
    """
    combined = bearing_radius - pin_radius
    if reading == "paper":
        combined = bearing_radius + pin_radius
    return 4.0 / (3.0 * compliance) * math.sqrt(bearing_radius * pin_radius / combined)


def liu_stiffness(width: float, clearance: float, compliance: float) -> float:
    """Return K, N/m^1.5, with which ``liu_force`` is the law of Liu, Zhang and Yang (2007).

    They print F = (pi / 2) delta E* b sqrt(delta / (2 (c + delta))), so that small
    contacts have K = pi b E* / (2 sqrt(2 c)). 1 / E* is the compliance, the sum of (1 -
    nu^2) / E of both, 1/Pa.
    """
    return math.pi * width / (2.0 * compliance * math.sqrt(2.0 * clearance))


def conforming_stiffness(width: float, clearance: float, compliance: float) -> float:
    """Return K, N/m^1.5, with which a pin deep in a foundation is as stiff as by Liu's law.

    Deep contacts have F = (pi / 2) k_w b R delta on a foundation with k_w b R = 3/4 K
    sqrt(c / 2), and F = pi b E* delta / (2 sqrt(2)) by ``liu_force``. Both are equal for
    K = 4 b E* / (3 sqrt(c)). 1 / E* is the compliance, the sum of (1 - nu^2) / E of
    both, 1/Pa.
    """
    return 4.0 * width / (3.0 * compliance * math.sqrt(clearance))


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
        if excess(middle) > 0.0:
            lowest = middle
        else:
            highest = middle
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


def check_normal(key: str, law: UserFunction, values: Mapping[str, float]) -> None:
    """Raise InputError where a user normal law gives no number, pulls, or creates energy."""

    def force(penetration: float, rate: float, onset_speed: float) -> float:
        state = {"penetration": penetration, "rate": rate, "onset_speed": onset_speed}
        return law.evaluate(key, NORMAL_PARAMETERS, {**values, **state})

    for fraction in (1e-6, 1e-4, 1e-2):
        penetration = fraction * values["clearance"]
        for onset in (1e-4, 1e-3, 1e-2, 0.05, 0.2, 1.0, 5.0):
            at_rest = force(penetration, 0.0, onset)
            label = f"{key}: {law.name} at penetration = {penetration:g} m"
            if not at_rest > 0.0:
                raise InputError(
                    f"{label} gives {at_rest:g} N at rest: it must push, above 0 N"
                )
            if at_rest != force(penetration, 0.0, 0.1):
                raise InputError(
                    f"{label} gives a force at rest that depends on onset_speed"
                )
            for rate in (0.1 * onset, 0.5 * onset, onset):
                closing = force(penetration, rate, onset)
                opening = force(penetration, -rate, onset)
                if closing < at_rest or opening > at_rest:
                    raise InputError(
                        f"{label} makes energy: it gives {closing:g} N where it closes at {rate:g} "
                        f"m/s, {at_rest:g} N at rest, {opening:g} N where it opens"
                    )
