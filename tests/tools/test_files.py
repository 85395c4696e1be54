"""Files that are there whole or not at all, and that know whether they still are."""

import errno
import os
from pathlib import Path
from typing import BinaryIO

import pytest

from presswear.tools.errors import InputError
from presswear.tools.files import digest, read_checked, write_bytes, write_whole


def test_a_full_disk_leaves_the_last_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "file"
    write_bytes(target, b"old")

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left on device") as raised:
        write_bytes(target, b"new")
    assert raised.value.filename == str(target)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_file_appears_whole_or_not_at_all(tmp_path: Path) -> None:
    target = tmp_path / "file"
    target.write_bytes(b"old")

    def broken(file: BinaryIO) -> None:
        file.write(b"new")
        raise OSError("no errno, no name")

    with pytest.raises(OSError, match="no errno, no name"):
        write_whole(target, broken)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_files_that_are_not_what_was_written_are_named(tmp_path: Path) -> None:
    file = tmp_path / "stage-0.npz"
    with pytest.raises(InputError, match=r"stage-0\.npz is missing"):
        read_checked(file, None)
    file.write_bytes(b"something")
    for expected in (None, digest(b"something")):
        assert read_checked(file, expected) == b"something"
    with pytest.raises(InputError, match=r"stage-0\.npz is cut off or altered"):
        read_checked(file, digest(b"something else"))
