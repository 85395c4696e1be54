"""Work-precision diagrams as tables of words, for a terminal."""

import math

from presswear.trials.costs.tables import TextTable
from presswear.trials.precision.diagram import Diagram, Quantity, TaskPoint
from presswear.trials.precision.methods import IMPACT, STEP, TOLERANCE
from presswear.trials.precision.study import Precision

SHOWN = {
    "slider position": "slider, m",
    "slider velocity": "m/s",
    "position constraints": "|Phi|",
    "angles": "angle, rad",
    "rates": "rad/s",
    "delivered restitution": "restit.",
    "contact time": "time, s",
    "deepest penetration": "depth, m",
    "touch times": "touches, s",
    "peak forces": "force",
    "energy residual / exchanged": "energy",
}
"""The quantities that a terminal has room for, and their headings."""
_SKIPPED = {"horizon": {"slider velocity"}}
_KNOBS = {STEP: "step", IMPACT: "steps/impact", TOLERANCE: "tol"}


def tables_of(precision: Precision) -> list[TextTable]:
    """A table for each diagram."""
    return [table_of(diagram) for diagram in precision.diagrams]


def table_of(diagram: Diagram) -> TextTable:
    """A diagram as a table: families one below the other, each from coarse to fine."""
    skipped = _SKIPPED.get(diagram.key, set())
    shown = [own for own in diagram.quantities if own.name in SHOWN and own.name not in skipped]
    rows: list[tuple[str, ...]] = []
    empty = ("",) * (len(shown) + 3)
    for family, points in diagram.families.items():
        rows.append((family + _order_words(diagram, family, shown[0]), *empty))
        rows += [_row(point, shown) for point in points]
    repeats = max((len(p.timing.walls) for p in diagram.points if p.timing), default=0)
    known = ", ".join(f"{SHOWN[own.name]} {own.known:.0e}" for own in shown if own.known > 0.0)
    return TextTable(
        diagram.title,
        ("method",),
        (*(SHOWN[own.name] for own in shown), "steps", "ms", "us/step"),
        tuple(rows),
        (
            diagram.task,
            f"Errors are from {diagram.reference}{f' ({known})' if known else ''}.",
            f"Times are medians of {repeats} interleaved repeats, without warm-up. * what scenes "
            "take by themselves; + the paper's setting.",
        ),
    )


def _order_words(diagram: Diagram, family: str, quantity: Quantity) -> str:
    """The observed order, where steps are what is varied."""
    if any(point.method.knob == TOLERANCE for point in diagram.families[family]):
        return ""
    order = diagram.order(family, quantity)
    return "" if math.isnan(order) else f": order {order:.1f}"


def _row(point: TaskPoint, shown: list[Quantity]) -> tuple[str, ...]:
    method, timing = point.method, point.timing
    mark = "*" * method.is_default + "+" * method.is_paper
    word = f"  {_KNOBS[method.knob]} {method.value:.3g} {mark}".rstrip()
    if point.failure or timing is None:
        return (f"{word}: {point.failure}", *("" for _ in shown), "", "", "failed")
    return (
        word,
        *(f"{point.errors[own.name]:.1e}" for own in shown),
        f"{timing.attempts}",
        _milliseconds(timing.wall),
        f"{1e6 * timing.per_step:.1f}",
    )


def _milliseconds(seconds: float) -> str:
    """Three digits, never a power of ten."""
    value = 1e3 * seconds
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"
