"""Sweeps from TOML files: a table ``[sweep]`` in the file of a scene, or beside the scene's name.

[sweep]
scene = "wear-times"           # a scene, or another file; left out in a scene's own file
vary = ["clearance=0.2mm:1.0mm:9", "A.friction=0.02,0.05"]
sample = "sobol:512"
ranges = ["wear_coefficient=lognormal(1e-15/Pa, 50%)"]
measures = ["A.force_max", "bdc_error"]
required = ["life>=2e6"]
draws = 4
seed = 0
keep = "measures"
"""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Literal

from presswear.scene.catalog import scene_named
from presswear.scene.files import SUFFIX, SWEEP, read_toml, scene_from
from presswear.scene.scene import Scene
from presswear.tools.documents import typed
from presswear.tools.errors import InputError, unknown
from presswear.tools.folders import check_file


@dataclass(frozen=True)
class Written:
    """What a file says on a sweep; see the head of this module."""

    scene: str = ""
    vary: tuple[str, ...] = ()
    sample: str = ""
    ranges: tuple[str, ...] = ()
    measures: tuple[str, ...] = ()
    required: tuple[str, ...] = ()
    draws: int = 1
    seed: int = 0
    keep: Literal["measures", "all"] = "measures"


def read_sweep(file: Path) -> tuple[Scene, Written]:
    """The scene and the sweep of a file; one that says nothing on a sweep is a scene alone.

    InputError naming the file, the key and what does not fit.
    """
    check_file(file)
    data = read_toml(file)
    told = data.get(SWEEP, {})
    if not isinstance(told, dict):
        raise InputError(f"{file}: {SWEEP} = {told!r}: a table is expected")
    known = [item.name for item in fields(Written)]
    for key in told:
        if key not in known:
            raise unknown(f"key of [{SWEEP}] in {file}", key, known)
    written = typed(told, Written, f"{file}: {SWEEP}")
    if not written.scene:
        return scene_from(file), written
    if data.keys() - {SWEEP}:
        raise InputError(f"{file}: {SWEEP}.scene names a scene, and the file describes one")
    if written.scene.endswith(SUFFIX):
        return scene_from(file.parent / written.scene), written
    return scene_named(written.scene), written
