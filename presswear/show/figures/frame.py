"""Figure of elastic frames: stretch and force over the crank angle."""

from functools import partial

import numpy as np

from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.results.frame_load import carried_weight
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing, Shown
from presswear.show.figures.window import draw_with_moments, sampled
from presswear.tools.arrays import Array


def stretch_over_angle(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the stretch of each elastic frame over the crank angle, with its force at the right."""
    linkage = result.scene.linkage()
    guides = linkage.elastic_guides
    if not guides or any("stretch" not in stage.data.arrays for stage in moving):
        return []
    shown, window = sampled(result, moving)
    height = 0.6 + 2.4 * len(guides)
    sheet, panels, zones = window.rows(len(guides), height, is_measured=True)
    marks: dict[str, str] = {}
    for k, (guide, axes) in enumerate(zip(guides, panels, strict=True)):
        stretch = partial(_stretch, number=k)
        marks |= draw_with_moments(axes, result, shown, moving, stretch, window)
        axes.set_ylabel(f"stretch of {guide.name} (µm)")
    window.label(panels, zones)
    for guide, axes in zip(guides, zones or panels, strict=True):
        _add_force(axes, linkage, guide)
    pens = [stage.pen for stage in shown]
    return style.finished(
        "frame", sheet, pens, window=window, marks=marks.values(), guides=guides
    )


def _stretch(stage: StageResult, number: int) -> Array:
    """Return the stretch of an elastic frame over time, um."""
    return np.asarray(1e6 * stage.arrays["stretch"][:, number])


def _add_force(axes: Axes, linkage: Linkage, guide: Guide) -> None:
    """Add a scale of the force of a frame, less the weight that it carries, at the right."""
    slope = 1e-9 * (guide.stiffness or 0.0)  # kN/µm
    weight = 1e-3 * carried_weight(linkage, guide)
    functions = (
        lambda stretch: slope * stretch + weight,
        lambda force: (force - weight) / slope,
    )
    scale = axes.secondary_yaxis("right", functions=functions)
    scale.set_ylabel("force (kN)")
