"""Figures 19, 22 and 25: path of the pin's centre in its bearing."""

from presswear.show.figures.motion import (
    circle_line,
    draw_path,
    gap_limit,
    limit_line,
    set_path_limits,
)
from presswear.show.figures.style import WIDTH, Sheet
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.figures.lines import (
    MILLIMETRES,
    ONE_CYCLE,
    Line,
    joint_title,
    shown_cycles,
    shown_joints,
)
from presswear.tools.numbers import readable


def centre_paths(
    evidence: Evidence, number: int, lines: tuple[Line, ...]
) -> tuple[str, Sheet] | None:
    """Path of each pin's centre over one cycle, a panel for each line and joint."""
    shown = shown_cycles(evidence, lines)
    joints = shown_joints(shown)
    if not shown or not joints:
        return None
    side = (WIDTH - 0.9) / max(len(shown), 2) - 0.1
    sheet = Sheet(figsize=(WIDTH, 1.1 + (side + 0.1) * len(joints)), layout="constrained")
    grid = sheet.subplots(len(joints), len(shown), squeeze=False, sharex=True, sharey=True)
    clearance = shown[0].result.scene.bearings.clearance
    widest, bounded = clearance, False
    for row, joint in zip(grid, joints, strict=True):
        for axes, one in zip(row, shown, strict=True):
            path = one.stage.arrays[f"{joint}_eccentricity"]
            limit = gap_limit(one.result, joint, one.stage)
            reach = draw_path(axes, path, limit, clearance, MILLIMETRES, one.line.colour)
            widest, bounded = max(widest, reach), bounded or limit.size > 0
        row[0].set_ylabel(f"{joint_title(joint)}\n$e_y$ (mm)")
    for axes, one in zip(grid[0], shown, strict=True):
        axes.set_title(one.line.name.replace(", ", "\n"))
    for axes in grid[-1]:
        axes.set_xlabel("$e_x$ (mm)")
    set_path_limits(grid.flat, 1.06 * MILLIMETRES * widest)
    handles = [circle_line(f"clearance circle, c = {readable(MILLIMETRES * clearance, 2)} mm")]
    if bounded:
        handles.append(limit_line())
    sheet.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    caption = (
        "Centre of the pin from the centre of its bearing, in fixed directions, over "
        f"{ONE_CYCLE}. It starts in the middle. Dashed: how far the pin of a new joint can go; "
        "where it leaves the circle, it presses into the bearing or the bearing is worn."
    )
    return caption, sheet
