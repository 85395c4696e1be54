"""Table of the report on the moments of a stroke."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.results.strokes import strokes_of
from presswear.scene.scene import Scene
from presswear.show.figures.style import stage_names
from presswear.show.report.parts import MILLI, NOTHING, Table, Text, column_table


def moments(result: Result) -> Table | None:
    """When and how high strokes touch the work, break it and leave it; None where none does."""
    scene = result.scene
    stages = tuple(stage for stage in result.stages if not stage.failed)
    found = {stage.index: strokes_of(scene, stage) for stage in stages}
    if all(own is None or not len(own.contact) for own in found.values()):
        return None
    words = {"contact": "Touches the work", "fracture": "Breaks it", "separation": "Leaves it"}
    begin = scene.run_up + STARTUP_CYCLES * scene.mechanism.period

    def told(name: str, in_degrees: bool) -> Text:
        def text(stage: StageResult) -> str:
            strokes = found[stage.index]
            rows = np.zeros((0, 2)) if strokes is None else getattr(strokes, name)
            rows = rows[~np.isnan(rows[:, 0])]
            settled = rows[rows[:, 0] >= begin]
            rows = settled if len(settled) else rows
            if not len(rows):
                return NOTHING
            if not in_degrees:
                return _spread(MILLI * rows[:, 1], 3)
            angle = degrees(scene, rows[:, 0])
            # Beside the first: 359 and 1 degrees lie close.
            return _spread(angle[0] + (angle - angle[0] + 180.0) % 360.0 - 180.0, 2)

        return text

    def rows_of(name: str) -> Mapping[str, Text]:
        return {
            f"{scene.mechanism.linkage().phase} (degrees)": told(name, True),
            "height over bottom dead centre (mm)": told(name, False),
        }

    groups = {
        heading: rows_of(name)
        for name, heading in words.items()
        if any(own and not np.isnan(getattr(own, name)).all() for own in found.values())
    }
    return column_table("moments of a stroke", stage_names(result, stages), stages, groups)


def _spread(values: NDArray[np.float64], decimals: int) -> str:
    """The mean of some values, and their ends in brackets where they differ."""
    low, middle, high = (
        f"{own:.{decimals}f}".replace("-", "−")
        for own in (values.min(), values.mean(), values.max())
    )
    return middle if low == high else f"{middle} ({low} to {high})"


def degrees(scene: Scene, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Phase of the cycle at instants, degrees, below 360."""
    return np.asarray(360.0 * ((time - 0.5 * scene.run_up) / scene.mechanism.period) % 360.0)
