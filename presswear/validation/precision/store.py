"""A study of speed against error as files: one JSON of everything, a CSV for each table."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from presswear.recording.sampling import Interval
from presswear.tools.documents import read_json
from presswear.tools.errors import InputError
from presswear.tools.files import write_bytes
from presswear.validation.precision.chaos import Chaos
from presswear.validation.precision.diagram import Diagram
from presswear.validation.precision.methods import Method
from presswear.validation.precision.study import Precision
from presswear.validation.precision.wear import QUANTITIES, WearStudy
from presswear.validation.stored import restored, write_document

SCHEMA = 4
FILE = "precision.json"
Cells = dict[str, Any]
"""Numbers and words by the names of their columns; None where there is none."""


def store(precision: Precision, folder: Path) -> None:
    """Write ``precision.json`` and ``precision-KEY.csv`` into a folder, made where needed.

    KEY is that of a diagram, ``statistics`` or ``wear``.
    """
    write_document(folder, FILE, SCHEMA, precision)
    tables = {own.key: diagram_rows(own) for own in precision.diagrams}
    tables |= {"statistics": statistic_rows(precision.chaos), "wear": wear_rows(precision.wear)}
    for key, rows in tables.items():
        file, cells = io.StringIO(), list(rows)
        writer = csv.DictWriter(file, cells[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(cells)
        write_bytes(folder / f"precision-{key}.csv", file.getvalue().encode())


def load(folder: Path) -> Precision:
    """Read a stored study back; InputError says what is missing, altered or of another schema."""
    file = folder / FILE
    data = read_json(file, f"{folder} holds no study of precision: it has no {FILE}", SCHEMA)
    try:
        found: Precision = restored(Precision, data, "study")
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    if not (found.diagrams and found.chaos.points and found.wear.points):
        raise InputError(f"{file}: a part of the study is empty")
    return found


def _of(method: Method) -> Cells:
    return {"family": method.family, "knob": method.knob, "value": method.value}


def diagram_rows(diagram: Diagram) -> Iterator[Cells]:
    """A row for each method: its errors, its cost, and what else was measured."""
    for point in diagram.points:
        method, timing = point.method, point.timing
        least, greatest = timing.ends if timing else (None, None)
        yield {
            **_of(method),
            **{own.error: point.errors.get(own.name) for own in diagram.quantities},
            "wall median (s)": timing and timing.wall,
            "wall least (s)": least,
            "wall greatest (s)": greatest,
            "warm-up (s)": timing and point.warm_up,
            "simulated (s)": timing and timing.simulated,
            "steps": timing and timing.steps,
            "sent back": timing and timing.sent_back,
            "evaluations": timing and timing.evaluations,
            "microseconds per step": timing and 1e6 * timing.per_step,
            **{name: point.values.get(name) for name in diagram.measured},
            "is_default": str(method.is_default).lower(),
            "is_paper": str(method.is_paper).lower(),
            "failure": point.failure,
        }


def statistic_rows(chaos: Chaos) -> Iterator[Cells]:
    """A row for each method and statistic: its value, its error by the steps, its cost."""
    for point in chaos.points:
        for name in point.statistics or ("",):
            found, error = point.statistics.get(name), point.step_errors.get(name)
            yield {
                **_of(point.method),
                "statistic": name,
                "mean": found and found.mean,
                "half width": found and found.half_width,
                "step error": error and error.value,
                "step error low": error and error.low,
                "step error high": error and error.high,
                "step error bound": error and error.bound,
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
        wear_updates: list[tuple[str, str, str, Interval | None]] = [
            (word, joint, f"{name} ({unit})", worn[name])
            for word, joints in (("first", point.first), ("second", point.second))
            for joint, worn in joints.items()
            for name, unit in QUANTITIES.items()
            if name in worn
        ]
        for word, joint, name, found in wear_updates or [("", "", "", None)]:
            yield {
                "varied": varied.group,
                "conventions": varied.conventions,
                "case": varied.label,
                "value": varied.value,
                "wear": word,
                "joint": joint,
                "quantity": name,
                "mean": found and found.value,
                "low": found and found.low,
                "high": found and found.high,
                "steps": point.steps,
                "cycles": point.cycles,
                "wall (s)": point.wall,
                "failure": point.failure,
            }
