"""Jobs in worker processes or in this process, and signals that stop a command.

A job is a picklable function. It reports its progress many times a second by a function
that it gets, and this function raises KeyboardInterrupt to stop the job. The result of a
job does not depend on the process and the time in which it runs. A worker may be killed
at any moment. Each worker has its own pipe, so that half a message does not disturb the
others.

The executor of loky 3.7 does not replace this file: its futures report no progress, and a
signal to the parent alone leaves jobs running to their end, or kills them with their state.
"""

import math
import multiprocessing
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib import import_module
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for
from types import FrameType, ModuleType
from typing import Any, Self

from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed, shown

POLL = 0.1  # s between two reports of a worker
MAX_JOBS = 10_000  # worker processes at a time: no machine has as many cores
GRACE = 3.0  # s for a job to stop, after which its worker is ended
LOST = "a worker process was ended from outside, for example because memory ran out"
_STOPS = math.inf  # progress of a job that is stopping; it may store its state for long
# Values in place of the key of a job
_IDLE = "idle"
_DROPPED = "dropped"  # the result of the job is no longer needed

# Called by a job with its progress (nan while it gets ready) and optionally a word,
# which stays in this process, and rows; KeyboardInterrupt stops the job.
Report = Callable[..., object]
Job = Callable[[Report], Any]
OnResult = Callable[[int, Any], Mapping[int, Job | None]]
"""Called with the key and the result of a job; returns further jobs, None to drop a job."""
OnProgress = Callable[[int, float, str, Array | None], object]
"""Called with the key of a job and what it reports."""


class Stopped(KeyboardInterrupt):
    """Raised by a job that is stopped, with its result so far."""

    def __init__(self, outcome: Any) -> None:
        super().__init__(outcome)
        self.outcome = outcome


def check_jobs(jobs: int | None) -> None:
    """Raise InputError unless the number of processes is from 1 to ``MAX_JOBS``."""
    if jobs is not None and not 1 <= jobs <= MAX_JOBS:
        limit = "at least 1" if jobs < 1 else f"at most {MAX_JOBS}"
        raise InputError(f"jobs = {shown(jobs)}: must be {limit}")


def cores() -> int:
    """Return the number of cores that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Workers:
    """Worker processes for jobs, which end with this process; or this process alone.

    Parameters
    ----------
    count : int
        Number of worker processes, which start with the first job; 1: this process does
        the jobs.
    imports : sequence of str
        Modules that jobs need.
    job_duration : float
        Wall time after which a job that can be resumed should return, s.
    """

    def __init__(
        self,
        count: int = 1,
        imports: Sequence[str] = (),
        job_duration: float = math.inf,
    ) -> None:
        # A process that ends with its parent may have no children.
        self.count = 1 if multiprocessing.current_process().daemon else count
        self.job_duration = job_duration
        self._imports = tuple(imports)
        self._workers: list[_Worker] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.process.kill()
            worker.process.join()
            worker.pipe.close()
        self._workers = []

    def run(
        self, jobs: Mapping[int, Job], on_result: OnResult, on_progress: OnProgress
    ) -> None:
        """Run jobs, at most one in each worker, and the jobs that ``on_result`` returns.

        Raises
        ------
        RunFailed
            If a worker was killed.
        """
        waiting = dict(jobs)
        if self.count == 1:
            _run_here(waiting, on_result, on_progress)
            return
        self._workers = self._workers or self._started()
        try:
            while waiting or self._running:
                self._start_jobs(waiting)
                self._handle_results(waiting, on_result)
                self._report_progress(on_progress)
        except BaseException as error:
            self._stop_jobs(on_result, isinstance(error, KeyboardInterrupt))
            self.__exit__()
            raise

    def _start_jobs(self, waiting: dict[int, Job]) -> None:
        """Send a waiting job to each idle worker."""
        idle = [worker for worker in self._workers if worker.key == _IDLE]
        for worker, key in zip(idle, list(waiting), strict=False):
            worker.send(waiting.pop(key))
            worker.key = key
            worker.progress = None
            worker.rows = None

    def _handle_results(self, waiting: dict[int, Job], on_result: OnResult) -> None:
        """Pass results on, and stop running jobs that ``on_result`` replaces or drops."""
        for key, result in self._results():
            if isinstance(result, BaseException):
                raise result
            following = on_result(key, result)
            _follow(waiting, following)
            for worker in self._running:
                if worker.key in following:
                    worker.key = _DROPPED
                    worker.send(None)

    def _report_progress(self, on_progress: OnProgress) -> None:
        for worker in self._running:
            if worker.progress is not None and worker.key != _DROPPED:
                rows = worker.rows
                worker.rows = None
                on_progress(worker.key, worker.progress, "", rows)

    def _stop_jobs(self, on_result: OnResult, is_interrupt: bool) -> None:
        """Stop all jobs and wait for them; after an interrupt, pass on their results.

        A job that has not begun to stop after ``GRACE`` is not waited for.
        """
        due = time.monotonic() + GRACE
        for worker in self._running:
            worker.send(None)
        while any(
            worker.progress == _STOPS or time.monotonic() < due
            for worker in self._running
        ):
            for key, result in self._results():
                is_result = not isinstance(result, BaseException)
                if is_result and (is_interrupt or is_stopped()):
                    on_result(key, result)

    @property
    def _running(self) -> "list[_Worker]":
        return [worker for worker in self._workers if worker.key != _IDLE]

    def _results(self) -> Iterator[tuple[int, Any]]:
        """Read what workers send; yield keys and results, or errors, of jobs that are complete."""
        ready = wait_for([worker.pipe for worker in self._running], POLL)
        for worker in [worker for worker in self._running if worker.pipe in ready]:
            key = worker.key
            # A worker is not read again if an interrupt ends ``recv`` within a message.
            worker.key = _IDLE
            try:
                is_complete, content = worker.pipe.recv()
            except (EOFError, OSError):
                is_complete = True
                content = RunFailed(LOST)
            if not is_complete:
                worker.key = key
                worker.progress, rows = content
                if rows is not None:
                    worker.rows = rows
            elif key != _DROPPED:
                yield key, content

    def _started(self) -> "list[_Worker]":
        has_server = "forkserver" in multiprocessing.get_all_start_methods()
        context: Any = multiprocessing.get_context(
            "forkserver" if has_server else "spawn"
        )
        package = import_module("presswear").__path__[0]
        # The server of forks would import a presswear of the working directory first.
        is_safe = not os.path.isdir("presswear") or os.path.samefile(
            "presswear", package
        )
        if has_server and is_safe:
            context.set_forkserver_preload(list(self._imports))
        with starting_processes():
            return [_Worker(context, self._imports) for _ in range(self.count)]


class _Worker:
    """Worker process, and the job that it does."""

    key: Any = _IDLE  # key of the job
    progress: float | None = None  # completed part of the job, once it is reported
    rows: Array | None = None  # rows that the job has reported and nobody has read

    def __init__(self, context: Any, imports: Sequence[str]) -> None:
        self.pipe, end = context.Pipe()
        self.process = context.Process(target=_work, args=(end, imports), daemon=True)
        self.process.start()
        end.close()

    def send(self, job: Job | None) -> None:
        """Send a job, or None, the request to stop it."""
        # The pipe of a worker that was killed is broken. To read from it reports this.
        with suppress(BrokenPipeError):
            self.pipe.send(job)


def _run_here(
    waiting: dict[int, Job], on_result: OnResult, on_progress: OnProgress
) -> None:
    while waiting:
        key = next(iter(waiting))
        job = waiting.pop(key)
        try:
            outcome = job(partial(_report_here, on_progress, key))
        except Stopped as stopped:
            on_result(key, stopped.outcome)
            raise KeyboardInterrupt from None
        _follow(waiting, on_result(key, outcome))


def _report_here(
    on_progress: OnProgress,
    key: int,
    done: float,
    word: str = "",
    rows: Array | None = None,
) -> None:
    on_progress(key, done, word, rows)


def _follow(waiting: dict[int, Job], following: Mapping[int, Job | None]) -> None:
    for key, job in following.items():
        waiting.pop(key, None)
        if job is not None:
            waiting[key] = job


def _work(pipe: "Connection[Any, Any]", imports: Sequence[str]) -> None:
    """Do the jobs of a worker; send False with their progress, True with their results."""
    end_with_parent()
    for name in imports:
        import_module(name)
    with suppress(EOFError, ConnectionError):  # the parent has ended
        _do_jobs(pipe)


def _do_jobs(pipe: "Connection[Any, Any]") -> None:
    due = 0.0

    def report(done: float, word: str = "", rows: Array | None = None) -> None:
        nonlocal due
        if math.isnan(done) or rows is not None or time.monotonic() >= due:
            due = time.monotonic() + POLL
            pipe.send((False, (done, rows)))
            if pipe.poll() and pipe.recv() is None:
                pipe.send((False, (_STOPS, None)))
                raise KeyboardInterrupt

    while True:
        if (job := pipe.recv()) is None:
            continue  # the request came too late
        due = 0.0
        try:
            result = job(report)
        except Stopped as stopped:
            result = stopped.outcome
        except MemoryError:
            result = RunFailed(LOST)
        except BaseException as error:
            if not isinstance(error, InputError | RunFailed):
                error.add_note(f"in a worker process:\n{traceback.format_exc()}")
            result = error
        pipe.send((True, result))


def end_with_parent() -> None:
    """Leave Ctrl-C to the parent; end this process when the parent has ended or was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if mask := getattr(signal, "pthread_sigmask", None):
        mask(signal.SIG_UNBLOCK, {signal.SIGTERM})  # blocked by ``starting_processes``
    parent = multiprocessing.parent_process()
    assert parent is not None, "a worker has a parent"

    def watch() -> None:
        wait_for([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


# Windows has no SIGHUP.
_SIGNALS = [
    getattr(signal, n) for n in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, n)
]
_received: list[int] = []  # signals


@contextmanager
def _handling(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Handle the signals that are not ignored, in the main thread, which alone can."""
    previous = {}
    if threading.current_thread() is threading.main_thread():
        for number in _SIGNALS:
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                previous[number] = signal.signal(number, handler)
    try:
        yield
    finally:
        for number, before in previous.items():
            signal.signal(number, before)


@contextmanager
def signals_held() -> Iterator[None]:
    """Deliver a signal that comes within the context at its end."""
    late: list[int] = []
    try:
        with _handling(lambda number, _: late.append(number)):
            yield
    finally:
        if late:
            signal.raise_signal(late[0])


@contextmanager
def starting_processes() -> Iterator[None]:
    """Start processes that do not import the main module and that Ctrl-C does not reach.

    A process that imports the main module runs a script again if the script has no ``if
    __name__ == "__main__":``. A signal is delivered at the end of the context. During
    the start it would leave a worker that fails with a traceback, or a parent that waits
    for a process which has ended. The processes call ``end_with_parent`` first.
    """
    main = sys.modules["__main__"]
    mask = getattr(signal, "pthread_sigmask", None)
    if mask:
        # The tracker admits SIGINT when it starts, and the processes inherit that. Start
        # it before the signals are blocked.
        resource_tracker.ensure_running()
    blocked = mask(signal.SIG_BLOCK, _SIGNALS) if mask else None
    with signals_held():
        try:
            sys.modules["__main__"] = ModuleType("__main__")
            yield
        finally:
            sys.modules["__main__"] = main
            if mask:
                mask(signal.SIG_SETMASK, blocked)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _received.append(number)
    raise KeyboardInterrupt


@contextmanager
def stoppable() -> Iterator[None]:
    """Let SIGINT, SIGTERM and SIGHUP raise KeyboardInterrupt; ignored signals stay ignored.

    A library may drop KeyboardInterrupt or replace it by another error. A command
    therefore calls ``check_stopped`` with its progress, and any error after a signal
    counts as an interrupt.
    """
    _received.clear()
    hook = sys.unraisablehook
    # An object that a signal left incomplete may fail when it is deleted, at the latest
    # at the end of the program. Do not print this.
    sys.unraisablehook = lambda problem: None if is_stopped() else hook(problem)
    try:
        with _handling(_interrupt):
            yield
    finally:
        if not is_stopped():
            sys.unraisablehook = hook


def is_stopped() -> bool:
    """Return whether a signal has come."""
    return bool(_received)


def check_stopped() -> None:
    """Raise KeyboardInterrupt if a signal has come."""
    if is_stopped():
        raise KeyboardInterrupt


def exit_code() -> int:
    """Return 128 plus the number of the signal that has come."""
    return 128 + (_received[0] if _received else signal.SIGINT)
