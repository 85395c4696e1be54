"""Figures of a result: drawn in a script or a notebook, or written as PNG files."""

import math
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from presswear.results.result import Result
from presswear.show.figures import dynamics, life, mechanism, motion, style, wear
from presswear.show.figures.style import DOTS_PER_INCH, SETTINGS, WIDTH, Axes, Drawing, Stages
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import write_whole

__all__ = ["NAMES", "Drawing", "drawings", "plot", "rendered", "save", "write"]

# Figures by name, in the order of the report: the choice of the stages that are drawn (None: all),
# and the function that returns the drawings of at least one stage, none where it would be empty.
NAMES: dict[str, tuple[Callable[[Result, Stages], Any] | None, Callable[..., list[Drawing]]]] = {
    "life": (None, life.service_life),
    "mechanism": (None, lambda result, stages: [mechanism.labelled(result.scene)]),
    "stroke": (style.moving_stages, motion.height_over_angle),
    "tonnage": (style.moving_stages, motion.force_over_stroke),
    "wear": (style.shown_stages, wear.wear_depth),
    "growth": (None, wear.wear_growth),
    "surfaces": (style.shown_stages, wear.worn_surfaces),
    "response": (style.moving_stages, motion.response),
    "bottom": (style.shown_stages, motion.bottom_dead_centre),
    "force": (style.loose_stages, motion.contact_force),
    "path": (style.loose_stages, motion.centre_trajectory),
    "phase": (style.settled_stages, dynamics.phase_portrait),
    "poincare": (style.settled_stages, dynamics.poincare_section),
    "impacts": (style.settled_stages, dynamics.impact_section),
    "modes": (style.settled_stages, dynamics.contact_modes),
    "spectrum": (style.settled_stages, dynamics.spectrum),
    "drives": (style.moving_stages, motion.drive_work),
    "oil": (None, motion.film_thickness),
}
_PYPLOT = "matplotlib.pyplot"  # keeps figures until they are closed, so it gets only shown ones


def drawings(
    result: Result, names: Sequence[str] = (), stage: int | None = None
) -> Iterator[Drawing]:
    """Draw figures of ``NAMES``, or all that show something, of one stage or all.

    InputError for an unknown stage or name, and a name for which there is nothing to draw.
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
    choose, draw = NAMES[name]
    with matplotlib.rc_context(SETTINGS):
        chosen = choose(result, stages) if choose and stages else stages
        return draw(result, chosen) if chosen else []


def plot(result: Result, names: Sequence[str] = (), stage: int | None = None) -> list[Axes]:
    """Draw figures as ``drawings`` does, show them in a notebook and return their axes."""
    axes = []
    for drawing in drawings(result, names, stage):
        sheet = drawing.sheet
        with matplotlib.rc_context(SETTINGS):
            sheet.draw_without_rendering()  # ticks get their look when they are first drawn
        # Pyplot gets a figure where it shows figures by itself.
        if "ipykernel" in sys.modules or (_PYPLOT in sys.modules and matplotlib.is_interactive()):
            import_module(_PYPLOT).figure(FigureClass=lambda sheet=sheet, **_: sheet)
        axes += sheet.axes
    return axes


def save(drawing: Drawing, folder: Path) -> Path:
    """Write a drawing into a folder, which is created where needed, and return the file."""
    return write(rendered(drawing), folder / drawing.file)


def rendered(drawing: Drawing) -> Image.Image:
    """Return the image of a drawing."""
    # A tall sheet, of a mechanism with many joints, has no more dots than a square one.
    tall = max(drawing.sheet.get_figheight() / WIDTH, 1.0)
    drawing.sheet.dpi = round(DOTS_PER_INCH / math.sqrt(tall))
    # Drawn once: ``savefig`` draws everything twice to lay it out.
    canvas = FigureCanvasAgg(drawing.sheet)
    with matplotlib.rc_context(SETTINGS):
        canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba()))


def write(image: Image.Image, path: Path) -> Path:
    """Write an image into a PNG file, whose folder is created where needed; return the path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # A palette makes the file three times smaller, and is faster to write.
    few = image.convert("RGB").quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    write_whole(path, lambda file: few.save(file, format="png"))
    return path
