"""Where results may go, and who writes there: said before anything is computed.

One process at a time writes into a folder.  Its lock is the system's own on an open file, so
that a process that is killed leaves none behind; the file says who holds it.
"""

import errno
import os
import platform
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from presswear.tools.errors import InputError, nearest
from presswear.tools.files import check_link

LOCK = "lock"
"""Name of the file that is locked."""
LONGEST_NAME = 255
"""Bytes of a name in common file systems."""
_LEFT = {LOCK, "result.json.part"}
"""Files that a run leaves that is killed as it begins."""
_BUSY = (errno.EACCES, errno.EAGAIN, errno.EDEADLK)
_TRIES = 5
_PAUSE = 0.02
"""Between two tries, s: whoever looks who holds a lock, has it for a moment."""


def check_name(path: Path) -> None:
    """InputError unless a file or folder can have this name, and it can be shown."""
    text = os.fspath(path)
    if not text.isprintable():
        raise InputError(f"{text!r}: a name of printable characters is expected")
    if any(len(part.encode()) > LONGEST_NAME for part in path.parts):
        raise InputError(f"{text}: names of at most {LONGEST_NAME} bytes are expected")


def check_folder(path: Path) -> None:
    """InputError where there is no such folder."""
    check_name(path)
    if not path.is_dir():
        raise InputError(f"{path}: there is no such folder{_nearest(path, Path.is_dir)}")


def check_file(path: Path) -> None:
    """InputError where there is no such file."""
    if not path.is_file():
        raise InputError(f"{path}: there is no such file{_nearest(path, Path.is_file)}")


def _nearest(path: Path, is_meant: Callable[[Path], bool]) -> str:
    """The name beside the first part that is missing which that comes near, as a question."""
    missing = next((own for own in (*reversed(path.parents), path) if not own.exists()), path)
    if missing != path:
        is_meant = Path.is_dir
    beside = missing.parent.iterdir() if missing.parent.is_dir() else ()
    return nearest(missing.name, (item.name for item in beside if is_meant(item)))


def is_free(path: Path) -> bool:
    """Tell whether a folder can be begun in: it is not there, or holds nothing of anybody.

    InputError where none of this name can be made and written into.
    """
    check_name(path)
    try:
        if path.exists():
            return path.is_dir() and {item.name for item in path.iterdir()} <= _LEFT
        if path.is_symlink():
            raise InputError(f"--out {path}: it is a link that leads nowhere")
        there = next(folder for folder in path.parents if folder.exists())
        if not there.is_dir():
            raise InputError(f"--out {path}: {there} is no folder")
        # Permissions do not tell for every kind of file system: trying does.
        os.rmdir(tempfile.mkdtemp(dir=there))
    except OSError as error:
        raise _unwritable(path, error) from None
    return True


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(f"--out {path}: nothing can be written there: {error.strerror}")


class FolderLock:
    """The right to write into a folder, until it is released or the process ends.

    Attributes
    ----------
    path : Path
        The folder's.
    warning : str
        Words for where this file system has no locks, or nothing.
    """

    def __init__(self, path: Path) -> None:
        """Lock a folder, made where it is not there.

        InputError where nothing can be written there, or naming who is at work in it, or where
        the lock is a link.
        """
        self.path = path
        self.warning = ""
        check_link(path / LOCK)
        self._made = tuple(folder for folder in (path, *path.parents) if not folder.exists())
        try:
            path.mkdir(parents=True, exist_ok=True)
            self._file = self._locked()
        except OSError as error:
            raise _unwritable(path, error) from None

    def _locked(self) -> IO[str]:
        for _ in range(_TRIES):
            file = (self.path / LOCK).open("a+", encoding="utf-8")
            problem = _lock(file)
            if problem in _BUSY:
                file.close()
                time.sleep(_PAUSE)
                continue
            if problem:
                self.warning = (
                    f"{self.path} is on a file system without locks ({os.strerror(problem)}): "
                    "start no second run in it"
                )
            # It may have been released, and removed, since it was opened.
            if _is_same(self.path / LOCK, file):
                file.truncate(0)
                file.write(f"process {os.getpid()} on {platform.node()}\n")
                file.flush()
                return file
            file.close()
        who = holder(self.path) or "another process"
        raise InputError(f"--out {self.path}: {who} is at work in it; wait for it, or name another")

    def is_held(self) -> bool:
        """True while the folder is still there and still ours."""
        return not self._file.closed and _is_same(self.path / LOCK, self._file)

    @property
    def is_released(self) -> bool:
        """True once it was given free."""
        return self._file.closed

    def release(self) -> None:
        """Give the folder free, and remove it where it was made for nothing; twice does no harm."""
        is_held = self.is_held()
        if os.name != "posix":  # where no open file can be removed
            self._file.close()
        if is_held:
            (self.path / LOCK).unlink(missing_ok=True)
            with suppress(OSError):  # up to the first folder that holds something
                for folder in self._made:
                    folder.rmdir()
        self._file.close()


def _lock(file: IO[str]) -> int:
    """Take the system's lock on a file; the number of the error where that fails, or 0."""
    try:
        if sys.platform == "win32":
            import msvcrt

            file.seek(1 << 30)  # behind the text, which others may read
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno or errno.EIO
    return 0


def _is_same(path: Path, file: IO[str]) -> bool:
    """True while a path leads to an open file."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(file.fileno()))
    except OSError:
        return False


def holder(path: Path) -> str | None:
    """Who is at work in a folder, in words; None where nobody is."""
    with suppress(OSError), (path / LOCK).open("r+", encoding="utf-8") as file:
        if _lock(file) in _BUSY:
            file.seek(0)
            return file.readline().strip() or "another process"
    return None


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
    lock = FolderLock(path)
    try:
        yield
    finally:
        lock.release()
