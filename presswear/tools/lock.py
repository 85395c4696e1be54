"""One writer at a time in a folder.

The lock is the system's own on an open file, so that a process that is killed leaves none
behind; the file says who holds it.
"""

import errno
import os
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from presswear.tools.errors import InputError
from presswear.tools.folders import check_name, check_new_folder

FILE = "lock"
_BUSY = (errno.EACCES, errno.EAGAIN, errno.EDEADLK)
_TRIES = 5
_PAUSE = 0.02
"""Between two tries, s: whoever looks who holds a lock, has it for a moment."""


def _lock(file: IO[str]) -> None:
    """Take the system's lock on a file; OSError where another has it or there is none."""
    if sys.platform == "win32":
        import msvcrt

        file.seek(1 << 30)  # behind the text, which others may read
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        return
    import fcntl

    fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


def _is_same(path: Path, file: IO[str]) -> bool:
    """Whether a path still leads to an open file."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(file.fileno()))
    except OSError:
        return False


class FolderLock:
    """The right to write into a folder, until it is released or the process ends.

    Attributes
    ----------
    path : Path
        The folder's.
    warning : str
        What to tell where this file system has no locks, or nothing.
    """

    def __init__(self, path: Path, file: IO[str], warning: str) -> None:
        self.path, self._file, self.warning = path, file, warning

    @staticmethod
    def take(path: Path) -> "FolderLock":
        """Lock an existing folder; InputError names who is at work in it."""
        for _ in range(_TRIES):
            file = (path / FILE).open("a+", encoding="utf-8")
            warning = ""
            try:
                _lock(file)
            except OSError as error:
                if error.errno in _BUSY:
                    file.close()
                    time.sleep(_PAUSE)
                    continue
                warning = (
                    f"{path} is on a file system without locks ({error.strerror}): "
                    "start no second run in it"
                )
            # It may have been released, and removed, since it was opened.
            if _is_same(path / FILE, file):
                file.truncate(0)
                file.write(f"process {os.getpid()} on {platform.node()}\n")
                file.flush()
                return FolderLock(path, file, warning)
            file.close()
        who = holder(path) or "another process"
        raise InputError(f"--out {path}: {who} is at work in it; wait for it, or name another")

    def is_held(self) -> bool:
        """Whether the folder is still there and still ours."""
        return not self._file.closed and _is_same(self.path / FILE, self._file)

    @property
    def is_released(self) -> bool:
        """Whether it was given free."""
        return self._file.closed

    def release(self) -> None:
        """Give the folder free; a second time does nothing."""
        if self._file.closed:
            return
        if self.is_held() and os.name == "posix":
            (self.path / FILE).unlink(missing_ok=True)
        self._file.close()
        if os.name != "posix":
            (self.path / FILE).unlink(missing_ok=True)


def holder(path: Path) -> str | None:
    """Who is at work in a folder, in words; None where nobody is."""
    try:
        with (path / FILE).open("r+", encoding="utf-8") as file:
            try:
                _lock(file)
            except OSError as error:
                if error.errno not in _BUSY:
                    return None
                file.seek(0)
                return file.readline().strip() or "another process"
    except OSError:
        pass
    return None


_LEFT = {FILE, "result.json.part"}
"""What a run leaves that is killed as it begins."""


def is_free(path: Path) -> bool:
    """Whether a folder can be begun in: it is not there, or holds nothing of anybody.

    InputError where there can be none of this name, before anything is created.
    """
    check_name(path)
    if not path.exists():
        check_new_folder(path)
        return True
    return path.is_dir() and {item.name for item in path.iterdir()} <= _LEFT


def make_folder(path: Path) -> tuple[Path, ...]:
    """Create a folder; returns what was not there, innermost first.

    InputError where it cannot be created.
    """
    try:
        new = tuple(folder for folder in (path, *path.parents) if not folder.exists())
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {path}: it cannot be created: {error.strerror}") from None
    return new


def remove_empty(folders: tuple[Path, ...]) -> None:
    """Remove folders, innermost first, up to the first that holds something."""
    for folder in folders:
        if not folder.exists() or any(folder.iterdir()):
            return
        folder.rmdir()


def take_folder(path: Path) -> FolderLock:
    """Lock a folder; InputError where it cannot be written or somebody is at work in it."""
    try:
        return FolderLock.take(path)
    except OSError as error:
        raise InputError(f"--out {path}: it cannot be written: {error.strerror}") from None


@contextmanager
def only_writer(path: Path) -> Iterator[None]:
    """Be the only one that writes into a new folder; left empty it is removed again.

    Raises
    ------
    InputError
        Where the folder holds something, cannot be made, or somebody is at work in it.
    """
    if not is_free(path):
        raise InputError(f"--out {path}: it exists and is not empty; name a new folder")
    new = make_folder(path)
    lock = take_folder(path)
    try:
        yield
    finally:
        lock.release()
        remove_empty(new)
