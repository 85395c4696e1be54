"""The figures of a result: drawn in a script or a notebook, or written as PNG files."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from presswear.results.result import Result
from presswear.show.figures.bottom import bottom_dead_centre
from presswear.show.figures.drives import drive_work
from presswear.show.figures.dynamics import (
    contact_modes,
    impact_section,
    phase_portrait,
    poincare_section,
    spectrum,
)
from presswear.show.figures.life import service_life
from presswear.show.figures.mechanism import mechanism
from presswear.show.figures.motion import centre_trajectory, contact_force, response
from presswear.show.figures.stroke import height_over_angle
from presswear.show.figures.style import (
    DOTS_PER_INCH,
    SETTINGS,
    Axes,
    Drawing,
    Sheet,
    Stages,
)
from presswear.show.figures.surfaces import worn_surfaces
from presswear.show.figures.tonnage import force_over_stroke
from presswear.show.figures.wear import wear_depth, wear_growth
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import write_whole

__all__ = ["NAMES", "Drawing", "drawings", "plot", "save"]

NAMES: dict[str, Callable[[Result, Stages], list[Drawing]]] = {
    "life": service_life,
    "mechanism": mechanism,
    "stroke": height_over_angle,
    "tonnage": force_over_stroke,
    "wear": wear_depth,
    "growth": wear_growth,
    "surfaces": worn_surfaces,
    "response": response,
    "bottom": bottom_dead_centre,
    "force": contact_force,
    "path": centre_trajectory,
    "phase": phase_portrait,
    "poincare": poincare_section,
    "impacts": impact_section,
    "modes": contact_modes,
    "spectrum": spectrum,
    "drives": drive_work,
}
"""Figures by name, in the order of the report; each is drawn of some stages of a result, at
least one, and gives nothing where it would say nothing."""
_PYPLOT = "matplotlib.pyplot"
"""Keeps figures until they are closed, so that only those for the screen are given to it."""


def drawings(
    result: Result, names: Sequence[str] = (), stage: int | None = None
) -> Iterator[Drawing]:
    """Draw figures of a result.

    Parameters
    ----------
    names : sequence of str
        Figures of ``NAMES``; none: all that make sense.
    stage : int or None
        The only stage to draw; None: all.

    Raises
    ------
    InputError
        For a stage that there is not, and a name that is unknown or of which there is
        nothing to draw.
    """
    for name in names:
        if not (isinstance(name, str) and name in NAMES):
            raise unknown("figure", name, NAMES)
    stages = result.stages if stage is None else (result.stage(stage),)
    for name in names or NAMES:
        found = drawn(name, result, stages)
        if names and not found:
            of = f"stage {stage} of " if stage is not None else ""
            raise InputError(f"{of}{result.scene.name} has nothing to draw as {name!r}")
        yield from found


def drawn(name: str, result: Result, stages: Stages) -> list[Drawing]:
    """Draw a figure of ``NAMES``, or nothing where it would say nothing."""
    with matplotlib.rc_context(SETTINGS):
        return NAMES[name](result, stages) if stages else []


def plot(result: Result, names: Sequence[str] = (), stage: int | None = None) -> list[Axes]:
    """Draw figures as ``drawings`` does; gives their axes, and shows them in a notebook."""
    axes = []
    for drawing in drawings(result, names, stage):
        with matplotlib.rc_context(SETTINGS):
            # Ticks get their looks when they are first drawn.
            drawing.sheet.draw_without_rendering()
        _show(drawing.sheet)
        axes += drawing.sheet.axes
    return axes


def _show(sheet: Sheet) -> None:
    """Hand a figure to pyplot where that shows figures by itself."""
    if "ipykernel" in sys.modules or (_PYPLOT in sys.modules and matplotlib.is_interactive()):
        import_module(_PYPLOT).figure(FigureClass=lambda **_: sheet)


@contextmanager
def _at(sheet: Sheet, dots_per_inch: float) -> Iterator[None]:
    """Draw a sheet at another resolution than that of its screen."""
    before, canvas = sheet.dpi, sheet.canvas
    try:
        sheet.dpi = dots_per_inch
        yield
    finally:
        sheet.dpi = before
        sheet.set_canvas(canvas)


def save(drawing: Drawing, folder: Path) -> Path:
    """Write a drawing into a folder, which is made where needed; gives the file."""

    def write(file: BinaryIO) -> None:
        # Drawn once: ``savefig`` draws all of it before, to lay it out.
        canvas = FigureCanvasAgg(drawing.sheet)
        canvas.draw()
        opaque = np.asarray(canvas.buffer_rgba())[..., :3]
        Image.fromarray(opaque).save(file, "png", dpi=(DOTS_PER_INCH, DOTS_PER_INCH))

    folder.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(SETTINGS), _at(drawing.sheet, DOTS_PER_INCH):
        write_whole(folder / drawing.file, write)
    return folder / drawing.file
