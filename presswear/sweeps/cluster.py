"""A cluster of Dask, local or of a scheduler that runs, as an executor."""

import importlib
import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, cast

from presswear.results.provenance import program_digest
from presswear.sweeps.work import WrongProgram
from presswear.tools.errors import InputError
from presswear.tools.workers import cores

if TYPE_CHECKING:
    from distributed import Client

ANSWER = 10.0
"""Time in which a scheduler answers, s."""
RETRIES = 3
"""Times that a row is done again whose worker was lost, and an executor is made anew with
nothing done in between."""
_POLL = 0.2
_HERE = "127.0.0.1"  # a local cluster accepts connections from this machine only
Say = Callable[[str], None]
"""Told lines for the person who waits."""


class NoAnswer(InputError):
    """A scheduler that is not there."""


def needs_distributed() -> None:
    """InputError where Dask is not installed."""
    try:
        importlib.import_module("distributed")
    except ImportError:
        raise InputError(
            "--on dask needs dask.distributed: pip install 'presswear[sweep]'"
        ) from None


@contextmanager
def cluster(address: str, jobs: int | None, patience: float, say: Say) -> Iterator[Executor]:
    """The executor of a cluster of Dask, whose workers have this program.

    InputError where no scheduler answers within a time, s, or a worker has another program;
    ConnectionError where the cluster is lost while it starts.
    """
    import dask
    from distributed import Client, LocalCluster

    for name in ("distributed", "tornado", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    settings = {
        "distributed.comm.timeouts.connect": f"{ANSWER}s",
        "distributed.scheduler.allowed-failures": RETRIES,
        "distributed.admin.large-graph-warning-threshold": "1GB",
    }
    with dask.config.set(settings), _closing_late() as keep:
        if address:
            client = keep(_connected(address, patience))
        else:
            try:
                cluster = keep(
                    LocalCluster(
                        host=_HERE,
                        n_workers=jobs or cores(),
                        threads_per_worker=1,
                        dashboard_address=f"{_HERE}:0",
                        silence_logs=logging.CRITICAL,
                    )
                )
                client = keep(Client(cluster, timeout=ANSWER))
            except (RuntimeError, OSError) as error:
                raise ConnectionError(f"the cluster did not start: {error}") from None
            say(
                f"cluster at dask{cluster.scheduler_address.removeprefix('tcp')}, dashboard at "
                f"{cluster.dashboard_link}"
            )
        for worker, found in _digests(client).items():
            if isinstance(found, OSError):
                raise ConnectionError(f"worker {worker} has ended")
            if found != program_digest():
                raise WrongProgram(
                    f"--on dask://{address}: worker {worker} has another program ({found}; here "
                    f"{program_digest()}): its numbers would not agree; install the same there"
                )
        yield client.get_executor(pure=False)


def _digests(client: "Client") -> dict[str, Any]:
    """Program digest of each worker, or the error with which the worker answers."""
    try:
        return cast(dict[str, Any], client.run(program_digest, on_error="return"))
    except OSError as error:
        raise ConnectionError(f"{error}") from None


@contextmanager
def _closing_late() -> Iterator[Callable[[Any], Any]]:
    """Close what was kept, the last first, whatever its own troubles."""
    held: list[Any] = []

    def keep(one: Any) -> Any:
        held.append(one)
        return one

    try:
        yield keep
    finally:
        for one in reversed(held):
            with suppress(Exception):
                one.close(timeout=2.0)


def _connected(address: str, patience: float) -> "Client":
    """A client of a scheduler that answers within a time, s."""
    from distributed import Client

    until = time.monotonic() + patience
    while True:
        left = min(max(until - time.monotonic(), 0.1), ANSWER)
        try:
            return Client(f"tcp://{address}", timeout=left)
        except (OSError, TimeoutError, ValueError) as error:
            if time.monotonic() + _POLL >= until:
                raise NoAnswer(
                    f"--on dask://{address}: no scheduler answers there within {patience:g} s "
                    f"({type(error).__name__})"
                ) from None
            time.sleep(_POLL)


def places_of(executor: Executor) -> int:
    """Threads of all workers that a cluster has now."""
    client: Client = cast(Any, executor)._client
    try:
        return max(sum(client.nthreads().values()), 1)
    except OSError as error:
        raise ConnectionError(f"{error}") from None
