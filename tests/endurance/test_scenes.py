"""Random scenes within all ranges run in both engines and conserve energy."""

from dataclasses import replace

import pytest

from endurance.random_scenes import ended, random_scenes
from endurance.subject import SEED, Trial

ENGINES = ("exudyn", "dae")
STEPS = 5000  # of a run: most do not reach the end of a cycle, some would take millions
ALLOWED = 0.02  # part of the scenes that may end with a message
SPARE = (
    10  # scenes that replace those outside of all contact laws, besides one for each
)


def run_scenes(trial: Trial, count: int, seed: int) -> None:
    """Run so many random scenes in both engines, a cycle of each."""
    refused = parts = stopped = outside = 0
    worst = 0.0
    for place, (scene, before) in enumerate(random_scenes(2 * count + SPARE, seed)):
        if trial.attempts == count:
            break
        refused += before
        results = {
            engine: ended(replace(scene, engine=engine), STEPS) for engine in ENGINES
        }
        if any(one.is_outside for one in results.values()):
            outside += 1
            continue
        missed = {engine: one for engine, one in results.items() if not one.passed}
        stopped += bool(missed) and all(one.failure for one in missed.values())
        parts += any(one.part < 1.0 for one in results.values())
        worst = max([worst, *(one.residual for one in results.values() if one.passed)])
        problems = [
            f"scene {place} of seed {seed}, {engine}: "
            + (one.failure or f"energy residual {one.residual:.1e} of that exchanged")
            for engine, one in missed.items()
        ]
        trial.add("; ".join(problems))
    trial.allowed = min(stopped, int(ALLOWED * count))
    trial.note = (
        f"{stopped} ended with a message; largest residual {worst:.1e} of the energy exchanged; "
        f"{parts} in part, at {STEPS} steps; {refused} more did not assemble, in "
        f"{outside} with a penetration beyond the pin radius"
    )
    assert trial.attempts == count
    trial.check()


def test_random_scenes_run_in_both_engines() -> None:
    run_scenes(Trial(), 1, seed=6)


@pytest.mark.endurance
def test_many_random_scenes(trial: Trial, is_quick: bool) -> None:
    run_scenes(trial, 5 if is_quick else 300, SEED)
