"""Figures 18, 21 and 24: contact force at A and C."""

from collections.abc import Sequence

from matplotlib.figure import SubFigure

from presswear.show.figures.style import Axes, Sheet, note
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.figures.lines import (
    ONE_CYCLE,
    Line,
    Shown,
    joint_title,
    shown_cycles,
    shown_joints,
)
from presswear.studies.paper.figures.peaks import ROW, Peak, draw_peaks, sheet_over_peaks
from presswear.tools.numbers import readable

_ROW_HEIGHT = 1.2


def contact_forces(
    evidence: Evidence, number: int, lines: tuple[Line, ...]
) -> tuple[str, Sheet] | None:
    """Normal force over one cycle, and its peaks over all cycles."""
    shown = shown_cycles(evidence, lines)
    joints = shown_joints(shown)
    if not shown or not joints:
        return None
    sheet, top, bottom = sheet_over_peaks(0.5 + _ROW_HEIGHT * len(shown), 0.85 + ROW * len(shown))
    _draw_cycles(top, shown, joints)
    panels = [Peak("force", f"largest force at {joint} in a cycle (N)", joint) for joint in joints]
    caption = (
        f"Normal contact force over time: {ONE_CYCLE}. Each panel has its own scale and names its "
        f"largest force. {draw_peaks(bottom, evidence, number, shown, panels)}"
    )
    return caption, sheet


def _draw_cycles(sheet: SubFigure, shown: Sequence[Shown], joints: Sequence[str]) -> None:
    grid = sheet.subplots(len(shown), len(joints), squeeze=False)
    for row, one in zip(grid, shown, strict=True):
        for axes, joint in zip(row, joints, strict=True):
            _draw_force(axes, one, joint)
        row[0].set_ylabel("normal force (N)")
    for column, joint in zip(grid.T, joints, strict=True):
        column[0].set_title(joint_title(joint), loc="left", fontweight="bold")
        for k, axes in enumerate(column):
            # Times are named again where the period changes.
            last = k == len(shown) - 1 or shown[k + 1].period != shown[k].period
            axes.tick_params(labelbottom=last)
            if last:
                axes.set_xlabel("time (s)")
    sheet.align_ylabels(list(grid[:, 0]))


def _draw_force(axes: Axes, one: Shown, joint: str) -> None:
    force = one.stage.arrays[f"{joint}_force"][:, 0]
    axes.plot(one.stage.arrays["time"], force, color=one.line.colour, linewidth=0.7)
    largest = float(force.max())
    axes.set_xlim(0.0, one.period)
    axes.set_ylim(0.0, 1.35 * largest if largest > 0.0 else 1.0)
    note(axes, f"{one.line.name}, largest {readable(one.peak('force', joint))} N")
