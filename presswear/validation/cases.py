"""Cases with numerical checks, and functions on runs that all checks share.

``presswear verify`` and the tests run the same cases:
``reference_problems.reference_cases`` and ``hard_cases.hard_cases``.
"""

import math
import re
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage
from presswear.physics.packed import depths_of
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed

Progress = Callable[[str, float], None]  # called with a name and the completed fraction
Status = Literal["pass", "MISS", "refused"]

GRAZED = 0.01  # share of the contacts on worn surfaces that may be too short
PATIENCE = 120.0  # s of CPU time after which a run counts as hung; most take below one
# Energy residual allowed, relative to the energy exchanged by the drives. At their
# default tolerances the engines leave 1e-10, 1e-8 and 2e-6 on the unworn press; losses
# in the contacts are 1e-3 and more.
ENERGY = {"dae": 1e-6, "exudyn-tree": 1e-6, "exudyn-joints": 1e-4}


@dataclass(frozen=True)
class Check:
    """Number whose absolute value may be at most a bound."""

    quantity: str
    value: float  # an error if there is a reference
    bound: float
    unit: str = ""
    # expected number, in the unit that the quantity names
    reference: float | None = None

    @staticmethod
    def against(
        quantity: str, reference: float, computed: float, bound: float
    ) -> "Check":
        """Compare a computed number with its reference."""
        return Check(quantity, computed - reference, bound, reference=reference)

    @property
    def passed(self) -> bool:
        """True if the number is within its bound; False for nan."""
        return abs(self.value) <= self.bound


@dataclass(frozen=True)
class Case:
    """Problem with its checks."""

    name: str
    reason: str  # source of the reference, or why the case is hard
    engine: str
    checks: Callable[[], Iterator[Check]]  # runs the case
    refusal: str = ""  # pattern of the message with which the case must be refused
    is_long: bool = False  # takes more than some ten seconds


class Outcome(NamedTuple):
    """Result of one check of a case, or of a case that was refused or failed."""

    case: Case
    check: Check | None  # None for a refusal or a failed run
    verdict: Status
    label: str  # checked quantity, or message of a refusal or of a failure
    seconds: float  # wall time since the previous outcome


def outcomes(case: Case) -> Iterator[Outcome]:
    """Run a case and yield an outcome for every check and for every way to end."""
    started = clock.perf_counter()
    try:
        for check in case.checks():
            ended = clock.perf_counter()
            if case.refusal:
                yield Outcome(
                    case, check, "MISS", "runs, but must be refused", ended - started
                )
                return
            status: Status = "pass" if check.passed else "MISS"
            yield Outcome(case, check, status, check.quantity, ended - started)
            started = ended
    except (InputError, RunFailed, ArithmeticError) as error:
        is_refusal = case.refusal and not isinstance(error, ArithmeticError)
        is_expected = is_refusal and re.search(case.refusal, str(error))
        status = "refused" if is_expected else "MISS"
        yield Outcome(case, None, status, str(error), clock.perf_counter() - started)


def finished(run: Run, name: str = "") -> Run:
    """Return a run; RunFailed, prefixed with a name, if it failed."""
    if run.status == "failed":
        raise RunFailed(f"{name}: {run.message}" if name else run.message)
    return run


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


def contacts_of(run: Run, k: int = 0) -> dict[str, Array]:
    """Return the recorded contacts of clearance joint ``k`` by column, shape (n,) each, SI."""
    return dict(zip(CONTACT_COLUMNS, run.recorder.stored_contacts(k).T, strict=True))


def first_contact(run: Run, k: int = 0) -> dict[str, float]:
    """Return the first contact of clearance joint ``k``; RunFailed if there is none."""
    contacts = contacts_of(finished(run), k)
    if not contacts["touchdown"].size:
        raise RunFailed("no contact, where there must be one")
    return {name: float(column[0]) for name, column in contacts.items()}


def missing_energy(run: Run) -> float:
    """Return the absolute energy residual relative to the energy exchanged by the drives."""
    residual = float(run.diagnostics["energy_residual_J"])
    return abs(residual) / float(run.diagnostics["drive_exchange_J"])


def energy_check(run: Run, engine: str) -> Check:
    """Return the check of the energy residual."""
    return Check("energy residual / exchanged", missing_energy(run), ENERGY[engine])


def order_of(steps: Sequence[float], errors: Sequence[float]) -> float:
    """Return the observed order: the slope of log error over log step, by least squares.

    nan for fewer than two steps, or if an error is not finite and positive.
    """
    if len(set(steps)) < 2 or not (np.all(np.isfinite(errors)) and min(errors) > 0.0):
        return math.nan
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def guarded(duration: float, cycles: int = 1, patience: float = PATIENCE) -> Plan:
    """Return a plan of cycles of a duration, s, that fails after ``patience``, s of CPU time.

    The time counts from the first report of progress.
    """
    started: float | None = None

    def report(part: float, recorder: object) -> None:
        nonlocal started
        now = clock.process_time()
        started = now if started is None else started
        if now - started > patience:
            raise RunFailed(
                f"stopped after {patience:g} s of CPU time at {100.0 * part:.3g} %"
            )

    return Plan(duration, cycles, recorded_cycles=1, report=report)


def part_of(report: Progress, start: float, size: float, prefix: str = "") -> Progress:
    """Return the progress of a part of a whole that starts at a fraction and has a size."""
    return lambda name, part: report(prefix + name, start + size * part)
