"""Parts that the commands of trials share: progress by name, and tables with sentences."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from presswear.commands.terminal import progress_bar

if TYPE_CHECKING:
    from presswear.trials.costs.tables import TextTable


@contextmanager
def telling(console: Console, name: str) -> Iterator[Callable[[str, float], None]]:
    """Show progress by what is being run and the part, 0 .. 1, that is done."""
    with progress_bar(console) as bar:
        task = bar.add_task(name, total=1.0)
        yield lambda word, part: bar.update(task, description=word, completed=part)


def print_text_table(console: Console, table: "TextTable") -> None:
    """Print a table and the sentences that explain it."""
    shown = Table(
        box=SIMPLE,
        pad_edge=False,
        collapse_padding=True,
        title=table.title,
        title_justify="left",
    )
    for name in table.texts:
        shown.add_column(name, overflow="fold")
    for name in table.numbers:
        shown.add_column(name, justify="right", no_wrap=True)
    for row in table.rows:
        shown.add_row(*(escape(cell) for cell in row))
    console.print(shown, highlight=False)
    for sentence in table.sentences:
        console.print(escape(sentence), highlight=False)
    console.print()
