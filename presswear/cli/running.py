"""The observer that tells of a run on the terminal."""

import time as clock

from rich.progress import Progress as Bar

from presswear.cli.terminal import Foretold
from presswear.recording.observer import Observer, Progress
from presswear.results.life import LifeResult
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.numbers import with_interval
from presswear.tools.processes import check_stopped

LIFE = "life,"
"""Begin of words on a life, which stands for itself."""


class Terminal(Observer):
    """Shows the progress of a campaign, and two lines on each finished stage."""

    def __init__(self, bar: Bar, scene: Scene) -> None:
        self._bar, self._scene = bar, scene
        self._compiled = 0.0  # time in which this stage compiled, s
        self._waits = 0.0  # when it began to, or nothing
        self._foretold = self._foretelling(0)
        self._task = bar.add_task(step_of(scene, 0, ""), total=1.0)

    def on_compile(self) -> None:
        """Show that kernels are compiled, until the run goes on; what that takes is no speed."""
        self._waits = self._waits or clock.perf_counter()
        self._foretold.wait()
        self._bar.update(self._task, description="compiling, once")

    def on_progress(self, progress: Progress) -> None:
        """Show where the campaign stands; ends it where a signal has come."""
        check_stopped()
        if self._waits:
            # The wear after a stage is in the time of none.
            if not is_wear(self._scene, progress.stage, progress.word):
                self._compiled += clock.perf_counter() - self._waits
            self._waits = 0.0
        if progress.stage != self._stage:
            self._foretold = self._foretelling(progress.stage)
        step = step_of(self._scene, progress.stage, progress.word)
        self._bar.update(self._task, description=step, completed=progress.whole)
        self._foretold.hear(progress.part)

    def _foretelling(self, stage: int) -> Foretold:
        """What says how long a stage takes: worn surfaces take longer, so that no more is known."""
        self._stage, left = stage, self._scene.wear_updates - stage
        more = f"; {left} more on worn surfaces follow{'s' * (left == 1)}" if left else ""
        name = step_of(self._scene, stage, "")
        return Foretold(self.on_message, f"stage {stage}, {name},", more)

    def on_message(self, line: str) -> None:
        """Print it."""
        self._bar.console.print(line, highlight=False, soft_wrap=True)

    def on_life(self, life: LifeResult) -> None:
        """Tell what came out."""
        self._bar.console.print(f"{life}", highlight=False, soft_wrap=True)
        self._compiled = 0.0  # in the time of no stage

    def on_stage(self, stage: StageResult) -> None:
        """Tell what was modelled, and what came out."""
        told = stage.diagnostics
        model = f"{stage.name}: {told['model']}. {told['solver']}"
        self._bar.console.print(model, highlight=False)
        self._bar.console.print(_stage_line(stage, self._compiled), highlight=False)
        self._compiled = 0.0


def step_of(scene: Scene, stage: int, word: str) -> str:
    """What a campaign does in a stage, in plain words: it runs, or wears the joints after it.

    Parameters
    ----------
    word : str
        Of its progress.
    """
    if word.startswith(LIFE):
        return word
    if is_wear(scene, stage, word):
        return f"applying the {word}"
    name = scene.stage_name(stage)
    name = f"after the {name}" if stage else name
    return f"{name}: {word}" if word else name


def is_wear(scene: Scene, stage: int, word: str) -> bool:
    """True where a word of progress is on the wear after a stage."""
    return word.startswith(scene.stage_name(stage + 1))


def _stage_line(stage: StageResult, compiled: float) -> str:
    """One line on a finished stage: how much ran, how finely, and what came out."""
    wall = stage.wall_s - compiled
    speed = wall / stage.simulated_s if stage.simulated_s > 0.0 else float("nan")
    parts = [
        f"  {stage.cycles} cycles, {stage.diagnostics['steps']} steps, "
        f"{speed:.2f} s per simulated second"
    ]
    for name, joint in stage.statistics.joints.items():
        fewest = joint.min_steps_per_contact
        resolved = (
            "no contact"
            if fewest is None
            else f"at least {fewest} step{'s' * (fewest != 1)} in each"
        )
        force, volume = joint.peak_force_per_cycle, joint.wear_volume.scaled(1e9)
        parts.append(
            f"{name}: {joint.contacts} contacts, {resolved}, mean peak "
            f"{with_interval(force.mean, force.half_width)} N, wear "
            f"{with_interval(volume.mean, volume.half_width)} mm^3"
        )
    return "; ".join(parts)
