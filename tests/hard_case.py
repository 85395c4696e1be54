"""Hard case with its verdict, and the soundness of runs that tests require."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage
from presswear.physics.packed import depths_of
from presswear.tools.errors import InputError, RunFailed
from presswear.validation.cases import Check, finished, missing_energy

Status = Literal["pass", "MISS", "refused"]

GRAZED = 0.01  # share of the contacts on worn surfaces that may be too short
# Energy residual allowed, relative to the energy exchanged by the drives. At their
# default tolerances the engines leave 1e-10, 1e-8 and 2e-6 on the unworn press; losses
# in the contacts are 1e-3 and more.
ENERGY = {"dae": 1e-6, "exudyn-tree": 1e-6, "exudyn-joints": 1e-4}


@dataclass(frozen=True)
class HardCase:
    """Problem with its checks."""

    name: str
    reason: str  # why the case is hard
    engine: str
    checks: Callable[[], Iterator[Check]]  # runs the case
    refusal: str = ""  # pattern of the message with which the case must be refused
    is_long: bool = False  # takes more than some ten seconds


class Outcome(NamedTuple):
    """Result of one check of a case, or of a case that was refused or failed."""

    case: HardCase
    check: Check | None  # None for a refusal or a failed run
    verdict: Status
    label: str  # checked quantity, or message of a refusal or of a failure


def outcomes(case: HardCase) -> Iterator[Outcome]:
    """Run a case and yield an outcome for every check and for every way to end."""
    try:
        for check in case.checks():
            if case.refusal:
                yield Outcome(case, check, "MISS", "runs, but must be refused")
                return
            status: Status = "pass" if check.passed else "MISS"
            yield Outcome(case, check, status, check.quantity)
    except (InputError, RunFailed, ArithmeticError) as error:
        is_refusal = case.refusal and not isinstance(error, ArithmeticError)
        is_expected = is_refusal and re.search(case.refusal, str(error))
        status = "refused" if is_expected else "MISS"
        yield Outcome(case, None, status, str(error))


def run_sound(linkage: Linkage, start: Start, engine: Engine, plan: Plan) -> Run:
    """Run a linkage; RunFailed says what is wrong with a run that is not sound."""
    return sound(engine.simulate(linkage, start, plan), plan)


def sound(run: Run, plan: Plan) -> Run:
    """Return a run; RunFailed unless it is complete, finite and has its contacts resolved.

    On a worn surface a pin may graze a bump: one contact in a hundred may then be too
    short.
    """
    recorder = finished(run).recorder
    records = recorder.records
    contacts = recorder.stored_contacts
    arrays: dict[str, list[ArrayLike]] = {
        "series": [recorder.rows],
        "cycles": [recorder.cycles],
        "wear": [recorder.maps.sampled],
        "state": [run.end.position, run.end.velocity],
        "energy": [
            value for value in run.diagnostics.values() if isinstance(value, float)
        ],
        "contacts": [contacts(k) for k in range(len(records.memory))],
    }
    for name, values in arrays.items():
        if not all(np.isfinite(array).all() for array in values):
            raise RunFailed(f"not finite: {name}")
    end = plan.cycle * plan.cycles
    if abs(run.time - end) > 1e-9:
        raise RunFailed(f"ended at {run.time:.9g} s, not at {end:.9g} s")
    unresolved = int(records.counters["unresolved"].sum())
    count = int(records.counters["contacts"].sum())
    is_worn = depths_of(records.packed).any()
    allowed = GRAZED * count if is_worn else 0
    if unresolved > allowed:
        raise RunFailed(f"{unresolved} of {count} contacts unresolved")
    return run


def energy_check(run: Run, engine: str) -> Check:
    """Return the check of the energy residual."""
    return Check("energy residual / exchanged", missing_energy(run), ENERGY[engine])
