"""Pictures of made-up sweeps: what is drawn, and that it can be read."""

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from made_up_sweep import swept
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PathCollection
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from presswear.recording.statistics import Estimate
from presswear.show.figures.style import SETTINGS, Drawing
from presswear.sweeps.analysis import Analysis, analysed
from presswear.sweeps.designs import design
from presswear.sweeps.distributions import Distribution, parse
from presswear.sweeps.figures import (
    curves,
    distribution,
    effects,
    heat_map,
    parallel,
    sections,
    shares,
    tornado,
)
from presswear.sweeps.figures.scales import Scale
from presswear.sweeps.inputs import Inputs
from presswear.sweeps.responses import responses
from presswear.sweeps.spread import Required, spread_of_rows
from presswear.sweeps.table import Column, Table
from presswear.tools.arrays import Array
from presswear.tools.quantities import Quantity

FACTORS = (
    Column("clearance", "m", "clearance"),
    Column("A.friction", "", "friction coefficient at A"),
    Column("A.a_wear_coefficient_with_a_long_name", "1/Pa", "wear coefficient at A"),
)
LIFE = Column("life", "", "strokes until the first limit")
SPREADS: dict[str, Distribution] = {
    FACTORS[0].key: parse("0.2mm:1mm", "clearance", Quantity("m", 0.0, 1.0, "", "")),
    FACTORS[1].key: parse("normal(0.1, 0.02)", "friction", Quantity("", 0.0, 1.0, "", "")),
    FACTORS[2].key: parse("lognormal(1e-15/Pa, 50%)", "k", Quantity("1/Pa", 0.0, 1.0, "", "")),
}
REQUIRED = Required(2e6, True)


def life(points: Array) -> Array:
    x, y, z = points.T
    return np.asarray(5e6 * (1e-15 / z) * (0.6e-3 / x) ** 0.8 * (1.0 - 2.0 * y))


def table(kind: str, size: int, draws: int = 2) -> Table:
    cube = design(kind, size, 3, seed=1)
    points = np.column_stack([own.at(u) for own, u in zip(SPREADS.values(), cube.T, strict=True)])
    found = swept(points, life(points), draws=draws)
    found.values[:] *= np.exp(0.1 * np.random.default_rng(1).standard_normal(found.values.shape))
    return replace(found, factors=FACTORS, measures=(LIFE,))


def of(kind: str, size: int) -> Analysis:
    return analysed(table(kind, size), "life", kind, SPREADS, REQUIRED)


@pytest.fixture(scope="module")
def sample() -> Analysis:
    own = table("sobol", 64)
    own.values[[6, 7]] = np.nan
    own.is_beyond[np.nan_to_num(own.values) > 1.2e7] = True
    return analysed(own, "life", "sobol", SPREADS, REQUIRED)


def drawn(make: Callable[[], Drawing | None]) -> Drawing:
    with matplotlib.rc_context(SETTINGS):
        found = make()
        assert found is not None
        found.sheet.set_canvas(FigureCanvasAgg(found.sheet))
        found.sheet.draw_without_rendering()
    return found


def widths(found: Drawing) -> list[float]:
    patches = found.sheet.axes[0].patches
    return [own.get_width() for own in patches if isinstance(own, Rectangle)]


def is_legible(found: Drawing) -> None:
    """Texts of each axes lie apart and inside of the figure."""
    inside = found.sheet.bbox.padded(2.0)
    for axes in found.sheet.axes:
        ticks = [*axes.get_xticklabels(), *axes.get_yticklabels()]
        # Ticks beyond the limits are kept, and not drawn.
        texts: list[Text] = [axes.xaxis.label, axes.yaxis.label, *axes.texts]
        for tick in ticks:
            x, y = axes.transData.transform(tick.get_position())
            is_x = tick in axes.get_xticklabels()
            low, high = (axes.bbox.x0, axes.bbox.x1) if is_x else (axes.bbox.y0, axes.bbox.y1)
            if low - 1.0 <= (x if is_x else y) <= high + 1.0:
                texts.append(tick)
        boxes = [own.get_window_extent() for own in texts if own.get_text() and own.get_visible()]
        for box in boxes:
            assert inside.containsx(box.x0), found.file
            assert inside.containsx(box.x1), found.file
        for first, second in combinations(boxes, 2):
            assert not first.padded(-1.0).overlaps(second.padded(-1.0)), found.file


def test_a_sample_can_be_read(sample: Analysis) -> None:
    assert sample.surface is not None
    assert sample.spread is not None
    assert sample.indices is not None
    surface, spread, indices = sample.surface, sample.spread, sample.indices
    own = sample.own
    for make in (
        lambda: heat_map(own, (0, 2), surface),
        lambda: heat_map(own, (0, 1), None),
        lambda: parallel(own),
        lambda: sections(surface),
        lambda: shares(own, indices),
        lambda: distribution(own, spread, REQUIRED, sample.rows),
    ):
        found = drawn(make)
        is_legible(found)
        assert found.caption.endswith(".")


def test_a_map_has_every_run_on_it(sample: Analysis) -> None:
    found = drawn(lambda: heat_map(sample.own, (0, 1), sample.surface))
    axes = found.sheet.axes[0]
    points = [own for own in axes.collections if isinstance(own, PathCollection)]
    counts = [len(np.asarray(own.get_offsets())) for own in points]
    failed = int(np.count_nonzero(~sample.own.has_value))
    bounds = int(np.count_nonzero(sample.own.is_beyond))
    assert failed == 1
    assert bounds > 0
    assert counts == [64 - failed - bounds, bounds, failed]
    assert np.ravel(np.asarray(points[0].get_array())) == pytest.approx(
        sample.own.means[sample.own.has_value & ~sample.own.is_beyond] / 1e6
    )
    assert found.sheet.axes[1].get_ylabel() == "life (10⁶)"
    assert axes.get_xlabel() == "clearance (µm)"
    assert "A.a_wear_coefficient_with_a_long_name = " in found.caption


def test_the_strongest_stands_at_the_top_of_a_tornado() -> None:
    found = of("one", 1)
    swings = found.swings
    assert swings is not None
    picture = drawn(lambda: tornado(found.own, swings))
    is_legible(picture)
    axes = picture.sheet.axes[0]
    names = [own.get_text().replace("\n", " ") for own in axes.get_yticklabels()]
    assert names == ["A.a wear coefficient with a long name", "clearance", "A.friction"]
    told = [swings[k] for k in (2, 0, 1)]
    expected = [end.mean for one in told if one for end in (one.at_low, one.at_high)]
    assert widths(picture) == pytest.approx(np.array(expected) / 1e6)
    assert {own.get_text() for own in axes.texts} >= {"240 µm", "960 µm", "0.0671", "0.133"}


def test_effects_and_blocks_can_be_read() -> None:
    paths, blocks = of("morris", 10), of("saltelli", 16)
    screening, indices = paths.screening, blocks.indices
    assert screening is not None
    assert indices is not None
    is_legible(drawn(lambda: effects(paths.own, screening)))
    picture = drawn(lambda: shares(blocks.own, indices))
    is_legible(picture)
    bars = widths(picture)
    assert len(bars) == 2 * 3 + 1
    assert indices.chaos is not None
    assert bars[-1] == pytest.approx(indices.chaos.mean)


def grid(halves: Array | None = None, draws: int = 3) -> Table:
    points = np.array([[x, y] for x in np.linspace(2e-4, 1e-3, 5) for y in (0.02, 0.05, 0.1)])
    values = 100.0 + 1e5 * points[:, 0] * (1.0 + points[:, 1])
    found = swept(points, values, draws=draws, noise=5.0, halves=halves)
    return replace(found, factors=FACTORS[:2], measures=(Column("C.force_max", "N", "peak"),))


def test_a_grid_has_a_line_for_each_value_of_the_other_factor() -> None:
    own = responses(grid(), "C.force_max")
    found = drawn(lambda: curves(own))
    is_legible(found)
    axes = found.sheet.axes[0]
    assert len(axes.lines) == len(axes.collections) == 3
    assert axes.get_ylabel() == "C.force_max (N)"
    labels = [text.get_text() for text in found.sheet.legends[0].get_texts()]
    assert labels == ["A.friction = 0.0200", "A.friction = 0.0500", "A.friction = 0.100"]
    for line, value in zip(axes.lines, (0.02, 0.05, 0.1), strict=True):
        rows = own.points[:, 1] == value
        assert np.asarray(line.get_ydata()) == pytest.approx(own.means[rows])
        assert np.asarray(line.get_xdata()) == pytest.approx(1e3 * own.points[rows, 0])
    assert "draws" in found.caption


def test_bands_of_lines_are_the_intervals_that_runs_tell() -> None:
    own = responses(grid(np.full(15, 7.0), draws=1), "C.force_max")
    found = drawn(lambda: curves(own))
    path = found.sheet.axes[0].collections[0].get_paths()[0].vertices
    first = np.asarray(path)[np.isclose(np.asarray(path)[:, 0], 0.2), 1]
    assert first.max() - first.min() == pytest.approx(14.0)
    assert "that the runs tell" in found.caption


def test_what_is_no_grid_has_no_lines(sample: Analysis) -> None:
    assert curves(sample.own) is None


def test_the_distribution_shows_what_is_told_of_it(sample: Analysis) -> None:
    assert sample.spread is not None
    spread = sample.spread
    axes = drawn(lambda: distribution(sample.own, spread, REQUIRED, None)).sheet.axes[0]
    curve, interval, point, required = axes.lines
    assert np.asarray(curve.get_xdata()) == pytest.approx(spread.values / 1e6)
    five = spread.quantile(5)
    assert five.low is not None
    assert np.asarray(interval.get_xdata()) == pytest.approx(
        [five.low / 1e6, (five.high or 0) / 1e6]
    )
    assert np.asarray(point.get_xdata()) == pytest.approx([five.mean / 1e6])
    assert np.asarray(required.get_xdata()) == pytest.approx([2.0, 2.0])


@pytest.mark.parametrize(
    ("unit", "values", "label", "told"),
    [
        ("m", [2e-4, 1e-3], "k (mm)", "1.00 mm"),
        ("1/Pa", [1e-16, 2e-15], "k (10⁻¹⁵ 1/Pa)", "2.00·10⁻¹⁵ 1/Pa"),
        ("", [1e6, 2e7], "k (10⁶)", "20.0·10⁶"),
        ("", [0.02, 0.1], "k", "0.100"),
        ("m^3", [1e-9, 3e-9], "k (mm³)", "3.00 mm³"),
        ("", [0.0, 0.0], "k", "0"),
    ],
)
def test_units_read_well(unit: str, values: list[float], label: str, told: str) -> None:
    scale = Scale.of(Column("k", unit, ""), np.array(values))
    assert scale.label == label
    assert scale.told(values[-1]) == told


def test_an_end_that_is_not_known_lies_at_the_edge() -> None:
    rows = swept(np.arange(16.0)[:, None], np.arange(16.0), is_beyond=np.arange(16) > 12)
    found = spread_of_rows(rows, "y")
    assert found is not None
    assert np.isnan(found.low[0])
    assert np.isnan(found.high[-1])
    axes = drawn(lambda: distribution(responses(rows, "y"), found, None, None)).sheet.axes[0]
    (path,) = axes.collections[0].get_paths()
    x, y = np.asarray(path.vertices).T
    left, right = axes.get_xlim()
    assert left < 0.0
    assert right > 14.0
    assert (x.min(), x.max()) == (left, right)
    assert (y.min(), y.max()) == (1.0, 99.0)
    five = next(own for own in axes.lines if np.all(np.asarray(own.get_ydata()) == 5.0))
    assert np.asarray(five.get_xdata())[0] == left


def test_two_values_are_no_logarithms() -> None:
    for pair in ([0.05, 0.1], [0.02, 0.05], [3e-4, 9e-4]):
        points = np.repeat(np.array(pair), 5)[:, None]
        assert not Inputs.of((Column("x", "", ""),), points).is_logarithmic.any()
    many = np.geomspace(1.0, 1e3, 7)[:, None]
    assert Inputs.of((Column("x", "", ""),), many).is_logarithmic.all()


def test_intervals_beyond_a_share_are_not_drawn() -> None:
    found = of("saltelli", 16)
    assert found.indices is not None
    wild = replace(found.indices, first=(Estimate(1.3, 0.5, 2.1),) * 3)
    picture = drawn(lambda: shares(found.own, wild))
    assert max(widths(picture)) <= 1.0
    lines = picture.sheet.axes[0].lines
    assert max(float(np.max(np.asarray(line.get_xdata()))) for line in lines) <= 1.0
