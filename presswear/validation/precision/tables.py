"""Tables of a study of speed against error, for its page and for a terminal.

Of those of the page each column has a name and what its cells show.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Literal, TypeVar

from presswear.show.report.parts import CUBIC_MILLIMETRES, MICRONS, Table
from presswear.tools.numbers import given, readable, whole, with_interval
from presswear.validation.costs.tables import TextTable
from presswear.validation.precision.chaos import Chaos, StatisticPoint
from presswear.validation.precision.diagram import Diagram, Quantity, TaskPoint
from presswear.validation.precision.figures.diagrams import shown_order
from presswear.validation.precision.growth import Parting
from presswear.validation.precision.methods import IMPACT, STEP, TOLERANCE
from presswear.validation.precision.recommendation import standing
from presswear.validation.precision.statistic import MAP, UNITS, sampling_error
from presswear.validation.precision.study import Precision
from presswear.validation.precision.wear import (
    DEEPEST,
    QUANTITIES,
    TITLES,
    WearPoint,
    Wears,
    WearStudy,
)
from presswear.validation.timing import Timing

T = TypeVar("T")

_PERCENT = 100.0
_NONE = "–"


def _table(
    groups: Mapping[str, Iterable[T]],
    columns: Mapping[str, Callable[[T], str]],
    numeric: bool = True,
) -> Table:
    """A table of items in groups by their headings; groups without any are left out."""
    filled = ((heading, list(items)) for heading, items in groups.items())
    rows = (
        (heading, tuple(tuple(read(item) for read in columns.values()) for item in items))
        for heading, items in filled
        if items
    )
    return Table(tuple(columns), tuple(rows), numeric)


def _marked(name: str, **marks: object) -> str:
    """A name with what holds besides, in brackets."""
    words = ", ".join(word for word, holds in marks.items() if holds)
    return f"{name} ({words})" if words else name


def _method(point: TaskPoint | StatisticPoint) -> str:
    """Step or tolerance of a point."""
    method = point.method
    name = f"{method.knob.partition(' (')[0]} {given(method.value)}"
    return _marked(name, default=method.is_default, paper=method.is_paper, failed=point.failure)


def error_text(value: float | None) -> str:
    """An error to two digits."""
    if value is None or not math.isfinite(value):
        return _NONE
    return given(float(f"{value:.1e}"))


def _spread(low: float, high: float, digits: int = 3) -> str:
    return f"{readable(low, digits)} to {readable(high, digits)}"


_COSTS: dict[str, Callable[[TaskPoint, Timing], str]] = {
    "steps": lambda point, timing: whole(timing.steps),
    "sent back": lambda point, timing: whole(timing.sent_back),
    "evaluations": lambda point, timing: whole(timing.evaluations),
    "median (ms)": lambda point, timing: readable(1e3 * timing.wall),
    "spread (ms)": lambda point, timing: _spread(1e3 * timing.ends[0], 1e3 * timing.ends[1]),
    "µs a step": lambda point, timing: readable(1e6 * timing.per_step),
    "warm-up (s)": lambda point, timing: readable(point.warm_up, 2),
}


def task_table(diagram: Diagram) -> Table:
    """Errors, other values and costs of every method on a task; families with their orders."""

    def error(quantity: Quantity, point: TaskPoint) -> str:
        return error_text(point.errors.get(quantity.name))

    def value(name: str, point: TaskPoint) -> str:
        return readable(point.values.get(name), 6)

    def cost(name: str, point: TaskPoint) -> str:
        return _NONE if point.timing is None else _COSTS[name](point, point.timing)

    groups = {}
    for family, points in diagram.families.items():
        orders = {own.name: shown_order(diagram, family, own) for own in diagram.quantities}
        known = [f"{name} {order:.1f}" for name, order in orders.items() if math.isfinite(order)]
        groups[f"{family}; observed orders: {', '.join(known)}" if known else family] = points
    return _table(
        groups,
        {
            "": _method,
            **{f"error: {own.title}": partial(error, own) for own in diagram.quantities},
            **{name: partial(value, name) for name in diagram.measured},
            **{name: partial(cost, name) for name in _COSTS},
        },
    )


_GROWTH: dict[str, Callable[[Parting], str]] = {
    "": lambda pair: "pair of starts",
    "growth rate, fitted (1/s)": lambda pair: readable(pair.rate),
    "the same a touch": lambda pair: readable(pair.per_touchdown, 2),
    "fitted over (s)": lambda pair: _spread(*pair.window) if pair.window else _NONE,
    "parted after (s)": lambda pair: readable(pair.divergence),
    "touches until then": lambda pair: whole(pair.touchdowns_to_divergence),
    "greatest distance (m)": lambda pair: error_text(max(pair.distance, default=None)),
}


def growth_table(chaos: Chaos) -> Table:
    """The pair of neighbouring starts."""
    return _table({"": [chaos.growth]}, _GROWTH)


def sampling_table(chaos: Chaos) -> Table:
    """The statistics as the finest method has them."""
    found = chaos.reference.statistics

    def title(name: str) -> str:
        kind = name.partition(" at ")[0]
        word = "root mean square of the map, " if kind == MAP else ""
        return f"{name} ({word}{UNITS[kind]} a cycle)"

    def of_stage(name: str) -> str:
        part = sampling_error(found[name], chaos.stage_cycles) / abs(found[name].mean)
        return f"{readable(_PERCENT * part, 2)} %"

    return _table(
        {"": found},
        {
            "": title,
            "mean": lambda name: with_interval(found[name].mean, found[name].half_width),
            "cycles": lambda name: whole(found[name].cycles),
            f"sampling error of {chaos.stage_cycles} cycles": of_stage,
        },
    )


def statistics_table(chaos: Chaos) -> Table:
    """Step error of every setting, and how many cycles it is honest for."""

    def cost(point: StatisticPoint) -> str:
        if not point.rates:
            return _NONE
        return f"{readable(point.cost, 2)} ({_spread(min(point.rates), max(point.rates), 2)})"

    def step_error(name: str, point: StatisticPoint) -> str:
        """Difference, its bound, and a star where it is seen."""
        step = point.step_errors.get(name)
        if step is None or step.bound is None or step.value is None:
            return _NONE
        mean = abs(chaos.reference.statistics[name].mean)
        value, bound = (_PERCENT * size / mean for size in (step.value, step.bound))
        sign = "" if name.startswith(MAP) else "+"
        text = f"{value:{sign}.1f} (≤ {bound:.1f}){' *' if step.is_seen else ''}"
        return text.replace("-", "−").replace(" ", "\u00a0")

    return _table(
        chaos.families,
        {
            "": _method,
            "s for a simulated second": cost,
            **{f"{name} (%)": partial(step_error, name) for name in chaos.names},
            "for wear": partial(standing, chaos),
        },
        numeric=False,
    )


def wear_table(wear: WearStudy) -> Table:
    """Wear of every case, and what it took."""

    def case(point: WearPoint) -> str:
        return _marked(point.varied.label, default=point.varied.is_default, failed=point.failure)

    def cell(which: Literal["first", "second"], name: str, joint: str, point: WearPoint) -> str:
        worn: Wears = getattr(point, which)
        if name not in worn.get(joint, {}):
            return _NONE
        interval, (factor, _) = worn[joint][name], units[QUANTITIES[name]]
        if interval.low is None or interval.high is None:
            return readable(factor * interval.value)
        spread = _spread(factor * interval.low, factor * interval.high, 2)
        return f"{readable(factor * interval.value)} ({spread})"

    units = {"m": (MICRONS, "µm"), "m^3": (CUBIC_MILLIMETRES, "mm³")}
    columns: dict[str, Callable[[WearPoint], str]] = {
        "": case,
        **{
            f"{name} at {joint} ({units[unit][1]})": partial(cell, "first", name, joint)
            for name, unit in QUANTITIES.items()
            for joint in wear.joints
        },
        **{
            f"second wear, deepest at {joint} (µm)": partial(cell, "second", DEEPEST, joint)
            for joint in wear.joints
        },
        "steps of the first wear": lambda point: whole(point.steps),
        "cycles run": lambda point: whole(point.cycles),
        "wall time (s)": lambda point: readable(point.wall, 2),
    }
    groups = {
        f"{title}, {name}": wear.of(group, name)
        for group, title in TITLES.items()
        for name in wear.conventions
    }
    return _table(groups, columns)


def _words(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Table:
    return Table(head, (("", tuple(rows)),), numeric=False)


def failures_table(precision: Precision) -> Table | None:
    """Everything that failed and why; None where nothing did."""
    points: list[tuple[str, TaskPoint | StatisticPoint]] = [
        (diagram.title, point) for diagram in precision.diagrams for point in diagram.points
    ]
    points += [("statistics", point) for point in precision.chaos.points]
    rows = [(task, point.method.label, point.failure) for task, point in points if point.failure]
    rows += [("wear", what, why) for what, why in precision.wear.failed.items()]
    return _words(("task", "method", "why"), rows) if rows else None


def references_table(diagrams: Sequence[Diagram]) -> Table:
    """References of the tasks, and how well they are known."""

    def known(diagram: Diagram) -> str:
        errors = (
            f"{own.name} {error_text(own.known)} {own.unit}".rstrip()
            for own in diagram.quantities
            if own.known > 0.0
        )
        return "; ".join(errors) or "exact"

    rows = ((diagram.title, diagram.reference, known(diagram)) for diagram in diagrams)
    return _words(("task", "reference", "its own error"), rows)


def origin_table(precision: Precision) -> Table:
    """Versions, processor, times."""
    origin = precision.provenance
    packages = ", ".join(f"{name} {number}" for name, number in origin["packages"].items())
    repeats = {len(p.timing.walls) for d in precision.diagrams for p in d.points if p.timing}
    rows = (
        ("processor", precision.processor),
        ("machine", origin["machine"]),
        ("packages", packages),
        ("Python", origin["python"]),
        ("source revision", origin["revision"]),
        ("started", origin["started"]),
        ("interleaved repeats of each timing", ", ".join(map(str, sorted(repeats))) or _NONE),
        ("extent", "quick" if precision.extent.quick else "full"),
        ("wall time of the study", f"{readable(precision.wall)} s"),
    )
    return _words(("", ""), rows)


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


def terminal_tables(precision: Precision) -> list[TextTable]:
    """A table for each diagram: families one below the other, each from coarse to fine."""
    return [_terminal_table(diagram) for diagram in precision.diagrams]


def _terminal_table(diagram: Diagram) -> TextTable:
    skipped = _SKIPPED.get(diagram.key, set())
    shown = [own for own in diagram.quantities if own.name in SHOWN and own.name not in skipped]
    rows: list[tuple[str, ...]] = []
    for family, points in diagram.families.items():
        # An order is told where steps are what is varied.
        order = diagram.order(family, shown[0])
        told = not any(own.method.knob == TOLERANCE for own in points) and not math.isnan(order)
        heading = f"{family}: order {order:.1f}" if told else family
        rows += [(heading, *[""] * (len(shown) + 3)), *(_terminal_row(p, shown) for p in points)]
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


def _terminal_row(point: TaskPoint, shown: list[Quantity]) -> tuple[str, ...]:
    method, timing = point.method, point.timing
    mark = "*" * method.is_default + "+" * method.is_paper
    word = f"  {_KNOBS[method.knob]} {method.value:.3g} {mark}".rstrip()
    if point.failure or timing is None:
        return (f"{word}: {point.failure}", *("" for _ in shown), "", "", "failed")
    milliseconds = 1e3 * timing.wall
    return (
        word,
        *(f"{point.errors[own.name]:.1e}" for own in shown),
        f"{timing.attempts}",
        # Three digits, never a power of ten.
        f"{milliseconds:.0f}" if milliseconds >= 100.0 else f"{milliseconds:.3g}",
        f"{1e6 * timing.per_step:.1f}",
    )
