"""Many cycles: constraints, energy and memory must not drift."""

import math
import resource
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from presswear.campaign.starts import start_of
from presswear.engines.base import Run
from presswear.linkage.press import Press
from presswear.record.recorder import Recorder
from presswear.record.tracker import Tracker
from presswear.scene.scene import Scene
from presswear.trials.hard.case import Case, Finding, energy_of, guarded, ran
from presswear.trials.hard.scenes import BASE

FAST = 40.0 * math.pi
"""Crank speed of the many cycles, rad/s: a cycle takes 50 ms and some hundred touches."""
LONGEST = 1200.0
"""Wall time that many cycles may take, s."""
GROWTH = 20.0
"""Most that the error of the constraints may grow over ten times the cycles.

Crank angles count on, 6 rad a cycle, and their round-off with them: the error grows ten
times, from 5e-12 m after ten cycles.  What feeds on itself grows a hundred times or more.
"""


class _Memory(Tracker):
    """Notes the peak memory of the process after each cycle, MB."""

    def __init__(self) -> None:
        self.sizes: list[float] = []

    def cycle(self, recorder: Recorder, state: object) -> bool:
        """Note the memory; it never ends the run."""
        self.sizes.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
        return False


def many_cycles(scene: Scene, cycles: int) -> tuple[Run, float]:
    """A run, and by how much the process grew after a tenth of it, MB."""
    watched = _Memory()
    plan = guarded(scene.mechanism.period, cycles, LONGEST)
    plan = replace(plan, trackers=(*plan.trackers, watched))
    run = ran(scene.linkage(), start_of(scene), scene.solver.over(scene.mechanism.period), plan)
    return run, watched.sizes[-1] - watched.sizes[cycles // 10]


def drifts(scene: Scene, cycles: int) -> Iterator[Finding]:
    """Compares many cycles with a tenth of them."""
    engine = scene.solver.word
    first, _ = many_cycles(scene, cycles // 10)
    run, grown = many_cycles(scene, cycles)
    yield energy_of(run, engine)
    yield Finding("cycles missing", cycles - len(run.recorder.cycles), 0.0)
    yield Finding("memory grown (MB)", grown, 8.0)
    if engine == "dae":
        early, late = (float(r.diagnostics["constraint_error_m"]) for r in (first, run))
        yield Finding("greatest |Phi| / clearance", late / scene.bearings.clearance, 1e-5)
        yield Finding("|Phi| over that of a tenth of the cycles", late / early, GROWTH)
    early, late = (abs(float(r.diagnostics["energy_residual_J"])) for r in (first, run))
    exchanged = float(run.diagnostics["drive_exchange_J"])
    per_cycle = (late / 10.0 - early) / (exchanged / 10.0)
    yield Finding("residual a cycle, growth / exchanged", per_cycle, 1e-8)


def drift_cases() -> Iterator[Case]:
    """A hundred cycles, and 2,000."""
    for cycles, long in ((100, False), (2000, True)):
        for engine in ("exudyn", "dae"):
            scene = replace(BASE, mechanism=Press(speed=FAST), engine=engine)
            yield Case(
                f"{cycles:,} cycles at 40 pi",
                "errors add up",
                scene.solver.word,
                partial(drifts, scene, cycles),
                long=long,
            )
