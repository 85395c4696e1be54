"""Define ``%%bash`` and ``table`` for the pages with code.

IPython's ``%%bash`` splits the output and checks only the last command.
"""

import subprocess
from collections.abc import Iterable, Sequence

from IPython.core.magic import register_cell_magic
from IPython.display import Markdown


@register_cell_magic
def bash(line: str, cell: str) -> None:
    """Run commands; the first one that fails ends the build."""
    process = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", cell],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    print(process.stdout, end="")
    process.check_returncode()


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> Markdown:
    """Return a table; columns whose name begins with ``>`` are aligned to the right."""
    heads = []
    rules = []
    for name in columns:
        heads.append(name.lstrip(">"))
        rules.append("---:" if name.startswith(">") else ":---")
    lines = [heads, rules]
    for row in rows:
        lines.append([cell.replace("|", "\\|") for cell in row])
    return Markdown("\n".join(f"| {' | '.join(line)} |" for line in lines))
