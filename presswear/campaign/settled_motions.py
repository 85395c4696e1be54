"""Settled motions of an ensemble: the replicates that settled, and the motions they settled on.

See ``presswear.recording.settling`` for the measure and its source.
"""

from collections.abc import Sequence

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.recording.columns import cycle_column
from presswear.recording.settling import (
    Motion,
    SettledMotion,
    Settling,
    group_motions,
    half_life,
    least_half_life,
    settled_motion,
    signatures_of,
)
from presswear.recording.statistics import STARTUP_CYCLES, Estimate, pooled
from presswear.tools.arrays import Array

Joints = Sequence[ClearanceJoint]


def settling_of(joints: Joints, runs: Sequence[Array]) -> Settling | None:
    """Return the settled and the irregular motions of runs, from their rows of cycles.

    None without joints or without cycles.
    """
    if not joints or not all(map(len, runs)):
        return None
    settled: list[SettledMotion] = []
    # cycles of each settled run, from the start of its settled motion
    settled_rows = []
    irregular_rows = []  # cycles of each run before it settled
    lengths = []  # numbers of cycles of the runs that have not settled
    starts: list[int | None] = []
    for rows in runs:
        motion = settled_motion(signatures_of(joints, rows))
        if motion is None:
            starts.append(None)
            lengths.append(len(rows))
            irregular_rows.append(rows)
        else:
            starts.append(motion.start)
            settled.append(motion)
            settled_rows.append(rows[motion.start :])
            irregular_rows.append(rows[: motion.start])
    motions = []
    for group in group_motions(settled):
        period = max(settled[k].period for k in group)
        rows_of_group = [settled_rows[k] for k in group]
        motions.append(_motion(joints, rows_of_group, len(group), period))
    irregular_rows = [rows for rows in irregular_rows if len(rows) > STARTUP_CYCLES]
    if irregular_rows:
        motions.append(_motion(joints, irregular_rows, len(lengths), None))
    times = [motion.start for motion in settled]
    return Settling(
        watched=min(map(len, runs)),
        starts=tuple(starts),
        motions=tuple(motions),
        half_life=half_life(times, lengths),
        least_half_life=least_half_life(times, lengths),
    )


def _motion(
    joints: Joints, runs: Sequence[Array], replicates: int, period: int | None
) -> Motion:
    """Return the motion of some rows of cycles, with two rows of start-up before each."""

    def mean(name: str, joint: int | None = None) -> Estimate:
        column = cycle_column(name, joint)
        estimate, *_ = pooled([rows[:, column] for rows in runs])
        return estimate.positive

    def by_joint(name: str) -> dict[str, Estimate]:
        return {joint.name: mean(name, k) for k, joint in enumerate(joints)}

    return Motion(
        replicates=replicates,
        period=period,
        peak_force=by_joint("force_max"),
        contacts=by_joint("contacts"),
        acceleration_max=mean("acceleration_max"),
    )
