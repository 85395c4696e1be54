"""A joint kind beside the elastic pin: a rubber bush, with a spring and damper in rotation."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
import pytest
from runs import energy_residual, step_response

from presswear.engines.base import Plan, Start
from presswear.engines.settings import Engine, ExudynTree, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.joints import Pin, Revolute
from presswear.linkage.linkage import Linkage, assemble, linkage_from
from presswear.linkage.points import GROUND, OutputPoint
from presswear.physics import ledger
from presswear.physics.equations.text import difference, negative, product, total
from presswear.physics.interactions import kinds
from presswear.physics.interactions.elastic_pin import ElasticPin, damping_of
from presswear.physics.interactions.page import Page
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.fields import quantity
from presswear.tools.serialize import make
from presswear.validation.cases import finished

MASS, INERTIA = 2.0, 0.5  # kg, kg m^2
FREQUENCY, TURNING_FREQUENCY = 40.0, 12.0  # rad/s
RATIO = 0.2  # part of the critical damping, in rotation


@dataclass(frozen=True)
class Bush(Pin, Revolute):
    """Rubber bush: an elastic pin that resists rotation."""

    stiffness: float = quantity(1e7, "N/m", 1e3, 1e12, "chosen", "in any direction")
    turning_stiffness: float = quantity(
        0.0, "N m/rad", 0.0, 1e9, "chosen", "in rotation"
    )
    turning_damping: float = quantity(
        0.0, "N m s/rad", 0.0, 1e9, "chosen", "in rotation"
    )


def bushes_of(linkage: Linkage) -> list[Bush]:
    return [pin for pin in linkage.elastic_pins if isinstance(pin, Bush)]


class RubberBush(ElasticPin):
    """The moment of a bush on the frame, as text, besides the force of an elastic pin."""

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        return [cls(bush, damping_of(linkage, bush)) for bush in bushes_of(linkage)]

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        x, y, turn = position
        energy = 0.0
        for bush in bushes_of(linkage):
            energy += 0.5 * bush.stiffness * (x * x + y * y)
            energy += 0.5 * bush.turning_stiffness * turn * turn
        return energy

    def write(self, page: Page) -> None:
        super().write(page)
        bush = self.pin
        assert isinstance(bush, Bush)
        text = page.text
        prefix = text.prefix(f"{bush.name}_turning")
        first, second = (page.chain.of(end.body) for end in bush.ends)
        stiffness = text.parameter(f"{prefix}_stiffness", bush.turning_stiffness)
        damping = text.parameter(f"{prefix}_damping", bush.turning_damping)
        spin = difference(second.omega, first.omega)
        damper = text.let(f"{prefix}_damper", product(damping, spin))
        elastic = product(stiffness, difference(second.angle, first.angle))
        moment = text.let(f"{prefix}_moment", total(elastic, damper))
        first.moments.append(moment)
        second.moments.append(negative(moment))
        page.add_power("load_work", negative(product(damper, spin)))


def body_on_bush() -> Linkage:
    """Return a body whose mass centre is held by a bush, without gravity."""
    bush = Bush(
        name="bush",
        first=(0.0, 0.0),
        second="mass",
        stiffness=MASS * FREQUENCY**2,
        damping_ratio=0.0,
        turning_stiffness=INERTIA * TURNING_FREQUENCY**2,
        turning_damping=2.0 * RATIO * INERTIA * TURNING_FREQUENCY,
    )
    return assemble(
        [Body("mass", MASS, INERTIA)],
        joints=[bush],
        output=OutputPoint("mass"),
        gravity=0.0,
        cycle=1.0,
    )


@pytest.mark.parametrize(
    ("engine", "tolerance"),
    [
        (InHouse(integration_tolerance=1e-12, free_step=0.01), 1e-9),
        (ExudynTree(tree_tolerance=1e-11, free_step=0.01), 1e-8),
    ],
    ids=["dae", "exudyn-tree"],
)
def test_a_bush_oscillates(monkeypatch, engine: Engine, tolerance):
    all_kinds = (*kinds.KINDS, RubberBush)
    for module in (kinds, ledger):
        monkeypatch.setattr(module, "KINDS", all_kinds)
    start = np.array([0.03, -0.02, 0.4])
    run = finished(
        engine.simulate(body_on_bush(), Start(start, np.zeros(3)), Plan(1.0, 1))
    )
    expected = start * math.cos(FREQUENCY)
    expected[2] = start[2] * step_response(TURNING_FREQUENCY, RATIO, 1.0)
    assert run.end.position == pytest.approx(expected, abs=tolerance)
    assert energy_residual(run) < 100.0 * tolerance


def test_a_joint_kind_is_stored_with_its_points_by_name():
    plain = body_on_bush().as_plain()
    (row,) = plain["joints"]
    assert (row["first"], row["second"]) == ([0.0, 0.0], "mass.centre")
    assert row["turning_stiffness"] == INERTIA * TURNING_FREQUENCY**2
    in_file = {**row, "turning_stiffness": "72 N m/rad"}
    assert make("joints[0]", Bush, in_file).turning_stiffness == 72.0
    plain["joints"] = [{"name": "pin", "first": row["first"], "second": row["second"]}]
    (pin,) = linkage_from(plain, "mechanism").revolutes
    assert type(pin) is Revolute
    assert pin.first.body == GROUND
