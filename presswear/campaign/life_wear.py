"""Wear between two stages through a service life."""

from collections.abc import Callable, Sequence

import numpy as np

from presswear.campaign import wear_update
from presswear.campaign.refinement import Refinement, Refinements
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.results.stage import WearStep
from presswear.tools.arrays import Array


def wear_between(
    refinements: Refinements,
    joints: Sequence[ClearanceJoint],
    initial: Array,
    since: float,
    until: float,
) -> wear_update.WearUpdate:
    """Return the wear between two numbers of strokes, interpolated between ends of blocks.

    ``initial`` are the depths of the initial surfaces of all replicates, shape
    (replicates, joints, 2, bins), m.
    """
    last = refinements[-1]
    coarser = None
    wear_at = _interpolated(last, initial)
    final_depth, final_loss = wear_at(until)
    _, first_loss = wear_at(since)
    if len(refinements) > 1 and refinements[-2].strokes[-1] >= until:
        coarser_at = _interpolated(refinements[-2], initial)
        _, coarser_final_loss = coarser_at(until)
        _, coarser_first_loss = coarser_at(since)
        coarser = coarser_final_loss - coarser_first_loss
    steps = []
    begin = since
    for block in last.blocks:
        end = min(block.strokes, until)
        if end <= begin:
            continue
        depth, material_loss = wear_at(end)
        _, loss_before = wear_at(begin)
        change = (material_loss - loss_before).mean(axis=0) / block.cycles
        forces = (block.samples[f"{joint.name}.force_max"].mean() for joint in joints)
        steps.append(
            WearStep(
                cycles_per_update=end - begin,
                cycles=block.cycles * len(initial),
                factor=(end - begin) / block.cycles,
                clearance_change=wear_update.largest_change(joints, change),
                max_depth=wear_update.by_side(joints, depth.max(axis=3).mean(axis=0)),
                peak_force=wear_update.by_joint(joints, forces),
                wall_s=block.wall_s,
            )
        )
        begin = end
    added_depth = final_loss - first_loss
    return wear_update.WearUpdate(final_depth, added_depth, tuple(steps), coarser)


def _interpolated(refinement: Refinement, initial: Array) -> Callable[[float], Array]:
    """Return a function from a number of strokes to depth and material loss, m.

    Its result has the shape (2, replicates, joints, 2, bins). The depth is that of the
    present surfaces. The material loss includes that of replaced bushings.
    """
    depth = np.array([initial, *(block.depth for block in refinement.blocks)])
    added_depth = np.diff(depth, axis=0, prepend=depth[:1])
    # A block without cycles is a replacement of bushings.
    is_replacement = [block.cycles == 0 for block in refinement.blocks]
    added_depth[1:][is_replacement] = 0.0
    values = np.stack([depth, np.cumsum(added_depth, axis=0)], axis=1)
    ends = np.append(0.0, refinement.strokes)

    def at(strokes: float) -> Array:
        k = int(np.searchsorted(ends, strokes, side="right"))
        if k == len(ends):
            return np.asarray(values[-1])
        part = (strokes - ends[k - 1]) / (ends[k] - ends[k - 1])
        return np.asarray(values[k - 1] + part * (values[k] - values[k - 1]))

    return at
