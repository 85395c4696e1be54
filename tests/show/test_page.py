"""Rows, tables and pages."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from html.parser import HTMLParser

import pytest
from python_process import python
from refusals import refused

import presswear as pw
from presswear.recording.statistics import Estimate
from presswear.show import page
from presswear.show.figures import Drawing
from presswear.show.figures.style import Sheet
from presswear.show.page import Row, column_table, plain_table
from presswear.tools.errors import InputError


class Page(HTMLParser):
    """Elements, links, texts and table rows of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.links: list[str] = []
        self.words: list[str] = []
        self.rows: list[list[str]] = []
        self.in_row = False
        self.feed(re.sub(r"(?s)<script>.*?</script>", "<script></script>", text))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [
            value or "" for name, value in attrs if name in ("src", "href", "srcset")
        ]
        if tag == "tr":
            self.rows.append([])
            self.in_row = True

    def handle_endtag(self, tag: str) -> None:
        self.in_row = self.in_row and tag != "tr"

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.words.append(data.strip())
            if self.in_row:
                self.rows[-1].append(data.strip())

    def row(self, label: str) -> list[str]:
        return next(row for row in self.rows if row and row[0] == label)

    def numbers(self, label: str, count: int) -> list[str]:
        """Last cells of a row, without the explanation of its label."""
        return self.row(label)[-count:]

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.words))


@dataclass
class Wheel:
    """Record with attributes, a mapping and a tuple."""

    depth: float
    joints: dict[str, dict[str, float]]
    ends: tuple[float, float]


WHEEL = Wheel(2e-5, {"A": {"force": 1234.0}}, (1.0, 2.0))


def test_a_path_reads_attributes_keys_and_indices():
    paths = {
        "depth": 2e-5,
        "joints.A.force": 1234.0,
        "ends.1": 2.0,
        "joints.B.force": None,
    }
    assert {path: page.value_at(WHEEL, path) for path in paths} == paths
    with pytest.raises(AttributeError):
        page.value_at(WHEEL, "dept")


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (None, "µm", "–"),
        (12345, "", "12\u202f345"),
        (2e-5, "µm", "20.0"),
        (Estimate.symmetric(1e-5, 2e-6, 9), "µm", "10.0\u00a0± 2.0"),
        (Estimate(1e-5, 8e-6, 2e-5), "µm", "10 (8.0 to 20)"),
        (Estimate(1e-5), "µm", "10.0 (too few cycles)"),
    ],
)
def test_values_are_shown_in_the_unit_of_their_row(value, unit, text):
    assert page.text_of(value, unit) == text


ENERGY = Row("energy", "made", "J")


def test_tables_of_rows():
    rows = [
        Row("force of A", "joints.A.force", "N", "peak"),
        Row("missing", "joints.B.force"),
    ]
    table = column_table("wheel", ["first", "second"], [WHEEL, WHEEL], {"": rows})
    assert table.head == ("wheel", "first", "second")
    assert table.groups == (("", (("force of A (N)", "1\u202f230", "1\u202f230"),)),)
    assert table.meanings == {"force of A (N)": "peak"}
    assert column_table("", ["first"], [WHEEL], {"": rows[1:]}) is None
    energies = column_table(
        "", ["a", "b"], [{"made": 911e-6}, {"made": 2e-5}], {"": [ENERGY]}
    )
    assert energies.groups == (("", (("energy (µJ)", "911", "20.0"),)),)


def test_a_page_of_sections_escapes_everything():
    hostile = "<script>alert('x')</script> & \"more\""
    table = plain_table([hostile], [("20.0",)])
    figure = page.Illustration(
        "a.png", hostile, hostile, "<svg viewBox='0 0 1 1'></svg>"
    )
    section = page.Section(hostile, [hostile], [(hostile, table)], [figure], [hostile])
    number = page.KeyNumber(hostile, hostile, hostile, hostile)
    screen = page.FirstScreen(hostile, "completed", [number], [hostile], figure)
    shown = Page(page.render_page(hostile, screen, [section], [hostile]))
    assert shown.tags.count("script") == 1  # of the page itself
    assert shown.tags.count("svg") == 2
    assert shown.words.count(hostile) == 16
    assert shown.links == ["#part-1"]


def numbered(*numbers: int) -> Iterator[Drawing]:
    for number in numbers:
        if number == 3:
            raise InputError("there is no third")
        yield Drawing(f"{number}.png", f"{number}", "", Sheet((1, 1)))


def test_figures_come_in_order(tmp_path):
    figures = page.illustrated(numbered(2, 0, 1, 4), tmp_path)
    assert "".join(figure.title for figure in figures) == "2014"
    assert {path.name for path in tmp_path.iterdir()} == {
        figure.file for figure in figures
    }
    (tmp_path / "5.svg").mkdir()
    with pytest.raises(IsADirectoryError):
        page.illustrated(numbered(5, 6), tmp_path)
    with refused("there is no third"):
        page.illustrated(numbered(3, 2), tmp_path)


def test_wear_below_round_off_is_zero():
    """An asperity far below an oil film wears by 1e-48 m, of a pressure by 1e-20 1/Pa."""
    wear = Estimate.symmetric(1e-48, 1e-49)
    assert [page.text_of(one, "µm") for one in (1e-48, wear)] == ["0", "0"]
    assert page.text_of(1e-40, "mm³") == page.text_of(1e-45, "N m") == "0"
    assert page.text_of(2.5e-9, "µm") == "2.50·10⁻³"
    assert page.text_of(1e-20, "1/Pa") == "10.0·10⁻²¹"
    assert page.text_of(float("nan"), "µm") == page.NOTHING


MEMORY = """
import re, resource, sys
import presswear as pw
from presswear.show.figures import drawings  # loads matplotlib
from presswear.show.report import write_report

result = pw.run(pw.scenes.ideal(cycles=1), sys.argv[1], engine="dae", jobs=1)
size = int(re.search(r"VmSize:\\s*(\\d+)", open("/proc/self/status").read())[1])
limit = 1024 * size + 2**22
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
try:
    write_report(result)
except pw.RunFailed as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_that_runs_out_while_drawing_is_one_line(tmp_path):
    folder = tmp_path / "run"
    ran = python("-c", MEMORY, folder, check=True)
    assert ran.stdout == (
        "memory ran out while the report was drawn; the result is kept, and presswear "
        f"report {folder} draws it\n"
    )
    assert pw.load(folder).status == "completed"
