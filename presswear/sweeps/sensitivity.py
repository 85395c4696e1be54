"""Sensitivity of a response to the parameters of a sweep, and its chaotic variance.

Replicates of a chaotic motion differ, which adds a variance that no parameter explains.
It lowers first-order indices and raises total indices. If replicates or the intervals of
the runs determine it, it is subtracted.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.sweeps.parameters import MORRIS_LEVELS
from presswear.sweeps.response_distribution import ENDS
from presswear.sweeps.response_points import Points
from presswear.tools.arrays import Array
from presswear.tools.errors import not_installed

# Saltelli blocks or Morris trajectories below which nothing is estimated
MIN_BLOCKS = 8
# Smallest share of all parameters in the variance; smaller indices are errors
MIN_SHARE = 0.1
MIN_POINTS = 64  # points of a sample below which first-order indices are not estimated
RESAMPLES = 200  # bootstrap resamples of SALib
# Harmonics of RBD-FAST; more resolve faster variations, with more noise
RBD_HARMONICS = 6


@dataclass(frozen=True)
class Sensitivity:
    """Sensitivity of a response to each of d parameters."""

    title: str
    method: str
    names: tuple[str, ...]  # names of the measures, such as first-order and total index
    values: Array  # shape (measures, d)
    half_widths: Array  # shape (measures, d), of the 95 % intervals; NaN if unknown
    # shares of the variance; otherwise in the unit of the response
    is_share: bool = False
    # value that chaos alone would give; NaN if unknown or subtracted
    noise: float = math.nan

    @property
    def order(self) -> list[int]:
        """Indices of the parameters, the most important first."""
        strength = self.values[-1] if self.is_share else np.abs(self.values).max(0)
        order = np.argsort(-np.nan_to_num(strength), kind="stable")
        return [int(k) for k in order]


def sensitivity(points: Points, kind: str) -> Sensitivity | None:
    """Return the sensitivity of a design; None if it has none or too few points.

    ``saltelli``: first-order and total Sobol' indices (`SALib.analyze.sobol`).
    ``sobol`` and ``latin``: first-order indices (`SALib.analyze.rbd_fast`). ``morris``:
    elementary effects of a jump by half of the range (`SALib.analyze.morris`). ``oat``:
    changes from the middle point. `InputError` if SALib is not installed.
    """
    if points.is_constant or not kind:
        return None
    if kind == "oat":
        return _changes(points)
    try:
        import SALib  # noqa: F401
    except ImportError:
        raise not_installed("sensitivity analysis", "SALib") from None
    # A block or trajectory with a missing value is omitted.
    dimension = len(points.parameters)
    size = {"saltelli": dimension + 2, "morris": dimension + 1}.get(kind, 1)
    blocks = np.arange(len(points.means)).reshape(-1, size)
    blocks = blocks[points.has_value[blocks].all(axis=1)]
    least = MIN_POINTS if size == 1 else MIN_BLOCKS
    if len(blocks) < least:
        return None
    if kind == "morris":
        return _elementary_effects(points, blocks.ravel())
    return _indices(points, blocks, kind)


def _problem_of(points: Points) -> dict[str, Any]:
    """Return the parameters for SALib, as coordinates from 0 to 1."""
    names = [column.key for column in points.parameters]
    return {
        "num_vars": len(names),
        "names": names,
        "bounds": [[0.0, 1.0]] * len(names),
    }


def _elementary_effects(points: Points, rows: NDArray[np.int64]) -> Sensitivity:
    """Return the elementary effects of some rows of a Morris design."""
    from SALib.analyze import morris

    effects = morris.analyze(
        _problem_of(points),
        points.points[rows],
        points.means[rows],
        num_levels=MORRIS_LEVELS,
        num_resamples=RESAMPLES,
        seed=1,
    )
    # SALib divides by the jump between its own levels, which lie at the ends of the
    # range.
    jump = MORRIS_LEVELS / (2.0 * (MORRIS_LEVELS - 1.0))
    unknown = np.full(len(points.parameters), np.nan)
    variance = float(points.noise[rows].mean())
    noise = math.nan
    if variance > 0.0:
        # Mean of the absolute difference of two normal values with this variance
        noise = math.sqrt(4.0 / math.pi * variance)
    return Sensitivity(
        title="Elementary effects of a jump by half of the range",
        method="Morris 1991; Campolongo, Cariboni and Saltelli 2007",
        names=("mean of the absolute effects", "standard deviation of the effects"),
        values=jump * np.array([effects["mu_star"], effects["sigma"]], float),
        half_widths=jump * np.array([effects["mu_star_conf"], unknown], float),
        noise=noise,
    )


def _indices(
    points: Points, blocks: NDArray[np.int64], kind: str
) -> Sensitivity | None:
    """Return Sobol' indices; None if chaos has nearly all of the variance."""
    from SALib.analyze import rbd_fast, sobol

    problem = _problem_of(points)
    options: dict[str, Any] = {"num_resamples": RESAMPLES, "seed": 1}
    rows = blocks.ravel()
    values = points.means[rows]
    if kind == "saltelli":
        indices = sobol.analyze(problem, values, calc_second_order=False, **options)
        method = "Saltelli et al. 2010; total indices after Jansen 1999"
        keys = ["S1", "ST"]
        # The variance is that of the two independent samples of each block.
        values = points.means[blocks[:, [0, -1]]]
    else:
        indices = rbd_fast.analyze(
            problem, points.points[rows], values, M=RBD_HARMONICS, **options
        )
        method = "RBD-FAST: Tarantola et al. 2006; Tissot and Prieur 2012"
        keys = ["S1"]
    noise = float(points.noise[rows].mean())
    variance = float(values.var())
    if variance - noise < MIN_SHARE * variance:
        return None
    # Chaos adds its variance to the denominator, and to the numerator of total indices.
    scale = variance / (variance - noise)
    shares = scale * np.array([indices[key] for key in keys], float)
    widths = scale * np.array([indices[f"{key}_conf"] for key in keys], float)
    shares[1:] -= noise / (variance - noise)
    names = ("first-order index", "total index")[: len(keys)]
    return Sensitivity("Sobol' indices", method, names, shares, widths, is_share=True)


def _changes(points: Points) -> Sensitivity | None:
    """Return the changes of a one-at-a-time design; None if its middle point has no value."""
    if not points.has_value[0]:
        return None
    # In the rows the changes at the lowest and at the highest value of a parameter
    values = np.full((2, len(points.parameters)), np.nan)
    variances = np.full_like(values, np.nan)
    for k, column in enumerate(points.points.T):
        rows = np.flatnonzero((column != column[0]) & points.has_value)
        for side, pick in enumerate((np.argmin, np.argmax)):
            if rows.size:
                row = rows[pick(column[rows])]
                values[side, k] = points.means[row] - points.means[0]
                variances[side, k] = points.noise[row] + points.noise[0]
    half_widths = points.quantile * np.sqrt(variances)
    names = ("change at the lowest value", "change at the highest value")
    return Sensitivity(
        title="One parameter at a time",
        method="change from the middle",
        names=names,
        values=values,
        half_widths=half_widths,
    )


def chaotic_share(points: Points) -> tuple[float, float, float] | None:
    """Return the share of the variance of single runs that is chaos, with its 95 % interval.

    One-way analysis of variance with random effects (Searle, Casella and McCulloch,
    Variance Components, chapter 3). The interval follows from the ratio F and is exact
    for normal points and runs. None without replicates.
    """
    from scipy import stats  # slow to import

    rows = points.has_value
    count = int(rows.sum())
    within = float(points.variances.mean())
    if not 0.0 < points.freedom < math.inf or count < 3 or within == 0.0:
        return None
    counts = points.counts[rows]
    means = points.means[rows]
    total = counts.sum()
    size = (total - (counts**2).sum() / total) / (count - 1.0)
    mean = (counts * means).sum() / total
    between = (counts * (means - mean) ** 2).sum() / (count - 1.0)
    quantiles = stats.f(count - 1, points.freedom).ppf(ENDS)
    ratios = between / within / np.append(1.0, quantiles)
    value, low, high = size / (size + np.maximum(ratios - 1.0, 0.0))
    return float(value), float(min(low, high)), float(max(low, high))
