"""Rigid joints with friction in runs: closed forms, ideal torques, energies, engines."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from runs import energy_residual, in_all_coordinates, residual, run_scene

import presswear as pw
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.linkage import Linkage
from presswear.physics.inverse_dynamics import needed_torques
from presswear.physics.packed import pack

RUBS = pw.Bearing(clearance=0.0, friction=0.1, bearing_radius=0.02)
LOOSE = pw.Bearing(clearance=1e-4, friction=0.1, bearing_radius=0.02)
MASS = 2.0
LENGTH = 0.4
SPIN = 20.0
DURATION = 0.2


def free_bar(law: FrictionLaw, radius: float) -> Linkage:
    """A bar without weight that turns about a pin of the frame at its end."""
    linkage = pw.assemble(
        [pw.Bar("bar", length=LENGTH, mass=MASS)],
        [pw.Pin("O", (0.0, 0.0), "bar.tail")],
        gravity=0.0,
        cycle=DURATION,
    )
    pin = replace(linkage.revolutes[0], bearing_radius=radius, friction=law)
    return replace(linkage, joints=(pin,))


def run_of_bar(engine: Any, law: FrictionLaw, radius: float) -> Run:
    arm = 0.5 * LENGTH
    start = Start(np.array([arm, 0.0, 0.0]), np.array([0.0, SPIN * arm, SPIN]))
    linkage = free_bar(law, radius)
    run: Run = engine.for_cycle(DURATION).simulate(linkage, start, Plan(DURATION, 1))
    return run


@pytest.mark.parametrize(
    ("engine", "error"),
    [
        (InHouse(), 1e-12),
        (ExudynJoints(), 2e-8),
        pytest.param(
            ExudynJoints(free_steps=40_000), 2e-9, marks=pytest.mark.slow, id="fine"
        ),
    ],
)
def test_a_free_bar_slows_down_by_the_friction_of_its_pin(engine, error):
    """F = m a sqrt(w^4 + w'^2), so that w' = -k w^2 and w = w_0 / (1 + k w_0 t)."""
    coefficient = 0.3
    radius = 0.05
    arm = 0.5 * LENGTH
    run = run_of_bar(engine, FrictionLaw(coefficient), radius)
    assert run.status == "completed", run.message
    inertia = MASS * LENGTH**2 / 3.0
    torque = coefficient * radius * MASS * arm
    k = torque / math.sqrt(inertia**2 - torque**2)
    spin = SPIN / (1.0 + k * SPIN * DURATION)
    assert run.end.velocity[2] == pytest.approx(spin, rel=error)
    lost = 0.5 * inertia * (SPIN**2 - spin**2)
    assert run.diagnostics["friction_loss_J"] == pytest.approx(lost, rel=10.0 * error)
    assert energy_residual(run) < 10.0 * error * lost


def test_friction_beyond_the_lever_of_the_joint_force_ends_the_run():
    """Above r mu m a = I no joint force holds the moment."""
    law = FrictionLaw(0.8)
    radius = 0.4
    run = run_of_bar(InHouse(), law, radius)
    assert run.status == "failed"
    assert "friction in rigid joints blocks motion" in run.message


@pytest.mark.parametrize(
    ("engine", "error", "run_up"),
    [
        (InHouse(), 1e-11, 0),
        (InHouse(), 1e-11, 1),
        (InHouse(projection="on"), 1e-12, 0),
        (ExudynJoints(), 1e-6, 0),
    ],
)
def test_drives_of_a_run_give_the_ideal_torque_with_friction(engine, error, run_up):
    scene = pw.Scene(pw.SliderCrank(run_up=run_up), bearings=dict.fromkeys("OAB", RUBS))
    assert scene.clearance_joints == ()
    linkage = scene.linkage()
    run = run_scene(scene, engine, recorded_cycles=1, run_up=scene.run_up)
    time = run.recorder.series("time")
    torque = run.recorder.rows[:, -1]
    rubbed = needed_torques(linkage, scene.ideal, time, linkage.bushings)[:, 0]
    free = needed_torques(linkage, scene.ideal, time)[:, 0]
    assert np.abs(rubbed - free).max() > 0.2 * np.abs(rubbed).max()
    np.testing.assert_allclose(
        torque, rubbed, rtol=0.0, atol=error * np.abs(rubbed).max()
    )
    assert residual(run) < 1e-6
    loss, work = (
        float(run.diagnostics[f"{name}_J"]) for name in ("friction_loss", "drive_work")
    )
    if run_up == 0:  # after a cycle everything else is as before
        assert loss == pytest.approx(work, rel=1e-9)
    assert loss > 0.1 * float(run.diagnostics["drive_exchange_J"])


@pytest.mark.parametrize(
    "bearings", [{"O": RUBS, "A": RUBS, "B": LOOSE}, {"O": RUBS, "A": LOOSE}]
)
def test_engines_agree_with_clearance_beside_rigid_joints_that_rub(
    bearings: dict[str, pw.Bearing],
):
    """Also on the pin of a crank that would be prescribed and left out."""
    scene = pw.Scene(pw.SliderCrank(), bearings=bearings, wear_updates=0)
    end = scene.mechanism.period / 8.0
    exact = run_scene(scene, InHouse("dop853", 1e-12), end)
    other = run_scene(scene, InHouse("dopri5", 1e-12, projection="on"), end)
    fine = ExudynJoints(free_steps=40_000, steps_per_contact=800, steps_sustained=40)
    exudyn = run_scene(scene, fine, end)
    for run, distance, energy in ((other, 1e-9, 1e-7), (exudyn, 1e-5, 1e-4)):
        np.testing.assert_allclose(
            run.end.position, exact.end.position, rtol=0.0, atol=distance
        )
        for name in ("friction_loss_J", "drive_work_J"):
            assert run.diagnostics[name] == pytest.approx(
                exact.diagnostics[name], rel=energy
            )
        assert residual(run) < 1e-5
    plain = replace(
        scene, bearings={name: one for name, one in bearings.items() if one is LOOSE}
    )
    without = run_scene(plain, InHouse(), end)
    losses = [float(one.diagnostics["friction_loss_J"]) for one in (exact, without)]
    assert losses[0] > 1.5 * losses[1]
    assert "friction without clearance: O" in str(exact.diagnostics["model"])


def test_the_open_tree_refuses_rigid_joints_that_rub():
    scene = pw.Scene(pw.SliderCrank(), bearings={"O": RUBS, "B": LOOSE})
    says = "joint O rubs without clearance, and its friction needs the joint force"
    with pytest.raises(pw.InputError, match=f"exudyn-tree.*{says}.*exudyn-joints, dae"):
        replace(scene, engine="exudyn-tree").check()
    with pytest.raises(pw.InputError, match=says):
        ExudynTree().simulate(
            scene.linkage(), Start(np.zeros(9), np.zeros(9)), Plan(1.0, 1)
        )
    assert replace(scene, engine="exudyn").solver.word == "exudyn-joints"


def test_nothing_is_added_where_no_joint_rubs():
    smooth = replace(RUBS, friction=0.0)
    for scene in (
        pw.Scene(pw.SliderCrank(), bearings={"O": smooth, "A": smooth}),
        pw.Scene(pw.SliderCrank(), bearings={"B": LOOSE}),
    ):
        linkage = scene.linkage()
        packed = pack(linkage)
        assert not packed.rubbing.size
        system = in_all_coordinates(linkage)
        coordinates = 2 * 3 * len(linkage.bodies)
        assert system.layout.size == coordinates + 6 + 2 * len(linkage.clearances) + 4
