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

from presswear.results.result import Result
from presswear.show.figures import drawings
from presswear.show.figures.style import LINES
from presswear.tools.errors import InputError

RESULT = lived(made_up(BODY, 3))
MINUTE = 60.0 / RESULT.scene.mechanism.period


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


def test_stages_of_a_life_are_named_by_strokes() -> None:
    names = ["no wear", "after 2.5 million strokes", "after 5 million strokes"]
    assert legend_of(next(drawings(RESULT, ["wear"])).sheet) == names[1:]
    assert list(RESULT.table().index) == names
    for name in names:
        assert f"\n{name} " in str(RESULT)
    assert [RESULT.stage_name(k) for k in range(3)] == names
    assert made_up(BODY, 3).stage_name(2) == "second wear"


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
