"""The figures of a result, as PNG files."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import matplotlib

from presswear.results.result import Result
from presswear.show.figures.growth import wear_growth
from presswear.show.figures.motion import centre_trajectory, contact_force, response
from presswear.show.figures.style import DOTS_PER_INCH, SETTINGS, Drawing
from presswear.show.figures.surfaces import worn_surfaces
from presswear.show.figures.wear import wear_depth
from presswear.tools.files import write_whole

__all__ = ["Drawing", "Figure", "draw_all", "drawings", "save"]

_DRAWERS: tuple[Callable[[Result], list[Drawing]], ...] = (
    wear_depth,
    wear_growth,
    worn_surfaces,
    response,
    contact_force,
    centre_trajectory,
)


@dataclass(frozen=True)
class Figure:
    """A figure that was written: file name inside its folder, title and caption."""

    file: str
    title: str
    caption: str


def drawings(result: Result) -> Iterator[Drawing]:
    """Draw what makes sense for a result, in the order of the report."""
    for draw in _DRAWERS:
        with matplotlib.rc_context(SETTINGS):
            found = draw(result)
        yield from found


def save(drawing: Drawing, folder: Path) -> Figure:
    """Write a drawing into a folder, which is made where needed."""

    def write(file: BinaryIO) -> None:
        drawing.sheet.savefig(file, format="png", dpi=DOTS_PER_INCH)

    folder.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(SETTINGS):
        write_whole(folder / drawing.file, write)
    return Figure(drawing.file, drawing.title, drawing.caption)


def draw_all(result: Result, folder: Path) -> list[Figure]:
    """Write the figures of a result into a folder."""
    return [save(drawing, folder) for drawing in drawings(result)]
