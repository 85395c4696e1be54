"""Periods of motions whose period is known."""

from dataclasses import replace

import numpy as np
import pytest
from bouncing_table import FREQUENCY, GRAVITY, PERIOD, BouncingTable

import presswear as pw
from presswear.analysis.periods import Periodicity, periodicity


def seen(ball: BouncingTable, cycles: int) -> Periodicity:
    """The period of a ball, after so many cycles from beside the periodic one."""
    state, t = ball.period_one(0.3 * PERIOD)
    state = state + np.array([1e-4, 1e-3])
    rows = np.zeros((cycles, 2))
    for k in range(cycles):
        state = ball.after(state, t, PERIOD)
        t += PERIOD
        rows[k] = state
    height = np.pi**2 * GRAVITY / FREQUENCY**2
    return periodicity(rows[-40:], np.array([height, height * FREQUENCY]), 1e-4)


@pytest.mark.parametrize("restitution", [0.5, 0.8])
def test_the_ball_doubles_its_period_where_it_must(restitution: float) -> None:
    ball = BouncingTable(restitution)
    assert seen(replace(ball, drive=0.99 * ball.doubling), 1500).period == 1
    assert seen(replace(ball, drive=1.01 * ball.doubling), 1500).period == 2


def test_the_logistic_map_repeats_itself_after_four_and_never() -> None:
    def orbit(r: float) -> Periodicity:
        x, rows = 0.3, []
        for _ in range(1200):
            x = r * x * (1.0 - x)
            rows.append([x])
        return periodicity(np.array(rows[-200:]), np.ones(1), 1e-6)

    # May, Nature 261 (1976) 459: period 4 from 1 + sqrt(6) to 3.5441, period 3 from 1 + sqrt(8).
    assert [orbit(r).period for r in (2.9, 3.2, 3.5, 3.835, 4.0)] == [1, 2, 4, 3, None]
    assert str(orbit(3.5)) == "period 4 within 0.0001 % in 200 cycles"
    assert str(orbit(4.0)) == "no period within 0.0001 % in 200 cycles"
    assert orbit(4.0).error > 1e-6


def test_a_period_is_seen_twice() -> None:
    """Seven states of period four have been seen once only."""
    states = np.tile(np.arange(4.0), 2)[:, None]
    assert periodicity(states[:7], np.ones(1)).period is None
    assert periodicity(states, np.ones(1)).period == 4


def test_each_number_has_its_scale() -> None:
    states = np.array([[0.0, 0.0], [1e-6, 0.0]] * 4)
    assert periodicity(states, np.array([1e-6, 1.0])).period == 2
    assert periodicity(states, np.array([1.0, 1.0])).period == 1
    with pytest.raises(pw.InputError, match="scales"):
        periodicity(states, np.zeros(2))
