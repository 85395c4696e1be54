"""What a hard case is, how it is run under guard, and how it is judged."""

import re
import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine
from presswear.linkage.elements import Linkage
from presswear.record.tracker import Telling
from presswear.tools.errors import InputError, RunFailed

PATIENCE = 120.0
"""Wall time after which a run that still goes on counts as hung, s; most take below one."""
ENERGY = {"dae": 1e-6, "exudyn-tree": 1e-6, "exudyn-joints": 1e-4}
"""Energy that may be missing after a run, part of what the drives exchanged.

At their standard tolerances the engines leave 1e-10, 1e-8 and 2e-6 on the press with
new joints: a hundred times that, where it is hard, is still far below the losses in
the contacts, 1e-3 and more, that a run is there to tell.
"""


@dataclass(frozen=True)
class Finding:
    """One figure of a case.

    Attributes
    ----------
    what : str
        What was measured, with its unit.
    figure, bound : float
        The figure's size passes up to the bound.
    """

    what: str
    figure: float
    bound: float

    @property
    def passed(self) -> bool:
        """Whether the figure is within its bound; never for what is not a number."""
        return abs(self.figure) <= self.bound


@dataclass(frozen=True)
class Case:
    """Something hard, and how to see whether it went well.

    Attributes
    ----------
    name, hard : str
        What it is, and why it is hard.
    engine : str
    findings : callable
        Runs it; yields its figures.
    refusal : str
        Pattern of the message with which it must be refused, before or while it runs;
        empty where it must run.
    long : bool
        Whether it takes more than some ten seconds.
    """

    name: str
    hard: str
    engine: str
    findings: Callable[[], Iterator[Finding]]
    refusal: str = ""
    long: bool = False


@dataclass(frozen=True)
class Outcome:
    """What came of one figure of a case, or of the case as a whole.

    Attributes
    ----------
    finding : Finding or None
        None where there is no figure: a refusal, or a run that did not end well.
    verdict : {"pass", "MISS", "refused"}
    message : str
        Of a refusal or of what went wrong.
    seconds : float
        Wall time since the figure before.
    """

    case: Case
    finding: Finding | None
    verdict: str
    message: str
    seconds: float


def outcomes(case: Case) -> Iterator[Outcome]:
    """Run a case; whatever it does, every figure and every way to end gives an outcome."""
    began = clock.perf_counter()

    def told(finding: Finding | None, verdict: str, message: str = "") -> Outcome:
        nonlocal began
        seconds, began = clock.perf_counter() - began, clock.perf_counter()
        return Outcome(case, finding, verdict, message, seconds)

    try:
        for finding in case.findings():
            if case.refusal:
                yield told(finding, "MISS", "ran, where it must be refused")
                return
            yield told(finding, "pass" if finding.passed else "MISS")
    except (InputError, RunFailed) as error:
        as_expected = bool(case.refusal) and re.search(case.refusal, str(error)) is not None
        yield told(None, "refused" if as_expected else "MISS", str(error))
    except ArithmeticError as error:
        yield told(None, "MISS", str(error))


def guarded(duration: float, cycles: int = 1, patience: float = PATIENCE) -> Plan:
    """A plan whose run is stopped when it takes too long, counted from its first progress.

    Parameters
    ----------
    duration : float
        Of one cycle, s.
    patience : float
        Wall time, s.
    """
    began: float | None = None

    def progress(part: float) -> None:
        nonlocal began
        now = clock.perf_counter()
        began = now if began is None else began
        if now - began > patience:
            raise RunFailed(f"stopped after {patience:g} s of wall time at {100.0 * part:.3g} %")

    return Plan(duration, cycles, recorded_cycles=1, trackers=(Telling(progress),))


def ran(linkage: Linkage, start: Start, accuracy: Engine, plan: Plan) -> Run:
    """A run that ended well; RunFailed says what is wrong with one that did not."""
    return sound(accuracy.simulate(linkage, start, plan), plan)


def sound(run: Run, plan: Plan) -> Run:
    """The run, or RunFailed: it failed, is not finite, ended early or left contacts unresolved."""
    if run.status == "failed":
        raise RunFailed(run.message)
    recorder = run.recorder
    arrays = {
        "series": recorder.rows,
        "cycles": np.array(recorder.cycles),
        "wear": recorder.maps.total,
        "position": run.end.position,
        "velocity": run.end.velocity,
        "energy": np.array([x for x in run.diagnostics.values() if isinstance(x, float)]),
        **{f"contacts {k}": recorder.episodes(k) for k in range(len(recorder.book.memory))},
    }
    for name, values in arrays.items():
        if not np.all(np.isfinite(values)):
            raise RunFailed(f"not finite: {name}")
    if abs(run.time - plan.cycle * plan.cycles) > 1e-9:
        raise RunFailed(f"ended at {run.time:.9g} s, not at {plan.cycle * plan.cycles:.9g} s")
    unresolved = int(recorder.book.tally["unresolved"].sum())
    if unresolved:
        total = int(recorder.book.tally["contacts"].sum())
        raise RunFailed(f"{unresolved} of {total} contacts unresolved")
    return run


def energy_of(run: Run, engine: str) -> Finding:
    """What is missing of the energy that the drives exchanged."""
    residual = float(run.diagnostics["energy_residual_J"])
    exchanged = float(run.diagnostics["drive_exchange_J"])
    return Finding("energy residual / exchanged", abs(residual) / exchanged, ENERGY[engine])
