"""Claims, settings and verdicts of the paper's study."""

import math
import re
from dataclasses import replace
from typing import get_args

import pytest

import presswear as pw
from presswear.paper import settings, verdicts
from presswear.paper.evidence import Measured
from presswear.paper.printed import (
    CLAIMS,
    PRINTED,
    Comparison,
    Expected,
    Place,
    Printed,
    wrapped_angle,
)
from presswear.paper.settings import FRICTION, HIGH_FRICTION, make_scenes
from presswear.paper.verdicts import Verdict, verdict

A = Place("speed-4pi", 0, "A")
B = Place("speed-8pi", 0, "A")


def test_claims_cover_the_paper_and_compare_the_higher_with_the_lower_friction():
    wheres = [claim.where.split(", Fig. ") for claim in CLAIMS]
    sections = {"5.3.1", "5.3.2", "5.3.3", "5.4.1", "5.4.2", "5.4.3", "6"}
    assert {section for section, _ in wheres} == sections
    figures = {int(number) for _, some in wheres for number in re.findall(r"\d+", some)}
    assert figures == set(range(8, 26))
    assert {int(number.figure[:-1]) for number in PRINTED} <= figures
    for part in (
        p
        for claim in CLAIMS
        if claim.where.startswith("5.4.2")
        for p in claim.comparisons
    ):
        if len(part.over) == 1:
            assert (part.under[0].setting, part.over[0].setting) == (
                FRICTION,
                HIGH_FRICTION,
            )


def test_each_sensitivity_changes_one_assumption_of_the_first_setting():
    scenes = make_scenes()
    first = list(scenes.values())[: len(settings.SETTINGS)]
    speeds = [2.0 / scene.mechanism.period for scene in first]  # over pi
    assert speeds == pytest.approx([3.5, 6.0, 6.0, 4.0, 8.0])
    base = first[0].as_dict()
    names = {name.partition("--")[0]: scene for name, scene in scenes.items()}
    assert names.keys() >= {*settings.GEOMETRIES, *settings.SENSITIVITIES}
    for case in settings.SENSITIVITIES:
        changed = {
            key for key, value in names[case].as_dict().items() if value != base[key]
        }
        changed -= {"origins", "tolerance", "wear_updates", "replicates"}
        assert 1 <= len(changed) <= 2, case
    quick = make_scenes("dae", quick=True)
    assert {scene.engine for name, scene in quick.items() if "other" not in name} == {
        "dae"
    }


def estimate(mean: float, half: float) -> pw.statistics.Estimate:
    return pw.statistics.Estimate.symmetric(mean, half)


def test_intervals_may_reach_zero_and_differences_of_angles_go_the_short_way():
    assert verdicts.ratio([estimate(1.0, 0.1)], [estimate(1.0, 1.5)]).high == math.inf
    assert verdicts.ratio([estimate(1.0, 1.5)], [estimate(1.0, 0.1)]).low == 0.0
    over, under = (estimate(math.radians(degrees), 0.01) for degrees in (5.0, 355.0))
    one = verdicts.difference(over, under, is_angle=True)
    assert one.mean == pytest.approx(math.radians(10.0))
    assert one.half_width == pytest.approx(0.01 * math.sqrt(2.0))
    assert wrapped_angle(math.pi + 0.1) == pytest.approx(0.1 - math.pi)


@pytest.mark.parametrize(
    ("low", "high", "more", "less", "same"),
    [
        (1.5, 3.0, "holds", "does not hold", "does not hold"),
        (0.9, 3.0, "undecided", "undecided", "undecided"),
        (0.3, 0.9, "does not hold", "holds", "does not hold"),
        (0.99, 1.01, "no effect", "no effect", "holds"),
        (0.96, 1.0, "no effect", "no effect", "undecided"),
        (0.85, 1.01, "undecided", "undecided", "undecided"),
    ],
)
def test_a_verdict_needs_the_whole_interval(low, high, more, less, same):
    """Ratios are compared with one, differences with zero."""
    expected: Expected
    for expected, word in (("more", more), ("less", less), ("same", same)):
        for quantity, off in (("force", 0.0), ("angle", 1.0)):
            ours = pw.statistics.Estimate(1.0 - off, low - off, high - off)
            assert verdict(ours, Comparison(quantity, (B,), (A,), expected)) == word
    assert (
        verdict(pw.statistics.Estimate(2.0), Comparison("force", (B,), (A,)))
        == "undecided"
    )
    assert verdict(None, Comparison("force", (B,), (A,))) == "not computed"


@pytest.mark.parametrize(
    ("parts", "word"),
    [
        *zip(
            ("h", "hh", "hf", "ff", "fo", "ho", "oo", "hm", "mm"),
            "hhpffoohm",
            strict=True,
        ),
        *zip(("n", "hn", "fn", "no"), "npfn", strict=True),
    ],
)
def test_a_claim_holds_where_all_its_parts_do(parts, word):
    words = dict(zip("hpfnom", get_args(Verdict), strict=True))
    assert verdicts.combined(words[letter] for letter in parts) == words[word]


def test_printed_numbers_are_compared_with_single_cycles_and_intervals():
    ours = Measured(estimate(100.0, 5.0), (60.0, 150.0), (100.0, 110.0))
    angle = Measured(estimate(math.radians(359.0), math.radians(5.0)))
    for quantity, value, measured, expected in (
        ("force", 140.0, ours, "inside"),
        ("force", 151.0, ours, "above"),
        ("force", 59.0, ours, "below"),
        ("force", 310.0, replace(ours, first_cycles=(300.0, 320.0)), "inside"),
        ("force", 100.0, Measured(estimate(100.0, 5.0)), "undecided"),
        ("force", 100.0, None, "not computed"),
        ("depth", 1e-6, ours, "as ratios only"),
        ("angle", math.radians(2.0), angle, "agrees"),
        ("angle", math.radians(6.0), angle, "differs"),
    ):
        number = Printed("5", "1", Place("speed-4pi", 1, "A"), quantity, value)
        assert verdicts.position(number, measured) == expected
    assert verdicts.agreement(2.0, pw.statistics.Estimate(1.9, 1.5, 2.5)) == "agrees"
    assert verdicts.agreement(3.0, pw.statistics.Estimate(1.9)) == "undecided"
