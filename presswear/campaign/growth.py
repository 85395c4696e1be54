"""Growth of the wear between two stages, of each start on surfaces of its own.

Wear follows dh/dN = E[w(h)]: the mean depth that a cycle adds on the surfaces h, of which one
cycle of a chaotic motion is a draw.  A wear cycle by cycle takes after each one what it stands
for, and no map is multiplied before the surfaces answer: a bump carries more pressure and wears
faster, so that noise is worn away again.  That holds while a cycle's share takes less than the
elastic overlap of the surfaces, twice of which a bump would overshoot.  The error of the step
goes as one over the cycles; a pass with twice as many shows it.

In one jump, as the paper does, a map is multiplied as it is, and its noise with it: the next
stage runs on a surface the rougher, the fewer cycles its map is of, and what it tells falls or
rises with them about as their root (of the paper's scene mean peak forces at A after two such
wears of 50, 200 and 2000 cycles were 298, 256 and 226 N).  So a number behind a jump is one for
that many cycles, as it is one for that many angles; the paper's are 200.  The starts go on twice:
together, on the mean of all their maps, and each alone on its own map.  Those alone are
independent, and say how much chance there is in it; their distance from those together, which is
counted as an error, says how much the number of cycles does.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import Ensemble
from presswear.linkage.elements import ClearanceJoint
from presswear.physics.wear import worn_volume
from presswear.recording.statistics import STARTUP_CYCLES, after_startup, half_width
from presswear.results.stage import SIDES, WearStep

Array = NDArray[np.float64]

FIRST_PASS = 8
"""Cycles of each start in the first pass of a wear."""


@dataclass(frozen=True)
class Growth:
    """One wear as far as it is known.

    Attributes
    ----------
    worn : ndarray, shape (runs, joints, 2, m)
        Depth of the surfaces of each run after it, m.
    added : ndarray, shape (runs, joints, 2, m)
        Depth that it added, m; see ``Ensemble`` for the order of runs.
    steps : tuple of WearStep
        How it was applied, as the mean of the starts.
    coarser : ndarray or None
        The added depth by a pass in half as many steps; None where there was none.
    """

    worn: Array
    added: Array
    steps: tuple[WearStep, ...]
    coarser: Array | None = None


def share_of(
    represented: float, cycles: int, extra: Array | float = 0.0
) -> Callable[[int, Array], Array]:
    """The ``wear`` of a plan: each cycle takes its share of the represented cycles.

    Parameters
    ----------
    represented : float
        Cycles that the wear stands for.
    cycles : int
        Cycles in which it is applied, behind those at the start that are no samples.
    extra : ndarray, shape (joints, 2, m), or 0
        Depth that each of them takes off besides, m.  Where it would give more back than a cycle
        takes, nothing is taken, and elsewhere so much less that the volume stays.
    """
    return partial(_lost, represented / cycles, extra)


def _lost(share: float, extra: Array | float, done: int, added: Array) -> Array:
    if done <= STARTUP_CYCLES:
        return np.zeros_like(added)
    if np.ndim(extra) == 0:
        return added * share + extra
    asked = added * share + extra
    lost = np.maximum(asked, 0.0)
    whole = lost.sum(axis=-1, keepdims=True)
    kept = np.maximum(asked.sum(axis=-1, keepdims=True), 0.0)
    return lost * np.divide(kept, whole, out=np.ones_like(whole), where=whole > 0.0)


def jump(ran: Ensemble, represented: float) -> Growth:
    """A wear in one jump, of all starts together and of each alone.

    Parameters
    ----------
    ran : Ensemble
    represented : float
        Cycles that the wear stands for.
    """
    together, alone = ran.together, ran.alone
    mean = np.broadcast_to(together.depth(), together.worn.shape)
    sets = [(together.worn, mean), (alone.worn, alone.depths())]
    if ran.replicates == 1:
        sets = sets[:1]
    before, depths = (np.concatenate(own) for own in zip(*sets, strict=True))
    added = represented * depths
    worn = before + added
    recorders, joints = together.recorders, ran.linkage.clearances
    cycles = sum(own.maps.samples for own in recorders)
    forces = [
        max(float(after_startup(own.each_cycle("force_max", k)).max()) for own in recorders)
        for k in range(len(joints))
    ]
    step = WearStep(
        cycles_per_update=represented,
        cycles=cycles,
        factor=represented * len(recorders) / cycles,
        clearance_change=largest_change(joints, added[0]),
        max_depth=by_side(joints, worn[0].max(axis=2)),
        peak_force={joint.name: force for joint, force in zip(joints, forces, strict=True)},
        wall_s=ran.wall,
    )
    return Growth(worn, added, (step,))


def cycle_by_cycle(ran: Ensemble, represented: float, coarser: Growth | None) -> Growth:
    """A wear as a pass over it has left the surfaces.

    Parameters
    ----------
    ran : Ensemble
        The pass.
    represented : float
        Cycles that the wear stands for.
    coarser : Growth or None
        The pass in half as many cycles.
    """
    joints, recorders = ran.linkage.clearances, ran.recorders
    worn = np.array([recorder.worn for recorder in recorders])
    growth = np.array([recorder.growth for recorder in recorders])[:, STARTUP_CYCLES:]
    clearance = np.array([joint.clearance for joint in joints])[:, np.newaxis]
    change = (growth[:, :, 0] / clearance).max(axis=(0, 2, 3))
    deepest = growth[:, :, 1].mean(axis=0)
    forces = np.max(
        [[own.each_cycle("force_max", k) for k in range(len(joints))] for own in recorders], axis=0
    )[:, STARTUP_CYCLES:]
    cycles = growth.shape[1]
    steps = tuple(
        WearStep(
            cycles_per_update=represented / cycles,
            cycles=len(recorders),
            factor=represented / cycles,
            clearance_change=float(change[n]),
            max_depth=by_side(joints, deepest[n]),
            peak_force={joint.name: float(forces[k, n]) for k, joint in enumerate(joints)},
            wall_s=ran.wall / cycles,
        )
        for n in range(cycles)
    )
    return Growth(worn, worn - ran.worn, steps, None if coarser is None else coarser.added)


def by_side(joints: Sequence[ClearanceJoint], depths: Array) -> dict[str, dict[str, float]]:
    """Depths of shape (joints, 2) by joint and side."""
    return {
        joint.name: dict(zip(SIDES, map(float, own), strict=True))
        for joint, own in zip(joints, depths, strict=True)
    }


def largest_change(joints: Sequence[ClearanceJoint], depth: Array) -> float:
    """Largest of some depths, m, shape (joints, 2, m), each as a part of its joint's clearance."""
    return max(
        (float(own.max()) / joint.clearance for joint, own in zip(joints, depth, strict=True)),
        default=0.0,
    )


def measures(joint: ClearanceJoint, depth: Array) -> Array:
    """What a wear is judged by: its volume, m^3, and the deepest of bearing and pin, m.

    Parameters
    ----------
    depth : ndarray, shape (2, m)
        Depth that it added, m; see ``map_shape``.
    """
    depth = depth[:, : joint.bins]
    return np.array([worn_volume(joint, depth), depth[0].max(), depth[1].max()])


def error_of(joints: Sequence[ClearanceJoint], growth: Growth) -> float:
    """How well a wear is known: the worst of its ``measures``, part of itself.

    The half width over the starts and the difference from the coarser pass, as the root of
    the sum of squares; infinite without a coarser pass.
    """
    if growth.coarser is None:
        return math.inf
    errors = [0.0]
    for k, joint in enumerate(joints):
        fine = np.array([measures(joint, own[k]) for own in growth.added])
        coarse = np.array([measures(joint, own[k]) for own in growth.coarser])
        for one, other in zip(fine.T, coarse.T, strict=True):
            mean = float(one.mean())
            if mean > 0.0:
                step = mean - float(other.mean())
                errors.append(math.hypot(half_width(one) or 0.0, step) / mean)
    return max(errors)
