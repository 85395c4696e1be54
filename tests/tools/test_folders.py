"""Where results may go, and one writer at a time."""

import errno
import fcntl
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from presswear.tools.errors import InputError
from presswear.tools.folders import LOCK, FolderLock, check_name, holder, is_free, only_writer


def test_a_new_and_an_empty_folder_are_free_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for name in ("empty", "new", "a/b/c", "ü µ"):
        assert is_free(tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == ["empty"]
    (tmp_path / "empty" / LOCK).touch()
    assert is_free(tmp_path / "empty")


@pytest.mark.parametrize("name", ["full", "file"])
def test_what_holds_something_is_not_free(tmp_path: Path, name: str) -> None:
    (tmp_path / "full").mkdir()
    for file in ("file", "full/file", f"full/{LOCK}"):
        (tmp_path / file).write_text("somebody's")
    before = sorted(tmp_path.rglob("*"))
    assert not is_free(tmp_path / name)
    with pytest.raises(InputError, match="not empty"), only_writer(tmp_path / name):
        pass
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("file/below", "is no folder"),
        ("dangling", "leads nowhere"),
        ("a\0b", "printable"),
        ("a\nb", "printable"),
        ("\udcff", "printable"),
        ("n" * 256, "255 bytes"),
        ("ü" * 128, "255 bytes"),
        ("/proc/none/x", "nothing can be written there"),
    ],
)
def test_what_cannot_be_a_folder_is_refused(tmp_path: Path, name: str, says: str) -> None:
    (tmp_path / "file").write_text("somebody's")
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InputError, match=says):
        is_free(tmp_path / name)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_path_may_be_long_its_names_may_not() -> None:
    check_name(Path("/".join(["n" * 255] * 20)))
    with pytest.raises(InputError, match="255 bytes"):
        check_name(Path("a/" + "n" * 256 + "/b"))


_HOLD = """
import sys, time
from pathlib import Path
from presswear.tools.folders import FolderLock
lock = FolderLock(Path(sys.argv[1]))
print("taken", flush=True)
time.sleep(60)
"""


def test_a_second_writer_is_refused_until_the_first_is_killed(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", _HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "taken\n"
    with pytest.raises(InputError, match=f"process {process.pid} on .* is at work in it"):
        FolderLock(tmp_path)
    assert f"process {process.pid} on " in (holder(tmp_path) or "")
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert holder(tmp_path) is None
    lock = FolderLock(tmp_path)
    assert lock.is_held()
    assert str(os.getpid()) in (tmp_path / LOCK).read_text()
    lock.release()
    assert list(tmp_path.iterdir()) == []


def test_a_lock_is_lost_with_its_folder(tmp_path: Path) -> None:
    lock = FolderLock(tmp_path)
    (tmp_path / LOCK).rename(tmp_path / "elsewhere")
    assert not lock.is_held()
    other = FolderLock(tmp_path)
    lock.release()  # it is not ours to remove
    assert other.is_held()
    other.release()


def test_a_folder_that_was_made_for_nothing_is_removed(tmp_path: Path) -> None:
    with only_writer(tmp_path / "new" / "below"):
        assert holder(tmp_path / "new" / "below") is not None
    assert not (tmp_path / "new").exists()
    with only_writer(tmp_path / "kept"):
        (tmp_path / "kept" / "result").touch()
    assert [item.name for item in (tmp_path / "kept").iterdir()] == ["result"]
    (tmp_path / "own").mkdir()
    with only_writer(tmp_path / "own"):
        pass
    assert (tmp_path / "own").is_dir()


def test_a_file_system_without_locks_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(descriptor: int, operation: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", none)
    lock = FolderLock(tmp_path)
    assert "without locks (No locks available): start no second run in it" in lock.warning
    assert lock.is_held()
    assert holder(tmp_path) is None
    lock.release()
    assert list(tmp_path.iterdir()) == []
