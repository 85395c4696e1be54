"""Several scenes in one folder: each result, resuming, and what is refused."""

from pathlib import Path
from typing import Any

import pytest
from endurance.sameness import folder_differences

import presswear as pw

Ran = tuple[Path, list[tuple[str, float, str]]]
"""Folder of the scenes, and what was reported."""


def scenes(**settings: Any) -> dict[str, pw.Scene]:
    """Return two scenes of one cycle, and one that fails at once."""
    common = {"engine": "dae", "wear_updates": 1, "cycles": 1, "purpose": "trajectory"} | settings
    return {
        "one": pw.scenes.wear_times(**common),
        "two": pw.scenes.wear_times(**common | {"seed": 2}),
        "fails": pw.scenes.wear_times(**common | {"integrator": "rk4-paper"}),
    }


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Ran:
    """Run two processes at a time."""
    folder, reported = tmp_path_factory.mktemp("scenes"), []
    pw.run_scenes(scenes(), folder, jobs=2, on_progress=lambda *report: reported.append(report))
    return folder, reported


def test_every_scene_has_its_result(ran: Ran) -> None:
    folder, reported = ran
    results = {name: pw.load(folder / name) for name in scenes()}
    assert [result.status for result in results.values()] == ["completed", "completed", "failed"]
    for name, result in results.items():
        fractions = [fraction for key, fraction, _ in reported if key == name]
        assert fractions == sorted(fractions)
        last = [words for key, fraction, words in reported if (key, fraction) == (name, 1.0)]
        assert last == [f"{result.status}: {result.message}".removesuffix(": ")]


def test_finished_runs_are_read_and_others_run_again(ran: Ran, tmp_path: Path) -> None:
    before = (ran[0] / "one" / "result.json").stat().st_mtime_ns
    results = pw.run_scenes(scenes(), ran[0], jobs=1)
    assert list(results) == list(scenes())
    assert (ran[0] / "one" / "result.json").stat().st_mtime_ns == before
    # The numbers do not depend on the number of processes.
    pw.run_scenes(scenes(), tmp_path, jobs=1)
    for name in scenes():
        assert folder_differences(tmp_path / name, ran[0] / name) == []


@pytest.mark.parametrize(
    ("settings", "arguments", "message"),
    [
        ({"friction": 0.3}, {}, "another scene: friction is"),
        ({}, {"jobs": 0}, "jobs = 0: must be at least 1"),
        ({}, {"engine": "exudyntree"}, "did you mean exudyn-tree"),
        (None, {}, "cannot name the folder of a scene"),
    ],
)
def test_scenes_that_cannot_run_are_refused(
    settings: dict[str, Any] | None,
    arguments: dict[str, Any],
    message: str,
    ran: Ran,
) -> None:
    named = {"../one": pw.scenes.wear_times()} if settings is None else scenes(**settings)
    with pytest.raises(pw.InputError, match=message):
        pw.run_scenes(named, ran[0], **arguments)
