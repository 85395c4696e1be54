"""One driver for all engines: cycle by cycle, from a state that can be written down."""

import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from numpy.typing import NDArray

from presswear.engines.base import Plan, Run, Start, Status, recorder_of
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import Constraints
from presswear.physics.forces import Ledger
from presswear.recording.observe import CONTACT_MADE, DRIVE_WORK
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Condition, Finding, examine
from presswear.tools.arrays import Array, State, named, numbers, part, set_numbers


@dataclass(frozen=True)
class Simulation:
    """A linkage in an engine, ready to run."""

    advance: Callable[[float], Finding | None]  # integrates up to a time, s
    state: Callable[[], tuple[float, Array, Array]]  # time, s, and q and v of all bodies, copied
    ledger: Callable[[], Ledger]  # energies since the run began
    # Live arrays that, with ``sums`` and the recorder, hold the state between two cycles
    arrays: Mapping[str, NDArray[Any]]
    sums: dict[str, float]  # counts and times summed over the cycles
    diagnostics: Callable[[], dict[str, float | int | str]]  # of this engine for ``Run``
    remedy: str  # what makes the steps of this engine finer
    constraints: Constraints | None = None  # what may drift
    worn: Callable[[], None] = lambda: None  # called when the surfaces have changed
    close: Callable[[], None] = lambda: None  # frees what the engine holds


# Builds the model of a linkage in a start, with an engine's settings
Prepare = Callable[[Linkage, Start, Any, Plan, Recorder], Simulation]

# Among the sums: elastic energy of what was worn off under load, J; energies of the ledger up to
# the end of the last cycle, J
_WORN_OFF, _MADE, _DRIVE_WORK = "worn_off", "made", "drive_work"


def _balance(running: Simulation) -> Ledger:
    """Return the energies so far; what went with worn surfaces is lost in contacts."""
    ledger = running.ledger()
    return replace(ledger, contact_loss=ledger.contact_loss + running.sums[_WORN_OFF])


def simulate(prepare: Prepare, linkage: Linkage, start: Start, settings: Any, plan: Plan) -> Run:
    """Run a linkage from a start; see ``Plan`` and ``Run``."""
    recorder = recorder_of(linkage, start, plan)
    running = prepare(linkage, start, settings, plan, recorder)
    running.sums.update({_WORN_OFF: 0.0, _MADE: 0.0, _DRIVE_WORK: 0.0})
    if plan.resume is not None:
        for name, array in running.arrays.items():
            array[...] = plan.resume[name]
        set_numbers(running.sums, plan.resume["sums"])
        recorder.load(part(plan.resume, "recorder"))
    started = clock.process_time()
    status, finding = _cycles(linkage, recorder, plan, running)
    cpu = clock.process_time() - started
    time, position, velocity = running.state()
    run = Run(
        status=status,
        finding=finding,
        recorder=recorder,
        end=Start(position, velocity),
        time=time,
        diagnostics={**running.diagnostics(), **_balance(running).as_dict()},
        cpu=cpu,
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
            "sums": numbers(running.sums),
            **named("recorder", recorder.save()),
        }

    def advanced(end: float) -> Finding | None:
        finding = running.advance(end)
        if finding is not None:
            return finding
        time, position, velocity = running.state()
        ledger = _balance(running)
        recorder.records.cycle[CONTACT_MADE] = ledger.made - running.sums[_MADE]
        recorder.records.cycle[DRIVE_WORK] = ledger.drive_work - running.sums[_DRIVE_WORK]
        running.sums.update({_MADE: ledger.made, _DRIVE_WORK: ledger.drive_work})
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
            recorder.wear(plan.wear(done + 1, added), *running.state()[1:])
            running.worn()
            running.sums[_WORN_OFF] += running.ledger().residual - before
        if done + 1 == plan.recorded_cycles:
            recorder.stop_recording()
