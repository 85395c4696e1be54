"""One linkage run from several starts: draws of a chaotic motion, put together.

Starts differ by up to 2 % of the smallest clearance.  Within a cycle or two that makes the runs
independent, which cycles of one run need not be.  Each start has worn surfaces of its own, so
that what follows a wear is independent too.  Behind a wear in one jump they run in two sets:
together on the surfaces that all their maps give, and each alone.

A set ends when its maps are known, in rounds: all its runs go so far, then the maps of all decide
whether that is enough, so that no number depends on which run was done first, where, or beside
how many others.  The first round takes FEWEST samples.  Each further one takes half of the cycles
that the error of the maps says are lacking (it falls with the square root of their number), dealt
out one by one to the starts.  Half, because that number is itself an estimate: all of it would run
past the end as often as stop short of it (so does triple sampling: Hall, Annals of Statistics 9,
1229, 1981), and a look after every cycle waits for the slowest run each time.  Of the paper's
press unworn, 4 starts, maps known to 3.5 %, 100 draws: 45.0 cycles for a true error of 3.1 %, in
3.9 looks; all that is lacking at once 55.6 cycles, a look after each cycle 44.6 cycles in 21.6
looks; one start after another, each ending when it has done its part, 46.2 cycles for 3.4 %.
"""

import logging
import math
import time as clock
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.progress import Forecast
from presswear.campaign.resolution import WORTH
from presswear.campaign.segment import Reached, Segment, Task, linkage_on
from presswear.engines.base import Run, Status
from presswear.linkage.linkage import Linkage
from presswear.recording.film import Film
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.recording.statistics import (
    LEAST_SAMPLES,
    STARTUP_CYCLES,
    MapBatches,
    map_batches,
    map_errors,
    mean_map,
)
from presswear.scene.scene import Scene
from presswear.tools.workers import Job, Workers

Array = NDArray[np.float64]

_LOG = logging.getLogger(__name__)

FEWEST = 16
"""Samples of all starts before a stage may end because its maps are known: fewer agree by luck."""
PART = 0.5
"""Part of the cycles that seem to be lacking which another round takes."""

ASIDE = -1
"""Key of the job that is done beside the runs, whose keys are their indices."""

_LARGEST = ("deepest_touch_m", "constraint_error_m", "constraint_velocity_error_m_s")
"""Diagnostics of which the largest counts, not the sum."""


@dataclass(frozen=True)
class Ensemble:
    """A linkage that ran, from one start or several.

    Attributes
    ----------
    linkage : Linkage
        On the surfaces that the scene begins on.
    worn : ndarray, shape (runs, joints, 2, m)
        Depth of the surfaces that each run began with, m.
    runs : tuple of Run
        By start, of one set or two; a failed one is the last.
    starts : int
        Runs of a set.
    wall : float
        s.
    step_errors : mapping
        What finer steps would change; see ``StepErrors``.
    """

    linkage: Linkage
    worn: Array
    runs: tuple[Run, ...]
    replicates: int
    wall: float
    step_errors: Mapping[str, float] = field(default_factory=dict)

    @property
    def together(self) -> "Ensemble":
        """The first set, which the numbers of a stage are from."""
        return self._set(slice(self.replicates))

    @property
    def alone(self) -> "Ensemble":
        """The last set, whose runs are independent: each start on surfaces of its own."""
        # Where one of them failed there are fewer runs than surfaces.
        return (
            self._set(slice(self.replicates, len(self.runs)))
            if len(self.runs) > self.replicates
            else self
        )

    def _set(self, part: slice) -> "Ensemble":
        return replace(self, worn=self.worn[part], runs=self.runs[part])

    @property
    def recorders(self) -> tuple[Recorder, ...]:
        """The recorders of the runs."""
        return tuple(run.recorder for run in self.runs)

    @property
    def cycles(self) -> int:
        """Cycles finished, of all runs."""
        return sum(len(recorder.cycles) for recorder in self.recorders)

    @property
    def failure(self) -> str:
        """Why it failed, or nothing."""
        last = self.runs[-1]
        if last.status != "failed":
            return ""
        return last.message if len(self.runs) == 1 else f"start {len(self.runs)}: {last.message}"

    @property
    def finding(self) -> Finding | None:
        """The finding that ended it, where it failed."""
        return self.runs[-1].finding

    @property
    def status(self) -> Status:
        """``failed``, ``enough`` where the maps were known early, or ``completed``."""
        if self.failure:
            return "failed"
        return "enough" if any(run.status == "enough" for run in self.runs) else "completed"

    @property
    def time(self) -> float:
        """Simulated time of all runs, s."""
        return sum(run.time for run in self.runs)

    def depth(self) -> Array:
        """Mean depth that one cycle adds, shape (joints, 2, m), m."""
        return mean_map([recorder.maps for recorder in self.recorders])

    def depths(self) -> Array:
        """The same of each start, shape (starts, joints, 2, m), m."""
        return np.array([mean_map([recorder.maps]) for recorder in self.recorders])

    def batches(self) -> tuple[Array, Array]:
        """Wear maps by batches of cycles, and the cycles in each; see ``map_batches``."""
        return map_batches([recorder.maps for recorder in self.recorders])

    def diagnostics(self) -> dict[str, float | int | str]:
        """Diagnostics of the solver: words of the first run, numbers of all."""
        found = dict(self.runs[0].diagnostics)
        for run in self.runs[1:]:
            for key, value in run.diagnostics.items():
                before = found[key]
                if isinstance(value, str) or isinstance(before, str):
                    continue
                found[key] = max(before, value) if key in _LARGEST else before + value
        # Signed residuals of several runs would cancel.
        found["energy_residual_J"] = sum(
            abs(float(run.diagnostics["energy_residual_J"])) for run in self.runs
        )
        if len(self.runs) > 1:
            found["replicates"] = len(self.runs)
        return found


@dataclass(frozen=True)
class Partial:
    """An ensemble of which some has run.

    Attributes
    ----------
    reached : tuple of Reached or None
        How far each run is; None: it has not been begun.
    until : tuple of int
        Cycles after which each ends the round at hand.
    wall : float
        So far, s.
    """

    reached: tuple[Reached | None, ...] = ()
    until: tuple[int, ...] = ()
    wall: float = 0.0


NOTHING = Partial()
"""An ensemble of which nothing has run."""


@dataclass(frozen=True)
class Runner:
    """Runs the linkage of a scene from every start.

    Attributes
    ----------
    scene : Scene
    forecast : Forecast
        Told how far it is.
    workers : Workers
        Does the runs.
    """

    scene: Scene
    forecast: Forecast
    workers: Workers

    def run(
        self,
        worn: Array,
        task: Task,
        begun: Partial = NOTHING,
        keep: Callable[[Partial], None] = lambda partial: None,
        step_errors: Job | None = None,
    ) -> Ensemble:
        """Run every start on its surfaces, in one set or two.

        A run that fails ends the rounds of its set, and all that stands behind it in order.

        Parameters
        ----------
        worn : ndarray, shape (runs, joints, 2, m)
            Depth of the surfaces of each run, m.
        begun : Partial
            What has run already.
        keep : callable
            Told what has run, whenever some more has.
        step_errors : job or None
            Finds ``Ensemble.step_errors`` beside the runs, where these are worth it.
        """
        scene = self.scene
        rounds = _Rounds(self, worn, task, begun, keep, step_errors)
        self.workers.run(rounds.jobs(), rounds.ended, rounds.told)
        runs = tuple(
            reached.run(scene, task, own)
            for reached, own in zip(rounds.reached[: rounds.last + 1], worn, strict=False)
            if reached is not None
        )
        errors = {} if runs[-1].status == "failed" else rounds.step_errors
        return Ensemble(scene.linkage(), worn, runs, scene.draws, rounds.wall, errors)


def most_runs(scene: Scene) -> int:
    """Most runs of an ensemble of a scene: behind a jump the starts run together and alone."""
    is_twice = scene.wear_updates > 0 and not scene.wears_in_steps and scene.draws > 1
    return scene.draws * (2 if is_twice else 1)


def dealt(total: int, runs: int) -> tuple[int, ...]:
    """So many cycles in all, dealt out one by one to some runs."""
    return tuple((total + runs - 1 - index) // runs for index in range(runs))


def first_round(task: Task, runs: int) -> tuple[int, ...]:
    """Cycles of each run of a set after which its maps are first looked at."""
    if task.tolerance is None:
        return (task.cycles,) * runs
    total = STARTUP_CYCLES * runs + max(FEWEST, LEAST_SAMPLES * runs)
    return tuple(min(own, task.cycles) for own in dealt(total, runs))


def lacking(task: Task, maps: Sequence[MapBatches], error: float) -> float:
    """Cycles, of all runs of a set, that maps known to an error lack; 0: they are known."""
    assert task.tolerance is not None, "nothing is lacking where nothing is asked"
    samples = sum(own.samples for own in maps)
    return max(samples * ((error / task.tolerance) ** 2 - 1.0), 0.0)


def next_round(task: Task, maps: Sequence[MapBatches], error: float) -> tuple[int, ...] | None:
    """Cycles of each run at the end of another round; None where there is none.

    Parameters
    ----------
    maps : sequence of MapBatches
        Of each run of a set.
    error : float
        Theirs, part of their rms.
    """
    run = [own.cycles for own in maps]
    more = lacking(task, maps, error)
    if more == 0.0 or min(run) >= task.cycles:
        return None
    total = sum(run) + math.ceil(PART * more)
    return tuple(min(own, task.cycles) for own in dealt(total, len(maps)))


class _Rounds:
    """The rounds of an ensemble: what is to run next, and how far it is."""

    def __init__(
        self,
        runner: Runner,
        worn: Array,
        task: Task,
        begun: Partial,
        keep: Callable[[Partial], None],
        aside: Job | None,
    ) -> None:
        scene = runner.scene
        self._runner, self._worn, self._task, self._keep = runner, worn, task, keep
        self._aside = aside
        self.step_errors: Mapping[str, float] = {}
        self.wall = begun.wall
        """Wall time until the last of the runs ended or was handed over, s."""
        self._linkages = [linkage_on(scene, own) for own in worn]
        self._began = clock.perf_counter() - begun.wall
        self._size = scene.draws
        sets = len(worn) // self._size
        first = first_round(task, self._size)
        self.reached = list(begun.reached) or [None] * len(worn)
        self._until = list(begun.until) or [*first * sets]
        self._done = [0.0 if own is None else float(own.cycles) for own in self.reached]
        # Most often the first round is enough; whether it is shows behind it.
        self._needed, self._known = [float(max(self._until))] * sets, [""] * sets
        self._waits = False  # for the compiler

    @property
    def last(self) -> int:
        """Index of the last run that counts: the first that failed."""
        failed = (k for k, own in enumerate(self.reached) if own and own.status == "failed")
        return next(failed, len(self.reached) - 1)

    def _is_over(self, index: int) -> bool:
        """True where a run has come to the end of its round."""
        own = self.reached[index]
        if own is None or own.status is None:
            return False
        return own.status != "enough" or own.cycles >= self._until[index]

    def jobs(self) -> dict[int, Job]:
        """What there is to do at first."""
        return {**self.segments(range(len(self.reached))), **self._worth()}

    def _worth(self) -> dict[int, Job]:
        """The job that is done beside the runs, once, as soon as they are long enough for it."""
        if self._aside is None or sum(self._until) < WORTH:
            return {}
        found, self._aside = {ASIDE: self._aside}, None
        return found

    def segments(self, runs: Iterable[int]) -> dict[int, Segment]:
        """What some runs lack until the end of their round."""
        found = {}
        for index in runs:
            reached = self.reached[index]
            if index <= self.last and not self._is_over(index):
                found[index] = Segment(
                    self._runner.scene,
                    self._task,
                    self._worn[index],
                    index + self._size * self._task.number,
                    self._until[index],
                    None if reached is None else reached.state,
                    self._runner.workers.lasts,
                    self._runner.forecast.frames,
                    self._runner.forecast.near,
                )
        return found

    def ended(self, index: int, outcome: Any) -> dict[int, Job | None]:
        """Note how far a run is; gives what is to run next, None for what is not wanted."""
        if index == ASIDE:
            self.step_errors = outcome
            return {}
        reached: Reached = outcome
        self.reached[index], self._done[index] = reached, float(reached.cycles)
        self.wall = clock.perf_counter() - self._began
        following: dict[int, Job | None] = {}
        if reached.status is None:
            following |= self.segments([index])
        elif reached.status == "failed":
            following |= dict.fromkeys([*range(index + 1, len(self.reached)), ASIDE])
        else:
            following |= {**self.segments(self._decided(index // self._size)), **self._worth()}
        self._keep(Partial(tuple(self.reached), tuple(self._until), self.wall))
        return following

    def _decided(self, number: int) -> Sequence[int]:
        """The runs of a set where another round begins; none where not."""
        members = range(number * self._size, (number + 1) * self._size)
        if self._task.tolerance is None or self.last < members[-1]:
            return ()
        maps = [own.maps for own in self.reached[members.start : members.stop] if own]
        if len(maps) < len(members) or not all(map(self._is_over, members)):
            return ()
        error = float(map_errors(*map_batches(maps)).max())
        _LOG.info("wear maps known to %.2g after %d cycles", error, sum(o.cycles for o in maps))
        self._known[number] = f", wear maps known to {100.0 * error:.0f} %"
        until = next_round(self._task, maps, error)
        if until is None:
            return ()
        self._until[members.start : members.stop] = until
        run = sum(own.cycles for own in maps)
        needed = (run + lacking(self._task, maps, error)) / len(maps)
        self._needed[number] = min(max(needed, *until), self._task.cycles)
        return members

    def told(self, index: int, done: float, word: str, rows: Array | None) -> None:
        """Tell how far the runs are."""
        if math.isnan(done):
            if not self._waits:
                _LOG.info("run %d waits for the compiler", index)
            self._waits = True
            self._runner.forecast.compiling()
            return
        self._waits = False
        if index != ASIDE:
            self._done[index] = done
        number, size = max(index, 0) // self._size, self._size
        needed = np.repeat(self._needed, size)
        low, high = (
            int(end(self._done[number * size : (number + 1) * size])) for end in (min, max)
        )
        where = f"cycle {low}" if low == high else f"cycles {low} to {high}"
        if size > 1:
            where += f" of {size} starts" + (" alone" if number else "")
        parts = [part for part in (self._task.word, where + self._known[number]) if part]
        film = None
        # A window shows one of them.
        if rows is not None and all(map(self._is_over, range(index))):
            film = Film.of(rows, len(self._linkages[index].clearances))
        self._runner.forecast.tell(
            float(np.minimum(self._done, needed).sum()) / size,
            float(needed.sum()) / size,
            ", ".join(parts),
            self._linkages[index],
            film,
        )
