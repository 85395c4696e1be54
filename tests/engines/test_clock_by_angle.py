"""Cycles that end at an angle of the leader: closed forms of a rotor on a motor, in all engines."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import presswear as pw
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.drives import Drive
from presswear.linkage.linkage import Linkage

SPEED, TIME, ANGLE = 2.0 * math.pi, 0.7, 0.3  # rad/s, s, rad
ENGINES: list[tuple[Engine, float]] = [
    (InHouse(integration_tolerance=1e-11), 1e-10),
    (InHouse(integrator="rk4", equal_step=1e-3), 1e-10),
    (InHouse(coordinates="all"), 1e-9),
    (ExudynTree(tree_tolerance=1e-12), 1e-9),
    (ExudynJoints(), 1e-5),
]


def line(speed: float) -> float:
    """Torque of a line motor, N m, on an inertia of 2 kg m^2."""
    return 2.0 / 0.7 * (6.283185307179586 - speed)


def rotor() -> Linkage:
    """A rotor on a pin, turned by a moment that depends on its speed."""
    body = pw.Body("crank", 5.0, 2.0, points={"tip": (0.1, 0.0)})
    pin = pw.Pin("A", (0.0, 0.0), "crank.centre")
    return pw.assemble(
        [body],
        [pin],
        output="crank.tip",
        direction=0.0,
        cycle=1.0,
        gravity=0.0,
        loads=[pw.Moment("crank", line)],
        guess={"crank": ANGLE},
    )


def turned(t: float, first: float) -> float:
    """Angle of the rotor since the start, rad; ``first`` is its initial speed."""
    return SPEED * t + (first - SPEED) * TIME * (1.0 - math.exp(-t / TIME))


def instant(angle: float, first: float) -> float:
    return float(brentq(lambda t: turned(t, first) - angle, 0.0, 10.0, xtol=1e-15))


@pytest.fixture
def leader(monkeypatch: pytest.MonkeyPatch) -> None:
    drive = Drive("crank", SPEED, ANGLE)
    monkeypatch.setattr(Linkage, "leader", property(lambda self: drive))


def run_of(engine: Engine, cycles: int, first: float, **plan: object) -> Run:
    start = Start(np.array([0.0, 0.0, ANGLE]), np.array([0.0, 0.0, first]))
    run = engine.for_cycle(1.0).simulate(
        rotor(), start, Plan(1.0, cycles, torques=False, **plan)
    )
    assert run.status == "completed", run.message
    return run


@pytest.mark.usefixtures("leader")
@pytest.mark.parametrize(("engine", "off"), ENGINES, ids=lambda one: str(one)[:30])
def test_cycles_end_at_whole_turns(engine: Engine, off: float) -> None:
    """A rotor that starts at a tenth of its speed: its first turns take longer."""
    first = 0.1 * SPEED
    run = run_of(engine, 3, first, sections=(0.25, 0.999, 1.0))
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
    time, nominal = recorder.series("time"), recorder.nominal_times
    angles = np.array([turned(t, first) for t in time])
    assert nominal == pytest.approx(angles / SPEED, abs=max(off, 1e-8))


@pytest.mark.usefixtures("leader")
def test_a_run_by_the_clock_ends_at_its_time() -> None:
    first = 0.1 * SPEED
    run = run_of(ENGINES[0][0], 2, first, by_clock=True)
    assert run.time == 2.0
    assert run.end.position[2] - ANGLE == pytest.approx(turned(2.0, first), abs=1e-9)
