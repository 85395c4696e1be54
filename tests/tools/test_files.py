"""Files that are whole or not there, and that know whether they are what was written."""

import errno
import json
import os
from pathlib import Path

import numpy as np
import pytest

from presswear.record.observe import RECORD
from presswear.tools.errors import InputError
from presswear.tools.files import (
    arrays_in,
    check_seal,
    read_checked,
    sealed_json,
    write_arrays,
    write_bytes,
)

ARRAYS = {
    "records": np.array([(1,) * len(RECORD.names or ())], RECORD),
    "numbers": np.linspace(0.0, 1.0, 40).reshape(5, 8),
    "nothing": np.zeros((0, 3)),
}


def test_arrays_are_read_as_they_were_written(tmp_path: Path) -> None:
    file = tmp_path / "arrays.npz"
    digest = write_arrays(file, ARRAYS, np.savez)
    arrays = arrays_in(read_checked(file, digest), file)
    assert arrays.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        assert arrays[name].dtype == array.dtype
        assert arrays[name].tobytes() == array.tobytes()
    with np.load(file, allow_pickle=False) as stored:
        assert set(stored) == set(ARRAYS)


def test_every_altered_byte_of_a_sealed_document_is_found(tmp_path: Path) -> None:
    document = {"schema": 3, "text": 'no "digest": here', "value": [1.5, None, True]}
    data = sealed_json(document)
    found = json.loads(data)
    check_seal(data, found, tmp_path)
    assert {key: found[key] for key in document} == document
    for place in range(len(data)):
        bad = data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]
        try:
            altered = json.loads(bad)
        except ValueError:
            continue
        with pytest.raises(InputError, match="cut off or altered"):
            check_seal(bad, altered, tmp_path)


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


def test_files_that_are_not_what_was_written_are_named(tmp_path: Path) -> None:
    file = tmp_path / "stage-0.npz"
    with pytest.raises(InputError, match=r"stage-0\.npz is missing"):
        read_checked(file, None)
    file.write_bytes(b"something")
    assert read_checked(file, None) == b"something"
    with pytest.raises(InputError, match=r"stage-0\.npz is cut off or altered"):
        read_checked(file, "0" * 64)
