"""Wear histories of a scene, from which ``service_life`` computes the life, and its results."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from presswear.campaign import wear_update
from presswear.campaign.cycles_of_life import cycles_left, fewest_cycles
from presswear.campaign.ensemble import (
    WATCHED_CYCLES,
    WATCHED_SECONDS,
    EnsembleState,
    Runner,
)
from presswear.campaign.life_estimate import estimate_life
from presswear.campaign.refinement import (
    FIRST_CHANGE,
    LoadBlock,
    Refinement,
    Refinements,
)
from presswear.campaign.replicates import RunSpec, linkage_on, worn_out
from presswear.campaign.service_life import (
    FIRST_WEAR,
    BlockPlan,
    LifeProblem,
    run_refinements,
)
from presswear.campaign.settled_motions import settling_of
from presswear.linkage.elements import ClearanceJoint, GuideCorner
from presswear.physics.dead_centre import bottom_of
from presswear.physics.running_in import archard_depth, running_in_of
from presswear.physics.statics import total_clearance
from presswear.physics.wall_wear import tilt_between, wall_volume, walls_of
from presswear.physics.wear import largest_play, worn_volume
from presswear.recording.columns import cycle_column
from presswear.recording.settling import Settling
from presswear.recording.statistics import STARTUP_CYCLES, quantile
from presswear.results.life import Ended, LifeResult, LimitResult, RefinementResult
from presswear.results.stage import WearStep
from presswear.scene.options import CLEARANCES, Life, Service
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.numbers import large, quantity_text

_MAX_CYCLES = 1_000_000  # of a history in one service interval: none comes so far
# of the first refinement: in the second, kernels are compiled and joints worn
MEASURED_BLOCKS = 2
# of each history, in whose time a stage runs until its wear maps are known
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
    # runs that do not wear, which show whether they settle
    watched: EnsembleState | None = None


def levels_of(scene: Scene, depth: Array, limited: Sequence[str]) -> dict[str, Array]:
    """Return the quantities of surfaces of shape (histories, joints, 2, bins), m, by key.

    Clearances take long and are computed only if a limit is on one of them.
    """
    levels = {}
    linkage = scene.linkage()
    for k, joint in enumerate(linkage.clearances):
        if isinstance(joint, GuideCorner):
            continue
        item = depth[:, k, :, : joint.bins]
        levels[f"{joint.name}.depth"] = item.max(axis=(1, 2))
        levels[f"{joint.name}.wear_volume"] = np.array(
            [worn_volume(joint, one) for one in item]
        )
        if not CLEARANCES.keys().isdisjoint(limited):
            play = np.array([largest_play(joint, one) for one in item])
            levels[f"{joint.name}.radial_clearance"] = 0.5 * play
            levels[f"{joint.name}.diametral_clearance"] = play
    for guide, walls in walls_of(linkage, depth).items():
        corner = next(one for one in linkage.corners if one.guide.name == guide)
        levels[f"{guide}.depth"] = walls.max(axis=(1, 2))
        volumes = [wall_volume(corner, one) for one in walls]
        levels[f"{guide}.wear_volume"] = np.array(volumes)
        tilts = [tilt_between(corner, one) for one in walls]
        levels[f"{guide}.tilt"] = np.array(tilts)
    if "total_clearance" in limited:
        values = [total_clearance(linkage_on(scene, one)) for one in depth]
        levels["total_clearance"] = np.array(values)
    return levels


def samples_of(scene: Scene, rows: Array) -> dict[str, Array]:
    """Return the quantities of rows of cycles, shape (histories, cycles, columns), by key."""
    samples = {}
    for k, joint in enumerate(scene.linkage().clearances):
        forces = rows[:, :, cycle_column("force_max", k)]
        samples[f"{joint.name}.force_max"] = forces.mean(axis=1)
    ideal = bottom_of(scene.ideal)
    if ideal is not None:
        off = rows[:, :, cycle_column("bottom_height")] - ideal.height
        mean = off.mean(axis=1)
        # Where a history wears out in one stroke, only the histories together have a
        # variance.
        is_single = off.shape[1] == 1
        variance = (
            np.full(len(off), off.var(ddof=1)) if is_single else off.var(axis=1, ddof=1)
        )
        samples |= {"bdc_error": mean, "bdc_drift": mean, "repeatability": variance}
    return samples


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

    @cached_property
    def settling(self) -> Settling | None:
        """Motions on the surfaces at the start; None if no cycle is complete."""
        runs = () if self.state.watched is None else self.state.watched.runs
        rows = [run.arrays["recorder/cycles"] for run in runs if run]
        return (
            settling_of(self.runner.scene.linkage().clearances, rows) if rows else None
        )

    def watch(self) -> None:
        """Run the histories without wear for as long as a stage is watched."""
        scene = self.runner.scene
        spec = RunSpec(
            max(scene.max_cycles // scene.replicate_count, 1),
            tolerance=math.inf,
            wear=wear_update.CycleWear(0.0, ()),
            label="life, does the motion settle?",
        )
        watched = self.state.watched or EnsembleState()
        runner = self.runner
        runner.later = fewest_cycles_of(scene) / scene.replicate_count
        runner.later += (scene.wear_updates + 1) * _stage_cycles(runner, ())
        ensemble = runner.run(
            self.initial, spec, watched, lambda s: self.store(watched=s)
        )
        if ensemble.failure:
            raise RunFailed(ensemble.failure, ensemble.finding)
        self.store(watched=ensemble.state)

    def limit_first_block(self) -> LifeProblem:
        """Return the problem with a first block that wears no more than a coarse step.

        K_d tells how much a stroke wears at ``pressure_reference`` only. The watched
        cycles tell it at the pressures of the scene.
        """
        joints = self.runner.scene.linkage().clearances
        laws = [joint.wear for joint in joints if joint.wear is not None]
        runs = () if self.state.watched is None else self.state.watched.runs
        maps = [run.maps for run in runs if run]
        if not maps or all(law.pressure_exponent == 1.0 for law in laws):
            return self.problem
        removed = np.mean([one.sampled / max(one.samples, 1) for one in maps], axis=0)
        change = wear_update.largest_change(joints, removed)
        change *= max(max(law.running_in, 1.0) for law in laws)
        share = self.problem.first_share
        if change > 0.0:
            share = min(share, FIRST_CHANGE / change)
        self.problem = replace(self.problem, first_share=share)
        return self.problem

    def start_up(self, interval: int) -> EnsembleState:
        """Return the runs that the histories of a service interval go on from, if any.

        Where all of them came to rest on one motion, wear begins in that motion.
        """
        watched = self.state.watched
        if (
            interval == 0
            and watched
            and self.settling
            and self.settling.verdict == "settled"
        ):
            runs = (run and replace(run, status=None) for run in watched.runs)
            return replace(watched, runs=tuple(runs))
        return EnsembleState((None,) * self.runner.scene.replicate_count)

    def advance(self, refinements: Refinements, plan: BlockPlan | Service) -> LoadBlock:
        """Run the next block, or replace or turn a bushing; see ``Advance``."""
        number = len(refinements)
        before = refinements[-1].blocks
        if isinstance(plan, Service):
            return self._maintain(before[-1], plan)
        runner = self.runner
        scene = self.runner.scene
        count = scene.replicate_count
        interval, strokes = (
            (before[-1].interval, before[-1].strokes) if before else (0, 0.0)
        )
        blocks = [block for block in before if block.interval == interval]
        # A service interval starts on the surfaces after maintenance, or on those of
        # the scene.
        first = blocks[0].depth if blocks and not blocks[0].cycles else self.initial
        earlier = blocks[-1].depth if blocks else first
        running = self.start_up(interval)
        start_up = running.cycles // count or STARTUP_CYCLES
        finished = start_up + sum(block.cycles for block in blocks)
        if self.state.place == (number, interval) and self.state.running.runs:
            running = self.state.running
        runner.done -= running.cycles / count
        running = replace(running, until=(finished + plan.cycles,) * count)
        self.state = replace(self.state, place=(number, interval), running=running)
        start = 0 if before else start_up
        runner.later = max(
            cycles_left(self.problem, refinements) - plan.cycles - start, 0.0
        )
        runner.later += (scene.wear_updates + 1) * _stage_cycles(runner, before)

        laws = running_in_of(scene.linkage().clearances)
        wear = wear_update.CycleWear(plan.share, laws, plan.extra)
        label = f"life, refinement {number}, {large(strokes, digits=2)} strokes"
        place = number + _MAX_INTERVALS * interval
        spec = RunSpec(_MAX_CYCLES, wear=wear, number=place, label=label)
        ensemble = runner.run(
            first, spec, running, lambda state: self.store(running=state)
        )
        if ensemble.failure:
            if not before:
                raise RunFailed(ensemble.failure, ensemble.finding)
            return replace(before[-1], cycles=0, ended_by=ensemble.failure)
        joints = ensemble.linkage.clearances
        recorders = ensemble.recorders
        depth = ensemble.surface_depth
        worn = worn_out(joints, depth)
        # A history whose surfaces are worn out ends early: all are taken back to that
        # cycle.
        counts = np.array([len(recorder.cycles) - finished for recorder in recorders])
        cycles = int(counts.min())
        part = (cycles / counts)[:, np.newaxis, np.newaxis, np.newaxis]
        depth = np.where(part < 1.0, earlier + part * (depth - earlier), depth)
        rows = np.array(
            [recorder.cycles[finished : finished + cycles] for recorder in recorders]
        )
        removed = (depth - earlier).mean(axis=0) / (plan.share * cycles)
        archard = archard_depth(laws, depth) - archard_depth(laws, earlier)
        if not before:
            self._check_reach(depth, plan.share * cycles)
        return LoadBlock(
            strokes + plan.share * cycles,
            cycles,
            interval,
            self._levels(depth),
            samples_of(scene, rows),
            wear_update.largest_change(joints, removed),
            archard.mean(axis=0) / (plan.share * cycles),
            depth,
            f"{worn.joint}: {worn.what}" if worn else "",
            ensemble.state.wall - running.wall,
            _settled(
                joints, [recorder.cycles[: finished + cycles] for recorder in recorders]
            ),
        )

    def _maintain(self, last: LoadBlock, service: Service) -> LoadBlock:
        depth = last.depth.copy()
        joints = self.runner.scene.linkage().clearances
        k = [joint.name for joint in joints].index(service.joint)
        bushing = depth[:, k, 0, : joints[k].bins]
        half_turn = joints[k].bins // 2
        bushing[...] = np.roll(bushing, half_turn, axis=1) if service.is_turned else 0.0
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
        return levels_of(
            self.runner.scene, depth, [limit.name for limit in self.problem.limits]
        )

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
        if is_before and life.at_most > (through := strokes / float(worn[deepest])):
            joint = joints[deepest]
            raise InputError(
                f"until: at the wear rate when new, joint {joint.name} wears by "
                f"{quantity_text(joint.deepest_wear, 'm')}, the most that the model holds for, "
                f"after {large(through, digits=1)} strokes, and no limit is exceeded "
                f"before {large(strokes / reached, digits=1)}; choose a limit that comes first, "
                "or give fewer joints clearance"
            )


def problem_of(scene: Scene, life: Life) -> LifeProblem:
    """Return limits and accuracy of a service life of a scene.

    The first cycles wear as much whatever the wear coefficients are, so that the
    surfaces follow one another alike, and a life is inversely proportional to the
    coefficients.
    """
    pairs = [scene.bearing(name).materials for name in scene.wearing_joints]
    coefficient = max(
        pair.wear_coefficient * max(pair.running_in, 1.0) for pair in pairs
    )
    limits = scene.life_limits
    services = life.services(scene.loose_pins)
    accuracy = life.at_most, scene.tolerance, life.max_cycles
    return LifeProblem(limits, services, *accuracy, FIRST_WEAR / coefficient)


def fewest_cycles_of(scene: Scene) -> float:
    """Return the cycles of all replicates that a life takes at least, before anything has run."""
    life = scene.life
    joints = scene.wearing_joints
    assert life is not None
    clearances = {name: scene.bearing(name).clearance for name in joints}
    return scene.replicate_count * fewest_cycles(problem_of(scene, life), clearances)


def run_life(
    runner: Runner,
    initial: Array,
    state: LifeState,
    keep: Callable[[LifeState], None],
    report: Callable[[LifeResult], None],
    announce: Callable[[float, float], None],
) -> tuple[tuple[Refinement, ...], LifeResult]:
    """Run the service life of a scene, or resume it; return its refinements as well.

    ``report`` is called with a preliminary life after each refinement that another one
    follows. ``announce`` is called once, early, with the cycles of all replicates and
    the time, s, that the life and the stages through it will still take. InputError if
    a limit is exceeded when new; RunFailed if a run fails before anything is known.
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
        if len(refinements) == 1 and len(refinements[0].blocks) == MEASURED_BLOCKS:
            left = cycles_left(problem, refinements)
            left += (scene.wear_updates + 1) * _stage_cycles(
                runner, refinements[0].blocks
            )
            last = refinements[0].blocks[-1]
            each = last.wall_s / max(last.cycles, 1)
            announce(left * scene.replicate_count, left * each)

    done = run_refinements(
        problem,
        histories.advance,
        state.refinements,
        keep_blocks,
        lambda refinements: report(preliminary_life(scene, problem, refinements)),
    )
    return done, replace(life_result(scene, problem, done), settling=histories.settling)


def _settled(
    joints: Sequence[ClearanceJoint], histories: Sequence[Array]
) -> int | None:
    """Return how many wear histories repeat at their end, from their rows of cycles."""
    settling = settling_of(joints, histories)
    return (
        None
        if settling is None or settling.verdict == "unwatched"
        else settling.settled
    )


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


def preliminary_life(
    scene: Scene, problem: LifeProblem, refinements: Refinements
) -> LifeResult:
    """Return the life of some refinements that others follow, with the state as its message."""
    life = life_result(scene, problem, refinements)
    error = "has an unknown error"
    if life.error is not None:
        error = f"has an error of {100.0 * life.error:.2g} %"
    elif life.sampling is not None:
        sampling = f"{100.0 * life.sampling:.2g} % by the scatter of the motion"
        error = f"has an error of {sampling}, and an unknown error of the wear steps"
    count = len(refinements)
    message = (
        f"refinement {count} is finished and {error}; refinement {count + 1} runs next"
    )
    return replace(life, ended="preliminary", message=message)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def life_result(
    scene: Scene, problem: LifeProblem, refinements: Refinements
) -> LifeResult:
    """Return the life as results store it."""
    last = refinements[-1]
    end = refinements[-1].blocks[-1]
    life = estimate_life(refinements, problem.limits)
    ended: Ended = "limit"
    message = ""
    if math.isinf(life.strokes):
        ended = "cycles"
        message = f"within {last.cycles} cycles of all replicates"
        if end.strokes >= problem.at_most:
            ended = "at_most"
            message = f"within {problem.at_most:.4g} strokes"
        message = f"no limit is exceeded {message}"
        if end.ended_by:
            ended = "worn"
            message = end.ended_by
    limits = []
    for limit in problem.limits:
        item = estimate_life(refinements, [limit])
        if last.crossing([limit]) == last.crossing(problem.limits):
            item = life  # here coarser refinements that another limit ended count too
        errors = _finite(item.strokes), _finite(item.sampling), _finite(item.step)
        reached = (float(values[-1]) for values in last.band(limit.key))
        limits.append(
            LimitResult(limit.key, limit.unit, limit.value, *errors, *reached)
        )
    stored = []
    for each in refinements:
        strokes = each.crossing(problem.limits)
        error = each.sampling_error(problem.limits)
        stored.append(
            RefinementResult(each.change, each.cycles, _finite(strokes), _finite(error))
        )
    curves = {"strokes": last.strokes}
    for key in (*last.blocks[0].levels, *last.blocks[0].samples):
        value, half = last.band(key)
        curves[key] = np.column_stack([value, value - half, value + half])
    # A life is inversely proportional to the wear coefficients, all of them high or low
    # together.
    joints = scene.wearing_joints
    services = problem.services[: end.interval]
    worst = max(scene.bearing(name).materials.wear_scatter for name in joints)
    scatter = quantile(math.inf) * math.sqrt(math.log1p(worst**2))
    errors = _finite(life.sampling), _finite(life.step), scatter
    words = tuple(f"{each.words} after {each.strokes:.4g} strokes" for each in services)
    strokes = life.strokes if math.isfinite(life.strokes) else end.strokes
    details = tuple(limits), tuple(stored)
    settled = tuple(block.settled for block in last.blocks if block.cycles)
    result = LifeResult(ended, message, strokes, *errors, *details, (), words, curves)
    return replace(result, settled=settled)


def unknown_life(scene: Scene, life: LifeResult) -> list[str]:
    """Return a message if a life is less accurate than requested, or unknown."""
    if life.ended != "limit":
        return [f"the life is not known: {life.message}"]
    if life.error is not None and life.error <= scene.tolerance:
        return []
    fault = "is unknown"
    if life.error is not None:
        fault = f"is {100.0 * life.error:.2g} %, above tolerance = {100.0 * scene.tolerance:.2g} %"
    return [f"the error of the life {fault}: a larger life.max_cycles is needed"]


def wear_between(
    refinements: Refinements,
    joints: Sequence[ClearanceJoint],
    initial: Array,
    since: float,
    until: float,
) -> wear_update.WearUpdate:
    """Return the wear between two numbers of strokes, interpolated between ends of blocks."""
    last = refinements[-1]
    coarser = None
    surfaces_at = _interpolated(last, initial)
    added_depth = surfaces_at(until)[1] - surfaces_at(since)[1]
    if len(refinements) > 1 and refinements[-2].strokes[-1] >= until:
        coarser_at = _interpolated(refinements[-2], initial)
        coarser = coarser_at(until)[1] - coarser_at(since)[1]
    steps = []
    at = since
    for block in last.blocks:
        end = min(block.strokes, until)
        if end <= at:
            continue
        depth, material_loss = surfaces_at(end)
        change = (material_loss - surfaces_at(at)[1]).mean(axis=0) / block.cycles
        forces = (block.samples[f"{joint.name}.force_max"].mean() for joint in joints)
        steps.append(
            WearStep(
                cycles_per_update=end - at,
                cycles=block.cycles * len(initial),
                factor=(end - at) / block.cycles,
                clearance_change=wear_update.largest_change(joints, change),
                max_depth=wear_update.by_side(joints, depth.max(axis=3).mean(axis=0)),
                peak_force=wear_update.by_joint(joints, forces),
                wall_s=block.wall_s,
            )
        )
        at = end
    return wear_update.WearUpdate(
        surfaces_at(until)[0], added_depth, tuple(steps), coarser
    )


def _interpolated(refinement: Refinement, initial: Array) -> Callable[[float], Array]:
    """Return a function of strokes: depth of the surfaces and material lost, stacked, m.

    A bushing that was replaced has lost its material all the same.
    """
    depth = np.array([initial, *(block.depth for block in refinement.blocks)])
    added_depth = np.diff(depth, axis=0, prepend=depth[:1])
    added_depth[1:][[not block.cycles for block in refinement.blocks]] = 0.0
    values = np.stack([depth, np.cumsum(added_depth, axis=0)], axis=1)
    ends = np.append(0.0, refinement.strokes)

    def at(strokes: float) -> Array:
        k = int(np.searchsorted(ends, strokes, side="right"))
        if k == len(ends):
            return np.asarray(values[-1])
        part = (strokes - ends[k - 1]) / (ends[k] - ends[k - 1])
        return np.asarray(values[k - 1] + part * (values[k] - values[k - 1]))

    return at
