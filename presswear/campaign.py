"""The outer loop: run, amplify the wear, rebuild the surfaces, run again."""

import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines import engine_for
from presswear.engines.base import Plan, Run, Start
from presswear.linkage import Linkage
from presswear.observe import Account
from presswear.scene import Scene
from presswear.statistics import map_errors, stage_statistics
from presswear.surface import Surface

Array = NDArray[np.float64]

LEAST_CYCLES = 3
"""Cycles before a wear map's scatter can be judged."""

Worn = dict[str, tuple[Surface, Surface]]


@dataclass(frozen=True)
class Stage:
    """One run of the outer loop.

    Attributes
    ----------
    index : int
        0 unworn, 1 after the first wear, and so on.
    linkage : Linkage
        What ran, worn surfaces included.
    run : Run
    added : ndarray, shape (joints, 2, m)
        Depth that one wear adds after this stage, bearing and pin, m.
    amplification : float
        Multiplier of the depth of the cycles run.
    statistics : dict
    wall : float
        s.
    """

    index: int
    linkage: Linkage
    run: Run
    added: Array
    amplification: float
    statistics: dict[str, Any]
    wall: float


@dataclass(frozen=True)
class Watcher:
    """Who is told what happens.

    Attributes
    ----------
    progress : callable
        Stage index, part of the stage done 0 .. 1, a word on where it stands.
    stage : callable
        Each finished stage.
    """

    progress: Callable[[int, float, str], None] = lambda stage, part, word: None
    stage: Callable[[Stage], None] = lambda stage: None


def start_of(scene: Scene) -> Start:
    """Pins centred in their bearings, positions and velocities of the ideal mechanism."""
    motion = scene.mechanism.ideal_motion(np.zeros(1))
    return Start(motion.position[0], motion.velocity[0])


def run_stage(scene: Scene, index: int, worn: Worn, watcher: Watcher) -> Stage:
    """Run one stage on given surfaces."""
    began = clock.perf_counter()
    linkage = scene.linkage(worn)
    most = scene.cycles if scene.cycles is not None else scene.most_cycles
    needed = float(most)
    word = ""

    def enough(account: Account) -> bool:
        nonlocal needed, word
        done = len(account.cycles)
        if not linkage.clearances or done < LEAST_CYCLES:
            return False
        error = float(map_errors(account).max())
        word = f"cycle {done}, wear maps known to {100.0 * error:.0f} %"
        if scene.cycles is not None:
            return False
        # The error falls with the square root of the number of cycles.
        needed = min(float(most), max(done * (error / scene.tolerance) ** 2, done + 1.0))
        return error <= scene.tolerance

    def progress(part: float) -> None:
        watcher.progress(index, min(part * most / needed, 1.0), word)

    plan = Plan(
        scene.mechanism.period,
        most,
        torques=scene.drive_torque == "on",
        enough=enough,
        progress=progress,
    )
    accuracy = scene.accuracy()
    run = engine_for(accuracy)(linkage, start_of(scene), accuracy, plan)
    cycles = len(run.account.cycles)
    factor = scene.amplification.factor(max(cycles, 1))
    added = run.account.depth_sum * factor
    statistics = stage_statistics(linkage, run.account, added) | {
        "energy_residual_J": run.diagnostics["energy_residual_J"],
        "energy_exchanged_J": run.diagnostics["drive_exchange_J"],
    }
    stage = Stage(index, linkage, run, added, factor, statistics, clock.perf_counter() - began)
    watcher.stage(stage)
    return stage


def worn_out(linkage: Linkage, worn: Worn) -> str | None:
    """Which surface has lost so much that there is no pin or wall left; None if none."""
    for joint in linkage.clearances:
        bearing, pin = worn[joint.name]
        for name, surface, limit in (
            ("bearing", bearing, joint.bearing_radius),
            ("pin", pin, joint.pin_radius),
        ):
            deepest = float(surface.depth.max(initial=0.0))
            if deepest >= limit:
                return (
                    f"the {name} of joint {joint.name} would lose {deepest:.3g} m, "
                    f"all of its radius of {limit:.3g} m"
                )
    return None


def run_campaign(scene: Scene, watcher: Watcher) -> tuple[str, str]:
    """Run every stage; returns status (``completed`` or ``failed``) and a message.

    Each stage goes to ``watcher.stage`` as soon as it is finished and is not kept.
    """
    worn: Worn = {}
    for index in range(scene.wears + 1):
        stage = run_stage(scene, index, worn, watcher)
        if stage.run.status == "failed":
            return "failed", f"stage {index}: {stage.run.message}"
        worn = {
            joint.name: (
                joint.bearing_surface.worn_by(stage.added[k, 0]),
                joint.pin_surface.worn_by(stage.added[k, 1]),
            )
            for k, joint in enumerate(stage.linkage.clearances)
        }
        gone = worn_out(stage.linkage, worn)
        if gone is not None and index < scene.wears:
            return "failed", f"after stage {index} {gone}; fewer represented_cycles may help"
    return "completed", ""
