"""What pages with code have at hand while the site is built.

``%%bash`` cells that give whole lines: IPython's own cuts what is printed into pieces, and minds
the last command alone.  ``table`` shows rows as a table of the page.
"""

import subprocess
from collections.abc import Iterable, Sequence

from IPython.core.magic import register_cell_magic
from IPython.display import Markdown


@register_cell_magic
def bash(line: str, cell: str) -> None:
    """Run commands; the first that fails ends the page, and with it the build."""
    ran = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", cell],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    print(ran.stdout, end="")
    ran.check_returncode()


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> Markdown:
    """Rows as a table; columns whose name begins with ``>`` stand to the right."""
    lines = [
        [name.lstrip(">") for name in columns],
        ["---:" if name.startswith(">") else ":---" for name in columns],
        *([cell.replace("|", "\\|") for cell in row] for row in rows),
    ]
    return Markdown("\n".join(f"| {' | '.join(line)} |" for line in lines))
