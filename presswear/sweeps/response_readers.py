"""Functions that read responses from a result, a stage and a joint of it.

The stage is None for a response of the whole result, the joint for one of a stage.
"""

import math
from collections.abc import Callable
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from presswear.linkage.surface import SIDES
from presswear.physics.statics import total_clearance
from presswear.physics.wear import worn_volume
from presswear.recording.statistics import Estimate
from presswear.recording.statistics.estimate import greatest
from presswear.results.bottom_dead_centre import rise
from presswear.results.joint_result import JointResult
from presswear.results.motor_load import leader_speed
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.results.stage_statistics import JointStatistics
from presswear.scene.scene import Scene


class Response(NamedTuple):
    """Value of a response."""

    value: float | None
    half_width: float | None = None  # half width of its 95 % interval
    censored: bool = False  # whether the value is a lower bound


def response_of(estimate: Estimate | None) -> Response | None:
    """Return an estimate as a response."""
    return None if estimate is None else Response(estimate.mean, estimate.half_width)


def _earlier(result: Result, stage: StageResult, joint: str) -> list[JointStatistics]:
    """Return the statistics of a joint in the stages before a stage."""
    stages = [before for before in result.stages if before.index < stage.index]
    statistics = [before.joints[joint].stored for before in stages]
    return [stored for stored in statistics if stored is not None]


def depth(result: Result, stage: StageResult, joint: JointResult) -> Response:
    """Return the largest depth; its interval is available after a single wear update."""
    value, side = max((float(joint.depth(side).max()), side) for side in SIDES)
    earlier = _earlier(result, stage, joint.name)
    if len(earlier) != 1 or result.scene.surfaces or side not in earlier[0].wear_peaks:
        return Response(value)
    return Response(value, earlier[0].wear_peaks[side].depth.half_width)


def worn_volume_of(result: Result, stage: StageResult, joint: JointResult) -> Response:
    """Return the worn volume; the errors of wear updates are independent."""
    clearances = {pin.name: pin for pin in result.scene.linkage().clearances}
    depths = np.array([joint.depth(side) for side in SIDES])
    value = worn_volume(clearances[joint.name], depths)
    updates = _earlier(result, stage, joint.name)
    half_widths = [update.wear_volume.half_width for update in updates]
    errors = [half_width for half_width in half_widths if half_width is not None]
    if not updates or len(errors) < len(updates):
        return Response(value)
    return Response(value, math.hypot(*errors))


def wear_rate(
    result: Result, stage: StageResult, joint: JointResult
) -> Response | None:
    """Return the volume that bearing and pin lose in a stroke."""
    if joint.stored is None:
        return None
    return response_of(joint.stored.wear_volume.scaled(1.0 / stage.cycles_per_update))


def bdc_drift(result: Result, stage: StageResult, joint: None) -> Response | None:
    """Return the change of the mean height of bottom dead centre from the unworn stage."""
    change = rise(stage, result.stages[0])
    return Response(0.0, 0.0) if change and stage.index == 0 else response_of(change)


def clearance(result: Result, stage: StageResult, joint: None) -> Response:
    """Return the total clearance of the worn linkage."""
    return Response(total_clearance(result.scene.linkage(stage.surfaces)))


def of_speed(name: str, factor: float = 1.0) -> Callable[..., Response | None]:
    """Return the function that reads a number of the first motor's speed."""

    def read(result: Result, stage: StageResult, joint: None) -> Response | None:
        speed = leader_speed(result.scene, stage)
        estimate: Estimate | None = None if speed is None else getattr(speed, name)
        return response_of(None if estimate is None else estimate.scaled(factor))

    return read


def greatest_of(
    loads: Callable[[Scene, StageResult], Any], name: str
) -> Callable[..., Response | None]:
    """Return the function that reads the greatest number of the motors, or of the frames."""

    def read(result: Result, stage: StageResult, joint: None) -> Response | None:
        each = (getattr(load, name) for load in loads(result.scene, stage).values())
        return response_of(greatest(filter(None, each)))

    return read


def wall_wear(result: Result, stage: StageResult, joint: None) -> Response | None:
    """Return the greatest depth of wear of a cycle on a wall of a guide."""
    sides = (walls.values() for walls in stage.statistics.walls.values())
    depths = (wall.depth_per_cycle for wall in chain.from_iterable(sides))
    return response_of(greatest(depths))


def settled_share(result: Result, stage: StageResult, joint: None) -> Response | None:
    """Return the share of the runs whose cycle repeats."""
    settling = stage.statistics.settling
    return None if settling is None else Response(settling.settled / settling.runs)


def service_life(result: Result, stage: None, joint: None) -> Response | None:
    """Return the service life; a life that no limit ended is a lower bound."""
    life = result.life
    if life is None:
        return None
    return Response(life.strokes, life.interval.half_width, censored=life.first is None)


def at_path(path: str) -> Callable[..., Response | None]:
    """Return the function that reads an estimate at a path of attributes of a joint or a stage."""

    def read(
        result: Result, stage: StageResult, joint: JointResult | None
    ) -> Response | None:
        value: Any = joint or stage
        for name in path.split("."):
            value = value and getattr(value, name)
        return response_of(value)

    return read


def mean_of(name: str) -> Callable[..., Response | None]:
    """Return the function that reads the mean of a recorded number over cycles."""

    def read(
        result: Result, stage: StageResult, joint: JointResult | None
    ) -> Response | None:
        statistics = joint.stored if joint else stage.statistics
        return response_of(statistics.means.get(name) if statistics else None)

    return read
