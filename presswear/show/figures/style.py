"""What all figures share: size, colours, names of stages, units."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from numpy.typing import NDArray

from presswear.results.result import Result
from presswear.scene.scene import stage_name

__all__ = ["Axes", "Sheet"]

Array = NDArray[np.float64]
LineStyle = Literal["solid"] | tuple[float, tuple[float, ...]]

WIDTH = 7.0
"""Width of every figure, inches: the text width of an A4 page, so that 8 pt print as 8 pt."""
DOTS_PER_INCH = 200
SHOWN_STAGES = 5
"""Most stages in one figure; of more, evenly spaced ones are shown."""
SHOWN_CYCLES = 2
"""Cycles, from the start, whose motion is shown."""

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

SIDES = ("bearing", "pin")
MICRONS = 1e6


@dataclass(frozen=True)
class Drawing:
    """A figure before it is written: file name, title, caption and the drawing itself."""

    file: str
    title: str
    caption: str
    sheet: Sheet


@dataclass(frozen=True)
class ShownStage:
    """A stage with the colour and line it has in every figure.

    Attributes
    ----------
    index : int
        0 unworn, 1 after the first wear, and so on.
    arrays : dict
        Its arrays under their names in the result folder, SI units.
    """

    index: int
    label: str
    colour: str
    dashes: LineStyle
    arrays: Mapping[str, Array]

    def depth(self, joint: str, side: str) -> Array:
        """Depth that the stage ran on, m; ``side`` is bearing or pin."""
        return self.arrays[f"{joint}_depth_{side}"]

    def early(self, end: float) -> slice:
        """Rows up to a time, s."""
        return slice(0, int(np.searchsorted(self.arrays["time"], end, side="right")))


def shown_stages(result: Result) -> list[ShownStage]:
    """The stages that figures show: the first, the last, and evenly spaced ones between."""
    count = len(result.stages)
    picked = np.unique(np.linspace(0, count - 1, min(count, SHOWN_STAGES)).round().astype(int))
    indices = [result.stages[int(k)].index for k in picked]
    labels = map(stage_name, indices) if result.scene.clearance_joints else ["computed"] * count
    return [
        ShownStage(index, label, colour, dashes, result.stages[int(k)].arrays)
        for index, label, k, (colour, dashes) in zip(indices, labels, picked, LINES, strict=False)
    ]


def maps_turn(result: Result) -> bool:
    """Whether the wear maps turn with their bodies, so that angles on them do not compare."""
    return result.scene.conventions.map_frame == "body"


def moving_stages(result: Result) -> list[ShownStage]:
    """The shown stages that have a motion to show.

    One that failed has none: up to where it was ended its numbers are worth nothing.
    """
    failed = {stage.index for stage in result.stages if stage.failed}
    return [
        stage
        for stage in shown_stages(result)
        if stage.index not in failed and stage.arrays["time"].size > 1
    ]


def shown_time(result: Result) -> float:
    """End of the motion shown, s."""
    recorded = max(float(stage.arrays["time"][-1]) for stage in moving_stages(result))
    return min(SHOWN_CYCLES * result.scene.mechanism.period, recorded)


def shown_time_text(result: Result) -> str:
    """The time shown, in words."""
    cycles = shown_time(result) / result.scene.mechanism.period
    whole = round(cycles)
    if whole < 1 or abs(cycles - whole) > 0.02:
        return f"the first {cycles:.2g} cycles"
    return "the first cycle" if whole == 1 else f"the first {whole} cycles"


def length_scale(largest: float) -> tuple[float, str]:
    """Factor and unit in which a length, m, reads as a number between 1 and 1000."""
    for factor, unit in ((1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")):
        if largest * factor >= 1.0:
            return factor, unit
    return 1e12, "pm"


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
