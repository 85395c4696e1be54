"""Settled motions: do the last cycles of a run repeat, and since when?

A rattling motion may be a transient: it is irregular for a time that nobody can
foretell, then comes to rest on a motion that repeats, and stays there (Lai and Tél,
Transient Chaos, Springer 2011).  A run has settled if its last cycles repeat.  They are
compared by their signature: where each pin is at the end of the cycle, over the
clearance, and the logarithm of each peak force. Between two cycles of a chaotic motion
a signature changes by about 1.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from presswear.recording.statistics import LEVEL, STARTUP_CYCLES, Estimate
from presswear.tools.arrays import Array

Verdict = Literal["settled", "coexisting", "irregular", "mixed", "unwatched"]

PERIODS = (1, 2, 3, 4)  # cycles after which a settled motion may repeat
# cycles that a settled motion has repeated for: laminar phases of chaos are shorter
REPEATED = 10
CHANGE = 0.2  # largest change of a signature between cycles that repeat
LEAST_FORCE = 1e-3  # of the largest peak force: smaller ones do not count


@dataclass(frozen=True)
class Rest:
    """Repeating motion on which a run came to rest."""

    start: int  # cycles before it
    period: int  # cycles after which it repeats
    signature: Array  # mean over its cycles


@dataclass(frozen=True)
class Motion:
    """Motion of some of the replicates; means of their cycles."""

    replicates: int
    period: int | None  # cycles after which it repeats; None: irregular
    peak_force: Mapping[str, Estimate]  # of a cycle, by joint, N
    contacts: Mapping[str, Estimate]  # of a cycle, by joint
    acceleration_max: Estimate  # of a cycle, m/s^2


@dataclass(frozen=True)
class Settling:
    """Kinds of motion that the replicates of a stage came to."""

    watched: int  # cycles of the shortest run
    # cycles of each replicate before it settled; None: irregular
    starts: tuple[int | None, ...]
    # the one of most replicates first, the irregular one last
    motions: tuple[Motion, ...]
    # of the irregular motion, cycles; None: none settled
    half_life: Estimate | None = None
    # of the irregular motion with 95 % probability, cycles
    least_half_life: float = 0.0

    @property
    def runs(self) -> int:
        """Number of replicates, on the mean surfaces and on surfaces of their own."""
        return len(self.starts)

    @property
    def settled(self) -> int:
        """Number of replicates that have settled."""
        return sum(start is not None for start in self.starts)

    @property
    def verdict(self) -> Verdict:
        """Word for the kinds of motion: one, several, or none that repeats."""
        if self.settled == 0:
            return "unwatched" if self.watched < REPEATED else "irregular"
        if self.settled < self.runs:
            return "mixed"
        regular = sum(motion.period is not None for motion in self.motions)
        return "settled" if regular == 1 else "coexisting"

    def skipped(self, replicate: int) -> int:
        """Return the number of cycles of a replicate that come before its start-up.

        Where all replicates have settled, the numbers are those of the motion that goes
        on, after a start-up: in its first cycle the rattle ends.
        """
        if self.settled < self.runs:
            return 0
        return self.starts[replicate] or 0

    @property
    def is_mixture(self) -> bool:
        """True if the replicates show different motions, so that one mean describes none."""
        return self.verdict in ("mixed", "coexisting")


def signatures(places: Array, forces: Array) -> Array:
    """Return what cycles are compared by, shape (cycles, 3 joints).

    Parameters
    ----------
    places : ndarray, shape (cycles, joints, 2)
        Place of each pin at the end of a cycle, relative to its bearing, over the
        clearance.
    forces : ndarray, shape (cycles, joints)
        Largest normal force in a cycle, N.
    """
    least = LEAST_FORCE * forces.max(initial=0.0)
    logarithms = np.log(np.maximum(forces, least if least > 0.0 else 1.0))
    return np.column_stack([places.reshape(len(places), -1), logarithms])


def rest_of(cycles: Array) -> Rest | None:
    """Return the motion on which a run came to rest, from the signatures of its cycles, or None.

    Of the periods by which the last cycles repeat, it is the one that goes back
    furthest.
    """
    best: Rest | None = None
    for period in PERIODS:
        change = np.abs(cycles[period:] - cycles[:-period]).max(axis=1, initial=0.0)
        others = np.flatnonzero(change > CHANGE)
        start = int(others[-1]) + 1 if others.size else 0
        if len(cycles) - start < max(REPEATED, 3 * period):
            continue
        if best is None or start < best.start:
            best = Rest(start, period, cycles[start:].mean(axis=0))
    return best


def same_motions(rests: Sequence[Rest]) -> list[list[int]]:
    """Return the indices of rests on the same motion, the largest group first."""
    groups: list[list[int]] = []
    for k, rest in enumerate(rests):
        for group in groups:
            if (
                np.abs(rest.signature - rests[group[0]].signature).max(initial=0.0)
                <= CHANGE
            ):
                group.append(k)
                break
        else:
            groups.append([k])
    return sorted(groups, key=len, reverse=True)


def half_life(starts: Sequence[int], irregular: Sequence[int]) -> Estimate | None:
    """Return the half-life of the irregular motion, cycles; None if no run has settled from it.

    The irregular motion is left at a constant rate, so that its duration is
    exponential.  Runs that had not settled when they ended are censored.  The rate is
    the number of runs that settled over the time of all; the ends of its interval are
    quantiles of chi-square (Lawless, Statistical Models and Methods for Lifetime Data,
    2nd ed., section 4.1).

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
    most = float(chdtri(2 * count + 2, upper_tail))
    least = float(chdtri(2 * count, 1.0 - upper_tail))
    to_half = math.log(2.0) * time
    return Estimate(to_half / count, 2.0 * to_half / most, 2.0 * to_half / least, count)


def least_half_life(starts: Sequence[int], irregular: Sequence[int]) -> float:
    """Return what the half-life exceeds with a confidence of 95 %, cycles; see ``half_life``."""
    from scipy.special import chdtri  # slow to import

    count, time = _irregular_time(starts, irregular)
    return 2.0 * math.log(2.0) * time / float(chdtri(2 * count + 2, 1.0 - LEVEL))


def _irregular_time(
    starts: Sequence[int], irregular: Sequence[int]
) -> tuple[int, float]:
    """Return how many runs settled from irregular motion, and the irregular cycles of all.

    They are counted from the end of the start-up: runs that have settled by then were
    never irregular.  The last cycles of the others, which may be regular already, do
    not count.
    """
    lasted = [start - STARTUP_CYCLES for start in starts if start > STARTUP_CYCLES]
    unseen = STARTUP_CYCLES + REPEATED
    still = [max(cycles - unseen, 0) for cycles in irregular]
    return len(lasted), float(sum(lasted) + sum(still))
