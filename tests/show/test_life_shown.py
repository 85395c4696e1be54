"""A made-up life in figures and report."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from made_up_life import LIFE, STROKES, lived, made_up_life, not_passed
from made_up_result import BODY, legend_of, made_up
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from test_report import Page, page_of

from presswear.results.life import Ended, LifeResult
from presswear.results.result import Result
from presswear.show.figures import drawings
from presswear.show.figures.style import LINES
from presswear.show.report import notes, render, words_of
from presswear.show.report.life import answer, life_head
from presswear.show.report.page import Illustration
from presswear.tools.errors import InputError

RESULT = lived(made_up(BODY, 3))
MINUTE = 60.0 / RESULT.scene.mechanism.period


@pytest.fixture(scope="module")
def page() -> Page:
    """The report."""
    return page_of(RESULT)


def told(life: LifeResult) -> str:
    """The answer on a life."""
    return answer(RESULT.scene, life)


def panels(result: Result = RESULT) -> dict[str, Axes]:
    """Panels of the figure by their titles."""
    (drawing,) = drawings(result, ["life"])
    drawing.sheet.draw_without_rendering()
    axes = [own for own in drawing.sheet.axes if own.axison]
    return {own.get_title(loc="left").replace("\n", " "): own for own in axes}


def test_every_followed_number_has_a_panel_in_its_unit() -> None:
    found = {title: own.get_ylabel() for title, own in panels().items()}
    assert found == {
        "depth of A": "(µm)",
        "worn volume of A": "(mm³)",
        "peak force of A": "(kN)",
        "depth of C: first": "(µm)",
        "worn volume of C": "(mm³)",
        "peak force of C": "(N)",
        "drift of bottom dead centre": "(µm)",
    }
    labels = {own.get_xlabel() for own in panels().values()}
    assert labels == {"", "(million strokes)"}


def test_curve_band_limit_and_life_stand_where_they_are() -> None:
    axes = panels()["depth of C: first"]
    curve, limit, life, service = axes.get_lines()
    np.testing.assert_allclose(
        np.asarray(curve.get_xydata()), 10.0 * np.outer(STROKES, [1e-7, 1e-6])
    )
    assert set(np.asarray(limit.get_ydata())) == {50.0}
    assert set(np.asarray(life.get_xdata())) == {1e-6 * LIFE}
    assert set(np.asarray(service.get_xdata())) == {2.0}
    band = axes.collections[0].get_paths()[0].vertices
    assert np.asarray(band)[:, 1].max() == pytest.approx(66.0)
    (span,) = [own for own in axes.patches if own.get_facecolor()[:3] == to_rgba(LINES[2][0])[:3]]
    error = math.hypot(0.03, 0.04)
    ends = span.get_extents().transformed(axes.transData.inverted())
    expected = 1e-6 * LIFE * np.exp([-error, error])
    assert (ends.x0, ends.x1) == pytest.approx(tuple(expected))


def test_phases_are_named_and_services_told_at_their_joint() -> None:
    found = panels()
    words = {title: [text.get_text() for text in own.texts] for title, own in found.items()}
    assert words["worn volume of A"] == ["replaced", "running-in", "steady"]
    assert words["worn volume of C"] == ["steady"]
    assert words["depth of C: first"] == []  # that at seven million strokes is not reached
    assert words["drift of bottom dead centre"] == ["limit 2 mm"]


def test_the_figure_of_a_life_that_no_limit_ended_tells_none() -> None:
    result = lived(made_up(BODY, 3), not_passed())
    (drawing,) = drawings(result, ["life"])
    assert "life with its interval" in legend_of(next(drawings(RESULT, ["life"])).sheet)
    assert "life with its interval" not in legend_of(drawing.sheet)
    assert "No limit is passed within 5 million strokes." in drawing.caption
    assert not [title for title in panels(result) if "first" in title]
    with pytest.raises(InputError, match="nothing to draw as 'life'"):
        list(drawings(made_up(BODY, 1), ["life"]))


def test_stages_of_a_life_are_named_by_strokes(page: Page) -> None:
    names = ["no wear", "after 2.5 million strokes", "after 5 million strokes"]
    assert legend_of(next(drawings(RESULT, ["wear"])).sheet) == names[1:]
    assert page.row("bottom dead centre") == ["bottom dead centre", *names]
    assert list(RESULT.table().index) == names
    for name in names:
        assert f"\n{name} " in str(RESULT)
    assert [RESULT.stage_name(k) for k in range(3)] == names
    assert made_up(BODY, 3).stage_name(2) == "second wear"


def test_the_answer_is_a_sentence() -> None:
    hours = round(LIFE / MINUTE / 60.0, -1)  # to as many digits as the life
    assert told(made_up_life()) == (
        "The first limit, depth of C over 50 µm, is passed after 5 million strokes (4.8 to 5.3 "
        f"million), {hours:.0f} hours at {MINUTE:.0f} strokes a minute. The wear coefficient "
        "itself scatters by 50 %: with that, 3 to 8.3 million strokes."
    )
    assert str(made_up_life()) == (
        "life: 5 million strokes (4.8 to 5.3 million) until depth of C is over 5e-05 m; "
        "3 to 8.3 million with the scatter of the wear coefficient"
    )
    finer = told(made_up_life(0.003, 0.004))
    assert "after 5 million strokes (4.98 to 5.03 million)" in finer
    assert "how well that is known cannot be told" in told(made_up_life(None, 0.1))


@pytest.mark.parametrize(
    ("ended", "message", "line"),
    [
        ("at_most", "", "life.at_most"),
        ("worn", "A: worn through", "There the model ends: A: worn through."),
        ("cycles", "", "life.max_cycles"),
    ],
)
def test_a_life_that_is_not_known_is_never_guessed(ended: Ended, message: str, line: str) -> None:
    life = not_passed(ended, message)
    assert told(life).startswith("No limit is passed within 5 million strokes, ")
    assert "depth of A 25.0 of 50 µm" in told(life)
    head = life_head(lived(made_up(BODY, 3), life))
    assert head is not None
    assert any(line in own for own in head.lines)
    assert head.causes is None
    assert {row[1] for row in head.limits.groups[0][1]} == {"not passed"}


def test_causes_stand_apart(page: Page) -> None:
    chance = f"chance in the motion: {RESULT.scene.draws} starts differ"
    assert page.row(chance)[1:] == ["3.0", "4.85 to 5.15 million"]
    step = "step of the wear, by passes in coarser steps"
    assert page.row(step)[1:] == ["4.1", "4.8 to 5.2 million"]
    assert page.row("scatter of the wear coefficients")[1:] == ["65", "3 to 8.2 million"]
    assert page.row("all together")[1:] == ["65", "3 to 8.3 million"]


def test_limits_passes_and_phases_are_tabled(page: Page) -> None:
    passed = page.row("depth of C over 50 µm")
    assert passed[1:3] == ["5 million", "4.8 to 5.3 million"]
    assert passed[4] == "60.0\u00a0± 3.0 µm"
    assert page.row("depth of A over 50 µm")[1:] == ["not passed", "–", "–", "20.0\u00a0± 1.0 µm"]
    assert page.row("A: running-in")[1:] == ["0 to 2 million", "3.00\u00a0± 0.20"]
    assert page.row("2")[1:] == ["0.100", "320", "5 million", "3.0"]
    assert "After 2 million strokes: bush of A replaced." in page.text


def test_a_limit_that_may_be_the_first_is_named() -> None:
    life = made_up_life()
    near = replace(life.limits[0], strokes=5.4e6, sampling=0.05, step=0.0)
    far = replace(near, strokes=7e6)
    for other, is_told in ((near, True), (far, False)):
        own = replace(life, limits=(other, *life.limits[1:]))
        head = life_head(lived(made_up(BODY, 3), own))
        assert head is not None
        found = " ".join(head.lines)
        assert ("the interval of depth of A begins before that" in found) == is_told


def test_the_life_comes_first_and_only_where_there_is_one() -> None:
    figure = Illustration("life.png", "Service life", "All.", "")
    page = Page(render(words_of(RESULT), [figure]))
    words = [word for word in page.words if word in ("How long it lasts", "At a glance")]
    assert words == ["How long it lasts", "At a glance"]
    assert page.words.count("Service life") == 1
    assert "How long it lasts" not in page_of(made_up(BODY, 3)).text
    assert any(
        "a wear from one to the next is of 2.5 million strokes" in own for own in notes(RESULT)
    )


def test_long_names_of_stages_stay_inside_the_figure() -> None:
    """Legends break into rows, titles of narrow panels into lines."""
    life = replace(made_up_life(), strokes=8.88e6)
    many = lived(made_up(BODY, 5), life)
    many = replace(many, scene=replace(many.scene, wear_updates=4))
    for name in ("path", "response", "surfaces", "bottom"):
        sheet = next(drawings(many, [name])).sheet
        sheet.draw_without_rendering()
        for own in sheet.legends:
            box = own.get_window_extent()
            assert 0.0 <= box.x0 < box.x1 <= sheet.bbox.width
        titles = [axes.title.get_window_extent() for axes in sheet.axes if axes.get_title()]
        assert not [pair for pair in combinations(titles, 2) if pair[0].overlaps(pair[1])]
