"""Free impacts through the compiled force against what the laws are known to give back."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from force_of import force_of, plain
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from presswear.linkage.laws import (
    delivered_restitution,
    greatest_penetration,
    lankarani_nikravesh_damping,
)
from presswear.validation import reference_problems as references

# Factors as they are printed.
CHI = {
    "lankarani-nikravesh": lambda e: 0.75 * (1.0 - e**2),
    "hunt-crossley": lambda e: 1.5 * (1.0 - e),
    "flores": lambda e: 8.0 * (1.0 - e) / (5.0 * e),
    "gonthier": lambda e: (1.0 - e**2) / e,
}
# Law, nominal restitution, damping factor chi, restitution delivered.
DELIVERED = [
    ("lankarani-nikravesh", 1.0, 0.0, 1.0),
    *(
        (law, nominal, CHI[law](nominal), delivered)
        for law, values in references.DELIVERED.items()
        for nominal, delivered in values.items()
    ),
]
EXPONENTS = [1.0, 1.5, 2.0, 2.2]
MASS, SPEED, STIFFNESS = 0.1, 0.3, 1.25e10


@dataclass(frozen=True)
class _Impact:
    restitution: float
    penetration: float
    duration: float


def _impact(exponent: float, damping: float) -> _Impact:
    """Integrate m x'' = -F through one free impact.

    Depth and time are scaled by the elastic impact's, so that the tolerances are
    relative to numbers of order one.
    """
    depth = ((exponent + 1.0) * MASS * SPEED**2 / (2.0 * STIFFNESS)) ** (1.0 / (exponent + 1.0))
    unit = depth / SPEED
    law = plain(STIFFNESS, exponent, damping)

    def rate(_: float, state: NDArray[np.float64]) -> list[float]:
        force = force_of(law, depth * float(state[0]), SPEED * float(state[1]), SPEED)
        return [float(state[1]), -force * unit / (MASS * SPEED)]

    def parts(_: float, state: NDArray[np.float64]) -> float:
        return float(state[0])

    def deepest(_: float, state: NDArray[np.float64]) -> float:
        return float(state[1])

    vars(parts).update(terminal=True, direction=-1.0)
    motion = solve_ivp(
        rate,
        (0.0, 100.0),
        [0.0, 1.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
        max_step=0.1,
        events=(parts, deepest),
    )
    assert motion.status == 1
    return _Impact(
        restitution=-float(motion.y_events[0][0, 1]),
        penetration=depth * float(motion.y_events[1][0, 0]),
        duration=unit * float(motion.t_events[0][0]),
    )


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize(("law", "nominal", "damping", "delivered"), DELIVERED)
def test_impact_gives_back_what_the_table_says(
    law: str, nominal: float, damping: float, delivered: float, exponent: float
) -> None:
    impact = _impact(exponent, damping)
    assert impact.restitution == pytest.approx(delivered, abs=1e-8), (law, nominal)
    # Some values are printed to eight digits: half a unit of the last.
    assert delivered_restitution(damping) == pytest.approx(delivered, abs=6e-9)
    if law == "lankarani-nikravesh":
        assert lankarani_nikravesh_damping(nominal) == pytest.approx(damping, rel=1e-14)
    closed = greatest_penetration(MASS, SPEED, STIFFNESS, exponent, damping)
    assert impact.penetration == pytest.approx(closed, rel=1e-8)


@pytest.mark.parametrize(("exponent", "lasts"), [(1.0, math.pi), (1.5, 2.9432751843)])
def test_an_elastic_impact_lasts_as_it_must(exponent: float, lasts: float) -> None:
    """Half a sine of a linear spring, and 2.943 delta_max / v after Hertz."""
    impact = _impact(exponent, 0.0)
    energy = (exponent + 1.0) * MASS * SPEED**2 / (2.0 * STIFFNESS)
    deepest = energy ** (1.0 / (exponent + 1.0))
    assert greatest_penetration(MASS, SPEED, STIFFNESS, exponent, 0.0) == pytest.approx(
        deepest, rel=1e-14
    )
    assert impact.penetration == pytest.approx(deepest, rel=1e-9)
    assert impact.duration == pytest.approx(lasts * deepest / SPEED, rel=1e-8)
