"""Runner of an ensemble: the rounds in which its runs are computed, and their progress.

A set of runs is computed in rounds until the error of its wear maps is below the
tolerance. All its runs reach the end of a round before the error is computed from all
maps, so that no number depends on the order or the number of the processes. The first
round has FEWEST samples. Each further round has half of the cycles that are lacking by
the present error. This number is an estimate, and with all of them the last round would
have too many cycles as often as too few (Hall, Annals of Statistics 9, 1229, 1981).
"""

import logging
import math
import time as clock
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from presswear.campaign.ensemble import Ensemble, EnsembleState
from presswear.campaign.replicates import (
    STEP_CHECK_CYCLES,
    Part,
    RunSpec,
    RunState,
    WorkUnit,
)
from presswear.campaign.settled_motions import settling_of
from presswear.recording.columns import cycle_column
from presswear.recording.observer import COMPILING, Observer, Progress
from presswear.recording.statistics import (
    MIN_SAMPLES,
    STARTUP_CYCLES,
    map_batches,
    map_errors,
)
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.processes import Job, Workers

_LOG = logging.getLogger(__name__)

Shares = tuple[float, float]  # completed share that never falls, latest estimate

# Samples of all replicates before a stage may end early: fewer may agree by chance
FEWEST = 20
ROUND_FRACTION = 0.5  # cycles of a further round over the lacking cycles
WATCHED_CYCLES = (
    50  # cycles of a replicate after which most motions that settle have settled
)
WATCHED_SECONDS = 10.0  # largest computing time of these cycles of all replicates, s
MAX_SHARE = 0.99  # largest share of a stage before its end: another round may follow
# Key of the step check among the jobs; the other keys are indices of runs
STEP_CHECK = -1


@dataclass
class Runner:
    """Runs the linkage of a scene from every replicate, and reports the progress.

    Progress counts the cycles of each replicate in a stage and the wear update after
    it.
    """

    scene: Scene
    workers: Workers = field(default_factory=Workers)
    observers: Sequence[Observer] = ()
    # number of the present stage; None: the service life before the stages
    index: int | None = None
    done: float = 0.0  # cycles of the ensembles before the present one
    later: float = 0.0  # expected cycles of the ensembles after it
    reported: float = 0.0  # largest number of cycles that was reported
    before: float = 0.0  # cycles of each run in the last stage
    shares: Shares = (0.0, 0.0)  # completed share of the stage
    life: Shares = (0.0, 0.0)  # share of the campaign that the service life took

    def start_stage(self, index: int) -> None:
        """Start the progress of another stage."""
        self.life = self.shares if self.index is None else self.life
        self.index = index
        self.shares = (0.0, 0.0)
        self.done = 0.0
        self.later = 0.0
        self.reported = 0.0

    def count_as(self, cost: float, later: float) -> None:
        """Count each completed cycle as ``cost`` cycles, and expect ``later`` further cycles."""
        self.done *= cost
        self.reported *= cost
        self.later = later

    def run(
        self,
        depth: Array,
        spec: RunSpec,
        state: EnsembleState | None = None,
        keep: Callable[[EnsembleState], None] = lambda state: None,
        step_check: Job | None = None,
    ) -> Ensemble:
        """Run every replicate on its surfaces, m, in one set or two, or resume from a state.

        A run that fails ends the rounds of its set, and all runs after it in order. The
        step check runs beside the others, if these are long enough. The state is kept
        whenever it changes.
        """
        rounds = _Rounds(self, depth, spec, state or EnsembleState(), keep, step_check)
        jobs = {**rounds.units(range(len(depth))), **rounds.check()}
        self.workers.run(jobs, rounds.on_end, rounds.on_report)
        ensemble = Ensemble.of(self.scene, spec, depth, rounds.state)
        self.done += ensemble.state.cycles / self.scene.replicate_count
        return ensemble

    def report(self, completed: float, total: float, word: str) -> None:
        """Report the completed cycles of each replicate, of the total of the ensemble.

        Each cycle completes an equal part of the remaining progress, so that the progress
        never falls.
        """
        done = self.done + completed
        left = total - completed + self.later
        step = max(done - self.reported, 0.0)
        self.reported = max(done, self.reported)
        shown = self.shares[0]
        if step > 0.0:
            shown = min(shown + (1.0 - shown) * step / (step + left), MAX_SHARE)
        self.shares = shown, done / (done + left)
        of_campaign = list(self.shares)
        if self.index is not None:
            stages = self.scene.wear_updates + 1
            for k, (life, share) in enumerate(zip(self.life, self.shares, strict=True)):
                of_campaign[k] = life + (1.0 - life) * (self.index + share) / stages
        progress = Progress(
            self.index or 0, shown, of_campaign[0], word, of_campaign[1]
        )
        for observer in self.observers:
            observer.on_progress(progress)


@dataclass
class _Rounds:
    """Rounds of an ensemble: the next jobs, and the progress."""

    runner: Runner
    depth: Array
    spec: RunSpec
    state: EnsembleState
    keep: Callable[[EnsembleState], None]
    step_check: Job | None

    def __post_init__(self) -> None:
        self._started = clock.perf_counter() - self.state.wall
        self._size = self.runner.scene.replicate_count
        sets = len(self.depth) // self._size
        until = (self.spec.cycles,) * self._size
        before = 0.0
        if self.spec.tolerance is not None:
            fewest = max(FEWEST, MIN_SAMPLES * self._size)
            until = self._deal(STARTUP_CYCLES * self._size + fewest)
            # As many as in the stage before, or the first round, is most often enough.
            before = self.runner.before
        runs = self.state.runs or (None,) * len(self.depth)
        until = self.state.until or until * sets
        self.state = replace(self.state, runs=runs, until=until)
        self._done = [0.0] * len(runs)
        for k, run in enumerate(runs):
            if run is not None:
                self._done[k] = float(run.cycles)
        self._needed = [max(float(max(until)), before)] * sets

    def _deal(self, total: int) -> tuple[int, ...]:
        """Return cycles for the runs of a set, with a total, as equal as possible."""
        size = self._size
        shares = [(total + size - 1 - k) // size for k in range(size)]
        return tuple(min(cycles, self.spec.cycles) for cycles in shares)

    def _last(self) -> int:
        """Return the index of the last run that counts: the first that failed."""
        runs = self.state.runs
        failed = (k for k, run in enumerate(runs) if run and run.status == "failed")
        return next(failed, len(runs) - 1)

    def _is_over(self, index: int) -> bool:
        run = self.state.runs[index]
        if run is None or run.status is None:
            return False
        return run.status != "enough" or run.cycles >= self.state.until[index]

    def check(self) -> dict[int, Job]:
        """Start the step check once the runs are long enough."""
        if self.step_check is None or sum(self.state.until) < STEP_CHECK_CYCLES:
            return {}
        job = self.step_check
        self.step_check = None
        return {STEP_CHECK: job}

    def units(self, indices: Iterable[int]) -> dict[int, Job]:
        """Return the work units of runs that are not at the end of their round."""
        runner = self.runner
        last = self._last()
        observers = [
            observer for observer in runner.observers if observer.observes_runs
        ]
        units: dict[int, Job] = {}
        for k in indices:
            if k > last or self._is_over(k):
                continue
            run = self.state.runs[k]
            arrays = None if run is None else run.arrays
            number = k + self._size * self.spec.number
            units[k] = WorkUnit(
                runner.scene,
                self.spec,
                Part(self.depth[k], number, self.state.until[k], arrays),
                runner.workers.job_duration,
                tuple(observers),
            )
        return units

    def on_end(self, key: int, outcome: Any) -> dict[int, Job | None]:
        """Store the outcome of a job; return the next jobs, None for those not needed any more."""
        if key == STEP_CHECK:
            self.state = replace(self.state, step_errors=outcome)
            return {}
        ended: RunState = outcome
        runs = [*self.state.runs]
        runs[key] = ended
        wall = clock.perf_counter() - self._started
        self.state = replace(self.state, runs=tuple(runs), wall=wall)
        self._done[key] = float(ended.cycles)
        following: dict[int, Job | None] = {}
        if ended.status is None:
            following |= self.units([key])
        elif ended.status == "failed":
            following |= dict.fromkeys(
                [*range(self._last() + 1, len(runs)), STEP_CHECK]
            )
        else:
            following |= self.units(self._next_round(key // self._size))
            following |= self.check()
        self.keep(self.state)
        return following

    def _next_round(self, number: int) -> Sequence[int]:
        """Return the runs of a set if another round of it starts."""
        spec = self.spec
        members = range(number * self._size, (number + 1) * self._size)
        if spec.tolerance is None or self._last() < members[-1]:
            return ()
        if not all(map(self._is_over, members)):
            return ()
        maps = [
            run.maps for run in self.state.runs[members.start : members.stop] if run
        ]
        error = float(map_errors(*map_batches(maps)).max())
        cycles = [run.cycles for run in maps]
        _LOG.info("wear maps known to %.2g after %d cycles", error, sum(cycles))
        samples = sum(run.samples for run in maps)
        lacking = max(samples * ((error / spec.tolerance) ** 2 - 1.0), 0.0)
        unseen = self._unseen(members)
        if max(lacking, unseen) == 0.0 or min(cycles) >= spec.cycles:
            return ()
        until = [*self.state.until]
        more = max(math.ceil(ROUND_FRACTION * lacking), unseen)
        dealt = self._deal(sum(cycles) + more)
        until[members.start : members.stop] = dealt
        self.state = replace(self.state, until=tuple(until))
        needed = (sum(cycles) + lacking) / len(maps)
        self._needed[number] = min(max(needed, *dealt), spec.cycles)
        return members

    def _unseen(self, members: range) -> int:
        """Return the cycles that the runs of a set lack to show whether the motion settles.

        Each run needs WATCHED_CYCLES, or as many as WATCHED_SECONDS allow. If only some
        runs have settled by then, the number of cycles is doubled.
        """
        rows = [
            run.arrays["recorder/cycles"]
            for run in self.state.runs[members.start : members.stop]
            if run
        ]
        cycles = sum(map(len, rows))
        steps = sum(float(numbers[:, cycle_column("steps")].sum()) for numbers in rows)
        solver = self.runner.scene.solver
        is_worn = self.depth[members.start].any()
        step_time = solver.worn_step_time if is_worn else solver.step_time
        seconds = step_time * steps / cycles
        affordable = int(WATCHED_SECONDS / (seconds * self._size))
        watched = self._size * min(WATCHED_CYCLES, affordable)
        if cycles < watched:
            return watched - cycles
        settling = settling_of(self.runner.scene.linkage().clearances, rows)
        is_mixed = settling is not None and settling.verdict == "mixed"
        return cycles if is_mixed else 0

    def on_report(self, index: int, done: float, *_: Any) -> None:
        """Report the progress of the runs."""
        is_compiling = math.isnan(done)
        if index != STEP_CHECK and not is_compiling:
            self._done[index] = done
        needed = np.repeat(self._needed, self._size)
        cycle = f"cycle {int(min(self._done))} of {math.ceil(max(self._needed))}"
        word = COMPILING if is_compiling else self.spec.label or cycle
        completed = float(sum(np.minimum(self._done, needed))) / self._size
        self.runner.report(completed, float(sum(needed)) / self._size, word)
