"""Scenes: the linkage and the engine that they make, and what is stored of them."""

import json
import math
from dataclasses import replace
from typing import Any

import pytest
from refusals import refused

from presswear.campaign.runs import run
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.mechanisms import SliderCrank
from presswear.scene.catalog import SCENES, scene_named, wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError

BASE = replace(wear_times(), name="base", title="a scene")


@pytest.mark.parametrize(
    ("joints", "engine", "kind"),
    [
        ("AC", "exudyn", ExudynTree),
        ("A", "exudyn", ExudynJoints),
        ("none", "exudyn", ExudynJoints),
        ("AC", "exudyn-joints", ExudynJoints),
        ("AC", "dae", InHouse),
    ],
)
def test_the_smallest_model_that_fits_is_used(joints, engine, kind):
    assert type(replace(BASE, joints=joints, engine=engine).solver) is kind


@pytest.mark.parametrize("name", list(SCENES))
def test_named_scenes_survive_storage(name):
    scene = scene_named(name)
    data = scene.as_dict()
    assert Scene.from_dict(data) == scene
    assert data == scene.as_dict()
    assert Scene.from_dict(json.loads(json.dumps(data, allow_nan=False))) == scene


def test_a_stored_scene_that_lost_a_value_is_refused():
    """What got lost is not today's default."""
    data = json.loads(json.dumps(BASE.as_dict()))
    for part in ("bearings", "numerics", "conventions", "mechanism"):
        for key in data[part]:
            less = {**data, part: {k: v for k, v in data[part].items() if k != key}}
            with refused(f"'?{key}|missing"):
                Scene.from_dict(less)


WRONG: tuple[tuple[str, Any], ...] = (
    ("mechanism", "abc"),
    ("mechanism", {}),
    ("origins", {"clearance": 1}),
    ("bearings", None),
    ("unknown", 1),
    ("name", 1),
    ("wear_updates", 1.5),
    ("joints", ["A"]),
    ("engine", "none"),
)


def stored(part: str, **changes: Any) -> dict[str, Any]:
    return {**BASE.as_dict(), part: {**BASE.as_dict()[part], **changes}}


@pytest.mark.parametrize(
    "data",
    [
        {},
        "scene",
        *({**BASE.as_dict(), key: value} for key, value in WRONG),
        stored("mechanism", kind="slider-crank"),
        stored("bearings", clearance=None),
        stored("bearings", friction=math.nan),
    ],
)
def test_data_that_are_no_scene_are_refused_in_one_line(data):
    with pytest.raises(InputError):
        Scene.from_dict(data)


@pytest.mark.parametrize(
    ("settings", "tolerance"),
    [
        ({}, 1e-5),
        ({"tolerance": 0.01}, 1e-6),
        ({"tolerance": 1.0}, 1e-5),
        ({"wear_updates": 0}, 1e-6),
        ({"wear_updates": 0, "cycles": 3}, 1e-6),
        ({"wear_updates": 0, "cycles": 2}, 1e-8),
        ({"purpose": "trajectory"}, 1e-8),
        ({"purpose": "forces"}, 1e-6),
        ({"purpose": "wear", "wear_updates": 0}, 1e-5),
    ],
)
def test_purpose_sets_the_default_tolerance(settings, tolerance):
    scene = replace(BASE, **settings)
    assert isinstance(scene.solver, ExudynTree)
    assert scene.solver.tree_tolerance == pytest.approx(tolerance)
    solver = changed(scene, {"tree_tolerance": 1e-8}).solver
    assert isinstance(solver, ExudynTree)
    assert solver.tree_tolerance == 1e-8


@pytest.mark.parametrize("conventions", ["paper", "refined"])
def test_without_clearance_no_joint_wears_and_one_stage_runs(conventions):
    scene = Scene(
        SliderCrank(), bearings={}, conventions=conventions, cycles=1, engine="dae"
    )
    assert scene.wear_updates == 0
    assert len(run(scene).stages) == 1
