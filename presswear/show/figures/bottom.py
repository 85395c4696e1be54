"""Figure of bottom dead centre, stroke by stroke."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.bottom import strokes_of
from presswear.results.result import Result
from presswear.show.figures.style import (
    MUTED,
    WIDTH,
    Drawing,
    Sheet,
    Stages,
    legend,
    shown_stages,
    wrapped,
)
from presswear.tools.numbers import unit_scale


def bottom_dead_centre(result: Result, stages: Stages) -> list[Drawing]:
    """Height of bottom dead centre over the ideal in each stroke, a panel for each stage."""
    scene = result.scene
    shown = [
        stage for stage in shown_stages(result, stages) if stage.data.statistics.bdc is not None
    ]
    if not shown or not scene.clearance_joints:
        return []
    strokes = [strokes_of(scene, stage.data) for stage in shown]
    factor, unit = unit_scale(
        "m",
        max(
            float(np.abs(rows).max(initial=0.0)) for replicates in strokes for _, rows in replicates
        ),
    )
    sheet = Sheet(figsize=(WIDTH, 2.6), layout="constrained")
    panels = sheet.subplots(1, len(shown), squeeze=False, sharey=True)[0]
    for axes, stage, replicates in zip(panels, shown, strokes, strict=True):
        for number, rows in replicates:
            stage.pen.draw(axes, number, factor * rows, linewidth=0.7, marker=".", markersize=3.0)
        error = stage.data.bdc.error
        low, high = error.low or error.mean, error.high or error.mean
        ends = (factor * end for end in (low, high))
        axes.axhspan(*ends, color=stage.pen.colour, alpha=0.2, linewidth=0.0)
        axes.axvspan(0.5, STARTUP_CYCLES + 0.5, color=MUTED, alpha=0.12, linewidth=0.0)
        axes.set_xlim(0.5, max(float(number[-1]) for number, _ in replicates if number.size) + 0.5)
        axes.xaxis.set_major_locator(MaxNLocator(6, integer=True))
        axes.set_xlabel(wrapped("since the start (strokes)", (WIDTH - 0.7) / len(shown) - 0.1))
    panels[0].set_ylabel(f"lowest place of the {scene.output}\nless ideal ({unit})")
    legend(sheet, [stage.pen for stage in shown], "outside upper center")
    caption = (
        f"Bottom dead centre of the {scene.output} over the ideal one, stroke by stroke, a line "
        "a start. The band is the mean of the settled strokes with its 95 % interval; grey ones "
        "are left out."
    )
    return [Drawing("bottom-dead-centre.png", "Bottom dead centre", caption, sheet)]
