"""Random scenes within all ranges: any that is allowed runs in both engines, its energy adds up."""

from dataclasses import replace

import pytest

from endurance.random_scenes import Ended, coarser, ended, random_scenes
from endurance.trial import SEED, Trial
from presswear.linkage.mechanisms import Press
from presswear.scene.catalog import wear_times
from presswear.scene.options import Numerics

ENGINES = ("exudyn", "dae")
STEPS = 5000
"""Of a run: most do not get through a cycle in so few, some would take millions."""
ALLOWED = 0.05
"""Part of the scenes that may end with a message: that says nothing false, but is no survivor."""


def run_scenes(trial: Trial, count: int, seed: int) -> None:
    """Run so many random scenes in both engines, a cycle of each."""
    trial.what = "random scenes run a cycle in both engines, finite, energy adds up"
    refused = parts = stopped = outside = 0
    worst = 0.0
    for place, (scene, before) in enumerate(random_scenes(2 * count, seed)):
        if trial.tried == count:
            break
        refused += before
        found = {engine: ended(replace(scene, engine=engine), STEPS) for engine in ENGINES}
        if any(one.is_outside for one in found.values()):
            outside += 1
            continue
        missed = {engine: one for engine, one in found.items() if not one.passed}
        stopped += bool(missed) and all(one.failure for one in missed.values())
        parts += any(one.part < 1.0 for one in found.values())
        worst = max([worst, *(one.residual for one in found.values() if one.passed)])
        problems = [
            f"scene {place} of seed {seed}, {engine}: "
            + (one.failure or f"energy residual {one.residual:.1e} of that exchanged")
            for engine, one in missed.items()
        ]
        trial.add("; ".join(problems))
    trial.allowed = min(stopped, int(ALLOWED * count))
    note = (
        f"{stopped} ended with a message; largest residual {worst:.1e} of the energy exchanged; "
        f"{parts} in part, at {STEPS} steps; {refused} more did not assemble, in "
        f"{outside} pins sank in deeper than they are thick"
    )
    trial.note, trial.miss = note, f"{note}; first {trial.miss}" if trial.miss else ""


def test_random_scenes_run_in_both_engines() -> None:
    trial = Trial()
    run_scenes(trial, 8, seed=1)
    assert (trial.tried, trial.passed) == (8, True), trial.miss


@pytest.mark.endurance
def test_many_random_scenes(trial: Trial, is_quick: bool) -> None:
    count = 5 if is_quick else 300
    run_scenes(trial, count, SEED)
    assert (trial.tried, trial.passed) == (count, True), trial.miss


def test_scenes_are_those_of_their_seed_and_differ() -> None:
    one, same, other = ([s for s, _ in random_scenes(6, seed)] for seed in (1, 1, 2))
    assert one == same
    assert one != other
    assert len({scene.joints for scene in one}) > 1
    assert {isinstance(scene.mechanism, Press) for scene in one + other} == {True, False}


def test_a_run_that_needs_more_steps_runs_in_part() -> None:
    scene = replace(wear_times(), wear_updates=0, engine="dae")
    whole, part = ended(scene, 60_000), ended(scene, 3000)
    assert whole.part == 1.0
    assert 0.0 < part.part < 1.0
    assert whole.passed
    assert part.passed


def test_what_fails_or_loses_energy_does_not_pass() -> None:
    assert not Ended(1.0, bound=1.0).passed
    assert not Ended(1.0, 2e-6, 1e-6).passed
    assert not Ended(1.0, 0.0, 1e-6, "it stopped").passed
    assert Ended(1.0, 1e-6, 1e-6).passed
    coarse = Numerics().having(integrator="rk4", equal_step=1e-2)
    stopped = replace(wear_times(), wear_updates=0, engine="dae", numerics=coarse)
    assert "no longer finite" in ended(stopped, 60_000).failure


@pytest.mark.parametrize(
    ("engine", "settings", "factor"),
    [
        ("dae", {}, 1.0),
        ("dae", {"integration_tolerance": 1e-12}, 1.0),
        ("dae", {"integration_tolerance": 1e-7}, 100.0),
        ("exudyn-joints", {"steps_per_contact": 20}, 100.0),
    ],
)
def test_coarser_settings_may_miss_more(
    engine: str, settings: dict[str, float], factor: float
) -> None:
    scene = replace(wear_times(), engine=engine, numerics=Numerics().having(**settings))
    assert coarser(scene) == pytest.approx(factor)
