"""Pictures of a study of speed against error."""

from collections.abc import Callable, Iterator
from functools import partial

import matplotlib

from presswear.show.figures.style import SETTINGS, Drawing
from presswear.trials.precision.figures.chaos import (
    growth_of_disturbance,
    statistics_against_cost,
)
from presswear.trials.precision.figures.diagrams import energy, orders, work_precision
from presswear.trials.precision.figures.wear import contact_models, wear_convergence
from presswear.trials.precision.study import Precision

__all__ = ["precision_drawings"]


def precision_drawings(precision: Precision) -> Iterator[Drawing]:
    """Draw whatever the study has, in the order of the report."""
    diagrams, chaos, wear = precision.diagrams, precision.chaos, precision.wear
    draw: list[Callable[[], Drawing | None]] = [partial(work_precision, own) for own in diagrams]
    if diagrams:
        draw += [partial(orders, diagrams), partial(energy, diagrams)]
    if chaos is not None:
        draw += [partial(growth_of_disturbance, chaos), partial(statistics_against_cost, chaos)]
    if wear is not None:
        draw += [partial(wear_convergence, wear), partial(contact_models, wear)]
    for drawer in draw:
        with matplotlib.rc_context(SETTINGS):
            drawing = drawer()
        if drawing is not None:
            yield drawing
