"""Replicates that are computed together: each has the bits that it has alone."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from presswear.campaign.replicates import Part, RunSpec, RunState, WorkUnit, start_of
from presswear.engines.base import Plan
from presswear.linkage.loads import Harmonics
from presswear.physics.wear import map_shape
from presswear.scene.catalog import scene_named
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import Array

QUICK = {"engine": "dae", "integrator": "dopri5", "integration_tolerance": "1e-6"}
# Round and worn surfaces, radial and on a foundation, laws, loads, springs and servo drives
SCENES: dict[str, tuple[str, dict[str, Any]]] = {
    "round": ("wear-times", {}),
    "foundation": ("wear-times", {"conventions": "refined"}),
    "laws": ("wear-times", {"friction_law": "lugre", "elasticity": "liu"}),
    "stiff": ("wear-times", {"normal_law": "kelvin-voigt", "viscous_damping": "1e3 N s/m"}),
    "smooth": ("wear-times", {"friction_law": "smooth", "exponent": "1.4"}),
    "loads": ("press-blanking", {}),
    "servo": ("press-servo-dwell", {}),
    "run-up": ("wear-times", {"run_up": "1"}),
}


def scene_of(name: str) -> Scene:
    base, changes = SCENES[name]
    return changed(scene_named(base), QUICK | changes)


def worn(scene: Scene, seed: int) -> Array:
    """Return depths of a smooth wear that differs from replicate to replicate."""
    depth = np.zeros(map_shape(scene.linkage().clearances))
    angle = np.linspace(0.0, 2.0 * math.pi, depth.shape[-1], endpoint=False)
    depth[:] = 1e-5 * (1.0 + np.cos(angle - seed))
    return depth


def states(scene: Scene, parts: Mapping[int, Part], cycles: int = 2) -> dict[int, RunState]:
    return WorkUnit(scene, RunSpec(cycles), parts, math.inf)(lambda *progress: None)


def differences(one: RunState, other: RunState) -> list[str]:
    """Return the names of arrays that differ in a bit."""
    assert set(one.arrays) == set(other.arrays)
    pairs = ((name, one.arrays[name], other.arrays[name]) for name in one.arrays)
    return [name for name, first, last in pairs if first.tobytes() != last.tobytes()]


@pytest.fixture(autouse=True)
def no_wall_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is among the sums of a run."""
    monkeypatch.setattr("time.perf_counter", lambda: 0.0)


@pytest.mark.parametrize("is_worn", [False, True], ids=["new", "worn"])
@pytest.mark.parametrize("name", SCENES)
def test_each_replicate_has_the_bits_that_it_has_alone(name: str, is_worn: bool) -> None:
    scene = scene_of(name)
    size = scene.solver.lanes(scene.linkage())
    assert size > 2
    nothing = np.zeros(map_shape(scene.linkage().clearances))
    parts = {
        k: Part(worn(scene, k) if is_worn else nothing, k, 1 + k % 2, None) for k in range(size - 1)
    }
    together = states(scene, parts)
    for k, part in parts.items():
        alone = states(scene, {k: part})[k]
        assert differences(together[k], alone) == []
        assert together[k].cycles == 1 + k % 2


def test_replicates_resume_in_other_company() -> None:
    scene = scene_of("round")
    nothing = np.zeros(map_shape(scene.linkage().clearances))
    first = states(scene, {k: Part(nothing, k, 1, None) for k in range(3)})
    resumed = states(scene, {k: Part(nothing, k, 2, first[k].arrays) for k in (2, 0)})
    for k, state in resumed.items():
        whole = states(scene, {k: Part(nothing, k, 2, None)})[k]
        assert differences(state, whole) == []


def test_replicates_run_one_by_one_while_another_process_compiles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = scene_of("round")
    nothing = np.zeros(map_shape(scene.linkage().clearances))
    parts = {k: Part(nothing, k, 1, None) for k in range(2)}
    together = states(scene, parts)
    pack = "presswear.engines.dae.pack"
    monkeypatch.setattr(f"{pack}.is_compiled_elsewhere", lambda *arguments: True)
    monkeypatch.setattr(f"{pack}.specialised", None)
    one_by_one = states(scene, parts)
    assert not any(differences(together[k], one_by_one[k]) for k in parts)


def test_a_replicate_that_fails_ends_alone() -> None:
    """Its load is far beyond what its joints bear."""
    scene = scene_of("loads")
    linkage, plan = scene.linkage(), Plan(scene.mechanism.period, 1, 0, torques=False)
    wild = replace(linkage.live_loads[0], law=Harmonics(1e15))
    broken = replace(linkage, loads=(wild, *linkage.loads[1:]))
    cases = [(broken if k == 1 else linkage, start_of(scene, k), plan) for k in range(3)]
    runs = scene.solver.simulate_together(cases)
    assert [run.status for run in runs] == ["completed", "failed", "completed"]
    assert runs[1].finding is not None
    for k in (0, 2):
        alone = scene.solver.simulate(*cases[k])
        assert np.array_equal(runs[k].end.position, alone.end.position)


def test_linkages_that_differ_in_kind_run_one_after_the_other() -> None:
    """Surfaces of one replicate are worn, those of another are round."""
    scene = scene_of("round")
    nothing = np.zeros(map_shape(scene.linkage().clearances))
    parts = {0: Part(nothing, 0, 1, None), 1: Part(worn(scene, 1), 1, 1, None)}
    together = states(scene, parts)
    for k, part in parts.items():
        assert differences(together[k], states(scene, {k: part})[k]) == []
