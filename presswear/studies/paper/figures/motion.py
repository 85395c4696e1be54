"""Figures 17, 20 and 23: displacement, velocity and acceleration of the slider."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from matplotlib.figure import SubFigure
from matplotlib.lines import Line2D

from presswear.scene.ideal import ideal_slider
from presswear.scene.scene import stage_name
from presswear.show.figures.motion import IDEAL_DASHES, draw_ideal, draw_stage
from presswear.show.figures.style import REFERENCE, Array, Axes, Sheet, note
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.figures.lines import (
    MILLIMETRES,
    ONE_CYCLE,
    Line,
    Shown,
    shown_cycles,
)
from presswear.studies.paper.figures.peaks import ROW, Peak, draw_peaks, sheet_over_peaks
from presswear.tools.numbers import readable

_QUANTITIES = (("displacement", "m"), ("velocity", "m/s"), ("acceleration", "m/s²"))
_HEIGHTS = (1.15, 0.95, 1.15)
"""Heights of displacement, its distance from the ideal, and velocity, inches."""
_ACCELERATION_HEIGHT = 1.05
_BESIDE = 3
"""Most lines whose names fit beside each other."""


def responses(evidence: Evidence, number: int, lines: tuple[Line, ...]) -> tuple[str, Sheet] | None:
    """The slider over one cycle against the ideal motion, and its peaks over all cycles."""
    shown = shown_cycles(evidence, lines)
    if not shown:
        return None
    columns = _columns(number, shown)
    rows = max(len(column) for column in columns.values())
    upper = sum(_HEIGHTS) + _ACCELERATION_HEIGHT * rows + 0.75
    sheet, top, bottom = sheet_over_peaks(upper, 0.95 + ROW * len(shown))
    _draw_cycles(top, columns, rows)
    handles = [Line2D([], [], color=REFERENCE, linestyle=IDEAL_DASHES, label="ideal")]
    if len(shown) > _BESIDE:
        # Legends fill their columns downwards: the lines of a setting one below the other.
        handles.append(Line2D([], [], linestyle="none", label=" "))
    handles += [one.line.handle(one.line.name) for one in shown]
    columns_of_legend = len(handles) if len(shown) <= _BESIDE else -(-len(handles) // 2)
    top.legend(handles=handles, loc="outside upper center", ncols=columns_of_legend)
    panels = [
        Peak(name, f"largest {name}\nof a cycle ({unit})", ideal=partial(_ideal_peak, column))
        for column, (name, unit) in enumerate(_QUANTITIES)
    ]
    caption = (
        f"Time histories: {ONE_CYCLE}. Dashed: the ideal motion in closed form; the second row "
        "shows how far the displacement is from it. Each panel of acceleration has its own scale, "
        "for impacts dwarf the ideal acceleration, and names its largest value of either sign. "
        + draw_peaks(bottom, evidence, number, shown, panels)
    )
    return caption, sheet


def _columns(number: int, shown: Sequence[Shown]) -> dict[str, list[Shown]]:
    """Panels beside each other with their titles: one for each speed, or stage, or one at all."""
    columns: dict[str, list[Shown]] = {}
    for one in shown:
        title = {20: stage_name(one.line.wears), 23: one.line.own}.get(number, "")
        columns.setdefault(title, []).append(one)
    return columns


def _draw_cycles(sheet: SubFigure, columns: dict[str, list[Shown]], rows: int) -> None:
    """Time histories: three rows for all lines of a column, and one for each acceleration."""
    grid = sheet.subplots(
        3 + rows,
        len(columns),
        squeeze=False,
        sharex="col",
        height_ratios=(*_HEIGHTS, *[_ACCELERATION_HEIGHT] * rows),
    )
    for row in grid[:3]:
        for axes in row[1:]:
            axes.sharey(row[0])
            axes.tick_params(labelleft=False)
    for column, (title, shown) in zip(grid.T, columns.items(), strict=True):
        _draw_column(column, shown)
        column[0].set_title(title, loc="left", fontweight="bold")
        for spare in column[3 + len(shown) :]:
            spare.set_axis_off()
        # Where a panel is missing below, the lowest one names the time.
        lowest = column[2 + len(shown)]
        lowest.set_xlabel("time (s)")
        lowest.tick_params(labelbottom=True)
    first = grid[:, 0]
    for axes, text in zip(
        first[:3],
        ("displacement\n(m)", "displacement\nless ideal (mm)", "velocity\n(m/s)"),
        strict=True,
    ):
        axes.set_ylabel(text)
    for axes in first[3:]:
        axes.set_ylabel("acceleration\n(m/s²)")
    for axes, text in zip(first[[0, 2, 3]], "abc", strict=True):
        _letter(axes, text)
    sheet.align_ylabels(list(first))


def _letter(axes: Axes, text: str) -> None:
    """The letter of a panel, as in the paper, in its upper left corner."""
    axes.text(
        0.008,
        0.95,
        text,
        transform=axes.transAxes,
        ha="left",
        va="top",
        fontweight="bold",
        bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0},
    )


def _draw_column(panels: Sequence[Axes], shown: Sequence[Shown]) -> None:
    period = max(one.period for one in shown)
    time = np.linspace(0.0, period, 1001)
    ideal = ideal_slider(shown[0].result.scene, time)
    every = slice(None)
    for one in shown:
        slider = one.stage.arrays["slider"]
        off = slider[:, 0] - ideal_slider(one.result.scene, one.stage.arrays["time"])[:, 0]
        draw_stage(panels[0], one.stage, every, slider[:, 0])
        draw_stage(panels[1], one.stage, every, MILLIMETRES * off)
        draw_stage(panels[2], one.stage, every, slider[:, 1])
    for axes, values in zip(panels, (ideal[:, 0], 0.0 * time, ideal[:, 1]), strict=False):
        draw_ideal(axes, time, values)
    for axes, one in zip(panels[3:], shown, strict=False):
        _draw_acceleration(axes, one, time, ideal[:, 2])
    panels[0].set_xlim(0.0, period)


def _draw_acceleration(axes: Axes, one: Shown, time: Array, ideal: Array) -> None:
    values = one.stage.arrays["slider"][:, 2]
    axes.plot(one.stage.arrays["time"], values, color=one.line.colour, linewidth=0.7)
    draw_ideal(axes, time, ideal)
    low, high = (float(end(np.append(values, ideal))) for end in (np.min, np.max))
    axes.set_ylim(low - 0.05 * (high - low), high + 0.4 * (high - low))
    note(axes, f"{one.line.name}, largest {readable(one.peak('acceleration'))} m/s²")


def _ideal_peak(column: int, one: Shown) -> float:
    """Largest value of the ideal motion in a cycle; the acceleration's has either sign."""
    values = ideal_slider(one.result.scene, np.linspace(0.0, one.period, 2001))[:, column]
    return float(np.abs(values).max() if column == 2 else values.max())
