"""``presswear dynamics``: what the motion of a result is, or of a scene over a quantity."""

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.analysis.bifurcation import Cycles, Parameter
from presswear.cli.terminal import (
    add_out,
    add_settings,
    count_given,
    free_folder,
    jobs_given,
    print_table,
    scene_given,
    settings_given,
)
from presswear.cli.trials import telling
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError

MOST_CYCLES = 100_000


def add(commands: Any) -> None:
    """Add the parser of ``dynamics``."""
    own = commands.add_parser(
        "dynamics",
        description="Of a result: modes of contact and the period of each stage.  Of a scene: its "
        "largest Lyapunov exponent, in-house; with --over a bifurcation diagram of its unworn "
        "linkage, up and down, each value beginning where the last one ended.  A diagram that "
        "was stopped goes on with --out of its folder.",
        epilog="example: presswear dynamics slider-crank --over 'speed=50:600:200 rad/s'",
    )
    own.add_argument("subject", help="a result folder, a file, FILE.toml, or a scene")
    own.add_argument(
        "--over",
        metavar="KEY=FIRST:LAST:COUNT",
        help="quantity and its values, with a unit behind",
    )
    own.add_argument("--cycles", default="100", help="cycles at each value (default 100)")
    own.add_argument(
        "--kept", default="40", help="of them the last ones that are shown (default 40)"
    )
    own.add_argument(
        "--exponent",
        default="20",
        metavar="CYCLES",
        help="cycles for the exponent, of a scene or at each value; 0: none (default 20)",
    )
    own.add_argument(
        "--orders",
        default="0",
        metavar="CYCLES",
        help="with --over: cycles for the amplitudes at the crank's harmonics; 0: none (default 0)",
    )
    own.add_argument("--jobs", help="processes (default: one a core)")
    add_settings(own)
    add_out(own, "SCENE-dynamics")
    own.set_defaults(run=_run)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    folder = Path(arguments.subject)
    if folder.is_dir():
        if arguments.over or arguments.set:
            raise InputError(f"{folder} is a result; --over and --set go with a scene")
        return _of_result(folder, console)
    cycles, orders = (
        0 if own == "0" else count_given(name, own, MOST_CYCLES)
        for name, own in (("--exponent", arguments.exponent), ("--orders", arguments.orders))
    )
    scene = changed(scene_given(arguments.subject), settings_given(arguments.set))
    if arguments.over is not None:
        over = Parameter.parse(arguments.over, scene)
        extent = Cycles(
            count_given("--cycles", arguments.cycles, MOST_CYCLES),
            count_given("--kept", arguments.kept, MOST_CYCLES),
            cycles,
            orders,
        )
        out = arguments.out or free_folder(f"{scene.name}-dynamics")
        return _diagram(scene, over, extent, out, jobs_given(arguments.jobs), console)
    if orders:
        raise InputError("--orders goes with --over")
    if not cycles:
        raise InputError("--exponent 0: without --over there is nothing else to do")
    return _exponent(scene, cycles, console)


def _exponent(scene: Scene, cycles: int, console: Console) -> int:
    from presswear.analysis.lyapunov import largest_exponent
    from presswear.campaign.replicates import start_of

    found = largest_exponent(scene.linkage(), start_of(scene), scene.mechanism.period, cycles)
    half = "too few cycles" if found.half_width is None else f"± {found.half_width:.3g}"
    console.print(
        f"{scene.name}: largest Lyapunov exponent {found.value:.4g} {half} 1/s, "
        f"{found.value * scene.mechanism.period:.3g} a cycle, from {found.intervals} intervals",
        highlight=False,
    )
    return 0


def _diagram(
    scene: Scene, over: Parameter, extent: Cycles, out: Path, jobs: int | None, console: Console
) -> int:
    from presswear.analysis.bifurcation import compute
    from presswear.campaign.replicates import start_of
    from presswear.show.figures import save
    from presswear.show.figures.bifurcation import draw_diagram, draw_orders

    with telling(console, "bifurcation diagram") as told:
        parts = dict.fromkeys(("up", "down"), 0.0)

        def tell(way: str, part: float) -> None:
            parts[way] = part
            told(f"bifurcation diagram, {way}", sum(parts.values()) / len(parts))

        diagram = compute(scene, over, extent, out, start_of, jobs, tell)
    for sentence in diagram.summary():
        console.print(sentence, highlight=False)
    for drawing in [draw_diagram(diagram), *([draw_orders(diagram)] if extent.orders else [])]:
        picture = save(drawing, out)
        console.print(f"picture in {picture}", highlight=False, soft_wrap=True)
    return 0


def _of_result(folder: Path, console: Console) -> int:
    from presswear.results.result import load
    from presswear.show.report_tables import motion_table

    result = load(folder)
    found = motion_table(result)
    if found is None:
        raise InputError(
            f"{folder}: no joint has clearance, or no cycle was recorded, so that there is no "
            "motion to tell"
        )
    console.print(f"of each mode: {found.head[0]}", highlight=False)
    for heading, rows in found.groups:
        print_table(console, (heading, *found.head[1:]), (), rows)
    return 0
