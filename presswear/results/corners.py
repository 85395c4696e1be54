"""Motion of the corners of a slide in a guide with clearance, from the series of a stage."""

import math

import numpy as np

from presswear.linkage.guide_corner import CORNERS
from presswear.linkage.joints import Guide
from presswear.results.stage import StageResult
from presswear.tools.arrays import Array


def tilt_series(stage: StageResult, guide: Guide) -> Array:
    """Return the tilt of a slide at the times of the series, rad, shape (n,).

    The corners of one face are the length of the slide apart, and their distances from
    the middle differ by this length times the sine of the tilt.
    """
    length, _ = guide.size
    front, back = (_across(stage, guide, f"left {end}") for end in ("front", "back"))
    return np.asarray(np.arcsin((front - back) / length))


def corner_paths(stage: StageResult, guide: Guide) -> dict[str, Array]:
    """Return the displacement of each corner across the guide, m, shape (n,), by its name."""
    return {corner: _across(stage, guide, corner) for corner in CORNERS}


def _across(stage: StageResult, guide: Guide, corner: str) -> Array:
    """Return the displacement of a corner across the guide, from the middle, m."""
    normal = np.array([-math.sin(guide.direction), math.cos(guide.direction)])
    return np.asarray(stage.joints[f"{guide.name} {corner}"].eccentricity @ normal)
