"""Progress of the commands that validate and measure."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console

from presswear.cli.terminal import progress_bar


@contextmanager
def telling(console: Console, name: str) -> Iterator[Callable[[str, float], None]]:
    """Show progress by what is being run and the part, 0 .. 1, that is done."""
    with progress_bar(console) as bar:
        task = bar.add_task(name, total=1.0)
        yield lambda word, part: bar.update(task, description=word, completed=part)
