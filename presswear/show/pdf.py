"""Report as a PDF for an author: key numbers, tables, and figures as vectors with fonts."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.backends.backend_pdf import PdfPages

from presswear.results.result import Result
from presswear.scene.catalog import title_of
from presswear.show.figures import drawings
from presswear.show.figures.style import SETTINGS, WIDTH, Drawing, Sheet, wrapped
from presswear.show.page import FirstScreen, Line, Table
from presswear.show.report import (
    drawings_of_many_cycles,
    first_screen,
    folder_of,
    report_tables,
    titles_of,
)
from presswear.tools.files import write_whole

# Text as fonts that an editor of vectors and a publisher can read, not as outlines
FONTS: Mapping[Any, Any] = {"pdf.fonttype": 42, "ps.fonttype": 42}
PAGE = 8.27, 11.69  # A4, inches
MARGIN = 0.5 * (PAGE[0] - WIDTH)
LINE = 0.16  # inches, of text of 8 pt
LABEL = 52  # letters of a first column
CELL = 34  # letters of another column, at most
BOLD = 1.2  # width of a bold letter over that of another


def write_pdf(result: Result, extra_figures: Sequence[str] = ()) -> Path:
    """Write ``report.pdf`` into the folder of a result, and return it.

    ``extra_figures`` are figures of ``OF_MANY_CYCLES`` beside those of the report.
    """
    file = folder_of(result) / "report.pdf"
    missing = list[str]()
    tables = report_tables(result, missing)
    screen = first_screen(result, missing)
    extra = drawings_of_many_cycles(result, extra_figures)
    sheets = [*drawings(result), *extra]
    information = {
        "Title": title_of(result.scene),
        "Creator": "presswear",
        "CreationDate": None,
    }

    def write(stream: Any) -> None:
        with (
            matplotlib.rc_context({**SETTINGS, **FONTS}),
            PdfPages(stream, metadata=information) as pages,
        ):
            _write_texts(pages, result, screen, tables)
            for number, drawing in enumerate(sheets, start=1):
                _add_figure(pages, drawing, number)

    write_whole(file, write)
    return file


def _write_texts(
    pages: PdfPages,
    result: Result,
    screen: FirstScreen,
    tables: dict[str, Table | None],
) -> None:
    """Write the pages of key numbers and tables."""
    texts = _Texts(pages)
    texts.paragraph(title_of(result.scene), size=14.0, weight="bold")
    texts.paragraph(f"{screen.status} {screen.made_by}")
    if screen.limits:
        rows = [
            (line.number.name, line.number.value, line.limit, line.verdict.word)
            for line in screen.limits
        ]
        head = f"Limits {screen.limits_stage}".rstrip()
        texts.table(head, ("", "value", "limit", ""), [("", rows)])
    numbers = []
    for number in screen.key_numbers:
        interval = ", ".join(filter(None, (number.interval, number.note)))
        numbers.append((number.title, number.value, interval))
    if numbers:
        texts.table("Key numbers", ("", "value", "95 % interval"), [("", numbers)])
    for warning in screen.warnings:
        texts.paragraph(warning)
    for name, heading in titles_of(result.scene).items():
        table = tables.get(name)
        if table is not None and not (name == "changes" and tables.get("chosen")):
            texts.table(heading, table.head, table.groups)
    texts.finish()


class _Texts:
    """Pages of text and tables, filled from the top."""

    def __init__(self, pages: PdfPages) -> None:
        self.pages = pages
        self.sheet = Sheet(figsize=PAGE)
        # height of the next line above the lower edge, inches
        self.height = PAGE[1] - MARGIN

    def finish(self) -> None:
        """Write the page."""
        self.pages.savefig(self.sheet)

    def _make_room(self, height: float) -> None:
        if self.height - height < MARGIN:
            self.finish()
            self.sheet = Sheet(figsize=PAGE)
            self.height = PAGE[1] - MARGIN

    def _write(self, left: float, text: str, **style: Any) -> None:
        self.sheet.text(
            left / PAGE[0],
            self.height / PAGE[1],
            text,
            va="top",
            linespacing=1.25,
            **style,
        )

    def paragraph(self, text: str, size: float = 8.0, weight: str = "normal") -> None:
        """Write a paragraph over the width of the page."""
        lines = wrapped(text, WIDTH * 8.0 / size).splitlines()
        height = LINE * size / 8.0 * len(lines)
        self._make_room(height)
        self._write(MARGIN, "\n".join(lines), fontsize=size, weight=weight)
        self.height -= height + 0.5 * LINE

    def table(
        self,
        heading: str,
        head: Line,
        groups: Iterable[tuple[str, Iterable[Line]]],
    ) -> None:
        """Write a table: its heading, its head, and its lines with headings of groups."""
        groups = [(name, list(lines)) for name, lines in groups]
        widths = _widths(head, list(chain(*(lines for _, lines in groups))))
        self.height -= 0.5 * LINE
        self._make_room(4.0 * LINE)
        self.paragraph(heading, size=10.0, weight="bold")
        self._line(head, widths, weight="bold")
        for name, lines in groups:
            if name:
                self._make_room(2.0 * LINE)
                self._write(MARGIN, name, fontsize=8.0, style="italic")
                self.height -= LINE
            for line in lines:
                self._line(line, widths)

    def _line(
        self, cells: Line, widths: Sequence[float], weight: str = "normal"
    ) -> None:
        letter = BOLD if weight == "bold" else 1.0
        texts = [
            wrapped(cell, (width - 0.1) / letter)
            for cell, width in zip(cells, widths, strict=True)
        ]
        height = LINE * max(text.count("\n") + 1 for text in texts)
        self._make_room(height)
        left = MARGIN
        for text, width in zip(texts, widths, strict=True):
            self._write(left, text, fontsize=8.0, weight=weight)
            left += width
        self.height -= height


def _widths(head: Line, lines: Sequence[Line]) -> list[float]:
    """Return the widths of columns, inches, by their longest texts and bold heads."""
    letters = []
    for k, (title, *column) in enumerate(zip(head, *lines, strict=True)):
        most = LABEL if k == 0 else CELL
        longest = max([BOLD * len(title), *map(len, column)])
        letters.append(min(longest + 4, most))
    return [WIDTH * count / max(sum(letters), 112) for count in letters]


def _add_figure(pages: PdfPages, drawing: Drawing, number: int) -> None:
    """Write a page of a figure with its number, title and caption below it."""
    text = wrapped(f"Figure {number}. {drawing.title}. {drawing.caption}", WIDTH)
    sheet = drawing.sheet
    below = -0.15 / sheet.get_figheight()
    sheet.draw_without_rendering()
    sheet.set_layout_engine("none")  # the caption moves nothing
    sheet.text(0.0, below, text, va="top", fontsize=8.0, linespacing=1.25)
    pages.savefig(sheet, bbox_inches="tight", pad_inches=0.0)
