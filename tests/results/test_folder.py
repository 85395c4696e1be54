"""Result folders: interrupted, damaged, of another version, with links, or on a full disk."""

import errno
import json
import math
import os
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from endurance.sameness import folder_differences
from refusals import refused

import presswear as pw
from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.runs import run_into
from presswear.linkage.surface import SIDES, bin_centres
from presswear.results.folder import FILE, SCHEMA, ResultFolder, read_stored
from presswear.results.provenance import provenance, revision_of
from presswear.results.result import unfinished
from presswear.show.report import render_report
from presswear.tools.serialize import write_json

SETTINGS: dict[str, Any] = {
    "conventions": "refined",
    "cycles": 2,
    "replicates": 2,
    "wear_updates": 1,
    "cycles_per_update": 2e4,
    "speed": "60rad/s",
    "engine": "dae",
    "integrator": "dopri5",
    "integration_tolerance": 1e-5,
    "angles": 90,
    "C.angles": 60,
}
# Two replicates of two cycles, a wear update in steps and a second stage: a campaign with
# every kind of checkpoint. The wear maps of its joints have different bins.
SCENE = pw.scenes.wear_times(**SETTINGS)


class Stop(BaseException):
    """Interruption of a run, like that of a signal."""


@dataclass
class Acting(pw.engines.Observer):
    """Observer that calls a function at one checkpoint of a campaign."""

    checkpoint: int  # number of the checkpoint, from 1; 0: the function is not called
    act: Callable[[], object]
    count: int = 0

    def on_checkpoint(self, checkpoint: Checkpoint, is_stage: bool) -> None:
        self.count += 1
        if self.count == self.checkpoint:
            self.act()


def halt() -> None:
    raise Stop


def run(path: Path, resume: bool = False, stop: int = 0) -> None:
    """Run the scene into a folder with a checkpoint after every cycle."""
    run_into(ResultFolder(path, SCENE, 0.0, resume), SCENE, [Acting(stop, halt)])


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "out"
    run(path)
    return path


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """Folder of a run that was stopped in the middle of a wear update in steps."""
    path = tmp_path_factory.mktemp("stopped") / "out"
    with pytest.raises(Stop):
        run(path, stop=7)
    return path


@pytest.fixture
def halted(stopped, tmp_path):
    """Copy of the folder of the stopped run."""
    return Path(shutil.copytree(stopped, tmp_path / "halted"))


def test_a_campaign_resumes_from_each_checkpoint(whole, tmp_path):
    """The campaign is stopped at each checkpoint and resumed from it."""
    steps = pw.load(whole).stages[0].wear_steps
    assert len(steps) > 1
    path = tmp_path / "out"
    stops = 0
    is_complete = False
    while not is_complete:
        # A resumed campaign first stores the checkpoint from which it resumes.
        next_checkpoint = 1 if stops == 0 else 2
        try:
            run(path, resume=True, stop=next_checkpoint)
            is_complete = True
        except Stop:
            stops += 1
    # Both replicates have two cycles in each step and in the last stage.
    assert stops >= 2 * (len(steps) + 1)
    assert folder_differences(whole, path) == []
    assert len(pw.load(path).provenance["resumed"]) == stops
    files = {f"{kind}-{index}.npz" for kind in ("stage", "film") for index in (0, 1)}
    assert {item.name for item in path.iterdir()} == {"result.json", *files}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (None, r"another scene: friction is 0\.02 there and 0\.3 here, cycles is 2"),
        ({"source": "x"}, "another program.*: source is x there"),
        ({"python": "2.7.18"}, r"python is 2\.7\.18 there"),
        ({"packages": {}}, "exudyn is missing there"),
    ],
)
def test_another_program_is_refused(change, words, halted):
    scene = SCENE
    if change is None:
        scene = replace(SCENE, cycles=3, bearings=replace(SCENE.bearings, friction=0.3))
    else:
        document = json.loads((halted / FILE).read_text())
        document["provenance"].update(change)
        write_json(halted / FILE, document)
    before = {file.name: file.read_bytes() for file in halted.iterdir()}
    with refused(words):
        ResultFolder(halted, scene, resume=True)
    assert {file.name: file.read_bytes() for file in halted.iterdir()} == before


def test_a_wrong_checkpoint_is_named_and_left(halted, tmp_path):
    with pytest.raises(Stop):
        run(tmp_path / "other", stop=3)
    file = next(halted.glob("checkpoint-*.npz"))
    different = next((tmp_path / "other").glob("checkpoint-*.npz"))
    for data in (file.read_bytes()[:-1], different.read_bytes()):
        file.write_bytes(data)
        with refused(f"{file.name} is cut off or altered"):
            ResultFolder(halted, SCENE, resume=True)
        assert file.read_bytes() == data


def test_damaged_results_are_named(whole, tmp_path):
    for name in ("stage-1.npz", "film-0.npz"):
        path = tmp_path / name
        shutil.copytree(whole, path)
        data = bytearray((path / name).read_bytes())
        data[len(data) // 2] ^= 4
        (path / name).write_bytes(data)
        with refused(f"{name} is cut off or altered"):
            pw.load(path)
        (path / name).unlink()
        with refused(f"{name} is missing"):
            pw.load(path)


def test_a_run_in_a_folder_is_not_disturbed_and_other_files_stay(tmp_path):
    first = ResultFolder(tmp_path / "out", SCENE)
    for resume in (False, True):
        with refused("is writing to it" if resume else "not empty"):
            ResultFolder(tmp_path / "out", SCENE, resume=resume)
    assert "is writing to it" in unfinished(pw.load(first.path))
    first.discard()
    assert not (tmp_path / "out").exists()
    (tmp_path / "precious").write_text("mine")
    for resume, words in ((False, "not empty"), (True, "no run to resume")):
        with refused(words):
            ResultFolder(tmp_path, SCENE, resume=resume)
    assert [item.name for item in tmp_path.iterdir()] == ["precious"]


def test_a_full_disk_ends_the_run_with_one_line(whole, tmp_path, monkeypatch):
    sync = os.fsync
    calls = iter(range(1000))

    def full(descriptor: int) -> None:
        if next(calls) >= 8:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        sync(descriptor)

    path = tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(
            pw.RunFailed, match=r"cannot be written: No space left on device; "
        ):
            run(path)
    assert not list(path.glob("*.part"))
    run(path, resume=True)
    assert folder_differences(whole, path) == []


def test_a_folder_that_was_removed_ends_the_run(tmp_path):
    path = tmp_path / "out"
    removing = Acting(1, lambda: shutil.rmtree(path))
    with pytest.raises(pw.RunFailed, match=f"{path} was removed or replaced"):
        run_into(ResultFolder(path, SCENE, 0.0), SCENE, [removing])
    assert not path.exists()


def test_an_error_of_the_program_is_named_in_the_folder(tmp_path):
    """The run can be resumed; its report and its line say what stopped it."""

    def divide_by_zero() -> None:
        raise ZeroDivisionError("no speed\nat crank")

    path = tmp_path / "out"
    with pytest.raises(ZeroDivisionError):
        run_into(ResultFolder(path, SCENE, 0.0), SCENE, [Acting(7, divide_by_zero)])
    reason = "stopped by ZeroDivisionError: no speed"
    result = pw.load(path)
    assert unfinished(result) == (
        f"{path} is unfinished ({reason}): 1 of 2 stages are stored"
    )
    assert f"1 of 2 stages are stored; {reason}." in render_report(result)
    run(path, resume=True)
    assert pw.load(path).message == ""


def test_there_is_no_report_without_a_finished_stage(tmp_path, command):
    path = tmp_path / "out"
    with pytest.raises(Stop):
        run(path, stop=1)
    line = f"run {path} --resume --out {path}"
    assert command(f"report {path}", 2).endswith(f"continue with: presswear {line}\n")


def test_a_resumed_command_has_the_result_of_an_uninterrupted_one(
    halted, whole, command
):
    resume = f"--resume --out {halted} --no-report"
    refused = command(f"run friction {resume}", 2)
    assert "it holds a run of wear-times, not of friction" in refused
    assert "resuming after stage 0, the wear after it" in command(
        f"run wear-times {resume}"
    )
    assert folder_differences(whole, halted) == []
    before = (halted / "result.json").read_bytes()
    assert "is already complete" in command(f"run wear-times {resume}")
    assert (halted / "result.json").read_bytes() == before
    assert json.loads(before)["status"] == "completed"


def test_maps_of_different_bins_are_stored_and_shown(whole):
    """Arrays, statistics, figures and report of a joint are over the angles of its map."""
    result = pw.load(whole)
    data = result.stages[1].arrays
    for name, bins in (("A", 90), ("C", 60)):
        assert "angle" not in data
        np.testing.assert_array_equal(data[f"{name}_angle"], bin_centres(bins))
        joint = result.stages[1].joints[name]
        numbers = result.stages[0].statistics.joints[name]
        worn = sum(float(joint.depth(side).mean()) for side in SIDES)
        (pin,) = (pin for pin in SCENE.linkage().clearances if pin.name == name)
        volume = worn * 2.0 * math.pi * pin.bearing_radius * pin.width
        assert numbers.wear_volume.mean == pytest.approx(volume, rel=1e-12)
    assert render_report(result)


@pytest.fixture(scope="module")
def document(whole):
    """Document of a run of two stages, as if it had failed and left a checkpoint."""
    document = json.loads((whole / FILE).read_text())
    finding = {"kind": "wear", "what": "a", "time_s": 1.0, "joint": "", "remedy": ""}
    document["stages"][1]["finding"] = finding
    checkpoint = {
        "file": "checkpoint-2.npz",
        "digest": 64 * "0",
        "words": "stage 1",
        "index": 1,
    }
    document["checkpoint"] = checkpoint
    document["provenance"]["resumed"] = [{"started": "now", "machine": "this"}]
    return json.dumps(document)


def test_a_document_is_read_and_written_unchanged(document, tmp_path):
    (tmp_path / FILE).write_text(document)
    read_stored(tmp_path).write(tmp_path)
    assert json.loads((tmp_path / FILE).read_text()) == json.loads(document)


@pytest.mark.parametrize(
    ("place", "value", "says"),
    [
        (
            "stages 0 statistics cycles",
            "five",
            "statistics.cycles: Expected `int`, got `str`",
        ),
        ("stages 1", {}, r"stages\[1\]: Object missing required field `index`"),
        (
            "stages 1 index",
            2,
            r"the stages \[0, 2\] and 'files' differ: film-1\.npz, film-2\.npz",
        ),
        ("files ../x", "", r"'files' differ: \.\./x"),
        ("files", {}, r"'files' differ: film-0\.npz"),
        ("checkpoint file", "../x", r"checkpoint.file: Invalid enum value '\.\./x'"),
        ("schema", 9, f"has schema 9; this version reads {SCHEMA}"),
    ],
)
def test_wrong_parts(document, tmp_path, place, value, says):
    changed = json.loads(document)
    part: Any = changed
    *keys, last = (int(key) if key.isdigit() else key for key in place.split())
    for key in keys:
        part = part[key]
    part[last] = value
    (tmp_path / FILE).write_text(json.dumps(changed))
    with refused(f"{FILE}.*{says}"):
        read_stored(tmp_path)


NO_SCENE = json.dumps(
    {"schema": SCHEMA, "scene": {"press": {}}, "provenance": provenance()}
)


@pytest.mark.parametrize(
    "text",
    ["", "[]", '{"schema": 99}', f'{{"schema": {SCHEMA}}}', "\x00\xff", NO_SCENE],
)
def test_a_folder_that_holds_no_result_is_refused(tmp_path, text):
    (tmp_path / FILE).write_text(text, encoding="latin-1")
    with refused(FILE):
        pw.load(tmp_path)


RESULT = "ideal"
SWEEP = "clearances"


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stored")
    pw.run(pw.scenes.ideal(engine="dae"), folder / RESULT)
    scene = pw.scenes.slider_crank(engine="dae", cycles=1, wear_updates=0)
    pw.sweep(scene, {"clearance": "0.2mm"}, folder / SWEEP, ["B.force_max"], jobs=1)
    return folder


@pytest.mark.parametrize(
    ("kind", "link", "line"),
    [
        (RESULT, "figures", "report {folder}"),
        (RESULT, "report.html.part", "report {folder}"),
        (RESULT, "lock", "run {kind} --resume --out {folder}"),
        (SWEEP, "table.csv.part", "report {folder}"),
        (SWEEP, "rows", "sweep slider-crank --resume --out {folder}"),
        (SWEEP, "runs", "sweep slider-crank --resume --out {folder}"),
    ],
)
def test_a_link_is_refused_in_one_line(stored, tmp_path, command, kind, link, line):
    folder = tmp_path / "copy"
    outside = tmp_path / "outside"
    shutil.copytree(stored / kind, folder)
    outside.mkdir()
    (outside / "file").write_text("nothing may be written here\n")
    if (folder / link).is_dir():
        shutil.rmtree(folder / link)
    is_file = "." in link or link == "lock"
    (folder / link).symlink_to(outside / "file" if is_file else outside)
    message = command(line.format(folder=folder, kind=kind), 2)
    assert f"{folder / link}: this is a link" in message
    assert [path.name for path in outside.iterdir()] == ["file"]
    assert (outside / "file").read_text() == "nothing may be written here\n"


def test_a_link_in_place_of_a_file_is_replaced(stored, tmp_path):
    folder = tmp_path / "copy"
    outside = tmp_path / "outside.html"
    shutil.copytree(stored / RESULT, folder)
    outside.write_text("nothing may be written here\n")
    (folder / "report.html").symlink_to(outside)
    pw.load(folder).report()
    assert outside.read_text() == "nothing may be written here\n"
    assert not (folder / "report.html").is_symlink()


def test_the_revision_is_that_of_the_repository_that_tracks_the_program(tmp_path):
    """An environment within the repository of another project is not part of it."""
    package = tmp_path / ".venv" / "presswear"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")

    def git(*words: str) -> str:
        author = ("-c", "user.name=a", "-c", "user.email=a@b.c")
        command = ["git", "-C", str(tmp_path), *author, *words]
        return subprocess.run(
            command, capture_output=True, text=True, check=True
        ).stdout.strip()

    assert revision_of(package) == "unknown"
    git("init")
    git("commit", "--allow-empty", "-m", "other project")
    assert revision_of(package) == "unknown"
    git("add", "--all")
    git("commit", "-m", "the program")
    assert revision_of(package) == git("rev-parse", "--short=12", "HEAD")
