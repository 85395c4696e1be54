"""``presswear improve``: each joint changed in one way at a time."""

import argparse

from rich.console import Console

from presswear.cli import terminal
from presswear.cli.several_runs import several_runs
from presswear.scene.settings import changed


def improve(arguments: argparse.Namespace, console: Console) -> int:
    """Change each joint in one way at a time, and rank the changes."""
    from presswear.sweeps import improve as improvements
    from presswear.sweeps.improve import write_report

    scene = terminal.load_scene(arguments.scene)
    options = {"engine": arguments.engine, "cycles": arguments.cycles}
    settings = terminal.parse_settings(arguments.set)
    scene = changed(scene, terminal.merge_options(settings, options))
    folder = terminal.output_folder(arguments, f"{scene.name}-improve")
    count = 1 + len(improvements.changes_of(scene))
    with several_runs(console, "improve", folder, count) as (show, _):
        improvement = improvements.improve(scene, folder, arguments.jobs, show)
    for quantity, effects in improvement.effects.items():
        lines = [f"  {effect}" for effect in effects]
        terminal.print_lines(console, f"{improvement.heading(quantity)}:", *lines)
    for change, reason in improvement.failures.items():
        terminal.print_lines(console, f"{change}: the run fails: {reason}")
    terminal.print_lines(console, *improvement.sentences)
    file = write_report(improvement, scene, folder)
    terminal.print_lines(console, f"report in {file}")
    return 0
