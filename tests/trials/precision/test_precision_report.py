"""The page of a study of speed against error."""

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from made_up_precision import chaos, diagram, precision

from presswear.studies.paper.variants import base_scene
from presswear.trials.precision.recommendation import recommend
from presswear.trials.precision.report import growth_sentence, headline, write_precision_report
from presswear.trials.precision.rows import statistic_rows, wear_rows
from presswear.trials.precision.tables import (
    cost_table,
    error_table,
    failures_table,
    growth_table,
    references_table,
    sampling_table,
    statistics_table,
    wear_cost_table,
    wear_table,
)

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


def test_numbers_of_a_task() -> None:
    errors, costs = error_table(diagram()), cost_table(diagram())
    assert errors.head[1:] == (
        "slider position (m)",
        "slider velocity (m/s)",
        "energy residual / exchanged",
        "touches",
    )
    for table in (errors, costs):
        for _, rows in table.groups:
            assert all(len(row) == len(table.head) for row in rows)
    families = dict(errors.groups)
    assert "dae, RK4; observed orders: slider position 4.0" in {n[:46] for n in families}
    smooth = dict(error_table(diagram("ideal")).groups)
    assert any(name.startswith("exudyn-tree, DOPRI5; observed orders: slider") for name in smooth)
    tree = families["exudyn-tree, DOPRI5"]
    default = next(row for row in tree if "default" in row[0])
    assert default == (
        "tolerance 1·10⁻⁸ (default)",
        "1·10⁻⁶",
        "5·10⁻⁵",
        "1·10⁻⁷",
        "54.0000",
    )
    # 3981 steps at 20 us: median, least and greatest, with a tenth sent back.
    cells = dict(zip(costs.head, dict(costs.groups)["exudyn-tree, DOPRI5"][-1], strict=True))
    assert cells["median (ms)"] == "79.6"
    assert cells["spread (ms)"] == "71.7 to 104"
    assert cells["steps"] == "3\u202f981"
    assert cells["µs a step"] == "18.2"
    assert cells["warm-up (s)"] == "2.5"
    rk4 = next(rows for name, rows in families.items() if name.startswith("dae, RK4"))
    paper = next(row for row in rk4 if "paper" in row[0])
    assert paper[1:] == ("failed", "–", "–", "–")


def test_failures_are_listed_with_reasons() -> None:
    table = failures_table(precision())
    assert table is not None
    ((_, rows),) = table.groups
    assert ("statistics", "dae, RK4, step 0.0001", "start 1: the state is no longer finite") in rows
    assert any(row[2] == "3 of the first 10 touches missing" for row in rows)
    assert any(row[2] == "stage 1: it blew up" for row in rows)
    clean = replace(diagram(), points=tuple(p for p in diagram().points if not p.failure))
    calm = replace(precision(whole=False), diagrams=(clean,))
    assert failures_table(calm) is None


def test_references_tell_their_own_error() -> None:
    ((_, rows),) = references_table([diagram()]).groups
    assert rows[0][2] == "slider position 1·10⁻⁸ m; slider velocity 1·10⁻⁶ m/s"
    known = tuple(replace(quantity, known=0.0) for quantity in diagram().quantities)
    exact = replace(diagram(), quantities=known)
    assert references_table([exact]).groups[0][1][0][2] == "exact"


def test_growth_and_statistics_in_numbers() -> None:
    found = chaos()
    ((_, pairs),) = growth_table(found).groups
    assert pairs[0][1] == "77.0"
    assert pairs[1][1:3] == ("–", "–")
    assert pairs[1][4:7] == ("–",) * 3
    assert "of two runs" in growth_sentence(precision())
    assert "Of 1 further pairs, begun later in the motion, 0 part" in growth_sentence(precision())
    ((_, means),) = sampling_table(found).groups
    assert means[0][0] == "wear total at A (N m a cycle)"
    assert means[0][3] == "5.0 %"
    table = statistics_table(found)
    rows = {row[0]: row for _, group in table.groups for row in group}
    assert all(len(row) == len(table.head) for row in rows.values())
    assert rows["tolerance 1·10⁻⁵"][2].split() == ["+10.0", "(≤", "15.0)", "*"]
    assert "honest up to 44 cycles" in rows["tolerance 1·10⁻⁸"]


def test_wear_in_numbers() -> None:
    found = precision().wear
    assert found is not None
    table = wear_table(found)
    rows = [row for _, group in table.groups for row in group]
    assert all(len(row) == len(table.head) for row in rows)
    assert rows[0][1] == "40.0 (38 to 42)"
    assert any(row[0] == "360 (default)" for row in rows)
    assert any(row[1] == "failed" for row in rows)
    costs = [row for _, group in wear_cost_table(found).groups for row in group]
    assert costs[0] == ("90", "1", "60", "3.5")
    assert len(costs) == len(rows)


def test_nothing_honest_is_said_so() -> None:
    study = replace(precision(), chaos=chaos(bound=1.0))
    assert "No setting has been shown to be honest" in headline(study, recommend(study, TAKEN))


def test_page_without_statistics_and_wear(tmp_path: Path) -> None:
    answer, path = write_precision_report(precision(whole=False), TAKEN, tmp_path)
    text = path.read_text()
    parsed(text)
    assert "Beyond the horizon" not in text
    assert "The paper's setting, RK4 at 1e-4 s, fails" in answer


def test_page_of_nothing(tmp_path: Path) -> None:
    study = replace(precision(whole=False), diagrams=())
    answer, path = write_precision_report(study, TAKEN, tmp_path)
    assert answer == "There is nothing to recommend from what was run."
    parsed(path.read_text())


def test_statistics_and_wear_are_rows_of_equal_length() -> None:
    study = precision()
    assert study.chaos is not None
    assert study.wear is not None
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
    assert worn[0]["mean"] == first.depth.value
