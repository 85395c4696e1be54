"""Part of the motion that figures over the crank angle show, and its working zone beside it."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, MultipleLocator

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.results.strokes import SNAP_THROUGH, WORK, strokes_of, working_strokes
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Sheet, Shown, ShownStage
from presswear.tools.arrays import Array

MOMENTS = {
    "contact": ("v", "triangle down: touches the work"),
    "fracture": ("x", "cross: the work breaks"),
    "separation": ("^", "triangle up: leaves the work"),
}
_MARGIN = 0.15  # margin before and after the working zone, part of its length
# What a line of the working zone has in common with that of the full turn
_LINE_STYLE = ("color", "linestyle", "linewidth", "marker", "markersize")
_WIDTHS = (3.0, 2.0)  # widths of the panels of the full turn and of the working zone


class Span(NamedTuple):
    """Times of the ideal motion between which a panel shows the motion, s."""

    start: float
    end: float


@dataclass(frozen=True)
class Window:
    """Part of the motion that figures show, in times of the ideal motion."""

    start: float  # s
    end: float  # s
    period: float  # duration of a cycle, s
    run_up: float  # duration of the run-up, s
    phase: str  # name of the angle of the cycle
    words: str  # description of the part
    # Working zone of a stroke, from the touch of the work to the end of the snap-through,
    # or until the force has vanished; None without work
    zone: Span | None = None

    def rows(
        self, count: int, height: float, **sharing: Any
    ) -> tuple[Sheet, list[Axes], list[Axes]]:
        """Return a sheet of rows, the panels of the full turn and those of the working zone.

        ``height`` is that of the sheet, inches, and ``sharing`` are options of
        ``style.panels``. Without work there are no panels of a working zone.
        """
        widths = _WIDTHS if self.zone else _WIDTHS[:1]
        options = {"sharex": "col", "width_ratios": widths} | sharing
        sheet, grid = style.panels(count, len(widths), height, **options)
        zones = list(grid[:, 1]) if self.zone else []
        return sheet, list(grid[:, 0]), zones

    def label(self, full: Sequence[Axes], zones: Sequence[Axes] = ()) -> None:
        """Limit the panels of the full turn, mark the phase below, and draw their zones."""
        axes = full[-1]
        axes.set_xlim(self.start, self.end)
        axes.xaxis.set_major_locator(MultipleLocator(0.25 * self.period))
        self._write_phase(axes)
        if self.zone is None or not zones:
            return
        for source, target in zip(full, zones, strict=True):
            for line in source.lines:
                _copy(line, source, target, self.zone)
            source.axvspan(*self.zone, color=style.MUTED, alpha=0.12, linewidth=0.0)
            target.yaxis.set_major_formatter(source.yaxis.get_major_formatter())
        zones[0].set_title("working zone (grey at the left)", fontweight="normal")
        start, end = (self.degrees(time) for time in self.zone)
        marks = MaxNLocator(5, steps=[1.0, 2.0, 5.0, 10.0]).tick_values(start, end)
        times = np.asarray(marks) * self.period / 360.0 + 0.5 * self.run_up
        zones[-1].xaxis.set_major_locator(FixedLocator(times.tolist()))
        self._write_phase(zones[-1])
        zones[-1].set_xlim(*self.zone)

    def degrees(self, time: float) -> float:
        """Return the angle of the cycle since the start at a time, s.

        During the run-up the speed rises steadily, so that the angle is half of that at
        nominal speed.
        """
        return 360.0 * (time - 0.5 * self.run_up) / self.period

    def _write_phase(self, axes: Axes) -> None:
        """Write the angle of the cycle in place of the time below a panel.

        With a working zone the angle is written without whole turns.
        """
        turn = 360.0 if self.zone else math.inf

        def text(time: float, _: Any) -> str:
            return f"{round(self.degrees(time), 6) % turn:g}"

        axes.xaxis.set_major_formatter(text)
        since = "" if self.zone else " since the start"
        axes.set_xlabel(f"{self.phase}{since} (degrees)")


def _copy(line: Line2D, source: Axes, target: Axes, zone: Span) -> None:
    """Draw the part of a line in the working zone with its style."""
    x, y = (np.asarray(values, float) for values in line.get_data())
    line_style: dict[str, Any] = {}
    for name in _LINE_STYLE:
        line_style[name] = getattr(line, f"get_{name}")()
    if line.get_transform() is not source.transData:  # a line of ``axhline``
        target.axhline(y[0], **line_style)
        return
    rows = np.flatnonzero((x >= zone.start) & (x <= zone.end))
    if not rows.size:
        return
    first = rows[0]
    end = rows[-1] + 1
    if line_style["linestyle"] != "None":
        # One more row on each side, so that the curve fills the panel.
        first = max(first - 1, 0)
        end += 1
    target.plot(x[first:end], y[first:end], **line_style)


def sampled(result: Result, stages: Shown) -> tuple[list[ShownStage], Window]:
    """Return the stages cut to the part of the motion that is shown: cycles after the start-up.

    With work it is one stroke, from upper dead centre to the next one.
    """
    scene = result.scene
    period = scene.mechanism.period
    ends = [float(stage.data.time[-1]) for stage in stages]
    # A cycle counts if it is complete but for 2 %.
    complete = [round((end - scene.run_up) / period - 0.48) for end in ends]
    first = max(min(STARTUP_CYCLES, min(complete) - 1), 0)
    start = scene.run_up + first * period
    zone = None
    strokes_and_zones = list(filter(None, (_stroke_of(result, s) for s in stages)))
    if strokes_and_zones:
        strokes, zones = zip(*strokes_and_zones, strict=True)
        start = max(stroke.start for stroke in strokes)
        zone_start = min(zone.start for zone in zones)
        zone = Span(zone_start, max(zone.end for zone in zones))
    shown_cycles = 1 if zone else style.SHOWN_CYCLES
    end = min(start + shown_cycles * period, max(ends))
    words = "a stroke" if zone else _words(first, (end - scene.run_up) / period)
    words = f"{words} of {1e3 * period:.0f} ms"
    if scene.linkage().leader is not None:
        words += " at nominal speed"
    if scene.run_up > 0.0:
        words += " after the run-up"
    shown = [
        replace(stage, data=style.between(stage.data, start, end)) for stage in stages
    ]
    phase = scene.mechanism.linkage().phase
    return shown, Window(start, end, period, scene.run_up, phase, words, zone)


def _stroke_of(result: Result, stage: ShownStage) -> tuple[Span, Span] | None:
    """Return the first sampled stroke on the work and its working zone with a margin.

    None without work.
    """
    data = stage.data
    strokes = working_strokes(result.scene, data)
    if not strokes:
        return None
    first = strokes[0]
    _, end_of_work = first.phases.get(SNAP_THROUGH, first.phases[WORK])

    def nominal_span(start: float, end: float) -> Span:
        return Span(*map(float, data.nominal_of(np.array([start, end]))))

    zone = nominal_span(first.contact, end_of_work)
    margin = _MARGIN * (zone.end - zone.start)
    wider_zone = Span(zone.start - margin, zone.end + margin)
    return nominal_span(first.start, first.end), wider_zone


def _words(first: int, count: float) -> str:
    """Return a description of the cycles from index ``first`` to ``count``, a number of cycles."""
    cycles = round(count)
    if abs(count - cycles) > 0.02:
        return f"the first {count:.2g} cycles"
    if first:
        is_one = first + 1 == cycles
        return f"cycle {cycles}" if is_one else f"cycles {first + 1} to {cycles}"
    return (
        "the first cycle, at the start" if cycles == 1 else f"the first {cycles} cycles"
    )


def draw_with_moments(
    axes: Axes,
    result: Result,
    shown: Shown,
    moving: Shown,
    values_of: Callable[[StageResult], Array],
    window: Window,
) -> dict[str, str]:
    """Draw a series of stages, and mark where the work is touched, breaks and is left.

    ``shown`` are the stages cut to the window, and ``moving`` the same stages with all
    their rows. The words of the marks are returned.
    """
    marks = {}
    for stage, uncut in zip(shown, moving, strict=True):
        stage.pen.draw(axes, stage.data.time, values_of(stage.data), linewidth=0.8)
        strokes = strokes_of(result.scene, uncut.data)
        if not strokes:
            continue
        values = values_of(uncut.data)
        for name, (mark, words) in MOMENTS.items():
            times = getattr(strokes, name)[:, 0]
            times = times[(times >= window.start) & (times <= window.end)]
            if times.size:
                marks[mark] = words
                rows = [abs(uncut.data.time - time).argmin() for time in times]
                colour = stage.pen.colour
                axes.plot(times, values[rows], mark, color=colour, markersize=6.0)
    return marks
