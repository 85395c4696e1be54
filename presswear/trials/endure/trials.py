"""All trials, in the order in which they are run."""

import signal
from collections.abc import Callable
from functools import partial

from presswear.trials.endure.altered import altered_results
from presswear.trials.endure.folders import damaged, deleted, disk_full, read_only, two_runs
from presswear.trials.endure.inputs import bad_scenes
from presswear.trials.endure.kills import killed
from presswear.trials.endure.memory import bounded
from presswear.trials.endure.scenes import valid_scenes
from presswear.trials.endure.subject import Progress
from presswear.trials.endure.trial import Trial

Attempt = Callable[[Progress], Trial]

SEED = 20240131
"""Of all random moments and places."""

SCENE_STEPS = 5000
"""Of a random scene: most do not get through a cycle in so few, some would take millions."""


def attempts(quick: bool) -> tuple[Attempt, ...]:
    """What is tried; quickly, a few of each."""

    def stopped(number: signal.Signals, often: int, rarely: int) -> Attempt:
        count = rarely if quick else often
        return lambda progress: killed(number, count, SEED, progress)

    def drawn(
        trial: Callable[[int, int, Callable[[float], None]], Trial], word: str, count: int
    ) -> Attempt:
        return lambda progress: trial(count, SEED, partial(progress, word))

    scenes = partial(valid_scenes, most=SCENE_STEPS)
    sizes = ("600k",) if quick else ("16k", "300k", "600k", "900k", "1200k")
    few, many = (20, 200) if quick else (200, 2000)
    return (
        drawn(bad_scenes, "bad input", 300 if quick else 5000),
        drawn(altered_results, "altered results", 120 if quick else 3000),
        drawn(scenes, "random scenes", 5 if quick else 300),
        stopped(signal.SIGKILL, 50, 3),
        stopped(signal.SIGINT, 20, 2),
        stopped(signal.SIGTERM, 20, 2),
        partial(disk_full, sizes),
        read_only,
        partial(deleted, 1 if quick else 5, SEED),
        partial(two_runs, 1 if quick else 3),
        partial(damaged, 5 if quick else 100, SEED),
        partial(bounded, "dae", few, many),
        *(() if quick else (partial(bounded, "exudyn-tree", few, many),)),
    )
