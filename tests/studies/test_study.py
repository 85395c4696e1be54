"""Studies: running variants side by side, going on with them, what is refused."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from endurance.sameness import folder_differences

import presswear as pw
from presswear.campaign.single import run_into
from presswear.recording.tracker import Progress, Tracker
from presswear.results.folder import ResultFolder
from presswear.results.result import load
from presswear.scene.catalog import wear_times
from presswear.scene.settings import changed
from presswear.studies.plan import Study, Variant, load_study, results_of, waiting
from presswear.studies.rows import run_study
from presswear.sweeps.store import Store
from presswear.tools.errors import InputError


def small(**settings: str) -> Study:
    """Two quick variants: one cycle each in the in-house solver, and one that fails at once."""
    # With fewer bins a single cycle may leave surfaces on which the next stage drives itself.
    short = replace(wear_times(), wear_updates=1, cycles=1, purpose="trajectory")
    base = changed(short, {"engine": "dae", "angles": "360", **settings})
    stops = changed(base, {"integrator": "rk4-paper"})
    variants = (Variant("one", "the first", base), Variant("stops", "the paper's step", stops))
    return Study("small", "Two variants", "Which?", variants)


class Hearing(Tracker):
    """Remembers which parts of variants it is told of."""

    def __init__(self) -> None:
        self.heard: list[tuple[str, float, str]] = []

    def variant(self, key: str, part: float, word: str) -> None:
        self.heard.append((key, part, word))


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Hearing]:
    """The small study's folder, and what was told."""
    folder, hearing = tmp_path_factory.mktemp("study") / "out", Hearing()
    run_study(small(), folder, 2, False, [hearing])
    return folder, hearing


@pytest.fixture
def folder(ran: tuple[Path, Hearing]) -> Path:
    return ran[0]


def test_every_variant_has_its_folder(ran: tuple[Path, Hearing]) -> None:
    folder, hearing = ran
    one, stops = (result for _, result in results_of(small(), folder))
    assert one is not None
    assert (one.status, len(one.stages)) == ("completed", 2)
    assert stops is not None
    assert stops.status == "failed"
    parts = [part for key, part, _ in hearing.heard if key == "one"]
    assert parts == sorted(parts)
    assert parts[-1] == 1.0
    assert ("stops", 1.0, stops.message) in hearing.heard


def test_resuming_keeps_what_is_finished(folder: Path) -> None:
    before = (folder / "one" / "result.json").stat().st_mtime_ns
    assert waiting(small(), folder, resume=True) == []
    run_study(small(), folder, 1, True)
    assert (folder / "one" / "result.json").stat().st_mtime_ns == before


def test_parts_of_a_study_share_a_folder_and_run_on_any_executor(
    folder: Path, tmp_path: Path
) -> None:
    """Each variant runs once, with the same numbers; what is there already is left alone."""
    again, on = tmp_path / "study", "concurrent.futures:ThreadPoolExecutor"
    assert set(pw.run(small(), again, jobs=1, on=on, shard="2/2")) == {"stops"}
    assert [variant.key for variant in waiting(small(), again, resume=True)] == ["one"]
    run_study(small(), again, 1, True, shard=(1, 2))
    for key in ("one", "stops"):
        assert folder_differences(again / key, folder / key) == []
    with Store(again) as store:
        assert len(store) == 2


def test_a_variant_whose_folder_was_taken_away_runs_again(folder: Path, tmp_path: Path) -> None:
    again = tmp_path / "study"
    shutil.copytree(folder, again)
    shutil.rmtree(again / "stops")
    run_study(small(), again, 1, True)
    assert folder_differences(again / "stops", folder / "stops") == []


def test_an_interrupted_variant_goes_on_where_it_stood(folder: Path, tmp_path: Path) -> None:
    again, study = tmp_path / "study", small()
    scene = study.variants[0].scene

    class Interrupts(Tracker):
        heard = 0

        def progress(self, progress: Progress) -> None:
            self.heard += progress.whole > 0.5
            if self.heard > 3:
                raise KeyboardInterrupt

    shutil.copytree(folder, again)
    shutil.rmtree(again / "one")
    with pytest.raises(KeyboardInterrupt):
        run_into(ResultFolder(again / "one", scene, 0.0), scene, [Interrupts()])
    assert list((again / "one").glob("checkpoint-*.npz"))
    assert [variant.key for variant in waiting(study, again, resume=True)] == ["one"]
    run_study(study, again, 1, True)
    assert folder_differences(again / "one", folder / "one") == []
    assert "resumed" in load(again / "one").provenance


def test_other_runs_in_the_folder_are_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="not empty"):
        waiting(small(), folder, resume=False)
    with pytest.raises(InputError, match=r"another study .one differs"):
        waiting(small(friction="0.3"), folder, resume=True)


def test_a_stored_study_is_the_same_study(folder: Path) -> None:
    assert load_study(folder) == small()
    with pytest.raises(InputError, match="no study"):
        load_study(folder / "one")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "cannot be read"),
        ('{"schema": 99}', "schema 99"),
        ('{"schema": 4}', "missing required field"),
    ],
)
def test_a_damaged_study_is_named(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "study.json").write_text(text)
    with pytest.raises(InputError, match=words):
        load_study(tmp_path)


def test_a_slow_engine_is_begun_first() -> None:
    """Or a process is left with it when the others are done."""
    base = small().variants[0].scene
    own, other = (Variant(word, "", replace(base, engine=word)) for word in ("dae", "exudyn"))
    assert other.extent > own.extent


def linked() -> Study:
    """A variant on the surfaces of another's last stage, and one on a stage that never comes."""
    base = small().variants[0].scene
    stops = small().variants[1].scene
    # Longer than what it waits for: the longest are begun first.
    alone = replace(base, wear_updates=0, cycles=21)
    assert Variant("on", "", alone).extent > Variant("base", "", base).extent
    variants = (
        Variant("base", "worn", base),
        Variant("stops", "the paper's step", stops),
        Variant("on", "on its surfaces", alone, "base:1"),
        Variant("never", "on what is never there", alone, "stops:1"),
    )
    return Study("linked", "Surfaces handed on", "Which?", variants)


@pytest.fixture(scope="module")
def linking(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Hearing]:
    """The folder of a study in which a variant begins on the surfaces of another."""
    folder, hearing = tmp_path_factory.mktemp("chain") / "out", Hearing()
    # Those on others are alone in their part, and run what they begin on first.
    run_study(linked(), folder, 2, False, [hearing], shard=(3, 4))
    assert [v.key for v in waiting(linked(), folder, resume=True)] == ["stops", "never"]
    run_study(linked(), folder, 2, True, [hearing])
    return folder, hearing


@pytest.fixture
def chain(linking: tuple[Path, Hearing]) -> Path:
    return linking[0]


def test_what_begins_on_surfaces_that_never_came_is_told_why(
    linking: tuple[Path, Hearing],
) -> None:
    told = ("never", 1.0, "stops never came to stage 1, on which it begins")
    assert told in linking[1].heard


def test_a_variant_begins_on_the_surfaces_of_another(chain: Path) -> None:
    base, _, on, never = (result for _, result in results_of(linked(), chain))
    assert base is not None
    assert on is not None
    assert never is None
    given, worn = on.stages[0].joints["A"], base.stages[1].joints["A"]
    assert given.depth("pin").tobytes() == worn.depth("pin").tobytes()
    assert given.depth("pin").any()
    assert on.scene.statuses["surfaces"] == "base:1"
    assert load_study(chain) == linked()
    assert [variant.key for variant in waiting(linked(), chain, resume=True)] == ["never"]
    run_study(linked(), chain, 1, True)


@pytest.mark.parametrize("on", ["base", "base:", "base:one", "nobody:1", "on:1", "never:0"])
def test_a_variant_on_what_is_not_before_it_is_refused(chain: Path, on: str) -> None:
    document = json.loads((chain / "study.json").read_text())
    document["variants"][2]["on"] = on
    other = chain.parent / f"other-{on.replace(':', '-')}"
    other.mkdir()
    (other / "study.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=f"on begins on '{on}'; KEY:STAGE of a variant before it"):
        load_study(other)


def test_a_study_on_other_surfaces_is_another_study(chain: Path) -> None:
    study = linked()
    changed_one = replace(study.variants[2], on="base:0")
    other = replace(study, variants=(*study.variants[:2], changed_one, study.variants[3]))
    with pytest.raises(InputError, match=r"another study .on differs"):
        waiting(other, chain, resume=True)
