"""Pictures of a study of speed against error."""

from collections.abc import Callable, Iterator
from functools import partial

import matplotlib

from presswear.show.figures.style import SETTINGS, Drawing
from presswear.validation.precision.figures.chaos import (
    growth_of_disturbance,
    statistics_against_cost,
)
from presswear.validation.precision.figures.diagrams import energy, orders, work_precision
from presswear.validation.precision.figures.wear import contact_models, wear_convergence
from presswear.validation.precision.study import Precision

__all__ = ["precision_drawings"]


def precision_drawings(precision: Precision) -> Iterator[Drawing]:
    """Draw whatever the study has, in the order of the report."""
    diagrams, chaos, wear = precision.diagrams, precision.chaos, precision.wear
    draw: list[Callable[[], Drawing | None]] = [
        *(partial(work_precision, diagram) for diagram in diagrams),
        *(partial(draw, diagrams) for draw in (orders, energy)),
        *(partial(draw, chaos) for draw in (growth_of_disturbance, statistics_against_cost)),
        *(partial(draw, wear) for draw in (wear_convergence, contact_models)),
    ]
    for drawer in draw:
        with matplotlib.rc_context(SETTINGS):
            drawing = drawer()
        if drawing is not None:
            yield drawing
