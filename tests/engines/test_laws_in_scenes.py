"""Contact and friction laws by name, and user laws, in whole mechanisms in every engine."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from runs import residual, run_scene

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.friction_settings import FRICTIONS
from presswear.linkage.normal_law import DAMPINGS, KELVIN_VOIGT, NormalLaw
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction
from presswear.validation.cases import contacts_of

BASE = replace(pw.scenes.wear_times(friction=0.1), wear_updates=0)
USER_LAWS = """
import math

def rub(sliding, normal, coefficient):
    return -coefficient * normal * 2.0 / math.pi * math.atan(sliding / 2e-4)

def push(penetration, rate, onset_speed, stiffness):
    return stiffness * penetration ** 1.5 * (1.0 + 0.2 * rate / onset_speed)

def pull(penetration, rate, onset_speed, stiffness):
    return stiffness * penetration ** 1.5 * (1.0 - 0.2 * rate / onset_speed)

def along(sliding, normal):
    return 0.1 * normal * sliding

def stick(sliding, normal, coefficient):
    return -math.copysign(coefficient * normal, sliding)

def words(penetration):
    return "much"

def lists(penetration, stiffness):
    return stiffness * sum([penetration]) ** 1.5
"""
SETTINGS = [
    *({"normal_law": name} for name in DAMPINGS if name != KELVIN_VOIGT),
    {"normal_law": KELVIN_VOIGT, "viscous_damping": 100.0},
    {"elasticity": "liu"},
    {"elasticity": "foundation"},
    {"contact": "foundation"},
    *({"friction_law": name} for name in FRICTIONS),
    {"normal_law": "push", "friction_law": "rub"},
    {"A.normal_law": "push", "C.friction_law": "threlfall", "C.friction": 0.2},
]


def with_laws(settings: dict[str, object], folder: Path) -> Scene:
    """Return the base scene with laws; the names of user laws are replaced by file and name."""
    file = folder / "laws.py"
    file.write_text(USER_LAWS)
    changes = {}
    for key, value in settings.items():
        is_user_law = f"def {value}(" in USER_LAWS
        changes[key] = f"{file}:{value}" if is_user_law else value
    return changed(BASE, changes)


def run_for(scene: Scene, engine: InHouse | ExudynTree, duration: float) -> Run:
    run = run_scene(scene, engine, duration)
    # Sums over Exudyn's steps have an error at a jump of the force at a separation.
    assert residual(run) < (1e-7 if isinstance(engine, InHouse) else 3e-7)
    return run


@pytest.mark.parametrize(
    "settings", SETTINGS, ids=lambda laws: ",".join(map(str, laws.values()))
)
def test_engines_agree_and_keep_the_energy(settings, tmp_path):
    """During the first contacts of the press, whose motion differs from that of the base scene."""
    scene = with_laws(settings, tmp_path)
    scene.check_user_laws()
    # The tolerance is small, because step control does not include energy integrals.
    in_house = InHouse(integration_tolerance=1e-12)
    run = run_for(scene, in_house, 0.03)
    tree = run_for(scene, ExudynTree(tree_tolerance=1e-12), 0.03)
    assert sum(contacts_of(run, k)["touchdown"].size for k in range(2)) >= 4
    assert np.abs(run.end.position - tree.end.position).max() < 1e-8
    base = run_for(BASE, in_house, 0.03)
    if scene.bearings != BASE.bearings or scene.conventions != BASE.conventions:
        assert np.abs(run.end.position - base.end.position).max() > 1e-8


@pytest.mark.parametrize("seed", range(1, 5))
def test_a_force_that_jumps_acts_from_the_touchdown_on(seed):
    """A step from a pin that round-off leaves just open starts without the force."""
    masses = {"rod_mass": 0.01, "slider_mass": 0.01}
    law = {"normal_law": KELVIN_VOIGT, "viscous_damping": 1e5}
    scene = pw.scenes.slider_crank(**masses, **law, seed=seed, wear_updates=0)
    run = run_scene(scene, InHouse(), 5e-4)
    contacts = contacts_of(run, 0)
    assert contacts["touchdown"].size >= 1 or run.recorder.records.onset[0] > 0.0


def test_lugre_converges_at_second_order_with_bodies_and_joints():
    """Ten touchdowns of a four-bar with soft bristles, which bend throughout a contact.

    If bristles bend before the touchdown, too, the friction loss is off by 4e-3 at any
    step.
    """
    scene = changed(
        Scene(mechanism=FOUR_BAR, joints="AB", wear_updates=0),
        {
            "clearance": 5e-4,
            "friction": 0.1,
            "B.elasticity": "foundation",
            "conventions": "paper",
            "A.normal_law": "herbert-mcwhannell",
            "A.restitution": 0.8,
            "A.friction_law": "lugre",
            "A.static_friction": 0.15,
            "A.bristle_stiffness": 1e3,
            "B.normal_law": "hunt-crossley",
            "B.restitution": 0.75,
        },
    )

    def outcome(engine: ExudynJoints | InHouse) -> tuple[float, int]:
        run = run_scene(scene, engine, 0.0114)
        touchdowns = sum(contacts_of(run, k)["touchdown"].size for k in range(2))
        return float(run.diagnostics["friction_loss_J"]), touchdowns

    reference, touchdowns = outcome(InHouse(integration_tolerance=1e-12))
    assert touchdowns >= 10
    errors = []
    for steps in (200, 800):
        loss, count = outcome(ExudynJoints(steps_per_contact=steps))
        assert count == touchdowns
        errors.append(abs(loss / reference - 1.0))
    assert errors[0] < 4e-5
    assert errors[1] < 4e-6
    assert errors[0] / errors[1] > 8.0


@pytest.mark.parametrize(
    ("key", "law", "message"),
    [
        ("normal_law", "pull", "makes energy"),
        ("normal_law", "words", "must be a number"),
        ("friction_law", "along", "makes energy"),
        ("friction_law", "stick", "jumps from 10 to -10 N at sliding = 0 m/s"),
        ("normal_law", "lists", r"A\.normal_law: lists cannot be compiled"),
    ],
)
def test_wrong_laws_are_refused(key, law, message, tmp_path):
    """Laws that create energy or jump, whose result is no number, or that do not compile."""
    with pytest.raises(InputError, match=message) as refusal:
        pw.run(with_laws({key: law}, tmp_path), tmp_path / "out")
    assert law in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "out").exists()


def mine(penetration: float, rate: float, onset_speed: float) -> float:
    return 1.25e10 * penetration**1.5 * (1.0 + 0.1 * rate / onset_speed)


def test_a_result_stores_its_function_and_refuses_another_law(tmp_path):
    scene = replace(BASE, bearings=pw.Bearing(normal_law=mine), cycles=1)
    result = pw.run(scene, tmp_path / "out", engine="dae")
    loaded = pw.load(tmp_path / "out")
    assert loaded.scene == result.scene
    law = loaded.scene.bearings.normal_law
    assert isinstance(law, UserFunction)
    assert "def mine" in law.source
    other = replace(BASE, bearings=pw.Bearing(normal_law="flores"), cycles=1)
    with pytest.raises(InputError, match="normal_law is user law mine"):
        pw.run(other, tmp_path / "out", engine="dae")


@pytest.mark.parametrize("engine", [InHouse(), ExudynTree()])
def test_a_law_without_a_number_ends_the_run(engine: InHouse | ExudynTree, tmp_path):
    """The law is not a number at penetrations beyond those that are checked before the run."""
    law = "1e7 * penetration if penetration < 9e-6 else math.nan"
    text = f"def late(penetration):\n    return {law}\n"
    (tmp_path / "late.py").write_text(text)
    scene = changed(BASE, {"normal_law": f"{tmp_path}/late.py:late"})
    scene.check_user_laws()
    plan = Plan(0.1, 1, recorded_cycles=1)
    run = engine.for_cycle(scene.mechanism.period).simulate(
        scene.linkage(), start_of(scene), plan
    )
    assert run.status == "failed"


def test_energy_that_a_user_law_creates_is_in_the_ledger():
    """The force of the law is greater while the pin leaves than while it approaches."""
    linkage = BASE.linkage()
    force = "1e10 * penetration ** 1.5 * (1.0 - 0.2 * rate / onset_speed)"
    source = f"def rise(penetration, rate, onset_speed):\n    return {force}\n"
    law = NormalLaw(1e10, user_law=UserFunction("rise", source).trusted())
    joints = tuple(replace(joint, normal=law) for joint in linkage.clearances)
    linkage = replace(linkage, clearances=joints)
    run = InHouse().simulate(linkage, start_of(BASE), Plan(0.03, 1))
    loss = float(run.diagnostics["contact_loss_J"])
    created = float(run.diagnostics["contact_made_J"])
    assert loss < 0.0
    assert created == pytest.approx(-loss, rel=1e-9)
