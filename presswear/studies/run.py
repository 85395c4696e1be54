"""Run a scene or a study: the entry for scripts."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import overload

from presswear.campaign.single import run_scene, with_engine
from presswear.engines.settings import Engine
from presswear.recording.tracker import Tracker
from presswear.results.result import Result
from presswear.scene.scene import Scene
from presswear.studies.plan import Study, results_of
from presswear.tools.checked import checked
from presswear.tools.errors import InputError


@overload
def run(
    scene: Scene,
    folder: str | Path | None = None,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    trackers: Sequence[Tracker] = (),
    check: bool = True,
) -> Result: ...


@overload
def run(
    scene: Study,
    folder: str | Path | None = None,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    trackers: Sequence[Tracker] = (),
    check: bool = True,
    on: str = "",
    shard: str = "1/1",
) -> dict[str, Result]: ...


@checked
def run(
    scene: Scene | Study,
    folder: str | Path | None = None,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    trackers: Sequence[Tracker] = (),
    check: bool = True,
    on: str = "",
    shard: str = "1/1",
) -> Result | dict[str, Result]:
    """Run a scene through all its stages, or each variant of a study.

    Parameters
    ----------
    scene : Scene or Study
    folder : path or None
        Where the result is kept; a run of the same scene that stands in it is gone on with,
        and one that is finished is read.  None: in memory only; a study needs one.
    engine : str, engine or None
        A word, such as ``dae``, or an engine with its settings, such as
        ``ExudynTree(tree_tolerance=1e-10)``; None: the scene's.
    jobs : int or None
        Runs at a time, of starts or of a study's variants; None: as many as there are cores.
        No number depends on it.
    trackers : sequence of Tracker
        Told what happens.
    check : bool
        Whether a scene that failed raises.  A variant of a study that fails is a result.
    on : str
        What does the runs of a study: ``dask``, ``dask://HOST:PORT`` or ``MODULE:FACTORY``;
        nothing: processes of this machine.
    shard : str
        ``K/N``: of a study every N-th run from the K-th.

    Returns
    -------
    Result or dict
        Of a study the results by the keys of its variants.

    Raises
    ------
    RunFailed
        With its finding, where the run failed and that is checked, or where its folder is
        lost.
    InputError
        Where the scene, or what stands in the folder, does not allow it.
    """
    if jobs is not None and jobs < 1:
        raise InputError(f"jobs = {jobs}: a number from 1 is expected")
    if isinstance(scene, Scene):
        if on or shard != "1/1":
            raise InputError("on and shard are for the runs of a study; this is one scene")
        return run_scene(scene, folder, engine, trackers, check, jobs)
    if folder is None:
        raise InputError(f"the study {scene.name} needs a folder for its runs")
    variants = tuple(replace(v, scene=with_engine(v.scene, engine)) for v in scene.variants)
    study, path = replace(scene, variants=variants), Path(folder)
    # Half of it is of no use to a scene.
    from presswear.studies.rows import run_study
    from presswear.sweeps.sweep import shard_given

    run_study(study, path, jobs, True, trackers, on=on, shard=shard_given(shard))
    return {v.key: result for v, result in results_of(study, path) if result is not None}
