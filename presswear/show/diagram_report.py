"""Report of a bifurcation diagram: its figures, and quantities of each cycle."""

from collections.abc import Sequence
from pathlib import Path

from presswear.analysis.bifurcation import Diagram
from presswear.recording.columns import index_of
from presswear.scene.catalog import title_of
from presswear.show import page
from presswear.show.figures.dynamics import BRANCHES, draw_diagram, draw_quantity
from presswear.show.page import FirstScreen, Section
from presswear.show.report import made_by
from presswear.tools.files import inside, write_bytes


def write_report(diagram: Diagram, folder: Path, also: Sequence[str] = ()) -> Path:
    """Write ``report.html`` and its figures into the folder of a diagram; return the page.

    The figures are the diagram, the peak force of each joint, and the quantities
    ``also``. InputError for an unknown quantity.
    """
    names = [f"{joint}.force_max" for joint in diagram.scene.clearance_joints]
    for name in also:
        index_of("quantity", name, tuple(diagram.quantities))
    drawings = [draw_diagram(diagram)]
    for name in dict.fromkeys([*names, *also]):
        drawings.append(draw_quantity(diagram, name))
    figures = page.illustrated(drawings, inside(folder, "figures"))
    rows = [
        (name, column.unit, column.text) for name, column in diagram.quantities.items()
    ]
    quantities = page.plain_table(("quantity", "unit", "meaning"), rows, numeric=False)
    note = (
        f"presswear report {folder} --figures NAMES draws other quantities; presswear "
        f"export {folder} FILE.csv writes all of them."
    )
    html = page.render_page(
        f"Bifurcation over {diagram.parameter.key}: {title_of(diagram.scene)}",
        FirstScreen(status=_status(diagram), made_by=made_by(diagram.provenance)),
        [
            Section("Figures", figures=figures, is_open=True),
            Section("Quantities of each cycle", [note], [("", quantities)]),
        ],
        diagram.summary(),
    )
    file = folder / "report.html"
    write_bytes(file, html.encode())
    return file


def _status(diagram: Diagram) -> str:
    """Return how many values of each branch have run."""
    count = len(diagram.parameter.values)
    parts = [
        f"{len(branch)} of {count} values with {BRANCHES[direction][0]} {diagram.parameter.key}"
        for direction, branch in diagram.branches.items()
    ]
    return f"{', '.join(parts)}, {diagram.cycles.total} cycles each."
