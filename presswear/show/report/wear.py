"""Rows and tables of wear: what each stage ran on, and how each wear was applied."""

import math
from functools import partial

import numpy as np

from presswear.recording.statistics import Estimate
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
    mean,
)
from presswear.tools.numbers import readable, whole

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
    side = sides[0] if len(sides) == 1 else "both"
    found = stage.statistics.joints.get(joint)
    if kind == "wear" and (found is None or side not in found.wear_peaks):
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
        "worn by one wear (mm³)": mean(joint, "wear_volume", CUBIC_MILLIMETRES),
        "deepest of one wear (µm)": partial(_depth, joint, sides),
    }


def _depth(joint: str, sides: tuple[str, ...], stage: StageResult) -> str:
    found = stage.statistics.joints.get(joint)
    texts = []
    for side in sides:
        peak = found and found.wear_peaks.get(side)
        depth = Estimate(math.nan) if peak is None else peak.depth.scaled(MICRONS)
        text = readable(depth.mean)
        if depth.low is not None:
            text += f" ({readable(depth.low)} to {readable(depth.high)})"
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
                max(step.peak_force[joint] for step in steps)
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
            100.0 * max(step.clearance_change for step in steps)
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
    return readable(MICRONS * steps[-1].max_depth[joint][side])


def spread(steps: Steps) -> str:
    """Least and largest multiplier of the steps of a wear."""
    least, most = (pick(step.factor for step in steps) for pick in (min, max))
    if readable(least) == readable(most):
        return readable(most)
    return f"{readable(least)} to {readable(most)}"
