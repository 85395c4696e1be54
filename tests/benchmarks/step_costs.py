"""CPU time of a step of ``dae`` relative to a step of the loop by hand, and of a first start.

usage: python tests/benchmarks/step_costs.py [--repeats N] [--cycles N]

Both keep the same accounts over the same cycles at the tolerance for wear. The loop has
the radial contact of round surfaces; ``dae`` runs with this contact, on the elastic
foundation of round surfaces, and on worn ones. Runs are interleaved. A first start is a
process that runs a cycle of the press with an empty cache of kernels, a second start
the same process with the filled one.
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
from typing import Any, NamedTuple

import numpy as np
from by_hand.equations import parameters, state_of
from by_hand.loop import run

from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import linkage_on, start_of
from presswear.campaign.wear_update import cycles_of_update
from presswear.engines.base import Plan
from presswear.engines.settings import LEAST_STEPS, InHouse
from presswear.recording.statistics import mean_map
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import RunFailed
from presswear.validation.cases import finished

TOLERANCE = 1e-6
SLOPES = 6  # evaluations of a trial step
WEAR_CYCLES = 12  # whose wear makes the worn surfaces
LOOP = "hand-written loop, radial contact"
START = (
    "run wear-times --wear-updates 0 --cycles 1 --no-report "
    "--set replicates=1 --set seed=1"
)
ENGINES = "dae", "exudyn-tree", "exudyn-joints"


class Cost(NamedTuple):
    """CPU time of a run."""

    cpu: float  # s
    steps: int  # attempted
    trials: float  # steps and those that locate events

    @property
    def step(self) -> float:
        """CPU time of a step, s."""
        return self.cpu / self.steps

    @property
    def trial(self) -> float:
        """CPU time of a trial step, s."""
        return self.cpu / self.trials


def engine_cost(scene: Scene, cycles: int, worn: Array | None = None) -> Cost:
    """Run ``dae``; ``worn`` are the depths of the surfaces, m."""
    linkage = scene.linkage() if worn is None else linkage_on(scene, worn)
    period = scene.mechanism.period
    engine = InHouse("dopri5", TOLERANCE).resolved("wear").for_cycle(period)
    plan = Plan(period, cycles, 1, torques=False)
    outcome = finished(engine.simulate(linkage, start_of(scene, 1), plan))
    numbers = outcome.diagnostics
    steps = int(numbers["steps"]) + int(numbers["steps_sent_back"])
    return Cost(outcome.cpu, steps, int(numbers["evaluations"]) / SLOPES)


def loop_cost(scene: Scene, cycles: int) -> Cost:
    """Run the loop by hand."""
    period = scene.mechanism.period
    start = state_of(scene.linkage(), start_of(scene, 1))
    ends = (period * np.arange(1, cycles + 1)).tolist()
    outcome = run(parameters(scene), start, ends, TOLERANCE, period / LEAST_STEPS)
    return Cost(outcome.cpu, outcome.steps, outcome.evaluations / SLOPES)


def worn_surfaces(scene: Scene) -> Array:
    """Return the depths after one wear update, m, (joints, 2, bins)."""
    stage, ensemble = run_stage(replace(scene, engine="dae", cycles=WEAR_CYCLES))
    if stage.failed:
        raise RunFailed(stage.message)
    return np.asarray(cycles_of_update(scene, ensemble) * mean_map(ensemble.maps))


def step_costs(repeats: int = 5, cycles: int = 20) -> list[dict[str, Any]]:
    """Time the steps of the loop and of ``dae``; return a row for each, medians of the repeats."""
    paper, refined = (wear_times(conventions=name) for name in ("paper", "refined"))
    runs: dict[str, Callable[[], Cost]] = {
        LOOP: partial(loop_cost, paper, cycles),
        "dae, radial contact": partial(engine_cost, paper, cycles),
        "dae, foundation, round surfaces": partial(engine_cost, refined, cycles),
        "dae, foundation, surfaces worn once": partial(
            engine_cost, refined, cycles, worn_surfaces(refined)
        ),
    }
    for each in runs.values():
        each()  # compiles
    rounds = [{name: each() for name, each in runs.items()} for _ in range(repeats)]
    rows = []
    for name in runs:
        costs = [costs_of_round[name] for costs_of_round in rounds]
        loops = [costs_of_round[LOOP] for costs_of_round in rounds]
        pairs = list(zip(costs, loops, strict=True))
        rows.append(
            {
                "method": name,
                "cpu_s_per_step": median(cost.step for cost in costs),
                "relative": median(cost.step / loop.step for cost, loop in pairs),
                "cpu_s_per_trial": median(cost.trial for cost in costs),
                "relative_trial": median(
                    cost.trial / loop.trial for cost, loop in pairs
                ),
                "steps_per_cycle": costs[0].steps / cycles,
                "cpu_s_per_cycle": median(cost.cpu for cost in costs) / cycles,
            }
        )
    return rows


def start_costs() -> list[dict[str, Any]]:
    """Return the CPU times of a first and of a second start of each engine."""
    rows = []
    for engine in ENGINES:
        first, second = start_times(engine)
        rows.append(
            {"engine": engine, "first_start_s": first, "second_start_s": second}
        )
    return rows


def start_times(engine: str) -> list[float]:
    """Return the CPU times of a first and a second start of an engine, s."""
    times = []
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "XDG_CACHE_HOME": folder}
        for name in ("first", "second"):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            command = [
                sys.executable,
                "-m",
                "presswear",
                *START.split(),
                "--engine",
                engine,
            ]
            command += ["--out", f"{folder}/{name}"]
            subprocess.run(
                command, env=environment, check=True, stdout=subprocess.DEVNULL
            )
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            start, end = (one.ru_utime + one.ru_stime for one in (before, after))
            times.append(end - start)
    return times


def main() -> None:
    """Print a line for each method and each engine."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5, help="(default 5)")
    parser.add_argument("--cycles", type=int, default=20, help="(default 20)")
    options = parser.parse_args()
    for row in step_costs(options.repeats, options.cycles):
        print(
            f"{row['method']}: {1e6 * row['cpu_s_per_step']:.2f} µs per step, "
            f"{row['relative']:.2f} of the loop, "
            f"{row['steps_per_cycle']:.0f} steps per cycle"
        )
    for row in start_costs():
        print(
            f"{row['engine']}: first start {row['first_start_s']:.1f} s, "
            f"second start {row['second_start_s']:.1f} s"
        )


if __name__ == "__main__":
    main()
