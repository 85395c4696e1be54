"""Estimates of a service life where wear law and noise are known."""
# mypy: disable-error-code="union-attr,operator"

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from refusals import refused
from scipy import stats

import presswear as pw
from campaign.known_wear import (
    CLEARANCE,
    DEPTH,
    DRIFT,
    KnownWear,
    evenly_worn,
    life_of,
    load_block,
    problem,
)
from presswear.campaign.cycles_of_life import (
    MIN_TIMED_BLOCKS,
    cycles_left,
    fewest_cycles,
    time_per_cycle,
)
from presswear.campaign.life_estimate import estimate_life
from presswear.campaign.life_result import life_result
from presswear.campaign.refinement import LoadBlock, Refinement, Refinements
from presswear.campaign.service_life import (
    next_block,
    next_refinement,
    run_refinements,
)
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.scene.options import Limit, Service
from presswear.scene.settings import changed


def test_the_step_after_a_service_is_that_of_the_new_bushing():
    """Blocks before the service neither change its length nor its correction."""
    levels = {"A.depth": np.full(8, 1e-6)}
    rows = (2.0, 2, 1e-12), (1e5, 8, 5e-12), (2e5, 8, 2e-12)
    old = [load_block(strokes, cycles, levels, rate) for strokes, cycles, rate in rows]
    service = replace(old[-1], cycles=0, interval=1, rate=0.0)
    blocks = (*old, service, load_block(2e5 + 2.0, 2, levels, 4e-11, interval=1))
    refinement = Refinement(1e-3, 8, blocks)
    plan = next_block(problem(DEPTH, services=(Service("A", 2e5, False),)), refinement)
    assert (plan.cycles, plan.extra) == (8, 0.0)
    assert plan.share == pytest.approx(1e-3 / 4e-8)


@pytest.mark.parametrize("before", [4, 6])
def test_correction_of_a_block_is_that_of_the_trapezoidal_rule(before):
    """Of a rate that rises linearly with the strokes, the sum of a block lacks a known part."""
    rate = 1e-12
    slope = 3e-18
    stood_for = 1e4
    cycles = 4

    def block(strokes: float, cycles: int, stood_for: float) -> LoadBlock:
        """Return a block in which each cycle wears at the rate of the strokes before it."""
        starts = strokes - stood_for * np.arange(1, cycles + 1)
        mean = rate + slope * float(starts.mean())
        return load_block(strokes, cycles, {"A.depth": np.zeros(8)}, mean)

    ends = 2.0, 2.0 + before * stood_for, 2.0 + (before + cycles) * stood_for
    counts = 2, before, cycles
    blocks = tuple(map(block, ends, counts, (1.0, stood_for, stood_for)))
    plan = next_block(problem(DEPTH), Refinement(1e-3, 5, blocks))
    # The integral over each cycle less the rate at its start.
    lacking = cycles * 0.5 * slope * stood_for**2
    assert plan.extra * plan.cycles == pytest.approx(
        np.full((1, 1, 1), lacking), rel=1e-9
    )


def test_samples_are_those_of_the_surfaces_before_each_cycle():
    """A quantity that is proportional to the depth is fitted exactly at the ends of blocks."""
    wear = 1e-11
    stood_for = 1e4
    blocks = []
    strokes = 0.0
    for k, cycles in enumerate((2, 4, 5, 3, 6, 4, 4)):
        each = stood_for if k else 0.0
        starts = strokes + each * np.arange(cycles)
        strokes = float(starts[-1]) + each
        means = 1.0 + 1e4 * wear * starts.mean() + np.array([-1e-6, 1e-6])
        samples = {"A.force_max": means}
        blocks.append(
            load_block(strokes, cycles, {"A.depth": np.zeros(2)}, wear, samples=samples)
        )
    refinement = Refinement(blocks=tuple(blocks))
    expected = 1.0 + 1e4 * wear * refinement.strokes
    assert refinement.curve("A.force_max") == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("limit", "noise", "lives"),
    [(DEPTH, 0.5, 30), (DEPTH, 1.5, 30), (DRIFT, 0.5, 10), (DEPTH, 1e-9, 10)],
    ids=["depth", "wild", "drift", "exact"],
)
def test_intervals_cover_the_life(limit, noise, lives):
    """At least nine of ten intervals hold the exact life."""
    covered = 0
    errors = []
    for seed in range(lives):
        draw = np.random.default_rng(seed)
        rate = 10.0 ** draw.uniform(-13, -9)
        fresh = draw.uniform(0.0, 10.0)
        wear = KnownWear(seed, rate, fresh, 10.0 ** draw.uniform(-5.5, -4.5), noise)
        life, _ = life_of(problem(limit), wear)
        covered += abs(math.log(life.strokes / wear.life_until(5e-5))) <= life.error
        errors.append(life.error)
    assert covered >= 0.9 * lives
    assert np.median(errors) < 0.1


def test_a_life_is_the_mean_of_its_refinements():
    """Weights are the cycles; independent errors add as squares, with Welch's freedom."""
    life, refinements = life_of(problem(DEPTH), KnownWear(3, noise=1.5, fresh=0.0))
    ends = [each.crossing([DEPTH]) for each in refinements]
    pairs = zip(refinements, ends, strict=True)
    weights = np.array([each.cycles_until(end) for each, end in pairs])
    weights /= weights.sum()
    assert life.strokes == pytest.approx(np.prod(ends**weights), rel=1e-12)
    halves = np.array([each.sampling_error([DEPTH]) for each in refinements])
    errors = weights * halves / stats.t.ppf(0.975, 7)
    freedom = 7.0 * (errors**2).sum() ** 2 / (errors**4).sum()
    expected = stats.t.ppf(0.975, freedom) * math.hypot(*errors)
    assert life.sampling == pytest.approx(expected, rel=1e-9)
    assert life.sampling < halves[-1]


def test_first_of_several_limits_ends_the_life():
    later = DEPTH
    sooner = Limit("bdc_drift", "", 1e-5)
    wear = KnownWear(2, noise=0.1, scatter=1e-7)
    life, refinements = life_of(problem(later, sooner), wear)
    assert abs(math.log(life.strokes / wear.life_until(2e-5))) <= life.error < 0.1
    each = [estimate_life(refinements, [limit]).strokes for limit in (later, sooner)]
    assert each == [math.inf, life.strokes]


def test_limit_exceeded_when_new_is_refused():
    with refused(r"A\.depth > 5e-05 m.*when new.*A\.depth is 6e-05"):
        run_refinements(problem(DEPTH), KnownWear(5, rate=1e-15, initial=6e-5))
    # A drift is zero when new, whatever scatters.
    drift = Limit("bdc_drift", "", 1e-5)
    assert math.isfinite(life_of(problem(drift), KnownWear(4, scatter=1e-6))[0].strokes)


def test_cycles_are_limited():
    limited = problem(DEPTH, tolerance=0.001, max_cycles=1000)
    life, refinements = life_of(limited, KnownWear(8, noise=3.0))
    assert max(each.cycles for each in refinements) <= 2 * limited.max_cycles
    assert next_refinement(limited, refinements) is None
    assert life.error > limited.tolerance


def ran(refinements: Refinements) -> int:
    """Return the cycles of each history, with two of a start-up in each refinement."""
    return sum(2 + sum(block.cycles for block in each.blocks) for each in refinements)


@pytest.mark.parametrize("limit", [DEPTH, DRIFT], ids=["depth", "drift"])
def test_a_life_takes_at_least_the_cycles_stated_before(limit):
    """A cycle of the first refinement wears half a percent of the clearance, on average."""
    fewest = fewest_cycles(problem(limit), {"A": CLEARANCE})
    expected = 8.0 + 10.0 + 40.0 if limit is DEPTH else 8.0 + 2.0 + 16.0
    assert fewest == pytest.approx(expected)
    whole = [
        ran(run_refinements(problem(limit, tolerance=1.0), KnownWear(seed)))
        for seed in range(20)
    ]
    assert fewest <= min(whole) <= 3.5 * fewest


def test_first_limit_is_as_accurate_as_the_life():
    """The coarser refinement ended with another limit, before it came to this one."""
    settings = {
        "life": "limits",
        "life.until": "depth > 0.05 mm",
        "conventions": "refined",
    }
    scene = changed(pw.scenes.wear_times(), settings)
    coarse = evenly_worn(10, 1.04e6, A=5e-11, C=4.5e-11)
    both = coarse, evenly_worn(40, 1.04e6, A=4.7e-11, C=4.9e-11)
    limits = (Limit("depth", joint, 0.05e-3) for joint in "AC")
    life = life_result(scene, problem(*limits), both)
    first = life.first
    assert (first.key, life.limits[0].step) == ("C.depth", None)
    assert (first.strokes, first.sampling, first.step) == (
        life.strokes,
        life.sampling,
        life.step,
    )


def test_interval_with_the_wear_coefficients_is_one_of_95_percent():
    """A lognormal coefficient with a standard deviation of half of its mean."""
    settings = {
        "life": "limits",
        "life.until": "A.depth > 0.05 mm",
        "conventions": "refined",
    }
    scene = changed(pw.scenes.wear_times(), settings)
    assert [scene.bearing(name).materials.wear_scatter for name in ("A", "C")] == [
        0.5,
        0.5,
    ]
    life = life_result(scene, problem(DEPTH), [evenly_worn(10, 2e6, A=5e-11, C=1e-11)])
    low, high = stats.lognorm.ppf((0.025, 0.975), math.sqrt(math.log(1.0 + 0.5**2)))
    assert math.exp(life.scatter) == pytest.approx(math.sqrt(high / low), rel=1e-12)


class TimedWear(KnownWear):
    """Histories whose cycles take 1 s on new surfaces, and ``worn`` s at the limit."""

    worn = 1.0
    clock = 0.0

    def __call__(self, refinements: Refinements, plan: Any) -> LoadBlock:
        block = super().__call__(refinements, plan)
        depth = float(block.levels["A.depth"].mean())
        start_up = 0 if refinements[-1].blocks else STARTUP_CYCLES
        cycles = block.cycles + start_up
        seconds = cycles * (1.0 + (self.worn - 1.0) * depth / DEPTH.value)
        self.clock += seconds
        return replace(block, wall_s=seconds)


@pytest.mark.parametrize(("worn", "factor"), [(1.0, 1.5), (2.0, 1.25), (4.0, 1.5)])
def test_time_of_a_life_whose_cycles_get_slower(worn, factor):
    """The first moment is the announcement, with an expected number of cycles."""
    life = problem(DEPTH)
    for seed in range(4):
        wear = TimedWear(seed, noise=0.3, fresh=0.0)
        wear.worn = worn
        moments: list[tuple[float, ...]] = []

        def keep(
            done: Refinements,
            wear: TimedWear = wear,
            moments: list[tuple[float, ...]] = moments,
        ) -> None:
            if len(done) > 1 or len(done[0].blocks) >= MIN_TIMED_BLOCKS:
                left = cycles_left(life, done)
                each = time_per_cycle(life, done)
                moments.append((wear.clock, ran(done), left, each))

        refinements = run_refinements(life, wear, keep=keep)
        clock, _, left, each = moments[0]
        assert 1.0 / factor < left * each / (wear.clock - clock) < factor
        for clock, cycles, _, each in moments[:-1]:
            seconds = each * (ran(refinements) - cycles)
            assert 0.5 < seconds / (wear.clock - clock) < 2.0
