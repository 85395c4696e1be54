"""Runner of a sweep: each row is one file, and any executor computes the rows.

A row is the file ``rows/DIGEST.json``. It is created exclusively and empty when the row
starts, and replaced by the complete file when the row ends. A killed sweep leaves empty
files for the rows that were running; the next run of the same rows removes them.
"""

import importlib
import logging
import os
import shutil
import statistics
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from multiprocessing import active_children, current_process, get_context
from pathlib import Path
from typing import Any, NamedTuple

from presswear.recording.observer import Observer
from presswear.results.provenance import program_digest
from presswear.results.result import Result, load
from presswear.scene.scene import Scene
from presswear.sweeps.response_readers import Response
from presswear.sweeps.responses import (
    Requested,
    User,
    responses_of,
    user_responses,
)
from presswear.tools.errors import InputError, RunFailed, not_installed
from presswear.tools.files import holder, read_checked, write_bytes
from presswear.tools.processes import (
    cores,
    end_with_parent,
    is_stopped,
    starting_processes,
)

ROWS = "rows"  # folder of the files of rows
RUNS = "runs"  # folder of complete results
POLL = 0.2  # time between two reports of the progress, s
QUEUED = 2  # rows submitted for each worker, so that no worker waits for the next row
CONNECT = 10.0  # time in which a Dask scheduler must answer, s
CLOSE = 5.0  # time in which a Dask cluster must close, s
LOCAL = "127.0.0.1"
Notify = Callable[[str], object]


@dataclass(frozen=True)
class Outcome:
    """Content of the file of a row: responses by key, or the reason why the run failed."""

    values: dict[str, Response] = field(default_factory=dict)
    error: str = ""
    seconds: float = 0.0  # wall time


class Progress(NamedTuple):
    """Progress of a sweep."""

    rows: int
    done: int
    failed: int
    slots: int  # rows that are computed at a time
    seconds: float  # median wall time of the completed rows; 0 before the first


def run_row(
    scene: Scene, requested: Requested, folder: Path | None, program: str
) -> Outcome:
    """Run the scene of a row in this process and return its responses without user functions.

    The complete result is stored in `folder`, unless it is None. An error of the machine
    is raised, an error of the scene is stored in the outcome. `InputError` if the program
    of this process differs from `program`, because the numbers would differ.
    """
    return run_scene(scene, requested, folder, program)[0]


def run_scene(
    scene: Scene, requested: Requested, folder: Path | None, program: str
) -> tuple[Outcome, Result | None]:
    """Run the scene of a row in this process; see `run_row`. The result is None if it failed."""
    if program_digest() != program:
        raise InputError(
            "a worker has another program: install equal versions of all packages"
        )
    from presswear.campaign.runs import run

    while folder is not None and holder(folder):
        time.sleep(POLL)  # a worker of a killed sweep ends within a second
    start = time.perf_counter()
    result = None
    values: dict[str, Response] = {}
    try:
        result = run(scene, folder, jobs=1, observers=[Observer()], check=False)
        message = result.message if result.status == "failed" else ""
        values = {} if message else responses_of(result, requested)
    except (OSError, MemoryError):
        raise
    # A user law may raise anything. Its error belongs to this row and must not end the
    # sweep.
    except Exception as error:
        if is_stopped():  # any error may follow a signal
            raise KeyboardInterrupt from None
        if isinstance(error, RunFailed) and error.finding is None:
            raise
        message = _message(error)
    outcome = Outcome(values, message, time.perf_counter() - start)
    return outcome, None if message else result


def with_functions(
    outcome: Outcome, functions: Sequence[User], read: Callable[[], Result]
) -> Outcome:
    """Return an outcome with the responses that are user functions, computed in this process.

    A worker may not be able to import a function of a notebook. An error of a function
    is stored as the error of the row.
    """
    if outcome.error or not functions:
        return outcome
    try:
        return replace(
            outcome, values=outcome.values | user_responses(read(), functions)
        )
    except (OSError, MemoryError):
        raise
    # A response of the user may raise anything; its error belongs to this row.
    except Exception as error:
        return replace(outcome, values={}, error=_message(error))


def _message(error: Exception) -> str:
    if isinstance(error, InputError | RunFailed):
        return str(error)
    return f"{type(error).__name__}: {error}"


def read_row(folder: Path, name: str) -> Outcome | None:
    """Return the stored row of a sweep folder; None if it is missing, empty or damaged."""
    import msgspec

    try:
        return msgspec.json.decode(
            read_checked(folder / ROWS / f"{name}.json"), type=Outcome
        )
    except (InputError, msgspec.DecodeError):
        return None


def run_rows(
    folder: Path,
    scenes: Mapping[str, Callable[[], Scene]],
    requested: Requested,
    executor: Executor,
    slots: int,
    keep_results: bool = False,
    on_progress: Callable[[Progress], object] = lambda progress: None,
) -> None:
    """Run the rows that are not stored in a sweep folder; `RunFailed` if the executor fails.

    `scenes` are functions that return the scene of each row, by name. The executor
    computes `slots` rows at a time. `on_progress` is called several times a second; an
    exception from it ends the sweep.
    """
    (folder / ROWS).mkdir(exist_ok=True)
    rows = _Rows(folder, requested, keep_results)
    rows.read(scenes)
    running: dict[Future[Outcome], str] = {}

    def report() -> None:
        on_progress(rows.progress(len(scenes), slots))

    def collect() -> None:
        for future in wait(running, POLL, FIRST_COMPLETED).done:
            rows.store(running.pop(future), _outcome(future))
        report()

    try:
        report()
        for name, scene in scenes.items():
            if not rows.start(name):
                continue
            try:
                arguments = rows.arguments(name, scene())
            except InputError as error:  # settings do not fit together
                rows.store(name, Outcome(error=str(error)))
            else:
                running[executor.submit(run_row, *arguments)] = name
            while len(running) >= QUEUED * slots - 1:
                collect()
        while running:
            collect()
        report()
    finally:
        for future in running:
            future.cancel()
        rows.remove_unfinished()


class _Rows:
    """Files of the rows of a sweep, and the rows that this process has started."""

    def __init__(self, folder: Path, requested: Requested, keep_results: bool) -> None:
        self._folder = folder
        self._requested = requested
        self._keeps_results = keep_results
        # User functions get the complete result, which the worker leaves in its folder.
        self._stores_results = keep_results or bool(requested.functions)
        self._program = program_digest()
        self._completed: list[Outcome] = []
        self._started: set[str] = set()

    def _file(self, name: str) -> Path:
        return self._folder / ROWS / f"{name}.json"

    def read(self, names: Iterable[str]) -> None:
        """Read the rows that are stored, and remove empty and incomplete ones."""
        for name in names:
            outcome = read_row(self._folder, name)
            has_result = (self._folder / RUNS / name).exists()
            if outcome and (outcome.error or not self._keeps_results or has_result):
                self._completed.append(outcome)
            else:
                self._file(name).unlink(missing_ok=True)

    def start(self, name: str) -> bool:
        """Create the file of a row.

        Returns False if the row is stored, or if another part of the sweep computes it.
        """
        try:
            self._file(name).open("x").close()
        except FileExistsError:
            return False
        self._started.add(name)
        return True

    def arguments(
        self, name: str, scene: Scene
    ) -> tuple[Scene, Requested, Path | None, str]:
        """Return the arguments of ``run_row`` for a row."""
        path = self._folder / RUNS / name if self._stores_results else None
        return scene, replace(self._requested, functions=()), path, self._program

    def store(self, name: str, outcome: Outcome) -> None:
        """Write the file of a completed row."""
        import msgspec

        path = self._folder / RUNS / name
        read = partial(load, path, trust=True)
        outcome = with_functions(outcome, self._requested.functions, read)
        if self._stores_results and not self._keeps_results:
            shutil.rmtree(path, ignore_errors=True)
        write_bytes(self._file(name), msgspec.json.encode(outcome))
        self._started.discard(name)
        self._completed.append(outcome)

    def progress(self, count: int, slots: int) -> Progress:
        """Return the progress of a sweep of ``count`` rows."""
        failed = sum(bool(outcome.error) for outcome in self._completed)
        durations = [outcome.seconds for outcome in self._completed]
        seconds = [duration for duration in durations if duration > 0.0]
        median = statistics.median(seconds or [0.0])
        return Progress(count, len(self._completed), failed, slots, median)

    def remove_unfinished(self) -> None:
        """Remove the files of rows that were started and are not complete."""
        for name in self._started:
            # A signal can arrive just after a row is written.
            if read_row(self._folder, name) is None:
                self._file(name).unlink(missing_ok=True)


def _outcome(future: Future[Outcome]) -> Outcome:
    try:
        return future.result()
    except (InputError, RunFailed):
        raise
    # Executors of any package are accepted, and they have no common error for a broken
    # worker, a lost connection or an argument that cannot be sent.
    except Exception as error:
        reason = f"{type(error).__name__}: {error}".rstrip(": ")
        remedy = 'a script that starts processes needs if __name__ == "__main__":'
        raise RunFailed(f"the executor failed ({reason}); {remedy}") from None


class SerialExecutor(Executor):
    """Executor that computes each row in this process as it is submitted."""

    def submit(  # noqa: D102
        self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any
    ) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@contextmanager
def open_executor(
    on: str, jobs: int | None, notify: Notify = print
) -> Iterator[tuple[Executor, int]]:
    """Open the executor of the option ``--on``, see `sweep`, and yield it with its slots.

    `notify` is called with a line for the user, such as the address of the Dask
    dashboard. `InputError` if the executor does not exist or does not answer.
    """
    count = jobs or cores()
    if on == "dask" or on.startswith("dask://"):
        with _dask_executor(on, count, notify) as opened:
            yield opened
    elif on:
        executor = _user_executor(on)
        try:
            yield executor, getattr(executor, "_max_workers", count)
        finally:
            executor.shutdown(wait=False, cancel_futures=True)
    elif count == 1 or current_process().daemon:
        yield SerialExecutor(), 1
    else:
        with ProcessExecutor(count) as executor:
            yield executor, count


class ProcessExecutor(ProcessPoolExecutor):
    """Processes of this machine that end with this process."""

    def __init__(self, count: int) -> None:
        # A fork would copy the locks of numerical libraries and of the progress bar.
        context = get_context("forkserver" if sys.platform == "linux" else "spawn")
        context.set_forkserver_preload([__name__, "presswear.campaign.runs"])
        self._before = set(active_children())
        super().__init__(count, context, end_with_parent)

    def submit(  # noqa: D102
        self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any
    ) -> Future[Any]:
        with starting_processes():
            return super().submit(fn, *args, **kwargs)

    def __exit__(
        self, kind: object, error: BaseException | None, trace: object
    ) -> None:
        if error is not None:
            for process in set(active_children()) - self._before:
                process.terminate()
        self.shutdown(wait=error is None, cancel_futures=True)


def _user_executor(on: str) -> Executor:
    module, _, name = on.partition(":")
    if not (module and name):
        example = "MODULE:FACTORY, such as concurrent.futures:ProcessPoolExecutor"
        raise InputError(f"on = {on}: expected dask, dask://HOST:PORT or {example}")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        executor = getattr(importlib.import_module(module), name)()
    except (ImportError, AttributeError, TypeError) as error:
        raise InputError(f"on = {on}: {error}") from None
    if not isinstance(executor, Executor):
        raise InputError(f"on = {on}: {type(executor).__name__} is not an Executor")
    return executor


@contextmanager
def _dask_executor(
    on: str, count: int, notify: Notify
) -> Iterator[tuple[Executor, int]]:
    try:
        import dask
        from distributed import Client
    except ImportError:
        raise not_installed(f"on = {on}", "distributed") from None
    address = on.removeprefix("dask").removeprefix("://")
    local: dict[str, Any] = {}  # settings of a cluster of this machine
    if on == "dask":
        local = {
            "n_workers": count,
            "threads_per_worker": 1,
            "host": LOCAL,
            "dashboard_address": f"{LOCAL}:0",
            "silence_logs": logging.CRITICAL,
        }
    elif not address.rpartition(":")[2].isdigit():
        raise InputError(
            f"on = {on}: expected dask://HOST:PORT, such as dask://head:8786"
        )
    for name in ("distributed", "tornado", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with dask.config.set({"distributed.comm.timeouts.connect": f"{CONNECT}s"}):
        server = f"tcp://{address}" if address else None
        try:
            client = Client(server, timeout=CONNECT, **local)
        except (OSError, TimeoutError, ValueError) as error:
            raise InputError(
                f"on = {on}: no scheduler answers within {CONNECT:g} s "
                f"({type(error).__name__})"
            ) from None
        try:
            if local:
                notify(f"Dask dashboard at {client.dashboard_link}")
            slots = max(sum(client.nthreads().values()), 1)
            yield client.get_executor(pure=False), slots
        finally:
            with suppress(Exception):  # the scheduler may be gone
                client.close(timeout=CLOSE)
