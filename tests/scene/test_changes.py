"""What was changed in a scene, and the title of what was run."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from presswear.linkage.mechanisms import FOUR_BAR
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import (
    SCENES,
    changes_of,
    name_of,
    press_blanking,
    short_name_of,
    title_of,
    wear_times,
)
from presswear.scene.files import example_file, scene_from
from presswear.scene.scene import Scene
from presswear.scene.settings import changed

TITLE = SCENES["wear-times"].title


def told(scene: Scene) -> dict[str, tuple[str, str, str]]:
    return {own.key: (own.value, own.was, own.unit) for own in changes_of(scene)}


@pytest.mark.parametrize("name", SCENES)
def test_a_named_scene_keeps_its_title(name: str) -> None:
    scene = SCENES[name].make()
    assert changes_of(scene) == ()
    assert (title_of(scene), name_of(scene), short_name_of(scene)) == (scene.title, name, name)


def test_changes_stand_behind_the_title_with_what_they_were() -> None:
    scene = wear_times(clearance="0.5 mm", wear_updates=1)
    assert told(scene) == {"clearance": ("0.5", "0.8", "mm"), "wear_updates": ("1", "2", "")}
    assert title_of(scene) == f"{TITLE}, changed: clearance 0.5 mm, wear updates 1"
    assert name_of(scene) == "wear-times, changed: clearance 0.5 mm, wear updates 1"
    assert short_name_of(scene) == "wear-times, changed"
    assert title_of(Scene.from_dict(scene.as_dict())) == title_of(scene)


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (wear_times(conventions="refined"), {"conventions": ("refined", "paper", "")}),
        (wear_times(slip="sliding"), {"slip": ("sliding", "angle", "")}),
        (
            wear_times(geometry="swapped", process="blanking"),
            {"geometry": ("swapped", "standard", ""), "process": ("blanking", "none", "")},
        ),
        (press_blanking(**{"process.force": "200 N"}), {"process.force": ("200", "500", "N")}),
        (wear_times(**{"A.clearance": "0.4 mm"}), {"A.clearance": ("0.4", "0.8", "mm")}),
        (wear_times(cycles=3), {"cycles": ("3", "none", "")}),
        (replace(wear_times(), wear_updates=1, name="mine"), {"wear_updates": ("1", "2", "")}),
        (
            replace(wear_times(), mechanism=FOUR_BAR, joints="B"),
            {"joints": ("B", "AC", ""), "mechanism": ("four-bar", "press", "")},
        ),
        (Scene(FOUR_BAR, bearings={"B": Bearing()}), {"joints": ("B", "none", "")}),
    ],
)
def test_nothing_is_told_that_follows_from_what_is_told(
    scene: Scene, expected: dict[str, Any]
) -> None:
    assert told(scene) == expected


def test_a_long_title_counts_what_is_left_out() -> None:
    scene = wear_times(clearance="0.5 mm", friction=0.1, wear_updates=1, cycles=3, replicates=2)
    assert title_of(scene).endswith(
        ", changed: clearance 0.5 mm, friction 0.1, wear updates 1, 2 more"
    )


def test_a_file_is_told_beside_the_defaults_and_renamed_where_it_was_changed(
    tmp_path: Path,
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(example_file("four-bar"))
    scene = scene_from(file)
    assert told(scene)["wear_updates"] == ("1", "0", "")
    assert title_of(scene) == "My four-bar"
    assert title_of(changed(scene, {"clearance": "0.5 mm"})) == (
        "My four-bar, changed: clearance 0.5 mm"
    )
