"""Wear against angles, cycles, amplification, contact model and method."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from precision.made_up_precision import SCENE
from presswear.recording.sampling import Interval
from presswear.scene.catalog import ideal
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError
from presswear.validation.precision import wear as module
from presswear.validation.precision.wear import (
    FULL,
    PAPER_STEP,
    QUICK,
    TITLES,
    USUAL,
    VOLUME,
    Means,
    Varied,
    WearPoint,
    cases,
    change,
    run_case,
    vary,
)

ALL = cases(SCENE, FULL)


@pytest.mark.parametrize(
    ("varied", "scene"), ALL, ids=[f"{varied.conventions} {varied.label}" for varied, _ in ALL]
)
def test_each_case_varies_one_thing(varied: Varied, scene: Scene) -> None:
    base = next(
        own
        for c, own in ALL
        if c.group == "contact" and c.is_default and c.conventions == varied.conventions
    )
    undone = {
        "angles": replace(scene, bearings=base.bearings),
        "cycles": replace(scene, cycles=base.cycles),
        "jump": replace(scene, extrapolation="conventions"),
        "contact": replace(scene, conventions=base.conventions),
        "method": replace(scene, engine=base.engine, numerics=base.numerics),
    }
    assert undone[varied.group] == base
    if varied.is_default and varied.group != "cycles":
        assert scene == base


def test_extents_cover_what_is_asked_for() -> None:
    for means in FULL.values():
        assert means.angles == (90, 180, 360, 720, 1440)
        assert means.cycles[:5] == (5, 10, 20, 50, 100)
    for extent in (QUICK, FULL):
        found = [varied for varied, _ in cases(SCENE, extent)]
        assert {c.group for c in found} == set(TITLES)
        assert {c.conventions for c in found if c.group == "angles"} == {"paper", "refined"}
        assert sum(c.label == PAPER_STEP for c in found) == 1


def values_of(group: str, conventions: str) -> list[float]:
    found = [c for c, _ in ALL if (c.group, c.conventions) == (group, conventions)]
    return [varied.value for varied in found if varied.value is not None]


def test_finest_comes_last() -> None:
    for group in ("angles", "cycles"):
        values = values_of(group, "paper")
        assert values == sorted(values)


def test_relative_change_with_its_interval() -> None:
    here, there = Interval(1.2, 1.08, 1.32), Interval(1.0, 0.9, 1.1)
    moved = change(here, there)
    assert moved.value == pytest.approx(0.2)
    half = 1.2 * math.hypot(0.1, 0.1)
    assert moved.low == pytest.approx(0.2 - half)
    assert moved.high == pytest.approx(0.2 + half)
    assert change(here, Interval(1.0, None, None)).low is None
    assert math.isnan(change(here, Interval(0.0, 0.0, 0.0)).value)


def ran(conventions: str, group: str, label: str, wear_updates: int = 1) -> WearPoint:
    """The point of a case of few cycles and a wear in one jump."""
    means = Means((90, 360), (4,), 4)
    extent = {"paper": replace(means, methods=(PAPER_STEP, USUAL)), "refined": means}
    varied, scene = next(
        (varied, own)
        for varied, own in cases(replace(SCENE, extrapolation="single"), extent)
        if (varied.conventions, varied.group, varied.label) == (conventions, group, label)
    )
    point = run_case(varied, replace(scene, wear_updates=wear_updates), lambda part: None)
    assert point.varied == varied
    return point


def test_depth_by_bins_depends_on_their_width() -> None:
    """One motion, other maps: what goes into one bin is more volume in a wider one."""
    coarse, fine = ran("paper", "angles", "90"), ran("paper", "angles", "360")
    for joint in ("A", "C"):
        ratio = coarse.first[joint][VOLUME].value / fine.first[joint][VOLUME].value
        assert ratio == pytest.approx(4.0, rel=1e-9)
        low, high = fine.first[joint][VOLUME].low, fine.first[joint][VOLUME].high
        assert low is not None
        assert high is not None
        assert low < fine.first[joint][VOLUME].value < high
    assert set(fine.second) == {"A", "C"}
    assert (fine.steps, fine.cycles) == (1, 24)
    assert fine.wall > 0.0


def test_depth_over_the_arc_does_not() -> None:
    """The volume is K_d times the work, whatever the bins."""
    coarse, fine = (ran("refined", "angles", label, wear_updates=0) for label in ("90", "360"))
    for joint in ("A", "C"):
        ratio = coarse.first[joint][VOLUME].value / fine.first[joint][VOLUME].value
        assert ratio == pytest.approx(1.0, rel=1e-9)


def test_the_step_of_the_paper_stays_in_as_a_failure() -> None:
    paper = ran("paper", "method", PAPER_STEP)
    assert "no longer finite" in paper.failure
    assert not paper.first
    assert not paper.second


def test_what_groups_have_in_common_runs_once(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[Scene] = []

    def pretend(varied: Varied, scene: Scene, told: Callable[[float], None]) -> WearPoint:
        ran.append(scene)
        told(0.5)
        return WearPoint(varied)

    monkeypatch.setattr(module, "run_case", pretend)
    told: list[float] = []
    means = Means((90, 360), (4, 10), 10)
    extent = {"paper": replace(means, methods=(PAPER_STEP, USUAL)), "refined": means}
    study = vary(SCENE, extent, lambda word, part: told.append(part))
    scenes = [scene for scene in ran if scene.cycles != 1]
    assert all(scenes.count(scene) == 1 for scene in scenes)
    # Of each set once as it is; angles, cycles, jump, contact, the paper's step once each.
    assert len(scenes) == 2 * (1 + 1 + 1 + 1 + 1) + 1
    assert [point.varied for point in study.points] == [c for c, _ in cases(SCENE, extent)]
    assert told == sorted(told)
    assert 0.0 <= told[0] <= told[-1] <= 1.0


def test_nothing_wears_without_clearance() -> None:
    with pytest.raises(InputError, match="nothing wears"):
        vary(ideal(), QUICK, lambda word, part: None)
