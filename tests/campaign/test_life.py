"""Service lives of a bushing: histories, readings, maintenance, and how lives end."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import shutil
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bush import CLEARANCE as GAP
from bush import COEFFICIENT, bush
from endurance.sameness import folder_differences
from refusals import refused

import presswear as pw
from campaign.fake_engine import Stops
from campaign.known_wear import DEPTH, load_block, problem
from presswear.campaign.life_result import life_by_rate
from presswear.campaign.refinement import Refinement
from presswear.campaign.service_life import FIRST_WEAR
from presswear.engines import driver
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Condition, Finding
from presswear.scene.settings import changed
from presswear.show.report import render_report

pytestmark = pytest.mark.usefixtures("unwatched")


def scene_of(part: float = 0.02, share: float = 1.0, **life: Any) -> pw.Scene:
    """Return a bushing worn until it has lost a part of its clearance, two replicates."""
    settings: dict[str, Any] = {"until": f"B.depth > {part * GAP!r} m", "at_most": 1e12}
    limits = pw.Life(**settings | life)
    return bush(
        share=share, life=limits, replicates=2, wear_updates=1, cycles=3, tolerance=0.5
    )


def life_of_scene(scene: pw.Scene) -> Any:
    return pw.run(scene, jobs=1, check=False).life


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("life") / "whole"
    return path, pw.run(scene_of(), path, jobs=1).life


def test_scenes_without_a_life_are_refused():
    with refused(r"^replicates = 1 does not fit \[life\]: use 2 to 100"):
        bush(life=pw.Life(), wear_updates=1)
    with refused(r"'B.force_max > 1 N': it is exceeded when new"):
        life_of_scene(scene_of(until="B.depth > 1 mm, force_max > 1 N"))
    with refused(r"'B.depth > 2.1 mm': allowed is below 2 mm, with wear"):
        scene_of(2.1)
    with refused(r"> 5.5 mm': allowed is below 5 mm, with"):
        scene_of(until="B.clearance > 5.5 mm")
    says = (
        r"joint B wears by 2.00 mm, the most that the model holds for, after .* "
        r"no limit is exceeded before .*; choose"
    )
    with refused(says):
        life_of_scene(scene_of(until="wear_volume > 1 m^3"))


def test_equal_replicates_leave_the_error_of_the_step(whole):
    life = whole[1]
    assert life.ended == "limit"
    assert life.sampling < 0.01 * life.step
    assert life.error == pytest.approx(life.step, rel=1e-4)
    depth = life.curves["B.depth"][:, 0]
    assert np.all(np.diff(depth) > 0.0)
    at = np.interp(life.strokes, life.curves["strokes"], depth)
    assert at == pytest.approx(0.02 * GAP, rel=1e-9, abs=0.0)


def test_wear_steps_of_a_life_are_its_blocks(whole):
    """Each of their cycles stands for as many strokes as their factor, in both replicates."""
    steps = pw.load(whole[0]).stages[0].wear_steps
    first = FIRST_WEAR / COEFFICIENT
    assert steps[0].cycles == 4
    assert steps[0].factor == pytest.approx(first, rel=1e-15, abs=0.0)
    assert sum(step.factor * step.cycles / 2 for step in steps) == pytest.approx(
        whole[1].strokes
    )


def test_no_number_depends_on_the_processes(whole, tmp_path):
    pw.run(pw.load(whole[0]).scene, tmp_path / "two", jobs=2)
    assert folder_differences(whole[0], tmp_path / "two") == []


def test_the_life_by_the_last_rate_is_a_straight_line():
    """Depths of 1 and 3 um after 100,000 and 200,000 strokes."""
    scene = scene_of()
    levels = [{"A.depth": np.full(8, depth)} for depth in (1e-6, 3e-6)]
    blocks = [load_block(1e5 * (k + 1), 8, levels[k], 2e-11) for k in range(2)]
    refinements = [Refinement(5e-3, 8, tuple(blocks))]
    life = life_by_rate(scene, problem(DEPTH), refinements)
    expected = 2e5 + 1e5 * (DEPTH.value - 3e-6) / 2e-6
    assert life.strokes == life.limits[0].strokes == pytest.approx(expected)
    assert life.error is None
    assert "by the wear rate after 200\u202f000 strokes" in f"{life}"
    assert "which mostly falls as surfaces run in: the life is then longer" in f"{life}"
    early = problem(DEPTH, at_most=0.5 * expected)
    assert life_by_rate(scene, early, refinements) is None
    still = [Refinement(5e-3, 8, (blocks[1], replace(blocks[1], strokes=3e5)))]
    assert life_by_rate(scene, problem(DEPTH), still) is None


@pytest.mark.parametrize(
    ("depth", "words"),
    [
        (4e-6, "50 % lower than at first: while this rate falls, the life is longer"),
        (
            6.5e-6,
            "75 % higher than at first: while this rate rises, the life is shorter",
        ),
        (
            5.01e-6,
            "which has not changed yet, with an unknown error; refinement 1 runs",
        ),
    ],
)
def test_a_life_by_a_rate_states_how_the_rate_has_changed(depth, words):
    """Depths of 1, 3 and 5 um would be a steady rate."""
    scene = scene_of()
    levels = [{"A.depth": np.full(8, value)} for value in (1e-6, 3e-6, depth)]
    blocks = [load_block(1e5 * (k + 1), 8, levels[k], 2e-11) for k in range(3)]
    refinements = [Refinement(5e-3, 8, tuple(blocks))]
    assert words in f"{life_by_rate(scene, problem(DEPTH), refinements)}"


@pytest.mark.parametrize(("number", "reports"), [(1, 3), (2, 30)])
def test_interrupted_life_resumes_bit_for_bit(number, reports, whole, tmp_path):
    scene = pw.load(whole[0]).scene
    path = tmp_path / "stopped"
    with pytest.raises(KeyboardInterrupt):
        pw.run(scene, path, observers=[Stops(f"refinement {number}", reports)], jobs=1)
    pw.run(scene, path, jobs=1)
    assert folder_differences(whole[0], path) == []


def test_life_is_inversely_proportional_to_the_wear_coefficient(whole):
    """A motion without chaos wears the same surfaces one after another."""
    tenfold = {"B.wear_coefficient": f"{10.0 * COEFFICIENT!r}/Pa"}
    life = life_of_scene(changed(pw.load(whole[0]).scene, tenfold))
    assert 10.0 * life.strokes == pytest.approx(whole[1].strokes, rel=1e-6, abs=0.0)
    # Readings of these joints tell their coefficient and the strokes that they have left.
    strokes = life.curves["strokes"]
    depth = life.curves["B.depth"][:, 0]
    readings = [
        pw.results.Reading("B", float(strokes[k]), "depth", float(depth[k]), 1e-8)
        for k in (len(strokes) // 3, len(strokes) // 2)
    ]
    left = pw.results.remaining_life(pw.load(whole[0]), readings)
    factor = left.joints[0].factor
    assert factor.mean == pytest.approx(10.0, rel=1e-3)
    expected = life.strokes - readings[-1].strokes
    assert left.remaining.mean == pytest.approx(expected, rel=0.01)
    assert left.remaining.low < expected < left.remaining.high


def test_readings_of_a_stored_life(whole, tmp_path, command):
    """Nothing is run, and a later report has the lines that are printed."""
    folder = tmp_path / "life"
    file = tmp_path / "readings.csv"
    shutil.copytree(whole[0], folder)
    at = 0.25 * whole[1].strokes
    file.write_text(f"joint,strokes,depth (um),error (um)\nB,{at},6,0.5\n")
    line = f"life {folder} --readings {file} --no-report"
    output = command(line)
    assert f"results in {folder}\nremaining life: " in output
    assert (folder / "readings.csv").read_bytes() == file.read_bytes()
    page = render_report(pw.load(folder)).replace("\xa0", " ")
    printed = [line for line in output.splitlines() if line.startswith(("rem", "B: "))]
    assert len(printed) == 2
    assert [line for line in printed if line not in page] == []
    assert "cannot be combined with --replace" in command(f"{line} --rotate B@1e3", 2)
    file.write_text("joint,strokes,depth (um)\nB,1e6,6\n")
    assert "1 without an error" in command(line, 2)
    (folder / "readings.csv").write_text("joint\n")
    assert "readings.csv: it has no rows" in render_report(pw.load(folder))


@pytest.mark.parametrize(
    ("key", "word"), [("replaced", "replaced"), ("rotated", "rotated by half a turn")]
)
def test_maintenance_adds_a_life(key, word, whole):
    """It alone wears, and on one side: new or rotated, the loaded side has lost nothing."""
    at = 0.6 * whole[1].strokes
    settings: dict[str, Any] = {key: f"B@{at!r}"}
    life = life_of_scene(scene_of(**settings))
    assert life.services == (f"bushing of B {word} after {at:.4g} strokes",)
    assert life.strokes == pytest.approx(at + whole[1].strokes, rel=0.05)
    strokes = life.curves["strokes"]
    depth = life.curves["B.depth"][:, 0]
    k = int(np.flatnonzero(np.diff(strokes) == 0.0)[0])
    assert strokes[k] == pytest.approx(at, rel=1e-9, abs=0.0)
    assert depth[k + 1] == (0.0 if key == "replaced" else depth[k])


def test_a_replaced_bushing_runs_in_again_under_a_power_of_the_pressure():
    """Only the bushing wears, so that the course after the service is that when new."""
    law = {"running_in": 20.0, "running_in_depth": "4 um"}
    law |= {"pressure_exponent": 0.7, "pressure_reference": "1 MPa"}
    at = 5e4
    life = life_of_scene(changed(scene_of(replaced=f"B@{at}"), law))
    strokes = life.curves["strokes"]
    depth = life.curves["B.depth"][:, 0]
    k = int(np.flatnonzero(np.diff(strokes) == 0.0)[0])
    assert depth[k + 1] == 0.0
    levels = np.linspace(2e-6, 0.9 * depth[k], 6)
    before = np.interp(levels, depth[: k + 1], strokes[: k + 1])
    after = np.interp(levels, depth[k + 1 :], strokes[k + 1 :]) - at
    np.testing.assert_allclose(after, before, rtol=0.01)
    # Surfaces that run in wear the first of these depths several times as fast.
    assert before[1] - before[0] < 0.5 * (before[-1] - before[-2])


def test_life_ends_with_the_cycle_that_wears_through_the_clearance():
    """Strokes are counted up to that cycle, within a block: Archard's rate stays."""
    surfaces = {"B": (np.full(120, 0.973 * GAP), None)}
    scene = scene_of(until="wear_volume > 1 m^3")
    radial = replace(scene.conventions, contact="radial")
    life = life_of_scene(replace(scene, conventions=radial, surfaces=surfaces))
    assert life.ended == "worn"
    assert "more than 1.00 mm, with a clearance of 1.00 mm" in life.message
    strokes = life.curves["strokes"]
    volume = life.curves["B.wear_volume"][:, 0]
    rates = np.diff(volume) / np.diff(strokes)
    assert rates[1:] == pytest.approx(rates[1], rel=1e-3, abs=0.0)
    assert life.strokes == strokes[-1]
    # Both replicates end within a block of two cycles.
    assert life.refinements[-1].cycles % 4 != 0


def fails_at(depth: float) -> Callable[..., Finding | None]:
    """Return an examination that finds something once a surface is so deep, m."""

    def examine(
        linkage: pw.linkage.Linkage, recorder: Recorder, now: Condition
    ) -> Finding | None:
        if recorder.surface_depth.max(initial=-np.inf) > depth:
            return Finding("state", "the state is no longer finite", now.time, "B", "")
        return None

    return examine


def test_failed_run_ends_a_life(monkeypatch):
    monkeypatch.setattr(driver, "examine", fails_at(0.01 * GAP))
    life = life_of_scene(scene_of())
    assert life.ended == "worn"
    assert "no longer finite" in life.message
    assert 0.0 < life.limits[0].last < 0.011 * GAP
    monkeypatch.setattr(driver, "examine", fails_at(-1.0))
    with pytest.raises(pw.RunFailed, match="no longer finite"):
        pw.run(scene_of(), jobs=1)
