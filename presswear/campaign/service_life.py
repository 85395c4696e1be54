"""Service life: wear run forward until the first of several limits is exceeded.

A *wear history* is a replicate whose surfaces wear from cycle to cycle, each cycle standing for
many strokes.  All histories advance together in *load blocks* of a few cycles.  In a block, a cycle
stands for as many strokes as take a specified part of the clearance off, by the mean rate of the
cycles before it: by its own rate, cycles that wear little would get too much weight.  A
*refinement* is one pass over the whole life.  Refinements with ever finer steps and new replicates
follow each other until the life is known: the half width over the histories and the error of the
step, which refinements in much coarser steps show, added as the root of the sum of squares.

Quantities of the surfaces, *levels*, are known at the end of each block.  Quantities of a stroke,
*samples*, scatter from stroke to stroke: a polynomial over the cycles is fitted to the means of the
blocks, of the order that best predicts one history from the others.  Over cycles, not strokes:
each cycle takes about as much off as the one before, so that running-in bends no curve.  Intervals
are those of the jackknife over whole histories, which share nothing, of the logarithm, since a life
has no sign (Miller, The jackknife - a review, Biometrika 61, 1, 1974).

A *service interval* ends where a bushing is replaced or turned (``maintain``).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import EnsembleState, Runner
from presswear.campaign.replicates import RunSpec, linkage_on, worn_out
from presswear.campaign.wear_update import (
    FIRST_PASS,
    WearUpdate,
    by_side,
    largest_change,
    wear_per_cycle,
)
from presswear.linkage.elements import ClearanceJoint
from presswear.physics.ideal import bottom_of
from presswear.physics.statics import total_clearance
from presswear.physics.wear import worn_volume
from presswear.recording.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.recording.statistics import STARTUP_CYCLES, half_width, quantile
from presswear.results.life import Ended, LifeResult, LimitResult, PassResult, Phase
from presswear.results.stage import WearStep
from presswear.scene.options import Limit, Service
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed

Array = NDArray[np.float64]

FIRST_CHANGE = 5e-3  # of the clearance, that a cycle of the first refinement takes off
MIN_BLOCK = 2  # cycles
BLOCK_GROWTH = 0.5  # cycles in a block over the root of those in the refinement
MIN_BLOCKS_FOR_REFUSAL = 16  # after which a limit that seems exceeded when new is taken to be so
MIN_CYCLES = 16  # of each history up to the life, in a refinement that determines it
MIN_REFINEMENT = 2.5  # ratio of cycles of two refinements that show the error of the step
MAX_STEP_GROWTH, MAX_CYCLE_GROWTH = 2.0, 8.0  # from block to block, from refinement to refinement
SCATTER_FRACTION = 0.7  # of the tolerance, that is meant for the scatter of histories
MAX_ORDER = 3  # of a polynomial through samples
MIN_ORDER = {"bdc_drift": 1}  # with order 0 a drift would be exactly zero
MARGIN = 0.1  # of the cycles up to a crossing; samples reach this far beyond it
MIN_BLOCKS = 4  # before samples can have exceeded a limit
_MAX_CYCLES = 1_000_000  # of a history in one service interval: none comes so far
_MAX_INTERVALS = 64  # service intervals of a refinement, so that no two of them start alike

MAX_PHASES = 3
MIN_RATE_CHANGE = 0.05  # of a wear rate: less is not a new phase
RUNNING_IN, STEADY, ACCELERATED = "running-in", "steady", "accelerated"


@dataclass(frozen=True)
class LifeProblem:
    """Limits and accuracy of a service life.

    Attributes
    ----------
    limits : tuple of Limit
    services : tuple of Service
        In the order of strokes.
    at_most : float
        Strokes.
    tolerance : float
        Relative error of the life.
    max_cycles : int
        Of all histories in a refinement.
    """

    limits: tuple[Limit, ...]
    services: tuple[Service, ...]
    at_most: float
    tolerance: float
    max_cycles: int

    @staticmethod
    def of(scene: Scene) -> "LifeProblem":
        """Return the problem of a scene with a life."""
        life, joints = scene.life, scene.clearance_joints
        assert life is not None
        limits, services = life.limits(joints), life.services(joints)
        return LifeProblem(limits, services, life.at_most, scene.tolerance, life.max_cycles)


@dataclass(frozen=True)
class LoadBlock:
    """Some cycles of every wear history.

    Attributes
    ----------
    strokes : float
        Strokes since new, at its end.
    cycles : int
        Cycles of each history; 0 for maintenance of a bushing.
    interval : int
        Number of the service interval.
    levels : mapping of str to ndarray, shape (histories,)
        Quantities of the surfaces at its end, by key.
    samples : mapping of str to ndarray, shape (histories,)
        Means over its cycles, by key.
    rate : float
        Largest depth that a stroke took off, mean of the histories, relative to the clearance.
    taken : ndarray, shape (joints, 2, bins)
        Depth that a stroke took off, mean of the histories, m.
    depth : ndarray, shape (histories, joints, 2, bins)
        Depth of the surfaces at its end, m.
    ended_by : str
        Why it is the last: a surface is worn deeper than the model allows, or a run failed.
    wall_s : float
        Wall time, s.
    """

    strokes: float
    cycles: int
    interval: int
    levels: Mapping[str, Array]
    samples: Mapping[str, Array]
    rate: float
    removed: Array
    depth: Array = field(default_factory=lambda: np.zeros((0, 0, 2, 0)))
    ended_by: str = ""
    wall_s: float = 0.0


Blocks = Sequence[LoadBlock]


@dataclass(frozen=True)
class BlockPlan:
    """Plan of the next load block.

    Attributes
    ----------
    cycles : int
        Cycles of each history.
    share : float
        Strokes that each stands for.
    extra : ndarray, shape (joints, 2, bins), or 0
        Depth that each takes off besides, m; below zero where wear slows down.
    """

    cycles: int
    share: float
    extra: Array | float = 0.0


@dataclass(frozen=True)
class Refinement:
    """One pass over a life.

    Attributes
    ----------
    change : float
        Part of the clearance that a cycle takes off.
    block : int
        Cycles in a block.
    blocks : tuple of LoadBlock
        Blocks so far; the first stands for as many strokes as it has cycles: the new state.
    """

    change: float = FIRST_CHANGE
    block: int = MIN_BLOCK
    blocks: tuple[LoadBlock, ...] = ()


@dataclass(frozen=True)
class LifeState:
    """State of a service life.

    Attributes
    ----------
    passes : tuple of Refinement
        The last one may be unfinished.
    place : tuple of int
        Refinement and service interval of the present runs.
    running : EnsembleState
        These runs, from the start of the service interval.
    """

    passes: tuple[Refinement, ...] = ()
    place: tuple[int, int] = (0, 0)
    running: EnsembleState = EnsembleState()


@dataclass(frozen=True)
class LifeEstimate:
    """Life as far as it is known.

    Attributes
    ----------
    strokes : float
        Infinite: no limit was exceeded as far as the histories went.
    sampling, step : float
        Half width over the histories, and error of the step, of its logarithm.
    """

    strokes: float
    sampling: float
    step: float

    @property
    def error(self) -> float:
        """Root of the sum of squares of both errors."""
        return math.hypot(self.sampling, self.step)


class Histories(Protocol):
    """Wear histories of a scene, or of a problem with a known solution."""

    def advance(self, number: int, before: Blocks, plan: BlockPlan) -> LoadBlock:
        """Advance by a block in the refinement of a number, after some blocks."""

    def maintain(self, number: int, before: Blocks, service: Service) -> LoadBlock:
        """Replace or turn a bushing and return a block without cycles."""


def run_refinements(
    problem: LifeProblem,
    histories: Histories,
    passes: Sequence[Refinement] = (),
    keep: Callable[[tuple[Refinement, ...]], None] = lambda passes: None,
) -> tuple[Refinement, ...]:
    """Run refinements until the life is known.

    Parameters
    ----------
    passes : sequence of Refinement
        Those that have run; the last one may be unfinished.
    keep : callable
        Called with them after each block.

    Raises
    ------
    InputError
        If a limit is exceeded when new.
    """
    done = list(passes) or [Refinement()]
    while True:
        last = done[-1]
        plan = next_block(problem, last)
        if plan is None:
            further = next_refinement(problem, done)
            if further is None:
                return tuple(done)
            done.append(further)
            continue
        number = len(done)
        if isinstance(plan, Service):
            block = histories.maintain(number, last.blocks, plan)
        else:
            block = histories.advance(number, last.blocks, plan)
        done[-1] = replace(last, blocks=(*last.blocks, block))
        if not last.blocks:
            for limit in problem.limits:
                if _is_exceeded(limit, block):
                    raise InputError(_exceeded_when_new(limit, [block]))
        keep(tuple(done))


def next_block(problem: LifeProblem, refinement: Refinement) -> BlockPlan | Service | None:
    """Return what a refinement runs next; None if it is finished."""
    blocks = refinement.blocks
    if not blocks:
        return BlockPlan(MIN_BLOCK, 1.0)
    last, interval = blocks[-1], blocks[-1].interval
    if last.ended_by or last.strokes >= problem.at_most:
        return None
    if len(blocks) > MIN_BLOCKS_FOR_REFUSAL and first_crossing(blocks, problem.limits) == 0.0:
        return None
    cycles = count_of(blocks) * sum(block.cycles for block in blocks)
    if cycles >= 2 * problem.max_cycles or _is_beyond(blocks, problem.limits):
        return None
    is_last = interval == len(problem.services)
    until = problem.at_most if is_last else problem.services[interval].strokes
    if last.strokes >= until:
        return problem.services[interval]
    if not last.cycles:
        # After maintenance the rate is that of the bushing before it: the new state runs first.
        return BlockPlan(MIN_BLOCK, 1.0)
    finished = [block for block in blocks if block.cycles and block.interval == interval]
    rate = sum(block.rate for block in finished[-2:]) / len(finished[-2:])
    share = refinement.change / rate if rate > 0.0 else math.inf
    if len(finished) > 1:
        share = min(share, MAX_STEP_GROWTH * (last.strokes - blocks[-2].strokes) / last.cycles)
    share = min(share, (until - last.strokes) / refinement.block)
    return BlockPlan(refinement.block, share, _correction(finished, refinement.block))


def _correction(finished: Blocks, cycles: int) -> Array | float:
    """Return the depth by which the last block fell short of the trapezoidal rule, by cycles.

    Each cycle has stood for strokes that come after it, at the rate of its own surfaces: the sum
    lacks half a cycle's change of the rate for each of its cycles.  All histories get the mean:
    the sum over a life is half of the change from new, and no scatter adds up in it.
    """
    if len(finished) < 2:
        return 0.0
    before, last = finished[-2:]
    # The new state was observed where the next block started.
    distance = 0.5 * (last.cycles + (before.cycles if len(finished) > 2 else 0))
    share = (last.strokes - before.strokes) / last.cycles
    whole: Array = 0.5 * share * last.cycles / distance * (last.removed - before.removed)
    return whole / cycles


def next_refinement(problem: LifeProblem, passes: Sequence[Refinement]) -> Refinement | None:
    """Return the next refinement; None if the life is known, or the cycles are used up.

    InputError if a limit is exceeded when new.
    """
    if not passes:
        return Refinement()
    last = passes[-1]
    life = estimate_life(problem, passes)
    if life.strokes == 0.0:
        limits = (limit for limit in problem.limits if not crossing(last.blocks, limit))
        raise InputError(_exceeded_when_new(next(limits), last.blocks))
    is_known = life.error <= problem.tolerance or not math.isfinite(life.strokes)
    if len(passes) > 1 and is_known:
        return None
    finished = cycles_until(last.blocks, min(life.strokes, last.blocks[-1].strokes))
    growth = MAX_STEP_GROWTH
    if math.isfinite(life.sampling):
        needed = (life.sampling / (SCATTER_FRACTION * problem.tolerance)) ** 2
        growth = min(max(needed, growth), MAX_CYCLE_GROWTH)
    wanted = max(growth * finished, MIN_CYCLES)
    if len(passes) > 1 and wanted * count_of(last.blocks) > problem.max_cycles:
        return None
    block = max(round(BLOCK_GROWTH * math.sqrt(wanted)), MIN_BLOCK)
    return Refinement(last.change * max(finished, 1.0) / wanted, block)


def estimate_life(
    problem: LifeProblem, passes: Sequence[Refinement], limits: Sequence[Limit] | None = None
) -> LifeEstimate:
    """Return the life from some refinements; with other limits, the first crossing of those."""
    limits, blocks = problem.limits if limits is None else limits, passes[-1].blocks
    end = first_crossing(blocks, limits)
    return LifeEstimate(end, sampling_error(blocks, limits), _step_error(passes, limits))


def _step_error(passes: Sequence[Refinement], limits: Sequence[Limit]) -> float:
    """Return the relative error of the life by the step of the last refinement, or infinity.

    It goes as one over the cycles, or faster: by each refinement in steps so much coarser, that of
    the last one is their distance over the ratio of the cycles less one.  The largest is taken.
    Scatter is in it as well, and counts the less, the farther the refinements are apart.
    """
    ends = [first_crossing(item.blocks, limits) for item in passes]
    runs = [
        cycles_until(item.blocks, end) if 0.0 < end < math.inf else math.inf
        for item, end in zip(passes, ends, strict=True)
    ]
    return max(
        (
            abs(math.log(ends[-1] / end)) / (runs[-1] / run - 1.0)
            for end, run in zip(ends[:-1], runs[:-1], strict=True)
            if runs[-1] < math.inf and 0.0 < MIN_REFINEMENT * run <= runs[-1]
        ),
        default=math.inf,
    )


def _exceeded_when_new(limit: Limit, blocks: Blocks) -> str:
    value = float(curve(blocks, limit.key)[0])
    return (
        f"until = '{limit.key} > {limit.value:.4g} {limit.unit}': it is exceeded when new, where "
        f"{limit.key} is {value:.4g} {limit.unit}"
    )


def _is_exceeded(limit: Limit, new: LoadBlock) -> bool:
    """Return whether the confidence interval of the unworn value lies above the limit."""
    values = [curve([new], limit.key, np.array([k]))[0] for k in range(count_of([new]))]
    return float(np.mean(values)) - (half_width(np.array(values)) or 0.0) >= limit.value


_LIMITED: dict[str, Callable[[Array, float], Array]] = {
    "bdc_error": lambda fit, new: np.abs(fit),
    "bdc_drift": lambda fit, new: np.abs(fit - new),
    "repeatability": lambda fit, new: np.sqrt(np.maximum(fit, 0.0)),
}  # limited quantity from the fit and its new value: errors have a sign, variances are averaged


def curve(blocks: Blocks, key: str, chosen: NDArray[np.int64] | slice = slice(None)) -> Array:
    """Return a quantity at the ends of blocks, mean of the chosen histories, shape (blocks,)."""
    if key in blocks[0].levels:
        return np.array([block.levels[key][chosen].mean() for block in blocks])
    name = key.rpartition(".")[2]
    fits = np.empty(len(blocks))
    for interval in sorted({block.interval for block in blocks}):
        rows = np.array([k for k, block in enumerate(blocks) if block.interval == interval])
        if any(blocks[k].cycles for k in rows):
            fits[rows] = _fit([blocks[k] for k in rows], key, chosen)
        else:
            fits[rows] = fits[rows[0] - 1]  # no stroke has run since the maintenance
    return _LIMITED[name](fits, float(fits[0])) if name in _LIMITED else fits


def _fit(blocks: Blocks, key: str, chosen: NDArray[np.int64] | slice) -> Array:
    """Return the fit through samples of one service interval, at the ends of its blocks."""
    strokes = np.array([block.strokes for block in blocks])
    # A service interval starts with its new state, not with the end of its first block.
    change = np.cumsum(
        [0.0, *(b.rate * n for b, n in zip(blocks[1:], np.diff(strokes), strict=True))]
    )
    scale = float(change[-1]) or 1.0
    has_cycles = np.array([block.cycles > 0 for block in blocks])
    counts = np.array([block.cycles for block in blocks if block.cycles], dtype=float)
    # A cycle runs on the surfaces before it.
    back = np.append(0.0, np.diff(change))[has_cycles] * 0.5 * (1.0 + 1.0 / counts)
    places = (change[has_cycles] - back) / scale
    rows = np.array([block.samples[key] for block in blocks if block.cycles])
    weights = np.sqrt(counts)
    order = max(_order(places, rows, weights), MIN_ORDER.get(key, 0))
    fit = np.polynomial.Polynomial.fit(
        places,
        rows[:, chosen].mean(axis=1),
        min(order, places.size - 1),
        domain=[0.0, 1.0],
        w=weights,
    )
    return np.asarray(fit(change / scale))


def _order(places: Array, rows: Array, weights: Array) -> int:
    """Return the order of the polynomial through some histories that best predicts another one."""
    count = rows.shape[1]
    errors = []
    for order in range(max(min(MAX_ORDER, places.size // 2 - 1), 0) + 1):
        base = np.vander(places, order + 1) * weights[:, np.newaxis]
        others = (rows.sum(axis=1, keepdims=True) - rows) / max(count - 1, 1)
        fit = base @ np.linalg.lstsq(base, others * weights[:, np.newaxis], rcond=None)[0]
        errors.append(float(((fit - rows * weights[:, np.newaxis]) ** 2).sum()))
    return int(np.argmin(errors))


def crossing(
    blocks: Blocks, limit: Limit, chosen: NDArray[np.int64] | slice = slice(None)
) -> float:
    """Return the strokes after which the mean of histories exceeds a limit; infinity: never."""
    values = curve(blocks, limit.key, chosen)
    above = np.flatnonzero(values >= limit.value)
    if not above.size:
        return math.inf
    k = int(above[0])
    if k == 0:
        return 0.0
    part = (limit.value - values[k - 1]) / (values[k] - values[k - 1])
    return float(blocks[k - 1].strokes + part * (blocks[k].strokes - blocks[k - 1].strokes))


def first_crossing(
    blocks: Blocks, limits: Sequence[Limit], chosen: NDArray[np.int64] | slice = slice(None)
) -> float:
    """Return the strokes after which the first of some limits is exceeded."""
    return min(crossing(blocks, limit, chosen) for limit in limits)


def sampling_error(blocks: Blocks, limits: Sequence[Limit]) -> float:
    """Return the half width of the logarithm of the strokes at the first crossing.

    Infinite if some history, left out, leaves the others without a crossing.
    """
    n = count_of(blocks)
    value = first_crossing(blocks, limits)
    if not 0.0 < value < math.inf or n < 2:
        return math.inf
    everyone = np.arange(n)
    without = np.array([first_crossing(blocks, limits, np.delete(everyone, k)) for k in everyone])
    if not np.all((without > 0.0) & np.isfinite(without)):
        return math.inf
    half = half_width(n * math.log(value) - (n - 1) * np.log(without))
    assert half is not None
    return half


def count_of(blocks: Blocks) -> int:
    """Return the number of histories."""
    return next(iter({**blocks[0].levels, **blocks[0].samples}.values())).size


def cycles_until(blocks: Blocks, strokes: float) -> float:
    """Return the cycles of each history after the first block, up to some strokes."""
    ends = np.cumsum([block.cycles for block in blocks]) - blocks[0].cycles
    return float(np.interp(strokes, [block.strokes for block in blocks], ends))


def _is_beyond(blocks: Blocks, limits: Sequence[Limit]) -> bool:
    """Return whether the histories are far enough beyond the first crossing to determine it."""
    if not math.isfinite(sampling_error(blocks, limits)):
        return False
    value = first_crossing(blocks, limits)
    first = next(limit for limit in limits if crossing(blocks, limit) == value)
    if first.key in blocks[0].levels:
        return True
    needed = (1.0 + MARGIN) * cycles_until(blocks, value)
    return len(blocks) > MIN_BLOCKS and cycles_until(blocks, math.inf) >= needed


def levels_of(scene: Scene, depth: Array, limited: Sequence[str]) -> dict[str, Array]:
    """Return the quantities of the surfaces by key, each of shape (histories,).

    Parameters
    ----------
    depth : ndarray, shape (histories, joints, 2, bins)
        Depth of the surfaces, m.
    limited : sequence of str
        Names that limits are on; the total clearance takes long and is computed only for these.
    """
    levels = {}
    for k, joint in enumerate(scene.linkage().clearances):
        item = depth[:, k, :, : joint.bins]
        levels[f"{joint.name}.depth"] = item.max(axis=(1, 2))
        levels[f"{joint.name}.wear_volume"] = np.array([worn_volume(joint, one) for one in item])
    if "total_clearance" in limited:
        values = [total_clearance(linkage_on(scene, one)) for one in depth]
        levels["total_clearance"] = np.array(values)
    return levels


def samples_of(scene: Scene, rows: Array) -> dict[str, Array]:
    """Return the quantities of strokes by key, each of shape (histories,).

    Parameters
    ----------
    rows : ndarray, shape (histories, cycles, columns)
        Columns CYCLE_FIXED and CYCLE_JOINT.
    """
    samples = {}
    for k, joint in enumerate(scene.linkage().clearances):
        column = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k + CYCLE_JOINT.index("force_max")
        samples[f"{joint.name}.force_max"] = rows[:, :, column].mean(axis=1)
    ideal = bottom_of(scene.ideal)
    if ideal is not None:
        off = rows[:, :, CYCLE_FIXED.index("bottom_height")] - ideal.height
        mean = off.mean(axis=1)
        samples |= {"bdc_error": mean, "bdc_drift": mean, "repeatability": off.var(axis=1, ddof=1)}
    return samples


@dataclass
class SceneHistories:
    """Wear histories of a scene.

    Attributes
    ----------
    runner : Runner
    initial : ndarray, shape (replicates, joints, 2, bins)
        Depth of the surfaces at the start, m.
    limited : tuple of str
        Names that limits are on.
    state : LifeState
    keep : callable
        Called with the state whenever it has changed.
    """

    runner: Runner
    initial: Array
    limited: tuple[str, ...]
    state: LifeState = field(default_factory=LifeState)
    keep: Callable[[LifeState], None] = lambda state: None

    def advance(self, number: int, before: Blocks, plan: BlockPlan) -> LoadBlock:
        """Advance by a block; see ``Histories``."""
        scene, interval = self.runner.scene, before[-1].interval if before else 0
        item = [block for block in before if block.interval == interval]
        # A service interval starts on the surfaces after maintenance, or on the scene's.
        first = item[0].depth if item and not item[0].cycles else self.initial
        finished = STARTUP_CYCLES + sum(block.cycles for block in item)
        strokes = before[-1].strokes if before else 0.0
        running = self.state.running
        if self.state.place != (number, interval):
            running = EnsembleState((None,) * scene.replicate_count)
        else:
            self.runner.progress.done -= running.cycles / scene.replicate_count
        running = replace(running, until=(finished + plan.cycles,) * scene.replicate_count)
        self.state = replace(self.state, place=(number, interval), running=running)
        spec = RunSpec(
            _MAX_CYCLES,
            wear=wear_per_cycle(plan.share, 1, plan.extra),
            number=number + _MAX_INTERVALS * interval,
            label=f"life, pass {number}, {strokes:.3g} strokes",
        )
        left = max(MIN_CYCLES - sum(block.cycles for block in before), MIN_BLOCK)
        left += 2 * MIN_CYCLES if number == 1 else 0
        self.runner.progress.later = left + scene.wear_updates * FIRST_PASS

        def keep(running: EnsembleState) -> None:
            self.state = replace(self.state, running=running)
            self.keep(self.state)

        ensemble = self.runner.run(first, spec, running, keep)
        if ensemble.failure:
            if not before:
                raise RunFailed(ensemble.failure, ensemble.finding)
            return replace(before[-1], cycles=0, ended_by=ensemble.failure)
        joints, recorders = ensemble.linkage.clearances, ensemble.recorders
        earlier = item[-1].depth if item else first
        depth = np.array([recorder.surface_depth for recorder in recorders])
        worn_through = [worn_out(joints, one) for one in depth]
        # A history whose surfaces are worn out ends early: all are taken back to that cycle.
        counts = np.array([len(recorder.cycles) - finished for recorder in recorders])
        cycles = int(counts.min())
        part = (cycles / counts)[:, np.newaxis, np.newaxis, np.newaxis]
        depth = np.where(part < 1.0, earlier + part * (depth - earlier), depth)
        rows = np.array([recorder.cycles[finished : finished + cycles] for recorder in recorders])
        represented = plan.share * cycles
        removed = (depth - earlier).mean(axis=0) / represented
        return LoadBlock(
            strokes + represented,
            cycles,
            interval,
            levels_of(scene, depth, self.limited),
            samples_of(scene, rows),
            largest_change(joints, removed),
            removed,
            depth,
            next(
                (
                    f"{first_found[0]}: {first_found[1]}"
                    for first_found in worn_through
                    if first_found
                ),
                "",
            ),
            ensemble.state.wall - running.wall,
        )

    def keep_passes(self, passes: tuple[Refinement, ...]) -> None:
        """Store refinements that have advanced."""
        self.state = replace(self.state, passes=passes)
        self.keep(self.state)

    def maintain(self, number: int, before: Blocks, service: Service) -> LoadBlock:
        """Replace or turn a bushing; see ``Histories``."""
        last, joints = before[-1], self.runner.scene.linkage().clearances
        depth = last.depth.copy()
        k = [joint.name for joint in joints].index(service.joint)
        bushing = depth[:, k, 0, : joints[k].bins]
        half_turn = joints[k].bins // 2
        bushing[...] = np.roll(bushing, half_turn, axis=1) if service.is_turned else 0.0
        levels = levels_of(self.runner.scene, depth, self.limited)
        interval = last.interval + 1
        return replace(last, cycles=0, interval=interval, levels=levels, rate=0.0, depth=depth)


def run_life(
    runner: Runner, initial: Array, state: LifeState, keep: Callable[[LifeState], None]
) -> tuple[tuple[Refinement, ...], LifeResult]:
    """Run the service life of a scene, or resume it; return its refinements as well.

    Parameters
    ----------
    initial : ndarray, shape (replicates, joints, 2, bins)
        Depth of the surfaces at the start, m.
    keep : callable
        Called with the state whenever it has changed.

    Raises
    ------
    InputError
        If a limit is exceeded when new.
    RunFailed
        If a run fails before anything is known.
    """
    problem = LifeProblem.of(runner.scene)
    limited = tuple(limit.name for limit in problem.limits)
    histories = SceneHistories(runner, initial, limited, state, keep)
    passes = run_refinements(problem, histories, state.passes, histories.keep_passes)
    return passes, life_result(runner.scene, problem, passes)


def life_result(scene: Scene, problem: LifeProblem, passes: tuple[Refinement, ...]) -> LifeResult:
    """Return the life as results store it."""
    blocks = passes[-1].blocks
    life, end = estimate_life(problem, passes), blocks[-1]
    ended: Ended = "limit"
    message = ""
    if math.isinf(life.strokes):
        if end.ended_by:
            ended, message = "worn", end.ended_by
        elif end.strokes >= problem.at_most:
            ended, message = "at_most", f"no limit is passed within {problem.at_most:.4g} strokes"
        else:
            ended = "cycles"
            message = f"no limit is passed within {_cycles(blocks)} cycles of all starts"
    # A life is inversely proportional to the wear coefficients, all of them high or low together.
    worst = max(scene.bearing(name).materials.wear_scatter for name in scene.clearance_joints)
    curves = {"strokes": np.array([block.strokes for block in blocks])}
    for key in (*blocks[0].levels, *blocks[0].samples):
        value, half = _band(blocks, key)
        curves[key] = np.column_stack([value, value - half, value + half])
    return LifeResult(
        ended,
        message,
        min(life.strokes, end.strokes),
        _finite(life.sampling),
        _finite(life.step),
        quantile(math.inf) * math.sqrt(math.log1p(worst**2)),
        tuple(_limit_result(problem, passes, limit, life) for limit in problem.limits),
        tuple(
            PassResult(
                item.change,
                _cycles(item.blocks),
                _finite(first_crossing(item.blocks, problem.limits)),
                _finite(sampling_error(item.blocks, problem.limits)),
            )
            for item in passes
        ),
        tuple(phase for name in scene.clearance_joints for phase in wear_phases(blocks, name)),
        tuple(
            f"{service.words} after {service.strokes:.4g} strokes"
            for service in problem.services[: end.interval]
        ),
        curves,
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _cycles(blocks: Blocks) -> int:
    return count_of(blocks) * sum(block.cycles for block in blocks)


def _limit_result(
    problem: LifeProblem, passes: tuple[Refinement, ...], limit: Limit, life: LifeEstimate
) -> LimitResult:
    blocks = passes[-1].blocks
    item = estimate_life(problem, passes, [limit])
    if item.strokes == life.strokes:
        item = life  # of the first limit a coarser pass that another limit ended counts too
    value, half = (float(values[-1]) for values in _band(blocks, limit.key))
    errors = _finite(item.strokes), _finite(item.sampling), _finite(item.step)
    return LimitResult(limit.key, limit.unit, limit.value, *errors, value, half)


def _band(blocks: Blocks, key: str) -> tuple[Array, Array]:
    """Return a quantity at the ends of blocks and its half width, by the jackknife."""
    value, n = curve(blocks, key), count_of(blocks)
    if n < 2:
        return value, np.zeros_like(value)
    without = np.array([curve(blocks, key, np.delete(np.arange(n), k)) for k in range(n)])
    pseudo = n * value - (n - 1) * without
    return value, np.array([half_width(values) for values in pseudo.T])


def wear_between(
    passes: Sequence[Refinement],
    joints: Sequence[ClearanceJoint],
    initial: Array,
    since: float,
    until: float,
) -> WearUpdate:
    """Return the wear between two numbers of strokes, by the last refinement.

    Surfaces are interpolated between the ends of blocks; at maintenance they are those after it.
    """
    last, *others = reversed(passes)
    depth_at, lost_at = _interpolated(last, initial)
    coarser = None
    if others and others[0].blocks[-1].strokes >= until:
        coarser_at = _interpolated(others[0], initial)[1]
        coarser = coarser_at(until) - coarser_at(since)
    steps, at, count = [], since, len(initial)
    for block in last.blocks:
        end = min(block.strokes, until)
        if end <= at:
            continue
        cycles = block.cycles * count
        added = (lost_at(end) - lost_at(at)).mean(axis=0) / block.cycles
        forces = {
            joint.name: float(block.samples[f"{joint.name}.force_max"].mean()) for joint in joints
        }
        steps.append(
            WearStep(
                cycles_per_update=end - at,
                cycles=cycles,
                factor=(end - at) * count / cycles,
                clearance_change=largest_change(joints, added),
                max_depth=by_side(joints, depth_at(end).max(axis=3).mean(axis=0)),
                peak_force=forces,
                wall_s=block.wall_s,
            )
        )
        at = end
    return WearUpdate(depth_at(until), lost_at(until) - lost_at(since), tuple(steps), coarser)


def _interpolated(
    refinement: Refinement, initial: Array
) -> tuple[Callable[[float], Array], Callable[[float], Array]]:
    """Return depth and material lost, m, as functions of strokes.

    A bushing that was replaced has lost its material all the same.
    """
    blocks = refinement.blocks
    depth = np.array([initial, *(block.depth for block in blocks)])
    added = [
        (after - before) * (block.cycles > 0)
        for (before, after), block in zip(pairwise(depth), blocks, strict=True)
    ]
    lost = np.cumsum([np.zeros_like(initial), *added], axis=0)
    ends = np.array([0.0, *(block.strokes for block in blocks)])

    def at(strokes: float, values: Array) -> Array:
        k = int(np.searchsorted(ends, strokes, side="right"))
        if k == len(ends):
            return np.asarray(values[-1])
        part = (strokes - ends[k - 1]) / (ends[k] - ends[k - 1])
        return np.asarray(values[k - 1] + part * (values[k] - values[k - 1]))

    return lambda strokes: at(strokes, depth), lambda strokes: at(strokes, lost)


def wear_phases(blocks: Blocks, joint: str) -> tuple[Phase, ...]:
    """Return the phases of a joint's wear: running-in, steady, accelerated.

    Wear rates that are constant between a few changes are fitted to those of the blocks: as many
    as the Bayesian information criterion allows, in which a change that may be anywhere counts
    twice (Zhang and Siegmund, Biometrics 63, 22, 2007).
    """
    finished = [k for k, block in enumerate(blocks) if block.cycles and k > 0]
    if not finished:
        return ()
    volume = [block.levels[f"{joint}.wear_volume"] for block in blocks]
    strokes = [block.strokes for block in blocks]
    rates = np.array(
        [(volume[k] - volume[k - 1]) / (strokes[k] - strokes[k - 1]) for k in finished]
    )
    weights = np.array([float(blocks[k].cycles) for k in finished])
    edges = list(_phase_edges(rates.mean(axis=1), weights))

    def means_of(edges: Sequence[int]) -> list[Array]:
        return [np.average(rates[a:b], axis=0, weights=weights[a:b]) for a, b in pairwise(edges)]

    def differ(first: Array, second: Array) -> bool:
        # The same histories ran in both phases: their differences are judged.
        change = second - first
        least = MIN_RATE_CHANGE * float(np.mean(first))
        return abs(float(change.mean())) > max(half_width(change) or 0.0, least)

    means = means_of(edges)
    while alike := [k for k, pair in enumerate(pairwise(means), 1) if not differ(*pair)]:
        del edges[alike[0]]
        means = means_of(edges)
    names = _phase_names([float(mean.mean()) for mean in means])
    return tuple(
        Phase(
            joint,
            name,
            strokes[finished[a] - 1],
            strokes[finished[b - 1]],
            float(mean.mean()),
            (half_width(mean) or 0.0) if count_of(blocks) > 1 else 0.0,
        )
        for name, mean, (a, b) in zip(names, means, pairwise(edges), strict=True)
    )


def _phase_edges(rates: Array, weights: Array) -> tuple[int, ...]:
    """Return the indices at which phases start, and the end of the last."""

    def residual(a: int, b: int) -> float:
        mean = float(np.average(rates[a:b], weights=weights[a:b]))
        return float(weights[a:b] @ (rates[a:b] - mean) ** 2)

    count = rates.size
    best = math.inf
    chosen: tuple[int, ...] = (0, count)
    for parts in range(1, min(MAX_PHASES, count // 2) + 1):
        for inner in combinations(range(1, count), parts - 1):
            edges = (0, *inner, count)
            rest = sum(residual(a, b) for a, b in pairwise(edges)) / float(weights.sum())
            rest = max(rest, 1e-12 * float(np.mean(rates**2)))
            penalty = (3 * parts - 2) * math.log(count)
            criterion = count * math.log(rest) + penalty if rest else -math.inf
            if criterion < best:
                best, chosen = criterion, edges
    return chosen


def _phase_names(rates: Sequence[float]) -> list[str]:
    """Return names: falling rates at first are running-in, rising last ones accelerated."""
    names = [STEADY] * len(rates)
    for k in range(len(rates) - 1):
        if rates[k] <= rates[k + 1]:
            break
        names[k] = RUNNING_IN
    for k in reversed(range(1, len(rates))):
        if rates[k] <= rates[k - 1] or names[k] != STEADY:
            break
        names[k] = ACCELERATED
    return names
