"""Tables of wear: what each stage ran on, and how each wear was applied."""

from collections.abc import Callable
from functools import partial

import numpy as np

from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult, WearStep
from presswear.scene.scene import stage_name
from presswear.show.figures.style import maps_turn
from presswear.show.report.parts import MICRONS, Row, Table, by_stage
from presswear.tools.numbers import readable, whole

Steps = tuple[WearStep, ...]


def wear_rows(result: Result, joint: str) -> list[Row]:
    """Deepest wear that each stage ran on, and that one wear after it adds."""
    rows = []
    parts = {side: (side,) for side in SIDES} if maps_turn(result) else {"bearing + pin": SIDES}
    for kind, text in (("depth", "deepest wear it ran on"), ("wear", "one more wear: deepest")):
        for part, sides in parts.items():

            def peak(stage: StageResult, kind: str = kind, sides: tuple[str, ...] = sides) -> str:
                depth = np.sum([stage.arrays[f"{joint}_{kind}_{side}"] for side in sides], axis=0)
                if not np.any(depth > 0.0):
                    return "0"
                angle = float(np.degrees(stage.angle[int(depth.argmax())]))
                return f"{readable(MICRONS * float(depth.max()))}\u00a0at\u00a0{angle:.1f}°"

            rows.append(by_stage(result, f"{text}, {part} (µm)", peak))
    return rows


def deepest_with_interval(result: Result, joint: str, stage: StageResult) -> str:
    """Deepest depth that one wear after a stage adds, with the ends of its interval."""
    found = stage.statistics.get("joints", {}).get(joint, {})
    sides = SIDES if maps_turn(result) else ("both",)
    texts = []
    for side in sides:
        depth = found.get(f"wear_depth_max_{side}_m")
        ends = found.get(f"wear_depth_max_{side}_interval_m")
        text = readable(None if depth is None else MICRONS * depth)
        if ends is not None:
            text += f" ({readable(MICRONS * ends[0])} to {readable(MICRONS * ends[1])})"
        texts.append(text if len(sides) == 1 else f"{side} {text}")
    return ", ".join(texts)


def growth(result: Result) -> Table | None:
    """How each wear was applied; None where all were single jumps."""
    if not result.grew_in_steps:
        return None
    wears = {
        stage_name(stage.index + 1): stage.wear_steps for stage in result.stages if stage.wear_steps
    }

    def row(label: str, value: Callable[[Steps], str]) -> Row:
        return (label, *map(value, wears.values()))

    how = (
        row("steps", lambda steps: whole(len(steps))),
        row(
            "cycles that it stands for",
            lambda steps: readable(sum(step.represented_cycles for step in steps)),
        ),
        row("cycles run", lambda steps: whole(sum(step.cycles for step in steps))),
        row("depth multiplied by", spread),
        row(
            "largest change in a step (% of the clearance)",
            lambda steps: readable(100.0 * max(step.largest_change_of_clearance for step in steps)),
        ),
        row("computed in (s)", lambda steps: readable(sum(step.wall_s for step in steps))),
    )
    joints = [
        (
            f"Joint {joint}",
            (
                *(
                    row(f"deepest then, {side} (µm)", partial(_deepest_then, joint, side))
                    for side in SIDES
                ),
                row("largest normal force in its runs (N)", partial(_largest_force, joint)),
            ),
        )
        for joint in result.scene.clearance_joints
    ]
    return Table(("how the wear was applied", *wears), (("", how), *joints))


def _deepest_then(joint: str, side: str, steps: Steps) -> str:
    return readable(MICRONS * steps[-1].deepest_m[joint][side])


def _largest_force(joint: str, steps: Steps) -> str:
    return readable(max(step.force_max_N[joint] for step in steps))


def spread(steps: Steps) -> str:
    """Least and largest multiplier of the steps of a wear."""
    least, most = (pick(step.factor for step in steps) for pick in (min, max))
    if readable(least) == readable(most):
        return readable(most)
    return f"{readable(least)} to {readable(most)}"
