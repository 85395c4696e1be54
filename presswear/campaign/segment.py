"""A segment of a run: the unit of work, wherever it is done.

A pure function of plain data: what is run on which surfaces from which start, the state to go on
from, and how far; it gives the state that is reached.  Nothing of it is tied to a process or a
machine, but for the last digits that processors differ in.
"""

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, Start, Status, recorder_of
from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import Surface
from presswear.physics.bottom import bottom_of
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.recording.statistics import RANGE_STROKES, STARTUP_CYCLES, MapBatches
from presswear.results.stage import SIDES
from presswear.scene.scene import Scene
from presswear.tools.arrays import State, named, part
from presswear.tools.compile import on_compiling
from presswear.tools.stopping import is_stopped
from presswear.tools.workers import Report, Stopped

Array = NDArray[np.float64]

Wear = Callable[[int, Array], Array]
"""See ``Plan.wear``."""


@dataclass(frozen=True)
class Task:
    """What the runs of an ensemble are made for.

    Attributes
    ----------
    cycles : int
        Most cycles of each start.
    tolerance : float or None
        How well the wear maps must be known from all starts together for the runs to end before;
        None: all cycles are run.
    wear : callable or None
        How the surfaces wear meanwhile; None: they stay.
    number : int
        Of the task in its stage: no two of them begin alike.
    word : str
        The task in a few words, or nothing.
    """

    cycles: int
    tolerance: float | None = None
    wear: Wear | None = None
    number: int = 0
    word: str = ""


@dataclass(frozen=True)
class Reached:
    """How far a run has come.

    Attributes
    ----------
    state : State
        Its recorder's and, where it can be gone on with, its engine's.
    status : Status or None
        As ``Run.status``; None: it was left between two cycles, and the rest is not known.
    finding : Finding or None
    end : Start or None
    time : float
        s.
    diagnostics : dict
    """

    state: State
    status: Status | None = None
    finding: Finding | None = None
    end: Start | None = None
    time: float = 0.0
    diagnostics: Mapping[str, float | int | str] = field(default_factory=dict)

    @property
    def cycles(self) -> int:
        """Cycles finished."""
        return len(self.state["recorder/cycles"])

    @property
    def maps(self) -> MapBatches:
        """Wear maps of those cycles."""
        return MapBatches.stored(part(self.state, "recorder/maps"))

    def run(self, scene: Scene, task: Task, worn: Array) -> Run:
        """The run of a task on surfaces, where it is known how it ended."""
        assert self.status is not None, "a run that goes on has no outcome"
        assert self.end is not None, "a run that ended is somewhere"
        recorder = recorder_of(linkage_on(scene, worn), start_of(scene), plan_of(scene, task))
        recorder.restore(part(self.state, "recorder"))
        told = dict(self.diagnostics)
        return Run(self.status, self.finding, recorder, self.end, self.time, told)

    @staticmethod
    def of(run: Run, state: State | None = None) -> "Reached":
        """Where a run has ended, with the state to go on from, where there is one."""
        if state is None:
            state = named("recorder", run.recorder.state())
        return Reached(state, run.status, run.finding, run.end, run.time, run.diagnostics)


def linkage_on(scene: Scene, worn: Array) -> Linkage:
    """The linkage of a scene on worn surfaces.

    Parameters
    ----------
    worn : ndarray, shape (joints, 2, m)
        Their depth, m; see ``map_shape``.
    """
    surfaces = {}
    for joint, (bearing, pin) in zip(scene.linkage().clearances, worn, strict=True):
        surfaces[joint.name] = Surface(bearing[: joint.bins]), Surface(pin[: joint.bins])
    return scene.linkage(surfaces)


def plan_of(scene: Scene, task: Task) -> Plan:
    """The plan of each run of a task, without observers."""
    # Strokes on work are samples of what is asked of joints and drives.
    judged = Plan.recorded_cycles if scene.process is None else STARTUP_CYCLES + RANGE_STROKES
    own = scene.recording
    if own.recorded_cycles is not None:
        judged = own.recorded_cycles
    bottom = bottom_of(scene.ideal)
    # Only what a stage is judged by has its series kept.
    return Plan(
        scene.mechanism.period,
        task.cycles,
        judged if task.wear is None else 1,
        rows_per_cycle=own.rows_per_cycle,
        sections=own.phases if task.wear is None else (),
        torques=scene.stores_torques,
        wear=task.wear,
        run_up=scene.run_up,
        stroke=None if bottom is None else bottom.window,
    )


def worn_out(joints: Sequence[ClearanceJoint], worn: Array) -> tuple[str, str] | None:
    """Which joint has lost too much, and how much; None if none.

    A bearing or pin that is worn deeper than the clearance is no pin in a round bearing any
    more: a small clearance is what the whole model rests on.

    Parameters
    ----------
    worn : ndarray, shape (joints, 2, m)
        Depth of its surfaces, m.
    """
    for joint, own in zip(joints, worn, strict=True):
        for name, depth in zip(SIDES, own, strict=True):
            deepest = float(depth.max(initial=0.0))
            if deepest > joint.clearance:
                return joint.name, (
                    f"the {name} would lose {deepest:.3g} m, more than the clearance of "
                    f"{joint.clearance:.3g} m"
                )
    return None


@dataclass(frozen=True)
class Segment:
    """A segment of a run.

    Attributes
    ----------
    scene : Scene
    task : Task
    worn : ndarray, shape (joints, 2, m)
        Depth of the surfaces that the run begins on, m.
    start : int
        Of several; see ``start_of``.
    until : int
        Cycles, from the run's beginning, after which it ends.
    state : State or None
        State to go on from; None: the run begins.
    lasts : float
        Wall time after which it ends as soon as a cycle does, s.
    frames : int
        Frames of the film to be shown while it runs.
    observers : tuple of Observer
        Told what the engine tells, in this process.
    """

    scene: Scene
    task: Task
    worn: Array
    start: int
    until: int
    state: State | None
    lasts: float
    frames: int = 0
    observers: tuple[Observer, ...] = ()

    def __call__(self, report: Report) -> Reached:
        """Run it; Stopped, with what was reached, where that is interrupted."""
        with on_compiling(lambda seconds: report(math.nan, "compiling")):
            return self._run(report)

    def _run(self, report: Report) -> Reached:
        linkage = linkage_on(self.scene, self.worn)
        hearing = _Hearing(self, linkage, report)
        observers = (hearing, *self.observers)
        plan = replace(plan_of(self.scene, self.task), observers=observers, resume=self.state)
        try:
            run = self.scene.solver.simulate(linkage, start_of(self.scene, self.start), plan)
        except BaseException as error:
            # Behind a signal any error is one of being stopped.
            if hearing.state is None or not (isinstance(error, KeyboardInterrupt) or is_stopped()):
                raise
            raise Stopped(Reached(hearing.state)) from None
        if run.status == "failed" or hearing.state is None:
            return Reached.of(run)
        reached = Reached.of(run, hearing.state)
        return replace(reached, status=None) if hearing.is_left else reached


class _Hearing(Observer):
    """Hears what a run does; ends it where it is to, and keeps the state to go on from."""

    def __init__(self, segment: Segment, linkage: Linkage, report: Report) -> None:
        self._segment, self._joints, self._report = segment, linkage.clearances, report
        self._began = clock.perf_counter()
        self._before = 0
        self.state = segment.state
        self.is_left = False
        if segment.state is not None:
            self._before = len(segment.state["recorder/cycles"])

    def on_start(self, recorder: Recorder) -> None:
        self._recorder = recorder

    def on_cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        done, segment = len(recorder.cycles), self._segment
        if done > self._before:
            self.state = state()
        is_gone = segment.task.wear is not None and worn_out(self._joints, recorder.worn)
        if is_gone or done >= segment.until:
            return True
        is_due = clock.perf_counter() - self._began >= segment.lasts
        self.is_left = is_due and done > self._before
        return self.is_left

    def on_advance(self, part: float) -> None:
        frames = self._segment.frames
        rows = self._recorder.last_frames(frames) if frames else None
        self._report(part * self._segment.task.cycles, "", rows)


def stored(prefix: str, reached: Reached, arrays: dict[str, Any]) -> dict[str, Any]:
    """A run that has come so far as a document; its arrays are added to those given."""
    arrays |= named(f"{prefix}/state", reached.state)
    if reached.end is not None:
        arrays |= {f"{prefix}/q": reached.end.position, f"{prefix}/v": reached.end.velocity}
    finding = reached.finding
    return {
        "status": reached.status,
        "finding": None if finding is None else vars(finding),
        "time": reached.time,
        "diagnostics": dict(reached.diagnostics),
    }


def restored(prefix: str, told: Mapping[str, Any], arrays: State) -> Reached:
    """What ``stored`` gave."""
    own = part(arrays, prefix)
    end = Start(own["q"], own["v"]) if "q" in own else None
    finding = Finding(**told["finding"]) if told["finding"] else None
    state = part(own, "state")
    return Reached(state, told["status"], finding, end, told["time"], told["diagnostics"])
