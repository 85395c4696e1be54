"""Results of the study ``paper`` made up from numbers that are known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.surface import bin_centres
from presswear.paper.evidence import Evidence
from presswear.paper.variants import BASE, CASES, base_scene, variant_key
from presswear.recording.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.results.result import Result
from presswear.results.stage import StageResult, StageStatistics

Array = NDArray[np.float64]
BINS = 72
CYCLES = 20
EVEN = {"A": 200.0, "C": 100.0}
"""Mean peak forces at both joints, N."""


def cycle_rows(count: int, seed: int, force: Mapping[str, float]) -> Array:
    """A row a cycle: forces scatter by a tenth about their means; seven contacts in each."""
    draw = np.random.default_rng(seed)

    def scatter(part: float) -> Array:
        return 1.0 + part * draw.normal(size=count)

    rows = {
        "displacement_max": 0.107 * scatter(1e-4),
        "velocity_min": np.full(count, -0.9),
        "velocity_max": 0.99 * scatter(1e-3),
        "acceleration_max": 1000.0 * scatter(0.1),
        "steps": np.zeros(count),
        "contact_made": np.zeros(count),
        "drive_work": np.zeros(count),
        "bottom_height": -0.588 + 1e-5 * scatter(1.0),
        "bottom_time": np.zeros(count),
    }
    columns = [rows[name] for name in CYCLE_FIXED]
    for mean in force.values():
        contacts = np.full(count, 7.0)
        own = {
            "force_max": mean * scatter(0.1),
            "load_distance": 3.0 * scatter(0.03),
            "contacts": contacts,
        }
        columns += [own[name] for name in CYCLE_JOINT]
    return np.column_stack(columns)


def wear_batches(peak: float, place: int, seed: int, count: int) -> Array:
    """Depth of one wear by batches, both sides half, shape (n, 2, BINS); deepest in a bin."""
    away = (np.arange(BINS) - place + BINS // 2) % BINS - BINS // 2
    scatter = 1.0 + 0.05 * np.random.default_rng(seed).normal(size=(count, 1))
    maps = peak * np.exp(-0.5 * (away / 4.0) ** 2) * scatter
    return np.asarray(0.5 * np.stack([maps, maps], axis=1))


def stage(
    setting: str,
    wear_updates: int,
    seed: int,
    force: Sequence[Mapping[str, float]] = (EVEN,),
    peak: Sequence[float] = (20e-6, 8e-6),
) -> dict[str, Array]:
    """Arrays of a stage, from mean forces by joint for each start and the depths of one wear."""
    scene = base_scene(setting)
    time = np.linspace(0.0, 3.0 * scene.mechanism.period, 1501)
    count = len(force)
    arrays = {
        "time": time,
        "slider": scene.ideal_slider(time),
        "angle": bin_centres(BINS),
        "cycles": np.concatenate(
            [cycle_rows(CYCLES, seed + 1000 * s, own) for s, own in enumerate(force)]
        ),
        "cycle_start": np.repeat(np.arange(float(count)), CYCLES),
        "wear_batch_cycles": np.ones(count * (CYCLES - 1)),
        "deviation_start": np.repeat(np.arange(float(count)), 3),
        "deviation": np.tile([3e-4, 0.02 + 0.01 * wear_updates, 1e-4, 0.1071], (3 * count, 1)),
    }
    turn = 6.0 * np.pi * time / time[-1]
    for k, joint in enumerate(("A", "C")):
        batches = wear_batches(peak[k], 18 + 20 * k, seed + k, count * (CYCLES - 1))
        arrays[f"{joint}_wear_batches"] = batches
        arrays[f"{joint}_flight"] = np.full(3 * count, 0.1 + 0.1 * wear_updates)
        arrays[f"{joint}_eccentricity"] = 8e-4 * np.column_stack([np.cos(turn), np.sin(turn)])
        arrays[f"{joint}_force"] = np.column_stack([100.0 * np.cos(turn) ** 8, 0.0 * turn])
        for s, side in enumerate(("bearing", "pin")):
            arrays[f"{joint}_wear_{side}"] = batches[:, s].mean(axis=0)
            arrays[f"{joint}_depth_{side}"] = np.zeros(BINS)
    return arrays


def result(
    setting: str,
    stages: Sequence[dict[str, Array]],
    status: str = "completed",
    **changes: Any,
) -> Result:
    """A result of some stages of a setting, its scene changed; a failed one ends in its last."""
    scene = replace(base_scene(setting), **changes)
    for before, after in pairwise(stages):
        for surface in ("bearing", "pin"):
            for joint in ("A", "C"):
                depth = f"{joint}_depth_{surface}"
                after[depth] = before[depth] + before[f"{joint}_wear_{surface}"]
    is_failed = status == "failed"
    listed = [
        StageResult(
            index=k,
            status="failed" if is_failed and k == len(stages) - 1 else "enough",
            message="",
            finding=None,
            amplification=1e5,
            wear_steps=(),
            simulated_s=1.0,
            wall_s=2.0,
            diagnostics={"model": "made up"},
            statistics=StageStatistics(
                len(arrays["cycles"]), energy_residual=1e-9, energy_exchanged=1.0
            ),
            arrays=arrays,
            joint_names=scene.clearance_joints,
        )
        for k, arrays in enumerate(stages)
    ]
    made = dict.fromkeys(("python", "revision", "machine", "started"), "made up")
    provenance = {**made, "packages": {"presswear": "0"}}
    message = "it stopped" if is_failed else ""
    return Result(scene, tuple(listed), status, message, provenance, 3.0)


@cache
def every_result() -> dict[str, Result]:
    """All runs of the study, alike but for their seeds."""
    return {
        variant_key(case.key, setting): result(
            setting,
            [
                stage(setting, k, 100 * seed + 10 * k + 1, [EVEN] * case.replicates)
                for k in range(min(base_scene(setting).wear_updates, case.wear_updates) + 1)
            ],
        )
        for seed, case in enumerate(CASES)
        for setting in case.settings
    }


@cache
def every_evidence() -> Evidence:
    """Evidence of all runs."""
    return Evidence(every_result())


def cut(whole: Result, stages: int | None = None, **changes: Any) -> Result:
    """A result's first stages, its scene changed."""
    return replace(whole, scene=replace(whole.scene, **changes), stages=whole.stages[:stages])


def evidence_of(setting: str, *stages: dict[str, Array], **changes: Any) -> Evidence:
    """Evidence of the standard case of one setting alone, from its stages."""
    return Evidence({variant_key(BASE, setting): result(setting, stages, **changes)})
