"""Records of runs in a folder that many processes write into: one truth, nothing torn.

Every process that writes has a file of its own, to which it adds lines and which nobody else
touches: a digest, then a record as JSON.  A line that a kill cut off has no right digest and is
no record.  What is there is found by reading all files, into an index on the local disk, so that
memory does not grow with the number of records.

A run that is about to begin is claimed by a link of its name, which only one process can make and
which says who did.  Whoever finds a claim of a process that has ended takes it away.  Each process
holds the system's lock on its own folder; on another machine, or where a file system has no locks,
it counts as ended when it has not touched its folder for ``LEASE``.
"""

import errno
import os
import platform
import secrets
import sqlite3
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Self

from presswear.tools.errors import InputError
from presswear.tools.files import PART, digest, inside
from presswear.tools.folders import LOCK, FolderLock, holder, is_free

RECORDS, CLAIMS, RUNS = "records", "claims", "runs"
"""Folders: of the processes that write, of claims, and of whole results."""
FILE = "records.jsonl"
LEASE = 120.0
"""Time after which a process that gave no sign counts as ended, s."""
BEAT = 20.0
"""Time between two signs, s."""
_CLEARING = "clearing"
_DIGITS = 16
_BLOCK = 2**22
"""Bytes that are read at a time."""
_LONGEST = 2**20
"""Bytes of a line at most."""


def can_begin(path: Path) -> bool:
    """Tell whether a folder is free, or holds what a process leaves that is killed as it begins."""
    if is_free(path):
        return True
    there = {item.name for item in path.iterdir()} if path.is_dir() else {""}
    is_ours = {name for name in there if not name.endswith(PART)} <= {RECORDS, CLAIMS}
    return is_ours and not any(own.stat().st_size for own in path.glob(f"{RECORDS}/*/{FILE}"))


@dataclass(frozen=True)
class Record:
    """What is kept of a run.

    Attributes
    ----------
    names : tuple of str
        Digests under which it is found: of its scene, and of how it was asked for.
    values : dict
        Value, half width (None: not told) and whether it is a lower bound only, by key.
    stages : int
        Stages that ran.
    reason : str
        Why it has no values, or nothing.
    wall_s : float
        What it took, s, without compiling.
    again : bool
        True where it failed by what is around it, so that whoever resumes tries it again.
    folder : bool
        True where its whole result is kept as well, in ``runs``.
    """

    names: tuple[str, ...]
    values: dict[str, tuple[float | None, float | None, bool]] = field(default_factory=dict)
    stages: int = 0
    reason: str = ""
    wall_s: float = 0.0
    again: bool = False
    folder: bool = False


class Records:
    """All sound records in a folder, as an index that ``refresh`` brings up to date.

    Attributes
    ----------
    path : Path
    damaged : int
        Lines that are cut off or altered.
    """

    def __init__(self, path: Path) -> None:
        # Imported where records are read or written.
        import msgspec

        self.path, self.damaged = path, 0
        self._read = msgspec.json.Decoder(Record).decode
        self._problem = msgspec.DecodeError
        self._seen: dict[str, tuple[int, int]] = {}
        self._ended: set[str] = set()
        # Without a name it stands in a file of its own that ends with this process.
        self._index = sqlite3.connect("", isolation_level=None)
        self._index.execute("PRAGMA journal_mode = OFF")
        self._index.execute(
            "CREATE TABLE places (name BLOB PRIMARY KEY, file INT, start INT, size INT, "
            "again INT, folder INT, failed INT) WITHOUT ROWID"
        )

    def refresh(self) -> None:
        """Read what others have written since."""
        with suppress(FileNotFoundError):
            for entry in sorted(os.scandir(self.path / RECORDS), key=lambda own: own.name):
                if entry.name not in self._ended:
                    # Locked before its file is made, and given free before that is read.
                    has_ended = (
                        self._file(entry.name).exists()
                        and not (self.path / RECORDS / entry.name / LOCK).exists()
                    )
                    with suppress(OSError):
                        self._refresh(entry.name)
                    if has_ended:
                        self._ended.add(entry.name)

    def _refresh(self, writer: str) -> None:
        number, start = self._seen.setdefault(writer, (len(self._seen), 0))
        with self._file(writer).open("rb") as file:
            if os.fstat(file.fileno()).st_size <= start:
                return
            file.seek(start)
            rest = b""
            self._index.execute("BEGIN")
            try:
                while (block := file.read(_BLOCK)) and len(rest) < _LONGEST:
                    *lines, rest = (rest + block).split(b"\n")
                    for line in lines:
                        self._add(number, start, line)
                        start += len(line) + 1
            finally:
                self._index.execute("COMMIT")
                self._seen[writer] = number, start

    def _file(self, writer: str) -> Path:
        return self.path / RECORDS / writer / FILE

    def _add(self, number: int, start: int, line: bytes) -> None:
        record = self._sound(line)
        if record is None:
            self.damaged += 1
        else:
            self._note(record, number, start, len(line))

    def _note(self, record: Record, number: int, start: int, size: int) -> None:
        told = (number, start, size, record.again, record.folder, bool(record.reason))
        self._index.executemany(
            # One that is whole is not replaced by one that is less.
            "INSERT INTO places VALUES (?,?,?,?,?,?,?) ON CONFLICT(name) DO UPDATE SET "
            "file=excluded.file, start=excluded.start, size=excluded.size, again=excluded.again, "
            "folder=excluded.folder, failed=excluded.failed "
            "WHERE places.again OR excluded.folder > places.folder",
            [(bytes.fromhex(name), *told) for name in record.names],
        )

    def _sound(self, line: bytes) -> Record | None:
        """The record of a line; None where it is cut off or altered."""
        told, _, text = line.partition(b" ")
        if told != digest(text)[:_DIGITS].encode():
            return None
        try:
            return self._read(text)
        except self._problem:
            return None

    def has_failed(self, name: str) -> bool:
        """True for a run that has no values."""
        found = self._place(name)
        return found is not None and bool(found[5])

    def _place(self, name: str) -> tuple[int, int, int, int, int, int] | None:
        found: tuple[int, int, int, int, int, int] | None = self._index.execute(
            "SELECT file, start, size, again, folder, failed FROM places WHERE name = ?",
            (bytes.fromhex(name),),
        ).fetchone()
        return found

    def is_sealed(self, name: str, with_folder: bool = False) -> bool:
        """True where a run need not run again.

        Parameters
        ----------
        with_folder : bool
            Whether its whole result is wanted too.
        """
        found = self._place(name)
        return found is not None and not found[3] and (bool(found[4]) or not with_folder)

    def get(self, name: str) -> Record | None:
        """A record; None where there is none."""
        found = self._place(name)
        if found is None:
            return None
        number, start, size = found[:3]
        with self._file(list(self._seen)[number]).open("rb") as file:
            file.seek(start)
            return self._sound(file.read(size))

    def forget(self, name: str) -> None:
        """Take a record for none, as where what it tells of is no longer there."""
        self._index.execute("DELETE FROM places WHERE name = ?", (bytes.fromhex(name),))

    def __len__(self) -> int:
        return int(self._index.execute("SELECT COUNT(*) FROM places").fetchone()[0])

    def close(self) -> None:
        """Drop the index."""
        self._index.close()


class Store(Records):
    """Records of a folder, and the right to add to them.

    Attributes
    ----------
    warning : str
        Words for where this file system has no locks, or nothing.
    """

    def __init__(self, path: Path) -> None:
        """Begin a file of records of this process; OSError, InputError where that cannot be."""
        super().__init__(path)
        self._writer = f"{platform.node()}-{os.getpid()}-{secrets.token_hex(4)}"
        self._own = inside(path, RECORDS) / self._writer
        self._lock = FolderLock(self._own)
        self.warning = self._lock.warning
        self._claims = inside(path, CLAIMS)
        self._held: set[str] = set()
        self._done: list[str] = []
        self._out = (self._own / FILE).open("ab", buffering=0)
        self._beaten = time.monotonic()
        self._ended.add(self._writer)  # its own lines it knows
        self.refresh()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.flush()
        self.release(tuple(self._held))
        is_empty = self._out.tell() == 0
        self._out.close()
        if is_empty:
            (self._own / FILE).unlink(missing_ok=True)
        with suppress(OSError):  # others claim
            self._claims.rmdir()
        self._lock.release()
        self.close()

    def claim(self, name: str, with_folder: bool = False) -> bool:
        """Claim a run that is about to begin; False where somebody has, or it is sealed by now."""
        if not self._linked(name):
            owner = self._owner(name)
            if owner is None or self._is_alive(owner):
                return False
            self._clear(owner)
            if not self._linked(name):
                return False
        self._held.add(name)
        # Whoever held it before has sealed it before it was given free.
        self.refresh()
        if self.is_sealed(name, with_folder):
            self.release((name,))
            return False
        return True

    def _linked(self, name: str) -> bool:
        try:
            os.symlink(self._writer, self._claims / name)
        except FileExistsError:
            return False
        except FileNotFoundError:
            self._claims.mkdir(exist_ok=True)
            return self._linked(name)
        return True

    def _owner(self, name: str) -> str | None:
        with suppress(OSError):
            return os.readlink(self._claims / name)
        return None

    def _is_alive(self, writer: str) -> bool:
        folder = self.path / RECORDS / writer
        if writer == self._writer:
            return True
        if writer.startswith(f"{platform.node()}-") and not self.warning:
            return holder(folder) is not None
        with suppress(OSError):
            self.beat(always=True)
            # Both times are those of the file system.
            return self._own.stat().st_mtime - folder.stat().st_mtime < LEASE
        return False

    def _clear(self, writer: str) -> None:
        """Take away all claims of a process that has ended, one process at a time."""
        try:
            lock = FolderLock(inside(self.path, _CLEARING))
        except InputError:
            return
        try:
            for entry in os.scandir(self._claims):
                if self._owner(entry.name) == writer:
                    os.unlink(entry.path)
        finally:
            lock.release()

    def release(self, names: Iterable[str]) -> None:
        """Give claims free."""
        for name in names:
            self._held.discard(name)
            if self._owner(name) == self._writer:
                (self._claims / name).unlink(missing_ok=True)

    def seal(self, record: Record, claimed: str) -> None:
        """Add a record; its claim is given free once ``flush`` has it on the disk."""
        import msgspec

        text = msgspec.json.encode(record)
        line = digest(text)[:_DIGITS].encode() + b" " + text
        start = self._out.tell()
        if self._out.write(line + b"\n") != len(line) + 1:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), f"{self._own / FILE}")
        number, _ = self._seen.setdefault(self._writer, (len(self._seen), 0))
        self._seen[self._writer] = number, start + len(line) + 1
        self._note(record, number, start, len(line))
        self._done.append(claimed)

    def flush(self) -> None:
        """Have all that is sealed on the disk."""
        if self._done:
            os.fsync(self._out.fileno())
            self.release(self._done)
            self._done.clear()
        self.beat()

    def beat(self, always: bool = False) -> None:
        """Give a sign of this process, now and then."""
        now = time.monotonic()
        if always or now - self._beaten > BEAT:
            self._beaten = now
            os.utime(self._own)
