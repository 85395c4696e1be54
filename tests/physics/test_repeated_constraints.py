"""Linkages whose ideal joints and drives hold a body more than once."""

import math
from dataclasses import replace

import numpy as np
import pytest
from marks import slow

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.linkage.linkage import Linkage
from presswear.physics.ideal import ideal_motion
from presswear.physics.inverse_dynamics import constraint_forces
from presswear.scene.plausible import doubts

SLOW = math.pi / 30.0  # rad/s, 1 rpm: inertia forces of some mN
FORCE = 4e6  # N, on the slide
# Steel bushings of 300 mm
BEARING = pw.Bearing(
    clearance=1e-4, bearing_radius=0.15, width=0.3, friction=0.0, contact_stiffness=5e12
)


def parallel_cranks(third_length: float = 0.05) -> Linkage:
    """Return three parallel cranks, one of them driven, that carry a coupling plate.

    Three bearings in one line would leave the plate free in the dead points of the
    cranks.
    """
    cranks = [
        pw.Bar(f"crank {n}", 0.05 if n < 3 else third_length, 1.0) for n in (1, 2, 3)
    ]
    places = {"1": (-0.2, 0.0), "2": (0.0, 0.15), "3": (0.2, 0.0)}
    joints = [pw.Pin(f"O{n}", place, f"crank {n}.tail") for n, place in places.items()]
    joints += [pw.Pin(f"A{n}", f"crank {n}.head", f"rod.{n}") for n in (1, 2, 3)]
    return pw.assemble(
        bodies=[*cranks, pw.Body("rod", 5.0, 0.1, places)],
        joints=joints,
        drives=[pw.Drive("crank 1", speed=1.0, angle=0.5)],
        guess={"crank 2": 0.5, "crank 3": 0.5, "rod": 0.0},
        output="rod.2",
        gravity=0.0,
    )


def with_shoe(offset: float) -> Linkage:
    """Return a two-point press whose slide turns on a shoe in the guide, loaded off its middle."""
    press = pw.TwoPoint(speed=SLOW).linkage()
    shoe = pw.Body("shoe", 1.0, 1.0)
    joints = [*press.revolutes, pw.Pin("shoe", "shoe.centre", "slider.centre")]
    guides = [replace(guide, body="shoe") for guide in press.guides]
    bodies = [
        replace(body, inertia=60.0) if body.name == "slider" else body
        for body in press.bodies
    ]
    return press.changed(
        bodies=[*bodies, shoe],
        joints=[*joints, *guides],
        loads=[pw.Load("slider", y=FORCE, moment=offset * FORCE)],
    )


def test_geared_cranks_share_the_load_of_a_guided_slide():
    press = pw.TwoPoint(speed=SLOW)
    linkage = press.linkage().changed(loads=[pw.Load("slider", y=FORCE)])
    ideal = ideal_motion(press.linkage(), press.period)
    forces = constraint_forces(linkage, ideal, np.linspace(0.0, press.period, 13))
    first, second = (ideal.rows.names.index(name) + 1 for name in ("B1", "B2"))
    carried = FORCE - press.slider_mass * press.gravity
    np.testing.assert_allclose(forces[:, first] + forces[:, second], carried, rtol=1e-6)
    np.testing.assert_allclose(forces[:, first], forces[:, second], rtol=1e-9)


def test_forces_of_repeated_constraints_balance_and_have_the_smallest_norm():
    linkage = parallel_cranks()
    ideal = ideal_motion(linkage, linkage.period)
    pushed = linkage.changed(loads=[pw.Load("rod", x=100.0, y=30.0, moment=7.0)])
    time = np.array([0.3, 2.0])
    forces = constraint_forces(pushed, ideal, time)
    transposed = ideal.rows.jacobian(
        ideal.at(time).position.reshape(2, -1, 3)
    ).transpose(0, 2, 1)
    for matrix, force in zip(transposed, forces, strict=True):
        # Forces of the rows that balance each other
        free = np.linalg.svd(matrix)[2][-1]
        assert np.abs(matrix @ free).max() < 1e-12
        assert abs(force @ free) < 1e-9 * np.abs(force).max()


def test_constraints_that_do_not_fit_are_refused_with_joint_and_distance():
    linkage = parallel_cranks(third_length=0.0501)
    expected = r"overconstrained: .* 13, 1 too many, .* at crank angle .* is off by .* m or rad"
    with pytest.raises(pw.InputError, match=expected):
        ideal_motion(linkage, linkage.period)


def simulated(scene: pw.Scene, duration: float) -> Run:
    """Run a scene for a duration, s, from its start."""
    engine = scene.solver.for_cycle(duration)
    return engine.simulate(
        scene.linkage(), start_of(scene), Plan(duration, 1, recorded_cycles=1)
    )


@pytest.mark.parametrize("engine", ["dae", slow("exudyn-joints")])
def test_joints_with_clearance_are_no_constraints_of_a_run(engine):
    bearings = {"A2": BEARING, "A3": BEARING}
    scene = pw.Scene(
        parallel_cranks(), bearings=bearings, engine=engine, wear_updates=0
    )
    assert simulated(scene, 0.02).status == "completed"
    assert any("smallest norm" in line for line in doubts(scene))


def settled_forces(linkage: Linkage, engine: str) -> list[float]:
    """Return the mean vertical forces of both rods on the slide, N, in the second half of 0.2 s."""
    bearings = {"B1": BEARING, "B2": BEARING}
    run = simulated(
        pw.Scene(linkage, bearings=bearings, engine=engine, wear_updates=0), 0.2
    )
    assert run.status == "completed"
    means = []
    for k in range(2):
        names = "normal", "eccentricity_x", "eccentricity_y"
        normal, ex, ey = (run.recorder.series(name, k) for name in names)
        half = normal.size // 2
        vertical = np.abs(normal * ey)[half:] / np.hypot(ex, ey)[half:]
        means.append(float(vertical.mean()))
    return means


def test_rods_of_a_turning_slide_share_an_off_centre_force_as_moments_say():
    forces = settled_forces(with_shoe(0.2), "dae")
    total = FORCE - 500.0 * 9.81
    assert max(forces) == pytest.approx(2.0 / 3.0 * total, rel=2e-3)
    assert min(forces) == pytest.approx(1.0 / 3.0 * total, rel=2e-3)
    assert math.isclose(sum(forces), total, rel_tol=1e-3)
