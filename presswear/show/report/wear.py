"""Rows and tables of wear: what each stage ran on, and how each wear was applied."""

from functools import partial

import numpy as np

from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult, WearStep
from presswear.show.figures.style import maps_turn
from presswear.show.report.parts import (
    CUBIC_MILLIMETRES,
    MICRONS,
    Rows,
    Table,
    by_joint,
    column_table,
    scaled,
    statistics,
)
from presswear.tools.numbers import readable, whole, with_interval

Steps = tuple[WearStep, ...]


def deepest(result: Result, joint: str) -> Rows[StageResult]:
    """Rows of the deepest wear that each stage ran on, and that one wear after it adds."""
    parts = {side: (side,) for side in SIDES} if maps_turn(result) else {"bearing + pin": SIDES}
    kinds = {"depth": "deepest wear it ran on", "wear": "one more wear: deepest"}
    return {
        f"{label}, {part} (µm)": partial(_peak, joint, kind, sides)
        for kind, label in kinds.items()
        for part, sides in parts.items()
    }


def _peak(joint: str, kind: str, sides: tuple[str, ...], stage: StageResult) -> str:
    told = f"wear_depth_max_{sides[0] if len(sides) == 1 else 'both'}_m"
    if kind == "wear" and told not in statistics(stage, joint):
        return "–"
    own = stage.joints[joint]
    depth = np.sum([own.arrays[f"{kind}_{side}"] for side in sides], axis=0)
    if not np.any(depth > 0.0):
        return "0"
    angle = float(np.degrees(own.angle[int(depth.argmax())]))
    return f"{readable(MICRONS * float(depth.max()))}\u00a0at\u00a0{angle:.1f}°"


def one_wear(result: Result, joint: str) -> Rows[StageResult]:
    """Rows of what one wear after a stage takes off, with intervals."""
    sides = SIDES if maps_turn(result) else ("both",)
    return {
        "worn by one wear (mm³)": partial(_volume, joint),
        "deepest of one wear (µm)": partial(_depth, joint, sides),
    }


def _volume(joint: str, stage: StageResult) -> str:
    found = statistics(stage, joint)
    names = ("wear_volume_m3", "wear_volume_half_width_m3")
    return with_interval(*(scaled(found.get(name), CUBIC_MILLIMETRES) for name in names))


def _depth(joint: str, sides: tuple[str, ...], stage: StageResult) -> str:
    found = statistics(stage, joint)
    texts = []
    for side in sides:
        text = readable(scaled(found.get(f"wear_depth_max_{side}_m"), MICRONS))
        ends = found.get(f"wear_depth_max_{side}_interval_m")
        if ends is not None:
            text += f" ({readable(MICRONS * ends[0])} to {readable(MICRONS * ends[1])})"
        texts.append(text if len(sides) == 1 else f"{side} {text}")
    return ", ".join(texts)


def growth(result: Result) -> Table | None:
    """The steps in which each wear was applied; None where all were single jumps."""
    if not result.grew_in_steps:
        return None

    def of_joint(joint: str) -> Rows[Steps]:
        return {
            **{
                f"deepest then, {side}, mean of the starts (µm)": partial(_then, joint, side)
                for side in SIDES
            },
            "largest normal force in its runs (N)": lambda steps: readable(
                max(step.force_max_N[joint] for step in steps)
            ),
        }

    how: Rows[Steps] = {
        "steps": lambda steps: whole(len(steps)),
        "cycles that it stands for": lambda steps: readable(
            sum(step.cycles_per_update for step in steps)
        ),
        "cycles run": lambda steps: whole(sum(step.cycles for step in steps)),
        "depth multiplied by": spread,
        "largest change in a step (% of the clearance)": lambda steps: readable(
            100.0 * max(step.largest_change_of_clearance for step in steps)
        ),
        "computed in (s)": lambda steps: readable(sum(step.wall_s for step in steps)),
    }
    worn = [stage for stage in result.stages if stage.wear_steps]
    return column_table(
        "how the wear was applied",
        [result.stage_name(stage.index + 1) for stage in worn],
        [stage.wear_steps for stage in worn],
        {"": how, **by_joint(result, of_joint)},
    )


def _then(joint: str, side: str, steps: Steps) -> str:
    return readable(MICRONS * steps[-1].deepest_m[joint][side])


def spread(steps: Steps) -> str:
    """Least and largest multiplier of the steps of a wear."""
    least, most = (pick(step.factor for step in steps) for pick in (min, max))
    if readable(least) == readable(most):
        return readable(most)
    return f"{readable(least)} to {readable(most)}"
