"""A block on a floor: SDND100 beside what ``presswear verify`` compares, and LuGre friction.

The floor is a bearing so large that it is flat. LuGre: Canudas de Wit, Olsson, Astrom
and Lischinsky, 1995.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import presswear as pw
from presswear.engines.base import Plan, Run
from presswear.engines.exudyn_joints.interaction_states import exponential_step
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.friction_settings import LuGreSettings, greatest_bristle_damping
from presswear.linkage.load_laws import OverTime
from presswear.linkage.loads import Force
from presswear.physics.interactions.lugre import (
    Bristles,
    bristle_force,
    bristle_rate,
)
from presswear.validation import reference_problems as references
from presswear.validation.cases import finished

PRESS = 10.0
DYNAMIC = 0.1
STATIC = 0.15
STRIBECK = 1e-3
STIFF = 1e4
SETTINGS = LuGreSettings(STATIC, STRIBECK, STIFF, 30.0)
LUGRE = FrictionLaw(DYNAMIC, 0.0, 1e-3, "lugre", settings=SETTINGS)
RAMP = FrictionLaw(DYNAMIC, 0.0, 1e-3)
FINE = InHouse(integration_tolerance=1e-10)


def pulled(
    pull: float,
    time: float,
    law: FrictionLaw = LUGRE,
    speed: float = 0.0,
    engine: Engine = FINE,
) -> Run:
    """A block of 1 kg pressed on by 10 N, after a while, s, under a pull, N, slowly put on."""
    linkage, start = references.block(0.0, PRESS, law, speed)
    slowly = OverTime([(0.0, 0.0), (1.0, pull)], period=0.0)
    own = pull if speed > 0.0 else slowly
    linkage = linkage.changed(loads=[*linkage.loads, Force("block.centre", 0.0, own)])
    return finished(engine.simulate(linkage, start, Plan(time, 1, recorded_cycles=1)))


@pytest.mark.parametrize("engine", [FINE, ExudynJoints(free_step=1e-4)])
def test_what_is_pulled_too_weakly_stays(engine: Engine):
    """Bristles bend until sigma_0 z bears the pull: then nothing moves, where a ramp creeps."""
    run = pulled(0.8, 1.1, engine=engine)
    assert borne_by_bristles(run) == pytest.approx(0.8 / PRESS, rel=1e-3)
    assert abs(run.end.velocity[0]) < 1e-7
    # Slipping on the way there adds to it: z' = x' (1 - sigma_0 z / g).
    moved = -STATIC / STIFF * math.log(1.0 - 0.8 / PRESS / STATIC)
    assert run.end.position[0] == pytest.approx(moved, rel=1e-2)
    assert pulled(0.8, 1.1, RAMP).end.velocity[0] == pytest.approx(0.8e-3, rel=1e-4)


def test_it_breaks_away_at_the_static_coefficient_and_slides_at_the_other():
    """Between c_f and c_s it depends on the start: from rest it holds, sliding it goes on."""
    pull = 0.5 * (DYNAMIC + STATIC) * PRESS
    assert abs(pulled(pull, 1.1).end.velocity[0]) < 1e-6
    sliding = pulled(pull, 0.3, speed=0.1)
    # Full of c_f: v = v_0 + (pull - c_f N) t.
    assert sliding.end.velocity[0] == pytest.approx(
        0.1 + (pull - DYNAMIC * PRESS) * 0.3, rel=1e-3
    )
    assert pulled(1.2 * STATIC * PRESS, 1.2).end.velocity[0] > 0.1


@pytest.mark.parametrize("speed", [2e-4, 1e-3, 3e-3])
def test_steady_sliding_follows_the_stribeck_curve(speed):
    """A pull of g(v) N holds a speed: it changes by second order only, in the beginning."""
    held = DYNAMIC + (STATIC - DYNAMIC) * math.exp(-((speed / STRIBECK) ** 2))
    run = pulled(held * PRESS, 2e-2, speed=speed)
    ratio = run.end.velocity[0] / STRIBECK
    now = DYNAMIC + (STATIC - DYNAMIC) * math.exp(-ratio * ratio)
    assert now == pytest.approx(borne_by_bristles(run), rel=0.2)


def borne_by_bristles(run: Run) -> float:
    """Friction over normal force at the end, sigma_0 z where the bristles hardly move."""
    contact = run.recorder.records.contacts[0]
    return abs(float(contact["tangential"])) / float(contact["normal"])


def test_bristles_do_not_oscillate_where_steps_are_long():
    """At 10 m/s they are bent after 1 us; a step of 1 ms ends at g / sigma_0."""
    slope = -10.0 * STIFF / DYNAMIC
    assert exponential_step(0.0, 10.0, slope, 1e-3) == pytest.approx(DYNAMIC / STIFF)


def greatest_push(
    coefficient: float, static: float, stribeck: float, damping: float
) -> float:
    """Return the greatest force along the sliding, N, of bristles bent by 0 to c_s / sigma_0."""
    law = Bristles(coefficient, static, stribeck, STIFF, damping)
    return max(
        bristle_force(1.0, speed, bristle, bristle_rate(speed, bristle, True, law), law)
        for speed in stribeck * np.linspace(0.01, 4.0, 200)
        for bristle in np.linspace(0.0, static / STIFF, 5)
    )


@given(
    coefficient=st.floats(1e-3, 0.8),
    ratio=st.floats(1.01, 20.0),
    stribeck=st.floats(1e-6, 1.0),
)
def test_allowed_damping_never_drives_the_sliding(coefficient, ratio, stribeck):
    """Bristles bent fully at low speed push forwards at a higher one if damped more than that."""
    static = ratio * coefficient
    limit = greatest_bristle_damping(coefficient, static, stribeck)
    assert greatest_push(coefficient, static, stribeck, 0.999 * limit) < 0.0
    assert greatest_push(coefficient, static, stribeck, 1.01 * limit) > 0.0


def test_without_a_fall_of_friction_every_damping_is_allowed():
    assert greatest_bristle_damping(0.1, 0.1, 1e-3) == math.inf
    assert greatest_bristle_damping(0.0, 0.0, 1e-3) == math.inf
    assert greatest_push(0.1, 0.1, 1e-3, 1e5) < 0.0


def test_damping_that_drives_the_sliding_is_refused_with_the_greatest():
    def bearing(damping: float) -> pw.Bearing:
        return pw.Bearing(
            friction_law="lugre",
            friction=0.1,
            static_friction=0.2,
            stribeck_speed=0.05,
            bristle_damping=damping,
        )

    assert bearing(10.0).bristle_damping == 10.0
    with pytest.raises(
        pw.InputError, match=r"^bristle_damping = 1000 s/m: "
    ) as refusal:
        bearing(1e3)
    allowed = float(str(refusal.value).split("up to ")[1].split()[0])
    assert allowed == pytest.approx(greatest_bristle_damping(0.1, 0.2, 0.05), rel=2e-3)
    bearing(allowed)
