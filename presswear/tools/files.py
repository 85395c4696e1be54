"""Files that are written whole or not at all, names of files and folders, and the folder lock.

One process at a time writes into a folder. Its lock is the system's lock on an open
file, so that a process that is killed leaves none behind; the file names its holder.
"""

import errno
import hashlib
import os
import platform
import re
import stat
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import IO, BinaryIO

from presswear.tools.errors import InputError, nearest

PART = ".part"  # ending of a file that is being written
LOCK = "lock"  # name of the file that is locked
# Largest size of a file that is read into memory, unless its size is specified
MOST_BYTES = 2**28
MAX_NAME = 255  # bytes of a name in common file systems
# Files that remain if a run is killed at its start
_LEFT = {LOCK, "result.json.part"}
# Errors of ``lock`` if another process has the lock
BUSY = (errno.EACCES, errno.EAGAIN, errno.EDEADLK)
_TRIES = 5  # attempts to lock a folder
# Pause between two attempts, s: a process that asks for the holder has the lock for a moment
_PAUSE = 0.02


def inside(folder: Path, *names: str) -> Path:
    """Return a folder inside another one; raise InputError where a link leads out of it."""
    for name in names:
        folder = folder / name
        _check_link(folder)
    return folder


def _check_link(path: Path) -> None:
    """Raise InputError for a link."""
    if path.is_symlink():
        raise InputError(
            f"{path}: this is a link; nothing is written through it, so remove it"
        )


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file so that it is there whole or not at all, even when power fails.

    OSError with the file, whose previous content is unchanged. InputError where a link
    would lead the bytes elsewhere; a link in place of the file is replaced.
    """
    unfinished = path.with_name(path.name + PART)
    _check_link(unfinished)
    try:
        with unfinished.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(unfinished, path)
    except OSError as error:
        if error.errno is None:
            raise
        # A full disk is reported without a name, other errors with the unfinished file.
        raise OSError(error.errno, error.strerror, str(path)) from None
    finally:
        with suppress(OSError):
            unfinished.unlink(missing_ok=True)


def write_bytes(path: Path, data: bytes) -> None:
    """Write bytes as ``write_whole`` does."""
    write_whole(path, lambda file: file.write(data))


def digest(data: bytes) -> str:
    """Return the SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def read_checked(
    path: Path, expected: str | None = None, most: int = MOST_BYTES
) -> bytes:
    """Read a file; raise InputError where it is missing, too large, or not the expected one.

    A pipe or a device, which may have no end, is not read.
    """
    without_waiting = getattr(os, "O_NONBLOCK", 0)  # for the other end of a pipe
    try:
        with open(os.open(path, os.O_RDONLY | without_waiting), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise InputError(f"{path}: it is not a regular file")
            if status.st_size > most:
                size = f"{status.st_size / 1e6:.3g} MB"
                raise InputError(
                    f"{path} has {size}: at most {most / 1e6:.3g} MB are expected"
                )
            data = file.read(status.st_size)
    except FileNotFoundError:
        raise InputError(f"{path} is missing") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    if expected is not None and digest(data) != expected:
        raise InputError(
            f"{path} is cut off or altered: its checksum is not the stored one"
        )
    return data


def read_text(path: Path) -> str:
    """Read a text file; raise InputError, with the nearest name, where it is missing or no text."""
    check_file(path)
    try:
        return read_checked(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file: {error}") from None


def separator_of(header: str) -> str:
    """Return the sign between the columns of a table, comma or semicolon, from its first line."""
    return ";" if ";" in header else ","


def check_name(path: Path) -> None:
    """Raise InputError unless a file or folder can have this name, and it can be shown."""
    text = os.fspath(path)
    if not text.isprintable():
        raise InputError(f"{text!r}: a name of printable characters is expected")
    if any(len(name.encode()) > MAX_NAME for name in path.parts):
        raise InputError(f"{text}: names of at most {MAX_NAME} bytes are expected")


def name_for(text: str) -> str:
    """Return a text as the name of a folder: a hyphen stands in for other characters."""
    return re.sub(r"[^A-Za-z0-9.+=_-]+", "-", text).strip("-")


def check_ending(path: Path, *endings: str, option: str = "") -> str:
    """Return the ending of a file name in lower case; raise InputError unless it is allowed."""
    check_name(path)
    label = f"{option} {path}".lstrip()
    ending = path.suffix.lower()
    if ending not in endings:
        raise InputError(f"{label}: the name must end in {' or '.join(endings)}")
    if path.is_dir():
        raise InputError(f"{label}: it is a folder; name a file")
    if not path.parent.is_dir():
        raise InputError(f"{label}: there is no folder {path.parent}")
    return ending


def _check_exists(is_wanted: Callable[[Path], bool], kind: str, path: Path) -> None:
    """Raise InputError where there is no such file or folder, with the nearest name."""
    check_name(path)
    if is_wanted(path):
        return
    if path.exists():
        raise InputError(f"{path}: it is not a {kind}")
    from_the_top = (*reversed(path.parents), path)
    missing = next((folder for folder in from_the_top if not folder.exists()), path)
    has_kind = is_wanted if missing == path else Path.is_dir
    neighbours = missing.parent.iterdir() if missing.parent.is_dir() else ()
    names = [neighbour.name for neighbour in neighbours if has_kind(neighbour)]
    hint = nearest(missing.name, names)
    raise InputError(f"{path}: there is no such {kind}{hint}")


check_folder = partial(_check_exists, Path.is_dir, "folder")
check_file = partial(_check_exists, Path.is_file, "file")


def is_free(path: Path) -> bool:
    """Return whether a folder is new or empty; InputError where it cannot be written."""
    check_name(path)
    try:
        if path.is_dir():
            return {file.name for file in path.iterdir()} <= _LEFT
        if path.exists():
            return False
        if path.is_symlink():
            raise InputError(f"folder {path}: it is a broken link")
        parent = next(folder for folder in path.parents if folder.exists())
        if not parent.is_dir():
            raise InputError(f"folder {path}: {parent} is not a folder")
        # Permissions do not decide it in every file system, but an attempt does.
        os.rmdir(tempfile.mkdtemp(dir=parent))
    except OSError as error:
        raise InputError(
            f"folder {path}: no file can be written there: {error.strerror}"
        ) from None
    return True


class FolderLock:
    """Exclusive right to write into a folder, until it is released or the process ends.

    The folder is made where it is not there. InputError where no file can be written
    there, with the holder of the lock, or where the lock is a link. ``warning`` is a
    text where this file system has no locks.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.warning = ""
        _check_link(path / LOCK)
        self._made = tuple(
            folder for folder in (path, *path.parents) if not folder.exists()
        )
        try:
            path.mkdir(parents=True, exist_ok=True)
            self._file = self._locked_file()
            self._file.truncate(0)
            self._file.write(f"process {os.getpid()} on {platform.node()}\n")
            self._file.flush()
        except OSError as error:
            reason = f"no file can be written there: {error.strerror}"
            raise InputError(f"folder {path}: {reason}") from None

    def _locked_file(self) -> IO[str]:
        for _ in range(_TRIES):
            file = (self.path / LOCK).open("a+", encoding="utf-8")
            problem = lock(file)
            if problem and problem not in BUSY:
                self.warning = (
                    f"{self.path} is on a file system without locks ({os.strerror(problem)}): "
                    "start no second run in it"
                )
            # It may have been released, and removed, since it was opened.
            if problem not in BUSY and _is_same(self.path / LOCK, file):
                return file
            file.close()
            time.sleep(_PAUSE)
        who = holder(self.path) or "another process"
        raise InputError(
            f"folder {self.path}: {who} is writing to it; wait, or name another"
        )

    def is_held(self) -> bool:
        """Return whether the folder is still there and still locked by this object."""
        return not self._file.closed and _is_same(self.path / LOCK, self._file)

    @property
    def is_released(self) -> bool:
        """True once it was released."""
        return self._file.closed

    def release(self) -> None:
        """Release the folder, and remove it where it is empty and was made here."""
        is_held = self.is_held()
        if os.name != "posix":  # where no open file can be removed
            self._file.close()
        if is_held:
            (self.path / LOCK).unlink(missing_ok=True)
            with suppress(OSError):  # up to the first folder that holds something
                for folder in self._made:
                    folder.rmdir()
        self._file.close()


def lock(file: IO[str]) -> int:
    """Take the system's lock on a file if it is free; return the number of the error, or 0."""
    try:
        if sys.platform == "win32":
            import msvcrt

            file.seek(1 << 30)  # behind the text, which other processes may read
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno or errno.EIO
    return 0


def _is_same(path: Path, file: IO[str]) -> bool:
    """Return whether a path leads to an open file."""
    with suppress(OSError):
        return os.path.samestat(os.stat(path), os.fstat(file.fileno()))
    return False


def holder(path: Path) -> str | None:
    """Return the process that holds the lock of a folder, in words; None for none."""
    with suppress(OSError), (path / LOCK).open("r+", encoding="utf-8") as file:
        if lock(file) in BUSY:
            file.seek(0)
            return file.readline(MAX_NAME).strip() or "another process"
    return None


@contextmanager
def only_writer(path: Path, resume: bool = False) -> Iterator[None]:
    """Hold the lock of a folder; InputError where it is locked, or neither new nor resumed."""
    if not (resume or is_free(path)):
        raise InputError(
            f"folder {path}: it exists and is not empty; name a new folder"
        )
    folder = FolderLock(path)
    try:
        yield
    finally:
        folder.release()
