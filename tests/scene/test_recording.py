"""The recording plan of a scene: requested series are stored, and nothing else changes."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from refusals import refused

import presswear as pw
from presswear.results.export import table_of
from presswear.scene.settings import changed
from presswear.show.report import report_tables

SCENE = pw.scenes.slider_crank(cycles=3, replicates=1)
SECTIONS = {"sections": "4", "section_angle": "90 deg"}


@pytest.mark.parametrize("engine", ["dae", "exudyn"])
def test_sections_are_states_of_the_series(engine):
    """The series counts the place from the start."""
    scene = changed(SCENE, SECTIONS)
    stage = pw.run(scene, engine=engine).stages[0]
    period = scene.mechanism.period
    at = (np.arange(3)[:, None] + np.array(scene.recording.phases)) * period
    assert stage.section("place").shape == stage.section("normal", "B").shape == (3, 4)
    # Straight between rows: a turn of 0.1 m errs by 0.1 (2 pi / 2000)^2 / 8 m, more at
    # impacts, and the last row lies before the end.
    place = np.interp(at.ravel()[:-1], stage.time, stage.displacement)
    with refused(r"'B\.norml'; did you mean B\.normal"):
        stage.section("norml", "B")
    seen = stage.section("place").ravel()[:-1]
    assert_allclose(np.diff(seen), np.diff(place), rtol=0.0, atol=1e-6)
    for name, column in zip("xy", stage.joints["B"].eccentricity.T, strict=True):
        expected = np.interp(at.ravel()[:-1], stage.time, column)
        seen = stage.section(f"eccentricity_{name}", "B").ravel()[:-1]
        assert_allclose(seen, expected, rtol=0.0, atol=1e-6)


def test_sections_end_no_cycle_elsewhere():
    """Without them nothing is kept, and the rows of the cycles stay as many."""
    bare = pw.run(SCENE, engine="dae").stages[0]
    assert "sections" not in bare.arrays
    with refused("no sections were stored; use sections = 1"):
        bare.section("place")
    seen = pw.run(changed(SCENE, SECTIONS), engine="dae").stages[0]
    assert seen.statistics.cycles == bare.statistics.cycles


def test_a_folder_holds_what_the_plan_asks_for(tmp_path):
    wanted = {
        **SECTIONS,
        "recorded_cycles": "1",
        "rows_per_cycle": "300",
        "digits": "single",
    }
    result = pw.run(changed(SCENE, wanted), tmp_path, engine="dae")
    read = pw.load(tmp_path)
    assert read.scene.recording == pw.Recording(
        1, 300, "all", "single", 4, 0.5 * math.pi
    )
    for name, item in read.stages[0].arrays.items():
        assert_array_equal(item, result.stages[0].arrays[name])
    stage = read.stages[0]
    full = pw.run(SCENE, engine="dae").stages[0]
    period = SCENE.mechanism.period
    assert stage.time[-1] <= 1.01 * period
    assert 300 <= stage.time.size < np.searchsorted(full.time, period)
    force = stage.joints["B"].force
    assert_array_equal(force, force.astype(np.float32))
    assert not np.array_equal(
        full.joints["B"].force, full.joints["B"].force.astype(np.float32)
    )


def test_series_of_joints_may_be_left_out(tmp_path):
    """All else stays, and what is made of them is left out, or told in one line."""
    scene = changed(SCENE, {"series": "output"})
    for one, folder in ((scene, "output"), (SCENE, "full")):
        pw.run(one, tmp_path / folder, engine="dae", jobs=1)
    read, full = (pw.load(tmp_path / folder) for folder in ("output", "full"))
    item = read.stages[0]
    stage = full.stages[0]
    left_out = {
        f"B_{name}" for name in ("eccentricity", "penetration", "force", "sliding")
    }
    assert stage.arrays.keys() - item.arrays.keys() == left_out
    for name, values in item.arrays.items():
        assert_array_equal(values, stage.arrays[name])
    with refused("joint B: its force was not stored; use series = all"):
        _ = item.joints["B"].force
    with refused("nothing to draw as 'path'"):
        read.plot("path")
    assert "B_normal_force" in table_of(full, 0)
    assert "B_normal_force" not in table_of(read, 0)
    tables = [report_tables(one, [])["motion"] for one in (full, read)]
    assert [table is not None for table in tables] == [True, False]
    room, whole = (
        (tmp_path / item / "stage-0.npz").stat().st_size for item in ("output", "full")
    )
    assert room < 0.6 * whole
