"""Driver of all engines: runs cycle by cycle, and can store and resume its state."""

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
from presswear.tools.compile_errors import short_errors


@dataclass(frozen=True)
class Simulation:
    """Model of a linkage in an engine, ready to run."""

    # integrate up to a time, s, or up to the nominal time of ``Recorder.aim`` if set
    advance: Callable[[float], Finding | None]
    # return the time, s, and copies of q and v of all bodies
    state: Callable[[], tuple[float, Array, Array]]
    ledger: Callable[[], Ledger]  # return the energies since the run began
    # update the contacts of the present state after the surfaces have changed
    update_contacts: Callable[[], None]
    # Arrays that the engine changes. With ``sums`` and the recorder they determine how
    # the run continues after a cycle.
    arrays: Mapping[str, NDArray[Any]]
    sums: dict[str, float]  # counts and times, summed over the cycles
    # return the diagnostics of this engine for ``Run``
    diagnostics: Callable[[], dict[str, float | int | str]]
    remedy: str  # setting that makes the steps of this engine finer
    constraints: Constraints | None = None  # to be checked for drift
    close: Callable[[], None] = lambda: None  # free the resources of the engine


# Build the model of a linkage in its initial state, with the settings of an engine
Prepare = Callable[[Linkage, Start, Any, Plan, Recorder], Simulation]
Case = tuple[Linkage, Start, Plan]

# Name of a sum: elastic energy of the material that was worn off under load, J
_WORN_OFF = "worn_off"
# Columns of a cycle, and the energy of the ledger whose change in the cycle each stores.
# The sums hold the energies at the end of the last cycle, J.
_ENERGIES = {
    CONTACT_MADE: "created",
    DRIVE_WORK: "drive_work",
    STORED_ENERGY_CHANGE: "stored",
}


def _balance(running: Simulation) -> Ledger:
    """Return the energies so far.

    The elastic energy of material that was worn off counts as contact loss.
    """
    ledger = running.ledger()
    contact_loss = ledger.contact_loss + running.sums[_WORN_OFF]
    return replace(ledger, contact_loss=contact_loss)


def simulate(prepare: Prepare, settings: Any, case: Case) -> Run:
    """Run a linkage from its start; see ``Plan`` and ``Run``.

    Raises
    ------
    InputError
        If a user law fails; with its line.
    """
    with short_errors:
        return _simulate(prepare, settings, case)


def _simulate(prepare: Prepare, settings: Any, case: Case) -> Run:
    """Build the model, resume the stored state if there is one, and run all cycles."""
    linkage, start, plan = case
    linkage = linkage.released
    recorder = recorder_of(linkage, start, plan)
    running = prepare(linkage, start, settings, plan, recorder)
    started = clock.process_time()
    running.sums.update(dict.fromkeys((_WORN_OFF, *_ENERGIES.values()), 0.0))
    if plan.resume is not None:
        for name, array in running.arrays.items():
            array[...] = plan.resume[name]
        stored = plan.resume["sums"].tolist()
        running.sums.update(zip(sorted(running.sums), stored, strict=True))
        recorder.load(part(plan.resume, "recorder"))
    status, finding = _Cycles(linkage, recorder, plan, running).run()
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
        cpu=clock.process_time() - started,
    )
    running.close()
    return run


class _Cycles:
    """Cycles of a run.

    Every cycle begins from the state at the end of the previous cycle, whether this
    process has computed that state or read it from a checkpoint. A resumed run
    therefore gives the same numbers.
    """

    def __init__(
        self, linkage: Linkage, recorder: Recorder, plan: Plan, running: Simulation
    ) -> None:
        self.linkage = linkage
        self.recorder = recorder
        self.plan = plan
        self.running = running

    def run(self) -> tuple[Status, Finding | None]:
        """Run to the end; return how the run ended and what went wrong, if anything."""
        finding = self._run_up()
        while finding is None:
            if status := self._ended():
                return status, None
            finding = self._cycle()
        return "failed", finding

    def _run_up(self) -> Finding | None:
        """Run up from rest before the first cycle; return what went wrong, if anything."""
        if self.plan.run_up == 0.0 or len(self.recorder.cycles):
            return None
        finding = self._advance(self.plan.run_up)
        if finding is None:
            self.recorder.start_cycle()
        return finding

    def _ended(self) -> Status | None:
        """Return how the run ended with the last cycle, or None if it continues.

        All observers are notified of the cycle, also if the first of them ends the run.
        """
        finished = len(self.recorder.cycles)
        if finished == 0:
            return None
        requests = [
            observer.on_cycle(self.recorder, self._state)
            for observer in self.plan.observers
        ]
        if finished >= self.plan.cycles:
            return "completed"
        return "enough" if any(requests) else None

    def _cycle(self) -> Finding | None:
        """Run one cycle; return what went wrong, if anything."""
        plan = self.plan
        recorder = self.recorder
        finished = len(recorder.cycles)
        for phase in plan.sections:
            if phase < 1.0:
                if finding := self._integrate(plan.time_of(finished + phase)):
                    return finding
                recorder.note_section()
        if finding := self._advance(plan.time_of(finished + 1)):
            return finding
        if 1.0 in plan.sections:
            recorder.note_section()
        depth = recorder.end_cycle()
        if plan.wear is not None:
            self._wear(plan.wear(finished + 1, depth, recorder.surface_depth))
        if finished + 1 == plan.recorded_cycles:
            recorder.stop_recording()
        return None

    def _integrate(self, end: float) -> Finding | None:
        """Integrate up to a nominal time, s; return what went wrong, if anything."""
        if self.recorder.has_leader and not self.plan.by_clock:
            self.recorder.aim(end)
        return self.running.advance(end)

    def _advance(self, end: float) -> Finding | None:
        """Integrate up to a nominal time, s, and account for the energies.

        Returns what went wrong, if anything.
        """
        running = self.running
        recorder = self.recorder
        finding = self._integrate(end)
        if finding is not None:
            return finding
        time, position, velocity = running.state()
        ledger = _balance(running)
        for column, name in _ENERGIES.items():
            energy = getattr(ledger, name)
            recorder.records.cycle[column] = energy - running.sums[name]
            running.sums[name] = energy
        condition = Condition(
            time, ledger, position, velocity, running.remedy, running.constraints
        )
        return examine(self.linkage, recorder, condition)

    def _wear(self, depth: Array) -> None:
        """Wear the surfaces by a depth, m.

        The elastic energy of material that is worn off under load is lost. It is the
        change of the residual of the ledger.
        """
        running = self.running
        before = running.ledger().residual
        self.recorder.wear(depth, running.update_contacts)
        running.sums[_WORN_OFF] += running.ledger().residual - before

    def _state(self) -> State:
        """Return the state between two cycles."""
        running = self.running
        state = {name: array.copy() for name, array in running.arrays.items()}
        state["sums"] = np.array([running.sums[name] for name in sorted(running.sums)])
        return {**state, **named("recorder", self.recorder.save())}
