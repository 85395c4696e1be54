"""Motions of drives: the same in every engine, derivatives of each other, exact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from hypothesis import assume, given
from hypothesis import strategies as st
from listeners import Keeps
from numpy.testing import assert_allclose, assert_array_equal
from runs import energy_residual

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.drives import Drive
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.motion_pieces import RISES, Rise
from presswear.physics.drive_motion import (
    break_after,
    drive_motion,
    is_steady,
    motions_of,
    run_up_motion,
)
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import State
from presswear.validation.cases import finished

TURN = 2.0 * math.pi
amplitudes = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
fourier = st.builds(
    Drive,
    st.just("crank"),
    st.floats(-50.0, 50.0),
    st.floats(-3.0, 3.0),
    st.floats(0.1, 50.0),
    st.lists(amplitudes, max_size=5),
)


@given(fourier, st.floats(0.0, 10.0))
def test_a_fourier_series_is_summed_as_it_is_written(drive: Drive, t):
    """Against its complex form, whose derivatives are exact."""
    k = 1.0 + np.arange(len(drive.harmonics))
    c = np.array([complex(a, -b) for a, b in drive.harmonics])
    waves = c * np.exp(1j * k * drive.frequency * t)
    rates = 1j * k * drive.frequency
    turned = drive.speed * t + (waves - c.real).real.sum()
    exact = (
        turned,
        drive.speed + (rates * waves).real.sum(),
        (rates**2 * waves).real.sum(),
    )
    scale = (
        1.0 + np.abs(c).sum() * (1.0 + 5.0 * drive.frequency * np.array([1.0, t])).max()
    )
    compiled = drive_motion(motions_of(FOUR_BAR.changed(drives=[drive]))[0], t)
    for level, (one, other) in enumerate(zip(compiled, exact, strict=True)):
        bound = (
            1e-13
            * scale
            * (1.0 + 5.0 * drive.frequency) ** level
            * (1.0 + abs(drive.speed))
        )
        assert one == pytest.approx(other, abs=bound)
    result = np.ravel(drive.motion(np.array([t]))) - np.array([drive.angle, 0.0, 0.0])
    assert_allclose(result, compiled, rtol=1e-12, atol=1e-9)
    assert is_steady(FOUR_BAR, drive) == (not drive.harmonics)
    assert not is_steady(FOUR_BAR.changed(run_up=1), drive)


FOURIER = Drive("crank", 30.0, 0.2, harmonics=[(0.1, 0.3), (0.0, -0.05), (0.02, 0.0)])
UNEVEN = FOUR_BAR.changed(drives=[FOURIER])
CRANK = SliderCrank(slide_angle=0.0)
SWINGING = Drive("crank", angle=0.5, frequency=40.0, harmonics=[(0.0, 0.8)])
ROCKING = CRANK.linkage().changed(drives=[SWINGING])


INDEXING = Drive(
    "crank",
    30.0,
    0.2,
    rises=[Rise(0.3, 1.9, 0.4, "modified-sine"), Rise(3.0, 5.0, -0.4, "3-4-5")],
)
SERVO = Drive(
    "crank",
    30.0,
    0.2,
    table=[(0.5, 0.0), (1.5, 0.15), (2.8, 0.05), (4.0, -0.1), (5.2, 0.1)],
)
MOTIONS = {
    "four-bar": UNEVEN,
    "slider-crank": ROCKING,
    "rises": FOUR_BAR.changed(drives=[INDEXING]),
    "table, run-up": FOUR_BAR.changed(drives=[SERVO], run_up=1),
}
STEADY = FOUR_BAR.changed(drives=[SERVO])


BOUND = 1e-7


# The trapezoidal rule has all motions below.
@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize(
    ("engine", "joints"), [("dae", "none"), ("dae", "B"), ("exudyn-tree", "B")]
)
def test_engines_follow_an_uneven_drive(name, engine, joints):
    """Without clearance the closed motion; with it the drive, and an energy that adds up."""
    scene = Scene(mechanism=MOTIONS[name], joints=joints, wear_updates=0, engine=engine)
    period = scene.mechanism.period
    plan = Plan(period, 1, run_up=scene.run_up)
    run = finished(
        scene.solver.for_cycle(period).simulate(scene.linkage(), start_of(scene), plan)
    )
    assert run.time == pytest.approx(scene.run_up + period, rel=1e-9)
    end = scene.ideal.at(np.array([run.time]))
    angle = np.abs(run.end.position - end.position[0])
    speed = np.abs(run.end.velocity - end.velocity[0])
    # The drive itself: exact.
    assert angle[2] < (1e-11 if engine == "dae" else 1e-14)
    assert speed[2] < 1e-9
    if joints == "none":
        assert angle.max() < BOUND
        assert speed.max() < 1e2 * BOUND
    else:
        residual = energy_residual(run)
        assert residual < 10.0 * BOUND * float(run.diagnostics["drive_exchange_J"])


@pytest.mark.parametrize("name", MOTIONS)
def test_the_trapezoidal_rule_keeps_to_uneven_drives_in_every_row(name):
    """All levels of what is watched, over the border of two cycles: nothing drifts or swings."""
    scene = Scene(mechanism=MOTIONS[name], joints="none", wear_updates=0)
    period = scene.mechanism.period
    engine = ExudynJoints(free_step=period / 500)
    plan = Plan(period, 2, 2, run_up=scene.run_up)
    run = engine.simulate(scene.linkage(), start_of(scene), plan)
    assert run.recorder.last_time == pytest.approx(scene.run_up + 2.0 * period)
    rows = run.recorder.rows
    exact = scene.ideal_slider(rows[:, 0])
    off = np.abs(rows[:, 1:4] - exact).max(axis=0) / np.abs(exact).max(axis=0)
    assert len(rows) > 1000
    assert np.all(off < (1e-12, 1e-12, 1e-11))
    # No torque in the series is beside the one of the motion.
    fine = InHouse(integration_tolerance=1e-12).simulate(
        scene.linkage(), start_of(scene), plan
    )
    one, other = (item.recorder for item in (run, fine))
    torque = np.interp(one.rows[:, 0], other.rows[:, 0], other.torques[:, 0])
    assert np.abs(one.torques[:, 0] - torque).max() < 1e-3 * np.abs(torque).max()


FAR = {"clearance": "0.9 m", "bearing_radius": "1 m"}
"""The pin never meets its bearing: what is left is smooth but for the breaks of the motion."""


@pytest.mark.parametrize("joint", ["O", "B"])
@pytest.mark.parametrize("is_far", [True, False], ids=["far", "near"])
def test_a_drive_turns_exactly_where_joints_are_loose(joint, is_far):
    """Its hinge, or a joint behind which the loop keeps freedom; with contacts and without."""
    clearance = FAR if is_far else {"clearance": "0.2 mm"}
    scene = changed(Scene(mechanism=UNEVEN, joints=joint, wear_updates=0), clearance)
    linkage = scene.linkage()
    period = scene.mechanism.period
    states: list[State] = []
    plan = Plan(0.07 * period, 3, observers=(Keeps(states.append),))
    run = ExudynJoints().for_cycle(period).simulate(linkage, start_of(scene), plan)
    touches = int(run.recorder.records.counters["contacts"].sum())
    assert run.status == "completed", run.message
    assert (touches < 3) == is_far
    for count, state in enumerate(states, 1):
        exact = linkage.drives[0].motion(np.array([count * plan.cycle]))
        result = [state[level][2] for level in "qva"]
        # Round-off of the accelerations of the free bodies is in that of the drive.
        assert_allclose(result, np.ravel(exact), rtol=1e-12)
    assert len(states) == 3


def flying(linkage: Linkage) -> Scene:
    return changed(Scene(mechanism=linkage, joints="B", wear_updates=0), FAR)


def flown(scene: Scene, engine: Engine, cycles: float = 1.37) -> Run:
    plan = Plan(cycles * scene.mechanism.period, 1, 1)
    return finished(engine.simulate(scene.linkage(), start_of(scene), plan))


def test_no_engine_loses_its_order_at_the_breaks_of_a_motion():
    """Steps of a given length against very fine ones; across the breaks errors were 1e-4 to 1e-5.

    Steps are as long as they may be: a tolerance that all of them pass.
    """
    scene = flying(STEADY)
    period = scene.mechanism.period
    fine = flown(scene, InHouse(integration_tolerance=1e-14, free_step=period / 2000))

    def error(engine: Engine) -> float:
        return float(
            np.abs(flown(scene, engine).end.position - fine.end.position).max()
        )

    rk4 = [
        error(InHouse(integrator="rk4", equal_step=period / n)) for n in (74, 148, 296)
    ]
    assert min(np.log2(rk4[k] / rk4[k + 1]) for k in (0, 1)) > 3.7
    tree = [
        error(ExudynTree(tree_tolerance=1e3, free_step=period / n)) for n in (148, 296)
    ]
    assert np.log2(tree[0] / tree[1]) > 4.2
    assert error(InHouse(integration_tolerance=1e6, free_step=period / 74)) < 1e-11


@pytest.mark.parametrize(
    "engine", [ExudynTree(), ExudynJoints(free_step=1e-3), InHouse()]
)
def test_no_cycle_holds_anything_of_the_run_up(engine: Engine):
    """Cycles are those of the linkage that starts at speed; a run goes on bit for bit."""
    scene = flying(MOTIONS["table, run-up"])
    linkage = scene.linkage()
    start = start_of(scene)
    period = scene.mechanism.period
    states: list[State] = []
    plan = Plan(period, 2, run_up=scene.run_up, observers=(Keeps(states.append),))
    run = finished(engine.simulate(linkage, start, plan))
    assert run.recorder.last_time == pytest.approx(
        scene.run_up + 2.0 * period, rel=1e-9
    )
    # The steps of the run-up are in none of them.
    assert run.recorder.each_cycle("steps").sum() < 0.7 * float(
        run.diagnostics["steps"]
    )
    again = engine.simulate(
        linkage, start, replace(plan, observers=(), resume=states[0])
    )
    assert_array_equal(again.recorder.cycles, run.recorder.cycles)
    assert_array_equal(again.end.position, run.end.position)


@st.composite
def in_pieces(draw: st.DrawFn) -> Drive:
    """Return a drive with two rises or a table."""
    speed = draw(st.floats(-9.0, 9.0))
    if draw(st.booleans()):
        values = draw(st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=20))
        table = [(k * TURN / len(values), x) for k, x in enumerate(values)]
        return Drive("crank", speed, frequency=7.0, table=table)
    first = draw(st.floats(0.0, 6.0))
    by = draw(st.floats(-2.0, 2.0))
    end = first + draw(st.floats(0.2, 4.0))
    rise = Rise(first, end, by, draw(st.sampled_from(sorted(RISES))))
    back = Rise(end + 0.5, end + 1.5, -0.8 * by, "cycloidal")
    return Drive("crank", speed, frequency=7.0, rises=[rise, back])


@given(in_pieces(), st.floats(0.0, 300.0), st.integers(0, 3))
def test_kernels_see_the_pieces_that_are_written(drive: Drive, t, run_up):
    """To round-off after hundreds of cycles, whose phase is known to 1e-12 rad."""
    linkage = FOUR_BAR.changed(drives=[drive], run_up=run_up, cycle=TURN / 7.0)
    motion = motions_of(linkage)[0]
    tau, rate, rise = run_up_motion(linkage.run_up_time, t)
    angle, speed, faster = (float(level[0]) for level in drive.motion(np.array([tau])))
    exact = angle - drive.angle, speed * rate, faster * rate**2 + speed * rise
    steep = (
        np.abs(drive.pieces.polynomial).max()
        + 10.0 * np.abs(drive.pieces.wave[:, :2]).prod()
    )
    for one, other in zip(drive_motion(motion, t), exact, strict=True):
        assert one == pytest.approx(other, rel=1e-12, abs=1e-10 * (1.0 + steep))


@given(in_pieces(), st.floats(0.0, 3.0), st.integers(0, 2))
def test_breaks_are_where_the_pieces_end(drive: Drive, t, run_up):
    """One after the other, each once: their phases are those at which pieces begin."""
    # Breaks are told apart from the turn's own end from 1e-9 of it on.
    assume(all(start == 0.0 or start > 1e-6 for start in drive.pieces.start))
    linkage = FOUR_BAR.changed(drives=[drive], run_up=run_up, cycle=TURN / 7.0)
    motion = motions_of(linkage)[0]
    duration = linkage.run_up_time
    result = [t]
    for _ in range(3 * len(drive.pieces.start) + 1):
        result.append(break_after(motion, result[-1]))
    assert np.all(np.diff(result) > 0.0)
    turns = 7.0 * np.array([run_up_motion(duration, t)[0] for t in result]) / TURN
    off = np.abs(np.subtract.outer(turns, drive.pieces.start / TURN) % 1.0)
    off = np.minimum(off, 1.0 - off).min(axis=1)
    of_run_up = np.isclose(result, duration, rtol=1e-12) & (off > 1e-9)
    assert of_run_up[1:].sum() <= 1
    assert off[1:][~of_run_up[1:]].max(initial=0.0) < 1e-11
    # None is left out: as many as pieces begin in that time.
    started = np.floor(turns[[0, -1]] - drive.pieces.start[:, np.newaxis] / TURN + 1e-9)
    assert len(result) - 1 - of_run_up[1:].sum() == np.diff(started).sum()


@given(st.floats(0.5, 500.0), st.integers(1, 10_000))
def test_a_cycle_that_ends_at_a_break_has_the_next_one_ahead(frequency, turns):
    """A whole turn short by round-off: a step to a break of no length would never end."""
    table = [(0.0, 0.0), (1.5, 0.2), (4.0, -0.1)]
    linkage = FOUR_BAR.changed(
        drives=[Drive("crank", 0.0, 0.0, frequency, table=table)]
    )
    (motion,) = motions_of(linkage)
    end = turns * (TURN / frequency)
    for time in (end, np.nextafter(end, 0.0), np.nextafter(end, math.inf)):
        assert break_after(motion, time) == pytest.approx(
            end + 1.5 / frequency, abs=1e-9 * end
        )
