"""What features cost: complete rows, ratios that follow from the times, no judging of times."""

import json
from dataclasses import replace
from pathlib import Path
from statistics import median

import pytest
from rich.console import Console

from presswear.__main__ import main
from presswear.commands.trials import print_text_table
from presswear.engines.base import Plan
from presswear.engines.exudyn_tree import engine
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.scene.catalog import scene_named
from presswear.tools.errors import InputError, RunFailed
from presswear.trials.costs import study as costs_study
from presswear.trials.costs.equal_work import FIXED, FIXED_STEP, check_fixed, equal_work
from presswear.trials.costs.features import SWITCHES, deepest, plan_of, timed_run, wear_once
from presswear.trials.costs.profile import call_costs, profile, record
from presswear.trials.costs.study import Costs, CostsExtent, store, study
from presswear.trials.costs.tables import markdown_of, tables_of
from presswear.trials.timing import Timing, model_of, time_runs

SHORT = CostsExtent(
    repeats=2,
    tree_cycles=0.05,
    joints_cycles=0.02,
    profile_cycles=0.05,
    wear_cycles=1,
    equal_time=0.0105,
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


def test_engines_are_complete_and_compared_with_fixed_steps(found: Costs) -> None:
    work = found.engines
    names = [row.timing.name for row in work.rows]
    assert len(names) == len(set(names)) == 7
    assert sum(name.startswith("tree") for name in names) == 4
    assert work.touchdowns == 1
    for row in work.rows:
        assert row.faster == pytest.approx(work.fixed.timing.per_second / row.timing.per_second)
        # No more than the clearance: it is the same motion.
        assert 0.0 <= row.slider_error < 1e-4
    errors = [row.touchdown_error for row in work.rows if "tolerance 1e-10" in row.timing.name]
    assert errors[0] < 1e-8


def test_fixed_steps_are_all_of_one_length() -> None:
    plan = Plan(3e-3, 1, 1, torques=False)
    timed = replace(timed_run("fixed", JOINTS, 1.0), engine=FIXED, plan=plan)
    rows = timed.run().recorder.book.record
    assert int(rows["steps"][0]) == 3001  # the start is one
    timing = time_runs([timed], 1, silent)[0]
    assert timing.steps * FIXED_STEP == pytest.approx(timing.simulated, rel=1e-12)
    check_fixed(timing)
    for broken in (replace(timing, steps=timing.steps + 1), replace(timing, sent_back=1)):
        with pytest.raises(RunFailed, match="1e-06"):
            check_fixed(broken)


def test_an_end_without_touches_has_no_touchdown_error() -> None:
    work = equal_work(scene_named("wear-times"), 1e-5, 1, silent)
    assert work.touchdowns == 0
    assert work.tree.touchdown_error == 0.0


def test_stages_add_up_to_the_run(found: Costs) -> None:
    assert list(found.profiles) == ["unworn", "worn"]
    for each in found.profiles.values():
        assert sum(part.seconds for part in each.parts) == pytest.approx(each.timing.wall)
        assert each.calls >= 6 * each.timing.attempts
        assert each.share_of("Exudyn", "Python", "kernel") == pytest.approx(1.0)
        assert each.largest_python.kind == "Python"
        assert {part.kind for part in each.parts} == {"Exudyn", "Python", "kernel"}


def test_a_profile_leaves_the_engine_as_it_was() -> None:
    before = dict(vars(engine))
    profile(SHORTEST, 1, silent)
    assert dict(vars(engine)) == before


def test_recording_does_not_change_a_run() -> None:
    run = SHORTEST.run()
    stages, steps = record(SHORTEST)
    assert len(steps.time) == int(run.diagnostics["steps"]) + 1
    assert steps.time[-1] == pytest.approx(run.time)
    assert len(stages.time) > int(run.diagnostics["evaluations"])


def test_what_a_call_takes_is_known_for_the_tree_only() -> None:
    with pytest.raises(InputError, match="no run of the open tree"):
        call_costs(timed_run("joints", JOINTS, 0.01))


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
    for words in ("fair measure", "Python as such takes", "times faster"):
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
    assert document["engines"]["passed"] == found.engines.passed
    for each in document["profiles"].values():
        assert sum(part["share"] for part in each["parts"]) == pytest.approx(1.0)


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
    assert "Engines at equal work" in capsys.readouterr().out
    assert main(["costs", "--out", str(folder)]) == 2
    assert "not empty" in capsys.readouterr().err


def test_repeats_that_take_other_steps_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = [SHORTEST.run(), replace(SHORTEST, plan=plan_of(0.5, 0.005)).run()]
    monkeypatch.setattr(type(SHORTEST), "run", lambda self: runs.pop(0))
    with pytest.raises(RunFailed, match="other steps"):
        time_runs([SHORTEST], 2, silent)
