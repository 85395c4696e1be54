"""Report pages: tables as lists of rows, figures, and one renderer for every kind of report.

A report defines its tables as lists of ``Row``, computes one record per column (a data
class or a mapping), and hands the tables to a template in ``templates/``.  All
sentences are in the template.
"""

import base64
import gc
import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape
from PIL.Image import Image

from presswear.recording.statistics import Estimate
from presswear.show.figures import Drawing, rendered, write
from presswear.show.figures.style import TEMPLATES
from presswear.show.figures.vector import svg_of, write_svg
from presswear.tools.numbers import (
    is_resolved,
    readable,
    unit_factor,
    unit_scale,
    whole,
)

NOTHING = "–"
# Characters of a figure in a page; a larger figure is shown as a PNG
MAX_SVG = 200_000
# Interval in parentheses, such as `` (1 to 2 %)``
_INTERVAL = re.compile(r" \(\S+ to \S+?( %)?\)")

Line = tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """Quantity in a table."""

    label: str
    # attributes, keys and indices from the record to the value: ``bdc.error``
    path: str
    # display unit into which the SI value is converted; see ``DISPLAY_UNITS``
    unit: str = ""
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
            return str(value.scaled(factor)) if is_resolved(value.mean, unit) else "0"
        case int() if factor == 1.0:
            return whole(value)
        case _:
            shown = factor * float(value) if is_resolved(value, unit) else 0.0
            return readable(shown, digits)


@dataclass(frozen=True)
class Table:
    """Table of texts."""

    head: Line  # titles of the columns
    # headings with the rows below them
    groups: tuple[tuple[str, tuple[Line, ...]], ...]
    numeric: bool = True  # all columns but the first are numbers
    # shown below labels, by label
    meanings: Mapping[str, str] = field(default_factory=dict)


def column_table(
    corner: str,
    names: Sequence[str],
    records: Sequence[Any],
    groups: Mapping[str, Sequence[Row]],
    numeric: bool = True,
) -> Table | None:
    """Return a table with a column per record and a line per row; None if no line has a value.

    ``corner`` is the title of the column of labels; ``groups`` are rows by heading.
    Rows without a value in any record are left out.
    """
    filled: list[tuple[str, tuple[Line, ...]]] = []
    meanings: dict[str, str] = {}
    for heading, rows in groups.items():
        lines = []
        for row in rows:
            displayed = _with_readable_unit(row, records)
            cells = [displayed.text(record) for record in records]
            if set(cells) <= {NOTHING}:
                continue
            lines.append((displayed.head, *cells))
            if row.meaning:
                meanings[displayed.head] = row.meaning
        if lines:
            filled.append((heading, tuple(lines)))
    if not filled:
        return None
    return Table((corner, *names), tuple(filled), numeric, meanings)


def _with_readable_unit(row: Row, records: Sequence[Any]) -> Row:
    """Return a row with the unit in which its largest value has a readable number."""
    largest = 0.0
    for record in records:
        value = value_at(record, row.path)
        number = value.mean if isinstance(value, Estimate) else value
        if isinstance(number, float):
            largest = max(largest, abs(number))
    _, unit = unit_scale(row.unit, largest or 1.0)
    return replace(row, unit=unit)


def plain_table(
    head: Iterable[str], lines: Iterable[Line], numeric: bool = True
) -> Table:
    """Return a table of one group of lines."""
    return Table(tuple(head), (("", tuple(lines)),), numeric)


class Illustration(NamedTuple):
    """Figure in a page: file name, title, caption and an ``svg`` element."""

    file: str
    title: str
    caption: str
    svg: str

    @property
    def element(self) -> Markup:
        """Element with its title and caption as a label, which keys and a mouse can enlarge."""
        label = escape(f"{self.title}. {self.caption}")
        head = f'<svg tabindex="0" role="img" aria-label="{label}" '
        return Markup(self.svg.replace("<svg ", head, 1))


@dataclass(frozen=True)
class Section:
    """Section of a page: tables with their headings, and notes in small print at the end."""

    heading: str
    paragraphs: Sequence[str] = ()
    tables: Sequence[tuple[str, Table]] = ()
    figures: Sequence[Illustration] = ()
    notes: Sequence[str] = ()
    is_open: bool = False  # False: only the heading is shown until it is clicked


def illustrated(drawings: Iterable[Drawing], folder: Path) -> list[Illustration]:
    """Draw figures, write them into a folder and return them for a page.

    A figure is a file ``.svg``, or ``.png`` if its SVG is too large.
    """
    # Figures are full of reference cycles, whose collection takes a sixth of the time.
    gc.disable()
    try:
        return [_illustration(drawing, folder) for drawing in drawings]
    finally:
        gc.enable()


def _illustration(drawing: Drawing, folder: Path) -> Illustration:
    svg = svg_of(drawing)
    file = folder / drawing.file
    if len(svg) > MAX_SVG:
        image = rendered(drawing)
        svg = _svg_of_image(image, write(image, file).read_bytes())
    else:
        file = write_svg(svg, file)
    return Illustration(file.name, drawing.title, drawing.caption, svg)


def drawn_inline(drawings: Iterable[Drawing]) -> list[Illustration]:
    """Draw figures for a page without files."""
    return [
        Illustration(drawing.file, drawing.title, drawing.caption, svg_of(drawing))
        for drawing in drawings
    ]


def _svg_of_image(image: Image, data: bytes) -> str:
    """Return an ``svg`` element that shows a PNG."""
    size = f'width="{image.width}" height="{image.height}"'
    link = f"data:image/png;base64,{base64.b64encode(data).decode()}"
    return f'<svg viewBox="0 0 {image.width} {image.height}"><image {size} href="{link}"/></svg>'


class KeyNumber(NamedTuple):
    """Number on the first screen: its name, value with unit, interval, and short meaning.

    ``compared`` holds names and values to which it is compared, a line each.
    A number with a note, such as ``from 12 strokes``, is uncertain: it is grey.
    ``estimate`` is the number in SI, which two results are compared by.
    ``depends_on_wear`` is False for a number that all stages of a run share. ``stage``
    names the surfaces of the number, such as ``after 20 000 strokes``.
    """

    name: str
    value: str
    interval: str
    meaning: str
    compared: tuple[tuple[str, str], ...] = ()
    note: str = ""
    estimate: Estimate | None = None
    depends_on_wear: bool = True
    stage: str = ""

    @property
    def title(self) -> str:
        """Name with the surfaces of the number."""
        return f"{self.name}, {self.stage}" if self.stage else self.name


class Verdict(NamedTuple):
    """Verdict on a number beside its limit: word, sign, and class in the style sheet."""

    word: str
    sign: str
    style: str


class LimitLine(NamedTuple):
    """Number beside its limit, both as texts, and the verdict."""

    number: KeyNumber
    limit: str
    verdict: Verdict


@dataclass(frozen=True)
class FirstScreen:
    """Top of a page: the status, limits, key numbers beside a picture, and the warnings."""

    status: str = ""
    style: str = "completed"  # class of the status in the style sheet
    key_numbers: Sequence[KeyNumber] = ()
    warnings: Sequence[str] = ()
    picture: Illustration | None = None
    limits: Sequence[LimitLine] = ()
    limits_stage: str = ""  # surfaces of the limited numbers; empty with one stage
    made_by: str = ""  # command, version and date


def render_page(
    title: str,
    first_screen: FirstScreen,
    sections: Sequence[Section] = (),
    answer: Sequence[str] = (),
    template: str = "page.html",
    **content: Any,
) -> str:
    """Return a page as HTML; everything in it is escaped.

    The answer and the sections, which fold, are below the first screen. ``content`` is
    for the parts of another template.
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
    environment.tests |= {
        "match": lambda text, pattern: re.match(pattern, text) is not None,
        "search": lambda text, pattern: re.search(pattern, text) is not None,
    }
    script = (files("presswear.show") / "templates/page.js").read_text("utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return environment.get_template(template).render(
        **vars(first_screen),
        **content,
        title=title,
        sections=sections,
        answer=answer,
        script=Markup(script),
        digest=digest,
    )


def _without_breaks(value: Any) -> Any:
    """Replace the spaces in intervals so that these are not broken; markup stays as it is."""
    if type(value) is not str:  # markup is a subclass of str
        return value
    return _INTERVAL.sub(lambda match: match[0].replace(" ", "\xa0"), value)
