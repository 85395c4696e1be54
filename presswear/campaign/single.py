"""One scene, run in memory or into a folder."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from presswear.campaign.campaign import run_campaign
from presswear.campaign.checkpoint import Checkpoint
from presswear.engines.settings import Engine
from presswear.record.soundness import Finding
from presswear.record.tracker import Tracker
from presswear.results.folder import ResultFolder
from presswear.results.provenance import provenance
from presswear.results.result import Result, load
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed


class _Kept(Tracker):
    """Keeps the stages of a run in memory."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []

    def stage(self, stage: StageResult) -> None:
        self.stages.append(stage)


def run_scene(
    scene: Scene,
    folder: str | Path | None = None,
    engine: str | Engine | None = None,
    trackers: Sequence[Tracker] = (),
    check: bool = True,
) -> Result:
    """Run one scene, in memory or into a folder; see ``presswear.run``."""
    scene = with_engine(scene, engine)
    if folder is None:
        kept = _Kept()
        status, message, finding = run_campaign(scene, (kept, *trackers))
        wall = sum(stage.wall_s for stage in kept.stages)
        result = Result(scene, tuple(kept.stages), status, message, provenance(), wall)
    else:
        store = ResultFolder(Path(folder), scene, resume=True)
        finding = run_into(store, scene, trackers)
        result = load(store.path)
        if finding is None and result.stages:
            finding = result.stages[-1].finding
    if check and result.status == "failed":
        raise RunFailed(result.message, finding)
    return result


def run_into(store: ResultFolder, scene: Scene, trackers: Sequence[Tracker] = ()) -> Finding | None:
    """Run a scene into its folder, or go on in it, to the end; returns what ended a failed run."""
    with store:
        if store.is_finished:
            return None
        begun = None if store.resumed is None else Checkpoint.restored(scene, *store.resumed)
        status, message, finding = run_campaign(scene, (store, *trackers), begun)
        store.close(status, message)
    return finding


def with_engine(scene: Scene, engine: str | Engine | None) -> Scene:
    """The scene with an engine by its word, or as an object with its settings."""
    if engine is None:
        return scene
    if isinstance(engine, str):
        return replace(scene, engine=engine)
    return replace(scene, engine=engine.word, numerics=scene.numerics.of(engine))
