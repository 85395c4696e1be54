"""A result, the same in memory and on disk.

On disk ``result.json`` holds the scene, the provenance, the statistics and the digests
of all files; ``stage-K.npz`` the arrays of stage K, ``film-K.npz`` its film.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from presswear.linkage.linkage import Linkage
from presswear.recording.film import Film
from presswear.recording.statistics import Estimate
from presswear.results.drives import DriveResult, drives_of
from presswear.results.folder import FILE, FINISHED, StoredResult, files_of, read_stored
from presswear.results.frame_load import FrameLoad, frame_loads
from presswear.results.guide_tilt import GuideTilt, guide_tilts
from presswear.results.life import FILE as LIFE
from presswear.results.life import PRELIMINARY, QUICK, WITHOUT_CURVES, LifeResult
from presswear.results.pin_load import elastic_pin_forces
from presswear.results.run_warnings import run_warnings
from presswear.results.stage import StageResult
from presswear.results.stage_statistics import JointStatistics
from presswear.results.stored_arrays import (
    MAX_BYTES,
    check_numbers,
    check_shapes,
    check_stage,
)
from presswear.results.strokes import Strokes, height_of, process_force, strokes_of
from presswear.results.tonnage import Tonnage, tonnage_of
from presswear.scene.catalog import name_of
from presswear.scene.files import TABLE, read_profiles
from presswear.scene.initial_surfaces import Surfaces
from presswear.scene.scene import Scene
from presswear.scene.stage_names import stage_name
from presswear.tools.arguments import checked_arguments
from presswear.tools.arrays import Array, read_numbers
from presswear.tools.errors import InputError, printable, shown
from presswear.tools.files import check_folder, holder, read_checked
from presswear.tools.numbers import MM3_PER_MILLION, counted, large
from presswear.tools.type_check import check_type

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


class _Stages(tuple[StageResult, ...]):
    """Stages of a result; the error for an unknown stage names the stages that exist."""

    def __getitem__(self, index: Any) -> Any:
        try:
            return super().__getitem__(index)
        except (IndexError, TypeError) as error:
            fault = f"there is no stage {index!r}; it has {_range_of(self)}"
            raise type(error)(fault) from None


def _range_of(stages: tuple[StageResult, ...]) -> str:
    """Return the numbers of the stages, such as ``0 to 2``."""
    if not stages:
        return "none"
    return "0" if len(stages) == 1 else f"0 to {len(stages) - 1}"


_HEAD = (
    "stage",
    "cycles",
    "ended",
    "joint",
    "mean peak force (N)",
    "worn per million strokes (mm³)",
)


@dataclass(frozen=True)
class Result:
    """Result of a scene: its stages, status and provenance."""

    scene: Scene
    stages: tuple[StageResult, ...]
    status: str  # completed, unconverged, failed, interrupted or running
    message: str  # reason why it is not completed; empty if it is completed
    provenance: Mapping[str, Any]  # versions, revision, machine and date
    wall_s: float
    path: Path | None = None  # its folder; None: in memory only
    life: LifeResult | None = None  # service life, if the scene has limits

    def __post_init__(self) -> None:
        check_type("stages", self.stages, tuple[StageResult, ...])
        object.__setattr__(self, "stages", _Stages(self.stages))

    def stage(self, index: int | str) -> StageResult:
        """Return the stage after a number of wear updates, or of a name.

        InputError lists the stored stages.
        """
        names = {self.stage_name(stage.index): stage for stage in self.stages}
        for name, stage in names.items():
            if index in (stage.index, name):
                return stage
        words = f" ({', '.join(names)})" if names else ""
        stored = f"{_range_of(self.stages)}{words}"
        raise InputError(
            f"{self.path or self.scene.name} has no stage {shown(index)}; it has {stored}"
        )

    def stage_name(self, index: int) -> str:
        """Return the name of a stage: its wear updates, or its strokes in a service life."""
        if self.life is None or self.life.ended == QUICK or index == 0:
            return stage_name(index, bool(self.stages) and self.stages[0].is_worn)
        return f"after {large(self.life.strokes * index / self.scene.wear_updates)} strokes"

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

    def frame_loads(self, index: int) -> dict[str, FrameLoad]:
        """Return the loads of elastic frames in a stage by guide; empty without a stroke."""
        return frame_loads(self.scene, self.stage(index))

    def elastic_pin_forces(self, index: int) -> dict[str, Mapping[str, Estimate]]:
        """Return the greatest force of each elastic pin in a stage by phase of a stroke, N."""
        return elastic_pin_forces(self.scene, self.stage(index))

    def guide_tilts(self, index: int) -> dict[str, GuideTilt]:
        """Return tilt and load of slides in a stage by guide; empty without a loose guide."""
        return guide_tilts(self.scene, self.stage(index))

    def drives(self, index: int) -> dict[str, DriveResult]:
        """Return the drives in a stage by their bodies; empty if torques were not stored."""
        return drives_of(self.scene, self.stage(index))

    @property
    def grew_in_steps(self) -> bool:
        """True if a wear update was applied in more than one step."""
        return any(len(stage.wear_steps) > 1 for stage in self.stages)

    def __repr__(self) -> str:
        """Return the scene, the status, the number of stages and the folder in one line."""
        ending = f": {self.message}" if self.message else ""
        where = f", in {self.path}" if self.path else ", in memory"
        count = counted(len(self.stages), "stage")
        text = f"{name_of(self.scene)}, {self.status}{ending}, {count}{where}"
        return printable(f"<Result: {text}>")

    def _repr_html_(self) -> str:
        """Return headline, key numbers and a picture for a notebook."""
        # Imported here, because results are in a lower layer.
        return str(import_module("presswear.show.notebook").html_of(self))

    def __str__(self) -> str:
        """Return a table of the stages, and sentences on deep contacts and rough surfaces."""
        ending = f": {self.message}" if self.message else ""
        where = f", in {self.path}" if self.path else ""
        lines = [f"{name_of(self.scene)}, {self.status}{ending}{where}"]
        if self.life is not None:
            lines.append(f"{self.life}")
        rows = list(self._table_rows())
        columns = max(map(len, rows), default=0)  # without a joint those of stages only
        rows = [
            [*row, *[""] * (columns - len(row))] for row in [_HEAD[:columns], *rows]
        ]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        for row in rows:
            lines.append("  ".join(map(str.ljust, row, widths)).rstrip())
        remark = self.scene.bin_remark
        if remark:
            lines.append(f"worn volume: {remark}")
        lines += run_warnings(self.scene, self.stages)
        return printable("\n".join(lines))

    def _table_rows(self) -> Iterator[list[str]]:
        """Yield a row for each joint of each stage; the first describes the stage."""
        has_clearance = bool(self.scene.clearance_joints)
        for stage in self.stages:
            name = self.stage_name(stage.index) if has_clearance else "computed"
            ended = stage.message or stage.status
            stage_cells = [name, str(stage.statistics.cycles), ended]
            if not stage.statistics.joints:
                yield stage_cells
            for joint_name, joint in stage.statistics.joints.items():
                volume = self._worn_volume(joint_name, joint, stage)
                yield [
                    *stage_cells,
                    joint_name,
                    f"{joint.peak_force_per_cycle}",
                    f"{volume.scaled(MM3_PER_MILLION)}",
                ]
                stage_cells = ["", "", ""]

    def _worn_volume(
        self, name: str, joint: JointStatistics, stage: StageResult
    ) -> Estimate:
        """Return the volume that a pin, or the corner of a slide, wears off in a cycle, m^3."""
        if name not in self.scene.loose_pins:
            materials = self.scene.bearing(name).materials
            return joint.load_distance_per_cycle.scaled(materials.wear_coefficient)
        if joint.is_unworn:
            return Estimate(0.0)
        return joint.wear_volume.scaled(1.0 / stage.cycles_per_update)

    def plot(self, *names: str, stage: int | None = None) -> "list[Axes]":
        """Draw figures and return their axes; a notebook shows the figures.

        Names are life, mechanism, stroke, tonnage, wear, growth, surfaces, response,
        bottom, force, path, tilt, corners, walls, phase, poincare, impacts, modes,
        spectrum, drives, motor, frame and oil; without a name all figures that have
        data are drawn. ``stage`` is the only stage to draw. InputError for an unknown
        name or stage, and for a figure without data.
        """
        # Imported here, because results are in a lower layer.
        return import_module("presswear.show.figures").plot(self, names, stage)

    def report(self) -> Path:
        """Draw the figures and write ``report.html`` into the result's folder; return its path.

        InputError for a result in memory.
        """
        return import_module("presswear.show.report").write_report(self)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the statistics with a row for each stage and a column for each number.

        Needs pandas. The series of a stage are those of ``stage.to_pandas()``.
        """
        import pandas

        table = pandas.json_normalize(
            [asdict(stage.statistics) for stage in self.stages]
        )
        names = [self.stage_name(stage.index) for stage in self.stages]
        table.index = pandas.Index(names, name="stage")
        return table


def stored_scene(path: Path) -> tuple[Scene, StoredResult]:
    """Return the scene of a result folder and its document."""
    stored = read_stored(path)
    try:
        return Scene.from_dict(stored.scene), stored
    except InputError as error:
        raise InputError(f"{path / FILE}: {error}") from None


@checked_arguments
def load(path: str | Path, trust: bool = False) -> Result:
    """Read a result folder; InputError names parts that are missing, damaged or too new.

    A checkpoint is not read, because a run may replace it at any time.

    Parameters
    ----------
    trust : bool
        Whether this process may execute the Python source code of user laws that the
        result stores. Running the scene again, static equilibria and ideal torques need
        it.
    """
    path = Path(path)
    scene, stored = stored_scene(path)
    if trust:
        scene.trust()
    linkage = scene.linkage()
    stages = []
    joints = tuple(joint.name for joint in linkage.clearances)
    for stage in stored.stages:
        name, film = files_of(stage.index)
        arrays = read_numbers(path / name, stored.files[name], MAX_BYTES)
        check_stage(arrays, scene, linkage)
        check_numbers(arrays, scene, stage)
        read_checked(path / film, stored.files[film], MAX_BYTES)
        read_film = partial(_film, path / film, stored.files[film], linkage)
        stages.append(
            replace(stage, arrays=arrays, joint_names=joints, read_film=read_film)
        )
    life = stored.life
    if life is not None and life.ended not in WITHOUT_CURVES:
        curves = read_numbers(path / LIFE, stored.files[LIFE], MAX_BYTES)
        shapes: dict[str, tuple[str | int, ...]] = dict.fromkeys(curves, ("strokes", 3))
        shapes["strokes"] = ("strokes",)
        check_shapes(curves, shapes)
        life = replace(life, curves=curves)
    return Result(
        scene,
        tuple(stages),
        status=stored.status,
        message=stored.message,
        provenance=stored.provenance,
        wall_s=stored.wall_s,
        path=path,
        life=life,
    )


def _film(file: Path, digest: str, linkage: Linkage) -> Film:
    arrays = read_numbers(file, digest, MAX_BYTES)
    joints = tuple(joint.name for joint in linkage.clearances)
    shapes: dict[str, tuple[str | int, ...]] = dict.fromkeys(arrays, ("frames",))
    shapes["position"] = ("frames", 3 * len(linkage.bodies))
    check_shapes(arrays, shapes)
    try:
        return Film.from_arrays(arrays, len(linkage.bodies), joints)
    except ValueError as error:
        raise InputError(f"{file} is no film: {error}") from None


def unfinished(result: Result) -> str:
    """Return a sentence on a stored run that is unfinished, or an empty text."""
    if result.status in FINISHED or result.path is None:
        return ""
    process = holder(result.path)
    if process:
        how = f"{process} is writing to it"
    elif result.status == "interrupted":
        how = "interrupted"
    else:
        how = result.message or "killed"
    stages = f"{len(result.stages)} of {result.scene.wear_updates + 1} stages"
    if result.life is not None and result.life.ended == PRELIMINARY:
        stages = f"a preliminary life and {stages}"
    return f"{result.path} is unfinished ({how}): {stages} are stored"


@checked_arguments
def read_surfaces(source: str | Path) -> Surfaces:
    """Return the surfaces of a stage of a result, or measured ones.

    Parameters
    ----------
    source : str or Path
        ``DIR:STAGE``: surfaces that the stage ran on, the mean of its replicates, such
        as 1 for the surfaces after the first wear update; ``DIR``: those of its last
        stage; ``FILE.csv``: a table of profiles, see
        ``presswear.scene.files.read_profiles``.
    """
    text = f"{source}"
    if text.lower().endswith(TABLE):
        return read_profiles(Path(text))
    folder, colon, stage = text.rpartition(":")
    if not colon or Path(text).is_dir():
        folder = text
        stage = ""
    elif not (stage.isascii() and stage.isdigit() and len(stage) < 10):
        raise InputError(f"{text}: a stage, 0, 1, 2 ..., must follow the colon")
    check_folder(Path(folder))
    result = load(folder)
    if not result.stages:
        raise InputError(f"{folder} has no finished stage")
    return result.stage(int(stage or result.stages[-1].index)).surfaces
