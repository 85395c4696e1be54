"""Figures of wear: maps, worn surfaces, growth."""

import re
from typing import Any

import numpy as np
import pytest
from made_up_result import BINS, BODY, BOTH, altered, grown, legend_of, made_up, sheet_of

from presswear.linkage.surface import bin_centres
from presswear.scene.scene import Scene
from presswear.show.figures import drawings
from presswear.show.figures.wear import seam


def test_wear_that_did_not_happen_is_named_so() -> None:
    assert legend_of(sheet_of("wear", made_up(BOTH, 3))) == [
        "first wear",
        "second wear",
        "third wear, not run",
    ]


def test_failed_stage_says_nothing_of_further_wear() -> None:
    sheet = sheet_of("wear", made_up(BOTH, 2, status="failed"))
    assert legend_of(sheet) == ["first wear"]


def test_depth_is_the_cumulative_total_in_microns() -> None:
    result = made_up(BOTH, 3)
    first, second, further = sheet_of("wear", result).axes[0].get_lines()
    expected = 2e6 * result.stages[1].arrays["A_depth_bearing"]
    np.testing.assert_allclose(np.asarray(first.get_ydata()), expected)
    np.testing.assert_allclose(np.asarray(second.get_ydata()), 2.0 * expected)
    np.testing.assert_allclose(np.asarray(further.get_ydata()), 3.0 * expected)


def lobe(centre: float) -> Any:
    """A groove of some width around an angle, degrees; its depth at the middles of bins, m."""
    away = np.angle(np.exp(1j * (bin_centres(BINS) - np.radians(centre))))
    return 1e-6 * np.exp(-((away / np.radians(25.0)) ** 2))


@pytest.mark.parametrize("centre", [0.0, 20.0, 100.0, 200.0, 345.0])
def test_a_lobe_is_never_cut_in_two(centre: float) -> None:
    angle = bin_centres(BINS)
    begin = seam(angle, [lobe(centre), 3.0 * lobe(centre)])
    assert begin % 10.0 == 0.0
    around = (centre - begin) % 360.0
    assert min(around, 360.0 - around) > 60.0
    result = made_up(BOTH, 2)
    worn = {**result.stages[1].arrays, "A_depth_pin": lobe(centre), "A_depth_bearing": lobe(centre)}
    axes = sheet_of("wear", altered(result, 1, arrays={**worn, "A_wear_pin": 0.0 * angle})).axes[0]
    low, high = axes.get_xlim()
    assert high - low == 360.0
    line = axes.get_lines()[0]
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert np.all(np.diff(x) > 0.0)
    depth = 2e6 * lobe(centre)
    np.testing.assert_allclose(y, np.interp(x, np.degrees(angle), depth, period=360.0), atol=1e-12)
    assert max(y[0], y[-1]) < 0.05 * depth.max()
    label = axes.xaxis.get_major_formatter()
    assert label(540.0) == "180"


def test_where_nothing_or_everything_is_worn_an_axis_begins_as_ever() -> None:
    angle = bin_centres(BINS)
    for depths in ([], [np.zeros(BINS)], [np.ones(BINS)], [lobe(180.0)]):
        assert seam(angle, depths) == 0.0
    # No place is unworn: the one that is worn least.
    assert seam(angle, [1e-6 + lobe(0.0)]) == pytest.approx(180.0, abs=10.0)


def test_very_different_depths_share_a_logarithmic_scale() -> None:
    result = made_up(BOTH, 3)
    arrays = result.stages[2].arrays
    deeper = {**arrays, "A_depth_pin": 1e3 * arrays["A_depth_pin"]}
    at_a, at_c = sheet_of("wear", altered(result, 2, arrays=deeper)).axes
    assert (at_a.get_yscale(), at_c.get_yscale()) == ("log", "linear")


@pytest.mark.parametrize("scene", [BOTH, BODY], ids=["fixed maps", "maps on bodies"])
def test_profile_is_drawn_to_the_stated_scale(scene: Scene) -> None:
    sheet = sheet_of("surfaces", made_up(scene, 3))
    bearings = scene.bearings
    radii = (bearings.bearing_radius, bearings.bearing_radius - bearings.clearance)
    for axes, radius in zip(sheet.axes[1:], radii, strict=True):
        (low, high), (left, right) = axes.get_ylim(), axes.get_xlim()
        box = axes.get_position()
        width, height = sheet.get_size_inches()
        radial = box.height * height / (1e-6 * (high - low))
        along = box.width * width / (np.radians(right - left) * radius)
        stated = re.search(r"radial scale ([\d\u202f]+) times", axes.get_title())
        assert stated is not None
        assert radial / along == pytest.approx(float(stated[1].replace("\u202f", "")))
        depths = np.concatenate([np.asarray(line.get_ydata()) for line in axes.get_lines()])
        assert low <= depths.min()
        assert depths.max() <= high


def test_unworn_surfaces_are_not_called_worn() -> None:
    """What the path's caption says of surfaces that turn is of worn ones only."""
    unworn, worn = (next(drawings(made_up(BODY, stages), ["path"])).caption for stages in (1, 2))
    assert "Worn surfaces turn" not in unworn
    assert "Worn surfaces turn" in worn


def test_many_stages_are_thinned_out() -> None:
    result = made_up(BOTH, 9)
    assert len(sheet_of("path", result).axes) == 2 * 5
    assert legend_of(sheet_of("response", result))[-1] == "eighth wear"


def test_growth_runs_over_all_steps_or_those_after_a_stage() -> None:
    whole, after = (grown().plot("growth", stage=stage)[0].get_lines()[0] for stage in (None, 1))
    assert np.asarray(whole.get_xydata()).tolist() == [[k, k] for k in map(float, range(7))]
    assert np.asarray(after.get_xydata()).tolist() == [[k, k] for k in (3.0, 4.0, 5.0, 6.0)]
