"""Report pages: tables as lists of rows, figures, and one renderer for every kind of report.

A report defines its tables as lists of ``Row``, computes one record per column (a data class or a
mapping), and hands the tables to a template in ``templates/``.  All sentences are in the template.
"""

import base64
import gc
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined
from PIL.Image import Image

from presswear.recording.statistics import Estimate
from presswear.show.figures import Drawing, rendered, write
from presswear.show.figures.style import TEMPLATES
from presswear.tools.numbers import readable, unit_factor, whole, with_interval

NOTHING = "–"
_INTERVAL = re.compile(r" \(\S+ to \S+?( %)?\)")  # a space is never part of a figure's data

Line = tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """Quantity in a table."""

    label: str
    path: str  # attributes, keys and indices from the record to the value: ``bdc.error``
    unit: str = ""  # display unit into which the SI value is converted; see ``DISPLAY_UNITS``
    meaning: str = ""  # explanation below the label
    digits: int = 3

    @property
    def head(self) -> str:
        """Label with the unit."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    def text(self, record: Any) -> str:
        """Return the value of a record as text."""
        return text_of(value_at(record, self.path), self.unit, self.digits)


def value_at(record: Any, path: str) -> Any:
    """Return the value at a path of attributes, keys and indices; None if a key is missing."""
    value = record
    for name in path.split("."):
        if value is None:
            return None
        if isinstance(value, Mapping):
            value = value.get(name)
        elif isinstance(value, list | tuple) and name.isdigit():
            value = value[int(name)]
        else:
            value = getattr(value, name)
    return value


def text_of(value: Any, unit: str = "", digits: int = 3) -> str:
    """Return an SI value as text in a display unit, with its interval if it has one."""
    factor = unit_factor(unit)
    match value:
        case None:
            return NOTHING
        case str():
            return value
        case Estimate():
            shown = value.scaled(factor)
            mean, low, high, half = shown.mean, shown.low, shown.high, shown.half_width
            if low is None or high is None or half is None:
                return with_interval(mean, None)
            if math.isclose(0.5 * (low + high), mean, rel_tol=1e-12, abs_tol=1e-6 * half):
                return with_interval(mean, half)
            mean_text, *ends = (readable(number, digits) for number in (mean, low, high))
            return f"{mean_text} ({' to '.join(ends)})"
        case int() if factor == 1.0:
            return whole(value)
        case _:
            return readable(factor * float(value), digits)


@dataclass(frozen=True)
class Table:
    """Table of texts."""

    head: Line  # titles of the columns
    groups: tuple[tuple[str, tuple[Line, ...]], ...]  # headings with the rows below them
    numeric: bool = True  # all columns but the first are numbers
    meanings: Mapping[str, str] = field(default_factory=dict)  # shown below labels, by label


def column_table(
    corner: str,
    names: Sequence[str],
    records: Sequence[Any],
    groups: Mapping[str, Sequence[Row]],
    numeric: bool = True,
) -> Table | None:
    """Return a table with a column per record and a line per row; None if no line has a value.

    ``corner`` is the title of the column of labels; ``groups`` are rows by heading. Rows without
    a value in any record are left out.
    """
    filled = {}
    for heading, rows in groups.items():
        lines = [(row.head, *(row.text(record) for record in records)) for row in rows]
        if lines := [line for line in lines if set(line[1:]) - {NOTHING}]:
            filled[heading] = tuple(lines)
    meanings = {row.head: row.meaning for rows in groups.values() for row in rows if row.meaning}
    return Table((corner, *names), tuple(filled.items()), numeric, meanings) if filled else None


def row_table(columns: Sequence[Row], records: Sequence[Any], numeric: bool = True) -> Table:
    """Return a table with a line per record and a column per row."""
    lines = tuple(tuple(column.text(record) for column in columns) for record in records)
    return Table(tuple(column.head for column in columns), (("", lines),), numeric)


class Illustration(NamedTuple):
    """Figure in a page: file name, title, caption and the PNG in base 64."""

    file: str
    title: str
    caption: str
    data: str


@dataclass(frozen=True)
class Section:
    """Section of a page: tables with their headings, and notes in small print at the end."""

    heading: str
    paragraphs: Sequence[str] = ()
    tables: Sequence[tuple[str, Table]] = ()
    figures: Sequence[Illustration] = ()
    notes: Sequence[str] = ()


def illustrated(drawings: Iterable[Drawing], folder: Path) -> list[Illustration]:
    """Draw figures, write them into a folder and return them for a page."""

    def illustration(drawing: Drawing, image: Image) -> Illustration:
        data = base64.b64encode(write(image, folder / drawing.file).read_bytes()).decode()
        return Illustration(drawing.file, drawing.title, drawing.caption, data)

    gc.disable()  # it would take a sixth of the time: figures are full of reference cycles
    try:
        # An image is compressed and written while the next one is drawn.
        with ThreadPoolExecutor(1) as writer:
            written = [writer.submit(illustration, each, rendered(each)) for each in drawings]
        return [future.result() for future in written]
    finally:
        gc.enable()


def render_page(
    title: str,
    sections: Sequence[Section] = (),
    figures: Sequence[Illustration] = (),
    template: str = "page.html",
    **content: Any,
) -> str:
    """Return a page as HTML; everything in it is escaped.

    ``page.html`` shows ``status``, ``style``, ``answer``, sections and figures; another template
    extends it and places what the content holds.
    """
    environment = Environment(
        loader=PackageLoader("presswear.show"),
        autoescape=True,
        finalize=_without_breaks,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {**TEMPLATES.filters, "text": text_of, "whole": whole}
    page = environment.get_template(template)
    return page.render(title=title, sections=sections, figures=figures, **content)


def _without_breaks(value: Any) -> Any:
    """Replace the spaces in intervals so that these are not broken; markup stays as it is."""
    is_text = type(value) is str
    return _INTERVAL.sub(lambda match: match[0].replace(" ", "\xa0"), value) if is_text else value
