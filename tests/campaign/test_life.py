"""Lives of made-up problems, whose law and noise are known."""

import math

import numpy as np
import pytest
from made_up import MadeUp

from presswear.campaign.service_life import (
    LifeEstimate,
    LifeProblem,
    Refinement,
    curve,
    estimate_life,
    next_refinement,
    run_refinements,
)
from presswear.scene.options import Limit, Service
from presswear.tools.errors import InputError

DEPTH = Limit("depth", "A", 5e-5)
DRIFT = Limit("bdc_drift", "", 2.5e-5)


def problem(
    *limits: Limit,
    services: tuple[Service, ...] = (),
    at_most: float = 1e12,
    tolerance: float = 0.1,
    max_cycles: int = 10_000,
) -> LifeProblem:
    """A problem with limits."""
    return LifeProblem(limits, services, at_most, tolerance, max_cycles)


def known(asked: LifeProblem, chains: MadeUp) -> tuple[LifeEstimate, tuple[Refinement, ...]]:
    """The life and the passes over it."""
    passes = run_refinements(asked, chains)
    return estimate_life(asked, passes), passes


def is_held(truth: float, found: LifeEstimate) -> bool:
    """True where the interval of a life holds the truth."""
    return abs(math.log(found.strokes / truth)) <= found.error


@pytest.mark.parametrize(
    ("limit", "noise"), [(DEPTH, 0.5), (DEPTH, 1.5), (DRIFT, 0.5)], ids=["depth", "wild", "drift"]
)
def test_intervals_hold(limit: Limit, noise: float) -> None:
    """Of 100 made-up problems at least 90 intervals hold the life."""
    held, errors = 0, []
    for seed in range(100):
        draw = np.random.default_rng(seed)
        own = MadeUp(
            seed,
            rate=10.0 ** draw.uniform(-13, -9),
            fresh=draw.uniform(0.0, 10.0),
            bedded=10.0 ** draw.uniform(-5.5, -4.5),
            noise=noise,
        )
        found, _ = known(problem(limit), own)
        held += is_held(own.life_until(5e-5), found)
        errors.append(found.error)
    assert held >= 90
    assert np.median(errors) < 0.1


def test_the_step_converges_and_is_told() -> None:
    """Without noise the error is that of the step, and no less is told."""
    own = MadeUp(1, noise=1e-9, fresh=30.0)
    truth = own.life_until(DEPTH.value)
    errors = []
    for tolerance in (0.1, 0.003):
        found, _ = known(problem(DEPTH, tolerance=tolerance), own)
        off = abs(math.log(found.strokes / truth))
        assert off <= found.error <= tolerance
        errors.append(off)
    assert errors[0] > 3.0 * errors[1] > 0.0


def test_the_first_of_several_limits_counts() -> None:
    later, sooner = Limit("depth", "A", 5e-5), Limit("bdc_drift", "", 1e-5)
    own = MadeUp(2, noise=0.1, scatter=1e-7)
    found, passes = known(problem(later, sooner), own)
    truth = own.life_until(2e-5)
    assert abs(math.log(found.strokes / truth)) <= found.error < 0.1
    # The other is told as well, where the wear was followed so far.
    each = [
        estimate_life(problem(later, sooner), passes, [limit]).strokes for limit in (later, sooner)
    ]
    assert each == [math.inf, found.strokes]


def test_steps_are_chosen_by_cycles_before() -> None:
    """By its own wear a cycle that wears little would stand for more strokes: a biased mean."""
    own = MadeUp(3, noise=2.0, fresh=0.0)
    found, _ = known(problem(DEPTH, tolerance=0.05, max_cycles=200_000), own)
    truth = own.life_until(DEPTH.value)
    assert abs(math.log(found.strokes / truth)) <= found.error < 0.06


def test_what_is_exceeded_when_new_is_refused() -> None:
    limit = Limit("bdc_drift", "", 1e-5)
    chains = MadeUp(4, scatter=1e-6)
    with pytest.raises(InputError, match=r"A\.depth > 5e-05 m.*when new.*A\.depth is 6e-05"):
        run_refinements(problem(DEPTH), MadeUp(5, rate=1e-15, begun=6e-5))
    # A drift is none when new, whatever scatters.
    assert math.isfinite(known(problem(limit), chains)[0].strokes)


def test_what_is_never_reached_is_no_life() -> None:
    own = MadeUp(6)
    asked = problem(DEPTH, at_most=0.5 * own.life_until(DEPTH.value))
    found, passes = known(asked, own)
    assert math.isinf(found.strokes)
    assert passes[-1].blocks[-1].strokes == pytest.approx(asked.at_most, rel=1e-12)
    assert len(passes) == 2
    reached = curve(passes[-1].blocks, "A.depth")[-1]
    assert 0.3 * DEPTH.value < reached < DEPTH.value


def test_a_bush_made_new_lives_longer() -> None:
    """It is seen to after just so many strokes, and wears from new again."""
    own = MadeUp(7, noise=0.1, fresh=0.0)
    at = 0.6 * own.life_until(DEPTH.value)
    service = Service("A", at, False)
    found, passes = known(problem(DEPTH, services=(service,)), own)
    assert found.strokes == pytest.approx(own.life_until(DEPTH.value) + at, rel=0.05)
    ends = [block.strokes for block in passes[-1].blocks if block.interval == 0]
    assert ends[-1] == pytest.approx(at, rel=1e-12)


def test_no_pass_has_more_cycles_than_may_be() -> None:
    own = MadeUp(8, noise=3.0)
    asked = problem(DEPTH, tolerance=0.001, max_cycles=1000)
    passes = run_refinements(asked, own)
    run = [8 * sum(block.cycles for block in one.blocks) for one in passes]
    assert max(run) <= 2 * asked.max_cycles
    assert next_refinement(asked, passes) is None
    assert estimate_life(asked, passes).error > asked.tolerance


def test_a_life_goes_on_from_any_block() -> None:
    """What has run decides alone what comes next."""
    asked = problem(DEPTH, tolerance=0.3)
    kept: list[tuple[Refinement, ...]] = []
    whole = run_refinements(asked, MadeUp(9), keep=kept.append)
    for passes in kept[:: len(kept) // 4]:
        chains = MadeUp(9)
        blocks = passes[-1].blocks
        chains.set(blocks[-1].levels["A.depth"])
        assert [own.blocks[-1].strokes for own in run_refinements(asked, chains, passes)] == [
            own.blocks[-1].strokes for own in whole
        ]
