"""Figures of small made-up results."""

import math
import re
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as pyplot
import numpy as np
import pytest
from hypothesis import given as drawn
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure as Sheet

from presswear.campaign.single import run_scene
from presswear.engines.base import Status
from presswear.linkage.elements import Bar, Pin
from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.loads import AnyLoad, Force, Harmonics, Load, Moment, Spring
from presswear.linkage.motions import Drive
from presswear.linkage.pieces import Rise
from presswear.linkage.process import Blanking
from presswear.linkage.surface import bin_centres
from presswear.record.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.results.drives import ideal_curves
from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult, WearStep
from presswear.scene.bearing import CONVENTIONS, Bearing
from presswear.scene.catalog import ideal, press_blanking, slider_crank, wear_times
from presswear.scene.scene import Scene, stage_name
from presswear.scene.settings import changed
from presswear.show.figures import NAMES, drawings, save
from presswear.show.figures.drives import within
from presswear.show.figures.mechanism import labelled
from presswear.show.figures.motion import Window
from presswear.show.figures.style import length_scale, round_down
from presswear.show.figures.wear import seam
from presswear.tools.errors import InputError
from presswear.tools.numbers import given, large, readable, whole, with_interval

BINS = 72
UNIT = re.compile(
    r"\((m|mm|µm|nm|s|N|m/s|m/s²|N m|W|degrees|strokes|%|orders|N²/Hz|\(m/s²\)²/Hz)\)"
)


def made_up(scene: Scene, stages: int, status: str = "completed", message: str = "") -> Result:
    """A result as a run of the scene would leave it, from formulas; stage depth grows."""
    ends = [("completed", "")] * (stages - 1) + [(status, message)]
    return Result(
        scene,
        tuple(_stage(scene, k, *end) for k, end in enumerate(ends)),
        status,
        message,
        {
            "python": "3.12.0",
            "packages": {"presswear": "0.1.0"},
            "revision": "0123456789ab",
            "machine": "a machine",
            "started": "2024-01-01T00:00:00Z",
        },
        wall_s=3.0,
    )


def _stage(scene: Scene, index: int, status: Any, message: str) -> StageResult:
    time = np.linspace(0.0, 2.0 * scene.mechanism.period, 400)
    angle = bin_centres(BINS)
    arrays = {
        "time": time,
        "slider": scene.ideal_slider(time) * (1.0 + 0.01 * (index + 1)),
        "angle": angle,
        "cycles": np.zeros((2, len(CYCLE_FIXED) + len(CYCLE_JOINT) * len(scene.clearance_joints))),
        "cycle_start": np.zeros(2),
    }
    arrays["cycles"][:, CYCLE_FIXED.index("bottom_height")] = -0.5878, -0.5879
    if scene.drive_torque == "on":
        arrays["drive_torque"] = np.column_stack([np.cos(40.0 * time), 1.0 + 0.0 * time])
    joints = {}
    for joint in scene.clearance_joints:
        turn = 6.0 * np.pi * time / time[-1]
        arrays[f"{joint}_eccentricity"] = 8e-4 * np.column_stack([np.cos(turn), np.sin(turn)])
        arrays[f"{joint}_force"] = np.column_stack([100.0 * np.cos(turn) ** 8, 0.0 * turn])
        arrays[f"{joint}_penetration"] = 1e-6 * np.sin(turn)
        arrays[f"{joint}_sliding"] = np.cos(turn)
        # Touchdown, separation, closing and release speed, peak force, steps.
        arrays[f"{joint}_contacts"] = np.array(
            [
                [k * time[-1] / 6.0, (k + 0.5) * time[-1] / 6.0, 0.1, -0.1, 50.0, 30.0]
                for k in range(6)
            ]
        )
        one = 5e-6 * np.exp(-((angle - np.radians(92.5)) ** 2) / 0.1)
        for side in SIDES:
            arrays[f"{joint}_depth_{side}"] = index * one
            arrays[f"{joint}_wear_{side}"] = one
        each = {"mean": 80.0, "half_width": 12.0, "cycles": 2}
        joints[joint] = {
            "force_max_N": 100.0 + index,
            "force_max_per_cycle_N": each,
            "dose_per_cycle_Nm": each | {"half_width": None},
            "contacts": 1234,
            "fewest_steps_in_a_contact": 50,
            "part_of_time_in_contact": 0.5,
            "wear_volume_m3": 3e-9,
            "wear_map_error": 0.1,
        }
    each = {"mean": 0.107, "half_width": 0.001, "cycles": 2}
    slider = {
        "displacement_max_m": 0.10731,
        "velocity_min_m_s": -0.9,
        "velocity_max_m_s": 1.0,
        "acceleration_max_m_s2": 1221.0,
        "displacement_max_per_cycle_m": each,
        "velocity_max_per_cycle_m_s": each,
        "acceleration_max_per_cycle_m_s2": each,
    }
    bdc = {
        "strokes": 2,
        "height_per_cycle_m": {"mean": -0.58785, "half_width": 2e-5, "cycles": 2},
        "error_per_cycle_m": {"mean": -(7.6 + index) * 1e-4, "half_width": 3e-5, "cycles": 2},
        "delay_per_cycle_s": {"mean": -3e-3, "half_width": None, "cycles": 2},
        "delay_per_cycle_rad": {"mean": -0.0314159, "half_width": 0.0174533, "cycles": 2},
        "standard_deviation_m": 4e-5,
        "standard_deviation_interval_m": [3e-5, 6e-5],
        "range_m": 1e-4,
        "range_interval_m": None,
        "range_strokes": 2,
        "range_of_all_m": 1e-4,
    }
    return StageResult(
        index,
        status,
        message,
        finding=None,
        amplification=2e6,
        wear_steps=(),
        simulated_s=float(time[-1]),
        wall_s=1.0,
        diagnostics={"model": "6 bodies, 2 drives", "steps": 4000},
        statistics={"cycles": 2, "slider": slider, "bdc": bdc, "joints": joints},
        arrays=arrays,
        joint_names=scene.clearance_joints,
    )


def altered(result: Result, index: int, **changes: Any) -> Result:
    """A result with one stage changed."""
    stages = list(result.stages)
    stages[index] = replace(stages[index], **changes)
    return replace(result, stages=tuple(stages))


BOTH = replace(wear_times(), cycles=2)
ONE = replace(BOTH, joints="C")
BODY = replace(BOTH, conventions=CONVENTIONS["refined"])
BODY_A = replace(BODY, joints="A")
IDEAL = replace(BOTH, joints="none", wears=0)
BOTTOM = "bottom-dead-centre.png"
NOT_MADE_UP = ("life", "tonnage")
"""Figures that need what made-up results have not."""
MOTION = [
    *("response.png", BOTTOM, "contact-force.png", "centre-trajectory.png"),
    *("phase.png", "poincare.png", "modes.png", "spectrum.png"),
]


@pytest.mark.parametrize(
    ("scene", "stages", "files"),
    [
        (BOTH, 2, ["wear-depth.png", "worn-surface-A.png", "worn-surface-C.png", *MOTION]),
        (BODY_A, 2, ["wear-depth.png", "worn-surface-A.png", *MOTION]),
        (ONE, 1, ["wear-depth.png", *MOTION]),
        (IDEAL, 1, ["response.png"]),
    ],
    ids=["both joints", "maps on bodies", "one joint, one stage", "ideal"],
)
def test_draws_what_makes_sense(
    scene: Scene, stages: int, files: list[str], tmp_path: Path
) -> None:
    found = list(drawings(made_up(scene, stages)))
    files = ["mechanism.png", "stroke.png", *files]
    assert [drawing.file for drawing in found] == files
    for drawing in found:
        assert save(drawing, tmp_path / "figures").read_bytes().startswith(b"\x89PNG")
        assert drawing.title
        assert drawing.caption.endswith(".")
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == sorted(files)


def sheet_of(name: str, result: Result) -> Sheet:
    """The first sheet of one kind of figure."""
    return next(drawings(result, [name])).sheet


def test_no_label_of_the_mechanism_hides_another() -> None:
    for scene in (wear_times(), press_blanking(), slider_crank(), Scene(FOUR_BAR)):
        drawing = labelled(scene)
        canvas: Any = FigureCanvasAgg(drawing.sheet)
        canvas.draw()
        renderer = canvas.get_renderer()
        (axes,) = drawing.sheet.axes
        names = {text.get_text().split("\n")[0] for text in axes.texts}
        assert {body.name for body in scene.mechanism.linkage().bodies} <= names
        boxes = [text.get_window_extent(renderer) for text in axes.texts]
        assert not [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]


def test_the_stroke_is_counted_from_the_ideal_bottom_dead_centre() -> None:
    (axes,) = sheet_of("stroke", made_up(IDEAL, 1)).axes
    *_, ideal = axes.lines
    height = np.asarray(ideal.get_ydata(), dtype=float)
    assert height.min() == pytest.approx(0.0, abs=1e-3)
    assert height.max() == pytest.approx(1e3 * IDEAL.stroke, rel=1e-4)


def labels(axes: Axes) -> list[str]:
    return [label for label in (axes.get_xlabel(), axes.get_ylabel()) if label]


def legend_of(sheet: Sheet) -> list[str]:
    return [text.get_text() for legend in sheet.legends for text in legend.get_texts()]


@pytest.mark.parametrize("scene", [BOTH, BODY], ids=["fixed maps", "maps on bodies"])
def test_every_axis_label_has_a_unit(scene: Scene) -> None:
    for drawing in drawings(made_up(scene, 2)):
        found = [label for axes in drawing.sheet.axes for label in labels(axes)]
        assert found
        assert all(UNIT.search(label) for label in found), found


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


def test_ideal_slider_is_the_closed_form() -> None:
    press = BOTH.mechanism
    slider = BOTH.ideal_slider(np.linspace(0.0, press.period, 2001))
    assert slider[0, 0] == 0.0
    assert slider[:, 0].max() == pytest.approx(0.1061, abs=1e-4)
    assert slider[:, 1].min() == pytest.approx(-0.889, abs=1e-3)
    assert slider[:, 2].min() == pytest.approx(-20.0, abs=0.1)


@pytest.mark.parametrize(
    ("figure", "column", "unit"),
    [("force", "force_max", "N"), ("response", "acceleration_max", "")],
)
def test_the_largest_of_a_panel_is_that_of_its_cycles(figure: str, column: str, unit: str) -> None:
    """Series are thinned: the peak of a cycle need not be in them."""
    result = made_up(IDEAL if figure == "response" else BOTH, 1)
    cycles = result.stages[0].arrays["cycles"]
    cycles[:, (*CYCLE_FIXED, *CYCLE_JOINT).index(column)] = 2000.0, 3000.0
    words = [text.get_text() for axes in sheet_of(figure, result).axes for text in axes.texts]
    assert f"largest 3\u202f000 {unit}" in words[0]


def test_bottoms_are_drawn_stroke_by_stroke_over_the_ideal() -> None:
    """Heights less the ideal one, which is that of the closed form of the press."""
    axes = sheet_of("bottom", made_up(BOTH, 2)).axes
    assert len(axes) == 2
    line = np.asarray(axes[1].get_lines()[0].get_xydata())
    assert line[:, 0].tolist() == [1.0, 2.0]
    assert line[:, 1] == pytest.approx([-712.3459, -812.3459], abs=1e-3)
    assert axes[0].get_ylabel().endswith("less ideal (µm)")
    assert list(drawings(made_up(IDEAL, 1), ["mechanism"]))
    with pytest.raises(InputError, match="nothing to draw as 'bottom'"):
        list(drawings(made_up(IDEAL, 1), ["bottom"]))


def test_unworn_surfaces_are_not_called_worn() -> None:
    """What the path's caption says of surfaces that turn is of worn ones only."""
    unworn, worn = (next(drawings(made_up(BODY, stages), ["path"])).caption for stages in (1, 2))
    assert "Worn surfaces turn" not in unworn
    assert "Worn surfaces turn" in worn


def test_many_stages_are_thinned_out() -> None:
    result = made_up(BOTH, 9)
    assert len(sheet_of("path", result).axes) == 2 * 5
    assert legend_of(sheet_of("response", result))[-1] == "eighth wear"


@pytest.mark.parametrize(
    ("status", "rows"), [("failed", None), ("completed", 1)], ids=["failed", "too short"]
)
def test_stage_without_motion_is_left_out(status: Status, rows: int | None) -> None:
    result = made_up(BOTH, 2, status)
    arrays = result.stages[1].arrays
    length = arrays["time"].size
    short = {
        name: array[:rows] if len(array) == length else array for name, array in arrays.items()
    }
    result = altered(result, 1, arrays=short)
    assert legend_of(sheet_of("response", result)) == ["ideal", "no wear"]


def grown() -> Result:
    """Three stages with two wears of three steps each between them, and torques."""
    result = made_up(replace(BOTH, drive_torque="on"), 3)
    for index in range(2):
        steps = [
            WearStep(1e6, 2, 5e5, 0.1, dict.fromkeys("AC", deepest), {"A": 9.0, "C": 9.0}, 1.0)
            for deepest in ({"bearing": 1e-6 * (3 * index + k), "pin": 1e-6} for k in (1, 2, 3))
        ]
        result = altered(result, index, wear_steps=tuple(steps))
    return result


def test_growth_runs_over_all_steps_or_those_after_a_stage() -> None:
    whole, after = (grown().plot("growth", stage=stage)[0].get_lines()[0] for stage in (None, 1))
    assert np.asarray(whole.get_xydata()).tolist() == [[k, k] for k in map(float, range(7))]
    assert np.asarray(after.get_xydata()).tolist() == [[k, k] for k in (3.0, 4.0, 5.0, 6.0)]


def test_plot_gives_the_axes_of_every_figure_in_memory() -> None:
    result = grown()
    assert result.path is None
    counts = {name: len(result.plot(name)) for name in NAMES if name not in NOT_MADE_UP}
    assert counts.pop("mechanism") == 1
    torque = {"drives": 4}
    motion = {"stroke": 1, "response": 7, "bottom": 3, "force": 6, "path": 6}
    moved = {"phase": 9, "poincare": 6, "modes": 6, "spectrum": 3}
    assert counts == {"wear": 2, "growth": 2, "surfaces": 6, **motion, **torque, **moved}
    assert len(result.plot()) == 1 + sum(counts.values())
    assert len(result.plot("path", "wear")) == counts["path"] + counts["wear"]


@pytest.mark.parametrize(
    "name", [name for name in NAMES if name not in ("mechanism", "growth", *NOT_MADE_UP)]
)
def test_plot_of_one_stage_shows_it_alone(name: str) -> None:
    (sheet,) = {axes.figure for axes in grown().plot(name, stage=1)[:3]}
    assert isinstance(sheet, Sheet)
    words = [text.get_text() for axes in sheet.axes for text in (axes.title, *axes.texts)]
    told = " ".join([*legend_of(sheet), *words])
    assert "first wear" in told
    assert "second wear" not in told
    assert "third wear" not in told


@pytest.mark.parametrize(
    ("names", "stage", "message"),
    [
        (
            ["forces"],
            None,
            "unknown figure 'forces'; did you mean force?; known are life, mechanism, stroke",
        ),
        (["growth"], None, "wear-times has nothing to draw as 'growth'"),
        (["wear"], 0, "stage 0 of wear-times has nothing to draw as 'wear'"),
        (["force"], 7, "wear-times has no stage 7; it has 0, 1, 2; did you mean 2?"),
    ],
)
def test_plot_refuses_in_a_line(names: list[str], stage: int | None, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        made_up(BOTH, 3).plot(*names, stage=stage)


def test_a_script_keeps_its_matplotlib_as_it_is() -> None:
    """No setting changes, and figures that nobody asked to see are not kept by pyplot."""
    before = dict(matplotlib.rcParams)
    made_up(IDEAL, 1).plot()
    assert dict(matplotlib.rcParams) == before
    assert pyplot.get_fignums() == []


def test_pyplot_shows_figures_where_it_is_interactive() -> None:
    pyplot.switch_backend("agg")
    with pyplot.ion():
        axes = made_up(IDEAL, 1).plot("response")
    assert [pyplot.figure(number) for number in pyplot.get_fignums()] == [axes[0].figure]
    pyplot.close("all")


def test_the_mechanism_is_labelled_where_it_stands() -> None:
    """Every body and joint by its name, at its place; drives in their senses."""
    scene = changed(wear_times(), {"A.clearance": "0.25mm"})
    drawing = labelled(scene, 0.1)
    (axes,) = drawing.sheet.axes
    words = [text.get_text() for text in axes.texts]
    linkage = scene.linkage()
    for body in linkage.bodies:
        assert body.name in words
    assert {"B", "D", "E", "O2", "O7", "A\nc = 0.25 mm", "C\nc = 0.8 mm"} <= set(words)
    motion = scene.ideal.at(np.array([0.1]))
    for k in range(len(linkage.bodies)):
        centre = motion.position[0, 3 * k : 3 * k + 2]
        marks = [np.ravel(line.get_xydata()) for line in axes.lines if line.get_marker() == "+"]
        assert any(np.allclose(mark, centre, atol=1e-12) for mark in marks)
    assert words.count("11 rad/s") == 2


def test_a_run_up_leaves_the_paths_whole() -> None:
    """The joints' paths are those of a cycle at speed, wherever the mechanism is drawn."""
    slow, plain = (
        labelled(Scene(mechanism=replace(FOUR_BAR, run_up=run_up), joints="B")).sheet.axes[0]
        for run_up in (3, 0)
    )
    for one, other in zip(slow.lines[:4], plain.lines[:4], strict=True):
        lengths = [
            np.hypot(*np.diff(np.asarray(own.get_xydata()), axis=0).T).sum() for own in (one, other)
        ]
        assert lengths[0] == pytest.approx(lengths[1], rel=1e-9)


def test_pins_at_one_place_share_a_text_and_springs_are_drawn() -> None:
    """Two pins join three bars in one place; nothing is written over."""
    third = Bar("third", 0.1, 0.2)
    spring = Spring("coil", "third.tail", (0.3, 0.2), 100.0, 0.1)
    linkage = replace(
        FOUR_BAR,
        bodies=[*FOUR_BAR.bodies, third],
        joints=[*FOUR_BAR.joints, Pin("B2", "rocker.head", "third.head")],
        drives=[*FOUR_BAR.drives, Drive("third", harmonics=[(0.0, 0.1)], frequency=30.0)],
        springs=[spring],
    )
    scene = Scene(linkage, bearings={"B": Bearing(clearance=1e-4)})
    (axes,) = labelled(scene).sheet.axes
    words = [text.get_text() for text in axes.texts]
    assert "B, B2\nc of B = 0.1 mm" in words
    assert "coil" in words
    places = [text.get_position() for text in axes.texts if text.get_fontweight() == "bold"]
    gaps = [math.dist(*pair) for pair in combinations(places, 2)]
    assert len(places) == 4
    assert min(gaps) > 0.01
    coil = max(axes.lines, key=lambda line: np.asarray(line.get_xydata())[:, 0].max())
    assert np.asarray(coil.get_xydata())[-1] == pytest.approx((0.3, 0.2))


@pytest.mark.parametrize(
    ("drive", "phase"),
    [
        (Drive("crank", 30.0), "crank angle"),
        (Drive("crank", -30.0), "crank angle"),
        (Drive("crank", 30.0, harmonics=[(0.0, 0.1)]), "phase of the cycle"),
        (Drive("crank", frequency=20.0, rises=[Rise(0.0, 3.0, math.tau)]), "phase of the cycle"),
    ],
)
def test_the_phase_is_a_crank_angle_only_where_a_crank_turns_with_it(
    drive: Drive, phase: str
) -> None:
    linkage = replace(FOUR_BAR, drives=[drive])
    window = Window(0.0, linkage.period, linkage.period, 0.0, linkage.phase, "")
    axes = Sheet().subplots()
    window.label(axes)
    assert axes.get_xlabel() == f"{phase} since the start (degrees)"


def test_loads_are_drawn_where_they_act() -> None:
    """A force as an arrow to its point, a moment as a bent one around the mass centre."""
    scene = Scene(mechanism=FOUR_BAR, joints="B")
    loads: list[AnyLoad] = [
        Force("rocker.head", 0.5, 3.0),
        Moment("crank", Harmonics(1.0)),
        Load("coupler", 2.0),
    ]
    loaded = replace(scene, mechanism=replace(FOUR_BAR, loads=loads))
    (axes,), (plain,) = (labelled(own).sheet.axes for own in (loaded, scene))
    assert len(axes.patches) == len(plain.patches) + 3
    red = [own for own in axes.patches if own.get_edgecolor() == to_rgba("tab:red")]
    position = scene.ideal.at(np.zeros(1)).position[0]
    angle = position[8]
    head = position[6:8] + 0.06 * np.array([math.cos(angle), math.sin(angle)])
    assert len(red) == 3
    for place in (head, position[3:5]):
        gaps = [np.abs(np.asarray(own.get_path().vertices) - place).max(axis=1) for own in red]
        # The head's corner is rounded; its tail is 40 mm away.
        assert min(float(gap.min()) for gap in gaps) < 2e-3


def test_stage_names() -> None:
    assert [stage_name(k) for k in (0, 1, 10, 11)] == [
        "no wear",
        "first wear",
        "tenth wear",
        "wear 11",
    ]


@pytest.mark.parametrize(
    ("value", "expected"), [(1.0, 1.0), (1.99, 1.0), (4.9, 2.0), (0.07, 0.05), (730.0, 500.0)]
)
def test_round_down(value: float, expected: float) -> None:
    assert round_down(value) == pytest.approx(expected)


def test_length_scale_reads_naturally() -> None:
    assert length_scale(1.2e-5) == (1e6, "µm")
    assert length_scale(0.0015) == (1e3, "mm")
    assert length_scale(0.0)[1] == "pm"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1369.2, "1\u202f370"),
        (-0.9448, "−0.945"),
        (999.9, "1\u202f000"),
        (2.5e-9, "2.50·10⁻⁹"),
        (12.34e6, "12.3·10⁶"),
        (None, "–"),
        (float("nan"), "–"),
    ],
)
def test_readable(value: float | None, text: str) -> None:
    assert readable(value) == text


@pytest.mark.parametrize(
    ("values", "digits", "text"),
    [
        ([4.5e6], 3, "4.5 million"),
        ([8.70e6, 9.54e6], 2, "8.7 to 9.5 million"),
        ([4.0, 1.739e6], 3, "0 to 1.74 million"),
        ([123456.0], 2, "120\u202f000"),
        ([999999.0], 3, "1 million"),
        ([1.234e9], 3, "1.23 billion"),
        ([0.0], 3, "0"),
    ],
)
def test_large_counts_are_said(values: list[float], digits: int, text: str) -> None:
    assert large(*values, digits=digits) == text


def test_numbers_with_company() -> None:
    assert with_interval(107.1912, 0.2693) == "107.19\u00a0± 0.27"
    assert with_interval(730.59, 1393.5) == "700\u00a0± 1\u202f400"
    assert with_interval(3.0, None) == "3.00 (too few cycles)"
    assert with_interval(None, None) == "–"
    assert with_interval(5.0, 0.0) == "5.000\u00a0± 0"
    assert (whole(258195), whole(None)) == ("258\u202f195", "–")
    assert (given(2e11), given(0.0243)) == ("2·10¹¹", "0.0243")


def test_short_peaks_leave_the_panels_of_the_drives_and_are_written_there() -> None:
    """A torque of a thousand times the ideal one in a single row of two thousand in a cycle."""
    result = run_scene(replace(ideal(), process=Blanking(), engine="dae", cycles=3))
    (stage,) = result.stages
    exact = ideal_curves(result.scene)["crank 2"].torque
    largest = float(np.abs(exact).max())
    torque = stage.arrays["drive_torque"].copy()
    torque[-100, 0] = -1e3 * largest
    struck = replace(stage, arrays={**stage.arrays, "drive_torque": torque})
    result = replace(result, stages=(struck,))
    (drawing,) = drawings(result, ["drives"])
    axes = drawing.sheet.axes[0]
    low, high = axes.get_ylim()
    assert low < exact.min() < exact.max() < high
    assert high - low < 1.3 * float(np.ptp(exact))
    assert axes.get_title(loc="right") == f"farthest: {readable(-1e3 * largest)} N m"


@drawn(st.floats(0.001, 0.2), st.integers(0, 100))
def test_the_ends_of_most_of_the_time_are_those_of_its_distribution(
    beyond: float, seed: int
) -> None:
    """Of a line from 0 to 1 in steps of any length."""
    time = np.cumsum(np.random.default_rng(seed).uniform(0.0, 2e-4, 10_000))
    time /= time[-1]
    assert within(time, time, beyond) == pytest.approx((beyond, 1.0 - beyond), abs=1e-3)
