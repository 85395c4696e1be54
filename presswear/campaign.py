"""The outer loop: run, amplify the wear, rebuild the surfaces, run again."""

import math
import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.amplification import Growth, Sample, WearStep, Worn, fastest_change, worn_out
from presswear.engines import engine_for
from presswear.engines.base import Plan, Run
from presswear.linkage import Linkage
from presswear.observe import CYCLE_FIXED, CYCLE_JOINT, Account
from presswear.sampling import STARTUP_CYCLES
from presswear.scene import Scene, stage_name
from presswear.starts import start_of
from presswear.statistics import stage_statistics

Array = NDArray[np.float64]

LEAST_CYCLES = STARTUP_CYCLES + 8
"""Cycles before a run may end because its wear maps are known: fewer samples agree by luck."""


@dataclass(frozen=True)
class Stage:
    """One run of the outer loop, and the wear after it.

    Attributes
    ----------
    index : int
        0 unworn, 1 after the first wear, and so on.
    linkage : Linkage
        What ran, worn surfaces included.
    run : Run
    added : ndarray, shape (joints, 2, m)
        Depth that the wear after this stage adds, bearing and pin, m: the sum of its steps.
        After the last stage no wear is applied; there it is what one more would add in one
        jump, at the rate of this stage.
    batches : ndarray, shape (n, joints, 2, m)
        Depth that one wear adds by each of n batches of the stage's cycles alone, m, with the
        mean ``added``; empty where few cycles ran.
    amplification : float
        Multiplier of the depth of the cycles that the stage ran.
    steps : tuple of WearStep
        How the wear was applied; empty after the last stage.
    statistics : dict
    wall : float
        Of the stage's own run, s.
    """

    index: int
    linkage: Linkage
    run: Run
    added: Array
    batches: Array
    amplification: float
    steps: tuple[WearStep, ...]
    statistics: dict[str, Any]
    wall: float


@dataclass(frozen=True)
class Watcher:
    """Who is told what happens.

    Attributes
    ----------
    progress : callable
        Stage index, part of the stage and of the wear after it done 0 .. 1, a word on where
        it stands.
    stage : callable
        Each finished stage, the wear after it included.
    overall : callable
        Part of the whole campaign done 0 .. 1, counted in runs as far as they are foreseen.
    """

    progress: Callable[[int, float, str], None] = lambda stage, part, word: None
    stage: Callable[[Stage], None] = lambda stage: None
    overall: Callable[[float], None] = lambda part: None


@dataclass
class Pace:
    """How far a campaign is; how many runs a wear takes shows only as it goes.

    Attributes
    ----------
    index : int
        Of the stage at hand.
    earlier, done : int
        Finished runs of earlier stages, and of this one.
    expected : float
        Runs of this stage and the wear after it; infinite before anything is known.
    worn_by : float
        Runs that the last wear took, or that the present one is expected to take.
    """

    scene: Scene
    watcher: Watcher
    index: int = 0
    earlier: int = 0
    done: int = 0
    expected: float = 1.0
    worn_by: float = 1.0
    _shown: float = 0.0
    _shown_overall: float = 0.0

    def __post_init__(self) -> None:
        if math.isfinite(self.scene.amplification.limit):
            self.worn_by = math.inf

    def begin(self, index: int) -> None:
        """Another stage begins."""
        self.earlier, self.done, self.index = self.earlier + self.done, 0, index
        self.expected = self.worn_by if index < self.scene.wears else 1.0
        self._shown = 0.0

    def expect(self, steps: int) -> None:
        """The present wear will take so many more steps, that of the present run included."""
        if self.index < self.scene.wears:
            self.expected = self.worn_by = float(self.done + steps)

    def tell(self, part: float, word: str) -> None:
        """Tell the watcher of the part of the present run that is done; no part ever shrinks."""
        wears = self.scene.wears
        self._shown = max(self._shown, min((self.done + part) / self.expected, 1.0))
        later = 0.0
        if self.index < wears:
            later = 1.0 + (wears - self.index - 1) * self.worn_by
        overall = (self.earlier + self.done + part) / (self.earlier + self.expected + later)
        self._shown_overall = max(self._shown_overall, min(overall, 1.0))
        if self.done > 0 or 1.0 < self.expected < math.inf:
            step = (
                f"step {self.done + 1} of about {self.expected:.0f} of the "
                f"{stage_name(self.index + 1)}"
            )
            word = f"{step}, {word}" if word else step
        self.watcher.progress(self.index, self._shown, word)
        self.watcher.overall(self._shown_overall)


@dataclass(frozen=True)
class Ran:
    """A linkage that ran.

    Attributes
    ----------
    wall : float
        s.
    """

    linkage: Linkage
    run: Run
    wall: float

    @property
    def cycles(self) -> int:
        """Cycles finished."""
        return len(self.run.account.cycles)

    def sample(self) -> Sample:
        """What it says about wear."""
        peaks = np.max(self.run.account.cycles, axis=0, initial=0.0)[len(CYCLE_FIXED) :]
        joints = self.linkage.clearances
        return Sample(
            joints,
            max(self.cycles, 1),
            self.run.account.maps.per_cycle(),
            {joint.name: float(peaks[k * len(CYCLE_JOINT)]) for k, joint in enumerate(joints)},
            self.wall,
        )


def run_on(scene: Scene, worn: Worn, remaining: float, tolerance: float, pace: Pace) -> Ran:
    """Run the linkage on given surfaces, with some represented cycles of a wear left.

    Parameters
    ----------
    tolerance : float
        How well the wear maps must be known where the scene does not say the cycles.
    """
    began = clock.perf_counter()
    linkage = scene.linkage(worn)
    amplification = scene.amplification
    most = scene.cycles if scene.cycles is not None else scene.most_cycles
    needed = float(most)
    word = ""

    def enough(account: Account) -> bool:
        nonlocal needed, word
        done = len(account.cycles)
        if not linkage.clearances:
            return False
        rate = fastest_change(linkage.clearances, account.maps.per_cycle())
        pace.expect(amplification.steps(rate, remaining))
        if done < LEAST_CYCLES:
            return False
        error = float(account.maps.errors().max())
        word = f"cycle {done}, wear maps known to {100.0 * error:.0f} %"
        if scene.cycles is not None:
            return False
        # The error falls with the square root of the number of cycles.
        needed = min(float(most), max(done * (error / tolerance) ** 2, done + 1.0))
        return error <= tolerance

    def progress(part: float) -> None:
        pace.tell(min(part * most / needed, 1.0), word)

    plan = Plan(
        scene.mechanism.period,
        most,
        torques=scene.drive_torque == "on",
        enough=enough,
        progress=progress,
    )
    accuracy = scene.accuracy()
    run = engine_for(accuracy)(linkage, start_of(scene), accuracy, plan)
    pace.done += 1
    return Ran(linkage, run, clock.perf_counter() - began)


def stage_of(
    scene: Scene, index: int, ran: Ran, added: Array, steps: tuple[WearStep, ...]
) -> Stage:
    """A stage with its statistics."""
    run = ran.run
    factor = scene.amplification.factor(max(ran.cycles, 1))
    batches = scene.represented_cycles * run.account.maps.batches()
    if len(batches):
        # Of a wear in steps, the sum of steps with the scatter of the first: in all runs but
        # that one the tolerance is wider by the root of their number.
        batches += added - batches.mean(axis=0)
    statistics = stage_statistics(ran.linkage, run.account, added, batches) | {
        "energy_residual_J": run.diagnostics["energy_residual_J"],
        "energy_exchanged_J": run.diagnostics["drive_exchange_J"],
    }
    if steps:
        factor = steps[0].factor
    return Stage(index, ran.linkage, run, added, batches, factor, steps, statistics, ran.wall)


def without_wear(scene: Scene, index: int, ran: Ran) -> Stage:
    """A stage after which no wear is applied; tells what one would add in one jump."""
    added = ran.run.account.maps.per_cycle() * scene.represented_cycles
    return stage_of(scene, index, ran, added, ())


def run_stage(scene: Scene, index: int, worn: Worn, watcher: Watcher) -> Stage:
    """Run one stage on given surfaces, without the wear after it."""
    pace = Pace(replace(scene, wears=index), watcher)
    pace.begin(index)
    ran = run_on(scene, worn, scene.represented_cycles, scene.tolerance, pace)
    stage = without_wear(scene, index, ran)
    watcher.stage(stage)
    return stage


def growths(
    scene: Scene, index: int, ran: Ran, first: Growth, pace: Pace
) -> Iterator[tuple[Growth, str]]:
    """The wear after a stage, step by step from its first, each with what is wrong, if anything.

    Ends with the represented cycles, or with the first thing that is wrong.
    """
    growth = first
    while True:
        gone = worn_out(ran.linkage.clearances, growth.worn)
        if gone is not None:
            where = step_name(index, growth) if len(growth.steps) > 1 else f"after stage {index}"
            yield growth, f"{where} {gone}; fewer represented_cycles may help"
            return
        yield growth, ""
        if growth.is_complete:
            return
        # The depths of the steps add up, their errors only as the root of the sum of squares.
        steps = len(growth.steps) / (1.0 - growth.remaining / scene.represented_cycles)
        ran = run_on(scene, growth.worn, growth.remaining, scene.tolerance * math.sqrt(steps), pace)
        if ran.run.status == "failed":
            yield growth, f"after {step_name(index, growth)}: {ran.run.message}"
            return
        growth = growth.after(scene.amplification, ran.sample())


def step_name(index: int, growth: Growth) -> str:
    """The last step applied, and how much of its wear is applied with it."""
    part = sum(step.represented_cycles for step in growth.steps)
    return (
        f"step {len(growth.steps)} of the {stage_name(index + 1)} "
        f"({part:.3g} of {part + growth.remaining:.3g} cycles)"
    )


def run_campaign(scene: Scene, watcher: Watcher) -> tuple[str, str]:
    """Run every stage; returns status (``completed`` or ``failed``) and a message.

    Each stage goes to ``watcher.stage`` as soon as the wear after it is applied, or as far
    as that came, and is not kept.
    """
    worn: Worn = {}
    pace = Pace(scene, watcher)
    for index in range(scene.wears + 1):
        pace.begin(index)
        ran = run_on(scene, worn, scene.represented_cycles, scene.tolerance, pace)
        if ran.run.status == "failed" or index == scene.wears:
            watcher.stage(without_wear(scene, index, ran))
            if ran.run.status == "failed":
                return "failed", f"stage {index}: {ran.run.message}"
            return "completed", ""
        first = Growth.begin(scene.amplification, worn).after(scene.amplification, ran.sample())
        growth, problem = first, ""
        try:
            for reached in growths(scene, index, ran, first, pace):
                growth, problem = reached
        finally:
            # The stage ran to its end, even where somebody stops the wear after it.
            watcher.stage(stage_of(scene, index, ran, growth.added, growth.steps))
        if problem:
            return "failed", problem
        worn = growth.worn
    return "completed", ""
