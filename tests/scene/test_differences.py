"""Changes against a named scene, and titles of changed scenes."""

from dataclasses import replace

import pytest
from four_bar_linkage import FOUR_BAR

import presswear as pw
from presswear.scene.catalog import changes_of, name_of, short_name_of, title_of
from presswear.scene.files import example_file, scene_from
from presswear.scene.settings import changed


def described(scene: pw.Scene) -> dict[str, tuple[str, str, str]]:
    """Return value, default and unit of each change."""
    return {
        change.key: (change.value, change.was, change.unit)
        for change in changes_of(scene)
    }


@pytest.mark.parametrize("name", pw.scenes.SCENES)
def test_a_named_scene_keeps_its_title(name):
    scene = pw.scenes.SCENES[name].make()
    assert changes_of(scene) == ()
    assert (title_of(scene), name_of(scene), short_name_of(scene)) == (
        scene.title,
        name,
        name,
    )


def test_a_scene_without_a_name_has_that_of_its_mechanism():
    scene = pw.Scene(pw.FourBar())
    assert (title_of(scene), name_of(scene)) == ("four-bar", "four-bar")
    assert short_name_of(scene) == "four-bar"


def test_the_title_lists_changes_and_counts_the_last():
    scene = pw.scenes.wear_times(clearance="0.5 mm", wear_updates=1)
    assert described(scene) == {
        "clearance": ("0.5", "0.8", "mm"),
        "wear_updates": ("1", "2", ""),
    }
    assert (
        title_of(scene) == f"{scene.title}, changed: clearance 0.5 mm, wear updates 1"
    )
    assert name_of(scene) == "wear-times, changed: clearance 0.5 mm, wear updates 1"
    assert short_name_of(scene) == "wear-times, changed"
    assert title_of(pw.Scene.from_dict(scene.as_dict())) == title_of(scene)
    scene = changed(scene, {"friction": "0.1", "cycles": "3", "replicates": "2"})
    assert title_of(scene).endswith(
        "clearance 0.5 mm, friction 0.1, wear updates 1, 2 more"
    )


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (pw.scenes.wear_times(slip="sliding"), {"slip": ("sliding", "angle", "")}),
        (
            pw.scenes.wear_times(geometry="swapped", process="blanking"),
            {
                "geometry": ("swapped", "standard", ""),
                "process": ("blanking", "none", ""),
            },
        ),
        (
            pw.scenes.press_blanking(**{"process.force": "200 N"}),
            {"process.force": ("200", "500", "N")},
        ),
        (
            replace(pw.scenes.wear_times(), mechanism=FOUR_BAR, joints="B"),
            {"joints": ("B", "AC", ""), "mechanism": ("four-bar", "press", "")},
        ),
        (
            pw.Scene(FOUR_BAR, bearings={"B": pw.Bearing()}),
            {"joints": ("B", "none", "")},
        ),
    ],
)
def test_changes_that_follow_are_omitted(scene, expected):
    assert described(scene) == expected


def test_a_scene_of_a_file_lists_changes_from_the_defaults(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(example_file("four-bar"))
    scene = scene_from(file)
    assert "wear_updates" not in described(scene)
    assert title_of(scene) == "My four-bar"
    scene = changed(scene, {"clearance": "0.5 mm"})
    assert title_of(scene) == "My four-bar, changed: clearance 0.5 mm"
