"""Size, colours, lines and units, which all figures share."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from textwrap import fill
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from presswear.results.result import Result
from presswear.results.stage import JOINT_SERIES, StageResult

__all__ = ["Axes", "Sheet"]

Array = NDArray[np.float64]
LineStyle = Literal["solid", "dotted"] | tuple[float, tuple[float, ...]]
Place = Literal["upper right", "outside upper center", "outside upper right"]
Stages = tuple[StageResult, ...]

WIDTH = 7.0
"""Width of every figure, inches: the text width of an A4 page, so that 8 pt print as 8 pt."""
DOTS_PER_INCH = 200
SHOWN_STAGES = 5
"""Most stages in one figure; of more, evenly spaced ones are shown."""
SHOWN_CYCLES = 2
"""Cycles whose motion is shown."""

SETTINGS: dict[Any, Any] = {
    "font.size": 8.5,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.5,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.linewidth": 0.6,
    "grid.color": "0.9",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.1,
}

_ROW, _HANDLE = 112, 8
"""Letters in the width of a figure, and those that a line takes in a legend."""
# The palette of Okabe and Ito, told apart with every common colour blindness.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")
_DASHES: tuple[LineStyle, ...] = (
    "solid",
    (0.0, (7.0, 1.5)),
    (0.0, (6.0, 1.2, 1.5, 1.2)),
    (0.0, (3.0, 1.2)),
    (0.0, (1.2, 1.0)),
)
LINES: tuple[tuple[str, LineStyle], ...] = tuple(zip(_COLOURS, _DASHES, strict=True))
"""Colour and dashes of the first, second, ... of several lines."""
REFERENCE = "black"
"""Colour of what is compared with: the ideal motion, the new surface, the round gap."""
MUTED = "0.45"
"""Colour of what was not run."""

MICRONS = 1e6


@dataclass(frozen=True)
class Drawing:
    """A figure before it is written: file name, title, caption and the drawing itself."""

    file: str
    title: str
    caption: str
    sheet: Sheet


@dataclass(frozen=True)
class Pen:
    """A line as a figure draws it: its name in the legend, colour, dashes and width, points."""

    label: str
    colour: str
    dashes: LineStyle = "solid"
    width: float = SETTINGS["lines.linewidth"]

    def draw(self, axes: Axes, x: ArrayLike, y: ArrayLike, **look: Any) -> None:
        """Draw ``y`` over ``x``, shape (n,) each; ``look`` changes matplotlib's line."""
        axes.plot(x, y, **self.look | look)

    def handle(self) -> Line2D:
        """The line in a legend."""
        return Line2D([], [], label=self.label, **self.look)

    @property
    def look(self) -> dict[str, Any]:
        """How matplotlib draws it."""
        return {"color": self.colour, "linestyle": self.dashes, "linewidth": self.width}


@dataclass(frozen=True)
class ShownStage:
    """A stage with the line that it has in a figure."""

    data: StageResult
    pen: Pen


def shown_stages(result: Result, stages: Stages) -> list[ShownStage]:
    """Pick the first, the last and evenly spaced ones between of some stages, with their lines."""
    count = len(stages)
    picked = np.unique(np.linspace(0, count - 1, min(count, SHOWN_STAGES)).round().astype(int))
    shown = [stages[int(k)] for k in picked]
    labels = stage_names(result, shown)
    return [
        ShownStage(stage, Pen(label, *line))
        for stage, label, line in zip(shown, labels, LINES, strict=False)
    ]


def stage_names(result: Result, stages: Iterable[StageResult]) -> list[str]:
    """Names of stages; one word for all where nothing can wear."""
    worn = bool(result.scene.clearance_joints)
    return [result.stage_name(stage.index) if worn else "computed" for stage in stages]


def between(stage: StageResult, begin: float, end: float) -> StageResult:
    """Return the stage with the rows of all its series between two times, s."""
    first = int(np.searchsorted(stage.time, begin))
    rows = slice(first, int(np.searchsorted(stage.time, end, side="right")))
    series = ["time", "slider", "drive_torque"]
    series += [f"{joint}_{name}" for joint in stage.joint_names for name in JOINT_SERIES]
    cut = {name: stage.arrays[name][rows] for name in series if name in stage.arrays}
    return replace(stage, arrays={**stage.arrays, **cut})


def maps_turn(result: Result) -> bool:
    """Say whether the wear maps turn with their bodies, so that angles on them do not compare."""
    return result.scene.conventions.map_frame == "body"


def angle_label(result: Result, side: str) -> str:
    """Label of an axis of the angles of a wear map."""
    where = f"angle on the {side}" if maps_turn(result) else "direction of contact"
    return f"{where} (degrees)"


def legend(sheet: Sheet, pens: Iterable[Pen], place: Place, **look: Any) -> None:
    """Name the lines of a figure, in one row if they fit; ``look`` changes matplotlib's legend."""
    handles = [pen.handle() for pen in pens]
    letters = sum(len(str(handle.get_label())) + _HANDLE for handle in handles)
    columns = math.ceil(len(handles) / math.ceil(letters / _ROW))
    sheet.legend(handles=handles, loc=place, ncols=columns, **look)


def wrapped(label: str, width: float) -> str:
    """A text in lines of a width, inches."""
    return fill(label, max(round(width * _ROW / WIDTH), 1))


def round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    # A value such as 0.5 may come as 4.9999999 powers of ten.
    return max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-9)) * power


def note(axes: Axes, text: str) -> None:
    """A short remark in the upper right corner of a panel."""
    axes.text(
        0.995,
        0.96,
        text,
        transform=axes.transAxes,
        ha="right",
        va="top",
        bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0},
    )
