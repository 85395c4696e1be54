"""Cache of machine code for all environments of a user.

A file of the cache is executed, as the source code is. It is therefore read only where
nobody but the user and root can have written it; otherwise kernels are compiled in
memory.
"""

import errno
import logging
import multiprocessing
import os
import pickle
import stat
import sys
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO, Any, ClassVar

import numba
from llvmlite import binding
from numba.core import compiler, config, event, serialize
from numba.np.numpy_support import numpy_version

from presswear.tools.files import BUSY, digest, lock, write_bytes
from presswear.tools.kernel_digest import fields_of
from presswear.tools.processes import signals_held

# Time for which a process that compiles may stand still, s; a function takes up to 15 s
PATIENCE = 20.0
_PAUSE = 0.05  # pause between two attempts to lock, s
_DIGEST_SIZE = 64  # bytes of a digest
_MAX_FILES = 400  # files in the cache, about 200 MB; a run stores 4 to 12 files
_PACKAGE = Path(__file__).parents[1]
# NUMBA_CPU_NAME, NUMBA_CPU_FEATURES of kernels in a wheel
_WHEEL_PROCESSOR = ("x86-64-v3", "")
_WHEEL_FEATURES = "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe"
# Settings of numba, NUMBA_NAME in the environment, that change machine code
_SETTINGS = "USING_SVML", "BOUNDSCHECK", "OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE"
_LOG = logging.getLogger(__name__)


@cache
def _warn(message: str, in_worker: bool = False) -> None:
    """Log a warning once, in a worker only if no other process may notice it."""
    if multiprocessing.parent_process() is None or in_worker:
        _LOG.warning(message)


def _is_safe(status: os.stat_result, folder: Path) -> bool:
    """Return whether only the user and root can have written a folder, or a file in it.

    Kernels of a wheel are as safe as the package: who can write there can change its
    source code.
    """
    if os.name != "posix":
        return True
    owners = {0, os.geteuid()}
    forbidden = stat.S_IWGRP | stat.S_IWOTH
    if folder.parent == _PACKAGE:
        package = _PACKAGE.stat()
        owners.add(package.st_uid)
        forbidden &= ~package.st_mode
    return status.st_uid in owners and not status.st_mode & forbidden


def _is_usable(folder: Path) -> bool:
    """Return whether a folder is there and safe; warn where it is not safe."""
    try:
        status = folder.lstat()
    except OSError:
        return False
    if stat.S_ISDIR(status.st_mode) and _is_safe(status, folder):
        return True
    _warn(
        f"{folder}: kernels are compiled in memory, because other users can write there, or it is "
        "no folder of this user; use chmod go-w, or XDG_CACHE_HOME for another place"
    )
    return False


def _entry_digest(file: Path, content: bytes) -> bytes:
    """Return the digest of an entry, ``_DIGEST_SIZE`` bytes, with which its file begins."""
    return digest(file.name.encode() + content).encode()


def _read_entry(file: Path) -> bytes:
    """Return the content of an entry; raise OSError where it is damaged or not safe.

    It may be anything: a link is not followed, and a pipe is not waited for.
    """
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    with open(os.open(file, flags), "rb") as opened:
        status = os.fstat(opened.fileno())
        if not (stat.S_ISREG(status.st_mode) and _is_safe(status, file.parent)):
            raise PermissionError(errno.EACCES, "other users can write it", f"{file}")
        entry = opened.read()
    content = entry[_DIGEST_SIZE:]
    if entry[:_DIGEST_SIZE] != _entry_digest(file, content):
        raise OSError(errno.EIO, "damaged, or the entry of another kernel", f"{file}")
    return content


class KernelCache:
    """Machine code of a function, one file for each signature.

    The process that compiles a function locks a file beside it. Others wait for the
    code as long as that process goes on.

    Parameters
    ----------
    key : tuple
        What the machine code depends on, apart from versions and settings of numba.
    """

    cache_path = None  # read by numba
    patience = PATIENCE
    _locks: ClassVar[list[IO[str]]] = []  # locks that this process holds
    _lock: IO[str] | None = None

    def __init__(self, *key: object) -> None:
        versions = sys.implementation.cache_tag, numba.__version__, numpy_version
        self._key = key, versions, [getattr(config, name, None) for name in _SETTINGS]

    def files(self, signature: Any, context: Any) -> list[Path]:
        """Return the file of the user and, if the processor can execute it, that of the wheel."""
        triple, name, features = context.codegen().magic_tuple()
        fields = [list(fields_of(kind)) for kind in signature]
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        processors = {base / "presswear" / "kernels": (name, features)}
        available = binding.get_host_cpu_features()
        if all(available.get(feature) for feature in _WHEEL_FEATURES):
            processors[_PACKAGE / "kernels"] = _WHEEL_PROCESSOR
        files = []
        for folder, processor in processors.items():
            key = (self._key, signature, fields, triple, *processor)
            files.append(folder / digest(repr(key).encode()))
        return files

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return stored code; None where it is to be compiled in this process."""
        code = self._stored(signature, context)
        if code is None:
            with suppress(Exception):  # nothing can be stored
                user_file, *_ = self.files(signature, context)
                self._take_lock(user_file)
                # Another process may have stored it meanwhile.
                code = self._stored(signature, context)
            if code is not None:
                self._release()
        return code

    def _stored(self, signature: Any, context: Any) -> Any:
        """Return stored code; None where there is none, or where it cannot be used."""
        # Another version of numba can fail in any way; see ``save_overload``.
        with suppress(Exception):
            for file in self.files(signature, context):
                # An entry of other source code can fail in any way, such as by a named
                # tuple that is missing.
                with suppress(Exception):
                    if not _is_usable(file.parent):
                        continue
                    content = pickle.loads(_read_entry(file))
                    with signals_held():  # as the compiler does
                        code = compiler.CompileResult._rebuild(context, *content)
                    if code.signature.args == signature:
                        with suppress(OSError):
                            os.utime(file)  # see ``_remove_unused``
                        return code
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Store code, and remove files not used for long; do nothing where none can be written."""
        try:
            file, *_ = self.files(signature, result.target_context)
            if _is_usable(file.parent):
                content = serialize.dumps(result._reduce())
                unfinished = file.with_suffix(f".{os.getpid()}")
                write_bytes(unfinished, _entry_digest(file, content) + content)
                unfinished.chmod(0o644)
                unfinished.replace(file)
                self._release()
                _remove_unused(file.parent)
        except OSError:
            pass
        # What another numba stores can fail in any way; the run goes on without it.
        except Exception as error:
            _warn(
                f"kernels are compiled in memory, at each start: numba {numba.__version__} differs "
                f"from the versions that presswear is tested with ({error})"
            )
        finally:
            self._release()

    def _take_lock(self, file: Path) -> None:
        """Lock an entry that is to be written, unless the process that has the lock hangs."""
        file.parent.parent.mkdir(parents=True, exist_ok=True)
        file.parent.mkdir(0o700, exist_ok=True)
        if not _is_usable(file.parent):
            return
        opened = file.with_suffix(".lock").open("a+", encoding="utf-8")
        if lock(opened) in BUSY:
            with event.trigger_event("numba:compile"):
                if not _wait(opened):
                    opened.close()
                    return
        opened.truncate(0)
        opened.write(f"process {os.getpid()}")
        opened.flush()
        self._lock = opened
        self._locks.append(opened)

    def _release(self) -> None:
        if self._lock is not None:
            self._locks.remove(self._lock)
            with suppress(OSError):
                Path(self._lock.name).unlink()
            self._lock.close()
            self._lock = None


def _remove_unused(folder: Path) -> None:
    """Remove the files that were not written or read for the longest time."""
    files = sorted(folder.iterdir(), key=lambda file: file.stat().st_mtime)
    for file in files[:-_MAX_FILES]:
        file.unlink()


def _wait(opened: IO[str]) -> bool:
    """Wait for a lock; return False once the process that has it stands still."""
    last_change = 0
    deadline = 0.0
    while lock(opened) in BUSY:
        change = os.fstat(opened.fileno()).st_mtime_ns
        now = time.monotonic()
        if change != last_change:
            last_change = change
            deadline = now + KernelCache.patience
        elif now > deadline:
            opened.seek(0)
            _warn(
                f"{opened.readline() or 'another process'} compiles kernels and stands still (is "
                "it suspended?): they are compiled in this process, too",
                in_worker=True,
            )
            KernelCache.patience = 0.0
            return False
        time.sleep(_PAUSE)
    return True


class _SignOfLife(event.Listener):
    """Touches the locked files of this process with each function that is compiled."""

    def on_start(self, event: Any) -> None:
        for opened in KernelCache._locks:
            with suppress(OSError):
                os.utime(opened.fileno())

    def on_end(self, event: Any) -> None:
        self.on_start(event)


event.register("numba:compile", _SignOfLife())
