"""One linkage run from several starts: draws of a chaotic motion, put together.

Starts differ by a hair's breadth.  Within a cycle or two that makes the runs
independent, which cycles of one run need not be.
"""

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.amplification import Amplification, Sample, Worn, fastest_change
from presswear.campaign.progress import Forecast
from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run, Status, recorder_of
from presswear.linkage.elements import Linkage
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
from presswear.scene.scene import Scene
from presswear.tools.arrays import State

Array = NDArray[np.float64]

FEWEST = 16
"""Samples of all starts before a stage may end because its maps are known: fewer agree by luck."""

_LARGEST = ("deepest_touch_m", "constraint_error_m", "constraint_velocity_error_m_s")
"""Diagnostics of which the largest counts, not the sum."""


@dataclass(frozen=True)
class Ensemble:
    """A linkage that ran, from one start or several.

    Attributes
    ----------
    runs : tuple of Run
        By start; a failed one is the last.
    wall : float
        s.
    """

    linkage: Linkage
    runs: tuple[Run, ...]
    wall: float

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

    def sample(self) -> Sample:
        """The outcome of all runs as far as it tells about wear."""
        joints = self.linkage.clearances

        def peak(k: int) -> float:
            found = [own.each_cycle("force_max", k) for own in self.recorders]
            return float(np.max(np.concatenate(found), initial=0.0))

        return Sample(
            joints,
            max(self.cycles, 1),
            self.depth(),
            {joint.name: peak(k) for k, joint in enumerate(joints)},
            self.wall,
        )


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


def empty_recorder(scene: Scene, linkage: Linkage, index: int) -> Recorder:
    """The recorder of a start's run before it begins."""
    plan = Plan(scene.mechanism.period, 1, torques=scene.drive_torque == "on")
    return recorder_of(linkage, start_of(scene, index), plan)


def run_ensemble(
    scene: Scene,
    worn: Worn,
    remaining: float,
    tolerance: float,
    forecast: Forecast,
    begun: Partial = NOTHING,
    keep: Callable[[Partial], None] = lambda partial: None,
) -> Ensemble:
    """Run the linkage on given surfaces, with some represented cycles of a wear left.

    Parameters
    ----------
    tolerance : float
        How well the wear maps must be known from all starts together, where the scene does
        not say the cycles.
    begun : Partial
        What has run already.
    keep : callable
        Told after each cycle what has run.
    """
    began = clock.perf_counter() - begun.wall
    linkage = scene.linkage(worn)
    runs, state = list(begun.runs), begun.state
    for index in range(len(runs), scene.starts):
        known = _UntilKnown(
            scene, linkage, remaining, tolerance, forecast, [run.recorder for run in runs]
        )
        storing = _Storing(tuple(runs), began, keep)
        plan = Plan(
            scene.mechanism.period,
            known.most,
            torques=scene.drive_torque == "on",
            trackers=(storing, known, *forecast.trackers),
            resume=state,
        )
        state = None
        runs.append(scene.solver.simulate(linkage, start_of(scene, index), plan))
        if runs[-1].status == "failed":
            break
    forecast.done += 1
    return Ensemble(linkage, tuple(runs), clock.perf_counter() - began)


@dataclass
class _Storing(Tracker):
    """Hands on what has run of an ensemble, after each cycle."""

    runs: tuple[Run, ...]
    began: float
    keep: Callable[[Partial], None]

    def cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        self.keep(Partial(self.runs, state(), clock.perf_counter() - self.began))
        return False


class _UntilKnown(Tracker):
    """Ends a run whose wear maps are known, and tells how far it is."""

    def __init__(
        self,
        scene: Scene,
        linkage: Linkage,
        remaining: float,
        tolerance: float,
        forecast: Forecast,
        earlier: Sequence[Recorder],
    ) -> None:
        self._scene, self._linkage, self._remaining = scene, linkage, remaining
        self._forecast, self._earlier = forecast, earlier
        # Each start adds its part: after k of n the error is that of k n-ths of the cycles.
        self._share = (len(earlier) + 1) / scene.starts
        self._tolerance = tolerance / math.sqrt(self._share)
        self.most = scene.cycles or max(scene.most_cycles // scene.starts, 1)
        # Luck in a later step of a wear is made good by the other steps.
        is_first = remaining >= scene.represented_cycles
        self._fewest = FEWEST if is_first else LEAST_SAMPLES
        self._needed = float(self.most)
        self._word = ""

    def begun(self, recorder: Recorder) -> None:
        self._recorder = recorder

    def cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        joints = self._linkage.clearances
        if not joints:
            return False
        maps = [*(earlier.maps for earlier in self._earlier), recorder.maps]
        change = fastest_change(joints, mean_map(maps))
        amplification = Amplification.of(self._scene)
        self._forecast.expect(amplification.steps(change, self._remaining))
        done = len(recorder.cycles)
        samples = sum(run.samples for run in maps)
        if done < STARTUP_CYCLES + LEAST_SAMPLES or samples < self._fewest * self._share:
            return False
        error = float(map_errors(*map_batches(maps)).max())
        start = f"start {len(maps)}, " if self._scene.starts > 1 else ""
        self._word = f"{start}cycle {done}, wear maps known to {100.0 * error:.0f} %"
        if self._scene.cycles is not None:
            return False
        # The error falls with the square root of the number of cycles.
        lacking = samples * ((error / self._tolerance) ** 2 - 1.0)
        self._needed = min(float(self.most), done + max(lacking, 1.0))
        return error <= self._tolerance

    def advanced(self, part: float) -> None:
        own = min(part * self.most / self._needed, 1.0)
        done = (len(self._earlier) + own) / self._scene.starts
        self._forecast.tell(done, self._word, self._linkage, self._recorder)
