"""The report page of small made-up results."""

import re
from dataclasses import replace
from functools import partial
from html.parser import HTMLParser
from pathlib import Path

import pytest
from made_up_result import BODY, BOTH, IDEAL, ONE, altered, made_up

from presswear.physics.statics import total_clearance
from presswear.results.result import Result
from presswear.results.stage import StageStatistics
from presswear.scene.bearing import CONVENTIONS, Conventions
from presswear.scene.catalog import slider_crank
from presswear.scene.settings import settings_of
from presswear.show.figures import Drawing, drawings
from presswear.show.figures.style import Sheet
from presswear.show.report import notes, render, words_of, write_report
from presswear.show.report.page import illustrated
from presswear.tools.errors import InputError


class Page(HTMLParser):
    """Elements, attribute values and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.links: list[str] = []
        self.words: list[str] = []
        self.rows: list[list[str]] = []
        self.in_row = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "srcset")]
        if tag == "tr":
            self.rows.append([])
            self.in_row = True

    def handle_endtag(self, tag: str) -> None:
        if tag == "tr":
            self.in_row = False

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.words.append(data.strip())
            if self.in_row:
                self.rows[-1].append(data.strip())

    def row(self, label: str) -> list[str]:
        return next(row for row in self.rows if row and row[0] == label)

    @property
    def text(self) -> str:
        return " ".join(self.words)


def page_of(result: Result) -> Page:
    return Page(render(words_of(result), []))


def test_one_file_without_references(tmp_path: Path) -> None:
    result = replace(made_up(ONE, 2), path=tmp_path)
    path = write_report(result)
    assert path == tmp_path / "report.html"
    text = path.read_text()
    page = Page(text)
    assert len(page.links) == len(list((tmp_path / "figures").iterdir())) == 13
    assert all(link.startswith("data:image/png;base64,") for link in page.links)
    own = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", text)
    assert not re.search(r"http|url\(|@import|<script|<link", own)


def numbered(number: int) -> list[Drawing]:
    """As many empty sheets as a number says; there is no third."""
    if number == 3:
        raise InputError("there is no third")
    return [Drawing(f"{number}-{k}.png", f"{number}", "", Sheet((1, 1))) for k in range(number)]


@pytest.mark.parametrize("at_once", [1, 2])
def test_figures_of_several_processes_come_in_order(tmp_path: Path, at_once: int) -> None:
    drawers = [partial(numbered, number) for number in (2, 0, 1, 4, 1)]
    said, found = illustrated(partial(dict, title="some"), drawers, tmp_path, at_once)
    assert said == {"title": "some"}
    assert [own.title for own in found] == ["2", "2", "1", "4", "4", "4", "4", "1"]
    files = {own.file for own in found}
    assert {path.name for path in tmp_path.iterdir()} == files == {*files, "4-3.png"}
    with pytest.raises(InputError, match="there is no third"):
        illustrated(dict, [partial(numbered, number) for number in (1, 2, 3, 4)], tmp_path, at_once)


def test_bottom_dead_centre_has_a_table() -> None:
    page = page_of(made_up(ONE, 2))
    told = page.row("standard deviation of the height (µm)")[1]
    assert told == "40.0\u00a0(30.0\u00a0to\u00a060.0)"
    assert page.row("later than the ideal (ms)")[1] == "−3.00 (too few cycles)"
    assert page.row("the same as crank angle (degrees)")[1] == "−1.8\u00a0± 1.0"
    # Each number stands once: what is told at a glance is not told again.
    for text in ("−860\u00a0± 30", "−100\u00a0± 42", "100 (too few strokes)"):
        assert page.words.count(text) == 1 + (text[0] == "1")
    clearance = page.row("total clearance at the slider (µm)")[2:]
    stages = [replace(ONE, surfaces=stage.surfaces) for stage in made_up(ONE, 2).stages]
    found = [1e6 * total_clearance(scene.linkage()) for scene in stages]
    assert [float(text.replace("\u202f", "")) for text in clearance] == pytest.approx(
        found, rel=1e-3
    )
    assert found[1] > found[0]
    rigid = page_of(made_up(IDEAL, 1))
    assert rigid.row("standard deviation of the height (µm)")
    assert "total clearance" not in rigid.text


def test_hostile_title_is_text() -> None:
    title = "<script>alert('x')</script> & \"more\""
    text = render(words_of(made_up(replace(BOTH, title=title), 1)), [])
    assert "script" not in Page(text).tags
    assert title in Page(text).words


def test_failed_status_is_shown_with_its_message() -> None:
    message = "stage 1: Newton's method found no solution <at all>"
    page = page_of(made_up(BOTH, 2, "failed", message))
    assert f"Failed: {message}" in page.words
    assert page.row("first wear")[1] == f"failed: {message}"


def test_stage_that_failed_at_once_leaves_dashes() -> None:
    result = made_up(BOTH, 2, "failed", "no step")
    page = page_of(altered(result, 1, statistics=StageStatistics(cycles=0)))
    assert page.row("largest acceleration (m/s²)")[1:] == ["1\u202f220", "–"]
    assert page.row("largest normal force (N)")[1:] == ["100", "–"]


def test_unfinished_status() -> None:
    assert "Unfinished: 1 of 3 stages stored" in page_of(made_up(BOTH, 1, "running")).text


def test_key_numbers() -> None:
    page = page_of(made_up(BOTH, 3))
    assert page.row("highest displacement (mm)")[1:] == ["107.3"] * 3
    assert page.row("deepest wear it ran on, bearing + pin (µm)")[1:] == [
        "0",
        "10.0\u00a0at\u00a092.5°",
        "20.0\u00a0at\u00a092.5°",
    ]
    assert page.row("one more wear: volume (mm³)")[1:] == ["3.00"] * 3
    assert page.row("time in contact (%)")[1:] == ["50.0"] * 3


def test_bodies_keep_their_own_depths() -> None:
    page = page_of(made_up(BODY, 2))
    assert page.row("deepest wear it ran on, pin (µm)")[1:] == ["0", "5.00\u00a0at\u00a092.5°"]


def test_says_how_far_to_trust_it() -> None:
    text = page_of(made_up(BOTH, 2)).text
    assert "Beyond some tens of impacts the motion is chaotic; a peak is one draw" in text
    assert "chosen, not the paper's" in text
    assert "80\u00a0± 12" in text


def test_radial_contact_on_worn_surfaces_is_warned_of() -> None:
    assert "met radially" in page_of(made_up(BOTH, 2)).text
    assert "met radially" not in page_of(made_up(BOTH, 1)).text
    assert "met radially" not in page_of(made_up(BODY, 2)).text


def test_ideal_press_is_not_called_chaotic() -> None:
    text = page_of(made_up(IDEAL, 1)).text
    assert "chaotic" not in text
    assert "chosen, not the paper's" in text


@pytest.mark.parametrize("joints", ["B", "none"])
def test_a_slider_crank_is_no_press_of_the_paper(joints: str) -> None:
    result = made_up(replace(slider_crank(), joints=joints), 1)
    sentences = [*notes(result), *(drawing.caption for drawing in drawings(result))]
    assert any("from memory and not checked against a page" in text for text in sentences)
    assert not [text for text in sentences if re.search(r"\b(press|paper|crank 2)\b", text)]
    table = next(text for text in sentences if "Chosen or assumed are gravity, " in text)
    assert ", clearance," not in table
    assert ", friction," in table


def test_every_setting_is_listed_with_its_origin() -> None:
    page = page_of(made_up(BOTH, 1))
    listed = {(row[0], row[-1]) for row in page.rows if row}
    assert {(setting.key, setting.meaning.text) for setting in settings_of(BOTH)} <= listed
    assert page.row("clearance")[1:4] == ["0.0008", "m", "paper, per study"]


@pytest.mark.parametrize(
    ("conventions", "name"),
    [
        (CONVENTIONS["paper"], "the “paper” set"),
        (CONVENTIONS["refined"], "the “refined” set"),
        (replace(CONVENTIONS["paper"], slip="sliding"), "a set of its own"),
    ],
)
def test_conventions_are_named(conventions: Conventions, name: str) -> None:
    scene = replace(BOTH, conventions=conventions)
    assert name in page_of(made_up(scene, 1)).text


def test_provenance() -> None:
    page = page_of(made_up(BOTH, 1))
    assert page.row("source revision")[1] == "0123456789ab"
    assert page.row("steps")[1:] == ["4\u202f000"]
