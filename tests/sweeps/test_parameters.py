"""Parameters from texts and Python values, distributions and designs."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import presswear as pw
from presswear.sweeps.parameters import design, parse_distribution, parse_group, texts_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity

SCENE = pw.scenes.wear_times()
LENGTH = Quantity("m", 0.0, 1.0, "", "")
PURE = Quantity("", 0.0, 1.0, "", "", open_low=True)
PRESSURE = Quantity("1/Pa", 0.0, math.inf, "", "")
U = np.linspace(0.01, 0.99, 99)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("clearance=0.2mm:1.0mm:5", [[2e-4], [4e-4], [6e-4], [8e-4], [1e-3]]),
        ("wear_coefficient=1e-16/Pa:1e-14/Pa:3:log", [[1e-16], [1e-15], [1e-14]]),
        ("engine=dae,exudyn", [[0.0], [1.0]]),
        ("A.friction=0.1,0.2 & C.friction=0.1,0.3", [[0.1, 0.1], [0.2, 0.3]]),
    ],
)
def test_text_gives_values(text: str, values: list[list[float]]) -> None:
    assert parse_group(SCENE, text).values.tolist() == values


def test_python_values_equal_texts() -> None:
    vary = {
        "clearance": np.array([1e-4, 2.5e-4]),
        "A.friction & C.friction": [(0.1, 0.2), (0.3, 0.4)],
        "engine": ["dae", "exudyn"],
        "cycles": [2, 3],
        "friction": "0:0.1:3",
    }
    groups = [parse_group(SCENE, text) for text in texts_of(SCENE, vary)]
    expected = [[1e-4, 2.5e-4], [[0.1, 0.2], [0.3, 0.4]], [0.0, 1.0], [2.0, 3.0], [0.0, 0.05, 0.1]]
    assert [group.values.squeeze().tolist() for group in groups] == expected
    assert [repr(groups[k].columns[0].setting(1.0)) for k in (0, 2, 3)] == ["1.0", "'exudyn'", "1"]
    wrong: list[object] = [[], 3, [None], [math.nan], [True], {"a": 1}]
    for values in wrong:
        with pytest.raises(InputError, match="friction"):
            texts_of(SCENE, {"friction": values})


@pytest.mark.parametrize(
    ("text", "meaning", "reference"),
    [
        ("0.2mm:1mm", LENGTH, stats.uniform(0.2e-3, 0.8e-3)),
        ("uniform( 200um,0.1cm )", LENGTH, stats.uniform(0.2e-3, 0.8e-3)),
        ("normal(0.8mm, 0.05mm)", LENGTH, stats.norm(0.8e-3, 0.05e-3)),
        ("normal(0.5, 0.2)", PURE, stats.truncnorm(-2.5, 2.5, loc=0.5, scale=0.2)),
        ("lognormal(1e-15/Pa, x1.6)", PRESSURE, stats.lognorm(math.log(1.6), scale=1e-15)),
    ],
)
def test_distributions_have_their_quantiles(
    text: str, meaning: Quantity, reference: stats.rv_continuous
) -> None:
    quantiles = parse_distribution(text, "key", meaning).ppf(U)
    assert quantiles == pytest.approx(reference.ppf(U), rel=1e-9, abs=0)


def test_a_coefficient_of_variation_is_deviation_over_mean() -> None:
    distribution = parse_distribution("lognormal(1.2e-15/Pa, 50%)", "wear_coefficient", PRESSURE)
    draws = distribution.ppf((np.arange(200_000) + 0.5) / 200_000)
    assert np.median(draws) == pytest.approx(1.2e-15, rel=1e-4, abs=0)
    assert draws.std() / draws.mean() == pytest.approx(0.5, rel=2e-3, abs=0)


def test_values_of_a_file_have_weights(tmp_path: Path) -> None:
    file = tmp_path / "measured.csv"
    file.write_text("# bushings\n0.4mm, 1\n\n0.2mm, 3\n")
    draws = parse_distribution(f"table({file})", "key", LENGTH).ppf((np.arange(400) + 0.5) / 400)
    assert [np.count_nonzero(draws == value) for value in (0.2e-3, 0.4e-3)] == [300, 100]
    for lines, message in (
        ("0.2mm\nred\n", "line 2: key = 'red'"),
        ("0.2mm,-1\n0.3mm\n", "line 1: weight"),
        ("0.2mm,0\n0.3mm,0", "at least two values and a positive weight"),
    ):
        file.write_text(lines)
        with pytest.raises(InputError, match=message):
            parse_distribution(f"table({file})", "key", LENGTH)


def test_designs_are_reproducible_and_balanced() -> None:
    rows = {"sobol": 16, "latin": 16, "saltelli": 80, "morris": 64, "oat": 97}
    for kind, count in rows.items():
        points = design(kind, 16, 3, seed=3)
        assert points.shape == (count, 3)
        assert np.array_equal(points, design(kind, 16, 3, seed=3))
        assert kind == "oat" or not np.array_equal(points, design(kind, 16, 3, seed=4))
    for kind in ("sobol", "latin"):  # one point in each sixteenth of every range
        places = np.sort((16.0 * design(kind, 16, 3, seed=1)).astype(int), axis=0)
        assert np.array_equal(places, np.repeat(np.arange(16)[:, None], 3, axis=1))
    blocks = design("saltelli", 8, 3, seed=1).reshape(8, 5, 3)
    for k in range(3):
        others = np.delete(np.arange(3), k)
        assert np.array_equal(blocks[:, k + 1, k], blocks[:, -1, k])
        assert np.array_equal(blocks[:, k + 1, others], blocks[:, 0, others])
