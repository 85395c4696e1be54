"""What does the rows of a sweep: processes here, Dask, or any executor; chosen by a word.

=====================  ==================================================================
nothing                processes of this machine, one a core
``dask``               a local cluster of Dask, with its dashboard
``dask://HOST:PORT``   the cluster of a scheduler that runs
``MODULE:FACTORY``     what a function of yours gives: any ``concurrent.futures.Executor``
=====================  ==================================================================

None of them plans anything: rows are handed out as places get free, and what is finished is
taken in any order.
"""

import importlib
import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, wait
from concurrent.futures import Future as Promise
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Protocol

from presswear.sweeps.cluster import (
    ANSWER,
    RETRIES,
    NoAnswer,
    Say,
    cluster,
    needs_distributed,
    places_of,
)
from presswear.sweeps.work import Outcome, RowJob
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.workers import Array, Job, cores, workers_for

BACK = 60.0
"""Time in which an executor that was lost comes back, s."""
_POLL = 0.2
_LOOK = 5.0
"""Time between two looks at how many workers there are, s."""
_AHEAD = 2
"""Rows that are handed out for each place."""
_ROW = "presswear.sweeps.work"
DASK = "dask"


class Feed(Protocol):
    """Rows that are to be done."""

    @property
    def is_over(self) -> bool:
        """True once there are no more to take, now or later."""

    def begun(self, places: int) -> None:
        """Hear how many rows are done at once."""

    def take(self, most: int) -> Mapping[int, RowJob]:
        """The next rows; none where others are at work on what is left."""

    def ended(self, row: int, outcome: Outcome) -> None:
        """Hear what a row gave."""

    def told(self, row: int, part: float, word: str = "") -> None:
        """Hear how far a row is, and where it stands, or that time passes (row -1)."""


Runner = Callable[[Feed], None]
"""Does all rows of a feed; RunFailed where it cannot go on."""


def runner_of(on: str, jobs: int | None, say: Say) -> Runner:
    """What does the rows, by its word; InputError where there is none of it.

    Parameters
    ----------
    on : str
        See the head of this module.
    jobs : int or None
        Rows at a time of processes here; None: as many as there are cores.
    say : callable
        Told lines for the person who waits.
    """
    if not on:
        return _Local(jobs or cores(), say)
    if on == DASK or on.startswith(f"{DASK}://"):
        needs_distributed()
        address = on.removeprefix(DASK).removeprefix("://")
        if on != DASK and not address.rpartition(":")[2].isdigit():
            raise InputError(f"--on {on}: dask://HOST:PORT is expected, such as dask://head:8786")
        return _Futures(lambda wait_s: cluster(address, jobs, wait_s, say), places_of, say)
    module, colon, name = on.partition(":")
    if not (module and colon and name):
        raise InputError(
            f"--on {on}: dask, dask://HOST:PORT or MODULE:FACTORY is expected, such as "
            "concurrent.futures:ProcessPoolExecutor"
        )
    return _Futures(lambda _: _made(on, module, name), _places, say)


class _Local:
    """Rows in processes of this machine; see ``tools.workers``."""

    def __init__(self, count: int, say: Say) -> None:
        self._count, self._say = count, say

    def __call__(self, feed: Feed) -> None:
        out = 0  # rows that are handed out

        def taken() -> Mapping[int, Job]:
            nonlocal out
            # One is ready for whoever is done first.
            found = feed.take(self._count + 1 - out)
            out += len(found)
            return found

        def ended(row: int, outcome: Outcome) -> Mapping[int, Job]:
            nonlocal out
            out -= 1
            feed.ended(row, outcome)
            return taken()

        def told(row: int, part: float, word: str, rows: Array | None) -> None:
            # It is not a number where a row gets ready.
            feed.told(row, 0.0 if math.isnan(part) else part, word)

        feed.begun(self._count)
        with workers_for(self._count, (_ROW,), lost=self._say) as workers:
            while not feed.is_over:
                first = taken()
                if first:
                    workers.run(first, ended, told)
                elif not feed.is_over:
                    _idle(feed)


def _idle(feed: Feed) -> None:
    feed.told(-1, 0.0)
    time.sleep(_POLL)


class _Futures:
    """Rows through an executor, made anew where it is lost.

    Parameters
    ----------
    make : callable
        Gives the executor as a context; takes how long it may wait for it, s.
    places : callable
        Rows that it does at once.
    """

    def __init__(
        self,
        make: Callable[[float], AbstractContextManager[Executor]],
        places: Callable[[Executor], int],
        say: Say,
    ) -> None:
        self._make, self._places, self._say = make, places, say

    def __call__(self, feed: Feed) -> None:
        self._left: dict[int, RowJob] = {}
        self._fruitless = 0
        patience = ANSWER
        while self._left or not feed.is_over:
            try:
                with self._make(patience) as executor:
                    feed.begun(self._places(executor))
                    self._use(executor, feed)
            except (BrokenExecutor, CancelledError, ConnectionError) as error:
                self._fruitless += 1
                if self._fruitless > RETRIES:
                    raise RunFailed(f"the executor was lost again and again: {error}") from None
                self._say(f"the executor was lost ({error or type(error).__name__}): begun anew")
                patience = BACK
            except NoAnswer as error:
                if patience == BACK:
                    raise RunFailed(str(error)) from None
                raise

    def _use(self, executor: Executor, feed: Feed) -> None:
        running: dict[Promise[Outcome], int] = {}
        unsent = dict(self._left)
        places, looked = self._places(executor), time.monotonic()
        try:
            while unsent or running or not feed.is_over:
                if time.monotonic() - looked > _LOOK:
                    # Workers come and go.
                    places, looked = self._places(executor), time.monotonic()
                room = _AHEAD * places - len(running)
                if room > len(unsent):
                    taken = feed.take(room - len(unsent))
                    self._left.update(taken)
                    unsent.update(taken)
                for row in list(unsent)[: max(room, 0)]:
                    running[executor.submit(_done_here, unsent[row])] = row
                    del unsent[row]
                if not running:
                    _idle(feed)
                    continue
                for future in wait(running, _POLL, FIRST_COMPLETED).done:
                    outcome = _outcome(future)
                    row = running.pop(future)
                    del self._left[row]
                    self._fruitless = 0
                    feed.ended(row, outcome)
                feed.told(-1, 0.0)
        finally:
            for future in running:
                future.cancel()


def _done_here(job: RowJob) -> Outcome:
    """Do a job where nobody asks how far it is."""
    return job(lambda done, word="", rows=None: None)


def _outcome(future: "Promise[Outcome]") -> Outcome:
    """What a row gave; one that took its workers with it has failed."""
    error = future.exception()
    if error is not None and type(error).__name__ == "KilledWorker":
        reason = f"its workers were ended from outside {RETRIES + 1} times: out of memory?"
        return Outcome(reason=reason, again=True)
    return future.result()


def _places(executor: Executor) -> int:
    """Rows that an executor does at once, as far as it says so."""
    for name in ("_max_workers", "max_workers"):
        found = getattr(executor, name, None)
        if isinstance(found, int) and found > 0:
            return found
    return cores()


def _made(on: str, module: str, name: str) -> AbstractContextManager[Executor]:
    """The executor that somebody's function gives."""
    here = f"{Path.cwd()}"
    if here not in sys.path:
        sys.path.append(here)
    try:
        made = getattr(importlib.import_module(module), name)()
    except (ImportError, AttributeError, TypeError) as error:
        raise InputError(f"--on {on}: {error}") from None
    if not isinstance(made, Executor):
        raise InputError(f"--on {on}: it gives {type(made).__name__}, not an Executor")
    return _ended(made)


@contextmanager
def _ended(executor: Executor) -> Iterator[Executor]:
    """An executor that is shut down at the end, and at once where something is wrong."""
    try:
        yield executor
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        raise
    executor.shutdown()
