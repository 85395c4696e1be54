"""Figures of a result: drawn in a script or a notebook, or written as PNG files."""

import sys
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from presswear.results.result import Result
from presswear.show.figures import dynamics, life, mechanism, motion, wear
from presswear.show.figures.style import DOTS_PER_INCH, SETTINGS, Axes, Drawing, Sheet, Stages
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import write_whole

__all__ = ["NAMES", "Drawing", "drawings", "plot", "save"]

# Figures by name, in the order of the report: each returns the drawings of at least one stage of
# a result, and none where it would show nothing.
NAMES: dict[str, Callable[[Result, Stages], list[Drawing]]] = {
    "life": life.service_life,
    "mechanism": mechanism.draw_mechanism,
    "stroke": motion.height_over_angle,
    "tonnage": motion.force_over_stroke,
    "wear": wear.wear_depth,
    "growth": wear.wear_growth,
    "surfaces": wear.worn_surfaces,
    "response": motion.response,
    "bottom": motion.bottom_dead_centre,
    "force": motion.contact_force,
    "path": motion.centre_trajectory,
    "phase": dynamics.phase_portrait,
    "poincare": dynamics.poincare_section,
    "impacts": dynamics.impact_section,
    "modes": dynamics.contact_modes,
    "spectrum": dynamics.spectrum,
    "drives": motion.drive_work,
}
_PYPLOT = "matplotlib.pyplot"  # keeps figures until they are closed, so it gets only shown ones


def drawings(
    result: Result, names: Sequence[str] = (), stage: int | None = None
) -> Iterator[Drawing]:
    """Draw figures of a result.

    Parameters
    ----------
    names : sequence of str
        Figures of ``NAMES``; none: all that show something.
    stage : int or None
        The only stage to draw; None: all.

    Raises
    ------
    InputError
        For an unknown stage or name, and a name for which there is nothing to draw.
    """
    for name in names:
        if not (isinstance(name, str) and name in NAMES):
            raise unknown("figure", name, NAMES)
    stages = result.stages if stage is None else (result.stage(stage),)
    for name in names or NAMES:
        figures = drawn(name, result, stages)
        if names and not figures:
            of_stage = f"stage {stage} of " if stage is not None else ""
            raise InputError(f"{of_stage}{result.scene.name} has nothing to draw as {name!r}")
        yield from figures


def drawn(name: str, result: Result, stages: Stages) -> list[Drawing]:
    """Return the drawings of a figure of ``NAMES``; none where it would show nothing."""
    with matplotlib.rc_context(SETTINGS):
        return NAMES[name](result, stages) if stages else []


def plot(result: Result, names: Sequence[str] = (), stage: int | None = None) -> list[Axes]:
    """Draw figures as ``drawings`` does, show them in a notebook and return their axes."""
    axes = []
    for drawing in drawings(result, names, stage):
        with matplotlib.rc_context(SETTINGS):
            # Ticks get their look when they are first drawn.
            drawing.sheet.draw_without_rendering()
        _show(drawing.sheet)
        axes += drawing.sheet.axes
    return axes


def _show(sheet: Sheet) -> None:
    """Hand a figure to pyplot where that shows figures by itself."""
    if "ipykernel" in sys.modules or (_PYPLOT in sys.modules and matplotlib.is_interactive()):
        import_module(_PYPLOT).figure(FigureClass=lambda **_: sheet)


def save(drawing: Drawing, folder: Path) -> Path:
    """Write a drawing into a folder, which is created where needed, and return the file."""
    sheet = drawing.sheet
    dpi, canvas = sheet.dpi, sheet.canvas

    def write(file: BinaryIO) -> None:
        # Drawn once: ``savefig`` draws everything twice to lay it out.
        agg = FigureCanvasAgg(sheet)
        agg.draw()
        opaque = np.asarray(agg.buffer_rgba())[..., :3]
        Image.fromarray(opaque).save(file, "png", dpi=(DOTS_PER_INCH, DOTS_PER_INCH))

    folder.mkdir(parents=True, exist_ok=True)
    try:
        sheet.dpi = DOTS_PER_INCH
        with matplotlib.rc_context(SETTINGS):
            write_whole(folder / drawing.file, write)
    finally:
        sheet.dpi = dpi
        sheet.set_canvas(canvas)
    return folder / drawing.file
