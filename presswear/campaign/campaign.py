"""The outer loop: run, amplify the wear, rebuild the surfaces, run again."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.amplification import Amplification, Growth, WearStep, Worn, worn_out
from presswear.campaign.ensemble import NOTHING, Ensemble, Underway, run_ensemble
from presswear.campaign.pace import Pace, Watcher
from presswear.campaign.standing import Standing
from presswear.campaign.statistics import stage_statistics
from presswear.linkage.elements import Linkage
from presswear.record.soundness import Finding
from presswear.scene.scene import Scene, stage_name

__all__ = ["Pace", "Stage", "Watcher", "run_campaign", "run_stage"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stage:
    """One run of the outer loop, and the wear after it.

    Attributes
    ----------
    index : int
        0 unworn, 1 after the first wear, and so on.
    ensemble : Ensemble
        What ran, worn surfaces included, and how it went.
    added : ndarray, shape (joints, 2, m)
        Depth that the wear after this stage adds, bearing and pin, m: the sum of its steps.
        After the last stage no wear is applied; there it is what one more would add in one
        jump, at the rate of this stage.
    batches : ndarray, shape (n, joints, 2, m)
        Depth that one wear adds by each of n batches of the stage's cycles alone, m, with the
        mean ``added``; empty where few cycles ran.
    weights : ndarray, shape (n,)
        Cycles in each of them.
    amplification : float
        Multiplier of the depth of the cycles that the stage ran.
    steps : tuple of WearStep
        How the wear was applied; empty after the last stage.
    statistics : dict
    finding : Finding or None
        What ended the stage, or the wear after it.
    """

    index: int
    ensemble: Ensemble
    added: Array
    batches: Array
    weights: Array
    amplification: float
    steps: tuple[WearStep, ...]
    statistics: dict[str, Any]
    finding: Finding | None = None

    @property
    def linkage(self) -> Linkage:
        """What ran, worn surfaces included."""
        return self.ensemble.linkage


def stage_of(
    scene: Scene,
    index: int,
    ran: Ensemble,
    added: Array,
    steps: tuple[WearStep, ...],
    finding: Finding | None,
) -> Stage:
    """A stage with its statistics."""
    factor = Amplification.of(scene).factor(max(ran.cycles, 1))
    maps, weights = ran.batches()
    batches = scene.represented_cycles * maps
    if len(batches):
        # Of a wear in steps, the sum of steps with the scatter of the first: in all runs but
        # that one the tolerance is wider by the root of their number.
        batches += added - np.average(batches, axis=0, weights=weights)
    statistics = stage_statistics(ran.linkage, ran.recorders, added, batches, weights)
    diagnostics = ran.diagnostics()
    statistics["energy_residual_J"] = diagnostics["energy_residual_J"]
    statistics["energy_exchanged_J"] = diagnostics["drive_exchange_J"]
    if steps:
        factor = steps[0].factor
    return Stage(index, ran, added, batches, weights, factor, steps, statistics, finding)


def without_wear(scene: Scene, index: int, ran: Ensemble) -> Stage:
    """A stage after which no wear is applied; tells what one would add in one jump."""
    added = ran.depth() * scene.represented_cycles
    return stage_of(scene, index, ran, added, (), ran.finding)


def run_stage(scene: Scene, index: int, worn: Worn, watcher: Watcher) -> Stage:
    """Run one stage on given surfaces, without the wear after it."""
    pace = Pace(replace(scene, wears=index), watcher)
    pace.begin(index)
    ran = run_ensemble(scene, worn, scene.represented_cycles, scene.tolerance, pace)
    stage = without_wear(scene, index, ran)
    watcher.stage(stage)
    return stage


def growths(
    scene: Scene,
    index: int,
    ran: Ensemble,
    first: Growth,
    pace: Pace,
    begun: Underway,
    keep: Callable[[Growth, Underway], None],
) -> Iterator[tuple[Growth, Finding | None]]:
    """The wear after a stage, step by step from its first, each with what is wrong, if anything.

    Ends with the represented cycles, or with the first thing that is wrong.

    Parameters
    ----------
    first : Growth
        The first step, or as many as have been applied already.
    begun : Underway
        What has run of the next step.
    keep : callable
        Told after each cycle of those runs where they stand.
    """
    growth = first
    while True:
        gone = worn_out(ran.linkage.clearances, growth.worn)
        if gone is not None:
            where = step_name(index, growth) if len(growth.steps) > 1 else f"after stage {index}"
            joint, what = gone
            remedy = "fewer represented_cycles may help"
            yield growth, Finding("wear", f"{where} {what}", ran.time, joint, remedy)
            return
        yield growth, None
        if growth.is_complete:
            return
        # The depths of the steps add up, their errors only as the root of the sum of squares.
        steps = len(growth.steps) / (1.0 - growth.remaining / scene.represented_cycles)
        tolerance = scene.tolerance * math.sqrt(steps)
        ran = run_ensemble(
            scene, growth.worn, growth.remaining, tolerance, pace, begun, partial(keep, growth)
        )
        begun = NOTHING
        if ran.finding:
            what = f"after {step_name(index, growth)}: {ran.finding.what}"
            yield growth, replace(ran.finding, what=what)
            return
        growth = growth.after(Amplification.of(scene), ran.sample())


def step_name(index: int, growth: Growth) -> str:
    """The last step applied, and how much of its wear is applied with it."""
    part = sum(step.represented_cycles for step in growth.steps)
    return (
        f"step {len(growth.steps)} of the {stage_name(index + 1)} "
        f"({part:.3g} of {part + growth.remaining:.3g} cycles)"
    )


def run_campaign(scene: Scene, watcher: Watcher, begun: Standing | None = None) -> tuple[str, str]:
    """Run every stage; returns status (``completed`` or ``failed``) and a message.

    Each stage goes to ``watcher.stage`` as soon as the wear after it is applied, or as far
    as that came, and is not kept.

    Parameters
    ----------
    begun : Standing
        Where to go on, as ``watcher.keep`` was told; None: from the start.
    """
    pace = Pace(scene, watcher)
    at = Standing() if begun is None else begun
    pace.restore(at.pace)
    for index in range(at.index, scene.wears + 1):
        worn = at.worn
        if begun is None or pace.index != index:
            pace.begin(index)

        def keep(
            ran: Ensemble | None,
            growth: Growth | None,
            underway: Underway,
            index: int = index,
            worn: Worn = worn,
        ) -> None:
            watcher.keep(Standing(index, worn, ran, growth, underway, pace.numbers()), False)

        ran = at.ran or run_ensemble(
            scene,
            worn,
            scene.represented_cycles,
            scene.tolerance,
            pace,
            at.underway,
            partial(keep, None, None),
        )
        if ran.failure or index == scene.wears:
            watcher.stage(without_wear(scene, index, ran))
            if ran.failure:
                return "failed", f"stage {index}: {ran.failure}"
            return "completed", ""
        amplification = Amplification.of(scene)
        first = at.growth or Growth.begin(amplification, worn).after(amplification, ran.sample())
        growth: Growth = first
        finding: Finding | None = None
        # What is underway is of the stage itself before its wear has begun.
        underway = NOTHING if at.ran is None else at.underway
        try:
            for reached in growths(scene, index, ran, first, pace, underway, partial(keep, ran)):
                growth, finding = reached
        finally:
            # The stage ran to its end, even where somebody stops the wear after it.
            watcher.stage(stage_of(scene, index, ran, growth.added, growth.steps, finding))
        if finding:
            return "failed", finding.words
        at = Standing(index + 1, growth.worn, pace=pace.numbers())
        watcher.keep(at, True)
    return "completed", ""
