"""CPU time of a step of ``dae`` relative to a step of the loop by hand, and of a first start.

Both keep the same accounts over the same cycles at the tolerance for wear. The loop has
the radial contact of round surfaces; ``dae`` runs with this contact, on the elastic
foundation of round surfaces, and on worn ones. Runs are interleaved. A first start is a
process that runs a cycle of the press with an empty cache of kernels, a second start
the same process with the filled one.
"""

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
from presswear.validation.by_hand.equations import parameters, state_of
from presswear.validation.by_hand.loop import run
from presswear.validation.cases import Progress, finished, part_of

TOLERANCE = 1e-6
SLOPES = 6  # evaluations of a trial step
WEAR_CYCLES = 12  # whose wear makes the worn surfaces
LOOP = "hand-written loop, radial contact"
START = (
    "run wear-times --wear-updates 0 --cycles 1 --no-report "
    "--set replicates=1 --set seed=1"
)
ENGINES = "dae", "exudyn-tree", "exudyn-joints"


class StepExtent(NamedTuple):
    """Repeats of each run, and its cycles."""

    repeats: int = 5
    cycles: int = 20


QUICK_STEPS = StepExtent(repeats=2, cycles=4)


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


def step_costs(extent: StepExtent, report: Progress) -> list[dict[str, object]]:
    """Time the steps of the loop and of ``dae``; return a row for each, medians of the repeats."""
    report("wear of the worn surfaces", 0.0)
    paper, refined = (wear_times(conventions=name) for name in ("paper", "refined"))
    cycles = extent.cycles
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
    rounds = []
    for k in range(extent.repeats):
        report(f"repeat {k + 1}", 0.3 + 0.7 * k / extent.repeats)
        rounds.append({name: each() for name, each in runs.items()})
    rows: list[dict[str, object]] = []
    for name in runs:
        costs = [one[name] for one in rounds]
        loops = [one[LOOP] for one in rounds]
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


def start_costs(report: Progress) -> list[dict[str, object]]:
    """Return the CPU times of a first and of a second start of each engine."""
    rows: list[dict[str, object]] = []
    for k, engine in enumerate(ENGINES):
        progress = part_of(report, k / len(ENGINES), 1.0 / len(ENGINES))
        first, second = start_times(engine, progress)
        rows.append(
            {"engine": engine, "first_start_s": first, "second_start_s": second}
        )
    return rows


def start_times(engine: str, report: Progress) -> list[float]:
    """Return the CPU times of a first and a second start of an engine, s."""
    times = []
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "XDG_CACHE_HOME": folder}
        for k, name in enumerate(("first", "second")):
            report(f"{name} start of {engine}", 0.7 * k)
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
