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
from presswear.trials.hard.case import HardCase, energy_of, ran
from presswear.trials.hard.scenes import BASE, in_both
from presswear.trials.runs import Check, guarded

FAST = 40.0 * math.pi
"""Crank speed of the many cycles, rad/s: a cycle takes 50 ms and some hundred contacts."""
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
    """Run many cycles, and see by how much the process grew after a tenth of them, MB."""
    memory, period = _Memory(), scene.mechanism.period
    plan = guarded(period, cycles, LONGEST)
    plan = replace(plan, trackers=(*plan.trackers, memory))
    run = ran(scene.linkage(), start_of(scene), scene.solver.over(period), plan)
    return run, memory.sizes[-1] - memory.sizes[cycles // 10]


def drifts(cycles: int, scene: Scene) -> Iterator[Check]:
    """Compare many cycles with a tenth of them."""
    engine = scene.solver.word
    first, _ = many_cycles(scene, cycles // 10)
    run, grown = many_cycles(scene, cycles)
    yield energy_of(run, engine)
    yield Check("cycles missing", cycles - len(run.recorder.cycles), 0.0)
    yield Check("memory grown (MB)", grown, 8.0)
    if engine == "dae":
        early, late = (float(r.diagnostics["constraint_error_m"]) for r in (first, run))
        yield Check("greatest |Phi| / clearance", late / scene.bearings.clearance, 1e-5)
        yield Check("|Phi| over that of a tenth of the cycles", late / early, GROWTH)
    early, late = (abs(float(r.diagnostics["energy_residual_J"])) for r in (first, run))
    exchanged = float(run.diagnostics["drive_exchange_J"])
    per_cycle = (late / 10.0 - early) / (exchanged / 10.0)
    yield Check("residual a cycle, growth / exchanged", per_cycle, 1e-8)


def drift_cases() -> Iterator[HardCase]:
    """A hundred cycles, and 2,000."""
    fast = replace(BASE, mechanism=Press(speed=FAST))
    for cycles, long in ((100, False), (2000, True)):
        name = f"{cycles:,} cycles at 40 pi"
        yield from in_both(name, "errors add up", fast, partial(drifts, cycles), long=long)
