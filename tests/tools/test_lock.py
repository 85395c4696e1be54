"""One writer at a time in a folder."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from presswear.tools.errors import InputError
from presswear.tools.lock import FILE, FolderLock, holder, is_free, only_writer

_HOLD = """
import sys, time
from pathlib import Path
from presswear.tools.lock import FolderLock
lock = FolderLock.take(Path(sys.argv[1]))
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
        FolderLock.take(tmp_path)
    assert f"process {process.pid} on " in (holder(tmp_path) or "")
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert holder(tmp_path) is None
    lock = FolderLock.take(tmp_path)
    assert lock.is_held()
    assert str(os.getpid()) in (tmp_path / FILE).read_text()
    lock.release()
    assert list(tmp_path.iterdir()) == []


def test_a_lock_is_lost_with_its_folder(tmp_path: Path) -> None:
    lock = FolderLock.take(tmp_path)
    (tmp_path / FILE).rename(tmp_path / "elsewhere")
    assert not lock.is_held()
    other = FolderLock.take(tmp_path)
    lock.release()  # it is not ours to remove
    assert other.is_held()
    other.release()


def test_only_what_holds_nothing_is_free(tmp_path: Path) -> None:
    assert is_free(tmp_path)
    assert is_free(tmp_path / "new")
    (tmp_path / FILE).touch()
    assert is_free(tmp_path)
    (tmp_path / "mine").touch()
    assert not is_free(tmp_path)
    assert not is_free(tmp_path / "mine")


def test_a_new_folder_that_stays_empty_is_removed(tmp_path: Path) -> None:
    with only_writer(tmp_path / "new"):
        assert holder(tmp_path / "new") is not None
    assert not (tmp_path / "new").exists()
    with only_writer(tmp_path / "kept"):
        (tmp_path / "kept" / "result").touch()
    assert [item.name for item in (tmp_path / "kept").iterdir()] == ["result"]
    with pytest.raises(InputError, match="not empty"), only_writer(tmp_path / "kept"):
        pass
