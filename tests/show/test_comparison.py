"""Two results side by side: ratios, limits, settings that differ, and refused folders."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
import re
from dataclasses import replace
from typing import Any

import made_up_result as made
import numpy as np
import pytest
from refusals import refused

import presswear as pw
from presswear.recording.statistics import Estimate, ratio
from presswear.show.comparison import (
    limit_pairs,
    number_pairs,
    render_comparison,
    setting_pairs,
)
from presswear.show.limits import ABOVE, WITHIN

ONE = made.made_up(replace(made.BODY, wear_updates=0), 1)


def with_force(result: pw.Result, force: Estimate) -> pw.Result:
    """Return a result with another mean peak force in each joint."""
    statistics = result.stages[0].statistics
    joints = {
        name: replace(joint, peak_force_per_cycle=force)
        for name, joint in statistics.joints.items()
    }
    return made.altered(result, 0, statistics=replace(statistics, joints=joints))


def test_the_interval_of_a_ratio_holds_in_95_of_100_trials():
    random = np.random.default_rng(1)
    errors = np.array([0.03, 0.08])  # standard deviations, relative
    hits = 0
    for _ in range(2000):
        draws = np.array([6.0, 4.0]) * (1.0 + errors * random.standard_normal(2))
        halves = 1.96 * errors * draws
        ends = (Estimate.symmetric(*pair) for pair in zip(draws, halves, strict=True))
        low, high = (lambda one: (one.low, one.high))(ratio(*ends))
        hits += low <= 1.5 <= high
    assert 0.935 < hits / 2000 < 0.965


def test_a_ratio_with_an_unknown_sign_has_no_interval():
    assert ratio(Estimate(2.0, -1.0, 5.0), Estimate(4.0, 3.0, 5.0)) == Estimate(0.5)
    assert ratio(Estimate(2.0), Estimate(4.0, 3.0, 5.0)) == Estimate(0.5)
    bottom = ratio(Estimate(-2.0, -2.2, -1.8), Estimate(-4.0, -4.0, -4.0))
    assert bottom.mean == 0.5
    assert bottom.low == pytest.approx(0.5 / math.sqrt(2.2 / 1.8))


@pytest.mark.parametrize(
    ("force", "text", "verdict"),
    [
        (Estimate(160.0, 152.0, 168.0, 20), "2.00 (1.71 to 2.35)", "run 2 is larger"),
        (Estimate(40.0, 38.0, 42.0, 20), "0.500 (0.426 to 0.586)", "run 2 is smaller"),
        (
            Estimate(84.0, 80.0, 88.0, 20),
            "1.05 (0.896 to 1.23)",
            "no certain difference",
        ),
        (Estimate(84.0, samples=20), "1.05", "interval unknown"),
    ],
)
def test_numbers_have_a_ratio_and_a_verdict(force, text, verdict):
    """The first has 68 to 92 N: ln(92 / 68) / 2 = 0.151, and 0.050 of 152 to 168 N."""
    pairs = {pair.name: pair for pair in number_pairs(ONE, with_force(ONE, force))}
    assert pairs["Peak joint force"].ratio == (text, verdict)
    assert pairs["Stroke"].ratio == ("1.00", "equal")


def test_limits_have_a_light_for_each_result():
    bearing = replace(ONE.scene.bearings, pressure_limit=0.2e6)
    first = replace(ONE, scene=replace(ONE.scene, bearings=bearing))
    second = with_force(first, Estimate(160.0, 152.0, 168.0, 20))
    (pressure,) = [
        pair for pair in limit_pairs(first, second) if "pressure" in pair.name
    ]
    assert pressure.first.verdict == WITHIN  # 80 N on 30 x 20 mm: 0.13 MPa
    assert pressure.second.verdict == ABOVE  # 0.27 MPa
    page = render_comparison(first, second)
    assert len(re.findall(r"within the limit|above the limit", page)) >= 2


def test_settings_that_differ_are_listed_with_both_values():
    changes: dict[str, Any] = {"A.clearance": "0.3 mm", "speed": "120 rpm"}
    other = pw.changed(ONE.scene, changes)
    listed = {
        pair.key: (pair.first, pair.second) for pair in setting_pairs(ONE.scene, other)
    }
    assert listed["A.clearance"] == ("0.8 mm", "0.3 mm")
    assert listed["speed"] == ("105 rpm", "120 rpm")
    assert len(listed) == 2
    assert setting_pairs(other, other) == []
    crank = pw.Scene(pw.SliderCrank())
    keys = {pair.key: pair for pair in setting_pairs(ONE.scene, crank)}
    assert (keys["rod_length"].first, keys["length_3"].second) == ("–", "–")
    worn = replace(ONE.scene, surfaces={"A": (np.full(360, 1e-6), None)})
    assert [pair.key for pair in setting_pairs(ONE.scene, worn)] == ["surfaces"]


def test_a_page_has_figures_of_both_and_no_text_of_a_title():
    planted = replace(ONE, scene=replace(ONE.scene, title="<script>x</script>"))
    page = render_comparison(ONE, planted)
    assert "<script>x" not in page
    assert len(re.findall('class="pair"', page)) >= 2
    assert "All settings are equal." in page


def test_folders_that_cannot_be_compared_are_named(tmp_path, command, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sweep").mkdir()
    (tmp_path / "sweep" / "sweep.json").write_text("{}")
    assert "sweep is a sweep; two runs are compared" in command("report sweep sweep", 2)
    assert "nowhere: there is no such folder" in command("report nowhere sweep", 2)
    assert "--out needs two folders" in command("report sweep --out a.html", 2)
    assert "--figures cannot be" in command("report sweep sweep --figures impacts", 2)
    with refused("has no stage with numbers to compare"):
        render_comparison(ONE, made.made_up(ONE.scene, 1, "failed", "it ended"))
