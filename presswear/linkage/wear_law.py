"""Wear law of a clearance joint, and its checks if it is a function of the user."""

from dataclasses import dataclass
from typing import Literal

from presswear.tools.errors import InputError
from presswear.tools.serialize import Checked
from presswear.tools.user_function import UserFunction

Slip = Literal["angle", "sliding"]
WearDistribution = Literal["bin", "arc"]
WearMaps = Literal["smoothed", "raw"]

ARCHARD = "archard"
WEAR_PARAMETERS = ("depth", "load_distance", "pressure", "coefficient")
"""Parameters of a user wear law: m, N/m, Pa, 1/Pa."""

# Values at which user wear laws are checked
CHECKED_DEPTHS = 0.0, 1e-7, 1e-6, 1e-5, 1e-4  # m
CHECKED_PRESSURES = 1e5, 1e6, 1e7, 1e8  # Pa
PRODUCT_TOL = 1e-9  # relative difference that is round-off


@dataclass(frozen=True)
class WearLaw(Checked):
    """Archard wear dh = K_d p ds of a clearance joint.

    Attributes
    ----------
    slip : {"angle", "sliding"}
        ``ds = (R_j + delta) |d phi|`` (equation 24), or ``|v_t| dt``.
    wear_distribution : {"bin", "arc"}
        ``bin``: all wear is in the bin of the contact, with the mean pressure of
        equations 25 to 28. ``arc``: wear is in proportion to the pressure over the
        contact arc.
    """

    coefficient: float  # K_d, 1/Pa
    slip: Slip = "sliding"
    wear_distribution: WearDistribution = "arc"
    # part of the depth that the bearing loses; the pin loses the rest
    bearing_share: float = 0.5
    angles: int = 360  # number of angular bins
    # wear coefficient of new surfaces over K_d; see ``physics.running_in``
    running_in: float = 1.0
    running_in_depth: float = 0.3e-6  # m
    pressure_exponent: float = 1.0  # m of dh = K_d p (p / p_ref)^(m - 1) ds
    pressure_reference: float = 10e6  # p_ref, Pa
    # K, 1/Pa, as a function of WEAR_PARAMETERS; see ``physics.user_wear``
    user_law: UserFunction | None = None

    @property
    def depends_on_pressure(self) -> bool:
        """True if a user law gives the coefficient as a function of the pressure."""
        law = self.user_law
        return law is not None and "pressure" in law.parameters(
            "wear_law", WEAR_PARAMETERS
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

    def coefficient_at(depth: float, load_distance: float, pressure: float) -> float:
        values = depth, load_distance, pressure, coefficient
        state = dict(zip(WEAR_PARAMETERS, values, strict=True))
        result = law.evaluate(key, WEAR_PARAMETERS, state)
        if not result > 0.0:
            place = ", ".join(f"{name} = {state[name]:g}" for name in used)
            raise InputError(
                f"{key}: {law.name} gives {result:g} 1/Pa at {place}: must be above 0"
            )
        return result

    for depth in CHECKED_DEPTHS:
        for pressure in CHECKED_PRESSURES:
            coefficient_at(depth, 0.0, pressure)
            worn = coefficient_at(depth, depth / coefficient, pressure)
            if "pressure" not in used:
                continue
            # K(h, p) K(0, p_0) = K(h, p_0) K(0, p) of a product of two functions
            product = worn * coefficient_at(0.0, 0.0, CHECKED_PRESSURES[0])
            expected = coefficient_at(depth, 0.0, CHECKED_PRESSURES[0])
            expected *= coefficient_at(0.0, 0.0, pressure)
            if abs(product - expected) > PRODUCT_TOL * expected:
                raise InputError(
                    f"{key}: {law.name} must be a function of depth times a function of pressure"
                )
