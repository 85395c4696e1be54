"""Cases with numerical checks, and functions on runs that all checks share.

``presswear verify`` and the tests run the same cases,
``reference_problems.reference_cases``.
"""

import math
import time as clock
import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np

from presswear.engines.base import Plan, Run
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed

Progress = Callable[[str, float], None]  # called with a name and the completed fraction

PATIENCE = 120.0  # s of CPU time after which a run is stopped; most need below 1 s


def read(file: str) -> dict[str, Any]:
    """Return the data of a TOML file beside this module."""
    text = files("presswear.validation").joinpath(file).read_text("utf-8")
    return tomllib.loads(text)


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
    source: str  # source of the reference
    checks: Callable[[], Iterator[Check]]  # runs the case


class Outcome(NamedTuple):
    """Result of one check of a case, or of a run that failed."""

    check: Check | None  # None for a failed run
    passed: bool
    label: str  # checked quantity, or message of a failure


def outcomes(case: Case) -> Iterator[Outcome]:
    """Run a case and yield an outcome for every check, and for a failure."""
    try:
        for check in case.checks():
            yield Outcome(check, check.passed, check.quantity)
    except (InputError, RunFailed, ArithmeticError) as error:
        yield Outcome(None, False, str(error))


def finished(run: Run, name: str = "") -> Run:
    """Return a run; RunFailed, prefixed with a name, if it failed."""
    if run.status == "failed":
        message = f"{name}: {run.message}" if name else run.message
        raise RunFailed(message)
    return run


def contacts_of(run: Run, k: int = 0) -> dict[str, Array]:
    """Return the recorded contacts of clearance joint ``k`` by column, shape (n,) each, SI."""
    return dict(zip(CONTACT_COLUMNS, run.recorder.stored_contacts(k).T, strict=True))


def first_contact(run: Run, k: int = 0) -> dict[str, float]:
    """Return the first contact of clearance joint ``k``; RunFailed if there is none."""
    contacts = contacts_of(finished(run), k)
    if not contacts["touchdown"].size:
        raise RunFailed("expected a contact, found none")
    return {name: float(column[0]) for name, column in contacts.items()}


def missing_energy(run: Run) -> float:
    """Return the absolute energy residual relative to the energy exchanged by the drives."""
    residual = float(run.diagnostics["energy_residual_J"])
    return abs(residual) / float(run.diagnostics["drive_exchange_J"])


def order_of(steps: Sequence[float], errors: Sequence[float]) -> float:
    """Return the observed order: the slope of log error over log step, by least squares.

    nan for fewer than two steps, or if an error is not finite and positive.
    """
    if len(set(steps)) < 2 or not (np.all(np.isfinite(errors)) and min(errors) > 0.0):
        return math.nan
    slope, _ = np.polyfit(np.log(steps), np.log(errors), 1)
    return float(slope)


def guarded(duration: float, cycles: int = 1, patience: float = PATIENCE) -> Plan:
    """Return a plan of cycles of a duration, s, that fails after ``patience``, s of CPU time.

    The time counts from the first report of progress.
    """
    started: float | None = None

    def report(fraction: float, recorder: object) -> None:
        nonlocal started
        now = clock.process_time()
        if started is None:
            started = now
        if now - started > patience:
            raise RunFailed(
                f"stopped after {patience:g} s of CPU time at {100.0 * fraction:.3g} %"
            )

    return Plan(duration, cycles, recorded_cycles=1, report=report)


def part_of(report: Progress, start: float, size: float, prefix: str = "") -> Progress:
    """Return the progress of a part of the work; start and size of the part are fractions."""
    return lambda name, fraction: report(prefix + name, start + size * fraction)


def worst_of(
    name: str, reference: Sequence[float] | Array, computed: Array, bound: float
) -> Check:
    """Return the check of the number that differs most from its reference."""
    worst = int(np.argmax(np.abs(computed - np.array(reference))))
    return Check.against(name, float(reference[worst]), float(computed[worst]), bound)
