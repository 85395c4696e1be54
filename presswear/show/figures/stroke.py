"""Figure of the stroke: the height of what is watched over the phase of the cycle."""

import numpy as np

from presswear.physics.bottom import bottom_of
from presswear.results.result import Result
from presswear.results.strokes import height_of, strokes_of
from presswear.show.figures.motion import IDEAL, moving_stages, settled
from presswear.show.figures.style import WIDTH, Drawing, Sheet, Stages, legend
from presswear.tools.numbers import unit_scale

MOMENTS = {
    "contact": ("v", "touches the work"),
    "fracture": ("x", "the work breaks"),
    "separation": ("^", "leaves the work"),
}
"""Moments of a stroke: their marks, and what happens."""


def height_over_angle(result: Result, stages: Stages) -> list[Drawing]:
    """Height over the ideal bottom dead centre, with the moments of the strokes on the work."""
    scene = result.scene
    moving = moving_stages(result, stages)
    if not moving or bottom_of(scene.ideal) is None:
        return []
    shown, window = settled(result, moving)
    factor, unit = unit_scale("m", scene.stroke)
    time = np.linspace(window.begin, window.end, 1001)
    begun = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)[0, 0]
    ideal = begun + scene.ideal_slider(time)[:, 0] - scene.bottom
    sheet = Sheet(figsize=(WIDTH, 2.9), layout="constrained")
    axes = sheet.subplots()
    marked: dict[str, str] = {}
    for stage, whole in zip(shown, moving, strict=True):
        stage.pen.draw(axes, stage.data.time, factor * height_of(scene, stage.data))
        strokes = strokes_of(scene, whole.data)
        for name, (mark, words) in MOMENTS.items() if strokes else ():
            moments = getattr(strokes, name)
            inside = (moments[:, 0] >= window.begin) & (moments[:, 0] <= window.end)
            if inside.any():
                marked[mark] = words
                when, height = moments[inside].T
                axes.plot(when, factor * height, mark, color=stage.pen.colour, markersize=6)
    IDEAL.draw(axes, time, factor * ideal, linewidth=0.9)
    axes.set_ylabel(f"height of the {scene.output}\nover bottom dead centre ({unit})")
    window.label(axes)
    legend(sheet, [IDEAL, *(stage.pen for stage in shown)], "outside upper center")
    marks = {"v": "pointing down", "^": "pointing up", "x": "cross"}
    caption = (
        f"Height of the {scene.output} over the lowest place that it would reach without "
        f"clearance, over {window.words}."
    )
    if marked:
        told = ", ".join(f"{marks[mark]}: {words}" for mark, words in marked.items())
        caption += f" Marks: {told}."
    return [Drawing("stroke.png", f"Height of the {scene.output} in the stroke", caption, sheet)]
