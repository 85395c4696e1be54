"""Pictures of a study of speed against error."""

from collections.abc import Callable, Iterator
from functools import partial

import matplotlib

from presswear.show.figures.style import SETTINGS, Drawing
from presswear.trials.precision.figures.diagrams import energy, orders, work_precision
from presswear.trials.precision.figures.growth import growth_of_disturbance
from presswear.trials.precision.figures.statistics import statistics_against_cost
from presswear.trials.precision.figures.wear import contact_models, wear_convergence
from presswear.trials.precision.study import Precision

__all__ = ["precision_drawings"]


def precision_drawings(precision: Precision) -> Iterator[Drawing]:
    """Draw whatever the study has, in the order of the report."""
    for draw in _drawers(precision):
        with matplotlib.rc_context(SETTINGS):
            drawing = draw()
        if drawing is not None:
            yield drawing


def _drawers(precision: Precision) -> Iterator[Callable[[], Drawing | None]]:
    diagrams, chaos, wear = precision.diagrams, precision.chaos, precision.wear
    for diagram in diagrams:
        yield partial(work_precision, diagram)
    if diagrams:
        yield partial(orders, diagrams)
        yield partial(energy, diagrams)
    if chaos is not None:
        yield partial(growth_of_disturbance, chaos)
        yield partial(statistics_against_cost, chaos)
    if wear is not None:
        yield partial(wear_convergence, wear)
        yield partial(contact_models, wear)
