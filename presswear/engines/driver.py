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

    # integrates up to a time, s; up to the nominal time of ``Recorder.aim`` if it is set
    advance: Callable[[float], Finding | None]
    # time, s, and q and v of all bodies, copied
    state: Callable[[], tuple[float, Array, Array]]
    ledger: Callable[[], Ledger]  # energies since the run began
    # fills the contacts of the present state on changed surfaces
    worn: Callable[[], None]
    # Live arrays that, with ``sums`` and the recorder, hold the state between two
    # cycles
    arrays: Mapping[str, NDArray[Any]]
    sums: dict[str, float]  # counts and times summed over the cycles
    # of this engine for ``Run``
    diagnostics: Callable[[], dict[str, float | int | str]]
    remedy: str  # what makes the steps of this engine finer
    constraints: Constraints | None = None  # what may drift
    close: Callable[[], None] = lambda: None  # frees what the engine holds


# Builds the model of a linkage in a start, with an engine's settings
Prepare = Callable[[Linkage, Start, Any, Plan, Recorder], Simulation]
Case = tuple[Linkage, Start, Plan]

# among the sums: elastic energy of what was worn off under load, J
_WORN_OFF = "worn_off"
# Energies of the ledger by the column of the cycle that adds to them; the sums hold
# their values at the end of the last cycle, J
_ENERGIES = {
    CONTACT_MADE: "made",
    DRIVE_WORK: "drive_work",
    STORED_ENERGY_CHANGE: "stored",
}


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
        cpu=clock.process_time() - began,
    )
    running.close()
    return run


class _Cycles:
    """The cycles of a run.

    Every cycle begins in the same way from the state that the last one left, whether
    this process computed that or read it: a run that was killed and goes on gives the
    same numbers.
    """

    def __init__(
        self, linkage: Linkage, recorder: Recorder, plan: Plan, running: Simulation
    ) -> None:
        self.linkage, self.recorder, self.plan, self.running = (
            linkage,
            recorder,
            plan,
            running,
        )

    def run(self) -> tuple[Status, Finding | None]:
        """Run to the end; return how the run ended and what went wrong, if anything."""
        finding = self._run_up()
        while finding is None:
            if status := self._ended():
                return status, None
            finding = self._cycle()
        return "failed", finding

    def _run_up(self) -> Finding | None:
        """Run up from rest, where the first cycle follows that."""
        if self.plan.run_up == 0.0 or len(self.recorder.cycles):
            return None
        finding = self._advance(self.plan.run_up)
        if finding is None:
            self.recorder.start_cycle()
        return finding

    def _ended(self) -> Status | None:
        """Return how the run ended with the last cycle, if it did.

        Every observer is notified of the cycle, whichever ends the run.
        """
        done = len(self.recorder.cycles)
        if done == 0:
            return None
        answers = [
            one.on_cycle(self.recorder, self._state) for one in self.plan.observers
        ]
        if done >= self.plan.cycles:
            return "completed"
        return "enough" if any(answers) else None

    def _cycle(self) -> Finding | None:
        """Run one cycle; return what went wrong, if anything."""
        plan, recorder = self.plan, self.recorder
        done = len(recorder.cycles)
        for phase in plan.sections:
            if phase < 1.0:
                if finding := self._integrate(plan.time_of(done + phase)):
                    return finding
                recorder.note_section()
        if finding := self._advance(plan.time_of(done + 1)):
            return finding
        if 1.0 in plan.sections:
            recorder.note_section()
        dose = recorder.end_cycle()
        if plan.wear is not None:
            self._wear(plan.wear(done + 1, dose, recorder.surface_depth))
        if done + 1 == plan.recorded_cycles:
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
        running, recorder = self.running, self.recorder
        finding = self._integrate(end)
        if finding is not None:
            return finding
        time, position, velocity = running.state()
        ledger = _balance(running)
        for column, name in _ENERGIES.items():
            energy = getattr(ledger, name)
            recorder.records.cycle[column] = energy - running.sums[name]
            running.sums[name] = energy
        now = Condition(
            time, ledger, position, velocity, running.remedy, running.constraints
        )
        return examine(self.linkage, recorder, now)

    def _wear(self, depth: Array) -> None:
        """Wear the surfaces; the elastic energy of what is worn off under load goes with it."""
        running = self.running
        before = running.ledger().residual
        self.recorder.wear(depth, running.worn)
        running.sums[_WORN_OFF] += running.ledger().residual - before

    def _state(self) -> State:
        """Return the state between two cycles."""
        running = self.running
        return {
            **{name: array.copy() for name, array in running.arrays.items()},
            "sums": np.array([running.sums[name] for name in sorted(running.sums)]),
            **named("recorder", self.recorder.save()),
        }
