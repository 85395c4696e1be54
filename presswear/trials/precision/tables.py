"""Tables of a study of speed against error."""

import math
from collections.abc import Callable, Sequence

from presswear.show.report.parts import CUBIC_MILLIMETRES, MICRONS, Row, Table
from presswear.tools.numbers import given, readable, whole, with_interval
from presswear.trials.precision.chaos import Chaos
from presswear.trials.precision.diagram import Diagram, Point
from presswear.trials.precision.figures.diagrams import shown_order
from presswear.trials.precision.methods import Method
from presswear.trials.precision.recommendation import standing
from presswear.trials.precision.statistic import MAP, StepError, unit_of
from presswear.trials.precision.study import Precision
from presswear.trials.precision.wear import QUANTITIES, TITLES, JointWear, WearPoint, WearStudy

_PERCENT = 100.0


def error_text(value: float | None) -> str:
    """An error to two digits."""
    if value is None or not math.isfinite(value):
        return "–"
    return given(float(f"{value:.1e}"))


def _marked(method: Method) -> str:
    """Step or tolerance with what it is besides."""
    marks = (("default", method.is_default), ("paper", method.is_paper))
    words = ", ".join(word for word, holds in marks if holds)
    name = f"{method.knob.partition(' (')[0]} {given(method.value)}"
    return f"{name} ({words})" if words else name


_COSTS = (
    "steps",
    "sent back",
    "evaluations",
    "median (ms)",
    "spread (ms)",
    "µs a step",
    "warm-up (s)",
)


def error_table(diagram: Diagram) -> Table:
    """Errors of every method on a task, and what else was measured; families with their orders."""
    titles = (quantity.title for quantity in diagram.quantities)
    groups = []
    for family, points in diagram.families.items():
        orders = {own.name: shown_order(diagram, family, own) for own in diagram.quantities}
        known = [f"{name} {order:.1f}" for name, order in orders.items() if math.isfinite(order)]
        heading = f"{family}; observed orders: {', '.join(known)}" if known else family
        rows = tuple(
            _of_run(
                point,
                (
                    *(error_text(point.errors.get(own.name)) for own in diagram.quantities),
                    *(readable(point.values.get(name), 6) for name in diagram.measured),
                ),
            )
            for point in points
        )
        groups.append((heading, rows))
    return Table(("error", *titles, *diagram.measured), tuple(groups))


def cost_table(diagram: Diagram) -> Table:
    """Steps and times of every method on a task."""
    groups = (
        (family, tuple(_of_run(point, _costs(point)) for point in points))
        for family, points in diagram.families.items()
    )
    return Table(("cost", *_COSTS), tuple(groups))


def _of_run(point: Point, cells: Row) -> Row:
    """A row of a method; one that failed has no numbers."""
    if point.failure:
        cells = ("failed", *("–" for _ in cells[1:]))
    return (_marked(point.method), *cells)


def _costs(point: Point) -> Row:
    timing = point.timing
    if timing is None:
        return ("–",) * len(_COSTS)
    low, high = (1e3 * end for end in timing.ends)
    return (
        whole(timing.steps),
        whole(timing.sent_back),
        whole(timing.evaluations),
        readable(1e3 * timing.wall),
        f"{readable(low)} to {readable(high)}",
        readable(1e6 * timing.per_step),
        readable(point.warm_up, 2),
    )


def growth_table(chaos: Chaos) -> Table:
    """Each pair of neighbouring starts."""
    rows = tuple(
        (
            f"pair {number}",
            readable(growth.rate),
            readable(growth.per_touch, 2),
            readable(growth.overall),
            "–" if growth.window is None else " to ".join(readable(t) for t in growth.window),
            readable(growth.divergence),
            whole(growth.touches_to_divergence),
            error_text(max(growth.distance, default=math.nan)),
        )
        for number, growth in enumerate(chaos.growths, 1)
    )
    head = (
        "",
        "growth rate, fitted (1/s)",
        "the same a touch",
        "growth rate, lulls included (1/s)",
        "fitted over (s)",
        "parted after (s)",
        "touches until then",
        "greatest distance (m)",
    )
    return Table(head, (("", rows),))


def sampling_table(chaos: Chaos) -> Table:
    """The statistics as the finest method has them."""
    rows = []
    for name, found in chaos.reference.statistics.items():
        kind = "root mean square of the map, " if name.startswith(MAP) else ""
        of_stage = found.sampling_error(chaos.stage_cycles) / abs(found.mean)
        rows.append(
            (
                f"{name} ({kind}{unit_of(name)} a cycle)",
                with_interval(found.mean, found.half_width),
                whole(found.cycles),
                f"{readable(_PERCENT * of_stage, 2)} %",
            )
        )
    head = ("", "mean", "cycles", f"sampling error of {chaos.stage_cycles} cycles")
    return Table(head, (("", tuple(rows)),))


def statistics_table(chaos: Chaos) -> Table:
    """Step error of every setting, and how many cycles it is honest for."""
    groups = []
    for family, points in chaos.families.items():
        rows: list[Row] = []
        for point in points:
            if point.failure:
                cells = ("failed", *("–" for _ in chaos.names), "")
            else:
                cost, low, high = (
                    readable(rate, 2) for rate in (point.cost, min(point.rates), max(point.rates))
                )
                cells = (
                    f"{cost} ({low} to {high})",
                    *(_step_error(chaos, point.step_errors[name], name) for name in chaos.names),
                    standing(chaos, point),
                )
            rows.append((_marked(point.method), *cells))
        groups.append((family, tuple(rows)))
    head = (
        "",
        "s for a simulated second",
        *(f"{name} (%)" for name in chaos.names),
        "for wear",
    )
    return Table(head, tuple(groups), numeric=False)


def _step_error(chaos: Chaos, step: StepError, name: str) -> str:
    """Difference, its bound, and a star where it is seen."""
    if step.bound is None or step.value is None:
        return "–"
    mean = abs(chaos.reference.statistics[name].mean)
    value, bound = (_PERCENT * size / mean for size in (step.value, step.bound))
    sign = "" if name.startswith(MAP) else "+"
    text = f"{value:{sign}.1f} (≤ {bound:.1f}){' *' if step.is_seen else ''}"
    return text.replace("-", "−").replace(" ", "\u00a0")


def wear_table(wear: WearStudy) -> Table:
    """Wear of every case."""
    joints = wear.joints
    factors = {"m": "µm", "m^3": "mm³"}
    columns = [(name, joint) for name in QUANTITIES for joint in joints]
    head = [f"{name} at {joint} ({factors[QUANTITIES[name][0]]})" for name, joint in columns]
    second = [f"second wear, deepest at {joint} (µm)" for joint in joints]

    def row(point: WearPoint) -> Row:
        cells = [_wear_cell(point.first.get(joint), name) for name, joint in columns]
        cells += [_wear_cell(point.second.get(joint), "deepest wear") for joint in joints]
        if point.failure:
            cells[0] = f"failed; {cells[0]}" if cells[0] != "–" else "failed"
        return (_wear_label(point), *cells)

    return Table(("wear", *head, *second), _wear_groups(wear, row))


def wear_cost_table(wear: WearStudy) -> Table:
    """What every case of wear took."""

    def row(point: WearPoint) -> Row:
        numbers = (whole(point.steps), whole(point.cycles), readable(point.wall, 2))
        return (_wear_label(point), *numbers)

    head = ("cost", "steps of the first wear", "cycles run", "wall time (s)")
    return Table(head, _wear_groups(wear, row))


def _wear_groups(
    wear: WearStudy, row: Callable[[WearPoint], Row]
) -> tuple[tuple[str, tuple[Row, ...]], ...]:
    found = (
        (f"{title}, {name}", tuple(map(row, wear.of(group, name))))
        for group, title in TITLES.items()
        for name in wear.conventions
    )
    return tuple((heading, rows) for heading, rows in found if rows)


def _wear_label(point: WearPoint) -> str:
    return f"{point.varied.label} (default)" if point.varied.is_default else point.varied.label


def _wear_cell(found: JointWear | None, name: str) -> str:
    if found is None:
        return "–"
    unit, read = QUANTITIES[name]
    factor = MICRONS if unit == "m" else CUBIC_MILLIMETRES
    interval = read(found)
    if interval.low is None or interval.high is None:
        return readable(factor * interval.value)
    low, high = (readable(factor * end, 2) for end in (interval.low, interval.high))
    return f"{readable(factor * interval.value)} ({low} to {high})"


def failures_table(precision: Precision) -> Table | None:
    """Everything that failed and why; None where nothing did."""
    rows: list[Row] = [
        (diagram.title, point.method.label, point.failure)
        for diagram in precision.diagrams
        for point in diagram.points
        if point.failure
    ]
    if precision.chaos is not None:
        rows += [
            ("statistics", point.method.label, point.failure)
            for point in precision.chaos.points
            if point.failure
        ]
    if precision.wear is not None:
        rows += [("wear", what, why) for what, why in precision.wear.failed.items()]
    return Table(("task", "method", "why"), (("", tuple(rows)),), numeric=False) if rows else None


def references_table(diagrams: Sequence[Diagram]) -> Table:
    """References of the tasks, and how well they are known."""
    rows = tuple(
        (
            diagram.title,
            diagram.reference,
            "; ".join(
                f"{own.name} {error_text(own.known)} {own.unit}".rstrip()
                for own in diagram.quantities
                if own.known > 0.0
            )
            or "exact",
        )
        for diagram in diagrams
    )
    return Table(("task", "reference", "its own error"), (("", rows),), numeric=False)


def origin_table(precision: Precision) -> Table:
    """Versions, processor, times."""
    origin = precision.provenance
    packages = ", ".join(f"{name} {number}" for name, number in origin["packages"].items())
    repeats = {len(p.timing.walls) for d in precision.diagrams for p in d.points if p.timing}
    rows = (
        ("processor", precision.processor),
        ("machine", str(origin["machine"])),
        ("packages", packages),
        ("Python", str(origin["python"])),
        ("source revision", str(origin["revision"])),
        ("started", str(origin["started"])),
        ("interleaved repeats of each timing", ", ".join(map(str, sorted(repeats))) or "–"),
        ("extent", "quick" if precision.extent.quick else "full"),
        ("wall time of the study", f"{readable(precision.wall)} s"),
    )
    return Table(("", ""), (("", rows),), numeric=False)
