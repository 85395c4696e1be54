"""What follows from the points of a sweep for one of its measures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswear.recording.statistics import Estimate
from presswear.sweeps.chaos import chaos_share
from presswear.sweeps.distributions import Distribution
from presswear.sweeps.one_plan import first_order
from presswear.sweeps.responses import Responses, responses
from presswear.sweeps.sensitivity import Indices, Screening, Swing, by_blocks, screening, swings
from presswear.sweeps.spread import Required, Spread, spread_of_rows, spread_of_surface
from presswear.sweeps.surface import Surface, surface
from presswear.sweeps.table import Table
from presswear.tools.errors import InputError

SAMPLES = ("sobol", "latin")
"""Designs whose points are a sample of the distributions of all factors."""
STEPPED = ("saltelli", "morris", "one")
"""Designs whose points hang together."""

MOST_OUTSIDE = 0.05
"""Part of a distribution that may lie outside the points of a surface."""


@dataclass(frozen=True)
class Analysis:
    """A measure of a sweep, and all that its points tell; None for what they do not.

    Attributes
    ----------
    own : Responses
    chaos : Estimate or None
        Share of the variance of a run.
    indices : Indices or None
    screening : tuple of Screening or None
    swings : tuple of (Swing or None) or None
    surface : Surface or None
    refusal : str
        Why there is no surface.
    out_of_reach : str
        Why it tells no spread, where all factors have distributions.
    runs, without : int
        All of them, and those without a value: they failed, or have not run yet.
    required : Required or None
    spread, mean_spread : Spread or None
        By the surface, of single runs and of what runs are on average.
    rows : Spread or None
        Of the rows alone.
    """

    own: Responses
    chaos: Estimate | None
    indices: Indices | None
    screening: tuple[Screening, ...] | None
    swings: tuple[Swing | None, ...] | None
    surface: Surface | None
    refusal: str
    out_of_reach: str
    runs: int
    without: int
    required: Required | None
    spread: Spread | None
    mean_spread: Spread | None
    rows: Spread | None

    @property
    def is_constant(self) -> bool:
        """True where the measure is the same at all points that have a value."""
        return float(np.ptp(self.own.means[self.own.has_value])) == 0.0

    @property
    def strongest(self) -> Sequence[int]:
        """Places of the factors, the one that the measure depends on most first."""
        count = len(self.own.factors)
        strength: Sequence[float] = [0.0] * count
        if self.indices is not None and self.indices.total:
            strength = [one.mean for one in self.indices.total]
        elif self.screening is not None:
            strength = [one.size.mean for one in self.screening]
        elif self.swings is not None:
            strength = [0.0 if one is None else one.span for one in self.swings]
        elif self.surface is not None:
            strength = [_reach(self.surface, k) for k in range(count)]
        elif self.indices is not None:
            strength = [one.mean for one in self.indices.first]
        return sorted(range(count), key=lambda k: -strength[k])


def _reach(found: Surface, place: int) -> float:
    """Standard deviation of a surface along one factor, all others in the middle, scaled."""
    points = np.tile(found.own.middle, (len(found.own.points), 1))
    points[:, place] = found.own.points[:, place]
    return float(found.mean(points).std())


def analysed(
    table: Table,
    key: str,
    sample: str = "",
    distributions: Mapping[str, Distribution] | None = None,
    required: Required | None = None,
) -> Analysis:
    """All that a table tells of one of its measures.

    Parameters
    ----------
    key : str
        Of the measure.
    sample : str
        Kind of the design of all factors, or of those that the others are crossed with; nothing
        for a grid.
    distributions : mapping or None
        By the keys of the factors.
    required : Required or None
        What the measure is not to miss.

    Raises
    ------
    InputError
        For a key that is none, or a table without any value of it.
    """
    own = responses(table, key)
    if not own.has_value.any():
        raise InputError(f"no run has a value of {key}")
    known = distributions or {}
    scattered = [known[factor.key] for factor in own.factors if factor.key in known]
    is_whole = len(scattered) == len(own.factors)
    blocks, paths, alone = by_blocks(own), screening(own), swings(own)
    # What is drawn along paths, or about a middle, is no sample of anything.
    is_stepped = sample in STEPPED or paths is not None or alone is not None
    indices = blocks or (None if is_stepped else first_order(own))
    found, refusal = None, ""
    try:
        found = surface(own)
    except InputError as error:
        refusal = str(error)
    # Blocks of Saltelli hang together; their chaos is told beside their indices.
    chaos = blocks.chaos if blocks is not None else chaos_share(own)

    far = "" if found is None or not is_whole else _out_of_reach(found, scattered)

    def by_surface(chaos: bool) -> Spread | None:
        if found is None or not is_whole or far:
            return None
        return spread_of_surface(found, scattered, required, chaos=chaos)

    return Analysis(
        own=own,
        chaos=chaos,
        indices=indices,
        screening=paths,
        swings=alone,
        surface=found,
        refusal=refusal,
        out_of_reach=far,
        runs=len(table.reasons),
        without=int(np.count_nonzero(np.isnan(table.values[:, table.place(key)]))),
        required=required,
        spread=by_surface(chaos=True),
        mean_spread=by_surface(chaos=False),
        rows=spread_of_rows(table, key, required) if is_whole and sample in SAMPLES else None,
    )


def _out_of_reach(found: Surface, distributions: Sequence[Distribution]) -> str:
    """Name a factor whose points leave out too much of its distribution, with how much; or none."""
    probabilities = (np.arange(1000) + 0.5) / 1000
    for factor, own, values in zip(
        found.own.factors, distributions, found.own.points.T, strict=True
    ):
        drawn = own.at(probabilities)
        outside = float(np.mean((drawn < values.min()) | (drawn > values.max())))
        if outside > MOST_OUTSIDE:
            return (
                f"{100.0 * outside:.3g} % of the values of {factor.key} lie outside its points, "
                f"at most {100.0 * MOST_OUTSIDE:g} % may"
            )
    return ""


def has_varied(own: Responses) -> int:
    """Number of factors with more than one value."""
    return int(np.count_nonzero(np.ptp(own.points, axis=0) > 0.0))
