"""Statistics and wear of a study of precision as rows of text, for CSV files."""

from presswear.trials.precision.chaos import Chaos
from presswear.trials.precision.wear import QUANTITIES, WearStudy

Rows = list[list[str]]
"""Of text, the names of the columns first."""


def _text(number: float | None) -> str:
    return "" if number is None else f"{number!r}"


def statistic_rows(chaos: Chaos) -> Rows:
    """A row for each method and statistic: its value, its error by the steps, its cost."""
    rows = [
        [
            "family",
            "knob",
            "value",
            "statistic",
            "mean",
            "half width",
            "step error",
            "step error low",
            "step error high",
            "step error bound",
            "wall per simulated second",
            "steps",
            "simulated (s)",
            "warm-up (s)",
            "failure",
        ]
    ]
    for point in chaos.points:
        own = [point.method.family, point.method.knob, _text(point.method.value)]
        cost = [_text(number) for number in (point.cost, point.steps, point.simulated)]
        rest = [*cost, _text(point.warm_up), point.failure]
        if not point.statistics:
            rows.append([*own, *[""] * 7, *rest])
        for name, statistic in point.statistics.items():
            error = point.step_errors.get(name)
            errors = (
                (error.value, error.low, error.high, error.bound)
                if error is not None
                else (None, None, None, None)
            )
            numbers = (statistic.mean, statistic.half_width, *errors)
            rows.append([*own, name, *map(_text, numbers), *rest])
    return rows


def wear_rows(wear: WearStudy) -> Rows:
    """A row for each case, wear, joint and quantity, with the ends of its interval."""
    rows = [
        [
            "varied",
            "conventions",
            "case",
            "value",
            "wear",
            "joint",
            "quantity",
            "mean",
            "low",
            "high",
            "steps",
            "cycles",
            "wall (s)",
            "failure",
        ]
    ]
    for point in wear.points:
        own = [str(point.group), point.conventions, point.label, _text(point.value)]
        rest = [str(point.steps), str(point.cycles), _text(point.wall), point.failure]
        if not point.first:
            rows.append([*own, *[""] * 6, *rest])
        for word, joints in (("first", point.first), ("second", point.second)):
            for joint, worn in joints.items():
                for name, (unit, pick) in QUANTITIES.items():
                    found = pick(worn)
                    numbers = map(_text, (found.value, found.low, found.high))
                    rows.append([*own, word, joint, f"{name} ({unit})", *numbers, *rest])
    return rows
