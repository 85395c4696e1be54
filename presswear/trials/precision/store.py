"""A study of speed against error as files: one JSON of everything, a CSV for each table."""

import csv
import io
from collections.abc import Iterable
from pathlib import Path

from presswear.tools.documents import read_json
from presswear.tools.errors import InputError
from presswear.tools.files import write_bytes
from presswear.trials.precision.rows import Cells, diagram_rows, statistic_rows, wear_rows
from presswear.trials.precision.study import Precision
from presswear.trials.stored import restored, write_document

SCHEMA = 2
FILE = "precision.json"


def store(precision: Precision, folder: Path) -> None:
    """Write ``precision.json`` and ``precision-KEY.csv`` into a folder, made where needed.

    KEY is that of a diagram, ``statistics`` or ``wear``.
    """
    write_document(folder, FILE, SCHEMA, precision)
    tables: dict[str, Iterable[Cells]] = {
        diagram.key: diagram_rows(diagram) for diagram in precision.diagrams
    }
    if precision.chaos is not None:
        tables["statistics"] = statistic_rows(precision.chaos)
    if precision.wear is not None:
        tables["wear"] = wear_rows(precision.wear)
    for key, rows in tables.items():
        file = io.StringIO()
        cells = list(rows)
        writer = csv.DictWriter(file, cells[0] if cells else (), lineterminator="\n")
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
    return found
