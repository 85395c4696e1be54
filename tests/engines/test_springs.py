"""Springs whose ends coincide, stiff springs, and loads whose force is not finite."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from runs import energy_residual, in_every_engine, step_response

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints
from presswear.linkage.bodies import Body
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.loads import Force
from presswear.linkage.points import GROUND, Attachment, OutputPoint
from presswear.linkage.spring import Spring
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

MASS = 2.0  # kg
FREQUENCY = 20.0  # of the mass on its spring, rad/s
DURATION = 1.0  # s
VELOCITY = np.array([0.3, 0.6, 0.0])  # at the start, m/s and rad/s


def free_body(*springs: Spring, loads: Sequence[Force] = ()) -> Linkage:
    """Return one free body with springs and loads, without gravity."""
    return assemble(
        [Body("mass", MASS, 1.0, {"tip": (0.1, 0.0)})],
        output=OutputPoint("mass"),
        gravity=0.0,
        springs=springs,
        loads=loads,
        cycle=DURATION,
    )


def spring_to_origin(length: float, damping: float = 0.0) -> Spring:
    origin = Attachment(GROUND, 0.0, 0.0)
    centre = Attachment("mass", 0.0, 0.0)
    return Spring("s", origin, centre, MASS * FREQUENCY**2, length, damping)


def run_from(
    engine: Engine, linkage: Linkage, x: float, velocity: Sequence[float] | Array
) -> Run:
    """Run a linkage with the body at ``x`` on the x axis."""
    start = Start(np.array([x, 0.0, 0.0]), np.array(velocity))
    return engine.simulate(linkage, start, Plan(DURATION, 1))


@in_every_engine
@pytest.mark.parametrize(
    ("x", "velocity", "decay"),
    [
        (1e-7, VELOCITY, 0.0),
        (0.05, VELOCITY, 0.0),
        (0.0, VELOCITY, 3.0),
        (0.0, 0.0 * VELOCITY, 3.0),
    ],
)
def test_a_spring_without_length_is_linear(engine: Engine, within, x, velocity, decay):
    """Both coordinates oscillate independently, also from coinciding ends; decay in 1/s."""
    spring = spring_to_origin(0.0, damping=2.0 * MASS * decay)
    run = run_from(engine, free_body(spring), x, velocity)
    assert run.status == "completed", run.message
    damped = math.sqrt(FREQUENCY**2 - decay**2)
    fading = math.exp(-decay * DURATION)
    expected = fading * velocity * math.sin(damped * DURATION) / damped
    expected[0] += x * step_response(FREQUENCY, decay / FREQUENCY, DURATION)
    assert run.end.position == pytest.approx(expected, abs=100.0 * within)
    assert energy_residual(run) < 100.0 * within


@in_every_engine
def test_a_spring_with_a_length_needs_a_direction(engine: Engine, within):
    linkage = free_body(spring_to_origin(0.1))
    with pytest.raises(InputError, match=r"^spring s: .*length = 100 mm"):
        run_from(engine, linkage, 0.0, [0.3, 0.0, 0.0])
    run = run_from(engine, linkage, 1e-7, [0.3, 0.0, 0.0])
    assert run.status == "completed", run.message


def test_a_spring_joins_two_bodies():
    for body in ("mass", GROUND):
        first = Attachment(body, 0.0, 0.0)
        second = Attachment(body, 0.1, 0.0)
        with pytest.raises(InputError, match=f"^spring s: both ends are on {body}"):
            free_body(Spring("s", first, second, 100.0, 0.1))


def square_root(time: float, position: float, speed: float) -> float:
    """Force that is not a number beyond 0.1 m, N."""
    return math.sqrt(0.1 - position)


@in_every_engine
def test_a_law_without_a_finite_force_is_named(engine: Engine, within):
    """The message does not advise another tolerance, which would not help."""
    pull = Force("mass", 0.0, square_root, "pull")
    linkage = free_body(loads=[Force("mass.tip", 0.0, 1.0), pull])
    run = run_from(engine, linkage, 0.0, [0.3, 0.0, 0.0])
    assert run.status == "failed"
    assert "force pull" in run.message
    assert "tolerance" not in run.message
    assert "steps" not in run.message


def test_steps_follow_the_stiffest_spring():
    """Each period of a frame of 112 Hz has a hundred steps."""
    frequency = 112.0  # Hz
    stiffness = MASS * (2.0 * math.pi * frequency) ** 2
    origin = Attachment(GROUND, 0.0, 0.0)
    centre = Attachment("mass", 0.0, 0.0)
    linkage = free_body(Spring("frame", origin, centre, stiffness, 0.0))
    run = run_from(ExudynJoints(free_steps=1000), linkage, 1e-3, np.zeros(3))
    assert int(run.diagnostics["steps"]) >= 100 * frequency * DURATION
