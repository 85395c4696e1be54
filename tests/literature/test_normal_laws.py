"""Normal laws by name in the engines: delivered restitution, depth and energy of an impact."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import Any

import pytest
from runs import energy_residual
from scipy.integrate import quad

from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.materials import Materials
from presswear.linkage.normal_law import (
    DAMPINGS,
    KELVIN_VOIGT,
    NormalLaw,
    delivered_restitution,
    greatest_penetration,
)
from presswear.physics.friction_and_normal import elastic_of, normal_record
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.pin_joints import normal_law_of
from presswear.tools.user_function import UserFunction
from presswear.validation import reference_problems as references
from presswear.validation.cases import finished, first_contact
from presswear.validation.reference_problems import delivered

CLEARANCE = 1e-4
STIFFNESS = 1.25e10
SPEED = 0.25
MASS = 0.3 * 0.1 / 0.4
ENGINES: list[tuple[Engine, float]] = [
    (InHouse(integration_tolerance=1e-12), 1e-8),
    (ExudynJoints(400, 10), 1e-4),
]
PLAN = Plan(4e-3, 1)


def impact(law: NormalLaw, engine: Engine, speed: float = SPEED) -> Run:
    """Run the impact of a free pin on a free bearing; see ``references.Impact``."""
    case = references.Impact(1.0, STIFFNESS, speed, CLEARANCE)
    joint = replace(case.linkage.clearances[0], normal=law)
    run = finished(
        engine.simulate(replace(case.linkage, clearances=(joint,)), case.start, PLAN)
    )
    energy = 0.5 * MASS * speed**2
    bound = 1e-8 if isinstance(engine, InHouse) else 1e-3
    assert energy_residual(run) < bound * energy
    return run


def kelvin_voigt_restitution(part: float) -> float:
    """Return the restitution of a linear spring with a part of the critical damping.
    The force ends where spring and damper cancel (Schwager and Poeschel, 2007).
    """
    if part == 1.0:
        return math.exp(-2.0)
    if part > 1.0:
        root = math.sqrt(part**2 - 1.0)
        return math.exp(-part / root * math.log((part + root) / (part - root)))
    root = math.sqrt(1.0 - part**2)
    # Phase at which damper and spring cancel, between 0 and pi
    phase = math.atan2(2.0 * part * root, 2.0 * part**2 - 1.0)
    return math.exp(-part / root * phase)


@pytest.mark.parametrize("law", references.DELIVERED)
def test_factors_and_restitution_as_printed(law):
    for nominal, expected in references.DELIVERED[law].items():
        printed = {
            "lankarani-nikravesh": 0.75 * (1.0 - nominal**2),
            "hunt-crossley": 1.5 * (1.0 - nominal),
            "flores": 8.0 * (1.0 - nominal) / (5.0 * nominal),
            "gonthier": (1.0 - nominal**2) / nominal,
        }[law]
        assert DAMPINGS[law].factor(nominal) == pytest.approx(printed, rel=1e-14)
        # Some values are printed to eight digits: half a unit of the last.
        assert delivered_restitution(printed) == pytest.approx(expected, abs=6e-9)


@pytest.mark.parametrize("exponent", [1.0, 2.0, 2.2])
def test_restitution_and_depth_hold_for_any_exponent(exponent):
    """The duration is compared for an elastic linear spring: half a period."""
    for damping in (0.0, 0.4):
        law = NormalLaw(1e7 if exponent == 1.0 else STIFFNESS, exponent, damping)
        run = impact(law, ENGINES[0][0])
        assert delivered(run, SPEED) == pytest.approx(
            delivered_restitution(damping), abs=1e-8
        )
        depth = run.recorder.series("penetration", 0).max()
        closed = greatest_penetration(MASS, SPEED, law.stiffness, exponent, damping)
        assert depth == pytest.approx(closed, rel=2e-3)
        contact = first_contact(run)
        if exponent == 1.0 and damping == 0.0:
            duration = contact["separation"] - contact["touchdown"]
            half_period = math.pi * math.sqrt(MASS / law.stiffness)
            assert duration == pytest.approx(half_period, rel=1e-8)


@pytest.mark.parametrize("part", [1e-9, 1e-5, 1e-3, 0.05, 0.5, 3.0])
def test_elastic_forces_and_energies(part):
    """Liu's law is compared as printed, the foundation with a quadrature over the arc."""
    depth = part * CLEARANCE
    bearing = Bearing(
        CLEARANCE, width=0.03, materials=Materials(206e9, 110e9), elasticity="liu"
    )
    liu = normal_record(normal_law_of(bearing, CONVENTIONS["paper"]), CLEARANCE)
    modulus = 1.0 / (0.91 / 206e9 + 0.91 / 110e9)
    printed = 0.5 * math.pi * depth * modulus * 0.03
    printed *= math.sqrt(depth / (2.0 * (CLEARANCE + depth)))
    assert elastic_of(liu, depth)[0] == pytest.approx(printed, rel=1e-13)

    law = NormalLaw(STIFFNESS, elasticity="foundation")
    foundation = normal_record(law, CLEARANCE)
    stiffness = 0.75 * STIFFNESS * math.sqrt(0.5 * CLEARANCE)
    eccentricity = CLEARANCE + depth
    half = math.acos(CLEARANCE / eccentricity) if part > 1e-6 else math.sqrt(2.0 * part)

    def overlap(x: float) -> float:
        # e cos(x) - c without its cancellation.
        return depth - 2.0 * eccentricity * math.sin(0.5 * x) ** 2

    def integral(rate: Any, low: float, high: float) -> float:
        return float(quad(rate, low, high, epsabs=0.0, epsrel=1e-12)[0])

    force = integral(lambda x: stiffness * overlap(x) * math.cos(x), -half, half)
    energy = integral(lambda x: 0.5 * stiffness * overlap(x) ** 2, -half, half)
    assert elastic_of(foundation, depth)[0] == pytest.approx(force, rel=1e-9)
    assert elastic_of(foundation, depth)[1] == pytest.approx(energy, rel=1e-9)
    for record in (liu, foundation):
        work = integral(lambda x, record=record: elastic_of(record, x)[0], 0.0, depth)
        assert elastic_of(record, depth)[1] == pytest.approx(work, rel=1e-9)


def test_small_contacts_have_the_stiffness_of_the_law():
    """It is 8.6e10 N/m^1.5 by Liu for the press of the paper, which prints 1.25e10."""

    def stiffness_of(bearing: Bearing) -> float:
        return normal_law_of(bearing, CONVENTIONS["paper"]).stiffness

    press = Bearing(0.8e-3)
    conforming = replace(press, elasticity="liu")
    measured = replace(conforming, contact_stiffness=2e9)
    assert stiffness_of(conforming) == pytest.approx(8.63e10, rel=1e-3)
    assert stiffness_of(press) == pytest.approx(1.25e10, rel=0.01)
    assert stiffness_of(measured) == 2e9


SOFT = """
K = 3.0e9

def spring(x):
    return K * x ** 1.3

def soft(penetration, rate, onset_speed):
    return spring(penetration) * (1.0 + 0.4 * rate / onset_speed)
"""


def law_cases() -> Iterator[tuple[NormalLaw, float]]:
    """Yield laws and their restitution by closed forms.

    Chi of the damping factor solves (1 + e) chi = ln[(1 + chi) / (1 - chi e)], whatever
    the elastic force is. The user law is a power of 1.3 with chi = 0.4.
    """
    chi_laws = [law for name, law in DAMPINGS.items() if name != KELVIN_VOIGT]
    for damping, nominal in product(chi_laws, (0.0, 0.05, 0.3, 0.9)):
        factor = damping.factor(max(nominal, damping.least))
        yield NormalLaw(STIFFNESS, 1.5, factor), delivered_restitution(factor)
    critical = 2.0 * math.sqrt(1e7 * MASS)
    for part in (0.0, 0.1, 0.5, 1.0, 2.0):
        law = NormalLaw(1e7, 1.0, viscosity=part * critical)
        yield law, kelvin_voigt_restitution(part)
    for elasticity in ("liu", "foundation"):
        law = NormalLaw(STIFFNESS, 1.5, 0.5625, elasticity=elasticity)
        yield law, delivered_restitution(0.5625)
    user_law = UserFunction("soft", SOFT).trusted()
    yield NormalLaw(STIFFNESS, user_law=user_law), delivered_restitution(0.4)


@pytest.mark.parametrize(("engine", "bound"), ENGINES)
@pytest.mark.parametrize(("law", "expected"), [*law_cases()])
def test_laws_deliver_the_restitution_of_closed_forms(
    law: NormalLaw, expected, engine: Engine, bound
):
    assert delivered(impact(law, engine), SPEED) == pytest.approx(expected, abs=bound)


def test_two_laws_with_one_name_are_distinguished():
    """Laws with one name and different texts run in turn in one process."""
    first = UserFunction("soft", SOFT).trusted()
    second = UserFunction("soft", SOFT.replace("0.4", "0.8")).trusted()
    first_again = UserFunction("soft", SOFT)
    engine = ENGINES[0][0]
    restitutions = [
        delivered(impact(NormalLaw(STIFFNESS, user_law=law), engine), SPEED)
        for law in (first, second, first_again)
    ]
    expected = pytest.approx(delivered_restitution(0.4), abs=1e-8)
    assert restitutions[0] == restitutions[2] == expected
    assert restitutions[1] == pytest.approx(delivered_restitution(0.8), abs=1e-8)
    plain = impact(NormalLaw(STIFFNESS, 1.5, 0.3), engine)
    assert delivered(plain, SPEED) == pytest.approx(
        delivered_restitution(0.3), abs=1e-8
    )
