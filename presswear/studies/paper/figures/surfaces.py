"""Figures 9, 10, 12, 13, 15 and 16: worn surfaces of pin and bearing."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from presswear.results.result import Result
from presswear.results.stage import SIDES
from presswear.show.figures.style import Array, Drawing, ShownStage
from presswear.show.figures.surfaces import worn_surface
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.figures.lines import Line
from presswear.studies.paper.variants import BASE

_COMPARED = {
    9: "after the first and the second wear",
    10: "after the first and the second wear",
    12: "after the first wear at two friction coefficients",
    13: "after the first wear at two friction coefficients",
    15: "after the first wear at two speeds",
    16: "after the first wear at two speeds",
}


def surfaces(joint: str) -> Callable[[Evidence, int, tuple[Line, ...]], Drawing | None]:
    """What draws the surfaces of a joint, outlines and an enlarged part."""

    def draw(evidence: Evidence, number: int, lines: tuple[Line, ...]) -> Drawing | None:
        shown = [found for line in lines if (found := _worn(evidence, line, joint)) is not None]
        if not shown:
            return None
        drawing = worn_surface(shown[0][0], joint, [stage for _, stage in shown])
        caption = (
            f"{drawing.caption} The surfaces are those that the stage before left on average "
            "over the cycles of all its starts: how uneven they are is partly chance, and the "
            f"depths with their intervals are in Fig. {number - (1 if joint == 'A' else 2)}. The "
            f"enlarged part is around the deepest wear of “{shown[-1][1].pen.label}”."
        )
        title = f"Fig. {number} Worn surfaces at {joint} {_COMPARED[number]}"
        return replace(drawing, file=f"fig-{number:02d}.png", title=title, caption=caption)

    return draw


def _worn(evidence: Evidence, line: Line, joint: str) -> tuple[Result, ShownStage] | None:
    """The run of a line, with its surfaces; None where nothing is worn."""
    result = evidence.at_stage(BASE, line.setting, line.wears - 1)
    if result is None or joint not in result.scene.clearance_joints:
        return None
    arrays = _after(result, line.wears, joint)
    if not any(np.any(arrays[f"{joint}_depth_{side}"] > 0.0) for side in SIDES):
        return None
    before = result.stages[line.wears - 1]
    worn = replace(before, arrays={**before.arrays, **arrays})
    return result, ShownStage(worn, line.pen(line.wear_name))


def _after(result: Result, wears: int, joint: str) -> dict[str, Array]:
    """Angle and depths after some wears."""
    before = result.stages[wears - 1].arrays
    found = {"angle": before["angle"]}
    for side in SIDES:
        name = f"{joint}_depth_{side}"
        # What a stage ran on is what is known best: a wear may have gone in steps.
        if wears < len(result.stages):
            found[name] = result.stages[wears].arrays[name]
        else:
            found[name] = before[name] + before[f"{joint}_wear_{side}"]
    return found
