"""The study ``runaway``: its readings, its answer, and its script."""

import math
import runpy
from dataclasses import replace
from pathlib import Path

import pytest

from presswear.__main__ import main
from presswear.campaign.single import run_scene
from presswear.campaign.study import Variant, load_study, results_of
from presswear.scene.catalog import wear_times
from presswear.scene.settings import changed
from presswear.studies import STUDIES
from presswear.studies.runaway.report import TwoWears, answer, read_wears
from presswear.studies.runaway.variants import make

SCRIPT = Path(__file__).parents[2] / "scenarios" / "runaway.py"


def outcome(label: str, first: float, second: float, failure: str = "") -> TwoWears:
    variant = Variant(label, label, wear_times())
    return TwoWears(variant, {"A": first}, {"A": second}, (100.0,), 1e-9, failure)


def test_the_answer_names_what_runs_away_and_what_stops() -> None:
    calm, away = outcome("calm", 1e-5, 2e-5), outcome("wild", 1e-5, 3e-4)
    stopped = outcome("broken", math.nan, math.nan, "it stopped")
    assert (calm.runs_away, away.runs_away, stopped.runs_away) == (False, True, None)
    text = answer([calm, away, stopped], 8e-4)
    assert "1 of 2 readings" in text
    assert "does run away under: wild (300 µm, 30 times the first)" in text
    assert "Not to be computed at all: broken" in text
    assert "run away under" not in answer([calm], 8e-4)
    assert "nothing can be said" in answer([stopped], 8e-4)


def test_outcomes_are_read_from_results() -> None:
    short = changed(replace(wear_times(), wears=1, cycles=1), {"engine": "dae", "angles": "16"})
    result = run_scene(short)
    one = read_wears(Variant("one", "", short), result)
    for wear, stage in zip((one.first, one.second), result.stages, strict=True):
        for name, joint in stage.joints.items():
            assert wear[name] == max(joint.wear(side).max() for side in ("bearing", "pin")) > 0.0
    paper_step = changed(short, {"integrator": "rk4-paper"})
    stops = read_wears(Variant("stops", "", paper_step), run_scene(paper_step, check=False))
    assert math.isnan(stops.growth)
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
            for name in ("stiffness", "slip", "map_frame", "footprint", "contact")
        ]
        assert sum(changes) + (scene.extrapolation != paper.extrapolation) == 1
    for variant in study.variants:
        # The second wear in steps needs the stage behind it.
        assert variant.scene.wears == (2 if variant.scene.wears_in_steps else 1)


def test_the_script_runs_and_its_study_can_be_gone_on_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "runaway"
    quick = {"engine": "dae", "cycles": 1, "represented_cycles": 1e5, "speed": 60.0}
    runpy.run_path(str(SCRIPT))["main"](str(folder), **quick)
    said = capsys.readouterr().out
    assert "of 15 readings that can be computed" in said
    assert f"report: {folder / 'report.html'}" in said
    study = load_study(folder)
    assert [v.key for v, result in results_of(study, folder) if result is None] == []
    page = (folder / "report.html").read_text()
    assert page.count("<figure>") == 1
    assert "a wear stands for 0.1 million" in page
    assert all(variant.label in page for variant in study.variants)
    assert main(["run", "runaway", "--resume", "--out", str(folder)]) == 0
    assert (folder / "report.html").read_text() == page
