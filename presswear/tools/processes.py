"""Jobs in worker processes or in this process, and signals that stop a command.

A job is a picklable function. It gets a function to report its progress, many times a second, which
is also where it is stopped. Its result does not depend on where or when it runs.

A worker may be killed at any moment. Progress and stop requests are therefore shared without a
lock, and results are written to files: half of a result in the pipe of an executor, which all
workers share, would leave its reader waiting forever.
"""

import math
import multiprocessing
import os
import pickle
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from multiprocessing.connection import wait as wait_for
from types import FrameType, ModuleType
from typing import Any, Self

from presswear.tools.arrays import Array
from presswear.tools.errors import RunFailed

POLL = 0.1  # s between two looks at the progress of workers
GRACE = 3.0  # s until a worker whose job does not stop is ended, for example while it compiles
STOP, HALT = 1.0, 2.0  # requests to a worker: stop the job; the pool ends
LOST = "a worker process was ended from outside, for example because memory ran out"


# Called by a job with its progress (nan while it gets ready) and optionally a word and rows, which
# stay in this process; KeyboardInterrupt stops the job.
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
        Number of worker processes, which start with the first job; 1: this process does the jobs.
    imports : sequence of str
        Modules that jobs need.
    lasts : float
        Wall time after which a job that can be resumed should return, s.
    """

    def __init__(
        self, count: int = 1, imports: Sequence[str] = (), lasts: float = math.inf
    ) -> None:
        # A process that ends with its parent may have no children.
        self.count = 1 if multiprocessing.current_process().daemon else count
        self.lasts, self._imports = lasts, tuple(imports)
        self._executor: ProcessPoolExecutor | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._end(wait=error is None)

    def run(self, jobs: Mapping[int, Job], on_result: OnResult, on_progress: OnProgress) -> None:
        """Run jobs, at most one in each worker, and those that follow after them.

        Raises
        ------
        RunFailed
            If a worker was killed.
        """
        waiting = dict(jobs)
        if self.count > 1:
            self._run_in_workers(waiting, on_result, on_progress)
        while waiting:
            key = next(iter(waiting))
            job = waiting.pop(key)
            try:
                outcome = job(
                    lambda done, word="", rows=None, k=key: on_progress(k, done, word, rows)
                )
            except Stopped as stopped:
                on_result(key, stopped.outcome)
                raise KeyboardInterrupt from None
            _follow(waiting, on_result(key, outcome))

    def _run_in_workers(
        self, waiting: dict[int, Job], on_result: OnResult, on_progress: OnProgress
    ) -> None:
        running: dict[Future[str], tuple[int, int]] = {}  # place and key
        dropped: set[int] = set()
        try:
            while waiting or running:
                self._submit(waiting, running)
                done = wait(running, POLL, FIRST_COMPLETED).done
                # When a pool breaks, some jobs may have finished all the same.
                for future in sorted(done, key=lambda each: each.exception() is not None):
                    key = running[future][1]
                    following = {} if key in dropped else on_result(key, _result(future))
                    del running[future]
                    dropped.discard(key)
                    _follow(waiting, following)
                    unwanted = {place: k for place, k in running.values() if k in following}
                    self._request(unwanted, STOP)
                    dropped.update(unwanted.values())
                for place, key in running.values():
                    part = self._shared[place]
                    if part != -math.inf:
                        on_progress(key, part, "", None)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) or is_stopped():
                self._request(range(self.count), HALT)
                wait(running)
                for future, (_, key) in running.items():
                    if key not in dropped and future.exception() is None:
                        on_result(key, _result(future))
            self._end(wait=False)
            if isinstance(error, BrokenProcessPool | MemoryError):
                raise RunFailed(LOST) from None
            raise

    def _submit(
        self, waiting: dict[int, Job], running: dict["Future[str]", tuple[int, int]]
    ) -> None:
        """Submit waiting jobs to free workers."""
        executor = self._executor or self._start()
        busy = {place for place, _ in running.values()}
        free = [place for place in range(self.count) if place not in busy]
        for place, key in zip(free, list(waiting), strict=False):
            self._shared[place], self._shared[self.count + place] = -math.inf, 0.0
            with starting_processes():
                running[executor.submit(_run_job, place, waiting.pop(key))] = place, key

    def _start(self) -> ProcessPoolExecutor:
        has_server = "forkserver" in multiprocessing.get_all_start_methods()
        context: Any = multiprocessing.get_context("forkserver" if has_server else "spawn")
        package = import_module("presswear").__path__[0]
        # The server of forks would import another version from the working directory.
        is_safe = not os.path.isdir("presswear") or os.path.samefile("presswear", package)
        if has_server and is_safe:
            context.set_forkserver_preload(list(self._imports))
        self._folder = tempfile.mkdtemp(prefix="presswear-")
        self._shared = context.RawArray("d", 2 * self.count)  # progress, then requests
        arguments = self._shared, self._folder, self._imports
        self._executor = ProcessPoolExecutor(self.count, context, _prepare, arguments)
        with starting_processes():
            for _ in range(self.count):  # start all workers now, so that they import together
                self._executor.submit(os.getpid)
        return self._executor

    def _request(self, places: Iterable[int], request: float) -> None:
        for place in places:
            self._shared[self.count + place] = request

    def _end(self, wait: bool) -> None:
        if self._executor is not None:
            self._request(range(self.count), HALT)
            self._executor.shutdown(wait, cancel_futures=True)
            shutil.rmtree(self._folder, ignore_errors=True)
            self._executor = None


def _follow(waiting: dict[int, Job], following: Mapping[int, Job | None]) -> None:
    for key, job in following.items():
        waiting.pop(key, None)
        if job is not None:
            waiting[key] = job


def _result(future: "Future[str]") -> Any:
    with open(future.result(), "rb") as file:
        return pickle.load(file)


_worker: dict[str, Any] = {}  # arguments of ``_prepare`` in a worker


def _prepare(shared: Any, folder: str, imports: Sequence[str]) -> None:
    """Prepare a worker."""
    _worker.update(shared=shared, folder=folder, is_running=False)
    end_with_parent(lambda: bool(shared[len(shared) - 1] == HALT and _worker["is_running"]), folder)
    for name in imports:
        import_module(name)


def _run_job(place: int, job: Job) -> str:
    """Run a job in a worker; return the path of the file with its result."""
    shared = _worker["shared"]

    def report(done: float, word: str = "", rows: Array | None = None) -> None:
        shared[place] = done
        if shared[len(shared) // 2 + place]:
            _worker["is_running"] = False
            raise KeyboardInterrupt

    _worker["is_running"] = True
    try:
        outcome = job(report)
    except Stopped as stopped:
        outcome = stopped.outcome
    finally:
        _worker["is_running"] = False
    handle, path = tempfile.mkstemp(dir=_worker["folder"])
    with open(handle, "wb") as file:
        pickle.dump(outcome, file)
    return path


def end_with_parent(is_stuck: Callable[[], bool] = lambda: False, folder: str = "") -> None:
    """Leave Ctrl-C to the parent; end this process when the parent has ended or was killed.

    It also ends after GRACE seconds in which ``is_stuck`` returned True. The folder is removed
    together with the parent.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None, "a process of an executor has a parent"

    def watch() -> None:
        stuck = 0.0
        while stuck < GRACE:
            if wait_for([parent.sentinel], 1.0):
                shutil.rmtree(folder, ignore_errors=True)
                break
            stuck = stuck + 1.0 if is_stuck() else 0.0
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


# Windows has no SIGHUP.
_SIGNALS = [getattr(signal, n) for n in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, n)]
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
def starting_processes(hides_main: bool = True) -> Iterator[None]:
    """Start processes that do not import the main module and that Ctrl-C does not reach.

    With the main module they would run a script a second time that lacks
    ``if __name__ == "__main__":``. A signal is delivered at the end: an executor that is abandoned
    while it starts a worker leaves one that fails with a traceback.
    """
    main, mask = sys.modules["__main__"], getattr(signal, "pthread_sigmask", None)
    blocked = mask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP}) if mask else None
    late: list[int] = []
    try:
        with _handling(lambda number, _: late.append(number)):
            if hides_main:
                sys.modules["__main__"] = ModuleType("__main__")
            yield
    finally:
        sys.modules["__main__"] = main
        if mask:
            mask(signal.SIG_SETMASK, blocked)
        if late:
            signal.raise_signal(late[0])


def _interrupt(number: int, frame: FrameType | None) -> None:
    _received.append(number)
    raise KeyboardInterrupt


@contextmanager
def stoppable() -> Iterator[None]:
    """Let SIGINT, SIGTERM and SIGHUP raise KeyboardInterrupt; ignored signals stay ignored.

    The program may be in a place that drops KeyboardInterrupt, or makes another error of it. A
    command therefore calls ``check_stopped`` with its progress, and any error after a signal counts
    as an interrupt.
    """
    _received.clear()
    hook = sys.unraisablehook
    # An object that a signal left incomplete fails when it is deleted, until the program ends.
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
