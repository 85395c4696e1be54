"""Figures of a result: drawn in a script or a notebook, or written as PNG files."""

import math
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from itertools import chain, islice
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from presswear.results.result import Result
from presswear.results.sampled_cycles import has_motion
from presswear.show.figures import (
    dynamics,
    frame,
    guide,
    life,
    mechanism,
    motion,
    motor,
    oil_film,
    style,
    wear,
)
from presswear.show.figures.style import (
    DOTS_PER_INCH,
    SETTINGS,
    WIDTH,
    Axes,
    Drawing,
    Stages,
)
from presswear.show.figures.vector import FILE_HEAD
from presswear.show.words import in_words_of
from presswear.tools.errors import InputError, NotStored, unknown
from presswear.tools.files import write_whole

__all__ = [
    "NAMES",
    "Drawing",
    "drawings",
    "first_drawings",
    "plot",
    "remove_others",
    "rendered",
    "save",
    "write",
]

# Figures by name, in the order of the report: the stages that are drawn, and the
# function that returns the drawings of at least one stage, none where it would be
# empty.
NAMES: dict[str, tuple[str, Callable[..., list[Drawing]]]] = {
    "life": ("all", life.service_life),
    "mechanism": ("all", lambda result, stages: [mechanism.labelled(result.scene)]),
    "tonnage": ("moving", motion.force_over_stroke),
    "wear": ("pins", wear.wear_depth),
    "growth": ("all", wear.wear_growth),
    "surfaces": ("pins", wear.worn_surfaces),
    "response": ("moving", motion.response),
    "bottom": ("shown", motion.bottom_dead_centre),
    "force": ("loose", motion.contact_force),
    "path": ("loose", motion.centre_trajectory),
    "tilt": ("guides", guide.tilt_over_angle),
    "corners": ("guides", guide.corner_trajectories),
    "walls": ("shown", guide.wall_wear),
    "phase": ("sampled", dynamics.phase_portrait),
    "poincare": ("sampled pins", dynamics.poincare_section),
    "impacts": ("sampled pins", dynamics.impact_section),
    "modes": ("sampled pins", dynamics.contact_modes),
    "spectrum": ("sampled", dynamics.spectrum),
    "drives": ("moving", motion.drive_work),
    "motor": ("moving", motor.speed_and_torque),
    "frame": ("moving", frame.stretch_over_angle),
    "oil": ("all", oil_film.film_thickness),
}
# Sections and spectra, which are drawn by name only
OF_MANY_CYCLES = ("poincare", "impacts", "spectrum")
# Figures that are drawn after a run, the most important first, and how many of them
FIRST = (
    "life",
    "response",
    "force",
    "wear",
    "tilt",
    "motor",
    "frame",
    "bottom",
    "drives",
)
FIRST_COUNT = 3
# keeps figures until they are closed, so it gets only shown ones
_PYPLOT = "matplotlib.pyplot"
_PROGRAM = "presswear"  # name of the program in the file of a figure


def drawings(
    result: Result, names: Sequence[str] = (), stage: int | None = None
) -> Iterator[Drawing]:
    """Draw figures of ``NAMES``, or all that show something, of one stage or all.

    Without names, those of ``OF_MANY_CYCLES`` and those whose series the result does not
    contain are left out. InputError for an unknown stage or name, and for a name for
    which there is nothing to draw.
    """
    for name in names:
        if not (isinstance(name, str) and name in NAMES):
            raise unknown("figure", name, NAMES)
    stages = result.stages if stage is None else (result.stage(stage),)
    if not names:
        for name in NAMES:
            if name not in OF_MANY_CYCLES:
                yield from drawn_if_stored(name, result, stages)
    for name in names:
        try:
            figures = drawn(name, result, stages)
        except NotStored as error:
            version = result.provenance["packages"]["presswear"]
            raise NotStored(f"{error}; presswear {version} wrote the result") from None
        if not figures:
            of_stage = f"stage {stage} of " if stage is not None else ""
            raise InputError(
                f"{of_stage}{result.scene.name} has nothing to draw as {name!r}"
            )
        yield from figures


def first_drawings(result: Result) -> list[Drawing]:
    """Draw the mechanism and the first ``FIRST_COUNT`` figures of ``FIRST`` that show something."""
    drawings_by_name = (drawn_if_stored(name, result, result.stages) for name in FIRST)
    first = islice(filter(None, drawings_by_name), FIRST_COUNT)
    return [*drawn("mechanism", result, result.stages), *chain.from_iterable(first)]


def drawn_if_stored(name: str, result: Result, stages: Stages) -> list[Drawing]:
    """Return the drawings of a figure; none if an earlier version did not record its series."""
    try:
        return drawn(name, result, stages)
    except NotStored:
        return []


def drawn(name: str, result: Result, stages: Stages) -> list[Drawing]:
    """Return the drawings of a figure of ``NAMES``; none where it would show nothing."""
    choice, draw = NAMES[name]
    with matplotlib.rc_context(SETTINGS):
        shown = style.shown_stages(result, stages) if stages else []
        # The numbers of a failed stage are meaningless.
        sound = [stage for stage in shown if not stage.data.failed]
        moving = [stage for stage in sound if stage.data.time.size > 1]
        sampled = [stage for stage in shown if has_motion(result.scene, stage.data)]
        loose = [stage for stage in moving if stage.data.has_joint_series]
        has_pins = bool(result.scene.loose_pins)
        choices: dict[str, Sequence[Any]] = {
            "all": stages,
            "shown": shown,
            "pins": shown if has_pins else (),
            "moving": moving,
            "loose": loose if has_pins else (),
            "guides": loose if result.scene.loose_guides else (),
            "sampled": sampled,
            "sampled pins": sampled if has_pins else (),
        }
        sheets = draw(result, choices[choice]) if choices[choice] else []
    return [_in_words(result, drawing) for drawing in sheets]


def _in_words(result: Result, drawing: Drawing) -> Drawing:
    """Return a drawing with title and caption in the words of the linkage."""
    return replace(
        drawing,
        title=in_words_of(result.scene, drawing.title),
        caption=in_words_of(result.scene, drawing.caption),
    )


def plot(
    result: Result, names: Sequence[str] = (), stage: int | None = None
) -> list[Axes]:
    """Draw figures as ``drawings`` does, show them in a notebook and return their axes."""
    axes = []
    for drawing in drawings(result, names, stage):
        sheet = drawing.sheet
        with matplotlib.rc_context(SETTINGS):
            # ticks get their look when they are first drawn
            sheet.draw_without_rendering()
        # Pyplot gets a figure where it shows figures by itself.
        if "ipykernel" in sys.modules or (
            _PYPLOT in sys.modules and matplotlib.is_interactive()
        ):
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
    few = image.convert("RGB").quantize(
        256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE
    )
    info = PngInfo()
    info.add_text("Software", _PROGRAM)
    write_whole(path, lambda file: few.save(file, format="png", pnginfo=info))
    return path


def remove_others(folder: Path, names: Collection[str]) -> None:
    """Remove the figures of earlier reports from a folder, except for some names."""
    for path in (*folder.glob("*.png"), *folder.glob("*.svg")):
        if path.name not in names and _is_written_here(path):
            path.unlink()


def _is_written_here(path: Path) -> bool:
    """Return whether this program has written an image."""
    if path.suffix == ".svg":
        with path.open("rb") as file:
            return file.read(len(FILE_HEAD)) == FILE_HEAD.encode()
    try:
        with Image.open(path) as image:
            return image.info.get("Software") == _PROGRAM
    except OSError:  # also of a file that is no image
        return False
