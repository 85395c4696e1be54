"""Periods of motions whose period is known."""

import numpy as np

from presswear.analysis.periods import Periodicity, periodicity


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


def test_a_period_is_seen_twice_and_each_number_has_its_scale() -> None:
    """Seven states of period four have been seen once only."""
    states = np.tile(np.arange(4.0), 2)[:, None]
    assert periodicity(states[:7], np.ones(1)).period is None
    assert periodicity(states, np.ones(1)).period == 4
    states = np.array([[0.0, 0.0], [1e-6, 0.0]] * 4)
    assert periodicity(states, np.array([1e-6, 1.0])).period == 2
    assert periodicity(states, np.array([1.0, 1.0])).period == 1
