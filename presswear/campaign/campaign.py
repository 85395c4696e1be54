"""The outer loop: run, amplify the wear, rebuild the surfaces, run again."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

from presswear.campaign.amplification import Amplification, Growth, Worn, worn_out
from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.ensemble import NOTHING, Ensemble, Partial, run_ensemble
from presswear.campaign.progress import Forecast
from presswear.campaign.stage import stage_of, without_wear
from presswear.record.soundness import Finding
from presswear.record.tracker import Tracker
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene, stage_name


def run_stage(
    scene: Scene, index: int, worn: Worn, trackers: Sequence[Tracker] = ()
) -> tuple[StageResult, Ensemble]:
    """Run one stage on given surfaces, without the wear after it; gives its runs as well."""
    forecast = Forecast(replace(scene, wears=index), trackers)
    forecast.begin(index)
    ran = run_ensemble(scene, worn, scene.represented_cycles, scene.tolerance, forecast)
    stage = without_wear(scene, index, ran)
    for tracker in trackers:
        tracker.stage(stage)
    return stage, ran


def growths(
    scene: Scene,
    index: int,
    ran: Ensemble,
    first: Growth,
    forecast: Forecast,
    begun: Partial,
    keep: Callable[[Growth, Partial], None],
) -> Iterator[tuple[Growth, Finding | None]]:
    """Apply the wear after a stage step by step; yields each step with what is wrong, if anything.

    Ends with the represented cycles, or with the first thing that is wrong.

    Parameters
    ----------
    first : Growth
        The first step, or as many as have been applied already.
    begun : Partial
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
            scene,
            growth.worn,
            growth.remaining,
            tolerance,
            forecast,
            begun,
            partial(keep, growth),
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


def run_campaign(
    scene: Scene, trackers: Sequence[Tracker], begun: Checkpoint | None = None
) -> tuple[str, str, Finding | None]:
    """Run every stage; returns status (``completed`` or ``failed``), a message and the finding.

    Trackers hear of each stage as soon as the wear after it is applied, or as far as that came.

    Parameters
    ----------
    begun : Checkpoint
        Where to go on, as trackers were told; None: from the start.
    """
    forecast = Forecast(scene, trackers)
    at = Checkpoint() if begun is None else begun
    forecast.restore(at.forecast)

    def tell(checkpoint: Checkpoint, is_stage: bool = False) -> None:
        for tracker in trackers:
            tracker.checkpoint(checkpoint, is_stage)

    def finish(stage: StageResult) -> None:
        for tracker in trackers:
            tracker.stage(stage)

    for index in range(at.index, scene.wears + 1):
        worn = at.worn
        if begun is None or forecast.index != index:
            forecast.begin(index)

        def keep(
            ran: Ensemble | None,
            growth: Growth | None,
            running: Partial,
            index: int = index,
            worn: Worn = worn,
        ) -> None:
            tell(Checkpoint(index, worn, ran, growth, running, forecast.numbers()))

        ran = at.ran or run_ensemble(
            scene,
            worn,
            scene.represented_cycles,
            scene.tolerance,
            forecast,
            at.partial,
            partial(keep, None, None),
        )
        if ran.failure or index == scene.wears:
            finish(without_wear(scene, index, ran))
            if ran.failure:
                return "failed", f"stage {index}: {ran.failure}", ran.finding
            return "completed", "", None
        amplification = Amplification.of(scene)
        first = at.growth or Growth.begin(amplification, worn).after(amplification, ran.sample())
        growth: Growth = first
        finding: Finding | None = None
        # What has run in part is of the stage itself before its wear has begun.
        running = NOTHING if at.ran is None else at.partial
        try:
            for reached in growths(scene, index, ran, first, forecast, running, partial(keep, ran)):
                growth, finding = reached
        finally:
            # The stage ran to its end, even where somebody stops the wear after it.
            finish(stage_of(scene, index, ran, growth.added, growth.steps, finding))
        if finding:
            return "failed", finding.words, finding
        at = Checkpoint(index + 1, growth.worn, forecast=forecast.numbers())
        tell(at, is_stage=True)
    return "completed", "", None
