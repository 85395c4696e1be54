"""One linkage run from several starts: draws of a chaotic motion, put together.

Starts differ by a hair's breadth.  Within a cycle or two that makes the runs
independent, which cycles of one run need not be.  Each start has worn surfaces of its own, so
that what follows a wear is independent too.  Behind a wear in one jump they run in two sets:
together on the surfaces that all their maps give, and each alone.
"""

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.progress import Forecast
from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run, Status
from presswear.linkage.elements import ClearanceJoint, Linkage
from presswear.linkage.surface import Surface
from presswear.record.recorder import Recorder
from presswear.record.sampling import (
    LEAST_SAMPLES,
    STARTUP_CYCLES,
    map_batches,
    map_errors,
    mean_map,
)
from presswear.record.soundness import Finding
from presswear.record.tracker import Tracker
from presswear.results.stage import SIDES
from presswear.scene.scene import Scene
from presswear.tools.arrays import State

Array = NDArray[np.float64]

FEWEST = 16
"""Samples of all starts before a stage may end because its maps are known: fewer agree by luck."""

_LARGEST = ("deepest_touch_m", "constraint_error_m", "constraint_velocity_error_m_s")
"""Diagnostics of which the largest counts, not the sum."""


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
        How well the wear maps must be known from all starts together for a run to end before;
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
class Ensemble:
    """A linkage that ran, from one start or several.

    Attributes
    ----------
    linkage : Linkage
        On the surfaces that the scene begins on.
    worn : ndarray, shape (runs, joints, 2, m)
        Depth of the surfaces that each run began with, m.
    runs : tuple of Run
        By start, of one set or two; a failed one is the last.
    starts : int
        Runs of a set.
    wall : float
        s.
    """

    linkage: Linkage
    worn: Array
    runs: tuple[Run, ...]
    starts: int
    wall: float

    @property
    def together(self) -> "Ensemble":
        """The first set, which the numbers of a stage are from."""
        return self._set(slice(self.starts))

    @property
    def alone(self) -> "Ensemble":
        """The last set, whose runs are independent: each start on surfaces of its own."""
        # Where one of them failed there are fewer runs than surfaces.
        return (
            self._set(slice(self.starts, len(self.runs))) if len(self.runs) > self.starts else self
        )

    def _set(self, part: slice) -> "Ensemble":
        return replace(self, worn=self.worn[part], runs=self.runs[part])

    @property
    def recorders(self) -> tuple[Recorder, ...]:
        """The recorders of the runs."""
        return tuple(run.recorder for run in self.runs)

    @property
    def cycles(self) -> int:
        """Cycles finished, of all runs."""
        return sum(len(recorder.cycles) for recorder in self.recorders)

    @property
    def failure(self) -> str:
        """Why it failed, or nothing."""
        last = self.runs[-1]
        if last.status != "failed":
            return ""
        return last.message if len(self.runs) == 1 else f"start {len(self.runs)}: {last.message}"

    @property
    def finding(self) -> Finding | None:
        """The finding that ended it, where it failed."""
        return self.runs[-1].finding

    @property
    def status(self) -> Status:
        """``failed``, ``enough`` where the maps were known early, or ``completed``."""
        if self.failure:
            return "failed"
        return "enough" if any(run.status == "enough" for run in self.runs) else "completed"

    @property
    def time(self) -> float:
        """Simulated time of all runs, s."""
        return sum(run.time for run in self.runs)

    def depth(self) -> Array:
        """Mean depth that one cycle adds, shape (joints, 2, m), m."""
        return mean_map([recorder.maps for recorder in self.recorders])

    def depths(self) -> Array:
        """The same of each start, shape (starts, joints, 2, m), m."""
        return np.array([mean_map([recorder.maps]) for recorder in self.recorders])

    def batches(self) -> tuple[Array, Array]:
        """Wear maps by batches of cycles, and the cycles in each; see ``map_batches``."""
        return map_batches([recorder.maps for recorder in self.recorders])

    def diagnostics(self) -> dict[str, float | int | str]:
        """Diagnostics of the solver: words of the first run, numbers of all."""
        found = dict(self.runs[0].diagnostics)
        for run in self.runs[1:]:
            for key, value in run.diagnostics.items():
                before = found[key]
                if isinstance(value, str) or isinstance(before, str):
                    continue
                found[key] = max(before, value) if key in _LARGEST else before + value
        # Signed residuals of several runs would cancel.
        found["energy_residual_J"] = sum(
            abs(float(run.diagnostics["energy_residual_J"])) for run in self.runs
        )
        if len(self.runs) > 1:
            found["starts"] = len(self.runs)
        return found


@dataclass(frozen=True)
class Partial:
    """An ensemble of which some has run.

    Attributes
    ----------
    runs : tuple of Run
        Of the starts that are finished.
    state : State or None
        Of the run of the next one; None: it has not been begun.
    wall : float
        So far, s.
    """

    runs: tuple[Run, ...] = ()
    state: State | None = None
    wall: float = 0.0


NOTHING = Partial()
"""An ensemble of which nothing has run."""


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
    """The plan of each run of a task, without trackers."""
    # Only what a stage is judged by has its series kept.
    recorded = Plan.recorded_cycles if task.wear is None else 1
    return Plan(
        scene.mechanism.period,
        task.cycles,
        recorded,
        torques=scene.drive_torque == "on",
        wear=task.wear,
        run_up=scene.run_up,
    )


def run_ensemble(
    scene: Scene,
    worn: Array,
    task: Task,
    forecast: Forecast,
    begun: Partial = NOTHING,
    keep: Callable[[Partial], None] = lambda partial: None,
) -> Ensemble:
    """Run the linkage from every start on its surfaces, in one set or two.

    Parameters
    ----------
    worn : ndarray, shape (runs, joints, 2, m)
        Depth of the surfaces of each run, m.
    begun : Partial
        What has run already.
    keep : callable
        Told after each cycle what has run.
    """
    began = clock.perf_counter() - begun.wall
    runs, state = list(begun.runs), begun.state
    for index in range(len(runs), len(worn)):
        linkage = linkage_on(scene, worn[index])
        earlier = [run.recorder for run in runs]
        watching = _Watching(scene, linkage, task, forecast, earlier, len(worn))
        storing = _Storing(tuple(runs), began, keep)
        plan = replace(
            plan_of(scene, task),
            trackers=(storing, watching, *forecast.trackers),
            resume=state,
        )
        state = None
        start = start_of(scene, index + scene.draws * task.number)
        runs.append(scene.solver.simulate(linkage, start, plan))
        if runs[-1].status == "failed":
            break
    wall = clock.perf_counter() - began
    ran = Ensemble(scene.linkage(), worn, tuple(runs), scene.draws, wall)
    forecast.done += ran.cycles / scene.draws
    return ran


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


@dataclass
class _Storing(Tracker):
    """Hands on what has run of an ensemble, after each cycle."""

    runs: tuple[Run, ...]
    began: float
    keep: Callable[[Partial], None]

    def cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        self.keep(Partial(self.runs, state(), clock.perf_counter() - self.began))
        return False


class _Watching(Tracker):
    """Ends a run whose wear maps are known or whose surfaces are gone; tells how far it is."""

    def __init__(
        self,
        scene: Scene,
        linkage: Linkage,
        task: Task,
        forecast: Forecast,
        before: Sequence[Recorder],
        runs: int,
    ) -> None:
        self._starts, self._linkage, self._task = scene.draws, linkage, task
        self._forecast, self._before, self._runs = forecast, len(before), runs
        # Those of its own set.
        self._earlier = before[len(before) - len(before) % scene.draws :]
        earlier = self._earlier
        # Each start adds its part: after k of n the error is that of k n-ths of the cycles.
        self._share = (len(earlier) + 1) / scene.draws
        # As many as the starts before it took, until its own maps tell.
        self._needed = float(max((len(own.cycles) for own in earlier), default=task.cycles))
        self._word = task.word

    def begun(self, recorder: Recorder) -> None:
        self._recorder = recorder

    def cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        joints = self._linkage.clearances
        if not joints:
            return False
        start = f"start {len(self._earlier) + 1}, " if self._starts > 1 else ""
        if self._before >= self._starts:
            start += "alone, "
        done = len(recorder.cycles)
        if self._task.wear is not None:
            self._word = f"{self._task.word}, {start}cycle {done}"
            return worn_out(joints, recorder.worn) is not None
        maps = [*(earlier.maps for earlier in self._earlier), recorder.maps]
        samples = sum(run.samples for run in maps)
        if done < STARTUP_CYCLES + LEAST_SAMPLES or samples < FEWEST * self._share:
            return False
        error = float(map_errors(*map_batches(maps)).max())
        self._word = f"{start}cycle {done}, wear maps known to {100.0 * error:.0f} %"
        if self._task.tolerance is None:
            return False
        # The error falls with the square root of the number of cycles.
        tolerance = self._task.tolerance / math.sqrt(self._share)
        lacking = samples * ((error / tolerance) ** 2 - 1.0)
        self._needed = min(float(self._task.cycles), done + max(lacking, 1.0))
        return error <= tolerance

    def advanced(self, part: float) -> None:
        own = min(part * self._task.cycles / self._needed, 1.0)
        run = (self._before + own) / self._starts * self._needed
        needed = self._runs / self._starts * self._needed
        self._forecast.tell(run, needed, self._word, self._linkage, self._recorder)
