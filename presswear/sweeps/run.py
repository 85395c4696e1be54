"""A sweep that runs: rows are taken that nobody has sealed or claimed, and sealed as they end."""

import logging
import math
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from presswear.sweeps.executors import Runner
from presswear.sweeps.measures import Found
from presswear.sweeps.store import Record, Store
from presswear.sweeps.work import Outcome, RowJob, Work
from presswear.tools.errors import InputError

_LOG = logging.getLogger(__name__)

_LOOK = 0.5
"""Time between two looks at rows that others are at work on, s."""
_FLUSH = 0.1
"""Time for which records are gathered before they are written through to the disk, s."""


@dataclass(frozen=True)
class Standing:
    """How far a sweep is.

    Attributes
    ----------
    rows, found, ran, failed : int
        All rows of this process; those that were sealed already, or by others meanwhile; those
        that ran, and those among both that have no values.
    parts : float
        Parts of rows at work that are done, summed.
    """

    rows: int
    found: int
    ran: int
    failed: int
    parts: float

    @property
    def done(self) -> int:
        """Rows that are sealed."""
        return self.found + self.ran


Gate = Callable[[float, int, int], None]
"""Hears behind the first run what it took, s, how many are left, and how many are done at once;
raises InputError where that is too long."""
Heard = Callable[[int, float, str], None]
"""Hears how far a row is, 0 .. 1, and where it stands; of one that is done why it has no values."""


def run_rows(
    work: Work,
    store: Store,
    runner: Runner,
    rows: Sequence[int],
    told: Callable[[Standing], None] = lambda standing: None,
    gate: Gate | None = None,
    begun: Callable[[], None] = lambda: None,
    heard: Heard = lambda row, part, word: None,
) -> Standing:
    """Run what is not sealed of some rows; what others are at work on is waited for.

    Parameters
    ----------
    gate : callable or None
        Where there is one, the first run is alone until it is through.
    begun : callable
        Called once the runner is there, before it is given any row.

    Raises
    ------
    RunFailed
        Where the runner cannot go on.
    InputError
        From the gate, or from a worker that has another program.
    """
    feed = _Feed(work, store, rows, told, gate, begun, heard)
    runner(feed)
    store.flush()
    told(feed.standing)
    return feed.standing


class _Feed:
    """Rows as a runner takes them."""

    def __init__(
        self,
        work: Work,
        store: Store,
        rows: Sequence[int],
        told: Callable[[Standing], None],
        gate: Gate | None,
        begun: Callable[[], None],
        heard: Heard,
    ) -> None:
        self._work, self._store, self._told, self._gate = work, store, told, gate
        self._begun, self._heard = begun, heard
        self._rows, self._next, self._places = rows, 0, 1
        self._found = self._ran = self._failed = 0
        self._is_open = gate is None
        self._busy: deque[tuple[int, str, str]] = deque()
        self._running: dict[int, tuple[str, str]] = {}
        self._parts: dict[int, float] = {}
        self._looked = self._flushed = -math.inf

    @property
    def standing(self) -> Standing:
        """How far it is."""
        parts = sum(self._parts.values())
        return Standing(len(self._rows), self._found, self._ran, self._failed, parts)

    @property
    def is_over(self) -> bool:
        """True once all rows are taken."""
        return self._next == len(self._rows) and not self._busy

    def begun(self, places: int) -> None:
        """Hear how many rows are done at once."""
        self._places = places
        self._begun()

    def take(self, most: int) -> Mapping[int, RowJob]:
        """The next rows that nobody has done or claimed, one alone until that is through."""
        if not self._is_open:
            most = 1 - len(self._running)
        found: dict[int, RowJob] = {}
        while len(found) < most and self._next < len(self._rows):
            row = self._rows[self._next]
            self._next += 1
            if (job := self._first(row)) is not None:
                found[row] = job
        if len(found) < most and time.monotonic() - self._looked > _LOOK:
            self._looked = time.monotonic()
            for _ in range(len(self._busy)):
                if len(found) < most:
                    row, name, shortcut = self._busy.popleft()
                    if (job := self._claimed(row, name, shortcut)) is not None:
                        found[row] = job
        return found

    def _first(self, row: int) -> RowJob | None:
        """The job of a row that is looked at for the first time; None where it is not to run."""
        shortcut = self._work.shortcut(row)
        if self._store.is_sealed(shortcut, self._work.with_folder):
            self._count(row, shortcut)
            return None
        try:
            name, job = self._work.job(row)
        except InputError as error:
            self._ran, self._failed = self._ran + 1, self._failed + 1
            self._store.seal(Record((shortcut,), reason=str(error)), shortcut)
            self._heard(row, 1.0, str(error))
            return None
        return self._claimed(row, name, shortcut, job)

    def _claimed(
        self, row: int, name: str, shortcut: str, job: RowJob | None = None
    ) -> RowJob | None:
        """The job of a row once it is ours; one that others have is kept for later."""
        if self._store.claim(name, self._work.with_folder):
            self._running[row] = name, shortcut
            return job or self._work.job(row)[1]
        if self._store.is_sealed(name, self._work.with_folder):
            # Another plan has sealed it where it is not found as this one asks for it.
            record = self._store.get(name)
            if record and not self._store.is_sealed(shortcut, self._work.with_folder):
                self._store.seal(replace(record, names=(shortcut,)), shortcut)
            self._count(row, name)
        else:
            self._busy.append((row, name, shortcut))
        return None

    def _count(self, row: int, name: str) -> None:
        """Count a row that was found."""
        self._found += 1
        self._failed += self._store.has_failed(name)
        self._heard(row, 1.0, "")

    def ended(self, row: int, outcome: Outcome) -> None:
        """Seal what a row gave."""
        name, shortcut = self._running.pop(row)
        self._parts.pop(row, None)
        self._store.seal(
            Record(
                (name, shortcut),
                {key: _plain(own) for key, own in outcome.values.items()},
                outcome.stages,
                outcome.reason,
                outcome.wall_s,
                outcome.again,
                self._work.with_folder,
            ),
            name,
        )
        self._ran += 1
        self._failed += bool(outcome.reason)
        _LOG.info("run %d has ended%s", row, f": {outcome.reason}" if outcome.reason else "")
        self._heard(row, 1.0, outcome.reason)
        self._tell()
        if not self._is_open and self._gate is not None:
            self._is_open = True
            self._gate(outcome.wall_s, self._left(), self._places)

    def _left(self) -> int:
        """Rows that are not sealed yet, as far as their shortcuts tell."""
        ahead, work = self._rows[self._next :], self._work
        sealed = (self._store.is_sealed(work.shortcut(row), work.with_folder) for row in ahead)
        return len(ahead) - sum(sealed)

    def told(self, row: int, part: float, word: str = "") -> None:
        """Hear how far a row is, or that time passes."""
        if row in self._running:
            self._parts[row] = part
            self._heard(row, part, word)
        self._tell()

    def _tell(self) -> None:
        now = time.monotonic()
        if now - self._flushed > _FLUSH:
            self._store.flush()
            self._flushed = now
            self._told(self.standing)


def _plain(found: Found) -> tuple[float | None, float | None, bool]:
    """A measure as JSON holds it."""
    value, half = (own if math.isfinite(own) else None for own in found[:2])
    return value, half, found.is_beyond
