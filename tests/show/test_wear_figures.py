"""Figures of wear, of worn surfaces and of a service life."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
import re
from typing import Any

import made_up_result as made
import numpy as np
import pytest
from drawn import legend_of, sheet_of
from made_up_result import altered, grown, lived, made_up, not_passed
from matplotlib.colors import to_rgba
from numpy.testing import assert_allclose

from presswear.linkage.surface import bin_centres
from presswear.show.figures import drawings
from presswear.show.figures.style import LINES
from presswear.show.figures.wear import seam


def test_depth_is_the_cumulative_total_in_microns():
    result = made_up(made.BOTH, 3)
    sheet = sheet_of("wear", result)
    assert legend_of(sheet) == [
        "first wear",
        "second wear",
        "third wear, not simulated",
    ]
    expected = 2e6 * result.stages[1].arrays["A_depth_bearing"]
    for k, line in enumerate(sheet.axes[0].get_lines(), start=1):
        assert_allclose(np.asarray(line.get_ydata()), k * expected)
    arrays = result.stages[2].arrays
    deeper = {**arrays, "A_depth_pin": 1e3 * arrays["A_depth_pin"]}
    at_a, at_c = sheet_of("wear", altered(result, 2, arrays=deeper)).axes
    assert (at_a.get_yscale(), at_c.get_yscale()) == ("log", "linear")


def lobe(centre: float) -> Any:
    """Groove around an angle, degrees; its depth at the bin centres, m."""
    away = np.angle(np.exp(1j * (bin_centres(made.BINS) - np.radians(centre))))
    return 1e-6 * np.exp(-((away / np.radians(25.0)) ** 2))


@pytest.mark.parametrize("centre", [0.0, 200.0, 345.0])
def test_a_lobe_is_never_cut_in_two(centre):
    angle = bin_centres(made.BINS)
    around = (centre - seam(angle, [lobe(centre), 3.0 * lobe(centre)])) % 360.0
    assert min(around, 360.0 - around) > 60.0
    result = made_up(made.BOTH, 2)
    worn = {
        **result.stages[1].arrays,
        "A_depth_pin": lobe(centre),
        "A_depth_bearing": lobe(centre),
    }
    axes = sheet_of(
        "wear", altered(result, 1, arrays={**worn, "A_wear_pin": 0.0 * angle})
    ).axes[0]
    low, high = axes.get_xlim()
    assert high - low == 360.0
    x, y = np.asarray(axes.get_lines()[0].get_xydata()).T
    assert np.all(np.diff(x) > 0.0)
    depth = 2e6 * lobe(centre)
    assert_allclose(y, np.interp(x, np.degrees(angle), depth, period=360.0), atol=1e-12)
    assert max(y[0], y[-1]) < 0.05 * depth.max()
    assert axes.xaxis.get_major_formatter()(540.0) == "180"
    for depths in ([], [np.zeros(made.BINS)], [np.ones(made.BINS)], [lobe(180.0)]):
        assert seam(angle, depths) == 0.0


@pytest.mark.parametrize(
    "scene", [made.BOTH, made.BODY], ids=["fixed maps", "maps on bodies"]
)
def test_profiles_are_drawn_to_the_stated_scale(scene):
    sheet = sheet_of("surfaces", made_up(scene, 3))
    bearings = scene.bearings
    radii = (bearings.bearing_radius, bearings.bearing_radius - bearings.clearance)
    for axes, radius in zip(sheet.axes[1:], radii, strict=True):
        low, high = axes.get_ylim()
        left, right = axes.get_xlim()
        box = axes.get_position()
        width, height = sheet.get_size_inches()
        radial = box.height * height / (1e-6 * (high - low))
        along = box.width * width / (np.radians(right - left) * radius)
        stated = re.search(r"radial scale ([\d\u202f]+) times", axes.get_title())
        assert radial / along == pytest.approx(float(stated[1].replace("\u202f", "")))
        depths = np.concatenate(
            [np.asarray(line.get_ydata()) for line in axes.get_lines()]
        )
        assert low <= depths.min()
        assert depths.max() <= high


def test_growth_runs_over_the_steps_after_a_stage():
    line = grown().plot("growth", stage=1)[0].get_lines()[0]
    assert np.asarray(line.get_xydata()).tolist() == [
        [k, k] for k in (3.0, 4.0, 5.0, 6.0)
    ]


def test_a_life_shows_every_quantity_with_its_limits():
    result = lived(made_up(made.BODY, 3))
    axes = [each for each in sheet_of("life", result).axes if each.axison]
    panels = {each.get_title(loc="left").replace("\n", " "): each for each in axes}
    assert {title: each.get_ylabel() for title, each in panels.items()} == {
        "depth of A": "(µm)",
        "worn volume of A": "(mm³)",
        "peak force of A": "(kN)",
        "depth of C: first": "(µm)",
        "worn volume of C": "(mm³)",
        "peak force of C": "(N)",
        "drift of bottom dead centre": "(µm)",
    }
    first = panels["depth of C: first"]
    curve, limit, life, service = (
        np.asarray(line.get_xydata()) for line in first.get_lines()
    )
    assert_allclose(curve, np.outer(made.STROKES, [1.0, 1e-11]))
    assert set(limit[:, 1]) == {5e-5}
    assert set(life[:, 0]) == {made.LIFE}
    assert set(service[:, 0]) == {2e6}
    colour = to_rgba(LINES[2][0])[:3]
    (span,) = [patch for patch in first.patches if patch.get_facecolor()[:3] == colour]
    ends = span.get_extents().transformed(first.transData.inverted())
    expected = made.LIFE * np.exp([-math.hypot(0.03, 0.04), math.hypot(0.03, 0.04)])
    assert (ends.x0, ends.x1) == pytest.approx(tuple(expected))
    words = {
        title: [text.get_text() for text in each.texts]
        for title, each in panels.items()
    }
    assert words["worn volume of A"] == ["replaced"]
    assert words["drift of bottom dead centre"] == ["limit 2 mm"]
    (open_end,) = drawings(lived(result, not_passed()), ["life"])
    assert "life with its interval" not in legend_of(open_end.sheet)
    assert "No limit is exceeded within 5 million strokes." in open_end.caption
    stages = ["after 2.5 million strokes", "after 5 million strokes"]
    assert legend_of(sheet_of("wear", result)) == stages
