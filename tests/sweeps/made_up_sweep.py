"""Tables of functions with known sensitivity."""

import numpy as np
from numpy.typing import NDArray

from presswear.sweeps.parameters import Column
from presswear.sweeps.plan import Table
from presswear.tools.arrays import Array

# Ishigami and Homma (1990) with a = 7 and b = 0.1.
ISHIGAMI_FIRST = (0.3139, 0.4424, 0.0)
ISHIGAMI_TOTAL = (0.5576, 0.4424, 0.2437)
ISHIGAMI_VARIANCE = 7.0**2 / 8.0 + 0.1 * np.pi**4 / 5.0 + 0.1**2 * np.pi**8 / 18.0 + 0.5


def ishigami(cube: Array) -> Array:
    x, y, z = np.pi * (2.0 * cube.T - 1.0)
    return np.asarray(np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x))


def table_of(
    points: Array,
    values: Array,
    replicates: int = 1,
    noise: float = 0.0,
    seed: int = 0,
    half_widths: float = np.nan,
    censored: NDArray[np.bool_] | None = None,
) -> Table:
    """Return the table of one response at points, with replicates and normal noise."""
    count = len(points) * replicates
    random = np.random.default_rng(seed)
    rows = np.repeat(values, replicates) + noise * random.standard_normal(count)
    bounds = np.zeros(len(points), bool) if censored is None else censored
    names = range(1, points.shape[1] + 1)
    columns = tuple(Column(f"x{k}", "m", f"parameter {k}") for k in names)
    halves = np.full((count, 1), half_widths)
    censored = np.repeat(bounds, replicates)[:, None]
    response = Column("y", "N", "response")
    points = np.repeat(points, replicates, axis=0)
    errors = ("",) * count
    return Table(
        columns,
        (response,),
        points,
        rows[:, None],
        halves,
        censored,
        errors,
        replicates,
    )
