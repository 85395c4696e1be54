"""Campaigns of stages and wear updates, and their results on disk."""

from typing import Any, cast

import numpy as np
import pytest
from endurance.sameness import folder_differences
from numpy.testing import assert_allclose, assert_array_equal
from refusals import refused

import presswear as pw
from presswear.campaign.campaign import run_stage


@pytest.fixture(scope="module", params=["paper", "refined"])
def campaign(request, tmp_path_factory):
    """One fast cycle of the press, worn once as if it had run a million times."""
    settings: dict[str, Any] = {"extrapolation": "single", "conventions": request.param}
    settings |= {
        "cycles": 1,
        "wear_updates": 1,
        "cycles_per_update": 1e6,
        "replicates": 1,
    }
    scene = pw.scenes.wear_times(speed=60.0, **settings)
    path = tmp_path_factory.mktemp("result") / request.param
    return scene, pw.run(scene), pw.run(scene, path)


def test_the_next_stage_runs_on_the_amplified_wear(campaign):
    scene, result, _ = campaign
    first, second = result.stages
    assert first.cycles_per_update == scene.cycles_per_update
    _, ran = run_stage(scene)
    for k, joint in enumerate(second.joints.values()):
        expected = 1e6 * ran.recorders[0].maps.sampled[k]
        assert expected.max() > 0.0
        assert_allclose(joint.depth("bearing"), expected[0], rtol=1e-14)
        assert_allclose(joint.depth("pin"), expected[1], rtol=1e-14)
    assert not first.joints["A"].depth("bearing").any()


def test_a_result_is_the_same_in_memory_and_on_disk(campaign):
    _, memory, disk = campaign
    assert (memory.scene, memory.status, memory.message) == (
        disk.scene,
        disk.status,
        disk.message,
    )
    for mine, theirs in zip(memory.stages, disk.stages, strict=True):
        assert mine.arrays.keys() == theirs.arrays.keys()
        for name, array in mine.arrays.items():
            assert_array_equal(array, theirs.arrays[name], err_msg=name)
        assert mine.statistics == theirs.statistics
        assert (
            mine.wear_steps == ()
            or mine.wear_steps[0].cycles == theirs.wear_steps[0].cycles
        )
        for name in ("time", "position", "joints"):
            one = getattr(mine.film, name)
            other = getattr(theirs.film, name)
            assert_array_equal(one, other, err_msg=name)
    table = str(memory).splitlines()[1:]
    assert table == str(disk).splitlines()[1:]
    remark = "worn volume: bins of 1°; twice as many bins halve it"
    is_by_bin = memory.scene.conventions.wear_distribution == "bin"
    assert table[5:] == ([remark] if is_by_bin else [])
    peak = disk.stages[1].joints["A"].statistics.peak_force
    assert disk.to_pandas().loc["first wear", "joints.A.peak_force"] == peak
    for index in (7, "x"):
        stored = r"it has 0 to 1 \(no wear, first wear\)"
        with refused(f"has no stage {index!r}; {stored}$"):
            disk.stage(index)
    with pytest.raises(TypeError, match="there is no stage 'x'; it has 0 to 1"):
        cast(Any, disk.stages)["x"]


def test_open_joints_have_no_force_and_series_hold_the_peak(campaign):
    for stage in campaign[2].stages:
        assert np.all(np.diff(stage.time) > 0.0)
        assert stage.displacement[0] == 0.0
        for joint in stage.joints.values():
            assert np.all(joint.force[joint.penetration < 0.0] == 0.0)
            assert joint.wear("bearing").max() > 0.0 < joint.wear("pin").max()
        joint = stage.joints["A"]
        peak = joint.statistics.peak_force
        assert 0.9 * peak < joint.force[:, 0].max() <= peak


def scenes(**settings: Any) -> dict[str, pw.Scene]:
    common = {
        "engine": "dae",
        "wear_updates": 1,
        "cycles": 1,
        "purpose": "wear",
    } | settings
    return {
        "one": pw.scenes.wear_times(**common),
        "two": pw.scenes.wear_times(**common | {"seed": 2}),
        "fails": pw.scenes.wear_times(**common | {"integrator": "rk4-paper"}),
    }


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scenes")
    reported = []
    pw.run_scenes(
        scenes(), folder, jobs=2, on_progress=lambda *report: reported.append(report)
    )
    return folder, reported


def test_every_scene_has_its_result(ran):
    folder, reported = ran
    results = {name: pw.load(folder / name) for name in scenes()}
    assert [result.status for result in results.values()] == [
        "completed",
        "completed",
        "failed",
    ]
    for name, result in results.items():
        fractions = [fraction for key, fraction, _ in reported if key == name]
        assert fractions == sorted(fractions)
        last = [
            words for key, fraction, words in reported if (key, fraction) == (name, 1.0)
        ]
        assert last == [f"{result.status}: {result.message}".removesuffix(": ")]


def test_finished_runs_are_read_and_others_run_again(ran, tmp_path):
    before = (ran[0] / "one" / "result.json").stat().st_mtime_ns
    results = pw.run_scenes(scenes(), ran[0], jobs=1)
    assert list(results) == list(scenes())
    assert (ran[0] / "one" / "result.json").stat().st_mtime_ns == before
    # The numbers do not depend on the number of processes.
    pw.run_scenes(scenes(), tmp_path, jobs=1)
    for name in scenes():
        assert folder_differences(tmp_path / name, ran[0] / name) == []


@pytest.mark.parametrize(
    ("named", "arguments", "message"),
    [
        (scenes(friction=0.3), {}, "another scene: friction is"),
        (scenes(), {"jobs": 0}, "jobs = 0: must be at least 1"),
        (scenes(), {"engine": "exudyntree"}, "did you mean exudyn-tree"),
        ({"../one": pw.scenes.wear_times()}, {}, "cannot name the folder of a scene"),
    ],
)
def test_impossible_scenes_are_refused(named, arguments, message, ran):
    with refused(message):
        pw.run_scenes(named, ran[0], **arguments)
