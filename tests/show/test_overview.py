"""The head of the report, of small made-up results and of a run."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_result import BOTH, IDEAL, ONE, altered, made_up
from test_report import Page, page_of

from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.process import Blanking
from presswear.recording.statistics import Estimate
from presswear.results.result import Result
from presswear.results.stage import StageResult, WearStep
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import press_blanking, wear_times
from presswear.scene.scene import Scene
from presswear.show.report import render, words_of
from presswear.show.report.moments import moments
from presswear.show.report.origin import changed_values
from presswear.show.report.overview import OPENING, compared, in_short
from presswear.show.report.page import Illustration


def head_of(result: Result) -> Page:
    """The part before the mechanics."""
    return Page(render(words_of(result), []).partition("<h2>Mechanics</h2>")[0])


def numbers(page: Page, label: str) -> list[str]:
    """Texts of a row behind its label and what that means."""
    return page.row(label)[2:]


def struck(stage: StageResult, joint: str, rows: list[int], force: float) -> StageResult:
    """The stage with some rows of a joint's force, and nothing else there."""
    forces = np.zeros_like(stage.joints[joint].force)
    forces[rows, 0] = force
    return replace(stage, arrays={**stage.arrays, f"{joint}_force": forces})


def test_new_and_worn_stand_side_by_side() -> None:
    step = WearStep(4e6, 2, 2e6, 0.1, {}, {}, 1.0)
    result = made_up(ONE, 3)
    for index in (0, 1):
        result = altered(result, index, wear_steps=(step,))
    page = head_of(result)
    assert page.rows[next(k for k, row in enumerate(page.rows) if row[:1] == ["no wear"])] == [
        *("no wear", "first wear", "second wear"),
    ]
    assert numbers(page, "strokes that the wear stands for") == [
        *("0", "4\u202f000\u202f000", "8\u202f000\u202f000"),
    ]
    assert numbers(page, "error of bottom dead centre (µm)") == [
        *("−760\u00a0± 30", "−860\u00a0± 30", "−960\u00a0± 30"),
    ]
    assert numbers(page, "the same, less that of the first stage (µm)") == [
        *("–", "−100\u00a0± 42", "−200\u00a0± 42"),
    ]
    assert numbers(page, "repeatability (µm)") == ["100 (too few strokes)"] * 3
    assert numbers(page, "largest joint force (N)") == ["100 at C", "101 at C", "102 at C"]
    assert page.row("total clearance at the slider (µm)")[1].endswith("100 N up and down")


def test_failed_stages_have_no_numbers_there() -> None:
    result = made_up(BOTH, 2, "failed", "no step")
    assert [stage.index for stage in compared(result)] == [0]
    assert "Not told here, since it failed: first wear." in in_short(result)
    alone = made_up(BOTH, 1, "failed", "no step")
    assert compared(alone) == ()
    assert "Nothing ran far enough for a number." in head_of(alone).text


def test_a_single_stroke_says_that_it_has_no_interval() -> None:
    result = made_up(ONE, 1)
    bdc = replace(
        result.stages[0].bdc, strokes=1, error=Estimate(-1e-4), range=None, range_strokes=1
    )
    statistics = replace(result.stages[0].statistics, bdc=bdc)
    page = head_of(altered(result, 0, statistics=statistics))
    assert numbers(page, "error of bottom dead centre (µm)") == ["−100 (too few cycles)"]
    assert numbers(page, "repeatability (µm)") == ["not known from 1 stroke"]
    assert "at a time" not in page.row("repeatability (µm)")[1]


@pytest.mark.parametrize("part", [0.25, 0.6])
def test_the_largest_force_is_told_with_its_moment(part: float) -> None:
    result = made_up(replace(ONE, wear_updates=0), 1)
    (stage,) = result.stages
    # The made-up run has two cycles, of which the second is settled.
    row = int((1.0 + part) * (stage.time.size - 1) / 2.0)
    struck_stage = struck(stage, "C", [row], 321.0)
    page = head_of(replace(result, stages=(struck_stage,)))
    angle = 360.0 * stage.time[row] / ONE.mechanism.period % 360.0
    assert numbers(page, "largest that was recorded (N)") == ["321 at C"]
    assert float(numbers(page, "its crank angle (degrees)")[0]) == pytest.approx(angle, abs=0.06)
    speed = ONE.ideal_slider(stage.time[row : row + 1])[0, 1]
    way = "up" if speed > 0.0 else "down"
    assert numbers(page, "its place in the stroke")[0].endswith(f"mm, going {way}")


def test_a_force_before_the_settled_cycles_is_not_the_largest() -> None:
    result = made_up(replace(ONE, wear_updates=0), 1)
    (stage,) = result.stages
    stage = struck(stage, "C", [50], 900.0)
    assert "900 at C" not in head_of(replace(result, stages=(stage,))).text


def test_moments_of_the_made_up_strokes() -> None:
    scene = replace(ONE, process=Blanking(), wear_updates=0)
    result = made_up(scene, 1)
    stage = replace(
        result.stages[0],
        arrays={**result.stages[0].arrays, "slider": scene.ideal_slider(result.stages[0].time)},
    )
    result = replace(result, stages=(stage,))
    table = moments(result)
    assert table is not None
    told = {heading: {row[0]: row[1] for row in rows} for heading, rows in table.groups}
    assert list(told) == ["Touches the work", "Breaks it", "Leaves it"]
    assert told["Breaks it"]["height over bottom dead centre (mm)"] == "4.500"
    touched = float(told["Touches the work"]["crank angle (degrees)"].split()[0])
    time = np.radians([touched]) / (2.0 * np.pi) * scene.mechanism.period
    place = scene.ideal.at(time).watched(scene.mechanism.linkage())[0]
    assert place[0] - scene.bottom == pytest.approx(5e-3, abs=2e-5)
    assert place[1] < 0.0
    assert moments(made_up(ONE, 1)) is None


def test_a_press_on_work_says_so_and_others_do_not() -> None:
    assert any(
        "presses on work (blanking" in text for text in in_short(made_up(press_blanking(), 1))
    )
    assert not any("work" in text for text in in_short(made_up(BOTH, 1)))


def test_a_linkage_of_ones_own_is_no_press() -> None:
    scene = Scene(FOUR_BAR, bearings={"B": Bearing(clearance=0.3e-3)}, wear_updates=0)
    result = replace(made_up(IDEAL, 1), scene=scene)
    text = " ".join([*in_short(result), changed_values(result)[0]])
    assert "The rocker moves between its lowest and its highest place, 111 mm apart" in text
    assert "from the defaults" in text
    assert "press" not in text
    assert "0.300 mm at B" in text


def test_without_clearance_nothing_is_said_of_errors() -> None:
    page = head_of(made_up(IDEAL, 1))
    assert "No joint has clearance" in page.text
    assert not [row for row in page.rows if row and "bottom dead centre" in row[0]]


def test_the_title_says_what_was_changed() -> None:
    page = page_of(made_up(wear_times(clearance="0.5 mm", wear_updates=1), 1))
    title = f"{wear_times().title}, changed: clearance 0.5 mm, wear updates 1"
    assert page.words.count(title) == 2
    assert page.row("clearance")[:4] == ["clearance", "0.5", "0.8", "mm"]
    assert wear_times().title not in page.words
    assert (
        "Nothing differs from the named scene wear-times." in page_of(made_up(wear_times(), 1)).text
    )


def test_the_opening_figures_stand_before_the_mechanics() -> None:
    some = [Illustration(file, file, "", "") for file in (*OPENING, "wear-depth.png")]
    head, _, rest = render(words_of(made_up(ONE, 1)), some).partition("<h2>Mechanics</h2>")
    assert all(f"<h3>{file}</h3>" in head for file in OPENING)
    assert "<h3>wear-depth.png</h3>" in rest
    assert "<h3>wear-depth.png</h3>" not in head
