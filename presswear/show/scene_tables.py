"""Tables of a report on its scene: settings, bodies, joints."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from presswear.linkage.bodies import INERTIA, MASS
from presswear.linkage.drives import Drive, LinearDrive
from presswear.linkage.joints import ends_of
from presswear.linkage.points import Attachment
from presswear.results.result import Result
from presswear.scene.catalog import base_of, named_scene
from presswear.scene.scene import Scene
from presswear.scene.setting_list import (
    DEFAULT,
    SET,
    Setting,
    settings_of,
    used_settings_of,
)
from presswear.show.page import Table
from presswear.show.tables import Record, line_table
from presswear.tools import numbers
from presswear.tools.quantities import Quantity


def setting_tables(result: Result) -> dict[str, Table]:
    """Return the tables ``parameters``, of all settings, and ``chosen``, of those the user set."""
    scene = result.scene
    before = {setting.key: setting.value for setting in settings_of(base_of(scene))}
    is_named = named_scene(scene) is not None
    records: dict[str, list[Record]] = {"parameters": [], "chosen": []}
    for setting in used_settings_of(scene):
        meaning = setting.meaning
        value = setting.value
        record: Record = {
            "setting": setting,
            "value": "none" if value is None else str(value),
        }
        if isinstance(meaning, Quantity) and isinstance(value, int | float):
            record["value"] = meaning.typeset(value)
        record["origin"] = _origin(scene, setting, before, is_named)
        records["parameters"].append(record)
        if record["origin"].startswith(SET):
            records["chosen"].append(record)
    filled = {name: lines for name, lines in records.items() if lines}
    return {name: line_table(name, result, lines) for name, lines in filled.items()}


def _origin(
    scene: Scene, setting: Setting, before: Mapping[str, Any], is_named: bool
) -> str:
    """Return the origin of a value.

    ``before`` has the values of the named scene, or the defaults, by key.
    """
    origin = scene.origins.get(setting.key, DEFAULT)
    if origin != DEFAULT:
        return origin
    if setting.key not in before or setting.value != before[setting.key]:
        return SET
    if not (is_named and isinstance(setting.meaning, Quantity)):
        return DEFAULT
    return setting.meaning.origin


def mechanism_tables(result: Result) -> dict[str, Table]:
    """Return the tables ``bodies``, with the drives, and ``pins``, of all joints and contacts."""
    scene = result.scene
    return {
        "bodies": line_table("bodies", result, _body_records(scene)),
        "pins": line_table("pins", result, _joint_records(scene)),
    }


def _body_records(scene: Scene) -> list[Record]:
    """Return the values of the bodies with those of their drives."""
    linkage = scene.base_linkage
    speeds = {drive.body: _speed_text(drive) for drive in linkage.drives}
    loose = [guide.name for guide in scene.loose_guides]
    guided = {
        guide.body
        for guide in linkage.guides
        if guide.name not in loose and not guide.is_moving
    }
    # With clearance in its guide a slide tilts, and gets an inertia.
    moving = {body.name: body for body in scene.linkage().bodies}
    start = scene.ideal.at(np.zeros(1)).position.round(9).reshape(-1, 3).tolist()
    records: list[Record] = []
    for body, position in zip(linkage.bodies, start, strict=True):
        inertia = None
        if body.name not in guided:
            inertia = INERTIA.typeset(moving[body.name].inertia)
        records.append(
            {
                "name": body.name,
                "mass": MASS.typeset(body.mass),
                "inertia": inertia,
                "start": position,
                "speed": speeds.get(body.name),
            }
        )
    return records


def _speed_text(drive: Drive) -> str:
    """Return the mean speed of a drive, or the guide along which it acts."""
    if isinstance(drive, LinearDrive):
        return f"along {drive.along}"
    text = Quantity("rad/s").typeset(drive.mean_speed)
    return f"{text}, not constant" if drive.repeats else text


def _joint_records(scene: Scene) -> list[Record]:
    """Return the values of the joints: their ends and, with clearance, their contacts."""
    linkage = scene.base_linkage
    loose = [guide.name for guide in scene.loose_guides]
    ends = {joint.name: (joint.first, joint.second) for joint in linkage.revolutes}
    titles = {}
    for guide in linkage.guides:
        ends[guide.name] = ends_of(guide)
        title = f"{guide.name}, along {math.degrees(guide.direction):.6g}°"
        if guide.is_moving:
            title += f" of {guide.on}"
        if guide.name in loose:
            title += ", each corner"
        titles[guide.name] = title
    clearances = scene.linkage().clearances
    radii = {joint.name: joint.pin_radius for joint in clearances}
    contacts = {joint.name: joint for joint in clearances}
    contacts |= {corner.guide.name: corner for corner in scene.linkage().corners}
    return [
        {
            "name": titles.get(name, name),
            "contact": contacts.get(name),
            "pin_radius": radii.get(name),
            "places": [*map(_place, points)],
        }
        for name, points in ends.items()
    ]


def _place(point: Attachment) -> str:
    """Return the body of a point and its coordinates, mm."""
    x = numbers.short_number(round(1e3 * point.x, 6) + 0.0)  # + 0.0: no -0
    y = numbers.short_number(round(1e3 * point.y, 6) + 0.0)
    return f"{point.body}: {x}, {y}"
