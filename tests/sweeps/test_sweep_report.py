"""The report of made-up sweeps: what it says is what the table holds."""

import re
import sys
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pandas
import pytest
from made_up_sweep import ishigami, random_blocks, swept
from test_sweep_figures import REQUIRED, SPREADS, grid, table

from presswear.recording.statistics import Estimate
from presswear.sweeps.analysis import analysed
from presswear.sweeps.designs import design
from presswear.sweeps.distributions import parse
from presswear.sweeps.figures.scales import Scale
from presswear.sweeps.report import FIRST_ROWS, REST, write_report
from presswear.sweeps.responses import responses
from presswear.sweeps.sensitivity import by_blocks
from presswear.sweeps.spread import Required
from presswear.sweeps.table import Column, Table
from presswear.sweeps.words import amount, parts
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity


def page(own: Table, folder: Path, sample: str = "") -> str:
    known = SPREADS if sample else None
    path = write_report(
        own, folder, "Lives", sample=sample, distributions=known, required={"life": REQUIRED}
    )
    assert path == folder / "report.html"
    text = re.sub(
        r"<style>.*?</style>|data:image/png;base64,[^\"]*", "", path.read_text(), flags=re.S
    )
    return unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", text)))


@pytest.fixture(scope="module")
def sampled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Table, str, Path]:
    own = table("sobol", 64)
    own.values[[4, 5, 20]] = np.nan
    reasons = list(own.reasons)
    reasons[4] = reasons[5] = "<b>the pin</b> sinks in deeper than it is thick"
    reasons[20] = "no number"
    own = replace(own, reasons=tuple(reasons))
    folder = tmp_path_factory.mktemp("sweep")
    return own, page(own, folder, "sobol"), folder


def test_it_counts_runs_points_and_failures(sampled: tuple[Table, str, Path]) -> None:
    _, text, _ = sampled
    assert "128 runs at 64 points, of which 3 have no values." in text
    assert "<b>the pin</b> sinks in deeper than it is thick 2 clearance =" in text
    assert text.index("sinks in deeper") < text.index("no number")


def test_its_numbers_are_those_of_the_analysis(sampled: tuple[Table, str, Path]) -> None:
    own, text, _ = sampled
    found = analysed(own, "life", "sobol", SPREADS, REQUIRED)
    assert found.indices is not None
    assert found.chaos is not None
    assert found.spread is not None
    assert found.spread.misses is not None
    assert found.surface is not None
    assert f"Of the variance of one run of life {parts(found.chaos)} is chaos" in text
    for k in (0, 2):
        key = found.own.factors[k].key
        assert f"{key}, alone {parts(found.indices.first[k])}" in text
    assert "vary together" not in text
    assert f"at least 2.00·10⁶, is {parts(found.spread.misses)}." in text
    five = found.spread.quantile(5)
    assert f"life is below {five.mean / 1e6:.2f}·10⁶ (" in text
    assert f"it explains {100.0 * found.surface.left_out.explained:.3g} % of the variance" in text


def test_all_rows_are_beside_it(sampled: tuple[Table, str, Path]) -> None:
    own, text, folder = sampled
    assert f"{128 - FIRST_ROWS} other rows are in {REST}" in text
    rows = pandas.read_csv(folder / REST, comment="#")
    assert np.array_equal(rows["life"], own.values[:, 0], equal_nan=True)
    assert {file.name for file in (folder / "figures").iterdir()} == {
        "shares-life.png",
        "spread-life.png",
        "map-life.png",
        "sections-life.png",
        "parallel-life.png",
    }


@pytest.mark.parametrize(
    ("kind", "size", "told"),
    [
        ("one", 1, "One factor at a time"),
        ("morris", 10, "Effects of jumps by half of the range"),
        ("saltelli", 16, "with others (total)"),
    ],
)
def test_each_design_has_its_table(tmp_path: Path, kind: str, size: int, told: str) -> None:
    assert told in page(table(kind, size), tmp_path, kind)


def test_the_strongest_effect_is_told_first(tmp_path: Path) -> None:
    jumps = table("morris", 10)
    found = analysed(jumps, "life").screening
    assert found is not None
    sizes = [one.size.mean for one in found]
    assert max(sizes) == sizes[2]
    told = f"most when it goes up by half of its range, by {sizes[2] / 1e6:.2f}·10⁶ ("
    assert f"{jumps.factors[2].key} changes life {told}" in page(jumps, tmp_path)
    alone = table("one", 1)
    moved = analysed(alone, "life").swings
    assert moved is not None
    assert moved[2] is not None
    text = page(alone, tmp_path)
    assert f"Alone, {alone.factors[2].key} moves life most: by " in text
    assert f"by {moved[2].at_low.mean / 1e6:.2f}·10⁶ (" in text


def test_points_that_do_not_reach_tell_no_spread(tmp_path: Path) -> None:
    text = page(table("morris", 10), tmp_path, "morris")
    assert "25 % of the values of clearance lie outside its points" in text
    assert "with a probability of" not in text


def test_without_draws_it_says_so(tmp_path: Path) -> None:
    text = page(table("latin", 64, draws=1), tmp_path)
    assert "How much of the variance of life is chaos cannot be told" in text


def test_a_grid_is_no_sample_of_anything(tmp_path: Path) -> None:
    text = page(grid(), tmp_path)
    assert "C.force_max over clearance" in text
    assert "Spread" not in text


def test_a_sample_that_is_crossed_with_values_is_told_of_at_each(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ishigami's function, and the same with its first two factors exchanged."""
    monkeypatch.setitem(sys.modules, "sklearn.exceptions", None)  # surfaces take seconds
    blocks = random_blocks(16, 3, seed=5)
    exchanged = ishigami(blocks[:, [1, 0, 2]])
    values = np.column_stack([ishigami(blocks), exchanged]).ravel()
    points = np.column_stack([np.repeat(blocks, 2, axis=0), np.tile([0.0, 1.0], len(blocks))])
    own = swept(points, values)
    order = Column("order", "", "which is which", ("as it is", "exchanged"))
    own = replace(own, factors=(*own.factors[:3], order))
    path = write_report(own, tmp_path, "Ishigami", sample="saltelli", crossed=1)
    text = unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", path.read_text())))
    alone = swept(blocks, exchanged)
    found = by_blocks(responses(alone, "y"))
    assert found is not None
    for place, part in enumerate(text.split(" y at order = ")[1:]):
        assert part.startswith(("as it is", "exchanged")[place])
    assert f"x2 {parts(found.first[1])} {parts(found.total[1])}" in part
    # Nothing is told of all of them together, which are no sample.
    assert text.count("Shares of the variance of the means") == 2


def test_without_scikit_learn_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.exceptions", None)
    text = page(table("latin", 64), tmp_path, "latin")
    assert "A response surface needs scikit-learn: pip install 'presswear[sweep]'." in text
    assert "By the rows alone, life is below" in text


def test_what_depends_on_nothing_says_so(tmp_path: Path) -> None:
    points = np.random.default_rng(1).random((100, 2))
    own = swept(points, np.zeros(100), draws=2, noise=1.0, seed=3)
    found = page(own, tmp_path)
    assert "No response surface of y" in found
    assert "The means of y depend on" not in found


def test_words_and_measures_without_values_are_told(tmp_path: Path) -> None:
    points = np.array([[float(k), x] for k in range(2) for x in (0.1, 0.2, 0.3)])
    own = swept(points, points.sum(axis=1))
    empty = np.full((6, 1), np.nan)
    own = replace(
        own,
        factors=(Column("engine", "", "which engine", ("dae", "exudyn")), own.factors[1]),
        measures=(*own.measures, Column("life", "", "strokes")),
        values=np.hstack([own.values, empty]),
        halves=np.hstack([own.halves, empty]),
        is_beyond=np.hstack([own.is_beyond, np.zeros((6, 1), np.bool_)]),
    )
    text = page(own, tmp_path)
    assert "engine which engine dae, exudyn 2 –" in text
    assert "life strokes 0 0 – – – –" in text
    assert "1 dae 100.0 0.1000" in text
    with pytest.raises(InputError, match="no run has a value of life"):
        analysed(own, "life")


def test_factors_that_vary_together_are_named(tmp_path: Path) -> None:
    pairs = [(0.1, 3.0), (0.2, 1.0), (0.3, 2.0)]
    zipped = np.array([[a, b, c] for a, b in pairs for c in (0.0, 1.0)])
    told = "x1 and x2 vary together"
    assert told in page(swept(zipped, zipped.sum(axis=1)), tmp_path)
    line = np.array([[x, -x] for x in np.random.default_rng(1).random(40)])
    assert told in page(swept(line, line[:, 0]), tmp_path)
    apart = np.random.default_rng(1).random((40, 2))
    assert told not in page(swept(apart, apart.sum(axis=1)), tmp_path)


def test_runs_without_values_are_counted_beside_the_spread(
    sampled: tuple[Table, str, Path],
) -> None:
    own, text, _ = sampled
    spread = analysed(own, "life", "sobol", SPREADS, REQUIRED).spread
    assert spread is not None
    assert spread.misses is not None
    worst = 100.0 * (3 + 125 * spread.misses.mean) / 128
    assert (
        "3 of 128 runs have no value of life and are not in this spread; if all of them miss, "
        f"{worst:.3g} % do."
    ) in text


def test_a_grid_counts_points_that_miss(tmp_path: Path) -> None:
    values = np.array([1e6, 3e6, 1.5e6, 4e6])
    is_beyond = np.array([False, False, True, True])
    own = swept(np.arange(4.0)[:, None], values, is_beyond=is_beyond, unit="")
    least = write_report(own, tmp_path, "Lives", required={"y": Required(2e6, True)}).read_text()
    told = "1 of 4 points miss what is required of y, at least 2.00·10⁶; at 1 of 4 points a lower"
    assert told in least
    most = write_report(own, tmp_path, "Lives", required={"y": Required(2e6, False)}).read_text()
    told = "2 of 4 points miss what is required of y, at most 2.00·10⁶; at 1 of 4 points a lower"
    assert told in most
    for row, shown in enumerate(("1.000", "3.000", "&gt;1.500", "&gt;4.000")):
        assert re.search(rf">{row + 1}</t[hd]>\s*<td[^>]*>[^<]*</td>\s*<td[^>]*>{shown}<", most)


def test_lower_bounds_leave_a_quantile_and_misses_open(tmp_path: Path) -> None:
    points = design("latin", 16, 1, 1)
    own = swept(points, np.linspace(1.0, 2.0, 16), is_beyond=np.ones(16, np.bool_))
    path = write_report(
        own,
        tmp_path,
        "Lives",
        sample="latin",
        distributions={"x1": parse("0m:1m", "x1", Quantity("m", 0.0, 1.0, "", ""))},
        required={"y": Required(1.5, True)},
    )
    text = unescape(re.sub(r"\s+", " ", path.read_text()))
    assert "lower bounds leave open which value y is below with a probability of 5 %." in text
    assert "at 8 of 16 points a lower bound leaves it open." in text
    assert "Shares of the variance and effects take the bound for the value." in text


def test_what_is_the_same_everywhere_is_told_once(tmp_path: Path) -> None:
    points = np.array([[a, b] for a in (1.0, 2.0) for b in (1.0, 2.0, 3.0)])
    text = page(swept(points, np.full(6, 5.0)), tmp_path)
    assert "It is 5.00 N at all points." in text
    assert "is chaos" not in text
    assert not (tmp_path / "figures").exists()


def test_intervals_wider_than_the_runs_differ_tell_no_chaos(tmp_path: Path) -> None:
    points = design("latin", 32, 2, 1)
    values = np.random.default_rng(1).normal(10.0, 1.0, 32)
    wide = page(swept(points, values, halves=np.full(32, 20.0)), tmp_path)
    assert "cannot be told: the intervals of the runs are wider than the runs differ" in wide
    assert "No response surface of y" in wide
    narrow = page(swept(points, values, halves=np.full(32, 0.5)), tmp_path)
    assert "is chaos: as the intervals of the runs themselves tell it" in narrow


def test_an_open_end_is_told_with_its_unit() -> None:
    scale = Scale.of(Column("y", "N", ""), np.array([1.0, 2.0]))
    assert amount(Estimate(1.0, None, 2.0), scale) == "1.00 N (at most 2.00 N)"
    assert amount(Estimate(1.0, 0.5, None), scale) == "1.00 N (at least 0.500 N)"
    assert amount(Estimate(1.0, 0.5, 2.0), scale) == "1.00 N (0.500 to 2.00)"


def test_a_sweep_in_which_all_failed_is_told(tmp_path: Path) -> None:
    own = swept(np.arange(3.0)[:, None], np.full(3, np.nan), reasons=("it hit",) * 3)
    text = page(own, tmp_path)
    assert "3 runs at 3 points, of which 3 have no values." in text
    assert "it hit 3 x1 =" in text
