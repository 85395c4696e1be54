"""Size, colours, line styles, stages and panels of all figures."""

import math
import re
import tomllib
from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from importlib.resources import as_file, files
from itertools import product
from textwrap import fill
from typing import Any

import matplotlib
import numpy as np
from jinja2 import Environment, StrictUndefined
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatterSciNotation
from numpy.typing import ArrayLike

from presswear.recording.columns import JOINT_ARRAYS
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.show.figures.margins import Margins
from presswear.tools.numbers import (
    SUPERSCRIPT,
    large,
    quantity_text,
    readable,
    short_number,
    unit_factor,
    unit_scale,
)

__all__ = ["Axes", "Sheet"]

LineStyle = str | tuple[float, tuple[float, ...]]

WIDTH = 7.0  # inches, the text width of an A4 page, so that 8 pt print as 8 pt
TALLEST = 9.6  # inches, the greatest height that fits an A4 page with its caption
DOTS_PER_INCH = 200
SHOWN_STAGES = 5  # largest number of stages in a figure
SHOWN_CYCLES = 2  # cycles whose motion is shown

_TEMPLATES = files("presswear.show") / "templates"
with as_file(_TEMPLATES / "figures.mplstyle") as file:
    SETTINGS = matplotlib.rc_params_from_file(file, use_default_template=False)
# Multiples of a power of ten that have labels on a logarithmic axis
SUBTICKS = (2.0, 5.0)
_ROW = 112  # characters in the width of a figure
_HANDLE = 8  # width of a line in a legend, characters
# The palette of Okabe and Ito is distinct with every common colour blindness.
LINES: tuple[tuple[str, LineStyle], ...] = (
    ("#0072B2", "solid"),
    ("#D55E00", (0.0, (7.0, 1.5))),
    ("#009E73", (0.0, (6.0, 1.2, 1.5, 1.2))),
    ("#CC79A7", (0.0, (3.0, 1.2))),
    ("#E69F00", (0.0, (1.2, 1.0))),
)
REFERENCE = "black"  # colour of the ideal motion, the new surface, the round gap
MUTED = "0.45"  # colour of what was not run
MICRONS = unit_factor("µm")
TEMPLATES = Environment(undefined=StrictUndefined)
TEMPLATES.filters |= {
    "number": lambda value, digits=3: readable(value, digits),
    "quantity": quantity_text,
    "large": large,
    "short": short_number,
    "slug": lambda text: re.sub(r"[^\w-]", "-", text),
}
_CAPTIONS = tomllib.loads((_TEMPLATES / "captions.toml").read_text("utf-8"))


class _PlainPowers(LogFormatterSciNotation):
    """Powers of ten without mathtext, which is off: a name such as ``$x^$`` is no formula."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        text = (
            super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")
        )
        text = text.replace(r"\times", "·")
        return re.sub(
            r"\^\{(.*)\}", lambda power: power[1].translate(SUPERSCRIPT), text
        )


@dataclass(frozen=True)
class Drawing:
    """Figure before it is written: file name, title, caption and sheet."""

    file: str
    title: str
    caption: str
    sheet: Sheet

    def __post_init__(self) -> None:
        for axes in self.sheet.axes:
            for axis in (axes.xaxis, axes.yaxis):
                major = axis.get_major_formatter()
                minor = axis.get_minor_formatter()
                if isinstance(major, LogFormatterSciNotation):
                    axis.set_major_formatter(
                        _PlainPowers(labelOnlyBase=major.labelOnlyBase)
                    )
                if isinstance(minor, LogFormatterSciNotation):
                    axis.set_minor_formatter(
                        _PlainPowers(labelOnlyBase=minor.labelOnlyBase)
                    )


@dataclass(frozen=True)
class Pen:
    """Line style of a figure: label in the legend, colour, dashes and width in points."""

    label: str
    colour: str
    dashes: LineStyle = "solid"
    width: float = SETTINGS["lines.linewidth"]

    def draw(self, axes: Axes, x: ArrayLike, y: ArrayLike, **line_style: Any) -> None:
        """Draw ``y`` over ``x``, shape (n,) each; ``line_style`` changes matplotlib's line."""
        axes.plot(x, y, **self.line_style | line_style)

    def handle(self) -> Line2D:
        """Return the line of the legend."""
        return Line2D([], [], label=self.label, **self.line_style)

    @property
    def line_style(self) -> dict[str, Any]:
        """Keyword arguments of a matplotlib line."""
        return {"color": self.colour, "linestyle": self.dashes, "linewidth": self.width}


@dataclass(frozen=True)
class ShownStage:
    """Stage with its line style in a figure."""

    data: StageResult
    pen: Pen


Stages = Sequence[StageResult]
Shown = Sequence[ShownStage]


def shown_stages(result: Result, stages: Stages) -> list[ShownStage]:
    """Return the first, the last and evenly spaced stages between, with their line styles."""
    count = len(stages)
    numbers = np.linspace(0, count - 1, min(count, SHOWN_STAGES)).round().astype(int)
    shown = [stages[int(k)] for k in np.unique(numbers)]
    labels = stage_names(result, shown)
    return [
        ShownStage(stage, Pen(label, *line))
        for stage, label, line in zip(shown, labels, LINES, strict=False)
    ]


def first_and_last(stages: Shown) -> list[ShownStage]:
    """Return the first and the last of some stages, which may be the same."""
    return list(stages) if len(stages) < 2 else [stages[0], stages[-1]]


def stage_names(result: Result, stages: Iterable[StageResult]) -> list[str]:
    """Return the names of stages; ``computed`` if nothing can wear."""
    if not result.scene.clearance_joints:
        return ["computed" for _ in stages]
    return [result.stage_name(stage.index) for stage in stages]


def between(stage: StageResult, start: float, end: float) -> StageResult:
    """Return the stage with the rows of all its series between two times, s."""
    first = int(np.searchsorted(stage.time, start))
    rows = slice(first, int(np.searchsorted(stage.time, end, side="right")))
    series = ["time", "clock", "nominal_rate", "slider", "drive_torque"]
    series += ["drive_angle", "drive_speed", "stretch", "pin_stretch"]
    for joint in stage.joint_names:
        series += [f"{joint}_{name}" for name in JOINT_ARRAYS]
    cut = {name: stage.arrays[name][rows] for name in series if name in stage.arrays}
    # A copy, because the class of the arrays names its file if an array is missing
    arrays: Any = copy(stage.arrays)
    arrays.update(cut)
    return replace(stage, arrays=arrays)


def maps_turn(result: Result) -> bool:
    """Return whether the wear maps turn with their bodies, so that their angles do not compare."""
    return result.scene.conventions.map_frame == "body"


def angle_label(result: Result, side: str) -> str:
    """Return the label of an axis of the angles of a wear map."""
    where = f"angle on the {side}" if maps_turn(result) else "direction of contact"
    return f"{where} (degrees)"


def panels(
    rows: int, columns: int, height: float, is_measured: bool = False, **sharing: Any
) -> tuple[Sheet, Any]:
    """Return a sheet of the common width and its grid of axes, an array of shape (rows, columns).

    The height is in inches; ``sharing`` goes to ``Figure.subplots``. Sheets with colour
    bars, or with legends beside a panel, are laid out by measured texts.
    """
    layout: Any = "constrained" if is_measured else Margins()
    sheet = Sheet(figsize=(WIDTH, height), layout=layout)
    return sheet, sheet.subplots(rows, columns, squeeze=False, **sharing)


def panel_list(
    count: int, height: float, columns: int = 2, **sharing: Any
) -> tuple[Sheet, list[Axes], list[Axes]]:
    """Return a sheet of rows of a height in inches, its panels, and the lowest of each column."""
    columns = min(count, columns)
    rows = math.ceil(count / columns)
    sheet, grid = panels(rows, columns, 0.6 + height * rows, **sharing)
    shown = list(grid.flat)[:count]
    for axes in grid.flat[count:]:
        axes.set_axis_off()
    for axes in shown[-columns:]:
        axes.tick_params(labelbottom=True)
    return sheet, shown, shown[-columns:]


def joint_panels(
    joints: Iterable[str], stages: Shown, height: float, label: str = "", **sharing: Any
) -> tuple[Sheet, list[tuple[Axes, str, ShownStage]], list[Axes]]:
    """Return a sheet with a panel for each joint in the first and in the last stage.

    ``height`` is that of a row, inches, and ``label`` is that of the vertical axes at the
    left.

    Returns
    -------
    sheet : Sheet
    panels : list of tuple
        Axes, joint and stage of each panel.
    lowest : list of Axes
        Lowest panel of each column.
    """
    contents = list(product(joints, first_and_last(stages)))
    sheet, shown, lowest = panel_list(len(contents), height, **sharing)
    panels = []
    for axes, (joint, stage) in zip(shown, contents, strict=True):
        axes.set_title(f"joint {joint}, {stage.pen.label}")
        panels.append((axes, joint, stage))
    for axes in shown[:: len(lowest)]:
        axes.set_ylabel(label, parse_math=True)
    return sheet, panels, lowest


def finished(
    name: str,
    sheet: Sheet,
    pens: Iterable[Pen] = (),
    place: Any = "outside upper center",
    **content: Any,
) -> list[Drawing]:
    """Name the lines of a sheet and return it as the only drawing.

    File, title and caption are those of ``captions.toml``, filled with the content.
    """
    handles = [pen.handle() for pen in pens]
    if handles:
        width = sum(len(str(handle.get_label())) + _HANDLE for handle in handles)
        rows = math.ceil(width / _ROW)
        columns = math.ceil(len(handles) / rows)
        sheet.legend(handles=handles, loc=place, ncols=columns)
    texts = []
    for template in _CAPTIONS[name].values():
        text = TEMPLATES.from_string(template).render(content)
        texts.append(re.sub(r"[ \n]+", " ", text).strip())
    file, title, caption = texts
    return [Drawing(file, title, caption, sheet)]


def wrapped(label: str, width: float) -> str:
    """Return a text in lines of a width, inches."""
    return fill(label, max(round(width * _ROW / WIDTH), 1))


def label_values(
    axes: Axes, name: str, unit: str, largest: float | None = None
) -> None:
    """Label the vertical axis of values in SI in a display unit.

    The unit is that in which the largest value, or the largest limit of the axis, reads
    well.
    """
    largest = max(map(abs, axes.get_ylim())) if largest is None else largest
    factor, shown = unit_scale(unit, largest)
    axes.set_ylabel(f"{name} ({shown})".lstrip())
    axes.yaxis.set_major_formatter(
        lambda value, _: f"{factor * value:g}".replace("-", "−")
    )


def round_down(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    # Round-off may make 0.5 smaller than 5 times 0.1.
    limit = value * (1.0 + 1e-9)
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= limit)


def note(axes: Axes, text: str) -> None:
    """Write a short remark into the upper right corner of a panel."""
    box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0}
    axes.text(
        0.995, 0.96, text, bbox=box, transform=axes.transAxes, ha="right", va="top"
    )
