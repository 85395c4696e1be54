"""``presswear dynamics settle``: motions on which a scene comes to rest."""

import argparse

from rich.console import Console

from presswear.cli import terminal
from presswear.cli.dynamics import in_house_scene


def settle(arguments: argparse.Namespace, console: Console) -> int:
    """Run a scene from different initial states; print and store its final motions."""
    from presswear.analysis.bifurcation import Parameter
    from presswear.analysis.final_motions import Watch
    from presswear.analysis.settle import check, compute
    from presswear.analysis.settling_tables import motion_rows, summary, write_tables
    from presswear.campaign.replicates import start_of
    from presswear.show.figures import save
    from presswear.show.figures.settling import drawings_of

    watch = Watch(arguments.starts, arguments.cycles)
    scene = in_house_scene(arguments)
    check(scene)
    parameter = Parameter.parse(arguments.over, scene) if arguments.over else None
    folder = terminal.output_folder(arguments, f"{scene.name}-settle")
    stored = "finished starts are stored"
    with terminal.resumable_steps(console, "final motions", folder, stored) as report:
        result = compute(
            scene, watch, folder, start_of, parameter, arguments.jobs, report
        )
    for settled in result.values:
        terminal.print_lines(console, *summary(result, settled))
        terminal.print_table(console, *motion_rows(settled))
    for file in write_tables(result, folder):
        terminal.print_lines(console, f"table in {file}")
    for drawing in drawings_of(result):
        terminal.print_lines(console, f"picture in {save(drawing, folder)}")
    return 0
