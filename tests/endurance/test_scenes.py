"""Random scenes within all ranges run in both engines and conserve energy."""

from dataclasses import replace

import pytest

from endurance.random_scenes import ended, random_scenes
from endurance.subject import SEED, Trial

ENGINES = ("exudyn", "dae")
# Largest number of steps of a run. Most runs do not reach the end of a cycle, for which
# some would need millions of steps.
STEPS = 5000
ALLOWED = 0.02  # part of the scenes that may end with a message
# Scenes outside of all contact laws are replaced, at most count + SPARE of them.
SPARE = 10


def run_scenes(trial: Trial, count: int, seed: int) -> None:
    """Run a number of random scenes in both engines, one cycle of each."""
    not_assembled = 0
    unfinished = 0
    stopped = 0
    outside = 0
    largest = 0.0
    scenes = random_scenes(2 * count + SPARE, seed)
    for index, (scene, refused) in enumerate(scenes):
        if trial.attempts == count:
            break
        not_assembled += refused
        results = {}
        for engine in ENGINES:
            results[engine] = ended(replace(scene, engine=engine), STEPS)
        if any(result.is_outside for result in results.values()):
            outside += 1
            continue
        unfinished += any(result.part < 1.0 for result in results.values())
        failures = []
        problems = []
        for engine, result in results.items():
            if result.passed:
                largest = max(largest, result.residual)
                continue
            failures.append(result.failure)
            residual = f"energy residual {result.residual:.1e} of that exchanged"
            problem = result.failure or residual
            problems.append(f"scene {index} of seed {seed}, {engine}: {problem}")
        stopped += bool(failures) and all(failures)
        trial.add("; ".join(problems))
    trial.allowed = min(stopped, int(ALLOWED * count))
    trial.note = (
        f"{stopped} ended with a message; largest residual {largest:.1e} of the energy "
        f"exchanged; {unfinished} ended after {STEPS} steps within the cycle; "
        f"{not_assembled} more did not assemble; in {outside} more the penetration exceeded "
        "the pin radius"
    )
    assert trial.attempts == count
    trial.check()


def test_random_scenes_run_in_both_engines():
    run_scenes(Trial(), 1, seed=6)


@pytest.mark.endurance
def test_many_random_scenes(trial: Trial, is_quick):
    run_scenes(trial, 5 if is_quick else 300, SEED)
