"""A friction law with a state that the package does not have, in every engine."""

from collections import Counter
from dataclasses import dataclass, fields
from typing import ClassVar

import pytest
from four_bar_linkage import FOUR_BAR
from runs import run_scene

from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.friction_settings import WITH_SETTINGS
from presswear.physics.equations.layout import State
from presswear.physics.interactions import clearance, kinds
from presswear.physics.interactions.friction import FrictionText, friction_of
from presswear.physics.interactions.page import Page
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.compile import Records
from presswear.validation.cases import contacts_of

STIFFNESS = 1e3  # sigma_0, 1/m


@dataclass
class Dahl:
    """z' = v - sigma_0 |v| z / c_f in contact and 0 in flight (Dahl 1968); F = -F_n sigma_0 z."""

    page: Page
    prefix: str
    joint: int
    law: FrictionLaw

    has_state: ClassVar[bool] = True

    @property
    def name(self) -> str:
        return f"{self.prefix}_deflection"

    def write_state(self, sliding: str, is_closed: str) -> None:
        text = self.page.text
        scale = self.law.coefficient / STIFFNESS
        place = self.page.add_state(State(self.name, scale, self.joint))
        z = text.let(self.name, f"y[{place}]")
        limit = text.parameter(f"{self.prefix}_limit", scale)
        rate = f"{sliding} - abs({sliding}) * {z} / {limit}"
        text.write(f"out[{place}] = {rate} if {is_closed} else 0.0")

    def force(self, normal: str) -> str:
        stiffness = self.page.text.parameter(f"{self.prefix}_dahl", STIFFNESS)
        return f"-{normal} * {stiffness} * {self.name}"


def dahl_at_first(
    page: Page, prefix: str, joint: int, law: FrictionLaw, record: Records
) -> FrictionText:
    """Return Dahl's law for the first joint."""
    if joint == 0:
        return Dahl(page, prefix, joint, law)
    return friction_of(page, prefix, joint, law, record)


def test_a_state_is_integrated_by_every_engine(monkeypatch):
    """Ten touchdowns of a four-bar; the friction loss depends on the deflection throughout."""
    scene = changed(
        Scene(mechanism=FOUR_BAR, joints="AB", wear_updates=0),
        {"clearance": 5e-4, "friction": 0.1, "restitution": 0.8},
    )

    def outcome(engine: Engine) -> tuple[float, int]:
        run = run_scene(scene, engine, 0.0114)
        touchdowns = sum(contacts_of(run, k)["touchdown"].size for k in range(2))
        return float(run.diagnostics["friction_loss_J"]), touchdowns

    exact = InHouse(integration_tolerance=1e-12)
    loss_without_state, _ = outcome(exact)
    monkeypatch.setattr(clearance, "friction_of", dahl_at_first)
    reference, touchdowns = outcome(exact)
    assert touchdowns >= 10
    assert abs(reference / loss_without_state - 1.0) > 0.01
    tree = outcome(ExudynTree(tree_tolerance=1e-11))
    coarse = outcome(ExudynJoints(steps_per_contact=200))
    fine = outcome(ExudynJoints(steps_per_contact=800))
    assert tree == pytest.approx((reference, touchdowns), rel=2e-6)
    assert fine == pytest.approx((reference, touchdowns), rel=4e-6)
    assert abs(coarse[0] - reference) > 8.0 * abs(fine[0] - reference)


def test_names_of_kernels_and_settings_are_different() -> None:
    """The equations call kernels by name, and a bearing has the settings of all laws."""
    kernels = {kernel for kind in kinds.KINDS for kernel in kind.kernels}
    names = Counter(kernel.__name__ for kernel in kernels)
    names += Counter(
        item.name for law in WITH_SETTINGS.values() for item in fields(law)
    )
    assert [name for name, count in names.items() if count > 1] == []
