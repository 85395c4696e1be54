"""Growth of a disturbance, and statistics with step error and sampling error."""

import json
import math
from dataclasses import replace
from typing import TypeVar

import numpy as np
import pytest

from precision.made_up_precision import NAMES, SCENE, STAGE_CYCLES, chaos, parting
from presswear.campaign.replicates import start_of, turned_back
from presswear.recording.sampling import Estimate, MapBatches
from presswear.scene.numerics import Numerics
from presswear.tools.documents import plain
from presswear.validation.precision.chaos import stage_cycles
from presswear.validation.precision.growth import (
    HIGH,
    LOW,
    PARTED,
    sampled_run,
)
from presswear.validation.precision.methods import statistics_methods
from presswear.validation.precision.statistic import (
    Draws,
    StepError,
    honest_cycles,
    map_statistic,
    map_step_error,
    mean_step_error,
    sampling_error,
    together,
)
from presswear.validation.precision.study import Precision
from presswear.validation.stored import as_plain, restored

T = TypeVar("T")
TIME = np.linspace(0.0, 1.0, 2001)
NO_TOUCHES = np.zeros(2001)


def stored(owner: T) -> T:
    """As a file gives it back."""
    data = json.loads(json.dumps(plain(as_plain(owner)), allow_nan=False))
    found = restored(type(owner), data)
    assert isinstance(found, type(owner))
    return found


def test_growth_rate_of_an_exponential() -> None:
    apart = np.minimum(1e-9 * np.exp(30.0 * TIME), 1e-3)
    growth = parting(TIME, apart, np.floor(100.0 * TIME))
    assert growth.rate == pytest.approx(30.0, rel=1e-3)
    assert growth.per_touchdown == pytest.approx(0.3, rel=2e-2)
    assert growth.divergence == pytest.approx(math.log(1000.0) / 30.0, abs=1e-3)
    assert growth.touchdowns_to_divergence == math.floor(100.0 * math.log(1000.0) / 30.0)
    assert growth.window is not None
    assert growth.window[0] == pytest.approx(math.log(3.0) / 30.0, abs=1e-3)
    assert stored(growth) == growth


def test_rate_is_read_between_its_bounds_only() -> None:
    """A slow start and a plateau behind do not count."""
    grown = 1e-9 * np.exp(60.0 * (TIME - 0.4))
    apart = np.where(TIME < 0.4, 1e-9, np.minimum(grown, 1e-4))
    growth = parting(TIME, apart, NO_TOUCHES)
    assert growth.rate == pytest.approx(60.0, rel=1e-3)
    assert growth.per_touchdown is None
    assert growth.window is not None
    inside = (growth.window[0] <= TIME) & (growth.window[1] >= TIME)
    assert LOW <= apart[inside][0] < 1.2 * LOW
    assert HIGH <= apart[inside][-1] < 1.2 * HIGH


def test_starts_that_never_part_have_no_rate() -> None:
    growth = parting(TIME, np.full_like(TIME, 0.5 * PARTED), NO_TOUCHES)
    assert growth.rate is None
    assert growth.window is None
    assert growth.divergence is None
    assert growth.touchdowns_to_divergence is None
    assert stored(growth) == growth


def test_two_runs_of_one_start_stay_together() -> None:
    """Both are sampled at the same times: nothing but the starts can set them apart."""
    linkage, period = SCENE.linkage(), SCENE.mechanism.period
    runs = [sampled_run(linkage, start_of(SCENE), period, 1, lambda part: None) for _ in range(2)]
    places = [np.array(sampler.places) for _, sampler in runs]
    assert places[0].shape == (400, 2, 2)
    assert np.array_equal(places[0], places[1])
    run, sampler = runs[0]
    assert run.time == pytest.approx(period)
    assert sampler.touchdowns == sorted(sampler.touchdowns)
    assert sampler.touchdowns[-1] == int(run.recorder.book.tally["contacts"].sum())


def test_full_turns_are_taken_off_a_state() -> None:
    start = start_of(SCENE)
    position = start.position.copy()
    position[2] += 2.0 * math.pi
    position[5] -= 4.0 * math.pi + 0.1
    turned = turned_back(replace(start, position=position), start)
    assert turned.position[2] == pytest.approx(start.position[2])
    assert turned.position[5] == pytest.approx(start.position[5] - 0.1)
    assert np.array_equal(turned.position[:2], start.position[:2])


def test_difference_of_means() -> None:
    here, there = Estimate(1.1, 0.03, 50), Estimate(1.0, 0.04, 100)
    step = mean_step_error(here, there, 2.0)
    assert step.value == pytest.approx(0.1)
    assert step.low == pytest.approx(0.0)
    assert step.high == pytest.approx(0.2)
    # One-sided at 95 %: 1.645 standard errors, where the half width has 1.96.
    assert step.bound == pytest.approx(0.1 + 0.05 * 1.6449 / 1.9600, rel=1e-4)
    assert mean_step_error(replace(here, half_width=None), there, 2.0).bound is None


def test_intervals_of_several_statistics_hold_together() -> None:
    assert together(1) == pytest.approx(1.0)
    assert together(6) == pytest.approx(2.6383 / 1.9600, rel=1e-4)


def maps(seed: int, cycles: int, bump: float = 0.0) -> list[MapBatches]:
    """Runs whose map is a wave, and scatters in every bin and cycle by as much as it is high."""
    generator = np.random.default_rng(seed)
    angle = np.linspace(0.0, 2.0 * math.pi, 40, endpoint=False)
    mean = 1.0 + 0.5 * np.sin(angle) + bump * np.cos(3.0 * angle)
    batches = MapBatches((1, 2, 40))
    for _ in range(cycles):
        batches.add(mean + generator.standard_normal((1, 2, 40)))
    return [batches]


def test_maps_of_one_method_do_not_differ_but_by_chance() -> None:
    """Noise alone sets maps apart; it is taken off, and no bound is below it by chance."""
    steps = [map_step_error(maps(2 * k, 40), maps(2 * k + 1, 80), 0, 1.0) for k in range(40)]
    seen = sum(step.is_seen for step in steps)
    assert seen <= 4
    raw = math.sqrt(1.0 / 39.0 + 1.0 / 79.0)  # root mean square distance that noise makes
    assert np.median([step.value for step in steps]) < 0.6 * raw
    assert all(step.bound is not None and 0.0 < step.bound < 2.0 * raw for step in steps)


def test_a_different_map_is_seen_and_bounded() -> None:
    true = 0.5 / math.sqrt(2.0)
    steps = [
        map_step_error(maps(2 * k, 40, bump=0.5), maps(2 * k + 1, 80), 0, 1.0) for k in range(20)
    ]
    assert all(step.is_seen for step in steps)
    assert np.mean([step.value for step in steps]) == pytest.approx(true, rel=0.1)
    assert sum(step.bound is not None and step.bound >= true for step in steps) >= 17


def test_error_of_a_map_falls_with_the_root_of_cycles() -> None:
    few, many = (map_statistic(maps(1, count + 1), 0) for count in (25, 400))
    assert few.half_width is not None
    assert many.half_width is not None
    assert few.half_width / many.half_width == pytest.approx(4.0, rel=0.2)
    assert sampling_error(few, 400) == pytest.approx(many.half_width, rel=0.2)
    # 80 bins of unit noise.
    assert many.half_width == pytest.approx(1.96 / 20.0, rel=0.1)


def test_cycles_for_which_a_setting_is_honest() -> None:
    statistic = Estimate(1.0, 0.02, 100)
    assert honest_cycles(statistic, StepError(0.0, -0.03, 0.03, 0.04)) == pytest.approx(25.0)
    assert honest_cycles(statistic, StepError(0.0, 0.0, 0.0, 0.0)) == math.inf
    assert math.isnan(honest_cycles(statistic, StepError(0.0, None, None, None)))
    assert sampling_error(statistic, 25.0) == pytest.approx(0.04)


def test_cheapest_honest_setting() -> None:
    found = chaos(coarsest_honest=1e-6)
    best = found.cheapest()
    assert best is not None
    assert best.method.value == 1e-6
    honest = [point for point in found.points if found.is_honest(point)]
    assert best.cost == min(point.cost for point in honest)
    assert not any(point.method.value > 1.001e-6 for point in honest)
    assert not any(point.failure for point in honest)


def test_a_bound_above_the_sampling_error_is_not_honest() -> None:
    """However small the difference is: sampling error of 16 cycles is 0.05 here."""
    sampling = 0.02 * math.sqrt(100 / STAGE_CYCLES)
    assert chaos(bound=0.99 * sampling).cheapest() is not None
    assert chaos(bound=1.01 * sampling).cheapest() is None


def test_what_is_seen_decides_for_wear_and_peak_forces_do_not() -> None:
    found = chaos()
    good = found.cheapest()
    assert good is not None
    seen = {**good.step_errors, NAMES[0]: StepError(0.01, 0.005, 0.015, 0.015)}
    assert not found.is_honest(replace(good, step_errors=seen))
    far = {**good.step_errors, "peak force at A": StepError(0.5, 0.4, 0.6, 0.6)}
    assert found.is_honest(replace(good, step_errors=far))
    assert not found.is_honest_in(replace(good, step_errors=far), "peak force at A")


def test_cycles_of_a_stage_are_those_that_its_tolerance_takes() -> None:
    draws = Draws((), tuple(maps(3, 102)))
    error = map_statistic(draws.maps, 0)
    assert error.half_width is not None
    part = error.half_width / 1.96 / error.mean
    scene = replace(SCENE, tolerance=part / 2.0, max_cycles=1000)
    assert stage_cycles(scene, draws) == pytest.approx(400, abs=2)
    # Fewer than a stage runs at least, more than it runs at most, as many as somebody says.
    assert stage_cycles(replace(SCENE, tolerance=1.0), draws) == 16
    assert stage_cycles(replace(scene, max_cycles=200), draws) == 200
    assert stage_cycles(replace(scene, cycles=7, replicates=2), draws) == 14


def test_ladder_has_the_paper_and_the_defaults() -> None:
    methods = statistics_methods(SCENE)
    assert [method.value for method in methods if method.is_paper] == [1e-4]
    own, period = Numerics().resolved("wear", SCENE.tolerance), SCENE.mechanism.period
    defaults = [method.engine for method in methods if method.is_default]
    assert defaults == [own.tree.over(period), own.dae]
    assert [stored(method) for method in methods] == list(methods)


def test_measured_statistics(found: Precision) -> None:
    """Few cycles of two methods and the paper's, which fails and stays in."""
    measured = found.chaos
    quick, paper = measured.points
    assert paper.method.is_paper
    assert "no longer finite" in paper.failure
    assert not paper.statistics
    assert not measured.is_honest(paper)
    assert set(measured.names) == set(NAMES) == set(quick.statistics)
    for name in NAMES:
        statistic, reference = quick.statistics[name], measured.reference.statistics[name]
        assert statistic.cycles == 3
        assert statistic.mean == pytest.approx(reference.mean, rel=1.0)
        assert quick.step_errors[name].bound is not None
    assert quick.cost > 0.0
    assert quick.simulated == pytest.approx(5 * SCENE.mechanism.period)
    growth = measured.growth
    assert growth.divergence == pytest.approx(0.14, abs=0.03)
    assert growth.rate is not None
    assert 40.0 < growth.rate < 150.0
