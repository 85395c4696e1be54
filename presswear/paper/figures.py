"""Counterparts of the paper's figures 8 to 25, for the report of the study.

Surfaces, motion, forces and paths are the program's own figures of each run. Figures of
the wear depth and of the peaks of single cycles compare settings and mark what the
paper prints.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import matplotlib
import numpy as np
from matplotlib.ticker import MultipleLocator

from presswear.paper import settings
from presswear.paper.evidence import QUANTITIES, Evidence, Measured
from presswear.paper.printed import PRINTED, RANGES, TEXTS, Place, printed_at
from presswear.paper.settings import BASE, JOINTS, SETTINGS, STAGES, run_name
from presswear.show.figures import Drawing, drawn
from presswear.show.figures.style import LINES, REFERENCE, Axes, Pen, ShownStage, panels
from presswear.show.figures.style import SETTINGS as STYLE
from presswear.show.figures.wear import worn_surface

CAPTIONS = TEXTS["captions"]
# ratio of largest to smallest depth up to which a linear scale shows both
LINEAR_RATIO = 20.0
_DIAMOND: dict[str, Any] = {
    "marker": "D",
    "markerfacecolor": "none",
    "linestyle": "none",
}


@dataclass(frozen=True)
class Line:
    """Setting after some wear updates, in the figures that compare it."""

    setting: str
    wear_updates: int
    pen: Pen

    def at(self, joint: str) -> Place:
        """Return the place of the quantities of a joint, or of the slider for ""."""
        return Place(self.setting, self.wear_updates, joint)


def _lines(*stages: tuple[str, int]) -> tuple[Line, ...]:
    has_several_settings = len({setting for setting, _ in stages}) > 1
    lines = []
    for (setting, wear_updates), line_style in zip(stages, LINES, strict=False):
        name = STAGES[wear_updates]
        if has_several_settings:
            name = f"{SETTINGS[setting].short}, {name}"
        lines.append(Line(setting, wear_updates, Pen(name, *line_style)))
    return tuple(lines)


_WEARS = _lines((settings.WEAR, 0), (settings.WEAR, 1), (settings.WEAR, 2))
_FRICTIONS = _lines(
    (settings.FRICTION, 0),
    (settings.HIGH_FRICTION, 0),
    (settings.FRICTION, 1),
    (settings.HIGH_FRICTION, 1),
)
_SPEEDS = _lines(
    (settings.SLOW, 0), (settings.SLOW, 1), (settings.FAST, 0), (settings.FAST, 1)
)
# Number of the first figure of wear, of the first figure of motion, and lines
GROUPS = ((8, 17, _WEARS), (11, 20, _FRICTIONS), (14, 23, _SPEEDS))


def drawings(evidence: Evidence) -> Iterator[Drawing]:
    """Draw the figures in the order of their numbers."""
    for number, _, lines in GROUPS:
        with matplotlib.rc_context(STYLE):
            figures = [depths(evidence, number, lines)]
            for k, joint in enumerate(JOINTS, 1):
                figures.append(surfaces(evidence, number + k, lines, joint))
        yield from filter(None, figures)
    for _, number, lines in GROUPS:
        yield from _motion_figures(evidence, number, lines)


def _motion_figures(
    evidence: Evidence, number: int, lines: Sequence[Line]
) -> Iterator[Drawing]:
    """Draw motion, force and path of each setting, and their peaks."""
    count = 1 + max(line.wear_updates for line in lines)
    # Quantities and joints whose peaks are drawn, by figure
    compared: dict[str, list[tuple[str, str]]] = {
        "response": [("displacement", ""), ("velocity", ""), ("acceleration", "")],
        "force": [("force", joint) for joint in JOINTS],
        "path": [],
    }
    for k, (kind, quantities) in enumerate(compared.items()):
        for setting in dict.fromkeys(line.setting for line in lines):
            if (result := evidence.results.get(run_name(BASE, setting))) is None:
                continue
            stages = tuple(stage for stage in result.stages[:count] if not stage.failed)
            for drawing in drawn(kind, result, stages):
                title = f"Fig. {number + k} {drawing.title}, {SETTINGS[setting].label}"
                yield replace(
                    drawing, file=f"fig-{number + k}-{setting}.png", title=title
                )
        with matplotlib.rc_context(STYLE):
            peak_figure = peaks(evidence, number + k, lines, quantities)
        if peak_figure is not None:
            yield peak_figure


def surfaces(
    evidence: Evidence, number: int, lines: Sequence[Line], joint: str
) -> Drawing | None:
    """Draw the surfaces of a joint after wear updates; None if nothing is worn."""
    shown = []
    results = []
    for line in lines:
        result = evidence.worn_run(BASE, line.at(joint))
        if result is None:
            continue
        stage = result.stages[line.wear_updates - 1]
        arrays = dict(stage.arrays)
        for name in (f"{joint}_depth_bearing", f"{joint}_depth_pin"):
            # The next stage ran on the exact surfaces. The sum is exact only if the
            # wear update had a single step.
            if line.wear_updates < len(result.stages):
                arrays[name] = result.stages[line.wear_updates].arrays[name]
            else:
                arrays[name] = arrays[name] + arrays[name.replace("depth", "wear")]
        shown.append(ShownStage(replace(stage, arrays=arrays), line.pen))
        results.append(result)
    if not shown:
        return None
    drawing = worn_surface(results[-1], joint, shown)
    caption = f"{drawing.caption} The enlarged part is of “{shown[-1].pen.label}”."
    title = f"Fig. {number} {drawing.title}"
    return replace(drawing, file=f"fig-{number:02d}.png", title=title, caption=caption)


def depths(evidence: Evidence, number: int, lines: Sequence[Line]) -> Drawing | None:
    """Draw the sum of the depths of pin and bearing, with the printed deepest wear."""
    with_wear = [line for line in lines if line.wear_updates > 0]
    worn = [line for line in with_wear if evidence.worn_run(BASE, line.at("A"))]
    if not worn:
        return None
    joints = [joint for joint in JOINTS if evidence.wear_map(BASE, worn[0].at(joint))]
    sheet, grid = panels(len(joints), 1, 0.8 + 2.5 * len(joints))
    for (axes,), joint in zip(grid, joints, strict=True):
        _draw_depths(axes, evidence, worn, joint)
        for arc in _printed_arcs(number, joint):
            axes.plot(
                np.degrees(arc),
                (0.98, 0.98),
                color="0.7",
                lw=4.0,
                transform=axes.get_xaxis_transform(),
            )
        axes.set_xlabel("direction of contact (degrees)")
        axes.set_ylabel("depth, bearing + pin (µm)")
        axes.set_title(f"joint {joint}")
    sheet.legend(
        handles=[line.pen.handle() for line in worn],
        loc="outside upper center",
        ncols=3,
    )
    printed = [entry for entry in PRINTED if _number_of(entry.figure) == number]
    doubts = dict.fromkeys(entry.misprint for entry in printed if entry.misprint)
    caption = CAPTIONS["depths"] + "".join(f" In print: {doubt}." for doubt in doubts)
    return Drawing(f"fig-{number:02d}.png", f"Fig. {number} Wear depth", caption, sheet)


def _number_of(figure: str) -> int:
    """Return the number of a printed figure such as ``8a``."""
    return int(figure[:-1])


def _printed_arcs(number: int, joint: str) -> Iterator[tuple[float, float]]:
    """Yield the arcs in which a joint is mainly worn by a printed figure, rad."""
    for figure, joint_of_figure, arcs in RANGES:
        if _number_of(figure) == number and joint_of_figure == joint:
            yield from arcs


def _draw_depths(
    axes: Axes, evidence: Evidence, lines: Sequence[Line], joint: str
) -> None:
    """Draw measured depths with intervals, and the printed deepest wear."""
    maps = {line: evidence.wear_map(BASE, line.at(joint)) for line in lines}
    printed = {line: printed_at(line.at(joint), "depth") for line in lines}
    largest = [1e6 * float(worn.mean.max()) for worn in maps.values() if worn]
    largest += [1e6 * number.value for number in printed.values() if number]
    is_logarithmic = max(largest) > LINEAR_RATIO * min(largest)
    floor = min(largest) / 30.0 if is_logarithmic else 0.0
    for line, worn in maps.items():
        if worn is None:
            continue
        degrees = np.degrees(worn.angle)
        colour = line.pen.colour
        curves = (worn.mean, worn.low, worn.high)
        mean, low, high = (np.maximum(1e6 * depth, 0.5 * floor) for depth in curves)
        axes.fill_between(degrees, low, high, color=colour, alpha=0.2, linewidth=0.0)
        line.pen.draw(axes, degrees, mean, linewidth=1.2)
        depth = printed[line]
        angle = printed_at(line.at(joint), "angle")
        if depth and angle:
            axes.plot(
                np.degrees(angle.value),
                1e6 * depth.value,
                color=colour,
                gid="printed",
                **_DIAMOND,
            )
    axes.set_xlim(0.0, 360.0)
    if is_logarithmic:
        axes.set_yscale("log")
        axes.set_ylim(floor, 3.0 * max(largest))
    else:
        axes.set_yscale("linear")
        axes.set_ylim(floor, None)
    axes.xaxis.set_major_locator(MultipleLocator(60.0))


def _measured(
    evidence: Evidence, lines: Sequence[Line], quantity: str, joint: str
) -> Iterator[tuple[int, Line, Measured]]:
    """Yield place in the figure, line and value of each line with a computed value."""
    for place, line in enumerate(lines):
        measured = evidence.measured(BASE, line.at(joint), quantity)
        if measured is not None:
            yield place, line, measured


def _draw_peak(axes: Axes, height: int, colour: str, measured: Measured) -> None:
    """Draw the mean of the peaks of cycles, its interval, and the range of single cycles."""
    estimate = measured.estimate
    if measured.single_cycles is not None:
        low, high = measured.single_cycles
        axes.barh(height, high - low, 0.62, low, color=colour, alpha=0.25)
    if estimate.low is not None and estimate.high is not None:
        interval = (estimate.low, estimate.high)
        axes.plot(interval, (height, height), color=colour, linewidth=1.8)
    axes.plot(
        estimate.mean, height, color=colour, marker="o", markersize=4.5, gid="mean"
    )


def peaks(
    evidence: Evidence,
    number: int,
    lines: Sequence[Line],
    shown: Sequence[tuple[str, str]],
) -> Drawing | None:
    """Draw means, scatter and printed values of the peaks of cycles, one row for each line.

    ``shown`` are quantities and joints.
    """
    if not shown or not any(_measured(evidence, lines, *shown[0])):
        return None
    sheet, grid = panels(1, len(shown), 0.85 + 0.24 * len(lines), sharey=True)
    for axes, (quantity, joint) in zip(grid[0], shown, strict=True):
        row = QUANTITIES[quantity]
        for height, line, measured in _measured(evidence, lines, quantity, joint):
            _draw_peak(axes, height, line.pen.colour, measured)
            printed = printed_at(line.at(joint), quantity)
            if printed is not None:
                axes.plot(
                    printed.value, height, color=REFERENCE, gid="printed", **_DIAMOND
                )
        where = f" at {joint}" if joint else ""
        axes.set_xlabel(f"{row.label}{where} ({row.unit})")
        axes.set_yticks(range(len(lines)), [line.pen.label for line in lines])
        axes.set_ylim(len(lines) - 0.5, -0.5)
        axes.locator_params(axis="x", nbins=4)
        axes.use_sticky_edges = False
        axes.margins(x=0.05)
    title = f"Fig. {number} Peaks of cycles"
    return Drawing(f"fig-{number}-peaks.png", title, CAPTIONS["peaks"], sheet)
