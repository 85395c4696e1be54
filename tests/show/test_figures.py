"""Figures of small made-up results."""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import made_up_result as made
import matplotlib
import matplotlib.pyplot as pyplot
import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from made_up_result import altered, grown, lived, made_up, not_passed
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure as Sheet

import presswear as pw
from presswear.campaign.runs import run
from presswear.linkage.surface import bin_centres
from presswear.recording.columns import CYCLE, JOINT_CYCLE, names_of
from presswear.results.oil_film import oil_films
from presswear.results.rigid_joints import ideal_curves
from presswear.results.strokes import sampled_strokes
from presswear.scene.catalog import ideal, press_blanking, slider_crank, wear_times
from presswear.scene.settings import changed
from presswear.show.figures import NAMES, drawings, first_drawings, save
from presswear.show.figures.mechanism import labelled
from presswear.show.figures.motion import whole_cycles
from presswear.show.figures.style import LINES, Drawing, label_values, panels
from presswear.show.figures.wear import seam
from presswear.show.figures.window import Window

UNIT = re.compile(
    r"^strokes |\((m|mm|µm|nm|s|N|m/s|m/s²|N m|W|degrees|strokes|%|orders|N²/Hz|\(m/s²\)²/Hz)\)"
)
NOT_MADE_UP = (
    "life",
    "tonnage",
    "oil",
    "tilt",
    "corners",
    "walls",
    "motor",
    "frame",
)  # figures that need what made-up results lack
WORN = ["wear-depth.png", "worn-surface-A.png", "worn-surface-C.png"]
MOTION = [
    "response.png",
    "bottom-dead-centre.png",
    "contact-force.png",
    "centre-trajectory.png",
    "phase.png",
    "modes.png",
]


def sheet_of(name: str, result: pw.Result) -> Sheet:
    return next(drawings(result, [name])).sheet


def legend_of(sheet: Sheet) -> list[str]:
    return [text.get_text() for legend in sheet.legends for text in legend.get_texts()]


SEVEN = replace(made.BOTH, joints="O2,O7,A,B,C,D,E")
RESULTS = [
    lived(made_up(made.BODY, 2)),
    grown(),
    made_up(SEVEN, 2),
]
RESULTS.append(made_up(replace(made.BODY, joints="A,B,C,D"), 1))
OILED = made_up(
    changed(made.BOTH, {"viscosity": "0.1 Pa s", "clearance": "0.05 mm"}), 1
)
RESULTS.append(OILED)
RESULTS.append(made_up(made.BOTH, 9))


@pytest.mark.parametrize("result", RESULTS)
def test_panels_with_their_labels_fit_beside_each_other(result: pw.Result) -> None:
    for drawing in drawings(result):
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
        (made.ONE, 1, ["wear-depth.png", *MOTION]),
        (made.IDEAL, 1, ["response.png"]),
    ],
)
def test_figures_are_drawn(
    scene: pw.Scene, stages: int, files: list[str], tmp_path: Path
) -> None:
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


@pytest.mark.parametrize(
    ("result", "files"),
    [
        (
            made_up(made.BOTH, 2),
            ["response.png", "contact-force.png", "wear-depth.png"],
        ),
        (
            lived(made_up(made.BODY, 2)),
            ["life.png", "response.png", "contact-force.png"],
        ),
        (made_up(made.IDEAL, 1), ["response.png"]),
        (made_up(made.IDEAL, 1, "failed"), []),
    ],
)
def test_figures_after_a_run_are_the_first_that_show_something(
    result: pw.Result, files: list[str]
) -> None:
    assert [one.file for one in first_drawings(result)] == ["mechanism.png", *files]


def test_plot_returns_the_axes_of_every_figure() -> None:
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


def test_a_phase_portrait_tells_new_surfaces_from_worn_ones() -> None:
    (portrait,) = drawings(made_up(made.BOTH, 2), ["phase"])
    lines = [
        x
        for axes in portrait.sheet.axes
        for x in axes.lines
        if x.get_linestyle() == "--"
    ]
    assert len(lines) == 4  # of two joints in two stages, one of them on worn surfaces
    assert "touches new surfaces; worn surfaces touch farther out." in portrait.caption


def test_oil_film_is_that_of_each_joint() -> None:
    panels = OILED.plot("oil")
    for name, axes, circle in zip(("A", "C"), panels[::2], panels[1::2], strict=True):
        film = oil_films(OILED.scene)[name]
        drawn, *levels = (
            np.asarray(line.get_ydata(), dtype=float) for line in axes.lines
        )
        np.testing.assert_allclose(drawn, 1e6 * film.thickness)
        assert [level[0] for level in levels] == pytest.approx(
            [3e6 * film.roughness, 1e6 * film.roughness]
        )
        full = (
            f"joint {name}: full film for\n{100.0 * film.full_share:.3g} % of the cycle"
        )
        assert axes.get_title(loc="left") == full
        limit, orbit, least = (np.asarray(line.get_xydata()) for line in circle.lines)
        np.testing.assert_allclose(np.hypot(*limit.T), 1.0)
        np.testing.assert_allclose(1.0 - np.hypot(*orbit.T), film.orbit.gap)
        assert 1.0 - math.hypot(*least[0]) == pytest.approx(film.orbit.gap.min())


@pytest.mark.parametrize(
    ("names", "stage", "message"),
    [
        (["forces"], None, "unknown figure 'forces'; did you mean force?"),
        (["growth"], None, "wear-times has nothing to draw as 'growth'"),
        (["wear"], 0, "stage 0 of wear-times has nothing to draw as 'wear'"),
        (["force"], 7, "wear-times has no stage 7; it has 0 to 2"),
    ],
)
def test_plot_refuses_in_a_line(
    names: list[str], stage: int | None, message: str
) -> None:
    with pytest.raises(pw.InputError, match=re.escape(message)):
        made_up(made.BOTH, 3).plot(*names, stage=stage)


def test_matplotlib_of_a_script_is_left_as_it_is() -> None:
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


def test_heights_are_relative_to_the_ideal_bottom_dead_centre() -> None:
    axes = sheet_of("bottom", made_up(made.BOTH, 2)).axes
    line = np.asarray(axes[1].get_lines()[0].get_xydata())
    assert line[:, 0].tolist() == [1.0, 2.0]
    # From the closed form of the press.
    assert line[:, 1] == pytest.approx([-712.3459, -812.3459], abs=1e-3)


@pytest.mark.parametrize(
    ("figure", "column"), [("force", "force_max"), ("response", "acceleration_max")]
)
def test_peaks_come_from_the_cycles_not_from_the_thinned_series(
    figure: str, column: str
) -> None:
    result = made_up(made.IDEAL if figure == "response" else made.BOTH, 1)
    cycles = result.stages[0].arrays["cycles"]
    cycles[:, names_of((*CYCLE, *JOINT_CYCLE)).index(column)] = 2000.0, 3000.0
    words = [
        text.get_text() for axes in sheet_of(figure, result).axes for text in axes.texts
    ]
    assert "largest 3\u202f000 " in words[0]


def test_stages_without_motion_are_left_out_and_many_are_thinned() -> None:
    failed = made_up(made.BOTH, 2, "failed")
    assert legend_of(sheet_of("response", failed)) == ["ideal", "no wear"]
    assert legend_of(sheet_of("wear", failed)) == ["first wear"]
    many = made_up(made.BOTH, 9)
    assert len(sheet_of("path", many).axes) == 2 * 2
    assert legend_of(sheet_of("response", many))[-1] == "eighth wear"


@pytest.fixture(scope="module")
def blanking() -> pw.Result:
    scene = replace(ideal(), process=pw.Blanking(), engine="dae", cycles=4)
    return run(scene)


def test_no_peak_of_a_drive_is_cut(blanking: pw.Result) -> None:
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
def test_the_working_zone_stands_beside_the_full_turn(
    blanking: pw.Result, name: str
) -> None:
    """From the touch of the work to 20 ms after its fracture, with a seventh before and after."""
    sheet = sheet_of(name, blanking)
    panels = np.array(sheet.axes).reshape(-1, 2)
    (stroke,) = [
        one
        for one in sampled_strokes(blanking.scene, blanking.stages[0])
        if one.start < panels[0, 0].get_xlim()[1] - 1e-3
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
            np.testing.assert_array_equal(y, np.interp(x, *line.get_data()))
            assert part.get_color() == line.get_color()
    titles = [axes.get_title(loc="left") for axes in panels[:, 1]]
    assert titles[0] == "working zone (grey at the left)"
    labels = [axes.get_xticklabels() for axes in panels[-1]]
    degrees = [float(label.get_text()) for row in labels for label in row]
    assert all(0.0 <= angle < 360.0 for angle in degrees)
    assert panels[-1, 0].get_xlabel() == "crank angle (degrees)"


def test_the_deviation_from_the_ideal_motion_comes_first(blanking: pw.Result) -> None:
    labels = [axes.get_ylabel() for axes in sheet_of("response", blanking).axes]
    assert labels[0].startswith("displacement\nminus\nideal")
    assert len(blanking.plot("tonnage")) == 1  # without work there is no zone
    assert len(sheet_of("response", made_up(made.IDEAL, 1)).axes) == 4


def test_an_axis_of_large_forces_is_in_kilonewtons() -> None:
    sheet, ((axes,),) = panels(1, 1, 2.0)
    axes.set_ylim(-2e4, 1e6)
    assert label_values(axes, "force", "N") == (1e-3, "kN")
    assert axes.get_ylabel() == "force (kN)"
    sheet.canvas.draw()
    assert [axes.yaxis.get_major_formatter()(value, 0) for value in (-2e4, 5e5)] == [
        "−20",
        "500",
    ]


def test_depth_is_the_cumulative_total_in_microns() -> None:
    result = made_up(made.BOTH, 3)
    sheet = sheet_of("wear", result)
    assert legend_of(sheet) == [
        "first wear",
        "second wear",
        "third wear, not simulated",
    ]
    expected = 2e6 * result.stages[1].arrays["A_depth_bearing"]
    for k, line in enumerate(sheet.axes[0].get_lines(), start=1):
        np.testing.assert_allclose(np.asarray(line.get_ydata()), k * expected)
    arrays = result.stages[2].arrays
    deeper = {**arrays, "A_depth_pin": 1e3 * arrays["A_depth_pin"]}
    at_a, at_c = sheet_of("wear", altered(result, 2, arrays=deeper)).axes
    assert (at_a.get_yscale(), at_c.get_yscale()) == ("log", "linear")


def lobe(centre: float) -> Any:
    """Groove around an angle, degrees; its depth at the bin centres, m."""
    away = np.angle(np.exp(1j * (bin_centres(made.BINS) - np.radians(centre))))
    return 1e-6 * np.exp(-((away / np.radians(25.0)) ** 2))


@pytest.mark.parametrize("centre", [0.0, 20.0, 200.0, 345.0])
def test_a_lobe_is_never_cut_in_two(centre: float) -> None:
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
    np.testing.assert_allclose(
        y, np.interp(x, np.degrees(angle), depth, period=360.0), atol=1e-12
    )
    assert max(y[0], y[-1]) < 0.05 * depth.max()
    assert axes.xaxis.get_major_formatter()(540.0) == "180"
    for depths in ([], [np.zeros(made.BINS)], [np.ones(made.BINS)], [lobe(180.0)]):
        assert seam(angle, depths) == 0.0


@pytest.mark.parametrize(
    "scene", [made.BOTH, made.BODY], ids=["fixed maps", "maps on bodies"]
)
def test_profiles_are_drawn_to_the_stated_scale(scene: pw.Scene) -> None:
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
        assert stated is not None
        assert radial / along == pytest.approx(float(stated[1].replace("\u202f", "")))
        depths = np.concatenate(
            [np.asarray(line.get_ydata()) for line in axes.get_lines()]
        )
        assert low <= depths.min()
        assert depths.max() <= high


def test_growth_runs_over_the_steps_after_a_stage() -> None:
    line = grown().plot("growth", stage=1)[0].get_lines()[0]
    assert np.asarray(line.get_xydata()).tolist() == [
        [k, k] for k in (3.0, 4.0, 5.0, 6.0)
    ]


def test_a_life_shows_every_quantity_with_its_limits() -> None:
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
    np.testing.assert_allclose(curve, np.outer(made.STROKES, [1.0, 1e-11]))
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


def words_of(axes: Axes) -> set[str]:
    return {text.get_text() for text in axes.texts}


CRANK = pw.SliderCrank(0.03, 0.45, slide_angle=-0.5 * math.pi)
LABELLED = [wear_times(), press_blanking(), slider_crank(), pw.Scene(FOUR_BAR)]
LABELLED += [pw.Scene(CRANK, joints="AB"), pw.Scene(pw.SixBar(), joints="B")]


@pytest.mark.parametrize("scene", LABELLED)
def test_joints_and_bodies_of_a_mechanism_are_named_inside_the_axes(
    scene: pw.Scene,
) -> None:
    (axes,) = (sheet := labelled(scene).sheet).axes
    sheet.draw_without_rendering()
    linkage = scene.mechanism.linkage()
    joints = {
        name for text in words_of(axes) for name in text.split("\n")[0].split(", ")
    }
    assert {joint.name for joint in linkage.revolutes} == joints
    (legend,) = sheet.legends
    bodies = [text.get_text().partition(",")[0] for text in legend.get_texts()]
    assert bodies == [body.name for body in linkage.bodies]
    outer = axes.get_window_extent()
    for box in (text.get_window_extent() for text in axes.texts):
        assert outer.x0 - 1.0 <= box.x0
        assert box.x1 <= outer.x1 + 1.0


def test_a_mechanism_is_labelled_at_its_position() -> None:
    scene = changed(wear_times(), {"A.clearance": "0.25mm"})
    (axes,) = (drawing := labelled(scene, 0.1)).sheet.axes
    assert "closed, 100 ms after the start; one" in drawing.caption
    assert "closed, at the start; one" in labelled(scene).caption
    joints = {"B", "D", "E", "O2", "O7", "A\nc = 0.25 mm", "C\nc = 0.8 mm"}
    assert joints == words_of(axes)
    (legend,) = drawing.sheet.legends
    assert legend.get_texts()[0].get_text() == "crank 2, 105 rpm"
    position = scene.ideal.at(np.array([0.1])).position[0].reshape(-1, 3)[:, :2]
    marks = [
        np.ravel(line.get_xydata()) for line in axes.lines if line.get_marker() == "+"
    ]
    np.testing.assert_allclose(marks, position, atol=1e-12)


def test_joints_at_one_place_share_a_label_and_springs_are_drawn() -> None:
    spring = pw.Spring("coil", "third.tail", (0.3, 0.2), 100.0, 0.1)
    linkage = FOUR_BAR.changed(
        bodies=[*FOUR_BAR.bodies, pw.Bar("third", 0.1, 0.2)],
        joints=[*FOUR_BAR.joints, pw.Pin("B2", "rocker.head", "third.head")],
        drives=[
            *FOUR_BAR.drives,
            pw.Drive("third", harmonics=[(0.0, 0.1)], frequency=30.0),
        ],
        springs=[spring],
    )
    (axes,) = labelled(
        pw.Scene(linkage, bearings={"B": pw.Bearing(clearance=1e-4)})
    ).sheet.axes
    assert {"B, B2\nc of B = 0.1 mm", "coil"} <= words_of(axes)
    coil = max(axes.lines, key=lambda line: np.asarray(line.get_xydata())[:, 0].max())
    assert np.asarray(coil.get_xydata())[-1] == pytest.approx((0.3, 0.2))


def test_loads_are_drawn_at_their_points() -> None:
    scene = pw.Scene(mechanism=FOUR_BAR, joints="B")
    loads: list[Any] = [pw.Force("rocker.head", 0.5, 3.0), pw.Load("coupler", 2.0)]
    loads.append(pw.Moment("crank", pw.Harmonics(1.0)))
    (axes,) = labelled(
        replace(scene, mechanism=FOUR_BAR.changed(loads=loads))
    ).sheet.axes
    red = [
        patch for patch in axes.patches if patch.get_edgecolor() == to_rgba("tab:red")
    ]
    assert len(red) == 3
    position = scene.ideal.at(np.zeros(1)).position[0]
    head = position[6:8] + 0.06 * np.array(
        [math.cos(position[8]), math.sin(position[8])]
    )
    for place in (head, position[3:5]):
        gaps = [
            np.abs(np.asarray(p.get_path().vertices) - place).max(axis=1) for p in red
        ]
        # The head of an arrow is rounded; its tail is 40 mm away.
        assert min(float(gap.min()) for gap in gaps) < 2e-3


def test_names_are_no_formulas(tmp_path: Path) -> None:
    """A joint, body or spring named $x^$ ended in an error of mathtext, after the run."""
    body = "$^2$"
    joint = "$x^$"
    bar = pw.Bar(body, 0.05, 0.3)
    bodies = [bar, *(b for b in FOUR_BAR.bodies if b.name != "crank")]
    pins = [
        pw.Pin("O", (0.0, 0.0), f"{body}.tail"),
        pw.Pin(joint, f"{body}.head", "coupler.tail"),
        pw.Pin("B", "coupler.head", "rocker.head"),
        pw.Pin("P", (0.18, 0.0), "rocker.tail"),
    ]
    spring = pw.Spring("$_$", "rocker.head", (0.18, 0.3), stiffness=100.0, length=0.1)
    linkage = pw.assemble(
        bodies,
        pins,
        [pw.Drive(body, 30.0)],
        body,
        FOUR_BAR.guess,
        name="$^$",
        springs=[spring],
    )
    scene = pw.Scene(
        linkage, "$a^$", "$b^$", pw.Bearing(), joints=f"{joint},B", wear_updates=1
    )
    for drawing in drawings(made_up(scene, 2)):
        save(drawing, tmp_path)


def test_powers_of_ten_are_plain_text() -> None:
    sheet, ((axes,),) = panels(1, 1, 3.0)
    axes.plot([1e-3, 1e3], [1.0, 20.0])
    axes.set(xscale="log", yscale="log", xlim=(1e-3, 1e3), ylim=(1.0, 9.0))
    Drawing("", "", "", sheet)
    FigureCanvasAgg(sheet).draw()
    assert [text.get_text() for text in axes.get_xticklabels()][1:3] == ["10⁻³", "10⁻²"]
    minor = [text.get_text() for text in axes.get_yticklabels(minor=True)]
    assert "2·10⁰" in minor


def test_figures_of_series_that_an_earlier_version_did_not_record_are_left_out() -> (
    None
):
    result = made_up(made.BOTH, 2)
    for stage in result.stages:
        for joint in stage.joint_names:
            del stage.arrays[f"{joint}_eccentricity"]  # type: ignore[attr-defined]
    files = [drawing.file for drawing in drawings(result)]
    assert "contact-force.png" in files
    assert "centre-trajectory.png" not in files
    message = "eccentricity was not stored; run the scene again; presswear 0.1.0 wrote the result"
    with pytest.raises(pw.InputError, match=message):
        next(drawings(result, ["path"]))


def test_a_stroke_has_no_peak_of_the_cycles_beside_it() -> None:
    """A stroke lies across two cycles, whose peaks may be in the strokes beside it."""
    window = Window(0.0, 0.0, period=0.5, run_up=0.0, phase="", words="")
    assert whole_cycles(np.array([1.0, 3.0]), window) == slice(2, 6)
    assert whole_cycles(np.array([1.001, 2.999]), window) == slice(2, 6)
    across = whole_cycles(np.array([0.9, 1.4]), window)
    assert not np.arange(10)[across].size
