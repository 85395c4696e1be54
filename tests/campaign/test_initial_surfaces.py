"""Campaigns that start on worn surfaces."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import shutil
from dataclasses import replace

import numpy as np
import pytest
from endurance.sameness import folder_differences
from refusals import refused

import presswear as pw
from presswear.results.result import stored_scene
from presswear.show.report import render_report

QUICK = {
    "engine": "dae",
    "integrator": "dopri5",
    "integration_tolerance": 1e-6,
    "speed": 60.0,
    "cycles_per_update": 1e6,
    "replicates": 1,
    "purpose": "wear",
}


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    """Three cycles, worn once in a jump."""
    scene = pw.scenes.wear_times(cycles=3, wear_updates=1, **QUICK)
    return pw.run(scene, tmp_path_factory.mktemp("first") / "out")


def test_scene_continues_another_bit_for_bit(first):
    """A stage is the same if its surfaces come from a wear update or from the scene."""
    worn = first.stages[1]
    scene = pw.scenes.wear_times(
        surfaces=worn.surfaces, cycles=3, wear_updates=0, **QUICK
    )
    again = pw.run(scene).stages[0]
    names = [stage.name for stage in (*first.stages, again)]
    assert names == ["no wear", "first wear", "initial surfaces"]
    assert again.arrays.keys() == worn.arrays.keys()
    for name, array in worn.arrays.items():
        assert again.arrays[name].tobytes() == array.tobytes(), name


def test_depths_may_not_add_up_to_more_than_the_clearance(first):
    deep = {"A": (np.full(360, 0.79e-3), None)}
    scene = pw.scenes.wear_times(surfaces=deep, cycles=1, wear_updates=1, **QUICK)
    with pytest.raises(
        pw.RunFailed, match="joint A: after stage 0 the bearing would lose"
    ):
        pw.run(replace(scene, cycles_per_update=1e9))


def test_forces_on_a_measured_surface_need_no_account_of_wear(tmp_path):
    surfaces = {"C": (None, np.full(60, 2e-6))}
    scene = pw.scenes.wear_times(
        surfaces=surfaces, cycles=1, wear_updates=0, wear_coefficient="0/Pa", **QUICK
    )
    result = pw.run(scene, tmp_path / "out")
    (stage,) = result.stages
    np.testing.assert_allclose(stage.joints["C"].depth("pin"), 2e-6, rtol=1e-12)
    assert not stage.joints["A"].depth("pin").any()
    assert "surfaces worn; wear not computed" in str(stage.diagnostics["model"])


@pytest.mark.parametrize(
    ("contact", "frame"), [("radial", "fixed"), ("foundation", "body")]
)
def test_energy_made_by_contacts_adds_up(first, contact, frame):
    surfaces = first.stages[1].surfaces
    settings = {**QUICK, "replicates": 2, "contact": contact, "map_frame": frame}
    scene = pw.scenes.wear_times(
        surfaces=surfaces, cycles=4, wear_updates=0, **settings
    )
    (stage,) = pw.run(scene).stages
    made = stage.each_cycle("contact_made").reshape(2, 4)
    assert made.sum() == pytest.approx(stage.diagnostics["contact_made_J"], rel=1e-12)
    # The force of a foundation on surfaces that turn with their bodies has a potential.
    assert made.any() == (contact == "radial")
    mean = stage.statistics.energy_made_per_cycle
    # The first two cycles are no samples.
    assert mean.mean == pytest.approx(np.mean(made[:, 2:]), rel=1e-12)
    assert mean.samples == 4


def test_scene_is_stored(first, tmp_path, command):
    """Started from the command line, then run again from the stored scene."""
    source = shutil.copytree(f"{first.path}", tmp_path / "source")
    options = [
        f"--set {k}={v}{'rad/s' if k == 'speed' else ''}" for k, v in QUICK.items()
    ]
    options += [f"--surfaces {source}:1 --cycles 1 --wear-updates 1"]
    line = " ".join(["run wear-times", *options])
    whole = tmp_path / "whole"
    again = tmp_path / "again"
    command(f"{line} --out {whole} --no-report")
    shutil.rmtree(source)
    text = f"starts on surfaces from {source}:1."
    assert text in render_report(pw.load(whole))
    pw.run(stored_scene(whole)[0], again)
    assert folder_differences(whole, again) == []
    refused = command(f"{line} --resume --out {again}", 2)
    assert refused == f"presswear: {source}: there is no such folder\n"


def test_surfaces_of_a_result_are_read_by_stage(first):
    by_stage, last = (
        pw.results.read_surfaces(f"{first.path}{stage}") for stage in (":1", "")
    )
    assert by_stage == last == first.stages[1].surfaces
    with refused("has no stage 4; it has 0 to 1"):
        pw.results.read_surfaces(f"{first.path}:4")
    other = pw.scenes.wear_times(surfaces=last, wear_updates=0, **QUICK)
    with refused(r"A is None there and \[\{.{,40}\.\.\. \([0-9a-f]+\)"):
        pw.run(other, first.path)
