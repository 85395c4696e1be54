"""Progress of a run, and what it prints at the end of each stage."""

import logging
import sys
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import Progress as ProgressBar

from presswear.cli import terminal
from presswear.linkage.guide_corner import CORNERS
from presswear.recording.observer import COMPILING, Observer, Progress
from presswear.recording.statistics import Estimate
from presswear.results.motions import state_of
from presswear.scene.scene import Scene
from presswear.tools.numbers import counted, duration_text, large, unit_scale
from presswear.tools.processes import check_stopped

if TYPE_CHECKING:
    from presswear.results.life import LifeResult
    from presswear.results.stage import StageResult

LOGGER = logging.getLogger(__name__)
LINE_INTERVAL = 60.0  # time between lines of progress where there is no terminal, s
LONG_LIFE = 600.0  # time above which a user confirms a service life, s
# Largest ratio of the time of a life to the time expected after its first blocks. The
# number of refinements and the time of a cycle on worn surfaces are not yet available.
LIFE_SPREAD = 2.0
# Cycles of all replicates from which the text mentions ``--quick``: ten minutes at 0.3 s
MANY_CYCLES = 2000
BAR_DELAY = 3.0  # time after which a run in Python shows its bar, s
SHOWN_JOINTS = 3  # joints in the lines of a stage
LIFE = "life,"  # start of the description of a step that follows a service life


class RunObserver(Observer):
    """Observer that shows the progress of a run and prints each finished stage."""

    def __init__(
        self, bar: ProgressBar, scene: Scene, is_confirmed: bool = True
    ) -> None:
        self._bar = bar
        self._scene = scene
        self._is_confirmed = is_confirmed
        self._compile_time = 0.0  # compile time of this stage, s
        # Time without progress: before the first report, and of compilation, s
        self._idle_time = 0.0
        self._compile_start: float | None = None
        # Completed share at the first report; above 0 in a resumed run
        self._first_share: float | None = None
        self._task = bar.add_task(step_text(scene, 0, ""), total=1.0)
        self._started = clock.perf_counter()
        self._printed = self._started  # time of the last line of progress

    def on_progress(self, progress: Progress) -> None:
        """Update the progress bar; raise KeyboardInterrupt after a signal.

        The time in which kernels are compiled does not count as computing time.
        """
        if progress.word == COMPILING:
            self._compile_start = self._compile_start or clock.perf_counter()
            self._bar.update(self._task, description="compiling, once")
            return
        check_stopped()
        text = step_text(self._scene, progress.stage, progress.word)
        if self._compile_start is not None:
            duration = clock.perf_counter() - self._compile_start
            self._idle_time += duration
            # The time of a stage does not include the wear update after it.
            if not text.startswith("applying"):
                self._compile_time += duration
            self._compile_start = None
        share = progress.estimate or progress.whole
        if self._first_share is None:
            self._first_share = share
            self._idle_time = clock.perf_counter() - self._started
        self._bar.update(
            self._task,
            description=text,
            completed=progress.whole,
            idle=self._idle_time,
            share=share,
            start=self._first_share,
        )
        if self._bar.disable and clock.perf_counter() > self._printed + LINE_INTERVAL:
            self._printed = clock.perf_counter()
            remaining = terminal.time_left(self._bar.tasks[self._task])
            line = f"{text}, {100.0 * progress.whole:.0f} % {remaining}".rstrip()
            terminal.print_lines(self._bar.console, line)

    def on_life_start(self, cycles: float, seconds: float) -> None:
        """Print the expected time of a life; ask a user at a terminal before a long one."""
        terminal.print_lines(self._bar.console, f"the life {needed(cycles, seconds)}")
        started = clock.perf_counter()
        if not self._is_confirmed:
            confirm(self._bar, seconds)
        self._idle_time += clock.perf_counter() - started

    def on_life(self, life: "LifeResult") -> None:
        """Print the service life."""
        terminal.print_lines(self._bar.console, f"{life}")
        self._compile_time = 0.0  # it belongs to no stage

    def on_stage(self, stage: "StageResult") -> None:
        """Print the cost of a stage, forces and wear, and whether the motion has settled."""
        model = stage.diagnostics["model"]
        solver = stage.diagnostics["solver"]
        LOGGER.info("%s: %s. %s", stage.name, model, solver)
        wall_s = stage.wall_s - self._compile_time
        speed = wall_s / stage.simulated_s if stage.simulated_s > 0.0 else float("nan")
        cycles = f"{counted(stage.statistics.cycles, 'cycle')} of all replicates"
        lines = [f"{stage.name}: {cycles}, {speed:.2f} s per simulated second"]
        joints = stage.statistics.joints.items()
        forces = {name: joint.peak_force_per_cycle for name, joint in joints}
        lines += _largest("mean peak force", "N", forces)
        settling = stage.statistics.settling
        if settling is not None:
            lines.append(f"  motion: {state_of(settling)}")
        remark = self._scene.bin_remark
        volumes = self._worn_volumes(stage)
        for line in _largest("wear per 10⁶ strokes", "m^3", volumes):
            lines.append(f"{line} ({remark})" if remark else line)
        terminal.print_lines(self._bar.console, *lines)
        self._compile_time = 0.0

    def _worn_volumes(self, stage: "StageResult") -> dict[str, Estimate]:
        """Return the worn volumes of pin joints and walls in a million strokes, m^3."""
        corners = []
        for guide in self._scene.loose_guides:
            corners += [f"{guide.name} {corner}" for corner in CORNERS]
        volumes = {}
        for name, joint in stage.statistics.joints.items():
            if name not in corners and not joint.is_unworn:
                volumes[name] = joint.wear_volume.scaled(1e6 / stage.cycles_per_update)
        for name, walls in stage.statistics.walls.items():
            for side, wall in walls.items():
                volumes[f"{side} wall of {name}"] = wall.volume_per_cycle.scaled(1e6)
        return volumes


@contextmanager
def late_bar(scene: Scene) -> Iterator[Observer]:
    """Yield an observer that shows a progress bar while a run lasts, after a few seconds."""
    bar = terminal.progress_bar(Console(stderr=True))
    bar.live.transient = True
    inner = RunObserver(bar, scene)
    start = clock.perf_counter()

    class Late(Observer):
        def on_progress(self, progress: Progress) -> None:
            inner.on_progress(progress)
            if clock.perf_counter() > start + BAR_DELAY:
                bar.start()

    try:
        yield Late()
    finally:
        bar.stop()


def step_text(scene: Scene, stage: int, step: str) -> str:
    """Return a description of the present step of a run, from ``Progress.word``."""
    if step.startswith(LIFE):
        return step
    if step.startswith(scene.stage_name(stage + 1)):
        return f"applying the {step}"
    name = f"after the {scene.stage_name(stage)}" if stage else scene.stage_name(stage)
    return f"{name}: {step}" if step else name


def _largest(words: str, unit: str, values: dict[str, Estimate]) -> list[str]:
    """Return a line with the largest values of joints; no line if all are zero."""
    names = sorted(values, key=lambda name: -values[name].mean)
    if not names or not values[names[0]].mean:
        return []
    factor, display = unit_scale(unit, values[names[0]].mean)
    texts = [f"{name} {values[name].scaled(factor)}" for name in names[:SHOWN_JOINTS]]
    if len(names) > SHOWN_JOINTS:
        texts.append(f"{len(names) - SHOWN_JOINTS} more")
    return [f"  {words}, {display}: {', '.join(texts)}"]


def needed(cycles: float, seconds: float) -> str:
    """Return the remaining cycles and time of a life in words."""
    count = large(cycles, digits=2)
    return (
        f"needs about {count} cycles of all replicates, {expected_time(seconds)} more"
    )


def expected_time(seconds: float) -> str:
    """Return the range of the time of a life in words."""
    return duration_text(seconds / LIFE_SPREAD, seconds * LIFE_SPREAD)


def least_needed(cycles: float) -> str:
    """Return the least number of cycles of a life in words, before anything has run."""
    count = large(cycles, digits=1)
    text = f"needs at least about {count} cycles of all replicates"
    text += "; after its first strokes follow a closer number and the time"
    if cycles >= MANY_CYCLES:
        text += (
            "; `presswear life --quick` estimates the strokes to a depth in two short "
            "stages, without an interval"
        )
    return text


def confirm(bar: ProgressBar, seconds: float) -> bool:
    """Ask a user at a terminal before a life that may be long; return whether a user was asked.

    Raises
    ------
    KeyboardInterrupt
        If the answer is no.
    """
    if not (bar.console.is_terminal and sys.stdin.isatty()):
        return False
    if LIFE_SPREAD * seconds <= LONG_LIFE:
        return False
    bar.stop()
    answer = input("continue? [y/N] (--yes: do not ask) ")
    if answer.strip().lower() not in ("y", "yes"):
        raise KeyboardInterrupt
    bar.start()
    return True
