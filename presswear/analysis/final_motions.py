"""Motions on which a linkage comes to rest, from starts spread over the phase space.

Irregular motion may be a transient: it is left at a constant rate for a motion that
repeats (Lai and Tél, Transient Chaos, Springer 2011). Shares of starts for each final
motion are those of basin stability (Menck, Heitzig, Marwan and Kurths, Nature Physics 9
(2013) 89).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswear.analysis.bifurcation import Parameter
from presswear.analysis.kicks import Kick
from presswear.recording.settling import (
    REPEATED,
    Rest,
    half_life,
    least_half_life,
    same_motions,
)
from presswear.recording.statistics import LEVEL, STARTUP_CYCLES, Estimate
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

FAILED, IRREGULAR = -2, -1  # in place of the cycles before a run settled
Runs = np.recarray[Any, Any]  # rows of ``settle.run_start``, with attributes


@dataclass(frozen=True)
class Watch:
    """Number of starts, and of cycles for which each is watched."""

    starts: int = 64
    cycles: int = 300  # at most

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
    """Motion to which some of the starts led; forces and contacts are means of its last cycles."""

    starts: int
    share: Estimate  # of the starts whose run did not fail
    period: int | None  # cycles; None: irregular until the last cycle
    peak_force: Mapping[str, float]  # of a cycle, by joint, N
    contacts: Mapping[str, float]  # that end in a cycle, by joint
    runs: tuple[int, ...]  # indices of their rows
    kicks: tuple[Kick, ...] | None = None  # least of each pin; None: not determined

    @property
    def least_kick(self) -> Kick | None:
        """Least kick after which it rattles, over all joints; None: it returns after all."""
        limits = [kick for kick in self.kicks or () if kick.rattles is not None]
        return min(limits, key=lambda kick: kick.rattles or 0.0, default=None)


@dataclass(frozen=True)
class FinalMotionsAt:
    """Final motions at one value of the parameter."""

    value: float | None  # of the parameter, SI; None: there is no parameter
    joints: tuple[str, ...]  # with clearance
    runs: Runs  # finished, in the order of the starts
    motions: tuple[FinalMotion, ...]  # of most starts first, the irregular one last
    # of the irregular motion, cycles; None: none or all settled at once
    half_life: Estimate | None
    least_half_life: float | None  # if no start has settled: lower 95 % limit, cycles

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
        weight = self.runs.irregular_cycles.astype(float)
        total = float(weight.sum())
        force = np.where(weight[:, np.newaxis] > 0.0, self.runs.irregular_force, 0.0)
        mean = (
            weight @ force / total
            if total > 0.0
            else np.full(len(self.joints), math.nan)
        )
        return dict(zip(self.joints, mean.tolist(), strict=True))

    def unsettled(self) -> tuple[Array, Array]:
        """Return numbers of cycles, and the share of the starts that settle after more."""
        after = np.where(self.runs.settled >= 0, self.runs.settled, math.inf)
        after = after[self.runs.settled != FAILED]
        cycles = np.arange(int(self.runs.cycles.max(initial=0)) + 1)
        return cycles.astype(float), (after > cycles[:, np.newaxis]).mean(axis=1)


@dataclass(frozen=True)
class FinalMotions:
    """Final motions of a scene, over a parameter if there is one; complete or in part."""

    scene: Scene
    watch: Watch
    parameter: Parameter | None
    values: tuple[FinalMotionsAt, ...]


def proportion(count: int, total: int) -> Estimate:
    """Return a share with its interval by Clopper and Pearson, Biometrika 26 (1934) 404."""
    from scipy.special import betaincinv  # slow to import

    tail = 0.5 - 0.5 * LEVEL
    low = betaincinv(count, total - count + 1, tail) if count > 0 else 0.0
    high = betaincinv(count + 1, total - count, 1.0 - tail) if count < total else 1.0
    return Estimate(count / total, float(low), float(high), total)


def evaluate(
    runs: Runs,
    joints: tuple[str, ...],
    kicks: Mapping[int, Sequence[Kick]],
    value: float | None,
) -> FinalMotionsAt:
    """Return the final motions of finished runs; ``kicks`` are by the first start of a motion."""
    counted = int((runs.settled != FAILED).sum())
    at_rest = np.flatnonzero(runs.settled >= 0)
    rests = [
        Rest(int(runs.settled[k]), int(runs.period[k]), runs.signature[k])
        for k in at_rest
    ]
    groups = [tuple(int(at_rest[k]) for k in group) for group in same_motions(rests)]
    irregular = tuple(int(k) for k in np.flatnonzero(runs.settled == IRREGULAR))
    motions = []
    for rows in [*groups, *([irregular] if irregular else [])]:
        chosen = list(rows)
        force = runs.peak_force[chosen].mean(axis=0)
        contacts = runs.contacts[chosen].mean(axis=0)
        tried = kicks.get(int(runs.index[rows[0]])) if rows is not irregular else None
        motion = FinalMotion(
            len(rows),
            proportion(len(rows), counted),
            None if rows is irregular else int(np.median(runs.period[chosen])),
            dict(zip(joints, force.tolist(), strict=True)),
            dict(zip(joints, contacts.tolist(), strict=True)),
            rows,
            None if tried is None else tuple(tried),
        )
        motions.append(motion)
    lasting = runs.cycles[list(irregular)].tolist()
    estimate = half_life([rest.start for rest in rests], lasting)
    bound = least_half_life([], lasting) if irregular and not rests else None
    return FinalMotionsAt(value, joints, runs, tuple(motions), estimate, bound)
