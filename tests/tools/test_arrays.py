"""Arrays by name in files."""

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswear.recording.observe import RECORD
from presswear.tools import arrays
from presswear.tools.arrays import named, part, read_arrays, read_numbers, write_arrays
from presswear.tools.errors import InputError

ARRAYS = {
    "records": np.array([(1,) * len(RECORD.names or ())], RECORD),
    "numbers": np.linspace(0.0, 1.0, 40).reshape(5, 8),
    "columns": np.asfortranarray(np.arange(6).reshape(2, 3)),
    "nothing": np.zeros((0, 3)),
}


@pytest.mark.parametrize("pack", [np.savez, np.savez_compressed])
def test_what_is_written_is_read(pack: Any, tmp_path: Path) -> None:
    file = tmp_path / "arrays.npz"
    digest = write_arrays(file, ARRAYS, pack)
    found = read_arrays(file, digest)
    assert found.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        assert found[name].dtype == array.dtype
        assert found[name].tobytes() == array.tobytes()
    with np.load(file, allow_pickle=False) as stored:
        assert set(stored) == set(ARRAYS)
    with pytest.raises(InputError, match=r"arrays\.npz is cut off or altered"):
        read_arrays(file, "0" * 64)


def test_numbers_are_read_as_numbers_and_nothing_else_is(tmp_path: Path) -> None:
    file = tmp_path / "arrays.npz"
    write_arrays(file, {name: ARRAYS[name] for name in ("numbers", "columns")})
    assert {values.dtype for values in read_numbers(file).values()} == {np.dtype(np.float64)}
    for values in (ARRAYS["records"], np.zeros(2, bool), np.array(["a"]), np.array([1j])):
        write_arrays(file, {"strange": values})
        with pytest.raises(InputError, match="strange holds no real numbers"):
            read_numbers(file)


def _npy(array: Any) -> bytes:
    file = io.BytesIO()
    np.save(file, array, allow_pickle=True)
    return file.getvalue()


def _header(text: str, version: int = 1) -> bytes:
    length = len(text).to_bytes(2 if version == 1 else 4, "little")
    return b"\x93NUMPY" + bytes([version, 0]) + length + text.encode()


def _promising(shape: str) -> bytes:
    return _header(f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n") + b"\0" * 16


@pytest.mark.parametrize(
    "member",
    [
        b"",
        b"no array",
        _npy(np.array([{}])),
        _promising("(10000000000000,)"),
        _promising("(-1, -2)"),
        _promising("(2**62,)"),
        _promising("('a',)"),
        _promising("(" * 200),
        _promising("()"),
        _header("x" * 60_000),
        _header("__import__('os').abort()"),
        _header("", 3),
    ],
)
def test_an_array_that_is_none_is_refused(member: bytes, tmp_path: Path) -> None:
    file = tmp_path / "arrays.npz"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("time.npy", member)
    with pytest.raises(InputError, match=r"arrays\.npz cannot be read"):
        read_arrays(file)


def test_an_archive_that_is_strange_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "arrays.npz"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("time.npy", _npy(np.zeros(3)))
    with pytest.raises(InputError, match="packed in an unknown way"):
        read_arrays(file)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("time.npy", _npy(np.zeros(3)))
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("time.npy", _npy(np.zeros(3)))
    with pytest.raises(InputError, match="a name is there twice"):
        read_arrays(file)
    monkeypatch.setattr(arrays, "MOST_BYTES", 10_000)
    write_arrays(file, {"zeros": np.zeros(2000)}, np.savez)
    assert read_arrays(file)["zeros"].size == 2000  # as large as it is
    write_arrays(file, {"zeros": np.zeros(2000)})
    with pytest.raises(InputError, match="unpacks to more than 10000 bytes"):
        read_arrays(file)


def test_a_state_is_a_part_of_a_larger_one() -> None:
    whole = {**named("one", ARRAYS), **named("ones", ARRAYS)}
    assert part(whole, "one").keys() == ARRAYS.keys()
    assert part(whole, "two") == {}
