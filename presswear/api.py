"""Functions that scripts call: a scene with its progress, and a linkage alone."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from multiprocessing import parent_process
from pathlib import Path

import numpy as np

from presswear.analysis.bifurcation import Cycles, Diagram, Parameter, compute
from presswear.campaign import runs
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.cycle import MAX_CYCLE, MIN_CYCLE
from presswear.linkage.linkage import Linkage
from presswear.physics.curve_following import followed, motion_of
from presswear.recording.observer import Observer
from presswear.recording.series_rows import ROWS_AT_LEAST, ROWS_AT_MOST
from presswear.results.folder import INTERVAL
from presswear.results.result import Result
from presswear.scene.scene import Scene
from presswear.tools.arguments import checked_arguments
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity

ENGINES = {kind.word: kind for kind in (ExudynTree, ExudynJoints, InHouse)}
DURATION = Quantity("s", 0.0, 1e6, "", "duration of a run", open_low=True)


@checked_arguments
def run(
    scene: Scene,
    folder: str | Path | None = None,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    observers: Sequence[Observer] = (),
    check: bool = True,
    interval: float = INTERVAL,
) -> Result:
    """Run a scene through all its stages.

    Parameters
    ----------
    scene : Scene
    folder : path or None
        Folder of the result. An interrupted run of the same scene in it resumes, and a
        finished one is read. None: the result is kept in memory only.
    engine : str, engine or None
        A name, such as ``dae``, or an engine with its settings, such as
        ``ExudynTree(tree_tolerance=1e-10)``; None: the scene's.
    jobs : int or None
        Replicates that run at a time; None: as many as there are cores. No number
        depends on it.
    observers : sequence of Observer
        Notified of what happens. Without one, a run of more than a few seconds shows
        its progress if the standard error is a terminal.
    check : bool
        Whether a failed run raises `RunFailed`.
    interval : float
        Time between two checkpoints in the folder, s.

    Returns
    -------
    Result

    Raises
    ------
    RunFailed
        With its finding, if the run failed and `check` is set, or if its folder is
        lost.
    InputError
        If the scene, or the content of the folder, does not allow the run.
    """
    if observers or not sys.stderr.isatty() or parent_process() is not None:
        return runs.run(scene, folder, engine, jobs, observers, check, interval)
    from presswear.cli.run_observer import late_bar  # slow to import

    with late_bar(scene) as bar:
        return runs.run(scene, folder, engine, jobs, (bar,), check, interval)


@checked_arguments
def bifurcation(
    scene: Scene,
    over: str,
    folder: str | Path,
    cycles: int = 100,
    stored: int | None = None,
    exponent: int = 20,
    jobs: int | None = None,
) -> Diagram:
    """Compute a bifurcation diagram on unworn surfaces, with increasing and decreasing values.

    Parameters
    ----------
    scene : Scene
    over : str
        Setting and its values, such as ``speed=50:600:200 rad/s``.
    folder : path
        Folder of the diagram. An interrupted diagram of the same scene in it resumes, and
        a finished one is read.
    cycles : int
        Cycles at each value.
    stored : int or None
        Last cycles at each value, whose numbers are stored; None: 40 % of ``cycles``.
    exponent : int
        Further cycles for the largest Lyapunov exponent; 0: none.
    jobs : int or None
        Number of processes, at most two; None: as many as there are cores.

    Returns
    -------
    Diagram

    Raises
    ------
    InputError
        If the scene does not allow the values, or the folder holds another diagram.
    """
    counts = Cycles.of(cycles, stored, exponent)
    parameter = Parameter.parse(over, scene)
    return compute(scene, parameter, counts, Path(folder), start_of, jobs)


@checked_arguments
def simulate(
    linkage: Linkage,
    start: Start | None = None,
    duration: float | str | None = None,
    engine: str | Engine = "dae",
) -> Run:
    """Run a linkage once from a start, without replicates, statistics and wear updates.

    Parameters
    ----------
    linkage : Linkage
        Its joints with clearance are in ``clearances``; ``Scene.linkage()`` has those of
        a scene.
    start : Start or None
        Coordinates and rates of all bodies; None: those of the motion with all joints
        closed, at t = 0.
    duration : float, str or None
        Time of the run, s; None: one cycle. Without drives that turn, and without a
        ``cycle`` of the linkage, it is needed.
    engine : str or engine
        A name, or an engine with its settings.

    Returns
    -------
    Run
        ``run.recorder.series("time")`` and ``series("displacement")`` are of the output
        point, ``series("penetration", 0)`` of the first joint with clearance;
        ``run.end`` is the state at the end, and ``run.message`` tells what ended a run
        that failed.

    Raises
    ------
    InputError
        If the engine cannot run this linkage or begin at this start.
    """
    linkage = followed(linkage)
    time = None if duration is None else DURATION.convert("duration", duration)
    has_cycle = linkage.cycle or any(drive.frequencies for drive in linkage.drives)
    if time is not None and not has_cycle:
        linkage = replace(linkage, cycle=min(max(time, MIN_CYCLE), MAX_CYCLE))
    if start is None:
        motion = motion_of(linkage.ideal).at(np.zeros(1))
        start = Start(motion.position[0], motion.velocity[0])
    count = 3 * len(linkage.bodies)
    for name, values in vars(start).items():
        if np.shape(values) != (count,):
            raise InputError(
                f"{name} of the start has shape {np.shape(values)}: expected is ({count},), "
                "three coordinates of each body"
            )
        if not np.all(np.isfinite(values)):
            raise InputError(f"{name} of the start: all numbers must be finite")
    if isinstance(engine, str):
        if engine not in ENGINES:
            raise unknown("engine", engine, ENGINES)
        engine = ENGINES[engine]()
    time = linkage.period if time is None else time
    cycle = min(linkage.period, time)
    rows = min(round(ROWS_AT_LEAST * time / cycle), ROWS_AT_MOST)
    plan = Plan(time, cycles=1, rows_per_cycle=rows, by_clock=True)
    return engine.for_cycle(cycle).simulate(linkage, start, plan)
