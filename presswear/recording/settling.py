"""Settled motions: whether the last cycles of a run repeat, and from which cycle on.

A rattling motion may be a transient: it is irregular for a time that cannot be
predicted, and then settles on a motion that repeats (Lai and Tél, Transient Chaos,
Springer 2011). A run has settled if its last cycles repeat. Cycles are compared by
their signatures: the position of each pin at the end of the cycle, relative to the
clearance, and the logarithm of each peak force. Between two cycles of a chaotic motion
a signature changes by about 1.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.recording.columns import cycle_column
from presswear.recording.statistics import LEVEL, STARTUP_CYCLES, Estimate
from presswear.tools.arrays import Array

Verdict = Literal["settled", "coexisting", "irregular", "mixed", "unwatched"]

PERIODS = (1, 2, 3, 4)  # cycles after which a settled motion may repeat
# Least number of cycles for which a settled motion has repeated. Laminar phases of a
# chaotic motion are shorter.
REPEATED = 10
CHANGE = 0.2  # largest change of a signature between cycles that repeat
# Smallest peak force whose logarithm is compared, over the largest peak force
LEAST_FORCE = 1e-3


@dataclass(frozen=True)
class SettledMotion:
    """Repeating motion on which a run has settled."""

    start: int  # number of cycles before it
    period: int  # cycles after which it repeats
    signature: Array  # mean over its cycles


@dataclass(frozen=True)
class Motion:
    """Motion of some of the replicates, with means over their cycles."""

    replicates: int
    period: int | None  # cycles after which it repeats; None: irregular
    peak_force: Mapping[str, Estimate]  # peak force of a cycle, by joint, N
    contacts: Mapping[str, Estimate]  # number of contacts in a cycle, by joint
    acceleration_max: Estimate  # largest acceleration of the output in a cycle, m/s^2


@dataclass(frozen=True)
class Settling:
    """Motions on which the replicates of a stage have settled."""

    watched: int  # cycles of the shortest run
    # number of cycles of each replicate before it settled; None: irregular
    starts: tuple[int | None, ...]
    # the motion of most replicates is first, the irregular motion is last
    motions: tuple[Motion, ...]
    # half-life of the irregular motion, cycles; None: no replicate has settled from it
    half_life: Estimate | None = None
    # lower 95 % limit of the half-life, cycles
    least_half_life: float = 0.0

    @property
    def runs(self) -> int:
        """Number of replicates: those on the mean surfaces and those on separate surfaces."""
        return len(self.starts)

    @property
    def settled(self) -> int:
        """Number of replicates that have settled."""
        return sum(start is not None for start in self.starts)

    @property
    def verdict(self) -> Verdict:
        """Name of the result: one settled motion, several, none, or a mixture."""
        if self.settled == 0:
            return "unwatched" if self.watched < REPEATED else "irregular"
        if self.settled < self.runs:
            return "mixed"
        regular = sum(motion.period is not None for motion in self.motions)
        return "settled" if regular == 1 else "coexisting"

    def skipped(self, replicate: int) -> int:
        """Return the number of cycles of a replicate that are left out before the start-up.

        If all replicates have settled, statistics are those of the settled motions. A
        start-up follows these cycles, because the first settled cycle contains the end
        of the irregular motion.
        """
        if self.settled < self.runs:
            return 0
        return self.starts[replicate] or 0

    @property
    def is_mixture(self) -> bool:
        """True if the replicates have different motions, so that a common mean is not useful."""
        return self.verdict in ("mixed", "coexisting")


def signatures(positions: Array, forces: Array) -> Array:
    """Return the signatures of cycles, shape (cycles, 3 joints).

    Parameters
    ----------
    positions : ndarray, shape (cycles, joints, 2)
        Position of each pin at the end of a cycle, relative to its bearing, over the
        clearance.
    forces : ndarray, shape (cycles, joints)
        Largest normal force in a cycle, N.
    """
    least = LEAST_FORCE * forces.max(initial=0.0)
    if least == 0.0:
        least = 1.0  # without any force all logarithms are 0
    logarithms = np.log(np.maximum(forces, least))
    return np.column_stack([positions.reshape(len(positions), -1), logarithms])


def signatures_of(joints: Sequence[ClearanceJoint], rows: Array) -> Array:
    """Return the signatures of cycles from their rows, shape (cycles, 3 joints)."""
    clearances = np.array([joint.clearance for joint in joints])[:, np.newaxis]
    places = []  # columns of the eccentricities, (joints, 2)
    forces = []
    for k in range(len(joints)):
        places.append([cycle_column(f"eccentricity_{axis}", k) for axis in "xy"])
        forces.append(cycle_column("force_max", k))
    return signatures(rows[:, places] / clearances, rows[:, forces])


def settled_motion(cycles: Array) -> SettledMotion | None:
    """Return the motion on which a run has settled, from the signatures of its cycles, (n, k).

    None if the run has not settled. If the last cycles repeat with several periods, the
    period with the earliest start is used.
    """
    best: SettledMotion | None = None
    for period in PERIODS:
        change = np.abs(cycles[period:] - cycles[:-period]).max(axis=1, initial=0.0)
        changing = np.flatnonzero(change > CHANGE)
        start = int(changing[-1]) + 1 if changing.size else 0
        if len(cycles) - start < max(REPEATED, 3 * period):
            continue
        if best is None or start < best.start:
            best = SettledMotion(start, period, cycles[start:].mean(axis=0))
    return best


def group_motions(motions: Sequence[SettledMotion]) -> list[list[int]]:
    """Return the indices of equal motions by group, the largest group first."""
    groups: list[list[int]] = []
    for k, motion in enumerate(motions):
        for group in groups:
            change = np.abs(motion.signature - motions[group[0]].signature)
            if change.max(initial=0.0) <= CHANGE:
                group.append(k)
                break
        else:
            groups.append([k])
    return sorted(groups, key=len, reverse=True)


def half_life(starts: Sequence[int], irregular: Sequence[int]) -> Estimate | None:
    """Return the half-life of the irregular motion, cycles; None if no run has settled from it.

    Runs leave the irregular motion at a constant rate, so that its duration has an
    exponential distribution. Runs that have not settled are censored. The rate is the
    number of runs that have settled over the irregular cycles of all runs. The limits
    of its interval are quantiles of chi-square (Lawless, Statistical Models and Methods
    for Lifetime Data, 2nd ed., section 4.1).

    Parameters
    ----------
    starts : sequence of int
        Cycles before each run settled.
    irregular : sequence of int
        Cycles of each run that did not settle.
    """
    count, time = _irregular_time(starts, irregular)
    if count == 0:
        return None
    from scipy.special import chdtri  # slow to import

    upper_tail = 0.5 - 0.5 * LEVEL
    largest = float(chdtri(2 * count + 2, upper_tail))
    smallest = float(chdtri(2 * count, 1.0 - upper_tail))
    scaled = math.log(2.0) * time
    return Estimate(
        scaled / count, 2.0 * scaled / largest, 2.0 * scaled / smallest, count
    )


def least_half_life(starts: Sequence[int], irregular: Sequence[int]) -> float:
    """Return the lower 95 % confidence limit of the half-life, cycles; see ``half_life``."""
    from scipy.special import chdtri  # slow to import

    count, time = _irregular_time(starts, irregular)
    return 2.0 * math.log(2.0) * time / float(chdtri(2 * count + 2, 1.0 - LEVEL))


def _irregular_time(
    starts: Sequence[int], irregular: Sequence[int]
) -> tuple[int, float]:
    """Return the number of runs that settled from irregular motion, and all irregular cycles.

    Irregular cycles are counted from the end of the start-up. A run that settles during
    the start-up does not count. The last ``REPEATED`` cycles of a run that has not
    settled do not count, because they may already be regular.
    """
    settled = [start - STARTUP_CYCLES for start in starts if start > STARTUP_CYCLES]
    left_out = STARTUP_CYCLES + REPEATED
    unsettled = [max(cycles - left_out, 0) for cycles in irregular]
    return len(settled), float(sum(settled) + sum(unsettled))
