"""Work-precision diagrams as tables of words, for a terminal."""

import math

from presswear.trials.costs.text import TextTable
from presswear.trials.precision.methods import IMPACT, STEP, TOLERANCE
from presswear.trials.precision.points import Diagram, Point
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
    names = [name for name in diagram.quantities if name in SHOWN and name not in skipped]
    rows: list[tuple[str, ...]] = []
    empty = ("",) * (len(names) + 3)
    for family, points in diagram.families().items():
        rows.append((family + _order_words(diagram, family, names[0]), *empty))
        rows += [_row(point, names) for point in points]
    repeats = max((len(p.effort.walls) for p in diagram.points if p.effort), default=0)
    known = ", ".join(
        f"{SHOWN[name]} {diagram.reference_errors[name]:.0e}"
        for name in names
        if diagram.reference_errors.get(name, 0.0) > 0.0
    )
    return TextTable(
        diagram.title,
        ("method",),
        (*(SHOWN[name] for name in names), "steps", "ms", "us/step"),
        tuple(rows),
        (
            diagram.task,
            f"Errors are from {diagram.reference}{f' ({known})' if known else ''}.",
            f"Times are medians of {repeats} interleaved repeats, without warm-up. * what scenes "
            "take by themselves; + the paper's setting.",
        ),
    )


def _order_words(diagram: Diagram, family: str, name: str) -> str:
    """The observed order, where steps are what is varied."""
    points = diagram.families()[family]
    order = math.nan
    if all(point.method.knob != TOLERANCE for point in points):
        order = diagram.order(family, name)
    return "" if math.isnan(order) else f": order {order:.1f}"


def _row(point: Point, names: list[str]) -> tuple[str, ...]:
    method, effort = point.method, point.effort
    mark = "*" * method.is_default + "+" * method.is_paper
    word = f"  {_KNOBS[method.knob]} {method.value:.3g} {mark}".rstrip()
    if point.failure or effort is None:
        return (f"{word}: {point.failure}", *("" for _ in names), "", "", "failed")
    return (
        word,
        *(f"{point.errors[name]:.1e}" for name in names),
        f"{effort.steps + effort.sent_back}",
        _milliseconds(effort.wall),
        f"{1e6 * effort.per_step:.1f}",
    )


def _milliseconds(seconds: float) -> str:
    """Three digits, never a power of ten."""
    value = 1e3 * seconds
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"
