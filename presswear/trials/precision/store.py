"""A study of speed against error as files: one JSON of everything, a CSV for each table."""

import csv
import io
import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from presswear.results.provenance import Provenance
from presswear.results.result import plain
from presswear.scene.scene import Scene
from presswear.tools.documents import read_json, schema_of, typed
from presswear.tools.errors import InputError
from presswear.tools.files import write_bytes
from presswear.tools.typed import misfits
from presswear.trials.precision.chaos import Chaos
from presswear.trials.precision.extent import Extent
from presswear.trials.precision.ladder import method_as_dict, method_from_dict
from presswear.trials.precision.points import Diagram, Effort, Point
from presswear.trials.precision.sheets import statistic_rows, wear_rows
from presswear.trials.precision.study import Precision
from presswear.trials.precision.wear import WearStudy

SCHEMA = 1
FILE = "precision.json"


def _point(point: Point) -> dict[str, Any]:
    effort = point.effort
    return {
        "method": method_as_dict(point.method),
        "family": point.method.family,
        "errors": dict(point.errors),
        "values": dict(point.values),
        "failure": point.failure,
        "effort": None if effort is None else asdict(effort),
        "wall_median_s": None if effort is None else effort.wall,
        "wall_per_step_s": None if effort is None else effort.per_step,
    }


def _stored_point(data: Mapping[str, Any]) -> Point:
    effort = data["effort"]
    if effort is not None:
        effort = Effort(**{**effort, "walls": tuple(effort["walls"])})
    return Point(
        method_from_dict(data["method"]), data["errors"], effort, data["failure"], data["values"]
    )


def _diagram(diagram: Diagram) -> dict[str, Any]:
    return {
        "key": diagram.key,
        "title": diagram.title,
        "task": diagram.task,
        "quantities": dict(diagram.quantities),
        "reference": diagram.reference,
        "reference_errors": dict(diagram.reference_errors),
        "orders": {
            family: {name: diagram.order(family, name) for name in diagram.quantities}
            for family in diagram.families()
        },
        "points": [_point(point) for point in diagram.points],
    }


def _stored_diagram(data: Mapping[str, Any]) -> Diagram:
    points = tuple(_stored_point(point) for point in data["points"])
    names = ("key", "title", "task", "quantities", "reference", "reference_errors")
    return Diagram(**{name: data[name] for name in names}, points=points)


def document_of(precision: Precision) -> dict[str, Any]:
    """The study as plain data: every error and wall time, and what follows from them."""
    return {
        "schema": SCHEMA,
        "scene": precision.scene.as_dict(),
        "extent": asdict(precision.extent),
        "provenance": dict(precision.provenance),
        "processor": precision.processor,
        "wall_s": precision.wall,
        "horizon_s": precision.horizon,
        "diagrams": [_diagram(diagram) for diagram in precision.diagrams],
        "chaos": None if precision.chaos is None else precision.chaos.as_dict(),
        "wear": None if precision.wear is None else precision.wear.as_dict(),
    }


def table_of(diagram: Diagram) -> list[list[str]]:
    """A diagram as rows of text, the names of the columns first; empty where nothing is known."""
    measured = list(dict.fromkeys(name for point in diagram.points for name in point.values))
    header = [
        "family",
        "knob",
        "value",
        *(
            f"{name} error{f' ({unit})' if unit else ''}"
            for name, unit in diagram.quantities.items()
        ),
        "wall median (s)",
        "wall least (s)",
        "wall greatest (s)",
        "warm-up (s)",
        "simulated (s)",
        "steps",
        "sent back",
        "evaluations",
        "microseconds per step",
        *measured,
        "is_default",
        "is_paper",
        "failure",
    ]
    rows = [header]
    for point in diagram.points:
        method, effort = point.method, point.effort
        costs: list[float | int | None] = [None] * 9
        if effort is not None:
            costs = [
                effort.wall,
                *effort.spread,
                effort.warm_up,
                effort.simulated,
                effort.steps,
                effort.sent_back,
                effort.evaluations,
                1e6 * effort.per_step,
            ]
        numbers = [
            method.value,
            *(point.errors.get(name) for name in diagram.quantities),
            *costs,
            *(point.values.get(name) for name in measured),
        ]
        rows.append(
            [
                method.family,
                method.knob,
                *("" if number is None else f"{number!r}" for number in numbers),
                str(method.is_default).lower(),
                str(method.is_paper).lower(),
                point.failure,
            ]
        )
    return rows


def store(precision: Precision, folder: Path) -> None:
    """Write ``precision.json`` and ``precision-KEY.csv`` into a folder, made where needed.

    KEY is that of a diagram, ``statistics`` or ``wear``.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(plain(document_of(precision)), indent=1, allow_nan=False)
    write_bytes(folder / FILE, text.encode())
    tables = {diagram.key: table_of(diagram) for diagram in precision.diagrams}
    if precision.chaos is not None:
        tables["statistics"] = statistic_rows(precision.chaos)
    if precision.wear is not None:
        tables["wear"] = wear_rows(precision.wear)
    for key, rows in tables.items():
        file = io.StringIO()
        csv.writer(file, lineterminator="\n").writerows(rows)
        write_bytes(folder / f"precision-{key}.csv", file.getvalue().encode())


def load(folder: Path) -> Precision:
    """Read a stored study back; InputError says what is missing or of another schema."""
    file = folder / FILE
    data = read_json(file, f"{folder} holds no study of precision: it has no {FILE}")
    schema_of(data, file, SCHEMA)
    try:
        found = Precision(
            Scene.from_dict(data["scene"]),
            Extent.from_dict(data["extent"]),
            typed(data["provenance"], Provenance, "provenance"),
            data["processor"],
            data["wall_s"],
            data["horizon_s"],
            tuple(_stored_diagram(diagram) for diagram in data["diagrams"]),
            None if data["chaos"] is None else Chaos.from_dict(data["chaos"]),
            None if data["wear"] is None else WearStudy.from_dict(data["wear"]),
        )
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise InputError(f"{file} is not whole: {error!r}") from None
    wrong = next(misfits(found), None)
    if wrong is not None:
        raise InputError(f"{file}: {wrong} is not what it should be")
    return found
