"""The result folder: what is kept, in which files.

``result.json`` holds the scene, where the numbers come from and the statistics;
``stage-K.npz`` the arrays of stage K, ``film-K.npz`` its film.  Files appear whole or not at all.
"""

import json
import math
import os
import platform
import subprocess
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from importlib.metadata import version
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from presswear.campaign import Stage
from presswear.deviation import deviations
from presswear.errors import InputError
from presswear.film import Film
from presswear.numerics import Numerics
from presswear.observe import SERIES_FIXED, SERIES_JOINT
from presswear.press import Press
from presswear.scene import Scene
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


def write_arrays(path: Path, arrays: Mapping[str, Array]) -> None:
    """Write arrays by name as ``write_whole`` does."""
    write_whole(path, lambda file: np.savez_compressed(file, allow_pickle=False, **arrays))


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
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            raise InputError(f"--out {path}: it exists and is not empty; name a new folder")
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
        ensemble = stage.ensemble
        joints = [joint.name for joint in ensemble.linkage.clearances]
        write_arrays(self.path / f"stage-{stage.index}.npz", stage_arrays(self._scene, stage))
        write_arrays(
            self.path / f"film-{stage.index}.npz", ensemble.accounts[0].film.arrays(joints)
        )
        self._document["stages"].append(
            {
                "index": stage.index,
                "status": ensemble.status,
                "message": ensemble.failure,
                "amplification": stage.amplification,
                "wear_steps": [step.as_dict() for step in stage.steps],
                "simulated_s": ensemble.time,
                "wall_s": ensemble.wall,
                "diagnostics": ensemble.diagnostics(),
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


def read_json(file: Path, missing: str) -> Any:
    """What a JSON file holds; InputError says that it is missing, in given words, or damaged."""
    try:
        return json.loads(file.read_text())
    except FileNotFoundError:
        raise InputError(missing) from None
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def load(path: Path) -> StoredResult:
    """Read a result folder; InputError says what is missing or of another schema."""
    file = path / "result.json"
    document = read_json(file, f"{path} is no result folder: it has no result.json")
    schema = document.get("schema") if isinstance(document, dict) else None
    if schema not in (1, SCHEMA):
        raise InputError(f"{file} has schema {schema!r}; this version reads 1 to {SCHEMA}")
    try:
        names = [path / f"stage-{int(entry['index'])}.npz" for entry in document["stages"]]
        scene = _from_schema_1(document["scene"]) if schema == 1 else document["scene"]
        # Before there were steps, every wear was one jump.
        scene = {"extrapolation": "single", **scene}
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{file} is not whole: {error!r}") from None
    return StoredResult(path, document, Scene.from_dict(scene), [_arrays(name) for name in names])


def _from_schema_1(scene: Mapping[str, Any]) -> dict[str, Any]:
    """A stored scene of schema 1: its mechanism is a press, its numerics are the scene's own."""
    plain = dict(scene)
    names = {item.name for item in fields(Numerics)}
    plain["numerics"] = {name: plain.pop(name) for name in names & plain.keys()}
    plain["mechanism"] = {"kind": Press.kind, **plain.pop("press")}
    return plain


def load_film(result: StoredResult, stage: int) -> Film:
    """The film of a stage; InputError where there is none or it is damaged."""
    file = result.path / f"film-{result.document['stages'][stage]['index']}.npz"
    if not file.exists():
        raise InputError(f"{file} is missing: this run was stored without a film; run it again")
    names = [joint.name for joint in result.scene.linkage({}).clearances]
    try:
        return Film.from_arrays(_arrays(file), names)
    except (KeyError, ValueError) as error:
        raise InputError(f"{file} is no film of this run: {error}") from None


def _arrays(file: Path) -> dict[str, Array]:
    """Arrays of one stage; InputError when the file is missing or damaged."""
    try:
        with np.load(file, allow_pickle=False) as stored:
            return dict(stored)
    except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
        raise InputError(f"{file} cannot be read: {error}") from None
