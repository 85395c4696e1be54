"""Figures of small made-up results."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import made_up_result as made
import matplotlib
import matplotlib.pyplot as pyplot
import numpy as np
import pytest
from drawn import legend_of, sheet_of
from made_up_result import altered, grown, lived, made_up
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from numpy.testing import assert_allclose, assert_array_equal
from refusals import refused

import presswear as pw
from presswear.campaign.runs import run
from presswear.recording.columns import CYCLE, JOINT_CYCLE, names_of
from presswear.results.oil_film import oil_films
from presswear.results.rigid_joints import ideal_curves
from presswear.results.strokes import sampled_strokes
from presswear.scene.catalog import ideal
from presswear.scene.settings import changed
from presswear.show.figures import NAMES, drawings, save
from presswear.show.figures.style import Drawing, label_values, panels
from presswear.show.figures.vector import svg_of

UNIT = re.compile(
    r"^strokes |\((m|mm|µm|nm|s|N|m/s|m/s²|N m|W|degrees|strokes|%|orders|N²/Hz|\(m/s²\)²/Hz)\)"
)
# Figures for which the made-up results have no data
NOT_MADE_UP = ["life", "tonnage", "oil", "tilt", "corners", "walls", "motor", "frame"]
WORN = ["wear-depth.png", "worn-surface-A.png", "worn-surface-C.png"]
MOTION = [
    "response.png",
    "bottom-dead-centre.png",
    "contact-force.png",
    "centre-trajectory.png",
    "phase.png",
    "modes.png",
]


SEVEN = replace(made.BOTH, joints="O2,O7,A,B,C,D,E")


@pytest.fixture(scope="module")
def oiled():
    oil = {"viscosity": "0.1 Pa s", "clearance": "0.05 mm"}
    return made_up(changed(made.BOTH, oil), 1)


@pytest.mark.parametrize(
    ("result_of", "names"),
    [
        (lambda: lived(made_up(made.BODY, 2)), ()),  # all figures of two joints
        (grown, ["growth", "drives", "surfaces"]),
        (lambda: made_up(SEVEN, 2), ["wear", "force", "path", "modes"]),
        (lambda: made_up(made.BOTH, 9), ["wear", "response", "path"]),  # legends
    ],
)
def test_panels_with_their_labels_fit_beside_each_other(result_of, names):
    assert_panels_fit(result_of(), names)


def test_panels_of_an_oil_film_fit_beside_each_other(oiled):
    assert_panels_fit(oiled, ["oil"])


def assert_panels_fit(result: pw.Result, names: Sequence[str]) -> None:
    for drawing in drawings(result, names):
        sheet = drawing.sheet
        FigureCanvasAgg(sheet).draw()
        panels = [axes for axes in sheet.axes if axes.axison and axes.get_subplotspec()]
        boxes = [box for axes in panels if (box := axes.get_tightbbox())]
        boxes += [legend.get_window_extent() for legend in sheet.legends if panels]
        places = [place for axes in panels if (place := axes.get_subplotspec())]
        assert all(place.get_gridspec().ncols <= 2 for place in places)
        for k, box in enumerate(boxes):
            near = box.padded(-2.0)  # pixels
            assert sheet.bbox.contains(near.x0, near.y0), (drawing.file, k)
            assert sheet.bbox.contains(near.x1, near.y1), (drawing.file, k)
            for other in boxes[:k]:
                assert not near.overlaps(other), (drawing.file, k)


@pytest.mark.parametrize(
    ("scene", "stages", "files"),
    [
        (made.BOTH, 2, [*WORN, *MOTION]),
        (made.IDEAL, 1, ["response.png"]),
    ],
)
def test_figures_are_drawn(scene, stages, files, tmp_path):
    figures = list(drawings(made_up(scene, stages)))
    files = ["mechanism.png", *files]
    assert [drawing.file for drawing in figures] == files
    for drawing in figures:
        assert save(drawing, tmp_path / "figures").read_bytes().startswith(b"\x89PNG")
        assert drawing.title
        assert drawing.caption.endswith(".")
        pairs = [(axes.get_xlabel(), axes.get_ylabel()) for axes in drawing.sheet.axes]
        assert all(UNIT.search(label) for pair in pairs for label in pair if label), (
            pairs
        )
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == sorted(
        files
    )


def test_plot_returns_the_axes_of_every_figure():
    """Of all stages those that are drawn without a name, of one stage each by its name."""
    result = grown()
    assert len(result.plot()) == 42
    counts = {}
    for name in NAMES:
        if name in NOT_MADE_UP:
            continue
        axes = result.plot(name, stage=1)
        counts[name] = len(axes)
        sheet = axes[0].figure
        assert isinstance(sheet, Sheet)
        texts = [text.get_text() for axes in sheet.axes for text in axes.texts]
        texts += [axes.get_title(loc="left") for axes in sheet.axes]
        words = " ".join([*legend_of(sheet), *texts])
        if name not in ("mechanism", "growth"):
            assert "first wear" in words
            assert "second wear" not in words
    worn = {"wear": 2, "growth": 2, "surfaces": 6}
    motion = {"response": 5, "bottom": 1, "force": 2, "path": 2, "drives": 4}
    dynamics = {"phase": 4, "poincare": 2, "impacts": 2, "modes": 2, "spectrum": 3}
    assert counts == {"mechanism": 1, **worn, **motion, **dynamics}


def test_oil_film_is_that_of_each_joint(oiled):
    panels = oiled.plot("oil")
    for name, axes, circle in zip(("A", "C"), panels[::2], panels[1::2], strict=True):
        film = oil_films(oiled.scene)[name]
        drawn, *levels = (
            np.asarray(line.get_ydata(), dtype=float) for line in axes.lines
        )
        assert_allclose(drawn, 1e6 * film.thickness)
        assert [level[0] for level in levels] == pytest.approx(
            [3e6 * film.roughness, 1e6 * film.roughness]
        )
        assert f"{100.0 * film.full_share:.3g} %" in axes.get_title(loc="left")
        limit, orbit, least = (np.asarray(line.get_xydata()) for line in circle.lines)
        assert_allclose(np.hypot(*limit.T), 1.0)
        assert_allclose(1.0 - np.hypot(*orbit.T), film.orbit.gap)
        assert 1.0 - math.hypot(*least[0]) == pytest.approx(film.orbit.gap.min())


@pytest.mark.parametrize(
    ("names", "stage", "message"),
    [
        (["forces"], None, "unknown figure 'forces'; did you mean force?"),
        (["wear"], 0, "stage 0 of wear-times has nothing to draw as 'wear'"),
        (["force"], 7, "wear-times has no stage 7; it has 0 to 2"),
    ],
)
def test_plot_refuses_in_a_line(names, stage, message):
    with refused(re.escape(message)):
        made_up(made.BOTH, 3).plot(*names, stage=stage)


def test_matplotlib_of_a_script_is_left_as_it_is():
    before = dict(matplotlib.rcParams)
    made_up(made.IDEAL, 1).plot()
    assert dict(matplotlib.rcParams) == before
    assert pyplot.get_fignums() == []
    pyplot.switch_backend("agg")
    with pyplot.ion():
        axes = made_up(made.IDEAL, 1).plot("response")
    assert [pyplot.figure(number) for number in pyplot.get_fignums()] == [
        axes[0].figure
    ]
    pyplot.close("all")


def test_heights_are_relative_to_the_ideal_bottom_dead_centre():
    axes = sheet_of("bottom", made_up(made.BOTH, 2)).axes
    line = np.asarray(axes[1].get_lines()[0].get_xydata())
    assert line[:, 0].tolist() == [1.0, 2.0]
    # From the closed form of the press.
    assert line[:, 1] == pytest.approx([-712.3459, -812.3459], abs=1e-3)


@pytest.mark.parametrize(
    ("figure", "column"), [("force", "force_max"), ("response", "acceleration_max")]
)
def test_peaks_come_from_the_cycles_not_from_the_thinned_series(figure, column):
    result = made_up(made.IDEAL if figure == "response" else made.BOTH, 1)
    cycles = result.stages[0].arrays["cycles"]
    cycles[:, names_of((*CYCLE, *JOINT_CYCLE)).index(column)] = 2000.0, 3000.0
    words = [
        text.get_text() for axes in sheet_of(figure, result).axes for text in axes.texts
    ]
    assert "largest 3\u202f000 " in words[0]


@pytest.fixture(scope="module")
def blanking():
    scene = replace(ideal(), process=pw.Blanking(), engine="dae", cycles=4)
    return run(scene)


def test_no_peak_of_a_drive_is_cut(blanking):
    """A torque of a thousand times the ideal one in one row of a cycle."""
    largest = float(np.abs(ideal_curves(blanking.scene)[0]["crank 2"].torque).max())
    stage = blanking.stages[0]
    torque = stage.arrays["drive_torque"].copy()
    start, end = sheet_of("drives", blanking).axes[0].get_xlim()
    row = int(np.searchsorted(stage.time, start + 0.9 * (end - start)))
    torque[row, 0] = -1e3 * largest
    arrays = {**stage.arrays, "drive_torque": torque}
    axes = sheet_of("drives", altered(blanking, 0, arrays=arrays)).axes[0]
    assert axes.get_ylim()[0] < -1e3 * largest


@pytest.mark.parametrize("name", ["response", "drives"])
def test_the_working_zone_stands_beside_the_full_turn(blanking, name):
    """From the touch of the work to 20 ms after its fracture, with a seventh before and after."""
    sheet = sheet_of(name, blanking)
    panels = np.array(sheet.axes).reshape(-1, 2)
    (stroke,) = [
        stroke
        for stroke in sampled_strokes(blanking.scene, blanking.stages[0])
        if stroke.start < panels[0, 0].get_xlim()[1] - 1e-3
    ][:1]
    length = stroke.fracture + 20e-3 - stroke.contact
    ends = stroke.contact - 0.15 * length, stroke.fracture + 20e-3 + 0.15 * length
    full = panels[0, 0].get_xlim()
    assert full == pytest.approx((stroke.start, stroke.end))
    for axes, zone in panels:
        assert zone.get_xlim() == pytest.approx(ends)
        # A mark of the work that lies outside of the zone is left out.
        drawn = [
            line
            for line in axes.lines
            if np.any(
                np.abs(np.asarray(line.get_xdata()) - np.mean(ends)) < np.ptp(ends) / 2
            )
        ]
        assert len(zone.lines) == len(drawn) >= 2
        for line, part in zip(drawn, zone.lines, strict=True):
            x, y = (np.asarray(one, float) for one in part.get_data())
            assert_array_equal(y, np.interp(x, *line.get_data()))
            assert part.get_color() == line.get_color()


def test_an_axis_of_large_forces_is_in_kilonewtons():
    sheet, ((axes,),) = panels(1, 1, 2.0)
    axes.set_ylim(-2e4, 1e6)
    label_values(axes, "force", "N")
    assert axes.get_ylabel() == "force (kN)"
    sheet.canvas.draw()
    assert axes.yaxis.get_major_formatter()(-2e4, 0) == "−20"


def test_figures_of_series_that_an_earlier_version_did_not_record_are_left_out():
    result = made_up(made.BOTH, 2)
    for stage in result.stages:
        for joint in stage.joint_names:
            del stage.arrays[f"{joint}_eccentricity"]  # type: ignore[attr-defined]
    files = [drawing.file for drawing in drawings(result)]
    assert "contact-force.png" in files
    assert "centre-trajectory.png" not in files
    message = "eccentricity was not stored; run the scene again; presswear 0.1.0 wrote the result"
    with refused(message):
        next(drawings(result, ["path"]))


def test_lines_of_a_page_are_those_that_were_drawn():
    """Steps from point to point, to a hundredth of a point, add up to the points."""
    time = np.linspace(0.0, 7.0, 500)
    sheet = Sheet(figsize=(2.0, 1.0))
    axes = sheet.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, 7.0), ylim=(-1.0, 1.0))
    axes.fill_between(time, np.sin(time), -1.0)
    (path,) = re.findall(r'd="(M[^"]{400,})"', svg_of(Drawing("a.png", "", "", sheet)))
    numbers = re.findall(r"-?[\d.]+", path)
    points = np.cumsum(np.reshape(np.array(numbers, float), (-1, 2)), axis=0)
    upper = points[1:501]
    assert_allclose(upper[:, 0], 144.0 / 7.0 * time, atol=0.006)
    assert_allclose(upper[0, 1] - upper[:, 1], 36.0 * np.sin(time), atol=0.011)
