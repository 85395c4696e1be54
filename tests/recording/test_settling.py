"""Repeating, irregular and mixed motions, and the half-life of an irregular transient."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math

import numpy as np
import pytest

from presswear.recording.settling import (
    REPEATED,
    group_motions,
    half_life,
    settled_motion,
    signatures,
)
from presswear.recording.statistics import STARTUP_CYCLES


def logistic(rate: float, count: int, first: float = 0.3) -> np.ndarray:
    """Return signatures of an orbit of the logistic map, as positions of one pin.

    The force of the pin is constant.
    """
    orbit = np.empty(count)
    orbit[0] = first
    for n in range(1, count):
        orbit[n] = rate * orbit[n - 1] * (1.0 - orbit[n - 1])
    places = np.zeros((count, 1, 2))
    places[:, 0, 0] = orbit
    return signatures(places, np.ones((count, 1)))


@pytest.mark.parametrize(("rate", "period"), [(2.8, 1), (3.2, 2), (3.5, 4)])
def test_periods_of_the_logistic_map(rate, period):
    """The periods of the map are in every textbook (May, Nature 261, 459, 1976)."""
    motion = settled_motion(logistic(rate, 60))
    orbit = logistic(rate, 400)
    assert np.abs(orbit[-1] - orbit[-1 - period]).max() < 1e-9
    assert period % motion.period == 0
    assert motion.start < 10


def test_the_chaotic_logistic_map_rarely_seems_to_settle():
    orbit = logistic(4.0, 3000)
    settled = [settled_motion(orbit[:count]) is not None for count in range(20, 3000)]
    # The orbit stays for some steps near the unstable fixed points at 0 and 3/4.
    assert np.mean(settled) < 0.05


def test_a_motion_settles_at_the_end_of_transient_chaos():
    orbit = np.concatenate([logistic(4.0, 37), logistic(2.8, 30, 0.6)])
    motion = settled_motion(orbit)
    assert abs(motion.start - 37) <= 2


def test_fewer_cycles_than_must_repeat_are_not_settled():
    assert settled_motion(logistic(2.8, REPEATED - 1, 0.64)) is None
    assert settled_motion(logistic(2.8, REPEATED, 0.64)) is not None


def test_forces_that_differ_by_a_factor_do_not_repeat():
    forces = np.where(np.arange(40) % 7 == 0, 3000.0, 300.0)[:, np.newaxis]
    assert settled_motion(signatures(np.zeros((40, 1, 2)), forces)) is None


def test_small_forces_do_not_count():
    forces = np.full((40, 2), 1000.0)
    forces[:, 1] = np.where(np.arange(40) % 7 == 0, 1e-3, 1e-6)
    assert settled_motion(signatures(np.zeros((40, 2, 2)), forces)) is not None


def test_motions_with_equal_means_are_one_group():
    motions = [settled_motion(logistic(rate, 60)) for rate in (2.8, 3.2, 2.81, 1.2)]
    assert all(motions)
    assert group_motions([motion for motion in motions if motion]) == [[0, 1, 2], [3]]


def test_half_life_is_the_mean_time_times_the_logarithm_of_two():
    estimate = half_life([12, 32, 1], [20 + 2 + REPEATED])
    assert estimate.mean == pytest.approx(30.0 * math.log(2.0))
    assert estimate.low < estimate.mean < estimate.high


def test_intervals_of_half_lives_contain_the_true_value_in_92_of_100_trials():
    """Durations of the irregular motion are drawn from an exponential distribution."""
    generator = np.random.default_rng(3)
    limit = 64  # largest duration that is observed, cycles
    truth = 39.0  # cycles
    count = 0
    trials = 400
    for _ in range(trials):
        times = generator.exponential(truth / math.log(2.0), 4)
        ended = [int(time) for time in times if time < limit]
        starts = [STARTUP_CYCLES + time for time in ended if time > 0]
        irregular = [limit + STARTUP_CYCLES + REPEATED] * (4 - len(ended))
        estimate = half_life(starts, irregular)
        if estimate is None:
            count += 1  # No interval is wrong without an estimate.
            continue
        assert estimate.high is not None
        count += estimate.low <= truth <= estimate.high
    assert 0.92 * trials < count
