"""Tables of wear: what each stage ran on, and how each wear was applied."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from presswear.results.results import StoredResult
from presswear.scene.scene import stage_name
from presswear.show.figures.style import SIDES, maps_turn
from presswear.show.report.parts import MICRONS, Row, Table, by_stage
from presswear.tools.numbers import readable, whole


def wear_rows(result: StoredResult, joint: str) -> list[Row]:
    """Deepest wear that each stage ran on, and that one wear after it adds."""
    rows = []
    parts = {side: (side,) for side in SIDES} if maps_turn(result) else {"bearing + pin": SIDES}
    for kind, text in (("depth", "deepest wear it ran on"), ("wear", "one more wear: deepest")):
        for part, sides in parts.items():

            def peak(k: int, kind: str = kind, sides: tuple[str, ...] = sides) -> str:
                arrays = result.stages[k]
                depth = np.sum([arrays[f"{joint}_{kind}_{side}"] for side in sides], axis=0)
                if not np.any(depth > 0.0):
                    return "0"
                angle = float(np.degrees(arrays["angle"][int(depth.argmax())]))
                return f"{readable(MICRONS * float(depth.max()))}\u00a0at\u00a0{angle:.1f}°"

            rows.append(by_stage(result, f"{text}, {part} (µm)", peak))
    return rows


def deepest_with_interval(result: StoredResult, joint: str, k: int) -> str:
    """Deepest depth that one wear after a stage adds, with the ends of its interval."""
    found = result.statistics(k).get("joints", {}).get(joint, {})
    sides = ("bearing", "pin") if maps_turn(result) else ("both",)
    texts = []
    for side in sides:
        depth = found.get(f"wear_depth_max_{side}_m")
        ends = found.get(f"wear_depth_max_{side}_interval_m")
        text = readable(None if depth is None else MICRONS * depth)
        if ends is not None:
            text += f" ({readable(MICRONS * ends[0])} to {readable(MICRONS * ends[1])})"
        texts.append(text if len(sides) == 1 else f"{side} {text}")
    return ", ".join(texts)


def growth(result: StoredResult) -> Table | None:
    """How each wear was applied; None where all were single jumps."""
    if not result.grew_in_steps:
        return None
    wears = [
        (stage_name(stage["index"] + 1), steps)
        for k, stage in enumerate(result.document["stages"])
        if (steps := result.wear_steps(k))
    ]

    def row(label: str, value: Callable[[list[dict[str, Any]]], str]) -> Row:
        return (label, *(value(steps) for _, steps in wears))

    how = (
        row("steps", lambda steps: whole(len(steps))),
        row("cycles that it stands for", lambda steps: readable(_sum(steps, "represented_cycles"))),
        row("cycles run", lambda steps: whole(_sum(steps, "cycles"))),
        row("depth multiplied by", lambda steps: spread(steps, "factor")),
        row(
            "largest change in a step (% of the clearance)",
            lambda steps: readable(100.0 * max(s["largest_change_of_clearance"] for s in steps)),
        ),
        row("computed in (s)", lambda steps: readable(_sum(steps, "wall_s"))),
    )
    joints = [
        (
            f"Joint {joint}",
            (
                *(
                    row(
                        f"deepest then, {side} (µm)",
                        partial(_deepest_then, joint, side),
                    )
                    for side in SIDES
                ),
                row(
                    "largest normal force in its runs (N)",
                    partial(_largest_force, joint),
                ),
            ),
        )
        for joint in result.scene.clearance_joints
    ]
    names = tuple(name for name, _ in wears)
    return Table(("how the wear was applied", *names), (("", how), *joints))


def _deepest_then(joint: str, side: str, steps: list[dict[str, Any]]) -> str:
    return readable(MICRONS * steps[-1]["deepest_m"][joint][side])


def _largest_force(joint: str, steps: list[dict[str, Any]]) -> str:
    return readable(max(s["force_max_N"][joint] for s in steps))


def _sum(steps: list[dict[str, Any]], key: str) -> float:
    return float(sum(step[key] for step in steps))


def spread(steps: list[dict[str, Any]], key: str) -> str:
    """Least and largest of a number of each step."""
    least, most = (pick(step[key] for step in steps) for pick in (min, max))
    if readable(least) == readable(most):
        return readable(most)
    return f"{readable(least)} to {readable(most)}"
