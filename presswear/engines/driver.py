"""One driver for all engines: cycle by cycle, from a state that can be written down."""

import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Run, Start, Status, recorder_of
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import Constraints
from presswear.physics.ledger import Ledger
from presswear.recording.columns import CONTACT_MADE, DRIVE_WORK, STORED_ENERGY_CHANGE
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Condition, Finding, examine, with_cause
from presswear.tools.arrays import Array, State, named, part


@dataclass(frozen=True)
class Simulation:
    """A linkage in an engine, ready to run."""

    advance: Callable[[float], Finding | None]  # integrates up to a time, s
    state: Callable[[], tuple[float, Array, Array]]  # time, s, and q and v of all bodies, copied
    ledger: Callable[[], Ledger]  # energies since the run began
    worn: Callable[[], None]  # fills the contacts of the present state on changed surfaces
    # Live arrays that, with ``sums`` and the recorder, hold the state between two cycles
    arrays: Mapping[str, NDArray[Any]]
    sums: dict[str, float]  # counts and times summed over the cycles
    diagnostics: Callable[[], dict[str, float | int | str]]  # of this engine for ``Run``
    remedy: str  # what makes the steps of this engine finer
    constraints: Constraints | None = None  # what may drift
    close: Callable[[], None] = lambda: None  # frees what the engine holds


# Builds the model of a linkage in a start, with an engine's settings
Prepare = Callable[[Linkage, Start, Any, Plan, Recorder], Simulation]
Case = tuple[Linkage, Start, Plan]

_WORN_OFF = "worn_off"  # among the sums: elastic energy of what was worn off under load, J
# Energies of the ledger by the column of the cycle that adds to them; the sums hold their values
# at the end of the last cycle, J
_ENERGIES = {CONTACT_MADE: "made", DRIVE_WORK: "drive_work", STORED_ENERGY_CHANGE: "stored"}


def _balance(running: Simulation) -> Ledger:
    """Return the energies so far; what went with worn surfaces is lost in contacts."""
    ledger = running.ledger()
    return replace(ledger, contact_loss=ledger.contact_loss + running.sums[_WORN_OFF])


def simulate(prepare: Prepare, settings: Any, case: Case) -> Run:
    """Run a linkage from its start; see ``Plan`` and ``Run``."""
    linkage, start, plan = case
    linkage = linkage.released
    recorder = recorder_of(linkage, start, plan)
    running = prepare(linkage, start, settings, plan, recorder)
    began = clock.process_time()
    running.sums.update(dict.fromkeys((_WORN_OFF, *_ENERGIES.values()), 0.0))
    if plan.resume is not None:
        for name, array in running.arrays.items():
            array[...] = plan.resume[name]
        stored = plan.resume["sums"].tolist()
        running.sums.update(zip(sorted(running.sums), stored, strict=True))
        recorder.load(part(plan.resume, "recorder"))
    status, finding = _cycles(linkage, recorder, plan, running)
    time, position, velocity = running.state()
    if finding is not None:
        finding = with_cause(finding, linkage, recorder, position, velocity)
    run = Run(
        status=status,
        finding=finding,
        recorder=recorder,
        end=Start(position, velocity),
        time=time,
        diagnostics={**running.diagnostics(), **_balance(running).as_dict()},
        cpu=clock.process_time() - began,
    )
    running.close()
    return run


def _cycles(
    linkage: Linkage, recorder: Recorder, plan: Plan, running: Simulation
) -> tuple[Status, Finding | None]:
    """Run cycle by cycle; returns how it ended and what went wrong, if anything.

    Every cycle begins in the same way from the state that the last one left, whether this
    process computed that or read it: a run that was killed and goes on gives the same numbers.
    """

    def state() -> State:
        return {
            **{name: array.copy() for name, array in running.arrays.items()},
            "sums": np.array([running.sums[name] for name in sorted(running.sums)]),
            **named("recorder", recorder.save()),
        }

    def advanced(end: float) -> Finding | None:
        finding = running.advance(end)
        if finding is not None:
            return finding
        time, position, velocity = running.state()
        ledger = _balance(running)
        for column, name in _ENERGIES.items():
            energy = getattr(ledger, name)
            recorder.records.cycle[column] = energy - running.sums[name]
            running.sums[name] = energy
        now = Condition(time, ledger, position, velocity, running.remedy, running.constraints)
        return examine(linkage, recorder, now)

    if plan.run_up > 0.0 and not len(recorder.cycles):
        finding = advanced(plan.run_up)
        if finding:
            return "failed", finding
        recorder.start_cycle()
    inner = [phase for phase in plan.sections if phase < 1.0]
    while True:
        done = len(recorder.cycles)
        if done > 0:
            # Every observer hears of the cycle, whichever ends the run.
            answers = [observer.on_cycle(recorder, state) for observer in plan.observers]
            if done >= plan.cycles:
                return "completed", None
            if any(answers):
                return "enough", None
        cycle_start = plan.run_up + plan.cycle * done
        for phase in inner:
            finding = running.advance(cycle_start + phase * plan.cycle)
            if finding:
                return "failed", finding
            recorder.note_section()
        finding = advanced(plan.run_up + plan.cycle * (done + 1))
        if finding:
            return "failed", finding
        if len(inner) < len(plan.sections):
            recorder.note_section()
        added = recorder.end_cycle()
        if plan.wear is not None:
            before = running.ledger().residual
            recorder.wear(plan.wear(done + 1, added), running.worn)
            running.sums[_WORN_OFF] += running.ledger().residual - before
        if done + 1 == plan.recorded_cycles:
            recorder.stop_recording()
