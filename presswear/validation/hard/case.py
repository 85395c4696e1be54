"""Hard cases as data, how each is run under guard, and how it is judged."""

import re
import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage
from presswear.tools.errors import InputError, RunFailed
from presswear.validation.runs import Check, finished, missing_energy

Verdict = Literal["pass", "MISS", "refused"]
ENERGY = {"dae": 1e-6, "exudyn-tree": 1e-6, "exudyn-joints": 1e-4}
"""Energy that may be missing after a run, part of what the drives exchanged.

At their standard tolerances the engines leave 1e-10, 1e-8 and 2e-6 on the press with
new joints: a hundred times that, where it is hard, is still far below the losses in
the contacts, 1e-3 and more, that a run is there to tell.
"""


@dataclass(frozen=True)
class HardCase:
    """Something hard, and how to see that it went well.

    Attributes
    ----------
    name, hard : str
        Its name, and why it is hard.
    checks : callable
        Runs it; yields its checks.
    refusal : str
        Pattern of the message with which it must be refused, before or while it runs;
        empty where it must run.
    long : bool
        True where it takes more than some ten seconds.
    """

    name: str
    hard: str
    engine: str
    checks: Callable[[], Iterator[Check]]
    refusal: str = ""
    long: bool = False


@dataclass(frozen=True)
class HardOutcome:
    """The outcome of one check of a case, or of the case as a whole.

    Attributes
    ----------
    check : Check or None
        None where there is no figure: a refusal, or a run that did not end well.
    message : str
        Words of a refusal, or on what went wrong.
    seconds : float
        Wall time since the check before.
    """

    case: HardCase
    check: Check | None
    verdict: Verdict
    message: str
    seconds: float

    @property
    def numbers(self) -> tuple[str, str]:
        """Figure and bound, as tables show them."""
        if self.check is None:
            return "", ""
        return f"{self.check.value:.1e}", f"{self.check.bound:.0e}"

    @property
    def checked(self) -> str:
        """Name of the figure, or the message where there is none."""
        return self.message or (self.check.quantity if self.check else "")


def outcomes(case: HardCase) -> Iterator[HardOutcome]:
    """Run a case; whatever it does, every figure and every way to end gives an outcome."""
    began = clock.perf_counter()

    def told(check: Check | None, verdict: Verdict, message: str = "") -> HardOutcome:
        nonlocal began
        seconds, began = clock.perf_counter() - began, clock.perf_counter()
        return HardOutcome(case, check, verdict, message, seconds)

    try:
        for check in case.checks():
            if case.refusal:
                yield told(check, "MISS", "ran, where it must be refused")
                return
            yield told(check, "pass" if check.passed else "MISS")
    except (InputError, RunFailed) as error:
        as_expected = bool(case.refusal) and re.search(case.refusal, str(error)) is not None
        yield told(None, "refused" if as_expected else "MISS", str(error))
    except ArithmeticError as error:
        yield told(None, "MISS", str(error))


def ran(linkage: Linkage, start: Start, engine: Engine, plan: Plan) -> Run:
    """Run to a sound end; RunFailed says what is wrong with one that is not."""
    return sound(engine.simulate(linkage, start, plan), plan)


def sound(run: Run, plan: Plan) -> Run:
    """The run, or RunFailed: it failed, is not finite, ended early or left contacts unresolved."""
    recorder = finished(run).recorder
    arrays = {
        "series": recorder.rows,
        "cycles": np.array(recorder.cycles),
        "wear": recorder.maps.sampled,
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


def energy_of(run: Run, engine: str) -> Check:
    """Check the energy that is missing of what the drives exchanged."""
    return Check("energy residual / exchanged", missing_energy(run), ENERGY[engine])
