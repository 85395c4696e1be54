"""Lives of scenes: what is asked for them, and what stops, ends or spoils them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

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
    SceneHistories,
    life_result,
)
from presswear.engines import driver
from presswear.linkage.linkage import Linkage
from presswear.recording.observer import Observer, Progress
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Condition, Finding
from presswear.scene.options import FOLLOWED, Life, Service
from presswear.scene.settings import changed

JOINTS = ("A", "B")
OF_JOINT = [name for name, own in FOLLOWED.items() if own.of_joint]


def lived(
    part: float = 0.02, *, share: float = 1.0, folder: Path | None = None, **life: Any
) -> pw.Result:
    """A bush worn until it has lost a part of its clearance, in two starts."""
    result = pw.run(asked(part, share, **life), folder, jobs=1)
    assert result.life is not None
    return result


def asked(part: float = 0.02, share: float = 1.0, **life: Any) -> pw.Scene:
    """The scene of such a life."""
    own = {"until": f"B.depth > {part * CLEARANCE!r} m", "at_most": 1e12, **life}
    return bush(
        share=share, life=Life(**own), replicates=2, wear_updates=1, cycles=3, tolerance=0.5
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A life that nothing stopped, in one process."""
    path = tmp_path_factory.mktemp("life") / "whole"
    lived(folder=path)
    return path


@given(
    st.sampled_from(sorted(FOLLOWED)),
    st.sampled_from(("", *JOINTS)),
    st.floats(1e-9, 1e6),
    st.text(" ", max_size=3),
)
def test_limits_are_read(name: str, joint: str, value: float, blank: str) -> None:
    """Of all joints where none is named; of the mechanism there is no joint to name."""
    unit = FOLLOWED[name].unit
    text = f"{blank}{joint + '.' if joint else ''}{name}{blank}>{blank}{value!r} {unit}{blank}"
    life = Life(until=text)
    if joint and name not in OF_JOINT:
        with pytest.raises(pw.InputError, match="is of the whole mechanism"):
            life.limits(JOINTS)
        return
    found = life.limits(JOINTS)
    assert [own.joint for own in found] == (
        [joint] if joint else list(JOINTS) if name in OF_JOINT else [""]
    )
    assert {own.value for own in found} == {value}


def test_one_start_has_no_interval() -> None:
    with pytest.raises(pw.InputError, match=r"^replicates = 1: .* allowed is 2 to 100$"):
        bush(life=Life(), wear_updates=1)


def test_starts_that_agree_are_a_life_without_chance(whole: Path) -> None:
    """Nothing but the step is left of its error."""
    life = pw.load(whole).life
    assert life is not None
    assert life.ended == "limit"
    assert life.sampling is not None
    assert life.step is not None
    assert life.sampling < 0.01 * life.step
    assert life.error == pytest.approx(life.step, rel=1e-4)
    depth = life.curves["B.depth"]
    assert np.all(np.diff(depth[:, 0]) > 0.0)
    # The limit lies where the curve passes it.
    at = np.interp(life.strokes, life.curves["strokes"], depth[:, 0])
    assert at == pytest.approx(0.02 * CLEARANCE, rel=1e-9, abs=0.0)


def test_no_number_depends_on_the_processes(whole: Path, tmp_path: Path) -> None:
    pw.run(pw.load(whole).scene, tmp_path / "two", jobs=2)
    assert folder_differences(whole, tmp_path / "two") == []


class Stops(Observer):
    """Interrupts a pass over a life once so much has been told of it."""

    def __init__(self, number: int, words: int) -> None:
        self.word, self.left = f"pass {number}", words

    def on_progress(self, progress: Progress) -> None:
        if self.word in progress.word:
            self.left -= 1
            if not self.left:
                raise KeyboardInterrupt


@pytest.mark.parametrize(("number", "words"), [(1, 3), (1, 12), (2, 2), (2, 30)])
def test_a_life_goes_on_where_it_stood(
    number: int, words: int, whole: Path, tmp_path: Path
) -> None:
    """Stopped in its first pass and its second, bit for bit."""
    scene, path = pw.load(whole).scene, tmp_path / "stopped"
    with pytest.raises(KeyboardInterrupt):
        pw.run(scene, path, observers=[Stops(number, words)], jobs=1)
    pw.run(scene, path, jobs=1)
    assert folder_differences(whole, path) == []


def curve(result: pw.Result) -> tuple[np.ndarray, np.ndarray]:
    """Strokes, and depth at B after them, m."""
    assert result.life is not None
    return result.life.curves["strokes"], result.life.curves["B.depth"][:, 0]


@pytest.mark.parametrize(
    ("service", "word"), [("replaced", "replaced"), ("turned", "turned by half")]
)
def test_a_bush_that_is_seen_to_lasts_as_long_again(service: str, word: str, whole: Path) -> None:
    """As it alone wears, and on one side: new or turned, what is loaded has lost nothing."""
    first = pw.load(whole).life
    assert first is not None
    at = 0.6 * first.strokes
    settings: dict[str, Any] = {service: f"B@{at!r}"}
    result = lived(**settings)
    assert result.life is not None
    assert result.life.services == (f"bushing of B {word} after {at:.4g} strokes",)
    assert result.life.strokes == pytest.approx(at + first.strokes, rel=0.05)
    strokes, depth = curve(result)
    k = int(np.flatnonzero(np.diff(strokes) == 0.0)[0])
    assert strokes[k] == pytest.approx(at, rel=1e-9, abs=0.0)
    before = depth[k]
    assert depth[k + 1] == (0.0 if service == "replaced" else before)


def test_a_new_bush_leaves_the_pin_and_a_turned_one_its_profile() -> None:
    """Replaced: depth 0 all around; turned: what it had, half a turn on."""
    scene = asked(share=0.5)
    joints = scene.linkage().clearances
    worn = np.random.default_rng(1).uniform(0.0, 1e-4, (2, 1, 2, joints[0].bins))
    chains = SceneHistories(
        cast(Any, SimpleNamespace(scene=scene)), np.zeros_like(worn), ("depth",)
    )
    last = LoadBlock(100.0, 4, 0, {}, {}, 1e-9, np.zeros(0), worn)
    new = chains.maintain(1, [last], Service("B", 100.0, False))
    turned = chains.maintain(1, [last], Service("B", 100.0, True))
    for own in (new, turned):
        assert (own.strokes, own.cycles, own.interval) == (100.0, 0, 1)
        assert np.array_equal(own.depth[:, :, 1], worn[:, :, 1])
    assert not new.depth[:, :, 0].any()
    assert new.levels["B.depth"] == pytest.approx(worn[:, 0, 1].max(axis=1))
    half = joints[0].bins // 2
    assert np.array_equal(turned.depth[:, 0, 0, half:], worn[:, 0, 0, :half])
    assert np.array_equal(turned.depth[:, 0, 0, :half], worn[:, 0, 0, half:])
    assert worn[:, 0, 0].any()


def test_a_limit_that_is_exceeded_when_new_is_refused() -> None:
    with pytest.raises(pw.InputError, match=r"'B.force_max > 1 N': it is exceeded when new"):
        lived(until="B.depth > 1 mm, force_max > 1 N")


def test_a_limit_that_is_not_reached_ends_with_the_strokes(whole: Path) -> None:
    """What is known is told: no life, but what was worn."""
    first = pw.load(whole).life
    assert first is not None
    at_most = 0.5 * first.strokes
    life = lived(at_most=at_most).life
    assert life is not None
    assert life.ended == "at_most"
    assert life.strokes == pytest.approx(at_most)
    assert life.first is None
    assert life.limits[0].last < 0.02 * CLEARANCE


def straight(cycles: int, strokes: float, **rates: float) -> Refinement:
    """A pass of two starts that wear evenly, apart by a hundredth."""
    apart, count = np.array([0.99, 1.01]), len(rates)
    blocks = []
    for k in range(cycles + 1):
        now = strokes * k / cycles
        depths = {f"{joint}.depth": rate * now * apart for joint, rate in rates.items()}
        volumes = {
            f"{joint}.wear_volume": 1e-6 * rate * now * apart for joint, rate in rates.items()
        }
        taken = np.full((count, 2, 8), 1e-12)
        blocks.append(LoadBlock(now, int(k > 0), 0, depths | volumes, {}, 1e-9, taken))
    return Refinement(1.0 / cycles, 1, tuple(blocks))


def test_the_first_limit_is_known_as_well_as_the_life() -> None:
    """Where a coarser pass ended with another limit, before it came to this one."""
    settings = {"life": "limits", "life.until": "depth > 0.05 mm", "conventions": "refined"}
    scene = changed(pw.scenes.wear_times(), settings)
    problem = LifeProblem.of(scene)
    passes = straight(10, 1.04e6, A=5e-11, C=4.5e-11), straight(40, 1.04e6, A=4.7e-11, C=4.9e-11)
    life = life_result(scene, problem, passes)
    first, other = life.first, life.limits[0]
    assert first is not None
    assert first.key == "C.depth"
    assert life.step is not None
    assert (first.strokes, first.sampling, first.step) == (life.strokes, life.sampling, life.step)
    assert other.step is None


@pytest.mark.parametrize("begun", [0.975, 0.979])
def test_what_is_worn_deeper_than_the_clearance_ends_there(begun: float) -> None:
    """Strokes are counted up to the cycle that did it, within a block: Archard's rate stays."""
    surfaces = {"B": (np.full(120, begun * CLEARANCE), None)}
    life = pw.run(replace(asked(1.5), surfaces=surfaces), jobs=1).life
    assert life is not None
    assert life.ended == "worn"
    assert "more than the clearance" in life.message
    strokes, volume = life.curves["strokes"], life.curves["B.wear_volume"][:, 0]
    rates = np.diff(volume) / np.diff(strokes)
    assert rates[1:] == pytest.approx(rates[1], rel=1e-3, abs=0.0)
    assert life.strokes == strokes[-1]
    # Both starts end within a block of two cycles, or nothing was tried.
    assert life.passes[-1].cycles % 4 != 0


def fails_at(depth: float) -> Callable[..., Finding | None]:
    """An examination that finds something once a surface is so deep, m."""

    def examine(linkage: Linkage, recorder: Recorder, now: Condition) -> Finding | None:
        if recorder.surface_depth.size and recorder.surface_depth.max() > depth:
            return Finding("state", "the state is no longer finite", now.time, "B", "")
        return None

    return examine


def test_a_run_that_fails_ends_a_life_with_what_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "examine", fails_at(0.01 * CLEARANCE))
    result = pw.run(asked(), jobs=1, check=False)
    assert result.life is not None
    assert result.life.ended == "worn"
    assert "no longer finite" in result.life.message
    assert 0.0 < result.life.limits[0].last < 0.011 * CLEARANCE


def test_a_run_that_fails_when_new_fails_the_life(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "examine", fails_at(-1.0))
    with pytest.raises(pw.RunFailed, match="no longer finite"):
        lived()
