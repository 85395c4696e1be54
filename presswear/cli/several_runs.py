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

    Without a terminal a line is printed every ``LINE_INTERVAL``. The time left is at least
    the time left of each run that has started.
    """
    shares: dict[str, float] = {}
    starts: dict[str, float] = {}
    started = printed = clock.perf_counter()
    shown = 0.0  # completed share, which never falls
    command = f"the same command with --resume --out {folder} continues"
    with (
        terminal.resumable(command, folder, lambda: "finished runs are stored"),
        terminal.progress_bar(console) as bar,
    ):
        task = bar.add_task(name, total=1.0)

        def show(run: str, share: float, words: str) -> None:
            nonlocal printed, shown
            check_stopped()
            now = clock.perf_counter()
            shares[run] = share
            starts.setdefault(run, now)
            finished = sum(share == 1.0 for share in shares.values())
            text = f"{name}: {finished} of {count} finished"
            expected = sum(shares.values()) / count
            shown = max(shown, expected)
            for name_of_run, completed in shares.items():
                elapsed = now - starts[name_of_run]
                if completed >= terminal.MIN_SHARE and elapsed > 0.0:
                    remaining = elapsed * (1.0 - completed) / completed
                    total = now - started + remaining
                    expected = min(expected, (now - started) / total)
            bar.update(task, description=text, completed=shown, share=expected)
            if bar.disable and now > printed + LINE_INTERVAL:
                printed = now
                time_left = terminal.time_left(bar.tasks[task])
                line = f"{text}, {100.0 * shown:.0f} % {time_left}".rstrip()
                terminal.print_lines(console, line)
            if share == 1.0:
                terminal.print_lines(console, f"finished {run}: {words}")

        yield show, bar
