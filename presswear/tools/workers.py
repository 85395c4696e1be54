"""Jobs done at once in processes of their own, or one after another in this one.

A job is a function that can be pickled.  It is given another one, to be called many times a
second with how far it is, which is also where it is stopped; what it has by then it can hand
over as ``Stopped``.  Nothing that it gives depends on where or when it runs.

Processes are forked from a server that has imported what jobs need and done nothing else (on
Linux; elsewhere they begin from nothing): a fork of this process would copy the locks of
threads that it does not copy, of numerical libraries, of a progress bar, of a window.  The
first job runs alone until it first tells how far it is, so that one process compiles what is not
compiled yet and the others load it.

A process may be killed at any moment.  Progress is therefore written to shared memory without a
lock, and results are written to files.  In the pipe of an executor, which all processes share,
half of a result would leave the reader waiting forever.
"""

import ctypes
import logging
import math
import multiprocessing
import os
import pickle
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from importlib import import_module
from multiprocessing.connection import wait as wait_for
from types import ModuleType, TracebackType
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from presswear.tools.errors import RunFailed
from presswear.tools.stopping import deferred, is_stopped

Array = NDArray[np.float64]

_LOG = logging.getLogger(__name__)


class Report(Protocol):
    """Hears from a job how far it is, many times a second; KeyboardInterrupt stops the job.

    NaN, with a word: it is getting ready, and so should no other.
    """

    def __call__(self, done: float, word: str = "", rows: Array | None = None) -> None:
        """Hear how far, in the job's own measure, in words, and numbers to be shown, (n, m)."""


Job = Callable[[Report], Any]
Ended = Callable[[int, Any], Mapping[int, Job | None]]
"""Hears by its key that a job has ended, with what it gave; gives further jobs by their keys, and
None for a key whose job is not wanted any more, whether it runs or waits."""
Told = Callable[[int, float, str, Array | None], None]
"""Hears by its key what a job has told."""
Lost = Callable[[str], None]


class Stopped(KeyboardInterrupt):
    """Raised by a job that is stopped, with what it has come to.

    Attributes
    ----------
    outcome : object
        As it would have given it itself.
    """

    def __init__(self, outcome: Any) -> None:
        super().__init__(outcome)
        self.outcome = outcome


class Workers(Protocol):
    """Something that does jobs.

    Attributes
    ----------
    lasts : float
        Wall time after which a job that can be gone on with is to hand over what it has, s.
    """

    lasts: float

    def run(self, jobs: Mapping[int, Job], ended: Ended, told: Told) -> None:
        """Do jobs, and those that come of them; interrupted, ``ended`` hears what there is."""


def outcomes(workers: Workers, jobs: Sequence[Job]) -> list[Any]:
    """Do jobs that nothing comes of; what they gave, in their order."""
    found: dict[int, Any] = {}

    def ended(key: int, outcome: Any) -> Mapping[int, Job | None]:
        found[key] = outcome
        return {}

    workers.run(dict(enumerate(jobs)), ended, lambda key, done, word, rows: None)
    return [found[key] for key in range(len(jobs))]


def cores() -> int:
    """Cores that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class InProcess:
    """Does one job after another in this process."""

    def __init__(self, lasts: float = math.inf) -> None:
        self.lasts = lasts

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        """Leave nothing behind."""

    def run(self, jobs: Mapping[int, Job], ended: Ended, told: Told) -> None:
        """Do jobs in their order, those that come of them behind the others."""
        waiting: dict[int, Job] = dict(jobs)
        while waiting:
            key = next(iter(waiting))
            job = waiting.pop(key)

            def report(
                done: float, word: str = "", rows: Array | None = None, key: int = key
            ) -> None:
                told(key, done, word, rows)

            try:
                outcome = job(report)
            except Stopped as stopped:
                ended(key, stopped.outcome)
                raise KeyboardInterrupt from None
            for other, following in ended(key, outcome).items():
                waiting.pop(other, None)
                if following is not None:
                    waiting[other] = following


WORD = 160
"""Bytes of a word that a job tells."""
ROWS_EVERY = 0.02
"""Least time between two rows that a job shows, s."""
POLL = 0.1
"""Time between two looks at the processes, s."""
GRACE = 3.0
"""Time that a job is given to see that it is to stop, s: the compiler never does."""


class _Board:
    """What processes tell, and which are to stop: a place for each, in shared memory.

    A word or rows may be read while they are written: they are there to be looked at.

    Attributes
    ----------
    folder : str
        Folder of the files with results.
    """

    def __init__(self, context: Any, places: int, room: int) -> None:
        self._room = room
        self.folder = tempfile.mkdtemp(prefix="presswear-")
        self.halt = context.RawValue(ctypes.c_bool, False)
        self.stops = context.RawArray(ctypes.c_bool, places)
        self.done = context.RawArray(ctypes.c_double, [math.nan] * places)
        self.words = context.RawArray(ctypes.c_char, places * WORD)
        self.rows = context.RawArray(ctypes.c_double, places * (2 + room))

    def stop(self) -> None:
        """Stop all jobs, for good."""
        self.halt.value = True
        for place in range(len(self.stops)):
            self.stops[place] = True

    def clear(self, place: int) -> None:
        """Make a place ready for another job."""
        self.stops[place], self.done[place] = False, math.nan
        self.rows[place * (2 + self._room)] = 0.0
        self._write(place, "")

    def _write(self, place: int, word: str) -> None:
        text = word.encode()[:WORD].ljust(WORD, b"\0")
        self.words[place * WORD : (place + 1) * WORD] = text

    def tell(self, place: int, done: float, word: str, rows: Array | None) -> None:
        """Write what a job tells."""
        self._write(place, word)
        if rows is not None and rows.size <= self._room:
            first = place * (2 + self._room)
            own = np.frombuffer(self.rows)[first : first + 2 + rows.size]
            own[2:] = rows.ravel()
            own[:2] = rows.shape
        self.done[place] = done

    def told(self, place: int) -> tuple[float, str, Array | None]:
        """What was written last."""
        text = self.words[place * WORD : (place + 1) * WORD].rstrip(b"\0")
        first = place * (2 + self._room)
        own = np.frombuffer(self.rows)[first : first + 2 + self._room]
        count, width = (int(number) for number in own[:2])
        rows = own[2 : 2 + count * width].reshape(count, width).copy() if count else None
        return self.done[place], text.decode(errors="ignore"), rows


class Pool:
    """Does jobs in processes of their own, so many at a time.

    They end with this process, however it ends.  Those that are killed, by somebody or by a
    system that is out of memory, are replaced, and their jobs done again; where that happens
    again and nothing was done in between there are half as many.

    Attributes
    ----------
    lasts : float
    """

    def __init__(
        self,
        count: int,
        imports: Sequence[str] = (),
        lasts: float = math.inf,
        room: int = 0,
        lost: Lost = lambda line: None,
    ) -> None:
        """Know what processes are to be; they begin with the first job.

        Parameters
        ----------
        count : int
        imports : sequence of str
            Modules that jobs need.
        room : int
            Most numbers in rows that a job shows; 0: none are.
        lost : callable
            Told in a line where a process was killed and is replaced.
        """
        self.lasts, self._lost = lasts, lost
        self._count, self._imports, self._room = count, tuple(imports), room
        self._is_again = False
        self._pool: ProcessPoolExecutor | None = None

    def _begin(self) -> None:
        _LOG.info("%d processes begin", self._count)
        context = _context(self._imports)
        self._is_warm = False
        self._board = _Board(context, self._count, self._room)
        self._pool = ProcessPoolExecutor(
            self._count, context, _prepare, (self._board, self._imports)
        )
        # All of them now: one that is asked for later would import when the others work.
        with suppress(BrokenProcessPool):  # whoever hands out a job will see
            for _ in range(self._count):
                self._submit(os.getpid)

    def _submit(self, function: Callable[..., Any], *given: Any) -> "Future[Any]":
        assert self._pool is not None, "processes have begun"
        with undisturbed():
            return self._pool.submit(function, *given)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._end(wait=error is None)

    def _end(self, wait: bool) -> None:
        if self._pool is not None:
            self._board.stop()
            self._pool.shutdown(wait, cancel_futures=True)
            shutil.rmtree(self._board.folder, ignore_errors=True)
            self._pool = None

    def run(self, jobs: Mapping[int, Job], ended: Ended, told: Told) -> None:
        """Do jobs, at most one in each process at a time, those that come of them last.

        Raises
        ------
        RunFailed
            Where the last process was killed again and again.
        """
        waiting: dict[int, Job] = dict(jobs)
        running: dict[Future[Any], tuple[int, int, Job]] = {}
        dropped: set[int] = set()
        try:
            while waiting or running:
                is_lost = not self._fill(waiting, running)
                done = wait(running, POLL, FIRST_COMPLETED).done
                # Of a pool that broke some may be finished all the same.
                for future in sorted(done, key=lambda own: own.exception() is not None):
                    if isinstance(future.exception(), BrokenProcessPool | MemoryError):
                        is_lost = True
                        break
                    _, key, _ = running[future]
                    further = {} if key in dropped else ended(key, _outcome(future.result()))
                    del running[future]
                    dropped.discard(key)
                    self._is_warm, self._is_again = True, False
                    for other, following in further.items():
                        waiting.pop(other, None)
                        if following is not None:
                            waiting[other] = following
                        for place, busy, _ in running.values():
                            if busy == other:
                                self._board.stops[place] = True
                                dropped.add(other)
                if is_lost:
                    lost = {key: job for _, key, job in running.values() if key not in dropped}
                    waiting, running, dropped = lost | waiting, {}, set()
                    self._replace()
                self._look(running, told)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) or is_stopped():
                self._collect(running, dropped, ended)
            self._end(wait=False)
            raise

    def _fill(self, waiting: dict[int, Job], running: dict["Future[Any]", Any]) -> bool:
        """Hand out jobs to places that are free; False where a process has been killed."""
        if self._pool is None:
            self._begin()
        busy = {place for place, _, _ in running.values()}
        free = [place for place in range(self._count) if place not in busy]
        if not self._is_warm:
            free = free[: 1 - len(busy)]
        try:
            for place, key in zip(free, list(waiting), strict=False):
                self._board.clear(place)
                job = waiting[key]
                running[self._submit(_do, place, job)] = place, key, job
                del waiting[key]
        except BrokenProcessPool:
            return False
        return True

    def _look(self, running: Mapping["Future[Any]", tuple[int, int, Job]], told: Told) -> None:
        """Hand on what was told."""
        for place, key, _ in running.values():
            done, word, rows = self._board.told(place)
            is_ready = not math.isnan(done)
            self._is_warm |= is_ready
            if is_ready or word:
                told(key, done, word, rows)

    def _replace(self) -> None:
        """Begin anew behind a process that was killed."""
        if self._is_again:
            self._count //= 2
        self._is_again = True
        self._end(wait=False)
        if self._count == 0:
            raise RunFailed(
                "worker processes were ended from outside again and again, as a system does that "
                "is out of memory"
            )
        line = (
            "a worker process was ended from outside, as a system does that is out of memory: what "
            f"was at work is done again, {self._count} at a time"
        )
        _LOG.warning(line)
        self._lost(line)

    def _collect(
        self,
        running: Mapping["Future[Any]", tuple[int, int, Job]],
        dropped: set[int],
        ended: Ended,
    ) -> None:
        """Stop all jobs, and hand on what they have come to."""
        self._board.stop()
        wait(running)
        for future, (_, key, _) in running.items():
            if key not in dropped and future.exception() is None:
                ended(key, _outcome(future.result()))


def workers_for(
    count: int,
    imports: Sequence[str] = (),
    lasts: float = math.inf,
    room: int = 0,
    lost: Lost = lambda line: None,
) -> InProcess | Pool:
    """The cheapest that can do so many jobs at once; see ``Pool``."""
    # A process that is to end with its own parent may have no children.
    is_alone = count <= 1 or multiprocessing.current_process().daemon
    return InProcess(lasts) if is_alone else Pool(count, imports, lasts, room, lost)


def _context(imports: Sequence[str]) -> Any:
    """How processes begin on this system."""
    if sys.platform != "linux":
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(imports))
    return context


def foresee(imports: Sequence[str]) -> None:
    """Have imported what the jobs of a ``Pool`` will need while this process does other things."""
    if sys.platform == "linux" and cores() > 1 and not multiprocessing.current_process().daemon:
        from multiprocessing import forkserver  # elsewhere there is none

        _context(imports)
        with undisturbed():
            forkserver.ensure_running()


@contextmanager
def undisturbed() -> Iterator[None]:
    """Begin processes that signals to a whole terminal do not reach, and no script's main module.

    They would run a script again that does not ask whether it is the main one.  Signals that are
    held back here arrive behind it.  They import from where this one does: the server of forks
    would look into the working directory first.
    """
    main, environment = sys.modules["__main__"], dict(os.environ)
    os.environ["PYTHONPATH"] = os.pathsep.join(map(os.path.abspath, sys.path))
    os.environ["PYTHONSAFEPATH"] = "1"
    held = {getattr(signal, name) for name in ("SIGINT", "SIGHUP") if hasattr(signal, name)}
    mask = getattr(signal, "pthread_sigmask", None)
    before = mask(signal.SIG_BLOCK, held) if mask else None
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        with deferred():
            yield
    finally:
        sys.modules["__main__"] = main
        for name in ("PYTHONPATH", "PYTHONSAFEPATH"):
            os.environ.pop(name)
            if name in environment:
                os.environ[name] = environment[name]
        if mask:
            mask(signal.SIG_SETMASK, before)


def end_with_parent() -> None:
    """End this process when its parent has ended, even if that was killed.

    A process of an executor would wait for jobs forever: it holds both ends of their pipe.
    """
    parent = multiprocessing.parent_process()
    assert parent is not None, "a process of an executor has a parent"

    def watch() -> None:
        wait_for([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


_BOARD: list[_Board] = []
"""In a process of a pool: where it tells how far it is."""
_STOPS = threading.Event()
"""In a process of a pool: its job has seen that it is to stop."""


def _prepare(board: _Board, imports: Sequence[str]) -> None:
    """Make a process of a pool ready."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # its parent decides
    _BOARD.append(board)
    threading.Thread(target=_outlive_nobody, args=(board,), daemon=True).start()
    for name in imports:
        import_module(name)


def _outlive_nobody(board: _Board) -> None:
    """End this process when its parent has ended, or waits in vain for it to stop."""
    parent = multiprocessing.parent_process()
    assert parent is not None, "a process of a pool has a parent"
    halted = 0.0
    while halted < GRACE:
        if wait_for([parent.sentinel], 1.0):
            break
        halted += board.halt.value and not _STOPS.is_set()
    else:
        os._exit(1)
    shutil.rmtree(board.folder, ignore_errors=True)
    os._exit(1)


def _outcome(path: str) -> Any:
    """Return the result that a process has written to a file."""
    with open(path, "rb") as file:
        return pickle.load(file)


def _do(place: int, job: Job) -> str:
    """Do a job in a process of a pool; return the path of the file with its result."""
    (board,) = _BOARD
    shown = -math.inf

    def report(done: float, word: str = "", rows: Array | None = None) -> None:
        nonlocal shown
        now = time.perf_counter()
        if rows is not None and now - shown < ROWS_EVERY:
            rows = None
        elif rows is not None:
            shown = now
        board.tell(place, done, word, rows)
        if board.stops[place]:
            if board.halt.value:
                _STOPS.set()
            raise KeyboardInterrupt

    try:
        outcome = job(report)
    except Stopped as stopped:
        outcome = stopped.outcome
    handle, path = tempfile.mkstemp(dir=board.folder)
    with open(handle, "wb") as file:
        pickle.dump(outcome, file)
    return path
