"""Numbers of a result that a sweep measures, by name.

``A.force_max`` is that of joint A in the last stage, ``A.force_max@0`` in the unworn one.
"""

import inspect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from presswear.physics.statics import total_clearance
from presswear.physics.wear import worn_volume
from presswear.recording.statistics import Estimate
from presswear.results.bottom import rise
from presswear.results.result import Result
from presswear.results.stage import SIDES, JointResult, JointStatistics, StageResult
from presswear.scene.life import FOLLOWED
from presswear.scene.scene import Scene
from presswear.sweeps.table import Column
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import digest


class Found(NamedTuple):
    """A number that was measured.

    Attributes
    ----------
    value : float
    half : float
        Half width of its 95 % interval; NaN where the result tells none.
    is_beyond : bool
        True where it is a lower bound only.
    """

    value: float
    half: float = math.nan
    is_beyond: bool = False


LAST = "last"
"""Stage of a key, for the last one."""
Own = Callable[[Result], float]
"""A measure of one's own; pickled it goes to the processes that run."""
OfJoint = Callable[[Result, StageResult, JointResult], Found | None]
OfStage = Callable[[Result, StageResult], Found | None]
OfResult = Callable[[Result], Found | None]


@dataclass(frozen=True)
class Measure:
    """A number of a result, of each joint, of each stage, or of the whole.

    Attributes
    ----------
    unit, text : str
    joint, stage, whole : callable or None
        What finds it, None where it is not known; one of them.
    is_dear : bool
        True where it is found only if it is asked for.
    """

    unit: str
    text: str
    joint: OfJoint | None = None
    stage: OfStage | None = None
    whole: OfResult | None = None
    is_dear: bool = False


def _estimate(estimate: Estimate | None) -> Found | None:
    """A mean over cycles, or another number with its interval."""
    if estimate is None:
        return None
    half = estimate.half_width
    return Found(estimate.mean, math.nan if half is None else half)


def _before(result: Result, stage: StageResult, joint: JointResult) -> list[JointStatistics]:
    """Statistics of a joint in the stages behind each of which a wear led to this one."""
    before = [own.joints[joint.name].stored for own in result.stages if own.index < stage.index]
    return [own for own in before if own is not None]


def _depth(result: Result, stage: StageResult, joint: JointResult) -> Found:
    """The deepest place; its interval is known where one wear made it."""
    value, side = max((float(joint.depth(own).max()), own) for own in SIDES)
    before = _before(result, stage, joint)
    if len(before) != 1 or result.scene.surfaces or side not in before[0].wear_peaks:
        return Found(value)
    half = before[0].wear_peaks[side].depth.half_width
    return Found(value, math.nan if half is None else half)


def _volume(result: Result, stage: StageResult, joint: JointResult) -> Found:
    """The volume; errors of one wear after another as independent."""
    geometry = next(own for own in result.scene.linkage().clearances if own.name == joint.name)
    value = worn_volume(geometry, np.array([joint.depth(own) for own in SIDES]))
    halves = [own.wear_volume.half_width for own in _before(result, stage, joint)]
    known = [own for own in halves if own is not None]
    if not known or len(known) < len(halves):
        return Found(value)
    return Found(value, math.hypot(*known))


def _rate(result: Result, stage: StageResult, joint: JointResult) -> Found | None:
    if joint.stored is None:
        return None
    return _estimate(joint.stored.wear_volume.scaled(1.0 / result.scene.cycles_per_update))


def _drift(result: Result, stage: StageResult) -> Found | None:
    found = rise(stage, result.stages[0])
    return Found(0.0, 0.0) if found and stage.index == 0 else _estimate(found)


def _life(result: Result) -> Found | None:
    life = result.life
    if life is None:
        return None
    half = life.interval.half_width
    return Found(life.strokes, math.nan if half is None else half, life.first is None)


def _followed(name: str, **found_by: Any) -> dict[str, Measure]:
    """A number that a life follows as well, with the same unit and text."""
    return {name: Measure(FOLLOWED[name].unit, FOLLOWED[name].text, **found_by)}


MEASURES: dict[str, Measure] = {
    **_followed(
        "force_max",
        joint=lambda _, stage, joint: _estimate(joint.stored and joint.stored.peak_force_per_cycle),
    ),
    **_followed("depth", joint=_depth),
    **_followed("wear_volume", joint=_volume),
    "wear_rate": Measure("m^3", "volume that a stroke takes off bearing and pin", joint=_rate),
    "contacts": Measure(
        "",
        "contacts in a cycle",
        joint=lambda _, stage, joint: _estimate(joint.stored and joint.stored.contacts_per_cycle),
    ),
    **_followed(
        "bdc_error", stage=lambda _, own: _estimate(own.statistics.bdc and own.statistics.bdc.error)
    ),
    **_followed("bdc_drift", stage=_drift),
    **_followed(
        "repeatability",
        stage=lambda _, own: _estimate(
            own.statistics.bdc and own.statistics.bdc.standard_deviation
        ),
    ),
    **_followed(
        "total_clearance",
        stage=lambda result, own: Found(total_clearance(result.scene.linkage(own.surfaces))),
        is_dear=True,
    ),
    "drive_work": Measure(
        "J",
        "work of all drives in a cycle",
        stage=lambda _, own: _estimate(own.statistics.drive_work_per_cycle),
    ),
    "life": Measure("", "strokes until the first limit is passed", whole=_life),
}
"""What can be measured, by name."""


@dataclass(frozen=True)
class Asked:
    """The measures of a sweep.

    Attributes
    ----------
    columns : tuple of Column
    keys : tuple of str
        Under which records hold them, ``@last`` for the last stage.
    dear : tuple of str
        Names of those that are found only if they are asked for.
    own : tuple of callable
        Those of one's own.
    further : str
        Digest of what records hold beside the usual measures; nothing where that is all.
    """

    columns: tuple[Column, ...]
    keys: tuple[str, ...]
    dear: tuple[str, ...] = ()
    own: tuple[Own, ...] = ()
    further: str = ""


def measures_asked(scene: Scene, measures: Sequence[str | Own]) -> Asked:
    """The measures that are asked for; all usual ones of the last stage where none is.

    Parameters
    ----------
    scene : Scene
        Any of the sweep.
    measures : sequence of str or callable
        Names, or functions of a result that give a number.

    Raises
    ------
    InputError
        For an unknown name, joint or stage.
    """
    known = usual_names(scene)
    columns, keys, dear, own = [], [], [], []
    for one in measures or [name for name, own in known.items() if not own.is_dear]:
        if not isinstance(one, str):
            columns.append(Column(one.__name__, "", (inspect.getdoc(one) or "").partition("\n")[0]))
            keys.append(one.__name__)
            own.append(one)
            continue
        name, at, stage = one.strip().partition("@")
        if name not in known:
            raise unknown("measure", name, known)
        measure = known[name]
        if at and (measure.whole or not (stage.isascii() and stage.isdigit())):
            raise InputError(f"measure {one}: NAME or NAME@STAGE, of a stage from 0, is expected")
        if at and int(stage) > scene.wear_updates:
            raise InputError(
                f"measure {one}: allowed is a stage from 0 to wear_updates = {scene.wear_updates}"
            )
        columns.append(Column(one.strip(), measure.unit, measure.text))
        keys.append(name if measure.whole else f"{name}@{int(stage) if at else LAST}")
        if measure.is_dear and name not in dear:
            dear.append(name)
    names = [column.key for column in columns]
    for place, name in enumerate(names):
        if name in names[:place]:
            raise InputError(f"measure {name} is asked for twice")
    told = [*sorted(dear), *(f"{one.__qualname__} {_source(one)}" for one in own)]
    further = digest("\n".join(told).encode()) if told else ""
    return Asked(tuple(columns), tuple(keys), tuple(dear), tuple(own), further)


def at_last(key: str, stages: int) -> str:
    """A key with the last of some stages by its number."""
    name, at, stage = key.partition("@")
    return f"{name}@{stages - 1}" if at and stage == LAST else key


def usual_names(scene: Scene) -> dict[str, Measure]:
    """All measures of a scene by their names, joints in front."""
    found: dict[str, Measure] = {}
    for name, own in MEASURES.items():
        joints = scene.clearance_joints if own.joint else ()
        found |= {f"{joint}.{name}": own for joint in joints}
        if not own.joint and (name != "life" or scene.life is not None):
            found[name] = own
    return found


def measured(result: Result, dear: Sequence[str] = (), own: Sequence[Own] = ()) -> dict[str, Found]:
    """Numbers of a result by their keys: the usual ones, and those that are asked for.

    Raises
    ------
    InputError
        Where a measure of one's own gives no number.
    """
    found: dict[str, Found | None] = {}
    for name, measure in MEASURES.items():
        if measure.whole is not None:
            found[name] = measure.whole(result)
        if measure.is_dear and name not in dear:
            continue
        for stage in result.stages:
            if measure.stage is not None:
                found[f"{name}@{stage.index}"] = measure.stage(result, stage)
            if measure.joint is not None:
                for joint in stage.joints.values():
                    key = f"{joint.name}.{name}@{stage.index}"
                    found[key] = measure.joint(result, stage, joint)
    for function in own:
        value = function(result)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"measure {function.__name__} gives {value!r}: a number is expected")
        found[function.__name__] = Found(float(value))
    return {key: value for key, value in found.items() if value is not None}


def _source(function: Own) -> str:
    """Text of a function, by which its results are known; its name where there is none."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        return f"{function.__module__}.{function.__qualname__}"
