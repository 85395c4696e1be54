"""Wear between two stages through a service life."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from presswear.campaign.refinement import LoadBlock, Refinement, Refinements
from presswear.campaign.wear_update import (
    WearUpdate,
    by_joint,
    by_side,
    largest_change,
)
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.results.stage import WearStep
from presswear.tools.arrays import Array


def wear_between(
    refinements: Refinements,
    joints: Sequence[ClearanceJoint],
    initial: Array,
    since: float,
    until: float,
) -> WearUpdate:
    """Return the wear between two numbers of strokes, interpolated between ends of blocks.

    ``initial`` are the depths of the initial surfaces of all replicates, shape
    (replicates, joints, 2, bins), m.
    """
    last = refinements[-1]
    wear_at = _interpolated(last, initial)
    coarser = None
    if len(refinements) > 1 and refinements[-2].strokes[-1] >= until:
        coarser_at = _interpolated(refinements[-2], initial)
        coarser = coarser_at(until).material_loss - coarser_at(since).material_loss
    steps = []
    start = since
    for block in last.blocks:
        end = min(block.strokes, until)
        if end > start:
            steps.append(_wear_step(block, start, end, joints, wear_at))
            start = end
    final = wear_at(until)
    added_depth = final.material_loss - wear_at(since).material_loss
    return WearUpdate(final.depth, added_depth, tuple(steps), coarser)


class _Wear(NamedTuple):
    """Wear at a number of strokes; shapes (replicates, joints, 2, bins), m."""

    depth: Array  # depth of the present surfaces
    material_loss: Array  # with the loss of replaced bushings


def _wear_step(
    block: LoadBlock,
    start: float,
    end: float,
    joints: Sequence[ClearanceJoint],
    wear_at: Callable[[float], _Wear],
) -> WearStep:
    """Return the wear between two numbers of strokes in a load block."""
    wear = wear_at(end)
    loss = wear.material_loss - wear_at(start).material_loss
    loss_per_cycle = loss.mean(axis=0) / block.cycles
    peak_forces = [block.samples[f"{joint.name}.force_max"].mean() for joint in joints]
    return WearStep(
        cycles_per_update=end - start,
        cycles=block.cycles * len(loss),
        factor=(end - start) / block.cycles,
        clearance_change=largest_change(joints, loss_per_cycle),
        max_depth=by_side(joints, wear.depth.max(axis=3).mean(axis=0)),
        peak_force=by_joint(joints, peak_forces),
        wall_s=block.wall_s,
    )


def _interpolated(refinement: Refinement, initial: Array) -> Callable[[float], _Wear]:
    """Return the wear as a function of the number of strokes, linear within blocks."""
    depth = np.array([initial, *(block.depth for block in refinement.blocks)])
    added_depth = np.diff(depth, axis=0, prepend=depth[:1])
    # A block without cycles is a replacement of bushings.
    is_replacement = [block.cycles == 0 for block in refinement.blocks]
    added_depth[1:][is_replacement] = 0.0
    values = np.stack([depth, np.cumsum(added_depth, axis=0)], axis=1)
    ends = np.append(0.0, refinement.strokes)

    def at(strokes: float) -> _Wear:
        k = int(np.searchsorted(ends, strokes, side="right"))
        if k == len(ends):
            return _Wear(*values[-1])
        fraction = (strokes - ends[k - 1]) / (ends[k] - ends[k - 1])
        return _Wear(*(values[k - 1] + fraction * (values[k] - values[k - 1])))

    return at
