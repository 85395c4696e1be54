"""Contents of a result folder: all of it is looked at before any of it is used.

Files may be damaged, of another version or made by somebody else.  Nothing in them is
executed: JSON holds plain data, and arrays are read as numbers of a size that the file
itself has.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.surface import bin_centres
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.observe import SECTION_JOINT_NAMES, SECTION_NAMES, cycle_columns
from presswear.results.life import FILE as LIFE
from presswear.results.life import LifeResult
from presswear.results.provenance import Provenance
from presswear.results.stage import SIDES, StageResult, angle_names
from presswear.tools.errors import InputError
from presswear.tools.serialize import typed

Array = NDArray[np.float64]

LARGEST_ENTRY = 1e100
"""Bound of the values in an array: a state that runs away is ended at 1e30."""


@dataclass(frozen=True)
class StoredCheckpoint:
    """Checkpoint of an unfinished run: turn of its file, last stored cycle, index of the stage."""

    turn: Literal[1, 2]
    words: str
    index: int


@dataclass(frozen=True)
class StoredResult:
    """The whole of ``result.json``; the scene is checked by ``Scene`` itself.

    Attributes
    ----------
    stages : tuple of StageResult
        Without their arrays.
    files : dict
        Digests by the names of files.
    """

    scene: dict[str, Any]
    conventions: dict[str, str]
    engine: str
    provenance: Provenance
    status: Literal["running", "interrupted", "completed", "unconverged", "failed"]
    message: str
    wall_s: float
    life: LifeResult | None
    stages: tuple[StageResult, ...]
    files: dict[str, str]
    checkpoint: StoredCheckpoint | None


def files_of(index: int) -> tuple[str, str]:
    """Files of a stage: its arrays and its film."""
    return f"stage-{index}.npz", f"film-{index}.npz"


def checkpoint_file(turn: int) -> str:
    """Name of a checkpoint's file; two take turns, so that one is always whole."""
    return f"checkpoint-{turn}.npz"


def stored_result(document: Any, file: Path) -> StoredResult:
    """The document of a result; InputError names the first part that is not what it should be.

    Joints are left for ``check_joints``, which needs the scene's.
    """
    found = typed(document, StoredResult, f"{file}")
    files = set() if found.checkpoint is None else {checkpoint_file(found.checkpoint.turn)}
    files |= set() if found.life is None else {LIFE}
    for place, stage in enumerate(found.stages):
        where = f"{file}: stages[{place}]"
        # Stages follow each other: readers take the place for the number of wears.
        if stage.index != place:
            raise InputError(f"{where}.index is {stage.index}; {place} is expected")
        files |= {*files_of(place)}
    for name in sorted(files ^ found.files.keys()):
        how = "lacks" if name in files else "has"
        raise InputError(f"{file}: 'files' {how} {name!r}, unlike its stages and checkpoint")
    return found


def check_joints(
    stored: StoredResult, joints: tuple[str, ...], wear_updates: int, file: Path
) -> None:
    """InputError where a result and its scene do not fit together.

    Parameters
    ----------
    joints : tuple of str
        With clearance.
    wear_updates : int
        How often they are worn.
    """
    if len(stored.stages) > wear_updates + 1:
        count = len(stored.stages)
        raise InputError(
            f"{file}: {count} stages, where the scene has wear_updates = {wear_updates}"
        )
    for stage in stored.stages:
        told: list[Mapping[str, Any]] = []
        if stage.statistics.output is not None:
            told.append(stage.statistics.joints)
        for step in stage.wear_steps:
            told += [step.max_depth, step.peak_force]
        for found in told:
            if set(found) != set(joints):
                raise InputError(
                    f"{file}: stages[{stage.index}] tells of joints {', '.join(found) or 'none'}, "
                    f"where the scene has clearance at {', '.join(joints) or 'none'}"
                )
        for sides in (own for step in stage.wear_steps for own in step.max_depth.values()):
            if set(sides) != set(SIDES):
                raise InputError(
                    f"{file}: stages[{stage.index}].wear_steps tells of {', '.join(sides)}; "
                    f"{', '.join(SIDES)} are expected"
                )


SHAPES = {
    "time": "rows",
    "slider": "rows 3",
    "wear_batch_cycles": "batches",
    "cycle_start": "cycles",
    "deviation": "recorded 4",
    "deviation_start": "recorded",
}
"""Arrays of a stage; the lengths of one name are the same throughout."""
JOINT_SHAPES = {
    "eccentricity": "rows 2",
    "penetration": "rows",
    "force": "rows 2",
    "sliding": "rows",
}
"""Series of each joint; all of them are there, or none."""
MAP_SHAPES = {
    "depth_bearing": "bins",
    "depth_pin": "bins",
    "wear_bearing": "bins",
    "wear_pin": "bins",
    "wear_batches": "batches 2 bins",
}
"""Those over the angle, with bins of its own."""
DEPTHS = ("depth_bearing", "depth_pin", "wear_bearing", "wear_pin")
"""Endings of the arrays of which no value is below zero."""


def check_arrays(
    arrays: Mapping[str, Array], joints: Mapping[str, int], drives: int, file: Path
) -> None:
    """InputError naming the first array of a stage that is missing, misshapen or not finite.

    Parameters
    ----------
    joints : mapping of str to int
        Bins of the wear maps of the joints with clearance, by name.
    drives : int
        Number of drives.
    """
    for name, values in arrays.items():
        if not np.all(np.abs(values) <= LARGEST_ENTRY):
            raise InputError(
                f"{file}: {name} holds a value that is not finite, or beyond {LARGEST_ENTRY:g}"
            )
    shapes = {**SHAPES, "cycles": f"cycles {cycle_columns(len(joints), drives)}"}
    if "drive_torque" in arrays:
        shapes["drive_torque"] = f"rows {drives}"
    if "sections" in arrays:
        width = len(SECTION_NAMES) + len(SECTION_JOINT_NAMES) * len(joints)
        shapes["sections"] = f"cycles_of_first sections {width}"
    for k, (joint, angle) in enumerate(angle_names(joints).items()):
        series = {f"{joint}_{name}": shape for name, shape in JOINT_SHAPES.items()}
        shapes |= series if arrays.keys() & series.keys() else {}
        shapes[f"{joint}_flight"] = "recorded"
        own = f"{joints[joint]}"
        shapes |= {f"{joint}_{name}": s.replace("bins", own) for name, s in MAP_SHAPES.items()}
        shapes[angle] = own
        shapes[f"{joint}_contacts"] = f"contacts_{k} {len(CONTACT_COLUMNS)}"
    lengths: dict[str, int] = {}
    for name, shape in shapes.items():
        _check_shape(arrays, name, shape.split(), lengths, file)
        values = arrays[name]
        if name == "time" and values.size and (values[0] < 0.0 or np.any(np.diff(values) < 0.0)):
            raise InputError(f"{file}: time goes backwards")
        if name.endswith("angle") and not np.allclose(values, bin_centres(values.size), 0.0, 1e-9):
            raise InputError(
                f"{file}: {name} does not hold the middles of {values.size} bins of a turn"
            )
        if name.endswith(DEPTHS) and np.any(values < 0.0):
            raise InputError(f"{file}: {name} holds a depth below zero")


def _check_shape(
    arrays: Mapping[str, Array], name: str, shape: list[str], lengths: dict[str, int], file: Path
) -> None:
    """InputError where an array is missing or misshapen; lengths seen first are added."""
    if name not in arrays:
        raise InputError(f"{file}: the array {name} is missing")
    found = arrays[name].shape
    if len(found) == len(shape):
        for length, word in zip(found, shape, strict=True):
            lengths.setdefault(word, int(word) if word.isdigit() else length)
    wanted = tuple(lengths.get(word, word) for word in shape)
    if found != wanted:
        told = ", ".join(map(str, wanted))
        raise InputError(f"{file}: {name} has the shape {found}; ({told}) is expected")
