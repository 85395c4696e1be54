"""Run several named scenes, each into its own sub-folder of one folder."""

import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from presswear.campaign.single import run, with_engine
from presswear.engines.settings import Engine
from presswear.recording.observer import Observer, Progress
from presswear.results.result import Result, load
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, shown
from presswear.tools.files import inside
from presswear.tools.folders import check_name
from presswear.tools.workers import Report, cores, workers_for

OnProgress = Callable[[str, float, str], object]


def run_scenes(
    scenes: Mapping[str, Scene],
    folder: str | Path,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    on_progress: Any = None,
) -> dict[str, Result]:
    """Run named scenes, several at a time, each into the sub-folder of its name.

    A run that is finished is read. A run that was interrupted resumes. No number depends on
    `jobs` or on the order of the scenes.

    Parameters
    ----------
    scenes : mapping of str to Scene
        Scenes by the names of their sub-folders.
    folder : path
        Folder of all runs.
    engine : str, engine or None
        Engine of every scene, as in `run`; None: each scene's own.
    jobs : int or None
        Scenes that run at a time; None: as many as there are cores.
    on_progress : callable or None
        Called with the name of a scene, the completed fraction of its run, and a few words. At
        1.0 the run has ended and the words are its status.

    Returns
    -------
    dict of str to Result
        Results by name. A scene that failed is a result with the status ``failed``.

    Raises
    ------
    InputError
        If a sub-folder holds the run of another scene, or a scene cannot run.
    """
    if jobs is not None and jobs < 1:
        raise InputError(f"jobs = {jobs}: must be at least 1")
    notify: OnProgress = on_progress or (lambda name, fraction, words: None)
    paths = {}
    for name, scene in scenes.items():
        if not name or name != Path(name).name:
            raise InputError(f"{shown(name)} cannot name the folder of a scene")
        paths[name] = inside(Path(folder).resolve(), name)
        check_name(paths[name])
        scene.check_trusted()
        scene.check()
    names = list(scenes)
    tasks = {
        key: partial(_run, with_engine(scenes[name], engine), paths[name])
        for key, name in enumerate(names)
    }

    def ended(key: int, status: str) -> dict[int, None]:
        notify(names[key], 1.0, status)
        return {}

    def told(key: int, done: float, words: str, _: object) -> None:
        notify(names[key], 0.0 if math.isnan(done) else done, words)

    with workers_for(min(jobs or cores(), len(names)), ("presswear.campaign.segment",)) as workers:
        workers.run(tasks, ended, told)
    return {name: load(path) for name, path in paths.items()}


def _run(scene: Scene, path: Path, report: Report) -> str:
    """Run a scene in this process and return its status, with the reason of a failure."""

    class Reports(Observer):
        def on_progress(self, progress: Progress) -> None:
            report(min(progress.whole, 0.999), progress.word)

        def on_compile(self) -> None:
            report(math.nan, "compiling")

    result = run(scene, path, jobs=1, observers=[Reports()], check=False)
    return f"{result.status}: {result.message}" if result.message else result.status
