"""The result folder: what is kept, in which files.

``result.json`` holds the scene, where the numbers come from and the statistics;
``stage-K.npz`` the arrays of stage K.  Files appear whole or not at all.
"""

import json
import math
import os
import platform
import subprocess
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from presswear.campaign import Stage
from presswear.deviation import deviations
from presswear.errors import InputError
from presswear.folders import check_new_folder
from presswear.migration import migrated
from presswear.observe import SERIES_FIXED, SERIES_JOINT
from presswear.scene import Scene
from presswear.stored import check_arrays, check_document, check_stages, read_arrays, schema_of
from presswear.surface import bin_centres

Array = NDArray[np.float64]

SCHEMA = 2
PACKAGES = ("presswear", "exudyn", "numpy", "scipy", "numba", "matplotlib")


def write_whole(path: Path, write: Callable[[BinaryIO], None]) -> None:
    """Write a file so that it is there whole or not at all."""
    part = path.with_name(path.name + ".part")
    try:
        with part.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def write_bytes(path: Path, data: bytes) -> None:
    """Write bytes as ``write_whole`` does."""

    def write(file: BinaryIO) -> None:
        file.write(data)

    write_whole(path, write)


def save_arrays(file: BinaryIO | Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays by name; without options, which numpy 2.0 stores as if they were arrays."""
    save: Callable[..., None] = np.savez_compressed
    save(file, **arrays)


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
    arrays["cycles"] = np.array([row for own in starts for row in own.cycles])
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


def source_revision() -> str:
    """Revision of the source when it runs from a checkout, else ``unknown``."""
    folder = Path(__file__).resolve().parent
    try:
        found = subprocess.run(
            ["git", "-C", str(folder), "describe", "--always", "--dirty", "--abbrev=12"],
            capture_output=True,
            text=True,
            timeout=5,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return found.stdout.strip()


def provenance() -> dict[str, Any]:
    """Versions, revision and machine."""
    return {
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
        "revision": source_revision(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }


class ResultFolder:
    """A result folder being written.

    Nothing is created before the first stage is finished, and the folder must not
    hold anybody's files.
    """

    def __init__(self, path: Path, scene: Scene) -> None:
        check_new_folder(path)
        self.path = path
        self._scene = scene
        self._began = time.perf_counter()
        self._document: dict[str, Any] = {
            "schema": SCHEMA,
            "scene": scene.as_dict(),
            "conventions": scene.as_dict()["conventions"],
            "engine": scene.engine,
            "provenance": provenance(),
            "status": "running",
            "message": "",
            "wall_s": 0.0,
            "stages": [],
        }

    def add(self, stage: Stage) -> None:
        """Store a finished stage."""
        self.path.mkdir(parents=True, exist_ok=True)
        arrays = stage_arrays(self._scene, stage)
        write_whole(
            self.path / f"stage-{stage.index}.npz",
            lambda file: save_arrays(file, arrays),
        )
        self._document["stages"].append(
            {
                "index": stage.index,
                "status": stage.ensemble.status,
                "message": stage.ensemble.failure,
                "amplification": stage.amplification,
                "wear_steps": [step.as_dict() for step in stage.steps],
                "simulated_s": stage.ensemble.time,
                "wall_s": stage.ensemble.wall,
                "diagnostics": stage.ensemble.diagnostics(),
                "statistics": stage.statistics,
            }
        )
        self._write()

    def close(self, status: str, message: str) -> None:
        """State how the campaign ended."""
        self._document["status"], self._document["message"] = status, message
        if self._document["stages"]:
            self._write()

    def _write(self) -> None:
        self._document["wall_s"] = time.perf_counter() - self._began
        text = json.dumps(plain(self._document), indent=1, allow_nan=False)
        write_bytes(self.path / "result.json", text.encode())


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

        Empty where none was, and in results from before there were steps.
        """
        found: list[dict[str, Any]] = self.document["stages"][stage].get("wear_steps", [])
        return found

    @property
    def grew_in_steps(self) -> bool:
        """Whether any wear was applied in more than one step."""
        return any(len(self.wear_steps(k)) > 1 for k in range(len(self.stages)))


MOST_TEXT = 2**28
"""Bytes of a JSON file; the largest studies have some millions."""


def read_json(file: Path, missing: str) -> Any:
    """What a JSON file holds; InputError says that it is missing, in given words, or damaged.

    Nothing is chosen between two values of one name, and no number is infinite: files are
    written without either.
    """
    if not file.is_file():
        raise InputError(missing)
    try:
        if file.stat().st_size > MOST_TEXT:
            raise ValueError(f"it has more than {MOST_TEXT} bytes")
        return json.loads(
            file.read_text(encoding="utf-8"),
            object_pairs_hook=_named_once,
            parse_float=_finite,
            parse_constant=_finite,
        )
    # A whole number of some thousand digits is a ValueError like any damage.
    except (OSError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def _named_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a name is there twice")
    return found


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is no finite number")
    return value


def load(path: Path) -> StoredResult:
    """Read a result folder; InputError says what is missing, damaged or of another schema."""
    file = path / "result.json"
    document = read_json(file, f"{path} is no result folder: it has no result.json")
    schema = schema_of(document, file, SCHEMA)
    check_document(document, file)
    scene = stored_scene(document, schema, file)
    joints = scene.clearance_joints
    check_stages(document, joints, scene.wears, file)
    stages = []
    for entry in document["stages"]:
        name = path / f"stage-{entry['index']}.npz"
        arrays = read_arrays(name)
        check_arrays(arrays, joints, scene.bearings.angles, name)
        stages.append(arrays)
    return StoredResult(path, document, scene, stages)


def stored_scene(document: Mapping[str, Any], schema: int, file: Path) -> Scene:
    """The scene of a document, by today's names; InputError names the file."""
    try:
        scene = Scene.from_dict(migrated(document["scene"], schema))
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    # Both are told twice, for whoever reads the file without us.
    for key in ("engine", "conventions"):
        inside = document["scene"].get(key)
        if document.get(key, inside) != inside:
            raise InputError(f"{file}: {key!r} is not what it is in 'scene', {inside!r}")
    return scene
