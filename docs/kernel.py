"""Cells of commands, while the site is built: ``%%bash`` that gives whole lines.

IPython's own cuts what is printed into pieces, and minds the last command alone.
"""

import subprocess

from IPython.core.magic import register_cell_magic


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
