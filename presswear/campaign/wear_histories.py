"""Wear histories of a scene, from which ``service_life`` computes the life, and its results."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from presswear.campaign.cycles_of_life import (
    MIN_TIMED_BLOCKS,
    cycles_left,
    relative_time,
    time_per_cycle,
)
from presswear.campaign.ensemble import Ensemble, EnsembleState
from presswear.campaign.life_problem import fewest_cycles_of, problem_of
from presswear.campaign.life_quantities import pseudo_levels_of, samples_of
from presswear.campaign.life_result import life_by_rate, life_result, preliminary_life
from presswear.campaign.refinement import (
    FIRST_CHANGE,
    LoadBlock,
    Refinement,
    Refinements,
)
from presswear.campaign.replicates import RunSpec, RunState, StepCheck, worn_out
from presswear.campaign.runner import WATCHED_CYCLES, WATCHED_SECONDS, Runner
from presswear.campaign.service_life import (
    BlockPlan,
    LifeProblem,
    next_block,
    run_refinements,
)
from presswear.campaign.settled_motions import settling_of
from presswear.campaign.wear_update import CycleWear, largest_change, stage_spec
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner
from presswear.physics.running_in import archard_depth, depth_laws_of
from presswear.recording.settling import Settling
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.life import LifeResult
from presswear.scene.options import Service
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.numbers import large, quantity_text

# Largest number of cycles of a history in a service interval, never reached
_MAX_CYCLES = 1_000_000
# Cycles of each history that take as long as a stage until its wear maps are known
STAGE_CYCLES = 8
# service intervals of a refinement, so that no two of them start alike
_MAX_INTERVALS = 64
REACH = 4.0  # factor that the wear rate may change by from that when new


@dataclass(frozen=True)
class LifeState:
    """State of a service life."""

    refinements: tuple[Refinement, ...] = ()  # the last one may be unfinished
    # refinement and service interval of the present runs
    place: tuple[int, int] = (0, 0)
    # these runs, from the start of the interval
    running: EnsembleState = EnsembleState()
    # runs on the surfaces at the start, which show whether they settle
    watched: EnsembleState | None = None
    # the same runs in the equations of worn surfaces, if they settle
    settled: EnsembleState | None = None


class _Interval(NamedTuple):
    """Service interval that a load block goes on with."""

    number: int
    strokes: float  # since the start of the life
    first: Array  # depth of its surfaces when it started, m
    earlier: Array  # depth of its surfaces before the block, m
    cycles: int  # cycles of its earlier blocks, in each history


@dataclass
class WearHistories:
    """Wear histories of a scene."""

    runner: Runner
    # depth of the surfaces at the start, (replicates, joints, 2, bins), m
    initial: Array
    problem: LifeProblem
    state: LifeState = field(default_factory=LifeState)
    # called whenever it has changed
    keep: Callable[[LifeState], None] = lambda state: None

    def store(self, **changes: Any) -> None:
        """Change the state and keep it."""
        self.state = replace(self.state, **changes)
        self.keep(self.state)

    @property
    def _watched_runs(self) -> tuple[RunState | None, ...]:
        watched = self.state.watched
        return () if watched is None else watched.runs

    @cached_property
    def settling(self) -> Settling | None:
        """Motions on the surfaces at the start; None if no cycle is complete."""
        runs = self._watched_runs
        rows = [run.arrays["recorder/cycles"] for run in runs if run]
        if not rows:
            return None
        return settling_of(self.runner.scene.linkage().clearances, rows)

    def watch(self) -> None:
        """Run the histories without wear, which shows whether the motion settles.

        They are the runs of the first stage, unless the scene has a number of cycles.
        If the motion settles they run again in the equations of worn surfaces, so that
        wear can begin in the settled motion.
        """
        runner = self.runner
        scene = runner.scene
        most = max(scene.max_cycles // scene.replicate_count, 1)
        label = "life, does the motion settle?"
        spec = RunSpec(most, math.inf, label=label)
        if scene.cycles is None:
            spec = replace(stage_spec(scene, 0), label=label)
        later = fewest_cycles_of(scene) / scene.replicate_count
        later += self.later_stages * _stage_cycles(runner, ())
        # Progress counts cycles on worn surfaces. Those on round ones take less time.
        cost = 1.0
        if not self.initial.any():
            cost = scene.solver.step_time / scene.solver.worn_step_time
        runner.later = later / cost
        self._run_without_wear(spec, "watched", StepCheck(scene, self.initial[0]))
        runner.count_as(cost, later)
        if self.settling and self.settling.verdict == "settled":
            spec = RunSpec(most, math.inf, wear=CycleWear(0.0, ()), label=label)
            self._run_without_wear(spec, "settled")

    def _run_without_wear(
        self, spec: RunSpec, name: str, step_check: StepCheck | None = None
    ) -> None:
        """Run the histories on the surfaces at the start; ``name`` is that of their state."""
        ensemble = self.runner.run(
            self.initial,
            spec,
            getattr(self.state, name),
            lambda state: self.store(**{name: state}),
            step_check,
        )
        if ensemble.failure:
            raise RunFailed(ensemble.failure, ensemble.finding)
        self.store(**{name: ensemble.state})

    @property
    def later_stages(self) -> int:
        """Number of stages that run after the life."""
        scene = self.runner.scene
        return scene.wear_updates + (scene.cycles is not None)

    def remaining(self, refinements: Refinements) -> tuple[float, float]:
        """Return cycles of all replicates and time, s, that life and stages will still take."""
        blocks = refinements[-1].blocks
        cycles = cycles_left(self.problem, refinements)
        cycles += self.later_stages * _stage_cycles(self.runner, blocks)
        seconds = cycles * time_per_cycle(self.problem, refinements)
        return cycles * self.runner.scene.replicate_count, seconds

    def limit_first_block(self) -> LifeProblem:
        """Return the problem with a first block that wears no more than a coarse step.

        K_d tells how much a stroke wears at ``pressure_reference`` only. The watched
        cycles tell it at the pressures of the scene.
        """
        joints = self.runner.scene.linkage().clearances
        laws = [joint.wear for joint in joints if joint.wear is not None]
        is_known = all(
            law.pressure_exponent == 1.0 and not law.depends_on_pressure for law in laws
        )
        runs = self._watched_runs
        maps = [run.maps for run in runs if run]
        if not maps or is_known:
            return self.problem
        removed = np.mean(
            [run_maps.sampled / max(run_maps.samples, 1) for run_maps in maps], axis=0
        )
        change = largest_change(joints, removed)
        of_depth = [law for law in depth_laws_of(joints) if law is not None]
        change *= max((law.ratio for law in of_depth if law.ratio > 1.0), default=1.0)
        share = self.problem.first_share
        if change > 0.0:
            share = min(share, FIRST_CHANGE / change)
        self.problem = replace(self.problem, first_share=share)
        return self.problem

    def start_up(self, interval: int) -> EnsembleState:
        """Return the runs that the histories of a service interval go on from, if any.

        Where all of them came to rest on one motion, wear begins in that motion.
        """
        settled = self.state.settled
        if interval == 0 and settled:
            joints = self.runner.scene.linkage().clearances
            rows = [run.arrays["recorder/cycles"] for run in settled.runs if run]
            settling = settling_of(joints, rows)
            if settling and settling.verdict == "settled":
                runs = (run and replace(run, status=None) for run in settled.runs)
                return replace(settled, runs=tuple(runs))
        return EnsembleState((None,) * self.runner.scene.replicate_count)

    def advance(self, refinements: Refinements, plan: BlockPlan | Service) -> LoadBlock:
        """Run the next block, or replace or turn a bushing; see ``Advance``."""
        number = len(refinements)
        before = refinements[-1].blocks
        if isinstance(plan, Service):
            return self._maintain(before[-1], plan)
        runner = self.runner
        scene = runner.scene
        count = scene.replicate_count
        interval = self._interval_of(before)
        running = self.start_up(interval.number)
        start_up = running.cycles // count or STARTUP_CYCLES
        finished = start_up + interval.cycles
        place = (number, interval.number)
        if self.state.place == place and self.state.running.runs:
            running = self.state.running
        runner.done -= running.cycles / count
        running = replace(running, until=(finished + plan.cycles,) * count)
        self.state = replace(self.state, place=place, running=running)
        started = 0 if before else start_up
        runner.later = self._later_cycles(refinements, plan.cycles + started)
        laws = depth_laws_of(scene.linkage().clearances)
        spec = RunSpec(
            _MAX_CYCLES,
            wear=CycleWear(plan.share, laws, plan.extra),
            number=number + _MAX_INTERVALS * interval.number,
            label=f"life, refinement {number}, {large(interval.strokes, digits=2)} strokes",
        )
        ensemble = runner.run(
            interval.first, spec, running, lambda state: self.store(running=state)
        )
        if ensemble.failure:
            if not before:
                raise RunFailed(ensemble.failure, ensemble.finding)
            return replace(before[-1], cycles=0, ended_by=ensemble.failure)
        wall = ensemble.state.wall - running.wall
        block = self._block_of(ensemble, interval, finished, plan.share, wall)
        if not before:
            self._check_reach(block.depth, block.strokes)
        return block

    def _later_cycles(self, refinements: Refinements, present: int) -> float:
        """Return the cycles of each history after the present ones, at the mean time so far.

        They include the stages after the life.
        """
        later = max(cycles_left(self.problem, refinements) - present, 0.0)
        later += self.later_stages * _stage_cycles(self.runner, refinements[-1].blocks)
        return later * relative_time(self.problem, refinements)

    def _interval_of(self, before: Sequence[LoadBlock]) -> _Interval:
        """Return the service interval that a refinement goes on with after some blocks.

        It starts on the surfaces after maintenance, or on those of the scene.
        """
        number = before[-1].interval if before else 0
        strokes = before[-1].strokes if before else 0.0
        blocks = [block for block in before if block.interval == number]
        first = self.initial
        if blocks and not blocks[0].cycles:
            first = blocks[0].depth
        earlier = blocks[-1].depth if blocks else first
        cycles = sum(block.cycles for block in blocks)
        return _Interval(number, strokes, first, earlier, cycles)

    def _block_of(
        self,
        ensemble: Ensemble,
        interval: _Interval,
        finished: int,
        share: float,
        wall: float,
    ) -> LoadBlock:
        """Return the block that runs add to their ``finished`` cycles.

        A history whose surfaces are worn out ends early: all are taken back to that
        cycle.
        """
        joints = ensemble.linkage.clearances
        rows = [recorder.cycles for recorder in ensemble.recorders]
        depth = ensemble.surface_depth
        worn = worn_out(joints, depth)
        counts = np.array([len(cycles) - finished for cycles in rows])
        cycles = int(counts.min())
        strokes = share * cycles
        earlier = interval.earlier
        fraction = (cycles / counts).reshape(-1, 1, 1, 1)
        depth = np.where(fraction < 1.0, earlier + fraction * (depth - earlier), depth)
        until = finished + cycles
        removed = (depth - earlier).mean(axis=0) / strokes
        laws = depth_laws_of(joints)
        archard = archard_depth(laws, depth) - archard_depth(laws, earlier)
        return LoadBlock(
            strokes=interval.strokes + strokes,
            cycles=cycles,
            interval=interval.number,
            levels=self._levels(depth),
            samples=samples_of(
                self.runner.scene, np.array([run[finished:until] for run in rows])
            ),
            rate=largest_change(joints, removed),
            removed=archard.mean(axis=0) / strokes,
            depth=depth,
            ended_by=f"{worn.joint}: {worn.what}" if worn else "",
            wall_s=wall,
            settled=_settled(joints, [run[:until] for run in rows]),
        )

    def _maintain(self, last: LoadBlock, service: Service) -> LoadBlock:
        depth = last.depth.copy()
        joints = self.runner.scene.linkage().clearances
        for k, joint in enumerate(joints):
            owner = joint.guide.name if isinstance(joint, GuideCorner) else joint.name
            if owner != service.joint:
                continue
            worn = depth[:, k, 0, : joint.bins]
            if service.is_rotated:
                worn[...] = np.roll(worn, joint.bins // 2, axis=1)
            else:
                worn[...] = 0.0
        interval = last.interval + 1
        return replace(
            last,
            cycles=0,
            interval=interval,
            levels=self._levels(depth),
            rate=0.0,
            depth=depth,
        )

    def _levels(self, depth: Array) -> dict[str, Array]:
        limited = [limit.name for limit in self.problem.limits]
        return pseudo_levels_of(self.runner.scene, depth, limited)

    def _check_reach(self, depth: Array, strokes: float) -> None:
        """Raise InputError if, at the rate when new, a joint wears out long before a limit.

        It is worn out where it is worn deeper than the model holds, see ``worn_out``.
        """
        scene = self.runner.scene
        joints = scene.linkage().clearances
        life = scene.life
        levels = self._levels(depth)
        assert life is not None
        limits = self.problem.limits
        is_of_depth = all(limit.name in ("depth", "wear_volume") for limit in limits)
        if not is_of_depth or self.initial.any() or self.problem.services:
            return
        worn = depth.mean(axis=0).max(axis=(1, 2)) / [
            joint.deepest_wear for joint in joints
        ]
        reached = max(float(levels[limit.key].mean()) / limit.value for limit in limits)
        deepest = int(np.argmax(worn))
        is_before = worn[deepest] > REACH * reached > 0.0
        through = strokes / max(float(worn[deepest]), 1e-300)
        if is_before and life.at_most > through:
            joint = joints[deepest]
            raise InputError(
                f"until: at the wear rate when new, joint {joint.name} wears by "
                f"{quantity_text(joint.deepest_wear, 'm')}, the most that the model holds for, "
                f"after {large(through, digits=1)} strokes, and no limit is exceeded "
                f"before {large(strokes / reached, digits=1)}; choose a limit that comes first, "
                "or give fewer joints clearance"
            )


def run_life(
    runner: Runner,
    initial: Array,
    state: LifeState,
    keep: Callable[[LifeState], None],
    report: Callable[[LifeResult], None],
    announce: Callable[[float, float], None],
) -> tuple[LifeState, LifeResult]:
    """Run the service life of a scene, or resume it; return its state as well.

    ``report`` is called with a preliminary life after each refinement that another one
    follows, and in the first one after 2, 4, 8 ... load blocks. ``announce`` is called
    once, early, with the cycles of all replicates and the time, s, that the life and
    the stages through it will still take. InputError if a limit is exceeded when new;
    RunFailed if a run fails before anything is known.
    """
    scene = runner.scene
    life = runner.scene.life
    assert life is not None
    problem = problem_of(scene, life)
    histories = WearHistories(runner, initial, problem, state, keep)
    if not state.refinements:
        histories.watch()
    problem = histories.limit_first_block()

    def keep_blocks(refinements: Refinements) -> None:
        histories.store(refinements=tuple(refinements))
        if len(refinements) > 1:
            return
        count = len(refinements[0].blocks)
        if count == MIN_TIMED_BLOCKS:
            announce(*histories.remaining(refinements))
        is_power_of_two = count > 1 and count.bit_count() == 1
        if is_power_of_two and next_block(problem, refinements[0]) is not None:
            early = life_by_rate(scene, problem, refinements)
            if early is not None:
                report(early)

    done = run_refinements(
        problem,
        histories.advance,
        state.refinements,
        keep_blocks,
        lambda refinements: report(preliminary_life(scene, problem, refinements)),
    )
    result = replace(life_result(scene, problem, done), settling=histories.settling)
    return replace(histories.state, refinements=done), result


def _settled(
    joints: Sequence[ClearanceJoint], histories: Sequence[Array]
) -> int | None:
    """Return how many wear histories repeat at their end, from their rows of cycles."""
    settling = settling_of(joints, histories)
    if settling is None or settling.verdict == "unwatched":
        return None
    return settling.settled


def _stage_cycles(runner: Runner, blocks: Sequence[LoadBlock]) -> float:
    """Return the cycles of each history that a stage through the life is expected to take."""
    cycles = runner.scene.cycles
    if cycles is not None:
        return cycles
    timed = [block for block in blocks if block.cycles]
    if not timed:
        return WATCHED_CYCLES
    seconds = runner.workers.count * timed[-1].wall_s / timed[-1].cycles
    if WATCHED_CYCLES * seconds <= WATCHED_SECONDS:
        return WATCHED_CYCLES
    return max(WATCHED_SECONDS / seconds, STAGE_CYCLES)
