"""Service lives of scenes: their limits, and how they stop, end and resume."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bush import CLEARANCE, bush
from endurance.sameness import folder_differences
from hypothesis import given
from hypothesis import strategies as st

import presswear as pw
from presswear.campaign.service_life import (
    LifeProblem,
    LoadBlock,
    Refinement,
    life_result,
)
from presswear.engines import driver
from presswear.linkage.linkage import Linkage
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Condition, Finding
from presswear.results.life import LifeResult
from presswear.scene.options import FOLLOWED, Life, Service
from presswear.scene.settings import changed

JOINTS = ("A", "B")


def scene_of(part: float = 0.02, share: float = 1.0, **life: Any) -> pw.Scene:
    """Return a bushing worn until it has lost a part of its clearance, two replicates."""
    settings: dict[str, Any] = {"until": f"B.depth > {part * CLEARANCE!r} m", "at_most": 1e12}
    limits = Life(**settings | life)
    return bush(share=share, life=limits, replicates=2, wear_updates=1, cycles=3, tolerance=0.5)


def life_of(scene: pw.Scene) -> LifeResult:
    life = pw.run(scene, jobs=1, check=False).life
    assert life is not None
    return life


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, LifeResult]:
    """Run a life without an interrupt, in one process."""
    path = tmp_path_factory.mktemp("life") / "whole"
    life = pw.run(scene_of(), path, jobs=1).life
    assert life is not None
    return path, life


@given(
    st.sampled_from(sorted(FOLLOWED)),
    st.sampled_from(("", *JOINTS)),
    st.floats(1e-9, 1e6),
    st.text(" ", max_size=3),
)
def test_limits_are_read(name: str, joint: str, value: float, blank: str) -> None:
    unit, of_joint = FOLLOWED[name].unit, FOLLOWED[name].of_joint
    text = f"{blank}{joint + '.' if joint else ''}{name}{blank}>{blank}{value!r} {unit}{blank}"
    if joint and not of_joint:
        with pytest.raises(pw.InputError, match="is of the whole mechanism"):
            Life(until=text).limits(JOINTS)
        return
    limits = Life(until=text).limits(JOINTS)
    assert [limit.joint for limit in limits] == (
        [joint] if joint else list(JOINTS) if of_joint else [""]
    )
    assert {limit.value for limit in limits} == {value}


def test_services_are_read_in_the_order_of_strokes() -> None:
    life = Life(replaced="A@2e6, B@4e6", turned=" B@1e6")
    expected = [Service("B", 1e6, True), Service("A", 2e6, False), Service("B", 4e6, False)]
    assert list(life.services(JOINTS)) == expected


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"until": "depth 5 um"}, "NAME > VALUE is expected"),
        ({"until": "dept > 5 um"}, "did you mean depth"),
        ({"until": "depth > 5 N"}, "until: depth"),
        ({"until": "D.depth > 5 um"}, "joint with clearance in until"),
        ({"replaced": "A2e6"}, r"replaced = 'A2e6': JOINT@STROKES is expected, such as"),
        ({"turned": "C@2e6"}, "joint with clearance in turned"),
        ({"turned": "A@many"}, "turned: A"),
        ({"replaced": "A@2e6", "at_most": 1e6}, "allowed is below at_most = 1e"),
    ],
)
def test_bad_lives_are_refused(settings: dict[str, Any], message: str) -> None:
    life = Life(**settings)
    with pytest.raises(pw.InputError, match=message):
        life.limits(JOINTS) and life.services(JOINTS)


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (lambda: bush(life=Life(), wear_updates=1), r"^replicates = 1: .* allowed is 2 to 100$"),
        (
            lambda: life_of(scene_of(until="B.depth > 1 mm, force_max > 1 N")),
            r"'B.force_max > 1 N': it is exceeded when new",
        ),
    ],
)
def test_scenes_without_a_life_are_refused(run: Callable[[], object], message: str) -> None:
    with pytest.raises(pw.InputError, match=message):
        run()


def test_equal_replicates_leave_the_error_of_the_step(whole: tuple[Path, LifeResult]) -> None:
    life = whole[1]
    assert life.ended == "limit"
    assert life.sampling is not None
    assert life.step is not None
    assert life.sampling < 0.01 * life.step
    assert life.error == pytest.approx(life.step, rel=1e-4)
    depth = life.curves["B.depth"][:, 0]
    assert np.all(np.diff(depth) > 0.0)
    at = np.interp(life.strokes, life.curves["strokes"], depth)
    assert at == pytest.approx(0.02 * CLEARANCE, rel=1e-9, abs=0.0)


def test_no_number_depends_on_the_processes(whole: tuple[Path, LifeResult], tmp_path: Path) -> None:
    pw.run(pw.load(whole[0]).scene, tmp_path / "two", jobs=2)
    assert folder_differences(whole[0], tmp_path / "two") == []


class Stops(pw.Observer):
    """Interrupts a refinement after a number of reports on it."""

    def __init__(self, number: int, reports: int) -> None:
        self.word, self.left = f"refinement {number}", reports

    def on_progress(self, progress: pw.Progress) -> None:
        if self.word in progress.word:
            self.left -= 1
            if not self.left:
                raise KeyboardInterrupt


@pytest.mark.parametrize(("number", "reports"), [(1, 3), (1, 12), (2, 2), (2, 30)])
def test_interrupted_life_resumes_bit_for_bit(
    number: int, reports: int, whole: tuple[Path, LifeResult], tmp_path: Path
) -> None:
    scene, path = pw.load(whole[0]).scene, tmp_path / "stopped"
    with pytest.raises(KeyboardInterrupt):
        pw.run(scene, path, observers=[Stops(number, reports)], jobs=1)
    pw.run(scene, path, jobs=1)
    assert folder_differences(whole[0], path) == []


@pytest.mark.parametrize(
    ("service", "word"), [("replaced", "replaced"), ("turned", "turned by half")]
)
def test_maintained_bushing_lasts_as_long_again(
    service: str, word: str, whole: tuple[Path, LifeResult]
) -> None:
    """It alone wears, and on one side: new or turned, the loaded side has lost nothing."""
    at = 0.6 * whole[1].strokes
    settings: dict[str, Any] = {service: f"B@{at!r}"}
    life = life_of(scene_of(**settings))
    assert life.services == (f"bushing of B {word} after {at:.4g} strokes",)
    assert life.strokes == pytest.approx(at + whole[1].strokes, rel=0.05)
    strokes, depth = life.curves["strokes"], life.curves["B.depth"][:, 0]
    k = int(np.flatnonzero(np.diff(strokes) == 0.0)[0])
    assert strokes[k] == pytest.approx(at, rel=1e-9, abs=0.0)
    assert depth[k + 1] == (0.0 if service == "replaced" else depth[k])


def test_limit_that_is_not_exceeded_ends_with_the_strokes(whole: tuple[Path, LifeResult]) -> None:
    at_most = 0.5 * whole[1].strokes
    life = life_of(scene_of(at_most=at_most))
    assert (life.ended, life.first) == ("at_most", None)
    assert life.strokes == pytest.approx(at_most)
    assert life.limits[0].last < 0.02 * CLEARANCE


def evenly_worn(cycles: int, strokes: float, **rates: float) -> Refinement:
    """Return a refinement of two histories that wear evenly and differ by a hundredth."""
    differing, blocks = np.array([0.99, 1.01]), []
    for k in range(cycles + 1):
        now = strokes * k / cycles
        levels = {f"{joint}.depth": rate * now * differing for joint, rate in rates.items()}
        levels |= {f"{joint}.wear_volume": 1e-6 * levels[f"{joint}.depth"] for joint in rates}
        removed = np.full((len(rates), 2, 8), 1e-12)
        blocks.append(LoadBlock(now, int(k > 0), 0, levels, {}, 1e-9, removed))
    return Refinement(1.0 / cycles, 1, tuple(blocks))


def test_first_limit_is_as_accurate_as_the_life() -> None:
    """The coarser refinement ended with another limit, before it came to this one."""
    settings = {"life": "limits", "life.until": "depth > 0.05 mm", "conventions": "refined"}
    scene = changed(pw.scenes.wear_times(), settings)
    both = (
        evenly_worn(10, 1.04e6, A=5e-11, C=4.5e-11),
        evenly_worn(40, 1.04e6, A=4.7e-11, C=4.9e-11),
    )
    life = life_result(scene, LifeProblem.of(scene), both)
    first = life.first
    assert first is not None
    assert life.step is not None
    assert (first.key, life.limits[0].step) == ("C.depth", None)
    assert (first.strokes, first.sampling, first.step) == (life.strokes, life.sampling, life.step)


@pytest.mark.parametrize("depth", [0.975, 0.979])
def test_life_ends_with_the_cycle_that_wears_through_the_clearance(depth: float) -> None:
    """Strokes are counted up to that cycle, within a block: Archard's rate stays."""
    surfaces = {"B": (np.full(120, depth * CLEARANCE), None)}
    life = life_of(replace(scene_of(1.5), surfaces=surfaces))
    assert life.ended == "worn"
    assert "more than the clearance" in life.message
    strokes, volume = life.curves["strokes"], life.curves["B.wear_volume"][:, 0]
    rates = np.diff(volume) / np.diff(strokes)
    assert rates[1:] == pytest.approx(rates[1], rel=1e-3, abs=0.0)
    assert life.strokes == strokes[-1]
    # Both replicates end within a block of two cycles.
    assert life.refinements[-1].cycles % 4 != 0


def fails_at(depth: float) -> Callable[..., Finding | None]:
    """Return an examination that finds something once a surface is so deep, m."""

    def examine(linkage: Linkage, recorder: Recorder, now: Condition) -> Finding | None:
        if recorder.surface_depth.max(initial=-np.inf) > depth:
            return Finding("state", "the state is no longer finite", now.time, "B", "")
        return None

    return examine


def test_failed_run_ends_a_life(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "examine", fails_at(0.01 * CLEARANCE))
    life = life_of(scene_of())
    assert life.ended == "worn"
    assert "no longer finite" in life.message
    assert 0.0 < life.limits[0].last < 0.011 * CLEARANCE
    monkeypatch.setattr(driver, "examine", fails_at(-1.0))
    with pytest.raises(pw.RunFailed, match="no longer finite"):
        pw.run(scene_of(), jobs=1)
