"""Figure of tonnage: the force of the work and of the joints over the height of a stroke."""

import numpy as np

from presswear.linkage.loads import Coining
from presswear.results.result import Result
from presswear.results.strokes import height_of, process_force
from presswear.results.tonnage import settled_strokes
from presswear.show.figures.motion import IDEAL, moving_stages
from presswear.show.figures.style import WIDTH, Drawing, Sheet, Stages, legend
from presswear.tools.numbers import unit_scale

_REACH = 1.3
"""Greatest height that is shown, part of that at which the work is touched."""


def force_over_stroke(result: Result, stages: Stages) -> list[Drawing]:
    """Force of the work in the settled strokes beside its curve, and of the joints there."""
    scene, process = result.scene, result.scene.process
    shown = [
        (stage, strokes)
        for stage in moving_stages(result, stages)
        if (strokes := settled_strokes(scene, stage.data))
    ]
    if process is None or not shown:
        return []
    joints = scene.clearance_joints if all(own.data.has_joint_series for own, _ in shown) else ()
    reach = _REACH * process.height
    factor, unit = unit_scale("m", reach)
    sheet = Sheet(figsize=(WIDTH, 0.8 + 1.7 * (1 + len(joints))), layout="constrained")
    panels = sheet.subplots(1 + len(joints), 1, sharex=True, squeeze=False)[:, 0]
    for stage, strokes in shown:
        time, height = stage.data.time, height_of(scene, stage.data)
        force = process_force(scene, stage.data)
        assert force is not None, "the scene has a process"
        series = [force, *(np.hypot(*stage.data.joints[name].force.T) for name in joints)]
        for stroke in strokes:
            # Beyond the reach nothing presses on the work.
            inside = (time >= stroke.begin) & (time < stroke.end) & (height <= reach)
            for axes, values in zip(panels, series, strict=True):
                stage.pen.draw(axes, factor * height[inside], values[inside], linewidth=0.7)
    if isinstance(process, Coining):
        depth = np.array([0.0, process.height])
        curve = process.stiffness * depth
    else:
        depth, curve = np.array(process.curve).T
    IDEAL.draw(panels[0], factor * (process.height - depth), curve, linewidth=0.9)
    panels[0].set_ylabel("force of the work (N)")
    for axes, name in zip(panels[1:], joints, strict=True):
        axes.set_ylabel(f"force at {name} (N)")
    panels[-1].set_xlim(factor * reach, 0.0)
    panels[-1].set_xlabel(f"height over the ideal bottom dead centre ({unit})")
    sheet.align_ylabels()
    pens = [IDEAL, *(stage.pen for stage, _ in shown)]
    legend(sheet, pens, "outside upper center")
    caption = (
        f"Force of the work on the {scene.output}, and between pins and bearings, in the settled "
        "strokes that were recorded. Going down is to the right; the way back lies over it. "
        "Dashed: the work's own curve, without a cushion."
    )
    return [Drawing("force-over-stroke.png", "Force over the stroke", caption, sheet)]
