"""Results of the paper's study with known numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

import presswear as pw
from presswear.linkage.surface import bin_centres
from presswear.paper.evidence import Evidence
from presswear.paper.settings import BASE, CASES, JOINTS, base_scene, run_name
from presswear.recording.columns import CYCLE, JOINT_CYCLE, names_of
from presswear.results.stage_statistics import StageStatistics
from presswear.tools.arrays import Array

BINS = 72
CYCLES = 20
EVEN = {"A": 200.0, "C": 100.0}  # mean peak forces, N


def cycle_rows(seed: int, force: Mapping[str, float]) -> Array:
    """Return a row per cycle: peaks scatter by a tenth, with seven contacts in each cycle."""
    draw = np.random.default_rng(seed)
    columns = {name: np.zeros(CYCLES) for name in names_of(CYCLE)}
    peaks = {
        "displacement": (0.107, 1e-4),
        "velocity": (0.99, 1e-3),
        "acceleration": (1e3, 0.1),
    }
    for name, (mean, part) in peaks.items():
        columns[f"{name}_max"] = mean * (1.0 + part * draw.normal(size=CYCLES))
    for joint, mean in force.items():
        numbers = {
            "force_max": mean * (1.0 + 0.1 * draw.normal(size=CYCLES)),
            "load_distance": 3.0 * (1.0 + 0.03 * draw.normal(size=CYCLES)),
            "contacts": np.full(CYCLES, 7.0),
            "closed_time": np.full(CYCLES, 0.5),
            "sliding_distance": np.full(CYCLES, 0.02),
        }
        for name in names_of(JOINT_CYCLE):
            columns[f"{joint}_{name}"] = numbers.get(name, np.zeros(CYCLES))
    return np.column_stack(list(columns.values()))


scene_of = cache(base_scene)


@cache
def ideal_series(setting: str) -> dict[str, Array]:
    """Return the ideal motion of the slider in a setting."""
    scene = scene_of(setting)
    time = np.linspace(0.0, 3.0 * scene.mechanism.period, 1501)
    return {"time": time, "slider": scene.ideal_slider(time)}


def stage(
    setting: str,
    wear_updates: int,
    seed: int,
    force: Sequence[Mapping[str, float]] = (EVEN,),
    peak: Sequence[float] = (20e-6, 8e-6),
) -> dict[str, Array]:
    """Return the arrays of a stage, from mean forces of each replicate and depths of one wear."""
    count = len(force)
    series = ideal_series(setting)
    time = series["time"]
    deviation = [3e-4, 0.02 + 0.01 * wear_updates, 1e-4, 0.1071]
    rows = [cycle_rows(seed + 1000 * k, mean) for k, mean in enumerate(force)]
    arrays = {
        **series,
        "angle": bin_centres(BINS),
        "cycles": np.concatenate(rows),
        "cycle_start": np.repeat(np.arange(float(count)), CYCLES),
        "wear_batch_cycles": np.ones(count * (CYCLES - 1)),
        "deviation_start": np.repeat(np.arange(float(count)), 3),
        "deviation": np.tile(deviation, (3 * count, 1)),
    }
    turn = 6.0 * np.pi * time / time[-1]
    away = (np.arange(BINS)[:, np.newaxis] - (18, 38) + BINS // 2) % BINS - BINS // 2
    for joint, depth, bell in zip(
        JOINTS, peak, np.exp(-0.5 * (away.T / 4.0) ** 2), strict=True
    ):
        draw = np.random.default_rng([seed, ord(joint)]).normal(
            size=(count * (CYCLES - 1), 1, 1)
        )
        batches = np.repeat(0.5 * depth * bell * (1.0 + 0.05 * draw), 2, axis=1)
        arrays[f"{joint}_wear_batches"] = batches
        arrays[f"{joint}_flight"] = np.full(3 * count, 0.1 + 0.1 * wear_updates)
        arrays[f"{joint}_eccentricity"] = 8e-4 * np.column_stack(
            [np.cos(turn), np.sin(turn)]
        )
        arrays[f"{joint}_force"] = np.column_stack(
            [100.0 * np.cos(turn) ** 8, 0.0 * turn]
        )
        for side, mean in zip(("bearing", "pin"), batches.mean(axis=0), strict=True):
            arrays[f"{joint}_wear_{side}"] = mean
            arrays[f"{joint}_depth_{side}"] = np.zeros(BINS)
    return arrays


def result(
    setting: str,
    stages: Sequence[dict[str, Array]],
    status: str = "completed",
    **changes: Any,
) -> pw.Result:
    """Return a result of some stages of a setting; a failed one ends in its last stage."""
    scene = replace(scene_of(setting), **changes)
    for before, after in pairwise(stages):
        for name in [
            f"{joint}_{{}}_{side}" for joint in JOINTS for side in ("bearing", "pin")
        ]:
            after[name.format("depth")] = (
                before[name.format("depth")] + before[name.format("wear")]
            )
    listed = []
    for k, arrays in enumerate(stages):
        ended = "failed" if status == "failed" and k == len(stages) - 1 else "enough"
        numbers = StageStatistics(
            len(arrays["cycles"]), energy_residual=1e-9, energy_exchanged=1.0
        )
        first: Any = (
            k,
            ended,
            "",
            None,
            1e5,
            (),
            1.0,
            2.0,
            {"model": "made up"},
            numbers,
        )
        last: Any = (arrays, scene.clearance_joints)
        listed.append(pw.results.StageResult(*first, *last))
    origin = dict.fromkeys(("python", "revision", "machine", "started"), "made up")
    return pw.Result(scene, tuple(listed), status, "", {**origin, "packages": {}}, 3.0)


@cache
def every_result() -> dict[str, pw.Result]:
    results = {}
    for seed, (name, case) in enumerate(CASES.items()):
        for setting in case.settings:
            last = min(scene_of(setting).wear_updates, case.wear_updates)
            seeds = range(100 * seed + 1, 100 * seed + 99, 10)
            force = [EVEN] * case.replicates
            stages = [stage(setting, k, seeds[k], force) for k in range(last + 1)]
            results[run_name(name, setting)] = result(setting, stages)
    return results


@cache
def every_evidence() -> Evidence:
    return Evidence(every_result())


def evidence_of(setting: str, *stages: dict[str, Array], **changes: Any) -> Evidence:
    return Evidence({run_name(BASE, setting): result(setting, stages, **changes)})
