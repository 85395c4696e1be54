"""``presswear dynamics``: contact modes and periods, Lyapunov exponents, bifurcation diagrams."""

import argparse
from pathlib import Path

from rich.console import Console

from presswear.cli import terminal
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError

CYCLES = 100  # default number of cycles at each value of a bifurcation diagram


def dynamics(arguments: argparse.Namespace, console: Console) -> int:
    """Print contact modes and periods, or an exponent, or draw a bifurcation diagram."""
    if arguments.over is not None:
        return _diagram(in_house_scene(arguments), arguments, console)
    for name in ("cycles", "stored", "out", "resume"):
        if getattr(arguments, name):
            raise InputError(f"--{name} needs --over")
    folder = Path(arguments.scene)
    if folder.is_dir():
        if arguments.engine or arguments.set:
            raise InputError(
                f"{folder} is a result folder: --engine and --set need --over"
            )
        return _describe(folder, console)
    scene = in_house_scene(arguments)
    if not arguments.exponent:
        raise InputError("--exponent 0 needs --over")
    return _exponent(scene, arguments.exponent, console)


def in_house_scene(arguments: argparse.Namespace) -> Scene:
    """Return the scene with the settings of ``--set``; InputError for another engine."""
    settings = terminal.parse_settings(arguments.set)
    engine = arguments.engine or settings.get("engine", "dae")
    if engine != "dae" or "wear_updates" in settings:
        raise InputError(
            f"presswear {arguments.command} uses engine = dae and no wear updates"
        )
    return terminal.requested_scene(arguments)


def _exponent(scene: Scene, cycles: int, console: Console) -> int:
    """Print the largest Lyapunov exponent of a scene."""
    from presswear.analysis.lyapunov import largest_exponent
    from presswear.campaign.replicates import start_of

    period = scene.mechanism.period
    exponent = largest_exponent(scene.linkage(), start_of(scene), period, cycles)
    half = exponent.half_width
    interval = "(too few cycles for an interval)" if half is None else f"± {half:.3g}"
    terminal.print_lines(
        console,
        f"{scene.name}: largest Lyapunov exponent {exponent.mean:.4g} {interval} 1/s, "
        f"{exponent.mean * period:.3g} per cycle, from {exponent.samples} intervals",
    )
    return 0


def _diagram(scene: Scene, arguments: argparse.Namespace, console: Console) -> int:
    """Compute a bifurcation diagram, or resume it, and draw it."""
    from presswear.analysis.bifurcation import DIRECTIONS, Cycles, Parameter, compute
    from presswear.campaign.replicates import start_of
    from presswear.show.figures import save
    from presswear.show.figures.dynamics import draw_diagram

    parameter = Parameter.parse(arguments.over, scene)
    count = arguments.cycles or CYCLES
    cycles = Cycles.of(count, arguments.stored, arguments.exponent)
    folder = terminal.output_folder(arguments, f"{scene.name}-dynamics")
    shares = dict.fromkeys(DIRECTIONS, 0.0)
    name = "bifurcation diagram"
    stored_text = "finished values are stored"
    with terminal.resumable_steps(console, name, folder, stored_text) as report:

        def show(direction: str, share: float) -> None:
            shares[direction] = share
            report(f"{name}, {direction}", sum(shares.values()) / len(shares))

        diagram = compute(
            scene, parameter, cycles, folder, start_of, arguments.jobs, show
        )
    terminal.print_lines(console, *diagram.summary())
    terminal.print_lines(console, f"picture in {save(draw_diagram(diagram), folder)}")
    terminal.print_lines(
        console,
        f"presswear report {folder} also draws numbers of each cycle, such as the peak forces",
    )
    return 0


def is_diagram(folder: Path) -> bool:
    """Return whether a folder holds a bifurcation diagram."""
    from presswear.analysis.bifurcation import FILE

    return (folder / FILE).exists()


def report(arguments: argparse.Namespace, console: Console) -> int:
    """Write the report of a bifurcation diagram."""
    from presswear.analysis.bifurcation import load_diagram
    from presswear.show.diagram_report import write_report

    folder = arguments.folder
    if arguments.format == "pdf" or arguments.limit:
        option = "--limit" if arguments.limit else "--format pdf"
        raise InputError(f"{option} cannot be used: {folder} is a bifurcation diagram")
    names = terminal.names_in(arguments.figures)
    file = write_report(load_diagram(folder), folder, names)
    terminal.print_lines(console, f"report in {file}")
    return 0


def export(arguments: argparse.Namespace, console: Console) -> int:
    """Write the numbers of a bifurcation diagram as CSV, NPZ or MAT."""
    from presswear.analysis.bifurcation import load_diagram
    from presswear.results.export import write_table

    folder = arguments.folder
    for name in ("stage", "strokes", "cycles", "life"):
        if getattr(arguments, name):
            raise InputError(
                f"--{name} cannot be used: {folder} is a bifurcation diagram"
            )
    diagram = load_diagram(folder)
    table = diagram.table()
    if not table:
        raise InputError(f"{folder}: no value of the diagram has run")
    write_table(arguments.file, table, diagram.units())
    rows = table["cycle"].size
    terminal.print_lines(
        console, f"{rows} rows of {len(table)} columns in {arguments.file}"
    )
    return 0


def _describe(folder: Path, console: Console) -> int:
    """Print the motion of a stored run."""
    from presswear.show.motion_table import motion_table

    table = motion_table(terminal.load_result(folder, console))
    if table is None:
        raise InputError(
            f"{folder}: no motion to analyse, because no joint has clearance or no cycle after "
            "the start-up was recorded"
        )
    terminal.print_lines(console, f"of each mode: {table.head[0]}")
    for heading, rows in table.groups:
        terminal.print_table(console, (heading, *table.head[1:]), rows)
    return 0
