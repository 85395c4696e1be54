"""Parts that the commands of trials share: progress by name, and tables with sentences."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape

from presswear.cli.terminal import print_table, progress_bar

if TYPE_CHECKING:
    from presswear.validation.costs.tables import TextTable


@contextmanager
def telling(console: Console, name: str) -> Iterator[Callable[[str, float], None]]:
    """Show progress by what is being run and the part, 0 .. 1, that is done."""
    with progress_bar(console) as bar:
        task = bar.add_task(name, total=1.0)
        yield lambda word, part: bar.update(task, description=word, completed=part)


def print_text_table(console: Console, table: "TextTable") -> None:
    """Print a table and the sentences that explain it."""
    look: dict[str, Any] = {"collapse_padding": True, "title": table.title, "title_justify": "left"}
    print_table(console, table.texts, table.numbers, table.rows, **look)
    for sentence in table.sentences:
        console.print(escape(sentence), highlight=False)
    console.print()
