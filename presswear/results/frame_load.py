"""Loads of elastic frames, guides with a spring, in the sampled strokes of a stage."""

import math
from dataclasses import dataclass

import numpy as np

from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.physics.interactions.elastic_guide import carried_mass
from presswear.recording.statistics import Estimate
from presswear.results.stage import StageResult
from presswear.results.strokes import (
    SNAP_THROUGH_S,
    SampledStroke,
    mean_of_strokes,
    working_strokes,
)
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

ALLOWED_REVERSE = 0.1  # reverse force over the greatest one that press makers allow


@dataclass(frozen=True)
class FrameLoad:
    """Load of an elastic frame in the work, means over the sampled strokes.

    The load is the force of its spring, less the weight that the frame carries, so that
    load and stretch are counted from rest under this weight. The load contains the
    inertia of the moving parts. The reverse force acts against the greatest
    force, within SNAP_THROUGH_S of the fracture; None if nothing breaks.
    """

    force: Estimate | None  # greatest force in the work, N
    stretch: Estimate | None  # stretch at this force, m
    reverse_force: Estimate | None  # N
    reverse_fraction: Estimate | None  # reverse over greatest force of the same stroke


def frame_loads(scene: Scene, stage: StageResult) -> dict[str, FrameLoad]:
    """Return the loads of elastic frames by guide; empty without a stroke on the work."""
    if "stretch" not in stage.arrays or stage.failed:
        return {}
    linkage = scene.linkage()
    strokes = working_strokes(scene, stage)
    if not strokes:
        return {}
    loads = {}
    stretches = stage.arrays["stretch"].T
    for guide, stretch in zip(linkage.elastic_guides, stretches, strict=True):
        loads[guide.name] = _load_of(linkage, guide, stage.clock, stretch, strokes)
    return loads


def carried_weight(linkage: Linkage, guide: Guide) -> float:
    """Return the weight that an elastic frame carries, along its guide, N."""
    weight = linkage.gravity * carried_mass(linkage, guide.body)
    return weight * math.sin(guide.direction)


def _load_of(
    linkage: Linkage,
    guide: Guide,
    time: Array,
    stretch: Array,
    strokes: list[SampledStroke],
) -> FrameLoad:
    """Return the load of a frame from its stretch, m, over time, s; shape (n,)."""
    stiffness = guide.stiffness or 0.0
    load = stiffness * stretch + carried_weight(linkage, guide)
    rows = [_forces_of(time, load, stroke) for stroke in strokes]
    greatest, reverse = np.array(rows).T
    is_loaded = greatest > 0.0
    return FrameLoad(
        force=mean_of_strokes(greatest),
        stretch=mean_of_strokes(greatest / stiffness),
        reverse_force=mean_of_strokes(reverse),
        reverse_fraction=mean_of_strokes(reverse[is_loaded] / greatest[is_loaded]),
    )


def _forces_of(time: Array, load: Array, stroke: SampledStroke) -> tuple[float, float]:
    """Return the greatest force in the work and the reverse force, N; nan without a fracture."""
    end_of_work = stroke.fracture if stroke.has_fracture else stroke.done
    in_work = load[(time >= stroke.contact) & (time <= end_of_work)]
    if not in_work.size:
        return math.nan, math.nan
    peak = float(in_work[np.abs(in_work).argmax()])
    if not stroke.has_fracture:
        return abs(peak), math.nan
    end = min(stroke.fracture + SNAP_THROUGH_S, stroke.end)
    after = load[(time >= stroke.fracture) & (time <= end)]
    reverse = -math.copysign(1.0, peak) * after
    return abs(peak), max(float(reverse.max(initial=0.0)), 0.0)
