"""What features cost: complete rows, ratios that follow from the times, no judging of times."""

import json
from dataclasses import replace
from pathlib import Path
from statistics import median

import pytest
from rich.console import Console

from presswear.__main__ import main
from presswear.cli.trials import print_text_table
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.scene.catalog import scene_named
from presswear.tools.errors import RunFailed
from presswear.validation.costs import study as costs_study
from presswear.validation.costs.features import SWITCHES, deepest, plan_of, timed_run, wear_once
from presswear.validation.costs.side_by_side import HAND, LEVELS, TREE
from presswear.validation.costs.study import Costs, CostsExtent, store, study
from presswear.validation.costs.tables import markdown_of, tables_of
from presswear.validation.timing import Timing, model_of, time_runs

SHORT = CostsExtent(
    repeats=2,
    tree_cycles=0.05,
    joints_cycles=0.02,
    wear_cycles=1,
    short=0.0105,
    long=0.02,
)
JOINTS = replace(scene_named("wear-times"), engine=ExudynJoints.word)
SHORTEST = timed_run("short", scene_named("wear-times"), 0.01)


def silent(name: str, part: float) -> None:
    """No progress."""


@pytest.fixture(scope="module")
def told() -> list[tuple[str, float]]:
    return []


@pytest.fixture(scope="module")
def found(told: list[tuple[str, float]]) -> Costs:
    return study(scene_named("wear-times"), SHORT, lambda name, part: told.append((name, part)))


def test_every_feature_has_its_rows(found: Costs) -> None:
    chosen, tree, joints = ([(row.feature, row.state) for row in t.rows] for t in found.features)
    clearances = [("clearance", state) for state in ("none", "A", "C", "A and C")]
    switches = [(feature, state) for feature, _, _ in SWITCHES for state in ("off", "on")]
    assert chosen == clearances
    assert tree == switches
    assert joints == clearances + switches
    assert {row.timing.model for row in found.features[1].rows} == {"tree 4"}
    models = [row.timing.model for row in found.features[2].rows]
    assert all(model.startswith("joints ") for model in models)
    assert models[:4] == ["joints 18 + 18", "joints 15 + 13", "joints 6 + 4", "joints 15 + 11"]


def test_ratios_follow_from_the_medians(found: Costs) -> None:
    for table in found.features:
        without: dict[str, Timing] = {}
        for row in table.rows:
            own = row.timing
            off = without.setdefault(row.feature, own)
            assert (row.state in ("off", "none")) == (own is off)
            assert len(own.walls) in (SHORT.repeats, SHORT.joints_repeats)
            assert own.per_step * (own.steps + own.sent_back) == pytest.approx(median(own.walls))
            assert row.step_ratio == pytest.approx(own.per_step / off.per_step)
            assert row.wall_ratio == pytest.approx(own.per_second / off.per_second)
            low, high = own.ends
            assert low <= own.wall <= high


def test_a_switch_changes_what_is_modelled(found: Costs) -> None:
    rows = {(row.feature, row.state): row.timing for row in found.features[1].rows}
    # Neither the account of wear nor stored torques change the motion, so the steps agree.
    for feature in ("wear account", "torques stored"):
        assert rows[feature, "off"].steps == rows[feature, "on"].steps
    assert rows["worn surfaces", "on"].steps != rows["worn surfaces", "off"].steps
    assert rows["friction", "on"].steps != rows["friction", "off"].steps


def test_all_methods_are_run_side_by_side(found: Costs) -> None:
    beside = found.side_by_side
    names = [method.name for method in beside.methods]
    assert names[:5] == [TREE, "dae, DOPRI5", "dae, DOP853", "exudyn-joints", HAND]
    assert {"by hand, LSODA", "by hand, DOP853", "by hand, Radau"} < set(names)
    assert len(names) + len(beside.missing) == 10
    assert beside.touches == 1
    for method in beside.methods:
        assert [own.failure for own in method.settings] == [""] * len(method.settings)
        assert all(len(own.seconds) == SHORT.repeats for own in method.settings)
        # No more than the clearance: it is the same motion.
        assert all(own.error is not None and own.error < 1e-3 for own in method.settings)
        for level, error in zip(method.levels, LEVELS, strict=True):
            assert level is None or level.error == error
            assert level is None or level.long is None or level.long.value == level.value
    by_name = {method.name: method for method in beside.methods}
    assert beside.units[0] in by_name[TREE].settings
    assert beside.units[1].value == beside.units[0].value
    finest = by_name[HAND].settings[-1]
    assert finest.steps == pytest.approx(1.0 / finest.value)
    assert finest.evaluations == 4.0 * finest.steps


def test_worn_surfaces_come_from_a_wear() -> None:
    scene = scene_named("wear-times")
    depths = deepest(scene, wear_once(scene, 1))
    assert sorted(depths) == ["A", "C"]
    assert all(1e-6 < depth < 1e-3 for depth in depths.values())


def test_models_plans_and_medians() -> None:
    scene = scene_named("wear-times")
    assert model_of(scene.linkage(), scene.solver.over(scene.mechanism.period)) == "tree 4"
    assert model_of(scene.linkage(), InHouse()) == "dae 18 + 14"
    whole, part = plan_of(0.5, 2.0), plan_of(0.5, 0.1)
    assert (whole.cycle, whole.cycles, whole.recorded_cycles) == (0.5, 2, 2)
    assert (part.cycle, part.cycles) == (0.05, 1)
    timing = Timing("case", "tree 4", 2.0, 90, 10, None, (1.0, 2.0, 9.0))
    assert (timing.wall, timing.ends, timing.attempts) == (2.0, (1.0, 9.0), 100)
    assert (timing.per_second, timing.per_step) == (1.0, 0.02)


def test_progress_rises_to_the_end(found: Costs, told: list[tuple[str, float]]) -> None:
    parts = [part for _, part in told]
    assert parts == sorted(parts)
    assert parts[0] == 0.0
    assert parts[-1] == 1.0


def test_markdown_and_terminal_hold_every_row(
    found: Costs, capsys: pytest.CaptureFixture[str]
) -> None:
    text = markdown_of(found)
    assert found.processor in text
    console = Console(width=80)
    for table in tables_of(found):
        assert f"## {table.title}" in text
        width = len(table.texts) + len(table.numbers)
        for row in table.rows:
            assert len(row) == width
            assert f"| {' | '.join(row)} |" in text
        assert all(sentence in text for sentence in table.sentences)
        print_text_table(console, table)
    assert "…" not in capsys.readouterr().out
    for words in ("fair measure", "The in-house solver takes, of the loop by hand"):
        assert words in text


def test_both_files_hold_what_was_measured(found: Costs, tmp_path: Path) -> None:
    store(found, "# tables\n", tmp_path / "new")
    assert (tmp_path / "new" / "costs.md").read_text() == "# tables\n"
    document = json.loads((tmp_path / "new" / "costs.json").read_text())
    assert document["provenance"]["packages"]["exudyn"]
    assert document["processor"]
    row = document["features"][1]["rows"][3]
    assert row["feature"] == "worn surfaces"
    timing = row["timing"]
    steps = timing["steps"] + timing["sent_back"]
    assert timing["per_step"] == pytest.approx(median(timing["walls"]) / steps)
    units = document["side_by_side"]["units"]
    assert [unit["cost"] for unit in units] == [unit.cost for unit in found.side_by_side.units]


def test_the_command_prints_and_stores(
    found: Costs,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    extents = []

    def measured(scene: object, extent: CostsExtent, progress: object) -> Costs:
        extents.append(extent)
        return found

    monkeypatch.setattr(costs_study, "study", measured)
    folder = tmp_path / "costs"
    assert main(["costs", "--quick", "--repeats", "3", "--out", str(folder)]) == 0
    assert extents == [replace(costs_study.QUICK, repeats=3)]
    assert sorted(path.name for path in folder.iterdir()) == ["costs.json", "costs.md"]
    assert "Same work, side by side" in capsys.readouterr().out
    assert main(["costs", "--out", str(folder)]) == 2
    assert "not empty" in capsys.readouterr().err


def test_repeats_that_take_other_steps_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = [SHORTEST.run(), replace(SHORTEST, plan=plan_of(0.5, 0.005)).run()]
    monkeypatch.setattr(type(SHORTEST), "run", lambda self: runs.pop(0))
    with pytest.raises(RunFailed, match="other steps"):
        time_runs([SHORTEST], 2, silent)
