"""Motions on which a linkage comes to rest, from starts spread over the phase space.

Irregular motion may be a transient: it is left at a constant rate for a motion that
repeats (Lai and Tél, Transient Chaos, Springer 2011). Shares of starts for each final
motion are those of basin stability (Menck, Heitzig, Marwan and Kurths, Nature Physics 9
(2013) 89).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from presswear.analysis.bifurcation import Parameter
from presswear.analysis.kicks import Kick
from presswear.recording.settling import (
    REPEATED,
    SettledMotion,
    group_motions,
    half_life,
    least_half_life,
)
from presswear.recording.statistics import LEVEL, STARTUP_CYCLES, Estimate
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

# Values of the column ``settled`` of ``Runs`` instead of the cycles before a run settled
FAILED = -2
IRREGULAR = -1
Runs = np.recarray[Any, Any]  # rows of ``settle.run_start``, with attributes


@dataclass(frozen=True)
class Watch:
    """Number of starts, and largest number of cycles of the run from each start."""

    starts: int = 64
    cycles: int = 300

    def __post_init__(self) -> None:
        least = STARTUP_CYCLES + REPEATED
        if self.starts < 1:
            raise InputError(f"starts = {self.starts}: must be at least 1")
        if self.cycles < least:
            raise InputError(
                f"cycles = {self.cycles}: must be at least {least}, because a settled motion has "
                f"to repeat for {REPEATED} cycles"
            )


@dataclass(frozen=True)
class FinalMotion:
    """Motion to which some of the starts led.

    Forces and contacts are means over the last cycles of the runs.
    """

    starts: int
    share: Estimate  # share of the starts whose run did not fail
    period: int | None  # cycles; None: irregular until the last cycle
    peak_force: Mapping[str, float]  # peak of a cycle by joint, N
    contacts: Mapping[str, float]  # number of contacts that end in a cycle, by joint
    runs: tuple[int, ...]  # indices of the runs from these starts
    # smallest kick of each pin that leads to rattling; None: not determined
    kicks: tuple[Kick, ...] | None = None

    @property
    def least_kick(self) -> Kick | None:
        """Smallest kick of any pin that leads to rattling.

        None if the motion returns after every kick.
        """
        rattling = [kick for kick in self.kicks or () if kick.rattles is not None]
        return min(rattling, key=lambda kick: kick.rattles or 0.0, default=None)


@dataclass(frozen=True)
class FinalMotionsAt:
    """Final motions at one value of the parameter."""

    value: float | None  # value of the parameter, SI; None: there is no parameter
    joints: tuple[str, ...]  # with clearance
    runs: Runs  # finished runs, in the order of the starts
    # the motion of most starts is first, the irregular motion is last
    motions: tuple[FinalMotion, ...]
    # half-life of the irregular motion, cycles; None: no run or every run settled at once
    half_life: Estimate | None
    # lower 95 % limit of the half-life if no start has settled, cycles
    least_half_life: float | None

    @property
    def counted(self) -> int:
        """Number of starts whose run did not fail."""
        return int((self.runs.settled != FAILED).sum())

    @property
    def failed(self) -> int:
        """Number of starts whose run failed."""
        return len(self.runs) - self.counted

    @property
    def irregular(self) -> int:
        """Number of starts that had not settled at the end."""
        return int((self.runs.settled == IRREGULAR).sum())

    @property
    def irregular_force(self) -> dict[str, float]:
        """Mean peak force of the cycles before the runs settled, by joint, N; NaN without any."""
        cycles = self.runs.irregular_cycles.astype(float)
        total = float(cycles.sum())
        if total > 0.0:
            has_cycles = cycles[:, np.newaxis] > 0.0
            force = np.where(has_cycles, self.runs.irregular_force, 0.0)
            mean = cycles @ force / total
        else:
            mean = np.full(len(self.joints), math.nan)
        return dict(zip(self.joints, mean.tolist(), strict=True))

    def unsettled(self) -> tuple[Array, Array]:
        """Return numbers of cycles, and the share of starts that have not settled after each."""
        settled = np.where(self.runs.settled >= 0, self.runs.settled, math.inf)
        settled = settled[self.runs.settled != FAILED]
        cycles = np.arange(int(self.runs.cycles.max(initial=0)) + 1)
        share = (settled > cycles[:, np.newaxis]).mean(axis=1)
        return cycles.astype(float), share


@dataclass(frozen=True)
class FinalMotions:
    """Final motions of a scene at the values of a parameter that have been computed so far.

    Without a parameter there is one entry.
    """

    scene: Scene
    watch: Watch
    parameter: Parameter | None
    values: tuple[FinalMotionsAt, ...]


def proportion(count: int, total: int) -> Estimate:
    """Return a share with its interval (Clopper and Pearson, Biometrika 26 (1934) 404)."""
    from scipy.stats import binomtest  # slow to import

    interval = binomtest(count, total).proportion_ci(LEVEL)
    return Estimate(count / total, float(interval.low), float(interval.high), total)


def evaluate(
    runs: Runs,
    joints: tuple[str, ...],
    kicks: Mapping[int, Sequence[Kick]],
    value: float | None,
) -> FinalMotionsAt:
    """Return the final motions of finished runs.

    ``kicks`` are those of each motion, by the index of its first start.
    """
    counted = int((runs.settled != FAILED).sum())
    settled = np.flatnonzero(runs.settled >= 0)
    settled_motions = [
        SettledMotion(int(runs.settled[k]), int(runs.period[k]), runs.signature[k])
        for k in settled
    ]
    motions = []
    for group in group_motions(settled_motions):
        rows = tuple(int(settled[k]) for k in group)
        period = int(np.median(runs.period[list(rows)]))
        motion = _motion(runs, joints, rows, counted, period)
        first = int(runs.index[rows[0]])
        if first in kicks:
            motion = replace(motion, kicks=tuple(kicks[first]))
        motions.append(motion)
    irregular = tuple(int(k) for k in np.flatnonzero(runs.settled == IRREGULAR))
    if irregular:
        motions.append(_motion(runs, joints, irregular, counted, period=None))
    cycles_of_irregular = runs.cycles[list(irregular)].tolist()
    estimate = half_life(
        [motion.start for motion in settled_motions], cycles_of_irregular
    )
    limit = None
    if irregular and not settled_motions:
        limit = least_half_life([], cycles_of_irregular)
    return FinalMotionsAt(value, joints, runs, tuple(motions), estimate, limit)


def _motion(
    runs: Runs,
    joints: tuple[str, ...],
    rows: tuple[int, ...],
    counted: int,
    period: int | None,
) -> FinalMotion:
    """Return the final motion of some rows of the runs, with its share of ``counted`` runs."""
    force = runs.peak_force[list(rows)].mean(axis=0)
    contacts = runs.contacts[list(rows)].mean(axis=0)
    return FinalMotion(
        starts=len(rows),
        share=proportion(len(rows), counted),
        period=period,
        peak_force=dict(zip(joints, force.tolist(), strict=True)),
        contacts=dict(zip(joints, contacts.tolist(), strict=True)),
        runs=rows,
    )
