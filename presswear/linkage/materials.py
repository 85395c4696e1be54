"""Elasticity and wear of pairs of materials."""

from dataclasses import dataclass, replace

from presswear.tools.fields import quantity
from presswear.tools.serialize import Checked


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
    for name, listed in MATERIALS.items():
        if replace(listed, **stated) == pair:
            return name
    return ""
