"""Surrogates of known functions and the distributions that they give."""

import math
import sys

import numpy as np
import pytest
from made_up_sweep import table_of
from numpy.typing import NDArray
from scipy import stats

from presswear.sweeps.parameters import Distribution, design, parse_distribution
from presswear.sweeps.responses import Limit
from presswear.sweeps.sensitivity import Points, points_of, sensitivity
from presswear.sweeps.surrogate import fit
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity

OTHERS = np.random.default_rng(5).random((500, 3))
NORMAL = parse_distribution("normal(0, 1)", "x", Quantity("", -math.inf, math.inf, "", ""))
# A life of 100 exp(0.5 x + 0.3 y + 0.25 e), all normal, is lognormal.
LIFE = stats.lognorm(math.hypot(0.5, 0.3, 0.25), scale=100.0)


def curved(points: Array) -> Array:
    return np.asarray(10.0 * np.exp(2.0 * points[:, 0] + np.sin(3.0 * points[:, 1])))


def sampled(size: int, noise: float = 0.0, censored: NDArray[np.bool_] | None = None) -> Points:
    points = design("sobol", size, 3, seed=1)
    table = table_of(points, curved(points), noise=noise, censored=censored)
    return points_of(table, "y")


def test_a_smooth_function_is_predicted() -> None:
    surrogate = fit(sampled(64))
    assert surrogate.predict(OTHERS)[0] == pytest.approx(curved(OTHERS), rel=0.05)
    assert surrogate.explained > 0.99


def test_noise_is_the_deviation_of_a_single_run() -> None:
    points = design("sobol", 256, 3, seed=1)
    surrogate = fit(points_of(table_of(points, curved(points) - 200.0, noise=6.0), "y"))
    assert not surrogate.is_logarithmic
    assert surrogate.predict(OTHERS)[1].mean() == pytest.approx(6.0, rel=0.2)


def test_a_distribution_has_the_quantiles_of_single_runs() -> None:
    hits = np.zeros(3)
    for seed in range(1, 9):
        points = NORMAL.ppf(design("sobol", 64, 2, seed))
        chaos = 0.25 * np.random.default_rng(seed).standard_normal(64)
        life = 100.0 * np.exp(0.5 * points[:, 0] + 0.3 * points[:, 1] + chaos)
        surrogate = fit(points_of(table_of(points, life), "y"))
        spread = surrogate.spread([NORMAL, NORMAL], Limit(40.0, True))
        truth = LIFE.ppf((0.05, 0.5, 0.95))
        places = [4, 49, 94]
        assert spread.values[places] == pytest.approx(truth, rel=0.25)
        hits += (spread.low[places] <= truth) & (truth <= spread.high[places])
        assert spread.violation is not None
        assert spread.violation[0] == pytest.approx(LIFE.cdf(40.0), abs=0.05)
    assert hits.min() >= 5


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (sampled(8), "8 points have a value; it needs 15 to 1000"),
        (sampled(64, censored=np.arange(64) == 3), "some of its values are lower bounds"),
        (sampled(64, noise=1e4), "in cross-validation it explains"),
        (points_of(table_of(OTHERS, np.ones(500)), "y"), "the same value at all points"),
    ],
)
def test_unsuitable_points_are_refused(points: Points, message: str) -> None:
    with pytest.raises(InputError, match=message):
        fit(points)


def test_a_distribution_beyond_the_points_is_reported() -> None:
    surrogate = fit(sampled(64))
    unit = Distribution("uniform", stats.uniform(0.0, 1.0))
    wide = Distribution("uniform", stats.uniform(-1.0, 3.0))
    assert surrogate.outside([unit, unit, unit]) == ""
    assert "of the values of x2 lie outside the points" in surrogate.outside([unit, wide, unit])


@pytest.mark.parametrize("package", ["sklearn", "SALib"])
def test_a_missing_package_is_named(package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=r"pip install 'presswear\[sweep\]'"):
        (fit(sampled(64)) if package == "sklearn" else sensitivity(sampled(64), "sobol"))
