"""CPU time of a step of ``dae`` relative to a step of the hand-written loop, and of a first start.

usage: python tests/benchmarks/step_costs.py [--repeats N] [--cycles N] [--no-start]

Both keep the same accounts over the same cycles at the tolerance for wear. The loop is
that of ``adaptive``, with the radial contact of round surfaces; ``dae`` runs with this
contact, on the elastic foundation of round surfaces, and on worn ones. Runs are
interleaved. A first start is a process that runs a cycle of the press with an empty
cache of kernels, a second start the same process with the filled one.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from statistics import median
from typing import NamedTuple

import numpy as np
from adaptive import run
from by_hand import parameters, state_of

from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import linkage_on, start_of
from presswear.campaign.wear_update import cycles_of_update
from presswear.engines.base import Plan
from presswear.engines.settings import LEAST_STEPS, InHouse
from presswear.recording.statistics import mean_map
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.validation.cases import finished

TOLERANCE = 1e-6
SLOPES = 6  # evaluations of a trial step
WEAR_CYCLES = 12  # whose wear makes the worn surfaces
LOOP = "hand-written loop"
START = """
import presswear as pw
pw.run(pw.scenes.wear_times(engine="%s", wear_updates=0, cycles=1, replicates=1, seed=1))
"""
ENGINES = "dae", "exudyn-tree", "exudyn-joints"


class Cost(NamedTuple):
    """CPU time of a run."""

    cpu: float  # s
    steps: int  # attempted
    trials: float  # steps and those that locate events
    cycles: int

    @property
    def step(self) -> float:
        """CPU time of a step, s."""
        return self.cpu / self.steps

    @property
    def trial(self) -> float:
        """CPU time of a trial step, s."""
        return self.cpu / self.trials


def engine_step(scene: Scene, cycles: int, worn: Array | None = None) -> Cost:
    """Run ``dae``."""
    linkage = scene.linkage() if worn is None else linkage_on(scene, worn)
    period = scene.mechanism.period
    engine = InHouse("dopri5", TOLERANCE).resolved("wear").for_cycle(period)
    plan = Plan(period, cycles, 1, torques=False)
    outcome = finished(engine.simulate(linkage, start_of(scene, 1), plan))
    numbers = outcome.diagnostics
    steps = int(numbers["steps"]) + int(numbers["steps_sent_back"])
    return Cost(outcome.cpu, steps, int(numbers["evaluations"]) / SLOPES, cycles)


def loop_step(scene: Scene, cycles: int) -> Cost:
    """Run the hand-written loop."""
    period = scene.mechanism.period
    start = state_of(scene.linkage(), start_of(scene, 1))
    ends = (period * np.arange(1, cycles + 1)).tolist()
    outcome = run(parameters(scene), start, ends, TOLERANCE, period / LEAST_STEPS)
    return Cost(outcome.cpu, outcome.steps, outcome.evaluations / SLOPES, cycles)


def worn_surfaces(scene: Scene) -> Array:
    """Return the depths after one wear update, m."""
    stage, ensemble = run_stage(replace(scene, engine="dae", cycles=WEAR_CYCLES))
    if stage.failed:
        raise SystemExit(stage.message)
    return np.asarray(cycles_of_update(scene, ensemble) * mean_map(ensemble.maps))


def start_times(engine: str) -> list[float]:
    """Return the CPU times of a first and a second start of an engine, s."""
    times = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(2):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            environment = {**os.environ, "XDG_CACHE_HOME": folder}
            subprocess.run(
                [sys.executable, "-c", START % engine], env=environment, check=True
            )
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            times.append(
                after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            )
    return times


def main() -> None:
    """Print the CPU time of a step and its ratio to that of the loop, and of both starts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--repeats", type=int, default=5, help="of each run (default 5)"
    )
    parser.add_argument(
        "--cycles", type=int, default=20, help="of each run (default 20)"
    )
    parser.add_argument(
        "--no-start", action="store_true", help="do not measure a first start"
    )
    arguments = parser.parse_args()
    paper, refined = (wear_times(conventions=name) for name in ("paper", "refined"))
    worn = worn_surfaces(refined)
    cycles = arguments.cycles
    runs: dict[str, Callable[[], Cost]] = {
        LOOP: partial(loop_step, paper, cycles),
        "dae, radial": partial(engine_step, paper, cycles),
        "dae, foundation": partial(engine_step, refined, cycles),
        "dae, worn foundation": partial(engine_step, refined, cycles, worn),
    }
    for each in runs.values():
        each()  # compiles
    rounds = [
        {name: each() for name, each in runs.items()} for _ in range(arguments.repeats)
    ]
    heads = ("us/step", "ratio", "us/trial", "ratio", "steps", "ms/cycle")
    print(f"{'at 1e-6':22}" + "".join(f"{head:>10}" for head in heads))
    for name in runs:
        costs = [one[name] for one in rounds]
        pairs = [(one[name], one[LOOP]) for one in rounds]
        numbers = (
            1e6 * median(cost.step for cost in costs),
            median(cost.step / loop.step for cost, loop in pairs),
            1e6 * median(cost.trial for cost in costs),
            median(cost.trial / loop.trial for cost, loop in pairs),
            costs[0].steps / cycles,
            1e3 * median(cost.cpu for cost in costs) / cycles,
        )
        print(f"{name:22}" + "".join(f"{number:10.4g}" for number in numbers))
    for engine in () if arguments.no_start else ENGINES:
        first, second = start_times(engine)
        print(
            f"first start of {engine}: {first:.1f} s of CPU time, second start: {second:.1f} s"
        )


if __name__ == "__main__":
    main()
