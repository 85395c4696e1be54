"""Parts that the trials share: progress, runs that ended well, orders, and checks with bounds."""

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Run
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.observer import AdvanceObserver
from presswear.tools.errors import RunFailed

Array = NDArray[np.float64]
Progress = Callable[[str, float], None]
"""Called with the name of what runs and the completed fraction."""
Told = Progress

PATIENCE = 120.0
"""CPU time after which a run that still goes on counts as hung, s; most take below one."""


def part_of(told: Told, start: float, size: float, whole: float = 1.0, prefix: str = "") -> Told:
    """Tell of a part of the whole.

    Parameters
    ----------
    start, size, whole : float
        Where the part begins, how large it is, and how large the whole is.
    prefix : str
        Stands before each word.
    """
    return lambda word, part: told(f"{prefix}{word}", (start + size * part) / whole)


def parts_of(told: Told, sizes: Mapping[str, float]) -> dict[str, Told]:
    """Share the whole out among sections of some sizes, whose names stand before each word."""
    found, before, whole = {}, 0.0, sum(sizes.values())
    for section, size in sizes.items():
        found[section] = part_of(told, before, size, whole, f"{section}: ")
        before += size
    return found


@dataclass(frozen=True)
class Check:
    """A figure with its bound; without a bound it is only reported.

    Attributes
    ----------
    quantity : str
        Name of the figure.
    value : float
        Its size passes up to the bound.
    """

    quantity: str
    value: float
    bound: float | None
    unit: str = ""

    @property
    def passed(self) -> bool:
        """True where the figure is within its bound; never for what is not a number."""
        return self.bound is None or abs(self.value) <= self.bound


def finished(run: Run, name: str = "") -> Run:
    """Give back a run that ended well; RunFailed, with a name before it, for one that failed."""
    if run.status == "failed":
        raise RunFailed(f"{name}: {run.message}" if name else run.message)
    return run


def contacts_of(run: Run, k: int = 0) -> dict[str, Array]:
    """Recorded contacts of clearance joint ``k`` by ``CONTACT_COLUMNS``, each shape (n,); SI."""
    return dict(zip(CONTACT_COLUMNS, run.recorder.episodes(k).T, strict=True))


def missing_energy(run: Run) -> float:
    """Energy that does not add up, part of what the drives exchanged."""
    residual, exchanged = (
        float(run.diagnostics[name]) for name in ("energy_residual_J", "drive_exchange_J")
    )
    return abs(residual) / exchanged


def order_of(steps: Sequence[float], errors: Sequence[float]) -> float:
    """Observed order: slope of log error over log step, by least squares.

    nan for fewer than two steps, or an error that has no logarithm.
    """
    if len(set(steps)) < 2 or not (np.all(np.isfinite(errors)) and min(errors) > 0.0):
        return math.nan
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def guarded(duration: float, cycles: int = 1, patience: float = PATIENCE) -> Plan:
    """A plan whose run is stopped when it takes too long, counted from its first progress.

    Parameters
    ----------
    duration : float
        Duration of one cycle, s.
    patience : float
        CPU time, s.
    """
    began: float | None = None

    def told(part: float) -> None:
        nonlocal began
        now = clock.process_time()
        began = now if began is None else began
        if now - began > patience:
            raise RunFailed(f"stopped after {patience:g} s of CPU time at {100.0 * part:.3g} %")

    return Plan(duration, cycles, recorded_cycles=1, observers=(AdvanceObserver(told),))
