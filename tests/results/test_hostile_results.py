"""Results from others: pipes, devices, bombs, and arrays that are missing or misshapen."""

import io
import json
import os
import shutil
import time
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refused

import presswear as pw
from presswear.results.folder import FILE
from presswear.results.result import stored_scene
from presswear.show.report import render_report
from presswear.sweeps.runner import ROWS, read_row
from presswear.tools.files import digest

STAGE = "stage-0.npz"
FILM = "film-0.npz"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "out"
    settings: dict[str, Any] = {
        "cycles": 2,
        "replicates": 1,
        "wear_updates": 0,
        "engine": "dae",
        "rows_per_cycle": 100,
    }
    pw.run(pw.scenes.wear_times(**settings, sections=1, drive_torque="on"), path)
    return path


@pytest.fixture
def received(whole, tmp_path):
    return Path(shutil.copytree(whole, tmp_path / "received"))


def plant(folder: Path, name: str, data: bytes) -> None:
    """Replace a file and its digest."""
    (folder / name).write_bytes(data)
    document = json.loads((folder / FILE).read_text())
    document["files"][name] = digest(data)
    (folder / FILE).write_text(json.dumps(document))


def packed(arrays: dict[str, Any]) -> bytes:
    data = io.BytesIO()
    np.savez_compressed(data, **arrays)
    return data.getvalue()


def bomb() -> bytes:
    """Return a small archive of 105 MB of zeros."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("time.npy", bytes(100 * 2**20))
    return data.getvalue()


def arrays_of(folder: Path, name: str) -> dict[str, Any]:
    with np.load(folder / name) as stored:
        return dict(stored)


@pytest.mark.parametrize("name", [STAGE, FILM, FILE])
@pytest.mark.parametrize("target", ["pipe", "/dev/zero"])
def test_pipes_and_devices_are_not_read(received, name, target):
    (received / name).unlink()
    if target == "pipe":
        os.mkfifo(received / name)
    else:
        (received / name).symlink_to(target)
    with refused(r"not a regular file|is not a result folder"):
        pw.load(received)


@pytest.mark.parametrize("name", [STAGE, FILM])
def test_arrays_larger_than_a_run_writes_are_not_unpacked(received, name):
    data = bomb()
    plant(received, name, data)
    assert len(data) < 2**18
    with refused("its arrays have 105 MB"):
        print(pw.load(received).stages[0].film)


def test_methods_without_a_limit_of_size_are_refused(received):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("time.npy", b"")
    plant(received, STAGE, data.getvalue())
    with refused("not compressed by deflate"):
        pw.load(received)


def test_a_file_that_is_too_long_is_not_read(received):
    with (received / FILM).open("r+b") as film:
        film.truncate(2**32)  # on the disk it takes nothing
    with refused("at most"):
        pw.load(received)


@pytest.mark.parametrize(
    ("item", "megabytes", "message"),
    [
        ("[],", 180, "has 180 MB: at most 67.1 MB are expected"),
        ("[],", 60, "has 20,000,0.. lists: at most 4,000,000 are expected"),
        ("0,", 60, "longer"),
    ],
)
def test_a_document_of_many_lists_is_refused_at_once(
    item, megabytes, message, received
):
    """180 MB of empty lists took minutes and gigabytes."""
    document = (received / FILE).read_text().rstrip()
    items = item * (1_000_000 * megabytes // len(item))
    long = f'{document[:-1]}, "longer": [{items[:-1]}]}}'
    (received / FILE).write_text(long)
    began = time.process_time()
    if item == "[],":
        with refused(message):
            pw.load(received)
    else:
        pw.load(received)
    assert time.process_time() - began < 10.0


def test_members_that_are_no_arrays_are_named(received):
    data = io.BytesIO((received / STAGE).read_bytes())
    with zipfile.ZipFile(data, "a") as archive:
        archive.writestr("note", "text")
    plant(received, STAGE, data.getvalue())
    with refused("note is no array"):
        pw.load(received)


def shorter(array: Any) -> Any:
    return array[:-1]


def deeper(array: Any) -> Any:
    return array[np.newaxis]


def single(array: Any) -> Any:
    return np.float64(1.0)


def test_misshapen_arrays_are_named(received):
    for name in (STAGE, FILM):
        arrays = arrays_of(received, name)
        original = (received / name).read_bytes()
        for key, array in arrays.items():
            if key == "angle" or key.startswith("C_"):  # not read; like A
                continue
            changes: list[Callable[[Any], Any]] = [deeper, single]
            if len(array) and key not in ("A_contacts", "sections"):
                changes.append(shorter)
            for change in changes:
                plant(received, name, packed(arrays | {key: change(array)}))
                with refused(name):
                    print(pw.load(received).stages[0].film)
        plant(received, name, original)


def test_missing_arrays_are_named(received):
    """A figure or a table may be left out; whatever fails does so with the name."""
    for name in (STAGE, FILM):
        arrays = arrays_of(received, name)
        for key in arrays:
            if key.startswith("C_"):  # like A
                continue
            plant(
                received,
                name,
                packed({name: arrays[name] for name in arrays if name != key}),
            )
            with suppress(pw.InputError):
                stage = pw.load(received).stages[0]
                print(
                    stage.film,
                    stage.joints["A"].contact("peak_force"),
                    stage.displacement,
                )
                print(
                    stage.each_cycle("steps"), stage.joints["A"].each_cycle("force_max")
                )
            if key in ("slider", "A_contacts", "cycles"):
                with suppress(pw.InputError):
                    render_report(pw.load(received))
        plant(received, name, packed(arrays))


def test_a_claim_of_many_cycles_does_not_unpack_a_bomb(received):
    document = json.loads((received / FILE).read_text())
    for stage in document["stages"]:
        stage["statistics"]["cycles"] = 10**12
    (received / FILE).write_text(json.dumps(document))
    plant(received, STAGE, bomb())
    with refused("its arrays have 105 MB, expected are 7"):
        pw.load(received)


def test_numbers_of_a_stage_are_finite_and_its_times_within_its_cycles(received):
    """A cycle takes memory, so that a late time would take all of it."""
    arrays = arrays_of(received, STAGE)
    for name, value, message in (
        ("time", 1e9, "time must contain finite numbers of at most"),
        ("time", np.nan, "time must"),
        ("A_force", np.inf, "A_force must contain finite numbers$"),
        ("cycles", np.nan, "cycles must"),
    ):
        wrong = arrays[name].copy()
        wrong.flat[-1] = value
        plant(received, STAGE, packed(arrays | {name: wrong}))
        with refused(message):
            pw.load(received)


def test_control_characters_are_printed_as_escapes(received):
    document = json.loads((received / FILE).read_text())
    document["message"] = document["stages"][0]["message"] = "\x1b]0;title\x07"
    (received / FILE).write_text(json.dumps(document))
    result = pw.load(received)
    for text in (f"{result}", f"{result.stages[0]!r}"):
        assert r"\x1b]0;title\x07" in text
        assert "\x1b" not in text


def test_an_empty_checkpoint_is_refused(received):
    document = json.loads((received / FILE).read_text())
    data = io.BytesIO()
    np.savez(data, document=np.frombuffer(b"\x80", np.uint8))  # an empty mapping
    (received / "checkpoint-1.npz").write_bytes(data.getvalue())
    document |= {
        "status": "interrupted",
        "checkpoint": {
            "file": "checkpoint-1.npz",
            "digest": digest(data.getvalue()),
            "words": "stage 0",
            "index": 0,
        },
    }
    (received / FILE).write_text(json.dumps(document))
    with refused("its checkpoint is of another scene"):
        pw.run(stored_scene(received)[0], received)


def test_row_of_a_sweep_that_is_a_pipe_is_no_row(tmp_path):
    (tmp_path / ROWS).mkdir()
    os.mkfifo(tmp_path / ROWS / "1.json")
    assert read_row(tmp_path, "1") is None
