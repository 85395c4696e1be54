"""Materials of pin and bearing: elasticity and wear of a pair."""

from dataclasses import dataclass

from presswear.tools.quantities import quantity
from presswear.tools.serialize import check_fields


@dataclass(frozen=True)
class Materials:
    """A pin and a bearing as a pair."""

    youngs_modulus: float = quantity(200e9, "Pa", 1e9, 1e12, "paper", "E of pin and bearing")
    bearing_modulus: float | None = quantity(
        None, "Pa", 1e9, 1e12, "chosen", "E of the bearing; none given: as the pin's"
    )
    poisson_ratio: float = quantity(0.3, "", 0.0, 0.5, "paper", "nu of pin and bearing")
    wear_coefficient: float = quantity(
        1.2e-15,
        "1/Pa",
        0.0,
        1e-9,
        "assumed, one number for all scenes",
        "K_d of pin and bearing together",
    )
    bearing_share: float = quantity(
        0.5, "", 0.0, 1.0, "paper", "part of the wear depth that the bearing loses"
    )
    wear_scatter: float = quantity(
        0.5,
        "",
        0.0,
        2.0,
        "literature",
        "standard deviation of K_d over its mean; Podra and Andersson 1999: 0.4 to 0.6",
    )

    def __post_init__(self) -> None:
        """InputError where a quantity is out of range."""
        check_fields(self)

    @property
    def name(self) -> str:
        """Name of the pair, or ``own`` for one that has none."""
        return next((name for name, preset in MATERIALS.items() if self == preset), "custom")

    @property
    def compliance(self) -> float:
        """Sum of (1 - nu^2) / E of both, 1/Pa."""
        moduli = self.youngs_modulus, self.bearing_modulus or self.youngs_modulus
        return sum((1.0 - self.poisson_ratio**2) / modulus for modulus in moduli)


def _steels(pin: float, bearing: float) -> Materials:
    """Steels with the wear coefficients of both, 1/Pa."""
    total = pin + bearing
    return Materials(wear_coefficient=total, bearing_share=bearing / total)


MATERIALS: dict[str, Materials] = {
    "paper": Materials(),
    "304L-304L": _steels(10e-15, 15e-15),
    "316L-304L": _steels(10e-15, 5e-15),
    "nitrided-304L": _steels(0.1e-15, 70e-15),
    "chromed-304L": _steels(0.1e-15, 50e-15),
}
"""Pairs by name, pin first.  Beside the paper's: stainless steels, rods in bores in water, after
code_aster's data bank of POST_USURE (``usuban``, GRAPPE_ALESAGE)."""
