"""Rows of the report on bottom dead centre: accuracy, repeatability, clearance under a load."""

import math
from collections.abc import Callable
from functools import cache

from presswear.physics.statics import heights_at_bottom, pull_of
from presswear.recording.statistics import Estimate
from presswear.results.bottom import rise
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.show.report.parts import MICRONS, MILLI, Rows, Table, Text, estimated, stage_table
from presswear.tools.errors import RunFailed
from presswear.tools.numbers import given, readable, whole

_DEGREES = 180.0 / math.pi


def bottom(result: Result, loaded: Rows[StageResult]) -> Table | None:
    """What the overview leaves of bottom dead centre; None where nothing has moved.

    Parameters
    ----------
    loaded : Rows
        Of ``under_load``.
    """
    if not any(stage.statistics.bdc for stage in result.stages):
        return None
    rows: Rows[StageResult] = {
        "standard deviation of the height (µm)": bottom_between("standard_deviation", MICRONS),
        "range of all strokes (µm)": lambda stage: readable(
            stage.statistics.bdc and MICRONS * stage.statistics.bdc.range_of_all
        ),
        **_delay(result),
        "settled strokes": lambda stage: whole(
            stage.statistics.bdc and stage.statistics.bdc.strokes
        ),
    }
    groups = {"": rows}
    # The first, the total clearance, stands at a glance.
    if at_rest := dict(list(loaded.items())[1:]):
        groups["At rest there, drives held"] = at_rest
    return stage_table(result, "bottom dead centre", groups)


def _delay(result: Result) -> Rows[StageResult]:
    """Rows of how late it is; of an ideal motion that stays there, for how long."""
    if not any(stage.statistics.bdc and stage.statistics.bdc.delay for stage in result.stages):
        return {
            "the ideal stays there, so that none is late (ms)": lambda stage: readable(
                stage.statistics.bdc and MILLI * stage.statistics.bdc.ideal_dwell
            )
        }
    phase = result.scene.mechanism.linkage().phase
    return {
        "later than the ideal (ms)": bottom_mean("delay", MILLI),
        f"the same as {phase} (degrees)": bottom_mean("delay_angle", _DEGREES),
        "standard deviation of the time (ms)": bottom_between("delay_standard_deviation", MILLI),
    }


def bottom_mean(name: str, factor: float) -> Text:
    """A mean over the settled strokes, with its interval."""
    return lambda stage: estimated(getattr(stage.statistics.bdc, name, None), factor)


def bottom_between(name: str, factor: float) -> Text:
    """A number with both ends of its interval, which is not symmetric."""

    def text(stage: StageResult) -> str:
        found: Estimate | None = getattr(stage.statistics.bdc, name, None)
        if found is None:
            return readable(None)
        found = found.scaled(factor)
        if found.low is None:
            return readable(found.mean)
        return f"{readable(found.mean)} ({readable(found.low)} to {readable(found.high)})"

    return text


def risen(stage: StageResult, first: StageResult) -> str:
    """How much higher bottom dead centre is than in another stage, µm, with its interval."""
    found = None if stage is first else rise(stage, first)
    return estimated(found, MICRONS)


def under_load(result: Result) -> Rows[StageResult]:
    """Heights under a static force either way and by weight alone, on each stage's surfaces.

    The first row is the total clearance; there is none without a joint with clearance, nor
    where that would execute source code stored in the result.
    """
    scene = result.scene
    untrusted = not all(law.is_trusted for law in scene.joint_laws.values())
    if not scene.clearance_joints or untrusted:
        return {}
    pull = pull_of(scene.linkage())

    @cache
    def heights(index: int) -> tuple[float, ...]:
        own = scene.linkage(result.stage(index).surfaces)
        try:
            return tuple(map(float, heights_at_bottom(own, (pull, -pull, 0.0))))
        except RunFailed:
            return ()

    def between(one: int, other: int) -> Callable[[StageResult], str]:
        def text(stage: StageResult) -> str:
            found = heights(stage.index)
            return readable(MICRONS * (found[one] - found[other]), 4) if found else "–"

        return text

    return {
        f"total clearance, pulled by {given(pull)} N up and down (µm)": between(0, 1),
        f"rise from rest under {given(pull)} N (µm)": between(0, 2),
    }
