"""Springs whose ends meet, stiff springs, and elements whose force is not finite."""

import math
from typing import Any

import numpy as np
import pytest

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.elements import GROUND, Attachment, Body, OutputPoint
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.loads import Force
from presswear.linkage.spring import Spring
from presswear.tools.errors import InputError

ENGINES: list[tuple[Engine, float]] = [
    (InHouse(integration_tolerance=1e-12, free_step=0.01), 1e-10),
    (InHouse("rk4", equal_step=0.77e-3), 1e-8),
    (ExudynTree(tree_tolerance=1e-11, free_step=0.01), 1e-9),
    (ExudynJoints(50, 10, free_step=3e-4, newton=1e-10), 2e-5),
]
EVERY = pytest.mark.parametrize(
    ("engine", "within"), ENGINES, ids=["dop853", "rk4", "exudyn-tree", "exudyn-joints"]
)
FREQUENCY = 20.0  # rad/s


def floating(*springs: Spring, **rest: Any) -> Linkage:
    """A free body of 2 kg."""
    bodies = [Body("mass", 2.0, 1.0, {"tip": (0.1, 0.0)})]
    output = OutputPoint("mass")
    return assemble(
        bodies, output=output, gravity=0.0, springs=springs, cycle=1.0, **rest
    )


def to_centre(length: float, damping: float = 0.0) -> Spring:
    ends = Attachment(GROUND, 0.0, 0.0), Attachment("mass", 0.0, 0.0)
    return Spring("s", *ends, 2.0 * FREQUENCY**2, length, damping)


def run(engine: Engine, linkage: Linkage, q: list[float], v: list[float]) -> Run:
    return engine.simulate(linkage, Start(np.array(q), np.array(v)), Plan(1.0, 1))


@EVERY
@pytest.mark.parametrize("x", [0.0, 1e-7, 0.05])
def test_a_spring_without_length_is_linear(
    engine: Engine, within: float, x: float
) -> None:
    """Also where its ends meet; both coordinates swing by themselves."""
    ran = run(engine, floating(to_centre(0.0)), [x, 0.0, 0.0], [0.3, 0.6, 0.0])
    assert ran.status == "completed", ran.message
    sine = math.sin(FREQUENCY) / FREQUENCY
    cosine = math.cos(FREQUENCY)
    expected = x * cosine + 0.3 * sine, 0.6 * sine, 0.0
    assert ran.end.position == pytest.approx(np.array(expected), abs=100.0 * within)
    assert abs(float(ran.diagnostics["energy_residual_J"])) < 100.0 * within


@EVERY
def test_a_spring_without_length_is_damped(engine: Engine, within: float) -> None:
    """Along the line through the place where its ends meet."""
    decay = 3.0
    linkage = floating(to_centre(0.0, damping=2.0 * 2.0 * decay))
    ran = run(engine, linkage, [0.0, 0.0, 0.0], [0.3, 0.6, 0.0])
    assert ran.status == "completed", ran.message
    damped = math.sqrt(FREQUENCY**2 - decay**2)
    part = math.exp(-decay) * math.sin(damped) / damped
    assert ran.end.position[:2] == pytest.approx(
        np.array([0.3, 0.6]) * part, abs=100.0 * within
    )


@EVERY
def test_a_spring_without_length_rests_where_its_ends_meet(
    engine: Engine, within: float
) -> None:
    ran = run(engine, floating(to_centre(0.0, 1.0)), [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    assert ran.status == "completed", ran.message
    assert not ran.end.position.any()


@EVERY
def test_a_spring_with_a_length_needs_a_direction(
    engine: Engine, within: float
) -> None:
    with pytest.raises(InputError, match=r"^spring s: .*length = 100 mm"):
        run(engine, floating(to_centre(0.1)), [0.0, 0.0, 0.0], [0.3, 0.0, 0.0])
    ran = run(engine, floating(to_centre(0.1)), [1e-7, 0.0, 0.0], [0.3, 0.0, 0.0])
    assert ran.status == "completed", ran.message


def test_a_spring_joins_two_bodies() -> None:
    for body in ("mass", GROUND):
        ends = Attachment(body, 0.0, 0.0), Attachment(body, 0.1, 0.0)
        with pytest.raises(InputError, match=f"^spring s: both ends are on {body}"):
            floating(Spring("s", *ends, 100.0, 0.1))


def rooted(time: float, position: float, speed: float) -> float:
    return math.sqrt(0.1 - position)


@EVERY
def test_a_law_without_a_finite_force_is_named(engine: Engine, within: float) -> None:
    """Not the tolerance, of which no choice helps."""
    linkage = floating(
        loads=[Force("mass.tip", 0.0, 1.0), Force("mass", 0.0, rooted, "pull")]
    )
    ran = run(engine, linkage, [0.0, 0.0, 0.0], [0.3, 0.0, 0.0])
    assert ran.status == "failed"
    assert "force pull" in ran.message
    assert "tolerance" not in ran.message
    assert "steps" not in ran.message


def test_steps_follow_the_stiffest_spring() -> None:
    """A frame of 112 Hz at 60 strokes a minute: a hundred steps in its period."""
    frequency = 2.0 * math.pi * 112.0
    mass = 2.0
    ends = Attachment(GROUND, 0.0, 0.0), Attachment("mass", 0.0, 0.0)
    linkage = floating(Spring("frame", *ends, mass * frequency**2, 0.0))
    ran = run(ExudynJoints(free_steps=1000), linkage, [1e-3, 0.0, 0.0], [0.0, 0.0, 0.0])
    assert int(ran.diagnostics["steps"]) >= 100 * 112
