"""Shapes that the arrays of a stored result may have, by its scene.

A result may come from anybody: what does not fit its scene is refused.
"""

import math
from itertools import product

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import WALL_BINS, WALLS, GuideCorner
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import SIDES
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.columns import (
    JOINT_ARRAYS,
    SECTION_JOINT_NAMES,
    cycle_columns,
)
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Arrays
from presswear.tools.errors import InputError

# Largest arrays of a stage: 4 million rows of the series with 8 joints have 2.2 GB
MAX_BYTES = 4_000_000_000


# Shape of an array. Lengths with the same name are equal.
Shape = tuple[str | int, ...]


def check_stage(arrays: Arrays, scene: Scene, linkage: Linkage) -> None:
    """Raise InputError for an array of a stage that is missing or has another shape."""
    if linkage.leader is not None:
        _require(arrays, "clock", "nominal_rate")
    shapes = _shapes_of_stage(scene, linkage)
    for joint in linkage.clearances:
        shapes |= _shapes_of_joint(joint)
        if isinstance(joint, GuideCorner):
            continue
        for name, side in product(("depth", "wear"), SIDES):
            shapes[f"{joint.name}_{name}_{side}"] = (joint.bins,)
            _require(arrays, f"{joint.name}_{name}_{side}")
    for guide in linkage.worn_guides:
        shapes[f"{guide.name}_wall_place"] = (WALL_BINS,)
        for name in ("depth", "wear"):
            shapes[f"{guide.name}_wall_{name}"] = (len(WALLS), WALL_BINS)
            _require(arrays, f"{guide.name}_wall_{name}")
    check_shapes(arrays, shapes)


def _shapes_of_stage(scene: Scene, linkage: Linkage) -> dict[str, Shape]:
    """Return the shapes of the arrays of a stage that are not of one joint, by name."""
    drives = len(linkage.drives)
    section_columns = 2 + len(SECTION_JOINT_NAMES) * len(linkage.clearances)
    cycle_column_count = cycle_columns(
        len(linkage.clearances),
        drives,
        linkage.leader is not None,
        len(linkage.oiled_joints),
    )
    return {
        "time": ("time",),
        "clock": ("time",),
        "nominal_rate": ("time",),
        "slider": ("time", 3),
        "drive_torque": ("time", drives),
        "drive_angle": ("time", drives),
        "drive_speed": ("time", drives),
        "stretch": ("time", len(linkage.elastic_guides)),
        "pin_stretch": ("time", len(linkage.elastic_pins)),
        "cycles": ("cycles", cycle_column_count),
        "cycle_start": ("cycles",),
        "sections": ("sections", scene.recording.sections, section_columns),
        "deviation": ("deviation", 4),
        "deviation_start": ("deviation",),
        "wear_batch_cycles": ("wear_batch_cycles",),
    }


def _shapes_of_joint(joint: ClearanceJoint) -> dict[str, Shape]:
    """Return the shapes of the arrays of a joint with clearance, by their stored names."""
    shapes: dict[str, Shape] = {}
    for name, columns in JOINT_ARRAYS.items():
        shapes[name] = ("time", len(columns)) if len(columns) > 1 else ("time",)
    shapes["contacts"] = (f"contacts of {joint.name}", len(CONTACT_COLUMNS))
    shapes["flight"] = ("deviation",)
    shapes["wear_batches"] = ("wear_batch_cycles", len(SIDES), joint.bins)
    return {f"{joint.name}_{name}": shape for name, shape in shapes.items()}


def _require(arrays: Arrays, *names: str) -> None:
    """Raise InputError if an array is not stored."""
    for name in names:
        _ = arrays[name]  # raises the error


def check_numbers(arrays: Arrays, scene: Scene, stage: StageResult) -> None:
    """Raise InputError for a number of a stage that is not finite, or a time beyond its rows.

    A stage that failed may hold any numbers, except for its times. A recorded cycle has
    many rows, so that the last time is below the period times the number of rows.
    """
    for name, values in arrays.items():
        most = math.inf
        if name in ("time", "clock"):
            most = scene.run_up + scene.mechanism.period * values.size
        elif stage.failed:
            continue
        if not np.all(np.isfinite(values) & (np.abs(values) <= most)):
            limit = "" if math.isinf(most) else f" of at most {most:.3g} s"
            raise InputError(
                f"{arrays.source}: {name} must contain finite numbers{limit}"
            )


def check_shapes(arrays: Arrays, shapes: dict[str, Shape]) -> None:
    """Raise InputError for an array of another shape; lengths with the same name are equal."""
    lengths: dict[str | int, int] = {}
    for name, shape in shapes.items():
        if name not in arrays:
            continue
        stored = arrays[name].shape
        expected = []
        for size, length in zip(shape, stored, strict=False):
            if isinstance(size, str):  # the first length of this name counts for all
                expected.append(lengths.setdefault(size, length))
            else:
                expected.append(size)
        if len(stored) != len(shape) or stored != tuple(expected):
            raise InputError(
                f"{arrays.source}: {name} has the shape {stored}, which does not fit"
            )
