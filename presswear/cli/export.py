"""``presswear export``: stored results as tables for other programs."""

import argparse

from rich.console import Console

from presswear.cli.terminal import load_result, print_lines


def export(arguments: argparse.Namespace, console: Console) -> int:
    """Run the command and return its exit code."""
    from presswear.results.export import life_table, strokes_table, table_of, write_table

    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        return sweep.export(arguments, console)
    result = load_result(arguments.folder, console)
    if arguments.life:
        table = life_table(result)
    else:
        table = (strokes_table if arguments.strokes else table_of)(result, arguments.stage)
    write_table(arguments.file, table)
    rows = next(iter(table.values())).size
    print_lines(console, f"{rows} rows of {len(table)} columns in {arguments.file}")
    return 0
