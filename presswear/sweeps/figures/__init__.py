"""The pictures of a sweep, each a drawing as those of a result."""

from presswear.sweeps.figures.bars import effects, shares, tornado
from presswear.sweeps.figures.curves import curves, sections
from presswear.sweeps.figures.maps import heat_map, parallel
from presswear.sweeps.figures.scatter import distribution

__all__ = [
    "curves",
    "distribution",
    "effects",
    "heat_map",
    "parallel",
    "sections",
    "shares",
    "tornado",
]
