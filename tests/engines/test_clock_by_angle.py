"""Cycles that end at an angle of the leader: closed forms of a rotor on a motor, in all engines."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import presswear as pw
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage

SPEED, TIME, ANGLE = 2.0 * math.pi, 0.7, 0.3  # rad/s, s, rad
ENGINES: list[tuple[Engine, float]] = [
    (InHouse(integration_tolerance=1e-11), 1e-10),
    (InHouse(integrator="rk4", equal_step=1e-3), 1e-10),
    (InHouse(coordinates="all"), 1e-9),
    (ExudynTree(tree_tolerance=1e-12), 1e-9),
    (ExudynJoints(), 1e-5),
]


INERTIA, SLIP = 2.0, 0.08  # kg m^2


def rotor(torque: float = INERTIA * SPEED * SLIP / TIME, brake: float = 0.0) -> Linkage:
    """A rotor on a pin with a line motor; ``brake`` is a moment against it, N m."""
    body = pw.Body("crank", 5.0, INERTIA, points={"tip": (0.1, 0.0)})
    motor = pw.Motor(torque, slip=SLIP, breakdown=None)
    return pw.assemble(
        [body],
        [pw.Pin("A", (0.0, 0.0), "crank.centre")],
        [pw.Drive("crank", SPEED, ANGLE, motor=motor)],
        output="crank.tip",
        direction=0.0,
        gravity=0.0,
        loads=[pw.Load("crank", moment=-brake)] if brake else [],
    )


def turned(t: float, first: float) -> float:
    """Angle of the rotor since the start, rad; ``first`` is its initial speed."""
    return SPEED * t + (first - SPEED) * TIME * (1.0 - math.exp(-t / TIME))


def instant(angle: float, first: float) -> float:
    return float(brentq(lambda t: turned(t, first) - angle, 0.0, 10.0, xtol=1e-15))


def run_of(
    engine: Engine,
    cycles: int,
    first: float,
    linkage: Linkage | None = None,
    **settings: Any,
) -> Run:
    start = Start(np.array([0.0, 0.0, ANGLE]), np.array([0.0, 0.0, first]))
    plan = Plan(1.0, cycles, torques=False, **settings)
    return engine.for_cycle(1.0).simulate(linkage or rotor(), start, plan)


@pytest.mark.parametrize(("engine", "off"), ENGINES, ids=lambda one: str(one)[:30])
def test_cycles_end_at_whole_turns(engine: Engine, off: float) -> None:
    """A rotor that starts at a tenth of its speed: its first turns take longer."""
    first = 0.1 * SPEED
    run = run_of(engine, 3, first, sections=(0.25, 0.999, 1.0))
    assert run.status == "completed", run.message
    ends = np.array([instant(2.0 * math.pi * k, first) for k in range(4)])
    recorder = run.recorder
    assert recorder.each_cycle("duration") == pytest.approx(np.diff(ends), abs=off)
    assert run.time == pytest.approx(ends[-1], abs=off)
    assert recorder.nominal_time == pytest.approx(3.0, abs=1e-9)
    # Places in the sections follow from the angle alone.
    phases = np.array([0.25, 0.999, 1.0])
    place = 0.1 * np.cos(ANGLE + 2.0 * math.pi * phases)
    assert recorder.sections[:, :, 0] == pytest.approx(np.tile(place, (3, 1)), abs=1e-9)
    # The bottom of a stroke is where the tip is on the left.
    bottom = (math.pi - ANGLE) / (2.0 * math.pi) + np.arange(3)
    times = recorder.each_cycle("bottom_time")
    assert times == pytest.approx(bottom, abs=1e-7)
    least = [SPEED + (first - SPEED) * math.exp(-t / TIME) for t in ends]
    assert recorder.each_cycle("leader_speed_min") == pytest.approx(least[:3], abs=1e-4)
    assert recorder.each_cycle("leader_speed_max") == pytest.approx(least[1:], abs=1e-4)
    mean = 2.0 * math.pi / np.diff(ends)
    assert recorder.each_cycle("leader_speed_mean") == pytest.approx(mean, rel=off)
    time = recorder.series("time")
    nominal = recorder.nominal_times
    angles = np.array([turned(t, first) for t in time])
    assert nominal == pytest.approx(angles / SPEED, abs=max(off, 1e-8))
    rates = 1.0 + (first / SPEED - 1.0) * np.exp(-time / TIME)
    assert recorder.nominal_rates == pytest.approx(rates, abs=max(off, 1e-8))


def test_a_run_by_the_clock_ends_at_its_time() -> None:
    first = 0.1 * SPEED
    run = run_of(ENGINES[0][0], 2, first, by_clock=True)
    assert run.time == 2.0
    assert run.end.position[2] - ANGLE == pytest.approx(turned(2.0, first), abs=1e-9)


@pytest.mark.parametrize("engine", [ENGINES[0][0], ENGINES[3][0], ENGINES[4][0]])
def test_a_stalled_motor_ends_the_run(engine: Engine) -> None:
    """A brake of the torque at a slip of 0.98, w = W_0 (0.02 + 0.98 exp(-t / T))."""
    torque = INERTIA * SPEED * SLIP / TIME
    run = run_of(engine, 9, SPEED, rotor(brake=0.98 * torque / SLIP))
    instant_of_stall = -TIME * math.log(0.03 / 0.98)
    angle = ANGLE + SPEED * (0.02 * instant_of_stall + TIME * (0.98 - 0.03))
    assert run.status == "failed"
    assert run.finding is not None
    assert run.finding.kind == "motor"
    stalled = float(run.message.split("an angle of ")[1].split()[0])
    assert stalled == pytest.approx(math.degrees(angle) % 360.0, abs=3.0)


@pytest.mark.parametrize("engine", [ENGINES[0][0], ENGINES[3][0], ENGINES[4][0]])
def test_a_motor_that_turns_backwards_at_the_start_ends_the_run(engine: Engine) -> None:
    """From rest under a brake of twice the torque of standstill."""
    run = run_of(engine, 2, 0.0, rotor(brake=2.0 * INERTIA * SPEED / TIME))
    assert run.status == "failed"
    assert run.message.startswith("the motor turns backwards from its start")
    # It has gone a quarter turn back, and is looked at every few cycles.
    assert math.pi / 2.0 < ANGLE - run.end.position[2] < 20.0 * math.pi


@pytest.mark.parametrize("engine", [ENGINES[0][0], ENGINES[3][0], ENGINES[4][0]])
def test_a_motor_that_does_not_start_ends_the_run(engine: Engine) -> None:
    """A hanging crank swings about the angle at which its weight holds the motor."""
    radius = 0.1
    mass = 50.0
    part = 0.02
    torque = part * mass * 9.81 * radius * SLIP
    motor = pw.Motor(torque, slip=SLIP, breakdown=None)
    linkage = pw.assemble(
        [pw.Body("crank", mass, 2.0, points={"axis": (-radius, 0.0)})],
        [pw.Pin("A", (0.0, 0.0), "crank.axis")],
        [pw.Drive("crank", SPEED, -0.5 * math.pi, motor=motor)],
    )
    start = Start(np.array([0.0, -radius, -0.5 * math.pi]), np.zeros(3))
    run = engine.for_cycle(1.0).simulate(linkage, start, Plan(1.0, 1))
    assert run.status == "failed"
    assert run.message.startswith("the motor does not start")
    assert 20.0 < run.time < 40.0
    rest = -0.5 * math.pi + math.asin(part)
    assert run.end.position[2] == pytest.approx(rest, abs=0.03)


def test_a_flywheel_approaches_the_even_crank_with_one_over_its_inertia() -> None:
    """Durations of a crank with an unbalanced mass, which starts at its top.

    From the side the first order would cancel over a turn.
    """
    even = 1.0
    off = []
    for inertia in (1e3, 1e4):
        body = pw.Body("crank", 50.0, 2.0, points={"axis": (-0.1, 0.0)})
        motor = pw.Motor(10.0, slip=SLIP, breakdown=None, inertia=inertia)
        linkage = pw.assemble(
            [body],
            [pw.Pin("A", (0.0, 0.0), "crank.axis")],
            [pw.Drive("crank", SPEED, 0.5 * math.pi, motor=motor)],
        )
        position = np.array([0.0, 0.1, 0.5 * math.pi])
        velocity = np.array([-0.1 * SPEED, 0.0, SPEED])
        run = (
            ENGINES[0][0]
            .for_cycle(1.0)
            .simulate(linkage, Start(position, velocity), Plan(1.0, 1))
        )
        assert run.status == "completed", run.message
        off.append(float(run.recorder.each_cycle("duration")[0]) - even)
    assert abs(off[0]) > 1e-4
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.1)
