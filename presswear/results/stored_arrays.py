"""Sizes and shapes that the arrays of a stored result may have, by its scene and statistics.

A result may come from anybody: nothing larger than a run can write is read into memory.
"""

import math

import numpy as np

from presswear.engines.base import Plan
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import WALL_BINS, WALLS, GuideCorner
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import SIDES
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.columns import (
    JOINT_ARRAYS,
    JOINT_SERIES_COUNT,
    LEADER_SERIES_COUNT,
    SECTION_JOINT_NAMES,
    SERIES_COUNT,
    cycle_columns,
)
from presswear.recording.film import FILM_CYCLES, FILM_JOINT_COUNT, FRAMES_PER_CYCLE
from presswear.recording.series_rows import CONTACTS_AT_MOST, ROWS_AT_MOST, ROWS_IN_ALL
from presswear.recording.statistics import RANGE_STROKES, STARTUP_CYCLES
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Arrays
from presswear.tools.errors import InputError

CURVE_BYTES = 2**26  # room for the curves of a service life
_HEADER_BYTES = 2**20  # room for the headers of all arrays
_BYTES = 8  # bytes of a number
# Room for further numbers of a cycle: replicate, deviations and weights
_OTHER_COLUMNS = 8
_MAPS_OF_JOINT = 8  # room for depths, wear and angles of both sides
_WALL_ARRAYS = 5  # rows of bins of a guide: places, depths and wear of both walls


def most_film_bytes(linkage: Linkage) -> int:
    """Return the largest size of a film, bytes."""
    columns = 1 + 3 * len(linkage.bodies) + FILM_JOINT_COUNT * len(linkage.clearances)
    frames = FILM_CYCLES * FRAMES_PER_CYCLE + 1
    return _HEADER_BYTES + _BYTES * frames * columns


def most_stage_bytes(scene: Scene, linkage: Linkage, stage: StageResult) -> int:
    """Return the largest size of the arrays of a stage, bytes."""
    joints = len(linkage.clearances)
    drives = len(linkage.drives)
    default = max(Plan.recorded_cycles, STARTUP_CYCLES + RANGE_STROKES)
    recorded = scene.recording.recorded_cycles or default
    run_up_cycles = math.ceil(scene.run_up / scene.mechanism.period)
    rows = min((recorded + run_up_cycles) * ROWS_AT_MOST, ROWS_IN_ALL)
    contacts = joints * recorded * CONTACTS_AT_MOST * len(CONTACT_COLUMNS)
    # There are two sets of replicates. Each replicate of the second has its surfaces.
    cycles = 2 * (stage.statistics.cycles + scene.replicate_count * (recorded + 1))
    bins = max((joint.bins for joint in linkage.clearances), default=0)
    width = _cycle_columns_of(linkage)
    width += scene.recording.sections * _section_columns_of(linkage)
    # Each cycle may have a wear map.
    width += _OTHER_COLUMNS + joints * (1 + len(SIDES) * bins)
    walls = _WALL_ARRAYS * WALL_BINS * len(linkage.worn_guides)
    series = SERIES_COUNT + JOINT_SERIES_COUNT * joints
    series += LEADER_SERIES_COUNT + len(linkage.elastic_joints) + 3 * drives
    maps = _MAPS_OF_JOINT * joints * bins + walls
    numbers = rows * series + contacts + cycles * width + maps
    return _HEADER_BYTES + _BYTES * numbers


def _cycle_columns_of(linkage: Linkage) -> int:
    """Return the number of columns of the array of cycles."""
    return cycle_columns(
        len(linkage.clearances),
        len(linkage.drives),
        linkage.leader is not None,
        len(linkage.oiled_joints),
    )


def _section_columns_of(linkage: Linkage) -> int:
    """Return the number of columns of a Poincare section."""
    return 2 + len(SECTION_JOINT_NAMES) * len(linkage.clearances)


# Shape of an array. Lengths with the same name are equal.
Shape = tuple[str | int, ...]


def check_stage(arrays: Arrays, scene: Scene, linkage: Linkage) -> None:
    """Raise InputError for an array of a stage that is missing or has another shape."""
    if linkage.leader is not None:
        _require(arrays, "clock", "nominal_rate")
    shapes = _shapes_of_stage(scene, linkage)
    for joint in linkage.clearances:
        shapes |= _shapes_of_joint(joint)
        if not isinstance(joint, GuideCorner):
            for side in SIDES:
                _require(
                    arrays, f"{joint.name}_depth_{side}", f"{joint.name}_wear_{side}"
                )
    for guide in linkage.worn_guides:
        shapes[f"{guide.name}_wall_place"] = (WALL_BINS,)
        for name in ("depth", "wear"):
            shapes[f"{guide.name}_wall_{name}"] = (len(WALLS), WALL_BINS)
            _require(arrays, f"{guide.name}_wall_{name}")
    check_shapes(arrays, shapes)


def _shapes_of_stage(scene: Scene, linkage: Linkage) -> dict[str, Shape]:
    """Return the shapes of the arrays of a stage that are not of one joint, by name."""
    drives = len(linkage.drives)
    sections = scene.recording.sections
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
        "cycles": ("cycles", _cycle_columns_of(linkage)),
        "cycle_start": ("cycles",),
        "sections": ("sections", sections, _section_columns_of(linkage)),
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
    if not isinstance(joint, GuideCorner):
        for side in SIDES:
            shapes[f"depth_{side}"] = (joint.bins,)
            shapes[f"wear_{side}"] = (joint.bins,)
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
