"""Figure of the depth of each surface over the cycles that a campaign stands for."""

from matplotlib.lines import Line2D

from presswear.results.result import Result
from presswear.scene.scene import stage_name
from presswear.show.figures.style import (
    MICRONS,
    MUTED,
    SIDES,
    WIDTH,
    Axes,
    Drawing,
    LineStyle,
    Sheet,
    maps_turn,
)

_MILLIONS = 1e-6
_LINES: dict[str, tuple[str, LineStyle]] = {
    "bearing": ("#0072B2", "solid"),
    "pin": ("#D55E00", (0.0, (7.0, 1.5))),
}
_MARKED_STEPS = 60
"""Most steps whose ends are marked; more would be a thick line."""
_NAMED_WEARS = 2
"""Most wears whose names stand beside each other above a panel; of more, the last is named."""


def wear_growth(result: Result) -> list[Drawing]:
    """Deepest depth of each surface over represented cycles, where wear went in steps."""
    if not result.grew_in_steps:
        return []
    wears = [stage for stage in result.stages if stage.wear_steps]
    joints = result.scene.clearance_joints
    sheet = Sheet(figsize=(WIDTH, 2.9), layout="constrained")
    grid = sheet.subplots(1, len(joints), squeeze=False)
    cycles, ends = [0.0], []
    for stage in wears:
        for step in stage.wear_steps:
            cycles.append(cycles[-1] + _MILLIONS * step.represented_cycles)
        ends.append((cycles[-1], stage_name(stage.index + 1)))
    marker = "." if len(cycles) <= _MARKED_STEPS else ""
    for axes, joint in zip(grid.flat, joints, strict=True):
        for side in SIDES:
            colour, dashes = _LINES[side]
            steps = [step for stage in wears for step in stage.wear_steps]
            depth = [0.0] + [MICRONS * step.deepest_m[joint][side] for step in steps]
            axes.plot(cycles, depth, color=colour, linestyle=dashes, marker=marker, markersize=4.0)
        _mark_wears(axes, ends)
        axes.set_xlim(0.0, None)
        axes.set_ylim(0.0, None)
        axes.set_xlabel("represented cycles (million)")
        axes.set_ylabel("deepest wear (µm)")
        axes.set_title(f"joint {joint}", loc="left", fontweight="bold")
    handles = [
        Line2D([], [], color=colour, linestyle=dashes, label=side)
        for side, (colour, dashes) in _LINES.items()
    ]
    sheet.legend(handles=handles, loc="outside upper right", ncols=len(handles))
    caption = (
        "Deepest wear of each surface over the cycles that the runs stand for. Between two "
        "points the surfaces kept their rate of wear; at each the linkage ran again on the "
        "rebuilt surfaces. Grey lines end a wear. The deepest place may move along a surface."
    )
    if not maps_turn(result):
        caption += " Both surfaces are shown apart, each with its share of the depth."
    return [Drawing("wear-growth.png", "Growth of the wear", caption, sheet)]


def _mark_wears(axes: Axes, ends: list[tuple[float, str]]) -> None:
    for end, _ in ends:
        axes.axvline(end, color=MUTED, linewidth=0.6)
    for end, name in ends if len(ends) <= _NAMED_WEARS else ends[-1:]:
        axes.annotate(
            name,
            (end, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0.0, 2.0),
            textcoords="offset points",
            ha="right",
            va="bottom",
            color=MUTED,
        )
