"""Functions that read responses from a result, a stage and a joint of it."""

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


class Place(NamedTuple):
    """Result, stage and joint that a response is read from."""

    result: Result
    stage: Any = None  # StageResult; None: a response of the whole result
    joint: Any = None  # JointResult; None: a response of the whole stage


Reader = Callable[[Place], Estimate | Response | None]


def _earlier_statistics(place: Place) -> list[JointStatistics]:
    """Return the statistics of the joint in the stages before the stage."""
    stages = place.result.stages[: place.stage.index]
    statistics = [stage.statistics.joints.get(place.joint.name) for stage in stages]
    return [joint for joint in statistics if joint is not None]


def depth(place: Place) -> Response:
    """Return the largest depth; its interval is available after a single wear update."""
    value, side = max((float(place.joint.depth(side).max()), side) for side in SIDES)
    earlier = _earlier_statistics(place)
    if len(earlier) != 1 or place.result.scene.surfaces:
        return Response(value)
    peak = earlier[0].wear_peaks.get(side)
    return Response(value, peak.depth.half_width if peak else None)


def worn_volume_of(place: Place) -> Response:
    """Return the worn volume; the errors of wear updates are independent."""
    joint = place.joint
    clearances = {pin.name: pin for pin in place.result.scene.linkage().clearances}
    depths = np.array([joint.depth(side) for side in SIDES])
    value = worn_volume(clearances[joint.name], depths)
    updates = _earlier_statistics(place)
    half_widths = [update.wear_volume.half_width for update in updates]
    errors = [half_width for half_width in half_widths if half_width is not None]
    if not updates or len(errors) < len(updates):
        return Response(value)
    return Response(value, math.hypot(*errors))


def wear_rate(place: Place) -> Estimate | None:
    """Return the volume that bearing and pin lose in a stroke."""
    stored = place.joint.stored
    return stored and stored.wear_volume.scaled(1.0 / place.stage.cycles_per_update)


def bdc_drift(place: Place) -> Estimate | Response | None:
    """Return the change of the mean height of bottom dead centre from the unworn stage."""
    change = rise(place.stage, place.result.stages[0])
    if change is not None and place.stage.index == 0:
        return Response(0.0, 0.0)
    return change


def clearance(place: Place) -> Response:
    """Return the total clearance of the worn linkage."""
    linkage = place.result.scene.linkage(place.stage.surfaces)
    return Response(total_clearance(linkage))


def stroke_rate(place: Place) -> Estimate | None:
    """Return the strokes in a minute with a motor."""
    speed = leader_speed(place.result.scene, place.stage)
    return speed.stroke_rate.scaled(60.0) if speed else None


def speed_drop(place: Place) -> Estimate | None:
    """Return the drop of the speed of the first motor."""
    speed = leader_speed(place.result.scene, place.stage)
    return speed.drop if speed else None


def greatest_of(loads: Callable[[Scene, StageResult], Any], name: str) -> Reader:
    """Return the function that reads the greatest number of the motors, or of the frames."""

    def read(place: Place) -> Estimate | None:
        by_body = loads(place.result.scene, place.stage)
        estimates = [getattr(load, name) for load in by_body.values()]
        return greatest(filter(None, estimates))

    return read


def wall_wear(place: Place) -> Estimate | None:
    """Return the greatest depth of wear of a cycle on a wall of a guide."""
    sides = (walls.values() for walls in place.stage.statistics.walls.values())
    return greatest(wall.depth_per_cycle for wall in chain.from_iterable(sides))


def settled_share(place: Place) -> Response | None:
    """Return the share of the runs whose cycle repeats."""
    settling = place.stage.statistics.settling
    return settling and Response(settling.settled / settling.runs)


def service_life(place: Place) -> Response | None:
    """Return the service life; a life that no limit ended is a lower bound."""
    life = place.result.life
    if life is None:
        return None
    return Response(life.strokes, life.interval.half_width, censored=life.first is None)


def at_path(path: str) -> Reader:
    """Return the function that reads an estimate at a path of attributes of a joint or a stage."""

    def read(place: Place) -> Estimate | None:
        value: Any = place.joint or place.stage
        for name in path.split("."):
            value = value and getattr(value, name)
        return value

    return read


def mean_of(name: str) -> Reader:
    """Return the function that reads the mean of a recorded number over cycles."""

    def read(place: Place) -> Estimate | None:
        statistics = place.joint.stored if place.joint else place.stage.statistics
        return statistics and statistics.means.get(name)

    return read
