"""Diagrams, statistics and wear of a study of precision as rows of named cells, for CSV files."""

from collections.abc import Callable, Iterator
from typing import Any

from presswear.record.sampling import Interval
from presswear.trials.precision.chaos import Chaos
from presswear.trials.precision.diagram import Diagram, TaskPoint
from presswear.trials.precision.methods import Method
from presswear.trials.precision.statistic import StepError
from presswear.trials.precision.wear import QUANTITIES, WearStudy
from presswear.trials.timing import Timing

Cells = dict[str, Any]
"""Numbers and words by the names of their columns; None where there is none."""

_TIMES: dict[str, Callable[[TaskPoint, Timing], float | int | None]] = {
    "wall median (s)": lambda point, timing: timing.wall,
    "wall least (s)": lambda point, timing: timing.ends[0],
    "wall greatest (s)": lambda point, timing: timing.ends[1],
    "warm-up (s)": lambda point, timing: point.warm_up,
    "simulated (s)": lambda point, timing: timing.simulated,
    "steps": lambda point, timing: timing.steps,
    "sent back": lambda point, timing: timing.sent_back,
    "evaluations": lambda point, timing: timing.evaluations,
    "microseconds per step": lambda point, timing: 1e6 * timing.per_step,
}


def _of(method: Method) -> Cells:
    return {"family": method.family, "knob": method.knob, "value": method.value}


def diagram_rows(diagram: Diagram) -> Iterator[Cells]:
    """A row for each method: its errors, its cost, and what else was measured."""
    for point in diagram.points:
        method, timing = point.method, point.timing
        yield {
            **_of(method),
            **{own.error: point.errors.get(own.name) for own in diagram.quantities},
            **{name: timing and read(point, timing) for name, read in _TIMES.items()},
            **{name: point.values.get(name) for name in diagram.measured},
            "is_default": str(method.is_default).lower(),
            "is_paper": str(method.is_paper).lower(),
            "failure": point.failure,
        }


def statistic_rows(chaos: Chaos) -> Iterator[Cells]:
    """A row for each method and statistic: its value, its error by the steps, its cost."""
    for point in chaos.points:
        for name in point.statistics or ("",):
            found = point.statistics.get(name)
            error = point.step_errors.get(name, StepError(None, None, None, None))
            yield {
                **_of(point.method),
                "statistic": name,
                "mean": None if found is None else found.mean,
                "half width": None if found is None else found.half_width,
                "step error": error.value,
                "step error low": error.low,
                "step error high": error.high,
                "step error bound": error.bound,
                "wall per simulated second": point.cost,
                "steps": point.steps,
                "simulated (s)": point.simulated,
                "warm-up (s)": point.warm_up,
                "failure": point.failure,
            }


def wear_rows(wear: WearStudy) -> Iterator[Cells]:
    """A row for each case, wear, joint and quantity, with the ends of its interval."""
    for point in wear.points:
        varied = point.varied
        wears: list[tuple[str, str, str, Interval | None]] = [
            (word, joint, f"{name} ({unit})", worn[name])
            for word, joints in (("first", point.first), ("second", point.second))
            for joint, worn in joints.items()
            for name, unit in QUANTITIES.items()
        ]
        for word, joint, name, found in wears or [("", "", "", None)]:
            yield {
                "varied": varied.group,
                "conventions": varied.conventions,
                "case": varied.label,
                "value": varied.value,
                "wear": word,
                "joint": joint,
                "quantity": name,
                "mean": None if found is None else found.value,
                "low": None if found is None else found.low,
                "high": None if found is None else found.high,
                "steps": point.steps,
                "cycles": point.cycles,
                "wall (s)": point.wall,
                "failure": point.failure,
            }
