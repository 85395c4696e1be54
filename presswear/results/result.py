"""A result, the same in memory and on disk.

On disk ``result.json`` holds the scene, where the numbers come from, the statistics and the
digests of all files; ``stage-K.npz`` the arrays of stage K, ``film-K.npz`` its film.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswear.recording.film import Film
from presswear.results.folder import (
    FILE,
    FINISHED,
    StoredResult,
    check_joints,
    files_of,
    read_document,
    stored_result,
)
from presswear.results.life import FILE as LIFE
from presswear.results.life import LifeResult, check_curves
from presswear.results.press_analysis import (
    DriveResult,
    Energy,
    Strokes,
    Tonnage,
    deep_contacts,
    drives_of,
    energy_of,
    height_of,
    process_force,
    strokes_of,
    tonnage_of,
)
from presswear.results.stage import StageResult, angle_names, check_arrays
from presswear.scene.bearing import Surfaces
from presswear.scene.catalog import name_of
from presswear.scene.files import TABLE, read_profiles
from presswear.scene.scene import Scene, stage_name
from presswear.tools.arrays import read_numbers
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder, holder, read_checked
from presswear.tools.numbers import large

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

_FIGURES, _REPORT = "presswear.show.figures", "presswear.show.report"
# Imported when they are called, since results are on a lower floor.


@dataclass(frozen=True)
class Result:
    """Result of a scene: its stages, status and provenance.

    Attributes
    ----------
    scene : Scene
    stages : tuple of StageResult
    status : str
        ``completed``, ``unconverged``, ``failed``, ``interrupted`` or ``running``.
    message : str
        Reason why it is not completed, or nothing.
    provenance : mapping
        Versions, revision, machine and date.
    wall_s : float
        Wall time, s.
    path : Path or None
        Its folder; None: in memory only.
    life : LifeResult or None
        Service life, if the scene has limits.
    """

    scene: Scene
    stages: tuple[StageResult, ...]
    status: str
    message: str
    provenance: Mapping[str, Any]
    wall_s: float
    path: Path | None = None
    life: LifeResult | None = None

    def stage(self, index: int) -> StageResult:
        """Return the stage after a number of wear updates; InputError names those there are."""
        for stage in self.stages:
            if stage.index == index:
                return stage
        indices = [stage.index for stage in self.stages]
        text, where = ", ".join(map(str, indices)) or "none", self.path or self.scene.name
        if indices:
            text += f"; did you mean {min(indices, key=lambda stage: abs(stage - index))}?"
        raise InputError(f"{where} has no stage {index}; it has {text}")

    def stage_name(self, index: int) -> str:
        """Return the name of a stage: its wear updates, or its strokes in a service life."""
        if self.life is None or index == 0:
            return stage_name(
                index, any(stage.index == 0 and stage.is_worn for stage in self.stages)
            )
        return f"after {large(self.life.strokes_at(self.scene, index))} strokes"

    def strokes(self, index: int) -> Strokes | None:
        """Return the recorded strokes of a stage on the work; None without a process."""
        return strokes_of(self.scene, self.stage(index))

    def process_force(self, index: int) -> Array | None:
        """Return the force of the work at the times of the series, shape (n,), N, or None."""
        return process_force(self.scene, self.stage(index))

    def height(self, index: int) -> Array:
        """Return the height over the ideal bottom dead centre at these times, shape (n,), m."""
        return height_of(self.scene, self.stage(index))

    def tonnage(self, index: int) -> Tonnage | None:
        """Return tonnage and shock in a stage; None if it failed or no stroke is complete."""
        return tonnage_of(self.scene, self.stage(index))

    def drives(self, index: int) -> dict[str, DriveResult]:
        """Return the drives in a stage by their bodies; empty if torques were not stored."""
        return drives_of(self.scene, self.stage(index))

    def energy(self, index: int) -> Energy | None:
        """Return the energy of a part; None if the stage failed before a cycle was complete."""
        return energy_of(self.scene, self.stage(index))

    @property
    def grew_in_steps(self) -> bool:
        """True if any wear update was applied in more than one step."""
        return any(len(stage.wear_steps) > 1 for stage in self.stages)

    def __str__(self) -> str:
        """Return a table of the stages, and sentences on deep contacts."""
        names = self.scene.clearance_joints
        columns = ["stage", "cycles"]
        for name in names:
            columns += [f"peak force {name} (N)", f"one wear {name} (mm³)"]
        rows = [[*columns, "ended"]]
        for stage in self.stages:
            name = self.stage_name(stage.index) if names else "computed"
            row = [name, str(stage.cycles)]
            for joint in stage.joints.values():
                statistics = joint.stored
                row += [
                    _short(statistics and statistics.peak_force),
                    _short(statistics and 1e9 * statistics.wear_volume.mean),
                ]
            rows.append([*row, stage.message or stage.status])
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in rows
        ]
        where = f", in {self.path}" if self.path else ""
        ending = f": {self.message}" if self.message else ""
        life = [] if self.life is None else [f"{self.life}"]
        first = f"{name_of(self.scene)}, {self.status}{ending}{where}"
        return "\n".join([first, *life, *lines, *deep_contacts(self.scene, self.stages)])

    def plot(self, *names: str, stage: int | None = None) -> "list[Axes]":
        """Draw figures and return their axes; a notebook shows the figures.

        Parameters
        ----------
        names : str
            As ``presswear.show.figures.NAMES`` lists them, such as ``wear``, ``force``,
            ``path``; none: all that have data.
        stage : int or None
            The only stage to draw; None: all.

        Raises
        ------
        InputError
            For an unknown name or stage, and for a figure without data.
        """
        axes: list[Axes] = import_module(_FIGURES).plot(self, names, stage)
        return axes

    def report(self) -> Path:
        """Draw the figures and write ``report.html`` into the result's folder; return its path.

        InputError for a result in memory.
        """
        path: Path = import_module(_REPORT).write_report(self)
        return path

    def table(self) -> "pandas.DataFrame":
        """Return the statistics with one row per stage and one column per number; needs pandas."""
        import pandas

        table = pandas.json_normalize([asdict(stage.statistics) for stage in self.stages])
        names = [self.stage_name(stage.index) for stage in self.stages]
        table.index = pandas.Index(names, name="stage")
        return table

    def dataset(self, stage: int) -> "xarray.Dataset":
        """Return series and wear maps of a stage over time and angle, SI units; needs xarray."""
        import xarray

        data = self.stage(stage)
        lengths = {"time": data.time.size}
        bins = {name: joint.angle.size for name, joint in data.joints.items()}
        lengths |= {angle: bins[name] for name, angle in angle_names(bins).items()}
        variables = {}
        for name, array in data.arrays.items():
            along = next((axis for axis, n in lengths.items() if array.shape[:1] == (n,)), None)
            if along is None or name in lengths:
                continue
            across = [f"{name}_{axis}" for axis in range(1, array.ndim)]
            variables[name] = ([along, *across], array)
        return xarray.Dataset(variables, coords={axis: data.arrays[axis] for axis in lengths})


def _short(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"


def stored_scene(path: Path) -> tuple[Scene, StoredResult]:
    """Return the scene of a result folder and its document, checked against each other."""
    file = path / FILE
    stored = stored_result(read_document(path), file)
    try:
        scene = Scene.from_dict(stored.scene)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    # Both are stored twice, for readers of the file.
    for key, value in {"engine": stored.engine, "conventions": stored.conventions}.items():
        if value != stored.scene[key]:
            raise InputError(f"{file}: {key!r} is not what it is in 'scene', {stored.scene[key]!r}")
    check_joints(stored, scene.clearance_joints, scene.wear_updates, file)
    return scene, stored


def load(path: str | Path, trust: bool = False) -> Result:
    """Read a result folder; InputError names parts that are missing, damaged or too new.

    A checkpoint is not read, because a run may replace it at any time.

    Parameters
    ----------
    trust : bool
        Whether this process may execute the Python source code of user laws that the result
        stores. Running the scene again, static equilibria and ideal torques need it.
    """
    path = Path(path)
    scene, stored = stored_scene(path)
    if trust:
        scene.trust()
    joints = scene.clearance_joints
    linkage = scene.linkage()
    bins = {joint.name: joint.bins for joint in linkage.clearances}
    stages = []
    for stage in stored.stages:
        name, film = files_of(stage.index)
        arrays = read_numbers(path / name, stored.files[name])
        check_arrays(arrays, bins, len(linkage.drives), path / name)
        read_checked(path / film, stored.files[film])
        read = partial(_film, path / film, stored.files[film], scene)
        stages.append(replace(stage, arrays=arrays, joint_names=joints, read_film=read))
    return Result(
        scene,
        tuple(stages),
        stored.status,
        stored.message,
        stored.provenance,
        stored.wall_s,
        path,
        _life(path, stored),
    )


def _life(path: Path, stored: StoredResult) -> LifeResult | None:
    """Return the life with its curves; InputError if they do not agree."""
    if stored.life is None:
        return None
    curves = read_numbers(path / LIFE, stored.files[LIFE])
    check_curves(stored.life, curves, path / LIFE)
    return replace(stored.life, curves=curves)


def _film(file: Path, digest: str, scene: Scene) -> Film:
    """Return the film in a file; InputError if it is missing or damaged."""
    linkage = scene.linkage()
    arrays = read_numbers(file, digest)
    names = [joint.name for joint in linkage.clearances]
    try:
        return Film.from_arrays(arrays, len(linkage.bodies), names)
    except (LookupError, ValueError) as error:
        raise InputError(f"{file} is no film of this run: {error}") from None


def unfinished(result: Result) -> str:
    """Return a sentence on a stored run that is unfinished, or nothing."""
    if result.status in FINISHED or result.path is None:
        return ""
    process = holder(result.path)
    if process is not None:
        how = f"{process} is at work in it"
    else:
        how = "interrupted" if result.status == "interrupted" else "killed, or stopped by an error"
    return (
        f"{result.path} is unfinished ({how}): {len(result.stages)} of "
        f"{result.scene.wear_updates + 1} stages are stored"
    )


def read_surfaces(source: str | Path) -> Surfaces:
    """Return the surfaces of a stage of a result, or measured ones.

    Parameters
    ----------
    source : str or Path
        ``DIR:STAGE``: those that the stage ran on, such as 1 for those after the first wear update,
        the mean of its replicates; ``DIR``: those of its last stage; ``FILE.csv``: a table of
        profiles, see ``presswear.scene.surfaces``.

    Raises
    ------
    InputError
        If the source is missing or cannot be read.
    """
    text = f"{source}"
    if text.lower().endswith(TABLE):
        return read_profiles(Path(text))
    folder, colon, stage = text.rpartition(":")
    if not colon or Path(text).is_dir():
        folder, stage = text, ""
    elif not (stage.isascii() and stage.isdigit() and len(stage) < 10):
        raise InputError(f"{text}: behind the colon a stage, 0, 1, 2 ..., is expected")
    check_folder(Path(folder))
    result = load(folder)
    if not result.stages:
        raise InputError(f"{folder} has no finished stage")
    return result.stage(int(stage or result.stages[-1].index)).surfaces
