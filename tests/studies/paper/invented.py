"""Results of the study ``paper`` made up from numbers that are known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.surface import bin_centres
from presswear.record.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.ideal import ideal_slider
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.variants import base_scene, cases, variant_key

Array = NDArray[np.float64]
BINS = 72
CYCLES = 20


def cycle_rows(count: int, seed: int, force: Mapping[str, float]) -> Array:
    """Rows of the account: forces scatter by a tenth about their means; contacts count through."""
    generator = np.random.default_rng(seed)
    rows = np.zeros((count, len(CYCLE_FIXED) + 2 * len(CYCLE_JOINT)))
    rows[:, 0] = 0.107 + 1e-5 * generator.normal(size=count)
    rows[:, 1] = -0.9
    rows[:, 2] = 0.99 + 1e-3 * generator.normal(size=count)
    rows[:, 3] = 1000.0 * (1.0 + 0.1 * generator.normal(size=count))
    for k, mean in enumerate(force.values()):
        base = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k
        rows[:, base] = mean * (1.0 + 0.1 * generator.normal(size=count))
        rows[:, base + 1] = 3.0 + 0.1 * generator.normal(size=count)
        rows[:, base + 2] = 7.0 * np.arange(1, count + 1)
    return rows


def wear_batches(peak: float, place: int, seed: int, count: int = CYCLES - 1) -> Array:
    """Depth of one wear by batches, both sides half, shape (n, 2, BINS); deepest in a bin."""
    generator = np.random.default_rng(seed)
    away = (np.arange(BINS) - place + BINS // 2) % BINS - BINS // 2
    shape = peak * np.exp(-0.5 * (away / 4.0) ** 2)
    maps = shape * (1.0 + 0.05 * generator.normal(size=(count, 1)))
    return np.asarray(0.5 * np.stack([maps, maps], axis=1))


def stage(setting: str, wears: int, seed: int, **numbers: Any) -> dict[str, Array]:
    """Arrays of a stage; ``force`` (by joint, of each start) and ``peak`` by joint.

    Without ``force`` there is one start.
    """
    scene = base_scene(setting)
    forces = numbers.get("force", [{"A": 200.0, "C": 100.0}])
    peak = numbers.get("peak", {"A": 20e-6, "C": 8e-6})
    time = np.linspace(0.0, 3.0 * scene.mechanism.period, 1501)
    count = len(forces)
    arrays = {
        "time": time,
        "slider": ideal_slider(scene, time),
        "angle": bin_centres(BINS),
        "cycles": np.concatenate(
            [cycle_rows(CYCLES, seed + 1000 * s, force) for s, force in enumerate(forces)]
        ),
        "cycle_start": np.repeat(np.arange(float(count)), CYCLES),
        "wear_batch_cycles": np.ones(count * (CYCLES - 1)),
        "deviation_start": np.repeat(np.arange(float(count)), 3),
        "deviation": np.tile([3e-4, 0.02 + 0.01 * wears, 1e-4, 0.1071], (3 * count, 1)),
    }
    for k, joint in enumerate(("A", "C")):
        batches = wear_batches(peak[joint], 18 + 20 * k, seed + k, count * (CYCLES - 1))
        turn = 6.0 * np.pi * time / time[-1]
        arrays[f"{joint}_wear_batches"] = batches
        arrays[f"{joint}_flight"] = np.full(3 * count, 0.1 + 0.1 * wears)
        arrays[f"{joint}_eccentricity"] = 8e-4 * np.column_stack([np.cos(turn), np.sin(turn)])
        arrays[f"{joint}_penetration"] = np.where(np.sin(turn) > 0.0, 1e-7, -1e-7)
        arrays[f"{joint}_force"] = np.column_stack([100.0 * np.cos(turn) ** 8, 0.0 * turn])
        arrays[f"{joint}_sliding"] = 0.0 * turn
        for s, side in enumerate(("bearing", "pin")):
            arrays[f"{joint}_wear_{side}"] = batches[:, s].mean(axis=0)
            arrays[f"{joint}_depth_{side}"] = wears * batches[:, s].mean(axis=0)
    return arrays


def result(
    setting: str,
    stages: Sequence[Mapping[str, Array]],
    status: str = "completed",
    **changes: Any,
) -> Result:
    """A result of some stages of a setting, its scene changed; a failed one ends in its last."""
    scene = replace(base_scene(setting), **changes)
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
            statistics={
                "cycles": len(arrays["cycles"]),
                "energy_residual_J": 1e-9,
                "energy_exchanged_J": 1.0,
            },
            arrays=arrays,
            joint_names=scene.clearance_joints,
        )
        for k, arrays in enumerate(stages)
    ]
    provenance = {
        "python": "3",
        "packages": {"presswear": "0"},
        "revision": "r",
        "machine": "m",
        "started": "now",
    }
    message = "it stopped" if is_failed else ""
    return Result(scene, tuple(listed), status, message, provenance, 3.0)


def every_result(stages: int = 3) -> dict[str, Result]:
    """All runs of the study, alike but for their seeds."""
    found = {}
    for seed, case in enumerate(cases()):
        for setting in case.settings:
            most = min(base_scene(setting).wears, case.wears) + 1
            force = [{"A": 200.0, "C": 100.0}] * case.starts
            found[variant_key(case.key, setting)] = result(
                setting,
                [
                    stage(setting, k, 100 * seed + 10 * k + 1, force=force)
                    for k in range(min(most, stages))
                ],
            )
    return found


def evidence_of(setting: str, *stages: dict[str, Array]) -> Evidence:
    """Evidence of the standard case of one setting alone, from its stages."""
    return Evidence({("standard", setting): result(setting, list(stages))})
