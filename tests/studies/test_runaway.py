"""The study ``runaway``: its readings, its answer, and its script."""

import math
import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from presswear.__main__ import main
from presswear.campaign.single import run_scene
from presswear.scene.catalog import wear_times
from presswear.scene.settings import changed
from presswear.studies import STUDIES
from presswear.studies.plan import Variant, load_study, results_of
from presswear.studies.runaway.report import (
    TwoWears,
    answer,
    contacts_compared,
    draw_wears,
    read_same,
    read_wears,
)
from presswear.studies.runaway.variants import LONGER, make
from presswear.tools.numbers import with_interval

SCRIPT = Path(__file__).parents[2] / "scenarios" / "runaway.py"


def outcome(label: str, first: float, second: float, failure: str = "") -> TwoWears:
    variant = Variant(label, label, wear_times())
    one, other = (
        {"A": np.full(4, depth) if depth > 0.0 else np.zeros(0)} for depth in (first, second)
    )
    return TwoWears(variant, one, other, (100.0,), 1e-9, failure)


def test_the_answer_names_what_runs_away_and_what_stops() -> None:
    calm, away = outcome("calm", 1e-5, 2e-5), outcome("wild", 1e-5, 3e-4)
    stopped = outcome("broken", math.nan, math.nan, "it stopped")
    assert (calm.away, away.away, stopped.growth.size) == (0, 4, 0)
    text = answer([calm, away, stopped], 8e-4)
    assert "1 of 2 readings" in text
    assert "from none of 4 starts: as a median it adds 2 to 2 times" in text
    # Of a probability with nothing but successes the interval has an end of its own.
    assert "wild, 4 of 4 (51 to 100 %), up to 30 times the first and 300 µm" in text
    assert "Not to be computed at all: broken" in text
    assert "runs away from some" not in answer([calm], 8e-4)
    assert "nothing can be said" in answer([stopped], 8e-4)


def test_outcomes_are_read_from_results() -> None:
    short = changed(
        replace(wear_times(), wear_updates=1, cycles=1, replicates=1),
        {"engine": "dae", "angles": "360"},
    )
    result = run_scene(short)
    one = read_wears(Variant("one", "", short), result)
    for wear, stage in zip((one.first, one.second), result.stages, strict=True):
        for name, joint in stage.joints.items():
            deepest = max(joint.wear(side).max() for side in ("bearing", "pin"))
            assert wear[name].shape == (1,)
            assert wear[name][0] == deepest > 0.0
    paper_step = changed(short, {"integrator": "rk4-paper"})
    stops = read_wears(Variant("stops", "", paper_step), run_scene(paper_step, check=False))
    assert stops.growth.size == 0
    assert "t = " in stops.failure


def test_runaway_changes_one_thing_at_a_time_and_only_what_it_says() -> None:
    study = make()
    assert study.name in STUDIES
    paper = study.variants[0].scene
    keys = [variant.key for variant in study.variants]
    assert len(set(keys)) == len(keys)
    for variant in study.variants[1:5]:
        scene = variant.scene
        changes = [
            getattr(scene.conventions, name) != getattr(paper.conventions, name)
            for name in ("stiffness", "slip", "map_frame", "wear_distribution", "contact")
        ]
        assert sum(changes) + (scene.extrapolation != paper.extrapolation) == 1
    for variant in study.variants:
        # The second wear in steps needs the stage behind it.
        wear_updates = 2 if variant.scene.wears_in_steps or variant.key == LONGER else 1
        assert variant.scene.wear_updates == (0 if variant.on else wear_updates)


def test_both_contacts_run_on_the_surfaces_of_one_run() -> None:
    study = make()
    same = [variant for variant in study.variants if variant.on]
    assert [(one.on, one.scene.conventions.contact) for one in same] == [
        (f"{LONGER}:{stage}", contact) for stage in (1, 2) for contact in ("radial", "foundation")
    ]
    (source,) = (variant.scene for variant in study.variants if variant.key == LONGER)
    assert (source.cycles, source.replicates, source.wear_updates) == (200, 1, 2)
    for one in same:
        alike = replace(one.scene.conventions, contact="radial")
        assert alike == source.conventions


def test_what_both_contacts_make_is_told_from_results() -> None:
    scene = changed(
        replace(wear_times(), wear_updates=0, cycles=4, replicates=2),
        {"engine": "dae", "integrator": "dopri5", "integration_tolerance": 1e-6},
    )
    scene = replace(scene, surfaces={"A": (1e-5 * (1.0 + np.sin(np.arange(360))), None)})
    variant = Variant("on", "after the first wear, radial", scene, "longer:1")
    result = run_scene(scene)
    told, joint = result.stages[0].statistics, result.stages[0].joints["A"].statistics
    one = read_same(variant, result)
    force = joint["force_max_per_cycle_N"]
    assert one.force == (force["mean"], force["half_width"])
    text = contacts_compared([one, read_same(variant, None)])
    assert text.count("after the first wear, radial: ") == 1
    assert f"{with_interval(*one.force)} N at A" in text
    made = told["energy_made_per_cycle_J"]
    row = one.row()
    assert row[2] == with_interval(1e3 * made["mean"], 1e3 * made["half_width"])
    assert contacts_compared([read_same(variant, None)]) == ""
    assert "never reached" in read_same(variant, None).row()[-1]


def test_words_stand_within_the_figure() -> None:
    same = [read_same(Variant("on", "on it", wear_times(), "longer:1"), None)]
    outcomes = [outcome("calm", 1e-5, 2e-5), outcome("broken", 0.0, 0.0, "it stopped")]
    sheet = draw_wears(outcomes, same, 8e-4).sheet
    sheet.draw_without_rendering()
    words = [text for axes in sheet.axes for text in axes.texts if text.get_text() == "stopped"]
    assert len(words) == 3
    for word in words:
        assert word.axes is not None
        inside, place = word.axes.get_window_extent(), word.get_window_extent()
        assert inside.x0 < place.x0 < place.x1 < inside.x1
        assert inside.y0 < place.y0 < place.y1 < inside.y1


def test_the_script_runs_and_its_study_can_be_gone_on_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "runaway"
    quick = {"engine": "dae", "cycles": 1, "replicates": 1, "cycles_per_update": 1e5, "speed": 60.0}
    runpy.run_path(str(SCRIPT))["main"](str(folder), **quick)
    said = capsys.readouterr().out
    assert "of 20 readings that can be computed" in said
    assert f"report: {folder / 'report.html'}" in said
    study = load_study(folder)
    assert [v.key for v, result in results_of(study, folder) if result is None] == []
    page = (folder / "report.html").read_text()
    assert page.count("<figure>") == 1
    assert "The same surfaces under both contacts: after the first wear, radial" in page
    assert "a wear stands for 0.1 million" in page
    assert all(variant.label in page for variant in study.variants)
    assert main(["run", "runaway", "--resume", "--out", str(folder)]) == 0
    assert (folder / "report.html").read_text() == page
