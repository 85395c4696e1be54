"""Progress of several runs in one folder."""

import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import Progress as ProgressBar

from presswear.cli import terminal
from presswear.cli.run_observer import LINE_INTERVAL
from presswear.tools.processes import check_stopped


@contextmanager
def several_runs(
    console: Console, name: str, folder: Path, count: int
) -> Iterator[tuple[Callable[[str, float, str], None], ProgressBar]]:
    """Show the progress of several runs in a folder; yield a function for ``run_scenes``.

    Without a terminal it is a line now and then.
    """
    shares: dict[str, float] = {}
    printed = clock.perf_counter()
    command = f"the same command with --resume --out {folder} continues"
    with (
        terminal.resumable(command, folder, lambda: "finished runs are stored"),
        terminal.progress_bar(console) as bar,
    ):
        task = bar.add_task(name, total=1.0)

        def show(run: str, share: float, words: str) -> None:
            nonlocal printed
            check_stopped()
            shares[run] = share
            finished = sum(share == 1.0 for share in shares.values())
            text = f"{name}: {finished} of {count} finished"
            whole = sum(shares.values()) / count
            bar.update(task, description=text, completed=whole)
            if bar.disable and clock.perf_counter() > printed + LINE_INTERVAL:
                printed = clock.perf_counter()
                remaining = terminal.time_left(bar.tasks[task])
                line = f"{text}, {100.0 * whole:.0f} % {remaining}".rstrip()
                terminal.print_lines(console, line)
            if share == 1.0:
                terminal.print_lines(console, f"finished {run}: {words}")

        yield show, bar
