"""How much a study of speed against error runs."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from presswear.trials.precision.methods import ALL, FEW, Rungs


@dataclass(frozen=True)
class Extent:
    """How much is run.

    Attributes
    ----------
    quick : bool
        Whether statistics and wear are studied in short as well.
    repeats : int
        How often each method is timed.
    rungs : Rungs
        Steps and tolerances.
    longest : float
        Longest horizon up to which trajectories are compared, s.
    beyond : bool
        Whether statistics beyond the horizon and wear are studied.
    """

    quick: bool
    repeats: int
    rungs: Rungs
    longest: float
    beyond: bool = True

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Extent":
        """An extent from its fields as plain data."""
        plain = dict(data)
        rungs = {name: tuple(values) for name, values in plain.pop("rungs").items()}
        return Extent(rungs=Rungs(**rungs), **plain)


QUICK = Extent(quick=True, repeats=5, rungs=FEW, longest=0.05)
"""A few steps and tolerances of each family."""
FULL = Extent(quick=False, repeats=5, rungs=ALL, longest=1.0)
