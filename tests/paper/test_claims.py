"""The claims as data: each comparison can be computed, and is of what its sentence says."""

import math
import re

import pytest
from invented import every_evidence

from presswear.paper.claims import CLAIMS, DEPTH_RATIOS
from presswear.paper.printed import DOUBTFUL, PRINTED
from presswear.paper.report.chosen import (
    WATCHED,
    across,
    distances_table,
    factors_of,
    fit_of,
    moves,
    stopped_table,
)
from presswear.paper.variants import (
    BASE,
    CASES,
    FRICTION,
    GEOMETRIES,
    HIGH_FRICTION,
    SENSITIVITIES,
    SETTINGS,
    STARTS,
    make_scenes,
)
from presswear.paper.verdicts import Verdict, compared, verdict
from presswear.paper.words import QUANTITIES
from presswear.show.page import Line, Table


def rows_of(table: Table) -> tuple[Line, ...]:
    ((_, rows),) = table.groups
    return rows


def test_known_depths_give_known_verdicts() -> None:
    """Made up: A is 2.5 times as deep as C everywhere, and nothing hangs on friction."""
    for claim in CLAIMS:
        assert claim.parts
        words = set()
        for part in claim.parts:
            assert part.quantity in QUANTITIES
            assert len(part.over) == len(part.under)
            ours = compared(every_evidence(), BASE, part)
            assert ours is not None, claim.quote
            words.add(verdict(ours, part))
        if "clearance A is more serious" in claim.quote:
            assert words == {Verdict.HOLDS}
        if claim.quote.startswith("the wear depth at the friction coefficient"):
            assert words == {Verdict.OPEN}


def test_friction_claims_compare_the_higher_with_the_lower_coefficient() -> None:
    parts = [part for claim in CLAIMS if claim.where.startswith("5.4.2") for part in claim.parts]
    for part in parts:
        if len(part.over) == 1:
            assert part.under[0].setting == FRICTION
            assert part.over[0].setting == HIGH_FRICTION


def test_every_figure_and_section_of_the_paper_has_its_claims() -> None:
    wheres = [claim.where.split(", Fig. ") for claim in CLAIMS]
    sections = {section for section, _ in wheres}
    assert sections == {"5.3.1", "5.3.2", "5.3.3", "5.4.1", "5.4.2", "5.4.3", "6"}
    figures = {int(number) for _, told in wheres for number in re.findall(r"\d+", told)}
    assert figures == set(range(8, 26))
    assert {int(item.figure[:-1]) for item in PRINTED} <= figures


def test_depth_ratios_are_all_printed() -> None:
    assert all(part.printed is not None for part in DEPTH_RATIOS)
    assert len(set(DEPTH_RATIOS)) == len(DEPTH_RATIOS) == 12


def test_the_study_runs_what_it_says() -> None:
    scenes = make_scenes()
    first = list(scenes.values())[: len(SETTINGS)]
    assert [scene.mechanism.period for scene in first] == [
        setting.scene().mechanism.period for setting in SETTINGS.values()
    ]
    standard = first[0]
    assert standard.replicates == STARTS
    assert {case.key for case in CASES} >= {*GEOMETRIES, *SENSITIVITIES}
    base = standard.as_dict()
    for name, scene in scenes.items():
        case = name.partition("--")[0]
        if case in SENSITIVITIES:
            told = scene.as_dict().items()
            changed = {key for key, value in told if value != base[key]}
            assert (
                1 <= len(changed - {"origins", "tolerance", "wear_updates", "replicates"}) <= 2
            ), case


def test_a_fit_leaves_out_what_is_doubtful() -> None:
    factors = factors_of(every_evidence(), BASE)
    assert len(factors) == 10
    assert len(DOUBTFUL) == 2
    even = {place: 2.0 if place in DOUBTFUL else 3.0 for place in factors}
    assert fit_of(even) == pytest.approx((3.0, 1.0))
    apart = [place for place in factors if place not in DOUBTFUL][:2]
    assert fit_of(dict(zip(apart, (2.0, 8.0), strict=True))) == pytest.approx((4.0, 2.0))
    assert math.isnan(fit_of(dict.fromkeys(DOUBTFUL, 1.0))[0])


def test_what_is_alike_moves_nothing_and_stops_right() -> None:
    evidence = every_evidence()
    for case in SENSITIVITIES:
        ratios = [across(evidence, place, quantity, case) for quantity, _, place in WATCHED]
        assert None not in ratios
        assert sum(map(moves, ratios)) <= 2
    stopped = rows_of(stopped_table(evidence))
    assert len(stopped) > 8
    # Each agrees with a probability of 95 %.
    assert [row[-1] for row in stopped].count("no") <= 1
    assert {row[-1] for row in stopped} <= {"yes", "no"}
    distances = rows_of(distances_table(evidence))
    assert len(distances) == 2
    for row in distances:
        error, full, expected, found = (float(cell.removesuffix(" %")) for cell in row[1:])
        assert expected == pytest.approx((error**2 + full**2) ** 0.5, abs=0.1)
        assert found < 3.0 * expected
