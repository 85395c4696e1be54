"""Files that are written whole or not at all, names, arrays, documents, and the folder lock."""

import errno
import fcntl
import os
import subprocess
import sys
from typing import BinaryIO

import numpy as np
import pytest

from presswear.tools import files
from presswear.tools.arrays import named, part, read_arrays, read_numbers, write_arrays
from presswear.tools.errors import InputError
from presswear.tools.serialize import read_json, write_json


def test_a_file_is_written_whole_or_stays(tmp_path, monkeypatch):
    target = tmp_path / "file"
    files.write_bytes(target, b"old")

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def broken(file: BinaryIO) -> None:
        file.write(b"new")
        raise OSError("no errno, no name")

    with pytest.raises(OSError, match="no errno, no name"):
        files.write_whole(target, broken)
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left on device") as raised:
        files.write_bytes(target, b"new")
    assert raised.value.filename == str(target)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_arrays_are_read_as_they_were_written(tmp_path):
    records = np.zeros(2, [("x", np.float64), ("n", np.int64)])
    file = tmp_path / "a.npz"
    checksum = write_arrays(
        file, named("joint", {"depth": np.arange(3.0)}) | {"records": records}
    )
    result = read_arrays(file, checksum)
    assert part(result, "joint")["depth"].tolist() == [0.0, 1.0, 2.0]
    assert result["records"].dtype == records.dtype
    with pytest.raises(InputError, match="records contains no real numbers"):
        read_numbers(file)
    with pytest.raises(InputError, match=r"a\.npz is cut off or altered"):
        read_arrays(file, files.digest(b""))
    with pytest.raises(InputError, match=r"b\.npz is missing"):
        files.read_checked(tmp_path / "b.npz", None)
    whole = file.read_bytes()
    np.savez(file, x=np.array([print]), allow_pickle=True)
    for data in (file.read_bytes(), whole[:-30], b"PK" + 99 * b"0"):
        file.write_bytes(data)
        with pytest.raises(InputError, match=r"a\.npz cannot be read"):
            read_arrays(file)


def test_documents_hold_finite_numbers_of_one_schema(tmp_path):
    file = tmp_path / "d.json"
    write_json(
        file,
        {"schema": 3, "x": np.float64(0.1), "y": float("nan"), "z": (np.int64(1),)},
    )
    assert read_json(file, "none", 3) == {"schema": 3, "x": 0.1, "y": None, "z": [1]}
    with pytest.raises(InputError, match="schema 3; this version reads 4"):
        read_json(file, "none", 4)
    with pytest.raises(InputError, match="nothing here"):
        read_json(tmp_path / "e.json", "nothing here", 3)
    numbers = (f'{{"schema": 3, "x": {number}}}' for number in ("NaN", "1e999"))
    for text in (*numbers, "[3]", "{", '{"schema": true}'):
        file.write_text(text)
        with pytest.raises(InputError, match=r"d\.json"):
            read_json(file, "none", 3)


def test_a_folder_is_free_if_it_is_new_or_empty(tmp_path):
    (tmp_path / "full").mkdir()
    (tmp_path / "empty").mkdir()
    for file in ("file", "full/file", f"full/{files.LOCK}", f"empty/{files.LOCK}"):
        (tmp_path / file).write_text("somebody's")
    before = sorted(tmp_path.rglob("*"))
    assert all(
        files.is_free(tmp_path / name) for name in ("empty", "new", "a/b/c", "ü µ")
    )
    for name in ("full", "file"):
        assert not files.is_free(tmp_path / name)
        with (
            pytest.raises(InputError, match="not empty"),
            files.only_writer(tmp_path / name),
        ):
            pass
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("file/below", "is not a folder"),
        ("dangling", "broken link"),
        ("a\0b", "printable"),
        ("\udcff", "printable"),
        ("n" * 256, "255 bytes"),
        ("/proc/none/x", "no file can be written there"),
    ],
)
def test_what_cannot_be_a_folder_is_refused(tmp_path, name, says):
    (tmp_path / "file").write_text("somebody's")
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InputError, match=says):
        files.is_free(tmp_path / name)
    assert sorted(tmp_path.rglob("*")) == before


_HOLD = """
import sys, time
from pathlib import Path
from presswear.tools.files import FolderLock
lock = FolderLock(Path(sys.argv[1]))
print("taken", flush=True)
time.sleep(60)
"""


def test_a_second_writer_is_refused_until_the_first_is_killed(tmp_path):
    command = [sys.executable, "-c", _HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "taken\n"
        with pytest.raises(
            InputError, match=f"process {process.pid} on .* is writing to it"
        ):
            files.FolderLock(tmp_path)
        assert f"process {process.pid} on " in (files.holder(tmp_path) or "")
        process.kill()
    assert files.holder(tmp_path) is None
    lock = files.FolderLock(tmp_path)
    assert lock.is_held()
    assert str(os.getpid()) in (tmp_path / files.LOCK).read_text()
    lock.release()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_was_made_for_nothing_is_removed(tmp_path):
    with files.only_writer(tmp_path / "new" / "below"):
        assert files.holder(tmp_path / "new" / "below") is not None
    assert not (tmp_path / "new").exists()
    with files.only_writer(tmp_path / "full"):
        (tmp_path / "full" / "result").touch()
    (tmp_path / "before").mkdir()
    with files.only_writer(tmp_path / "before"):
        pass
    assert {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*")} == {
        "full",
        "full/result",
        "before",
    }


def test_missing_locks_are_reported(tmp_path, monkeypatch):
    def none(descriptor: int, operation: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", none)
    lock = files.FolderLock(tmp_path)
    assert (
        "without locks (No locks available): start no second run in it" in lock.warning
    )
    assert lock.is_held()
    assert files.holder(tmp_path) is None
    lock.release()
    assert list(tmp_path.iterdir()) == []
