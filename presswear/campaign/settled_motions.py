"""Settled motions of an ensemble: which replicates came to rest, and what each kind of motion is.

See ``presswear.recording.settling`` for the measure and its source.
"""

from collections.abc import Sequence

import numpy as np

from presswear.linkage.elements import ClearanceJoint
from presswear.recording.columns import cycle_column
from presswear.recording.settling import (
    Motion,
    Rest,
    Settling,
    half_life,
    least_half_life,
    rest_of,
    same_motions,
    signatures,
)
from presswear.recording.statistics import STARTUP_CYCLES, Estimate, pooled
from presswear.tools.arrays import Array

Joints = Sequence[ClearanceJoint]


def rests_of(joints: Joints, runs: Sequence[Array]) -> list[Rest | None]:
    """Return the motion on which each run came to rest, from its rows of cycles."""
    clearances = np.array([joint.clearance for joint in joints])[:, np.newaxis]
    indices = range(len(joints))
    places = [
        [cycle_column(f"eccentricity_{axis}", k) for axis in "xy"] for k in indices
    ]
    forces = [cycle_column("force_max", k) for k in indices]
    return [
        rest_of(signatures(rows[:, places] / clearances, rows[:, forces]))
        for rows in runs
    ]


def settling_of(joints: Joints, runs: Sequence[Array]) -> Settling | None:
    """Return what runs came to, from their rows of cycles; None without clearance or cycles."""
    if not joints or not all(map(len, runs)):
        return None
    rests = rests_of(joints, runs)
    starts = tuple(None if rest is None else rest.start for rest in rests)
    settled = [k for k, rest in enumerate(rests) if rest is not None]
    groups = same_motions([rest for rest in rests if rest is not None])
    motions = []
    for group in groups:
        members = [settled[n] for n in group]
        period = max(rest.period for k in members if (rest := rests[k]))
        rows = [runs[k][starts[k] :] for k in members]
        motions.append(_motion(joints, rows, len(members), period))
    irregular = [run[:start] for run, start in zip(runs, starts, strict=True)]
    irregular = [rows for rows in irregular if len(rows) > STARTUP_CYCLES]
    if irregular:
        motions.append(_motion(joints, irregular, len(runs) - len(settled), None))
    times = (
        [rest.start for rest in rests if rest is not None],
        [len(run) for run, rest in zip(runs, rests, strict=True) if rest is None],
    )
    return Settling(
        watched=min(map(len, runs)),
        starts=starts,
        motions=tuple(motions),
        half_life=half_life(*times),
        least_half_life=least_half_life(*times),
    )


def _motion(
    joints: Joints, runs: Sequence[Array], replicates: int, period: int | None
) -> Motion:
    """Return the motion of some rows of cycles, with two rows of start-up before each."""

    def mean(name: str, joint: int | None = None) -> Estimate:
        return pooled([rows[:, cycle_column(name, joint)] for rows in runs])[0].positive

    def by_joint(name: str) -> dict[str, Estimate]:
        return {joint.name: mean(name, k) for k, joint in enumerate(joints)}

    return Motion(
        replicates=replicates,
        period=period,
        peak_force=by_joint("force_max"),
        contacts=by_joint("contacts"),
        acceleration_max=mean("acceleration_max"),
    )
