"""Rows put together by points."""

import numpy as np
import pytest
from made_up_sweep import swept

from presswear.recording.statistics import Estimate, quantile
from presswear.sweeps.responses import responses
from presswear.sweeps.table import Table
from presswear.tools.errors import InputError

POINTS = np.array([[3.0, 1.0], [1.0, 2.0], [2.0, 0.5]])


def table(values: list[float], draws: int) -> Table:
    found = swept(POINTS, np.zeros(3), draws=draws)
    found.values[:, 0] = values
    return found


def test_draws_are_put_together_in_the_order_of_their_points() -> None:
    own = responses(table([5.0, 7.0, 1.0, np.nan, 2.0, 6.0], draws=2), "y")
    assert np.array_equal(own.points, POINTS)
    assert own.means.tolist() == [6.0, 1.0, 4.0]
    assert own.counts.tolist() == [2.0, 1.0, 2.0]
    assert own.variances.tolist() == [2.0, 5.0, 8.0]  # of one draw: the mean of the others
    assert own.noise.tolist() == [1.0, 5.0, 4.0]
    assert own.noise_source == "draws"
    assert own.freedoms.tolist() == [1.0, 2.0, 1.0]  # of one draw: those of all others


def test_a_point_without_a_value_is_none() -> None:
    own = responses(table([5.0, np.nan, 3.0], draws=1), "y")
    assert own.has_value.tolist() == [True, False, True]
    assert own.noise_source == "nothing"
    assert own.only(own.has_value).points.tolist() == [[3.0, 1.0], [2.0, 0.5]]


def test_intervals_of_runs_tell_the_noise_of_single_draws() -> None:
    half = quantile(np.inf) * np.array([1.0, 2.0, 3.0])
    own = responses(swept(POINTS, np.zeros(3), halves=half), "y")
    assert own.noise == pytest.approx([1.0, 4.0, 9.0], rel=1e-12)
    assert own.noise_source == "intervals"
    assert responses(swept(POINTS, np.zeros(3), halves=half, draws=2), "y").noise_source == "draws"


def test_a_draw_that_is_there_twice_is_one() -> None:
    again = np.vstack([POINTS, POINTS[:1]])
    own = responses(swept(again, np.array([5.0, 1.0, 3.0, 5.0])), "y")
    assert own.counts.tolist() == [1.0, 1.0, 1.0]
    assert own.noise_source == "nothing"
    assert own.path.tolist() == [0, 1, 2, 0]


def test_one_lower_bound_makes_the_mean_one() -> None:
    found = swept(POINTS, np.zeros(3), draws=2)
    found.is_beyond[3, 0] = True
    assert responses(found, "y").is_beyond.tolist() == [False, True, False]


def test_an_unknown_measure_is_refused() -> None:
    with pytest.raises(InputError, match="unknown measure 'yy'; did you mean y"):
        responses(swept(POINTS, np.zeros(3)), "yy")


def test_means_and_differences_hold_where_points_scatter_unequally() -> None:
    scatter = np.array([10.0, 0.1, 1.0])
    held = []
    for seed in range(300):
        found = swept(POINTS, np.zeros(3), draws=3, noise=1.0, seed=seed)
        found.values[:, 0] *= np.repeat(scatter, 3)
        own = responses(found, "y")
        apart = own.difference(0, 1)
        assert apart.low is not None
        assert apart.high is not None
        held.append([*(np.abs(own.means) <= own.half_widths), apart.low <= 0.0 <= apart.high])
    assert np.mean(held, axis=0) == pytest.approx(0.95, abs=0.04)


def test_nothing_is_told_of_single_draws() -> None:
    own = responses(swept(POINTS, np.arange(3.0)), "y")
    assert np.isnan(own.half_widths).all()
    assert own.difference(2, 0) == Estimate(2.0, None, None)
