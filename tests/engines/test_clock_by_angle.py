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

SPEED = 2.0 * math.pi  # without load, rad/s
TIME = 0.7  # time constant, s
ANGLE = 0.3  # at the start, rad
INERTIA = 2.0  # kg m^2
SLIP = 0.08
# Engines, and tolerances of times, s
ENGINES: list[tuple[Engine, float]] = [
    (InHouse(integration_tolerance=1e-11), 1e-10),
    (InHouse(integrator="rk4", equal_step=1e-3), 1e-10),
    (InHouse(coordinates="all"), 1e-9),
    (ExudynTree(tree_tolerance=1e-12), 1e-9),
    (ExudynJoints(), 1e-5),
]
IN_HOUSE = ENGINES[0][0]
each_kind = pytest.mark.parametrize(
    "engine", [IN_HOUSE, ExudynTree(tree_tolerance=1e-12), ExudynJoints()]
)
SECTIONS = (0.25, 0.999, 1.0)  # phases of Poincare sections
TIP = 0.1  # distance of the tip from the axis, m


def rotor(torque: float = INERTIA * SPEED * SLIP / TIME, brake: float = 0.0) -> Linkage:
    """A rotor on a pin with a line motor; ``brake`` is a moment against it, N m."""
    body = pw.Body("crank", 5.0, INERTIA, points={"tip": (TIP, 0.0)})
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


def angle_at(t: float, first: float) -> float:
    """Angle of the rotor since the start, rad; ``first`` is its initial speed, rad/s."""
    return SPEED * t + (first - SPEED) * TIME * (1.0 - math.exp(-t / TIME))


def instant(angle: float, first: float) -> float:
    """Time at which the rotor has an angle since the start, s."""
    return float(brentq(lambda t: angle_at(t, first) - angle, 0.0, 10.0, xtol=1e-15))


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


@pytest.mark.parametrize(
    ("engine", "within"), ENGINES, ids=lambda value: str(value)[:30]
)
def test_cycles_end_at_whole_turns(engine: Engine, within):
    """A rotor that starts at a tenth of its speed: times, sections and speeds."""
    first = 0.1 * SPEED
    run = run_of(engine, 3, first, sections=SECTIONS)
    assert run.status == "completed", run.message
    ends = np.array([instant(2.0 * math.pi * k, first) for k in range(4)])
    durations = np.diff(ends)
    recorder = run.recorder
    assert recorder.each_cycle("duration") == pytest.approx(durations, abs=within)
    assert run.time == pytest.approx(ends[-1], abs=within)
    assert recorder.nominal_time == pytest.approx(3.0, abs=1e-9)
    # Positions in the sections follow from the angle alone.
    position = TIP * np.cos(ANGLE + 2.0 * math.pi * np.array(SECTIONS))
    expected = np.tile(position, (3, 1))
    assert recorder.sections[:, :, 0] == pytest.approx(expected, abs=1e-9)
    # At the bottom of a stroke the tip is on the left.
    bottom = (math.pi - ANGLE) / (2.0 * math.pi) + np.arange(3)
    assert recorder.each_cycle("bottom_time") == pytest.approx(bottom, abs=1e-7)
    assert recorder.each_cycle("bottom_height") == pytest.approx(-TIP, abs=1e-9)
    speeds = SPEED + (first - SPEED) * np.exp(-ends / TIME)
    least = recorder.each_cycle("leader_speed_min")
    assert least == pytest.approx(speeds[:-1], abs=1e-4)
    largest = recorder.each_cycle("leader_speed_max")
    assert largest == pytest.approx(speeds[1:], abs=1e-4)
    mean = recorder.each_cycle("leader_speed_mean")
    assert mean == pytest.approx(2.0 * math.pi / durations, rel=within)
    time = recorder.series("time")
    angles = np.array([angle_at(t, first) for t in time])
    tolerance = max(within, 1e-8)
    assert recorder.nominal_times == pytest.approx(angles / SPEED, abs=tolerance)
    rates = 1.0 + (first / SPEED - 1.0) * np.exp(-time / TIME)
    assert recorder.nominal_rates == pytest.approx(rates, abs=tolerance)


def test_a_run_by_the_clock_ends_at_its_time():
    first = 0.1 * SPEED
    run = run_of(IN_HOUSE, 2, first, by_clock=True)
    assert run.time == 2.0
    angle = run.end.position[2] - ANGLE
    assert angle == pytest.approx(angle_at(2.0, first), abs=1e-9)


@each_kind
def test_a_stalled_motor_ends_the_run(engine: Engine):
    """The torque of a brake is that at a slip s: w = w_0 (1 - s + s exp(-t / T)).

    A motor is stalled at 5 % of its speed without load.
    """
    slip = 0.98
    torque = INERTIA * SPEED * SLIP / TIME
    run = run_of(engine, 9, SPEED, rotor(brake=slip * torque / SLIP))
    decay = 0.05 - (1.0 - slip)  # s exp(-t / T) at this speed
    time = -TIME * math.log(decay / slip)
    angle = ANGLE + SPEED * ((1.0 - slip) * time + TIME * (slip - decay))
    assert run.status == "failed"
    assert run.finding is not None
    assert run.finding.kind == "motor"
    _, _, rest = run.message.partition("an angle of ")
    reported = float(rest.split()[0])
    assert reported == pytest.approx(math.degrees(angle) % 360.0, abs=3.0)


@each_kind
def test_a_motor_that_turns_backwards_at_the_start_ends_the_run(engine: Engine):
    """From rest under a brake of twice the torque of standstill."""
    run = run_of(engine, 2, 0.0, rotor(brake=2.0 * INERTIA * SPEED / TIME))
    assert run.status == "failed"
    assert run.message.startswith("the motor turns backwards from its start")
    # The run ends after a quarter turn back, which is checked every few cycles.
    assert math.pi / 2.0 < ANGLE - run.end.position[2] < 20.0 * math.pi


@pytest.mark.parametrize("engine", [IN_HOUSE, ExudynTree(tree_tolerance=1e-12)])
def test_a_motor_that_does_not_start_ends_the_run(engine: Engine):
    """A hanging crank swings about the angle at which its weight holds the motor."""
    radius = 0.1
    mass = 50.0
    ratio = 0.02  # torque of the motor at rest over the greatest moment of the weight
    torque = ratio * mass * 9.81 * radius * SLIP
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
    rest = -0.5 * math.pi + math.asin(ratio)
    assert run.end.position[2] == pytest.approx(rest, abs=0.03)
