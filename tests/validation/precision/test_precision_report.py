"""The page of a study of speed against error."""

from dataclasses import replace
from html.parser import HTMLParser

import pytest

from precision.made_up_precision import chaos, diagram, precision
from presswear.show.report.parts import Table
from presswear.studies.paper.variants import base_scene
from presswear.validation.precision.recommendation import recommend
from presswear.validation.precision.report import growth_sentence, headline, write_precision_report
from presswear.validation.precision.store import statistic_rows, wear_rows
from presswear.validation.precision.tables import (
    failures_table,
    growth_table,
    references_table,
    sampling_table,
    statistics_table,
    task_table,
    wear_table,
)
from presswear.validation.precision.wear import DEEPEST

TAKEN = base_scene("wear-times").numerics


class _Page(HTMLParser):
    """Text, tags that are not closed in order, and addresses of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words: list[str] = []
        self.addresses: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "img", "br", "link"):
            self.open.append(tag)
        for name, value in attrs:
            if name in ("src", "href") and value:
                self.addresses.append(value)
            if name == "id" and value:
                self.anchors.add(value)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("precision")
    answer, path = write_precision_report(precision(), TAKEN, folder)
    assert path == folder / "report.html"
    text = path.read_text()
    assert (folder / "figures" / "precision-horizon.png").exists()
    assert answer.split(":")[0] in text
    failed = "Task <ideal>; Task <horizon>; statistics of wear"
    assert answer.endswith(f"The paper's setting, RK4 at 1e-4 s, fails: {failed}.")
    return text


def parsed(text: str) -> _Page:
    found = _Page()
    found.feed(text)
    assert not found.open
    return found


def test_page_is_whole_and_needs_no_network(page: str) -> None:
    found = parsed(page)
    for address in found.addresses:
        assert address.startswith(("data:image/png;base64,", "#"))
        if address.startswith("#"):
            assert address[1:] in found.anchors
    assert sum(address.startswith("data:") for address in found.addresses) == 8


def test_recommendation_comes_before_any_figure(page: str) -> None:
    places = [
        page.index(words)
        for words in (
            "The cheapest setting that is honest for wear",
            "Recommended, and what the code takes",
            "<figure",
        )
    ]
    assert places == sorted(places)


def test_every_recommendation_is_told(page: str) -> None:
    text = " ".join("".join(parsed(page).words).split())
    for one in recommend(precision(), TAKEN):
        assert one.subject in text
        assert one.verdict in text


def test_names_are_escaped(page: str) -> None:
    assert "A processor &lt;with&gt; &amp; name" in page
    assert "<horizon>" not in page


def cells(table: Table) -> dict[str, dict[str, str]]:
    """Cells by the label of their row and the title of their column."""
    rows = [row for _, group in table.groups for row in group]
    return {row[0]: dict(zip(table.head, row, strict=True)) for row in rows}


def test_numbers_of_a_task() -> None:
    table = task_table(diagram())
    families = dict(table.groups)
    assert "dae, RK4; observed orders: slider position 4.0" in {n[:46] for n in families}
    smooth = dict(task_table(diagram("ideal")).groups)
    assert any(name.startswith("exudyn-tree, DOPRI5; observed orders: slider") for name in smooth)
    # Rows of other families have the same labels.
    tree = cells(replace(table, groups=tuple(g for g in table.groups if "tree" in g[0])))
    default = tree["tolerance 1·10⁻⁸ (default)"]
    assert list(default.values())[1:5] == ["1·10⁻⁶", "5·10⁻⁵", "1·10⁻⁷", "54.0000"]
    assert list(default)[1:4] == [f"error: {own.title}" for own in diagram().quantities]
    # 3981 steps at 20 us: median, least and greatest, with a tenth sent back.
    assert default["median (ms)"] == "79.6"
    assert default["spread (ms)"] == "71.7 to 104"
    assert default["steps"] == "3\u202f981"
    assert default["µs a step"] == "18.2"
    assert default["warm-up (s)"] == "2.5"
    _, *paper = cells(table)["step 0.0001 (paper, failed)"].values()
    assert set(paper) == {"–"}


def test_failures_are_listed_with_reasons() -> None:
    table = failures_table(precision())
    assert table is not None
    ((_, rows),) = table.groups
    assert ("statistics", "dae, RK4, step 0.0001", "start 1: the state is no longer finite") in rows
    assert any(row[2] == "3 of the first 10 touches missing" for row in rows)
    assert any(row[2] == "stage 1: it blew up" for row in rows)
    clean = replace(diagram(), points=tuple(p for p in diagram().points if not p.failure))
    found = precision()
    ran = replace(found.chaos, points=tuple(p for p in found.chaos.points if not p.failure))
    worn = replace(found.wear, points=tuple(p for p in found.wear.points if not p.failure))
    assert failures_table(replace(found, diagrams=(clean,), chaos=ran, wear=worn)) is None


def test_references_tell_their_own_error() -> None:
    ((_, rows),) = references_table([diagram()]).groups
    assert rows[0][2] == "slider position 1·10⁻⁸ m; slider velocity 1·10⁻⁶ m/s"
    known = tuple(replace(quantity, known=0.0) for quantity in diagram().quantities)
    exact = replace(diagram(), quantities=known)
    assert references_table([exact]).groups[0][1][0][2] == "exact"


def test_growth_and_statistics_in_numbers() -> None:
    found = chaos()
    (pair,) = cells(growth_table(found)).values()
    assert pair["growth rate, fitted (1/s)"] == "77.0"
    assert "exponent is 33.0\u00a0± 4.0 /s" in growth_sentence(found)
    unknown = replace(found, exponent=None)
    assert "of two runs" in growth_sentence(unknown)
    assert "exponent" not in growth_sentence(unknown)
    calm = replace(found.growth, distance=(2e-9,) * 400)
    (pair,) = cells(growth_table(replace(found, growth=calm))).values()
    assert [*pair.values()][1:6] == ["–"] * 5
    assert "stay within" in growth_sentence(replace(found, growth=calm))
    means = cells(sampling_table(found))["wear total at A (N m a cycle)"]
    assert means["sampling error of 16 cycles"] == "5.0 %"
    rows = cells(statistics_table(found))
    assert rows["tolerance 1·10⁻⁵"]["wear total at A (%)"].split() == ["+10.0", "(≤", "15.0)", "*"]
    assert rows["tolerance 1·10⁻⁸"]["for wear"] == "honest up to 44 cycles"
    assert "no longer finite" in rows["step 0.0001 (paper, failed)"]["for wear"]


def test_wear_in_numbers() -> None:
    rows = cells(wear_table(precision().wear))
    first = rows["90"]
    assert first["deepest wear at A (µm)"] == "10.0 (9.5 to 10)"
    assert [first[name] for name in list(first)[-3:]] == ["1", "60", "3.5"]
    assert "360 (default)" in rows
    assert rows["foundation (failed)"]["deepest wear at A (µm)"] == "–"


def test_nothing_honest_is_said_so() -> None:
    study = replace(precision(), chaos=chaos(bound=1.0))
    assert "No setting has been shown to be honest" in headline(study, recommend(study, TAKEN))


def test_statistics_and_wear_are_rows_of_equal_length() -> None:
    study = precision()
    told, worn = list(statistic_rows(study.chaos)), list(wear_rows(study.wear))
    for rows in (told, worn):
        assert len(rows) > 3
        assert len({tuple(row) for row in rows}) == 1
    known = [point for point in study.chaos.points if point.statistics]
    named = [row for row in told if row["statistic"]]
    assert len(named) == sum(len(point.statistics) for point in known)
    assert named[0]["mean"] == next(iter(known[0].statistics.values())).mean
    failed = [point for point in study.chaos.points if point.failure]
    assert sum(bool(row["failure"]) for row in told) >= len(failed) > 0
    first = next(iter(study.wear.points[0].first.values()))
    assert worn[0]["mean"] == first[DEEPEST].value
