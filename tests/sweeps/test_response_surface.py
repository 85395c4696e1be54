"""Response surfaces of known functions, and how well they say what they know."""

import numpy as np
import pytest
from made_up_sweep import ISHIGAMI_VARIANCE, ishigami, swept
from numpy.typing import NDArray

from presswear.sweeps.designs import design
from presswear.sweeps.inputs import Inputs
from presswear.sweeps.responses import Responses, responses
from presswear.sweeps.surface import LEAST_A_FACTOR, Process, fitted, noise_share, surface
from presswear.sweeps.table import Column
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

OTHERS = np.random.default_rng(5).random((500, 3))


def bent(points: Array) -> Array:
    return np.asarray(10.0 * np.exp(2.0 * points[:, 0] + np.sin(3.0 * points[:, 1])))


def over(
    size: int,
    draws: int = 1,
    noise: float = 0.0,
    is_beyond: NDArray[np.bool_] | None = None,
    cut: float = np.inf,
) -> Responses:
    points = design("sobol", size, 3, seed=1)
    values = np.minimum(bent(points), cut)
    return responses(swept(points, values, draws=draws, noise=noise, is_beyond=is_beyond), "y")


def test_a_smooth_function_is_found() -> None:
    found = surface(over(64))
    assert found.level(OTHERS) == pytest.approx(bent(OTHERS), rel=0.05)
    assert found.left_out.explained > 0.99


def test_what_is_left_out_is_what_other_points_predict() -> None:
    own = over(64, noise=2.0)
    found = fitted(own, "linear")
    process = found.process
    for k in (0, 17, 63):
        others = np.arange(64) != k
        rest = Process(
            process.kernel,
            process.coordinates[others],
            process.values[others],
            process.noise[others],
        )
        mean, covariance = rest.at(process.coordinates[k : k + 1])
        assert found.left_out.means[k] == pytest.approx(mean[0], rel=1e-9)
        variance = covariance[0, 0] + process.noise[k]
        assert found.left_out.deviations[k] ** 2 == pytest.approx(variance, rel=1e-9, abs=0)
    off = process.values - found.left_out.means
    base = [v - np.delete(process.values, k).mean() for k, v in enumerate(process.values)]
    assert found.left_out.explained == pytest.approx(1.0 - (off @ off) / np.dot(base, base))


def test_the_scale_on_which_chaos_is_even_is_taken() -> None:
    points = design("sobol", 128, 3, seed=1)
    random = np.random.default_rng(3).standard_normal(128)
    even = swept(points, 100.0 + bent(points) + 3.0 * random)
    growing = swept(points, bent(points) * np.exp(0.1 * random))
    assert surface(responses(even, "y")).scale == "linear"
    assert surface(responses(growing, "y")).scale == "logarithmic"


def test_the_nugget_is_the_variance_of_one_run() -> None:
    points = design("sobol", 256, 3, seed=1)
    for draws in (1, 4):
        own = responses(swept(points, bent(points) - 200.0, draws=draws, noise=6.0), "y")
        found = surface(own)
        assert found.chaos == pytest.approx(6.0, rel=0.15)


def test_its_bands_hold_the_function_that_it_does_not_know() -> None:
    truth = bent(OTHERS) - 200.0
    points = design("sobol", 64, 3, seed=1)
    held = []
    for seed in range(12):
        noisy = swept(points, bent(points) - 200.0, noise=10.0, seed=seed)
        mean, deviation = surface(responses(noisy, "y")).predicted(OTHERS)
        held.append(np.mean(np.abs(truth - mean) < 1.96 * deviation))
    assert 0.85 < np.mean(held) <= 1.0


def test_draws_scatter_as_the_bands_say() -> None:
    found = surface(over(32, noise=5.0))
    few = OTHERS[:40]
    mean, deviation = found.predicted(few)
    drawn = found.draws(few, 4000, np.random.default_rng(1))
    assert drawn.mean(axis=0) == pytest.approx(mean, abs=5.0 * deviation.max() / np.sqrt(4000))
    assert drawn.std(axis=0) == pytest.approx(deviation, rel=0.06, abs=1e-6)


def test_lower_bounds_are_lifted_and_not_taken_for_values() -> None:
    points = design("sobol", 128, 3, seed=1)
    cut = float(np.quantile(bent(points), 0.8))
    above = bent(OTHERS) > cut
    ignored, lifted = (
        np.mean(
            np.log(surface(over(128, is_beyond=flags, cut=cut)).level(OTHERS) / bent(OTHERS))[above]
        )
        for flags in (None, bent(points) > cut)
    )
    assert ignored < -0.2
    assert abs(lifted) < 0.05


def test_noise_is_refused_with_its_reason() -> None:
    points = design("sobol", 64, 3, seed=1)
    random = np.random.default_rng(1).standard_normal(64)
    with pytest.raises(
        InputError, match=r"explain \d+ % of its variance, of which chaos leaves 100 %"
    ):
        surface(responses(swept(points, random), "y"))


def test_chaos_that_draws_tell_is_no_fault_of_the_surface() -> None:
    points = design("sobol", 256, 3, seed=1)
    plane = points.sum(axis=1)
    own = responses(swept(points, plane, draws=2, noise=1.2), "y")
    found = surface(own)
    assert found.left_out.explained < 0.45
    share = 1.2**2 / 2.0 / (1.2**2 / 2.0 + 0.25)
    assert noise_share(found) == pytest.approx(share, abs=0.08)


@pytest.mark.parametrize(
    ("own", "told"),
    [
        (over(8), f"8 points have a value, {3 * LEAST_A_FACTOR} at least"),
        (over(64, is_beyond=np.ones(64, np.bool_)), "64 of 64 points are lower bounds only"),
        (over(64, cut=0.0), "the same at every point"),
    ],
)
def test_what_has_no_surface_says_why(own: Responses, told: str) -> None:
    with pytest.raises(InputError, match=told):
        surface(own)


def test_coordinates_are_of_one_length() -> None:
    factors = (
        Column("clearance", "m", ""),
        Column("wear_coefficient", "1/Pa", ""),
        Column("engine", "", "", ("dae", "exudyn", "none")),
    )
    points = np.array([[1e-4, 1e-16, 0.0], [2e-4, 1e-14, 2.0], [3e-4, 1e-15, 1.0]])
    found = Inputs.of(factors, points).at(points)
    assert found == pytest.approx(
        np.array([[0, 0, 1, 0, 0], [0.5, 1, 0, 0, 1], [1, 0.5, 0, 1, 0]]), abs=1e-9
    )


def test_words_have_a_surface_of_their_own() -> None:
    random = np.random.default_rng(1)
    points = np.column_stack([random.random(90), random.integers(3, size=90)])
    heights = np.array([5.0, -3.0, 1.0])
    table = swept(points, np.sin(3.0 * points[:, 0]) + heights[points[:, 1].astype(int)])
    worded = Column("law", "", "", ("a", "b", "c"))
    own = responses(table, "y")
    own = Responses(**{**vars(own), "factors": (own.factors[0], worded)})
    found = surface(own)
    assert found.level(np.array([[0.5, k] for k in range(3)])) == pytest.approx(
        np.sin(1.5) + heights, abs=0.05
    )


@pytest.mark.slow
def test_ishigami_is_found() -> None:
    points = design("sobol", 256, 3, seed=1)
    found = surface(responses(swept(points, ishigami(points)), "y"))
    off = found.level(OTHERS) - ishigami(OTHERS)
    assert np.mean(off**2) < 0.05 * ISHIGAMI_VARIANCE
