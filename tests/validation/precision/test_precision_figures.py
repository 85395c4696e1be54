"""Pictures of a study of speed against error, of made-up numbers."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure as Sheet
from matplotlib.text import Text

from precision.made_up_precision import DEFAULTS, chaos, diagram, precision, wear
from presswear.show.figures.style import Drawing
from presswear.validation.precision.figures import precision_drawings
from presswear.validation.precision.figures.panels import LOOKS, look_of


@pytest.fixture(scope="module")
def drawn() -> dict[str, Drawing]:
    return {drawing.file: drawing for drawing in precision_drawings(precision())}


def values(data: Any) -> list[float]:
    """Data of a line as numbers."""
    return [float(value) for value in np.ravel(data)]


def texts(sheet: Sheet) -> list[Text]:
    """All that is written on a sheet."""
    found = (text for text in sheet.findobj(Text) if isinstance(text, Text))
    return [text for text in found if text.get_text()]


def test_everything_that_was_run_is_drawn(drawn: dict[str, Drawing]) -> None:
    names = ["ideal", "horizon", "orders", "energy", "growth", "statistics", "wear", "contact"]
    assert list(drawn) == [f"precision-{name}.png" for name in names]
    assert all(drawing.title and drawing.caption for drawing in drawn.values())


def test_errors_over_wall_times(drawn: dict[str, Drawing]) -> None:
    """The curve of a family holds its medians and errors; bars go from least to greatest."""
    axes = drawn["precision-horizon.png"].sheet.axes[0]
    tree = [p for p in diagram().points if p.method.engine.word == "exudyn-tree"]
    look = look_of("exudyn-tree, DOPRI5")
    containers: list[Any] = list(axes.containers)
    bars = next(c for c in containers if c.lines[0].get_color() == look.colour)
    x, y = np.asarray(bars.lines[0].get_data(), dtype=float)
    assert x == pytest.approx([1e3 * p.timing.wall for p in tree if p.timing])
    assert y == pytest.approx([p.errors["slider position"] for p in tree])
    ends = np.array([segment[:, 0] for segment in bars.lines[2][0].get_segments()])
    assert ends == pytest.approx(
        np.array([[1e3 * t for t in p.timing.ends] for p in tree if p.timing])
    )


def test_failures_and_the_paper_are_in_every_panel(drawn: dict[str, Drawing]) -> None:
    for name in ("ideal", "horizon", "orders", "statistics"):
        sheet = drawn[f"precision-{name}.png"].sheet
        panels = [axes for axes in sheet.axes if axes.axison]
        assert panels
        for axes in panels:
            marks = [line.get_gid() for line in axes.lines]
            assert marks.count("paper") == 1, name
            if name != "statistics":
                assert marks.count("failed") == 2
    assert "exudyn-joints, trapezoidal rule, steps in an impact 20" in (
        drawn["precision-horizon.png"].caption
    )
    for name in ("growth", "energy"):
        sheet = drawn[f"precision-{name}.png"].sheet
        assert any(line.get_gid() == "paper" for axes in sheet.axes for line in axes.lines), name
    assert "foundation: stage 1: it blew up" in drawn["precision-contact.png"].caption


def marks(drawing: Drawing, gid: str) -> list[tuple[float, float]]:
    """Places of marks of a kind in the first panel."""
    found = (line for line in drawing.sheet.axes[0].lines if line.get_gid() == gid)
    return [(values(line.get_xdata())[0], values(line.get_ydata())[0]) for line in found]


def test_the_paper_has_its_mark_where_it_ran() -> None:
    found = diagram()
    like = found.points[0]
    points = [replace(like, method=p.method) if p.method.is_paper else p for p in found.points]
    study = replace(precision(), diagrams=(replace(found, points=tuple(points)),))
    assert like.timing is not None
    (place,) = marks(next(precision_drawings(study)), "paper")
    assert place == pytest.approx((1e3 * like.timing.wall, like.errors["slider position"]))


def test_defaults_are_ringed(drawn: dict[str, Drawing]) -> None:
    errors = {p.method.label: p.errors.get("slider position") for p in diagram().points}
    rings = {y for _, y in marks(drawn["precision-horizon.png"], "default")}
    assert rings == {errors[label] for label in DEFAULTS}


def test_error_of_the_reference_is_a_line(drawn: dict[str, Drawing]) -> None:
    axes = drawn["precision-horizon.png"].sheet.axes[0]
    flat = [line for line in axes.lines if values(line.get_ydata()) == [1e-8, 1e-8]]
    assert len(flat) == 1
    energy = drawn["precision-horizon.png"].sheet.axes[2]
    assert not [line for line in energy.lines if values(line.get_xdata()) == [0, 1]]


def test_orders_stand_at_their_curves(drawn: dict[str, Drawing]) -> None:
    """Errors go as tolerance, steps as its fifth root: order 5; RK4 as it was made.

    Around contacts what is error-controlled has none.
    """
    smooth, contacts = drawn["precision-orders.png"].sheet.axes[:2]
    assert "5.0" in {text.get_text() for text in smooth.texts}
    found = {text.get_text() for text in contacts.texts}
    assert "4.0" in found
    assert "5.0" not in found


def test_families_differ_in_colour_dashes_and_marker() -> None:
    for part in ("colour", "marker", "dashes"):
        values = [getattr(look, part) for look in LOOKS]
        assert len(set(values)) == len(values)
    # Also for those who see no colours.
    grey = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in (to_rgb(k.colour) for k in LOOKS)]
    assert max(grey) < 0.75
    assert look_of("dae, RK4") == look_of("dae, RK4") != look_of("dae, DOPRI5")


def test_growth_is_drawn_with_its_fit(drawn: dict[str, Drawing]) -> None:
    (axes,) = drawn["precision-growth.png"].sheet.axes
    growth = chaos().growth
    (curve,) = (line for line in axes.lines if len(values(line.get_xdata())) == len(growth.time))
    assert values(curve.get_ydata()) == pytest.approx(list(growth.distance))
    fits = [
        line
        for line in axes.lines
        if 10 < len(values(line.get_xdata())) < len(growth.time) and line.get_linestyle() == "--"
    ]
    assert len(fits) == 1
    x, y = (np.asarray(part, dtype=float) for part in fits[0].get_data())
    assert float(np.polyfit(x, np.log(y), 1)[0]) == pytest.approx(growth.rate)


def test_honest_settings_are_filled(drawn: dict[str, Drawing]) -> None:
    sheet = drawn["precision-statistics.png"].sheet
    found = chaos()
    honest = sum(found.is_honest(point) for point in found.points)
    ran = sum(not point.failure for point in found.points)
    for axes in sheet.axes:
        marks = [line.get_gid() for line in axes.lines]
        assert marks.count("honest") == honest
        assert marks.count("open") == ran - honest
    best = found.cheapest()
    assert best is not None
    for axes in sheet.axes:
        ends = [(values(line.get_xdata()), values(line.get_ydata())) for line in axes.lines]
        assert ends.count(([best.cost, best.cost], [0.0, 1.0])) == 1


def test_sampling_error_of_a_stage_is_the_band(drawn: dict[str, Drawing]) -> None:
    axes = drawn["precision-statistics.png"].sheet.axes[0]
    # 2 % from 100 cycles is 5 % from 16.
    edge = 100.0 * 0.02 * math.sqrt(100 / 16)
    assert [edge, edge] in [pytest.approx(values(line.get_ydata())) for line in axes.lines]


def test_wear_in_parts_of_the_finest(drawn: dict[str, Drawing]) -> None:
    sheet = drawn["precision-wear.png"].sheet
    axes = sheet.axes[0]
    containers: list[Any] = list(axes.containers)
    curves = {c.lines[0].get_color(): values(c.lines[0].get_ydata()) for c in containers}
    assert curves[LOOKS[0].colour] == pytest.approx([16.0, 4.0, 1.0])
    assert curves[LOOKS[2].colour] == pytest.approx([1.0, 1.0, 1.0])
    assert {"90", "360", "1440", "200"} <= {text.get_text() for text in texts(sheet)}


def test_a_wear_that_failed_throughout_is_no_picture() -> None:
    found = wear()
    failed = tuple(replace(p, first={}, second={}, failure="no") for p in found.points)
    study = replace(precision(), wear=replace(found, points=failed))
    files = [drawing.file for drawing in precision_drawings(study)]
    assert "precision-wear.png" not in files


def test_text_is_large_enough(drawn: dict[str, Drawing]) -> None:
    for drawing in drawn.values():
        drawing.sheet.draw_without_rendering()
        # Powers are set smaller than their labels.
        assert min(float(text.get_fontsize()) for text in texts(drawing.sheet)) >= 5.5
        assert drawing.sheet.get_figwidth() == 7.0
