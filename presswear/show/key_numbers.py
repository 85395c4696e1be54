"""Key numbers of a result, with intervals and short meanings."""

import math
from collections.abc import Mapping

from presswear.recording.statistics.estimate import Estimate, key_of_greatest
from presswear.results.life import (
    QUICK,
    WITHOUT_CURVES,
    LifeResult,
    digits_of,
    span_of,
    words_of,
)
from presswear.results.motor_load import mean_period
from presswear.results.oil_film import oil_films
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.show.drive_numbers import drive_numbers
from presswear.show.figures.life import limit_text
from presswear.show.joint_numbers import explained, joint_numbers, pins_of
from presswear.show.page import KeyNumber
from presswear.show.stroke_numbers import motion_numbers, stroke_numbers
from presswear.show.wear_number import wear_per_million_strokes
from presswear.show.words import number_in_words_of
from presswear.tools import numbers

# Part of the greatest wear or force from which another joint is named as well
_CLOSE = 0.9


def key_numbers(result: Result) -> list[KeyNumber]:
    """Return the key numbers of a life, and of the last stage that did not fail, if any."""
    stages = stages_with_numbers(result)
    of_life = [] if result.life is None else [_life(result, result.life)]
    if not stages:
        return of_life
    scene = result.scene
    last = stages[-1]
    of_last = motion_numbers(scene, last)
    of_last += stroke_numbers(scene, last)
    peaks = joint_numbers(scene, stages) + drive_numbers(scene, stages)
    of_last += [explained(peak, last) for peak in peaks]
    result_numbers = of_life + _with_surfaces(of_last, result, last)
    if result.life is None:
        result_numbers += _wear(result, stages)
    improvement = _improvement(scene, last, result.life)
    result_numbers += _with_surfaces(improvement, result, last)
    return [number_in_words_of(scene, number) for number in result_numbers]


def _wear(result: Result, stages: list[StageResult]) -> list[KeyNumber]:
    """Return the wear of the last wear update whose wear is known; a jump in one step has none."""
    for stage in reversed(stages):
        if wear := wear_per_million_strokes(result.scene, stage):
            return _with_surfaces(wear, result, stage)
    return []


def _with_surfaces(
    stage_numbers: list[KeyNumber], result: Result, stage: StageResult
) -> list[KeyNumber]:
    """Return numbers of a stage with its surfaces in words, where they depend on the wear."""
    words = surfaces_of(result, stage)
    named = []
    for number in stage_numbers:
        named.append(number._replace(stage=words if number.depends_on_wear else ""))
    return named


def surfaces_of(result: Result, stage: StageResult) -> str:
    """Return the surfaces of a stage in words; empty if the run has one stage."""
    if len(result.stages) < 2:
        return ""
    if stage.index == 0:
        return "on the initial surfaces" if stage.is_worn else "on new surfaces"
    earlier = result.stages[: stage.index]
    strokes = numbers.large(sum(before.cycles_per_update for before in earlier))
    return f"after {strokes} strokes"


def stages_with_numbers(result: Result) -> list[StageResult]:
    """Return the stages that did not fail and ran far enough for a number."""
    return [
        stage for stage in result.stages if stage.statistics.output and not stage.failed
    ]


def _life(result: Result, life: LifeResult) -> KeyNumber:
    hours = numbers.readable(life.strokes * mean_period(result) / 3600.0, 2)
    first = life.first
    name = "Service life"
    if life.ended in WITHOUT_CURVES:
        name += f", {life.ended}"
    if first is None:
        value = f"more than {numbers.large(life.strokes)} strokes"
        return KeyNumber(name, value, "", f"No limit is exceeded in {hours} hours.")
    value = f"{numbers.large(life.strokes, digits=digits_of(life.total_error))} strokes"
    interval = span_of(life.strokes, life.total_error)
    meaning = (
        f"{hours} hours, until the {words_of(first.key)} exceeds {limit_text(first)}."
    )
    if life.ended == QUICK:
        meaning += " By two wear rates, without an interval."
    if interval:
        meaning += " The interval contains the scatter of the wear coefficients."
    span = interval and f"{interval} strokes"
    return KeyNumber(name, value, span, meaning, estimate=life.interval)


def _improvement(
    scene: Scene, stage: StageResult, life: LifeResult | None
) -> list[KeyNumber]:
    """Return the joint to improve first: it ends the life, wears most, or bears most load."""
    joints = pins_of(scene, stage)
    if len(joints) < 2:
        return []
    name = "Improve first"
    if life is not None and life.first is not None and "." in life.first.key:
        joint, _, _ = life.first.key.partition(".")
        text = "It ends the service life."
        return [KeyNumber(name, f"joint {joint}", "", text, depends_on_wear=False)]
    volumes = {pin: statistics.wear_volume for pin, statistics in joints.items()}
    total = sum(volume.mean for volume in volumes.values())
    if total > 0.0:
        first = _rivals(volumes)
        share = 100.0 * sum(volumes[pin].mean for pin in first) / total
        reason = (
            f"{share:.0f} % of the material that the joints lose in a stroke is there."
        )
        if len(first) == len(volumes):
            reason = "All joints lose about as much material in a stroke."
        if oil_films(scene):
            reason += " This is for dry contact; see the oil films."
    else:
        forces = {pin: joint.peak_force_per_cycle for pin, joint in joints.items()}
        first = _rivals(forces)
        reason = "The largest force is there."
    reason += " presswear improve compares changes of each joint."
    return [KeyNumber(name, f"joint {' or '.join(first)}", "", reason)]


def _rivals(values: Mapping[str, Estimate]) -> list[str]:
    """Return the names of the greatest value and of values that are hardly smaller."""
    greatest = values[key_of_greatest(values)]
    lowest = min(greatest.low or math.inf, _CLOSE * greatest.mean)
    return [
        name
        for name, value in values.items()
        if max(value.mean, value.high or 0.0) >= lowest
    ]
