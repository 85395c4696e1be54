"""Figures 9, 10, 12, 13, 15 and 16: worn surfaces of pin and bearing."""

import numpy as np

from presswear.results.result import Result
from presswear.show.figures.style import SIDES, Sheet, ShownStage
from presswear.show.figures.surfaces import worn_surface
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.figures.lines import Line
from presswear.studies.paper.variants import BASE


def surfaces(
    joint: str, evidence: Evidence, number: int, lines: tuple[Line, ...]
) -> tuple[str, Sheet] | None:
    """Surfaces of a joint, outlines and an enlarged part."""
    shown = [found for line in lines if (found := _worn(evidence, line, joint)) is not None]
    if not shown:
        return None
    drawing = worn_surface(shown[0][0], joint, [stage for _, stage in shown])
    caption = (
        f"{drawing.caption} The surfaces are those that the stage before left on average "
        "over the cycles of all its starts: how uneven they are is partly chance, and the "
        f"depths with their intervals are in Fig. {number - (1 if joint == 'A' else 2)}. The "
        f"enlarged part is around the deepest wear of “{shown[-1][1].label}”."
    )
    return caption, drawing.sheet


def _worn(evidence: Evidence, line: Line, joint: str) -> tuple[Result, ShownStage] | None:
    """The run of a line, with its surfaces; None where nothing is worn."""
    result = evidence.worn_at(BASE, line.at(joint))
    if result is None:
        return None
    before = result.stages[line.wears - 1].arrays
    arrays = {"angle": before["angle"]}
    for side in SIDES:
        name = f"{joint}_depth_{side}"
        # What a stage ran on is what is known best: a wear may have gone in steps.
        if line.wears < len(result.stages):
            arrays[name] = result.stages[line.wears].arrays[name]
        else:
            arrays[name] = before[name] + before[f"{joint}_wear_{side}"]
    if not any(np.any(arrays[f"{joint}_depth_{side}"] > 0.0) for side in SIDES):
        return None
    return result, ShownStage(line.wears, line.wear_name, line.colour, line.dashes, arrays)
