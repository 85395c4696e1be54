"""The result folder: what is kept, in which files, and reading it back.

``result.json`` holds the scene, where the numbers come from, the statistics and the digests
of all files; ``stage-K.npz`` the arrays of stage K, ``film-K.npz`` its film.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.campaign import Stage
from presswear.campaign.deviation import deviations
from presswear.tools.errors import InputError
from presswear.tools.files import check_seal, read_checked, read_json
from presswear.record.film import Film
from presswear.tools.lock import holder
from presswear.record.observe import SERIES_FIXED, SERIES_JOINT
from presswear.scene.scene import Scene
from presswear.results.stored import check_arrays, check_document, check_stages, read_arrays, schema_of
from presswear.linkage.surface import bin_centres

Array = NDArray[np.float64]

FILE = "result.json"
SCHEMA = 4
FINISHED = ("completed", "failed")
"""Statuses of a run that has come to its end."""


def stage_arrays(scene: Scene, stage: Stage) -> dict[str, Array]:
    """The arrays of one stage under their contracted names; SI units.

    Series, episodes and torques are those of the first start.
    """
    ensemble = stage.ensemble
    joints = ensemble.linkage.clearances
    account = ensemble.accounts[0]
    series = account.rows
    arrays: dict[str, Array] = {"time": series[:, 0], "slider": series[:, 1:SERIES_FIXED]}
    torques = series[:, SERIES_FIXED + SERIES_JOINT * len(joints) :]
    if torques.shape[1] > 0:
        arrays["drive_torque"] = torques
    for k, joint in enumerate(joints):
        own = series[:, SERIES_FIXED + SERIES_JOINT * k :][:, :SERIES_JOINT]
        name = joint.name
        arrays[f"{name}_eccentricity"] = own[:, 0:2]
        arrays[f"{name}_penetration"] = own[:, 2]
        arrays[f"{name}_force"] = own[:, 3:5]
        arrays[f"{name}_sliding"] = own[:, 5]
        arrays[f"{name}_contacts"] = account.episodes(k)
        bins = stage.added.shape[2]
        arrays["angle"] = bin_centres(bins)
        for side, surface, added in (
            ("bearing", joint.bearing_surface, stage.added[k, 0]),
            ("pin", joint.pin_surface, stage.added[k, 1]),
        ):
            arrays[f"{name}_depth_{side}"] = surface.depth if surface.is_worn else np.zeros(bins)
            arrays[f"{name}_wear_{side}"] = added
        arrays[f"{name}_wear_batches"] = stage.batches[:, k]
    arrays["wear_batch_cycles"] = stage.weights
    starts = ensemble.accounts
    arrays["cycles"] = np.concatenate([own.cycles for own in starts])
    arrays["cycle_start"] = np.repeat(
        np.arange(float(len(starts))), [len(own.cycles) for own in starts]
    )
    arrays |= deviations(scene, ensemble)
    return arrays


def plain(value: Any) -> Any:
    """Data that JSON can hold: a number that is not finite becomes null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value


@dataclass(frozen=True)
class StoredResult:
    """A result folder read back.

    Attributes
    ----------
    document : dict
        ``result.json``.
    scene : Scene
    stages : list of dict
        Arrays of each stage by name.
    """

    path: Path
    document: dict[str, Any]
    scene: Scene
    stages: list[dict[str, Array]]

    def statistics(self, stage: int) -> dict[str, Any]:
        """Statistics of a stage."""
        found: dict[str, Any] = self.document["stages"][stage]["statistics"]
        return found

    def wear_steps(self, stage: int) -> list[dict[str, Any]]:
        """How the wear after a stage was applied, as ``WearStep.as_dict`` says it.

        Empty where none was.
        """
        found: list[dict[str, Any]] = self.document["stages"][stage]["wear_steps"]
        return found

    @property
    def grew_in_steps(self) -> bool:
        """Whether any wear was applied in more than one step."""
        return any(len(self.wear_steps(k)) > 1 for k in range(len(self.stages)))


def read_document(path: Path) -> dict[str, Any]:
    """What ``result.json`` in a folder holds; InputError where it is not what was written."""
    file = path / FILE
    document = read_json(file, f"{path} is no result folder: it has no {FILE}")
    schema_of(document, file, SCHEMA)
    found: dict[str, Any] = document
    check_seal(read_checked(file, None), found, file)
    return found


def load(path: Path) -> StoredResult:
    """Read a result folder; InputError names what is missing, cut off, altered or too new."""
    file = path / FILE
    document = read_document(path)
    check_document(document, file)
    scene = stored_scene(document, file)
    joints = scene.clearance_joints
    check_stages(document, joints, scene.wears, file)
    digests = document["files"]
    stages = []
    for entry in document["stages"]:
        name = f"stage-{entry['index']}.npz"
        arrays = read_arrays(path / name, digests.get(name))
        check_arrays(arrays, joints, scene.bearings.angles, path / name)
        stages.append(arrays)
    for name in digests.keys() - {f"stage-{entry['index']}.npz" for entry in document["stages"]}:
        read_checked(path / name, digests[name])
    return StoredResult(path, document, scene, stages)


def unfinished(path: Path, document: Mapping[str, Any]) -> str:
    """Whether a run has not come to its end, and what is there of it, in words; or nothing."""
    status = document["status"]
    if status in FINISHED:
        return ""
    who = holder(path)
    if who is not None:
        how = f"{who} is at work in it"
    else:
        how = "interrupted" if status == "interrupted" else "killed, or stopped by an error"
    done = len(document["stages"])
    return (
        f"{path} is unfinished ({how}): {done} of {document['scene']['wears'] + 1} stages are "
        "stored"
    )


def stored_scene(document: Mapping[str, Any], file: Path) -> Scene:
    """The scene of a document, by today's names; InputError names the file."""
    try:
        scene = Scene.from_dict(document["scene"])
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    # Both are told twice, for whoever reads the file without us.
    for key in ("engine", "conventions"):
        inside = document["scene"][key]
        if document.get(key) != inside:
            raise InputError(f"{file}: {key!r} is not what it is in 'scene', {inside!r}")
    return scene


def load_film(result: StoredResult, stage: int) -> Film:
    """The film of a stage; InputError where there is none or it is damaged."""
    file = result.path / f"film-{result.document['stages'][stage]['index']}.npz"
    if not file.exists():
        raise InputError(f"{file} is missing: this run was stored without a film; run it again")
    linkage = result.scene.linkage()
    arrays = read_arrays(file, result.document["files"].get(file.name))
    names = [joint.name for joint in linkage.clearances]
    try:
        return Film.from_arrays(arrays, len(linkage.bodies), names)
    except (LookupError, ValueError) as error:
        raise InputError(f"{file} is no film of this run: {error}") from None
