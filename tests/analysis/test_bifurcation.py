"""Bifurcation diagrams: parameters, continuation, resuming, periods."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from refusals import refused

import presswear as pw
from presswear.analysis import bifurcation
from presswear.analysis.pins import CONTACT_GAP, move_pins, slides
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Start
from presswear.engines.settings import InHouse
from presswear.physics.constraints import constraints_of
from presswear.results.provenance import provenance
from presswear.scene.settings import changed
from presswear.show.figures.dynamics import draw_diagram

SCENE = pw.scenes.slider_crank()
CYCLES = bifurcation.Cycles(12, 6, 0)


def test_parameter_is_read_with_its_unit():
    clearance = bifurcation.Parameter.parse("clearance=0.01:0.05:5 mm", SCENE)
    assert_allclose(clearance.values, 1e-5 * np.arange(1, 6), rtol=1e-12)
    speed = bifurcation.Parameter.parse("speed=2pi:12pi:3 rad/s", SCENE)
    # Values of a range have 12 digits.
    assert_allclose(speed.values, np.pi * np.array([2.0, 7.0, 12.0]), rtol=5e-12)
    assert speed.unit == "rad/s"
    assert bifurcation.Parameter.parse("B.friction=0.1:0:2", SCENE).values == (0.0, 0.1)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("speed", "KEY=FIRST:LAST:COUNT"),
        ("speed=1:2", "FIRST:LAST:COUNT"),
        ("speed=1:2:3", "no unit"),
        ("speed=1 rad/s", "two different values"),
        ("sped=1:2:3", "did you mean speed"),
        ("speed=0:20:5 rad/s", "speed = 0"),
        ("speed=1:20:5 mm", "unknown unit 'mm'"),
        ("cycles=1:20:5", "not a count"),
        ("engine=dae,exudyn", "not a count or a choice"),
    ],
)
def test_bad_parameters_are_refused(text, message):
    with refused(message):
        bifurcation.Parameter.parse(text, SCENE)


def test_pins_keep_their_positions_relative_to_the_clearance():
    previous = SCENE.linkage()
    scene = pw.scenes.slider_crank(clearance="0.4 mm", speed="500 rad/s")
    run = bifurcation.ENGINE.simulate(
        previous, start_of(SCENE), Plan(SCENE.mechanism.period, 3, 1)
    )
    linkage = scene.linkage()
    start = bifurcation.continued(linkage, previous, run.end, start_of(scene))
    phi, phi_t, *_ = constraints_of(linkage).evaluate(
        0.0, start.position, start.velocity
    )
    assert np.abs(phi).max() < 1e-12
    assert np.abs(phi_t).max() < 1e-9
    # The rows of the closed joint are the last but those of guide and drive.
    rows = slice(2 * len(linkage.revolutes), 2 * len(linkage.revolutes) + 2)
    before, after = (
        constraints_of(each.ideal).evaluate(0.0, end.position, end.velocity)[0][rows]
        for each, end in ((previous, run.end), (linkage, start))
    )
    cap = min(1.0, (1.0 - CONTACT_GAP) * 5e-4 / np.hypot(*before))
    assert_allclose(after, 0.8 * cap * before, rtol=1e-6)
    scaled = 500.0 / previous.drives[0].speed * run.end.velocity
    assert_allclose(start.velocity, scaled, rtol=0.0, atol=0.3)


def test_a_stopped_branch_is_resumed(tmp_path):
    parameter = bifurcation.Parameter.parse("clearance=0.01:0.05:4 mm", SCENE)
    for values, name in (
        (parameter.values, "whole"),
        (parameter.values[:2], "parts"),
        (parameter.values, "parts"),
    ):
        file = tmp_path / f"{name}.npz"
        bifurcation.run_branch(
            SCENE, parameter.key, values, CYCLES, start_of, file, lambda *report: None
        )
    whole, parts = (
        bifurcation.read_branch(tmp_path / f"{name}.npz") for name in ("whole", "parts")
    )
    assert whole.tobytes() == parts.tobytes()
    assert parts.value.tolist() == list(parameter.values)


def test_periods_of_two_clearances(tmp_path):
    """At 10 um the motion has the period of the crank; at 0.3 mm none within 60 cycles."""
    parameter = bifurcation.Parameter.parse("clearance=0.01:0.3:2 mm", SCENE)
    diagram = bifurcation.compute(
        SCENE, parameter, bifurcation.Cycles(60, 30, 4), tmp_path, start_of, 1
    )
    for direction in bifurcation.DIRECTIONS:
        branch = diagram.branches[direction]
        periods = dict(zip(branch.value, diagram.periods(direction), strict=True))
        small = periods[1e-5]
        large = periods[3e-4]
        assert (small.period, large.period) == (1, None)
        assert branch.exponent[branch.value == 3e-4][0][0] > 0.0
    assert "periodic at 1 of 2 values" in diagram.summary()[0]
    assert bifurcation.load_diagram(tmp_path).summary() == diagram.summary()
    assert draw_diagram(diagram).sheet.axes
    with refused("a diagram with another cycles"):
        bifurcation.compute(SCENE, parameter, CYCLES, tmp_path, start_of, 1)


def test_a_failed_run_leaves_a_gap(monkeypatch, tmp_path):
    """With far too large steps all numbers are NaN, and the next value starts anew."""
    monkeypatch.setattr(
        bifurcation, "ENGINE", pw.engines.InHouse("rk4", equal_step=1e-2)
    )
    parameter = bifurcation.Parameter("speed", (1.0, 2.0), "rad/s")
    file = tmp_path / "up.npz"
    cycles = bifurcation.Cycles(12, 6, 0)
    bifurcation.run_branch(
        SCENE, "speed", (100.0,), cycles, start_of, file, lambda *report: None
    )
    branch = bifurcation.read_branch(file)
    assert np.isnan(branch.pins).all()
    start = start_of(changed(SCENE, {"speed": 100.0}))
    assert_array_equal(branch.end[0], [start.position, start.velocity])
    diagram = bifurcation.Diagram(
        SCENE, parameter, CYCLES, {"up": branch}, provenance()
    )
    assert diagram.periods("up") == [None]
    assert "1 runs failed" in diagram.summary()[0]


def test_a_slide_keeps_its_place_and_tilt_relative_to_the_clearance():
    """Two opposite corners that press on their walls open; the rod hangs from the slide."""
    scenes = [pw.scenes.press_off_centre(clearance=f"{c} mm") for c in (0.05, 0.1)]
    narrow, wide = (scene.linkage() for scene in scenes)
    ideal = start_of(scenes[0])
    pins = np.zeros((0, 2))
    for place, tilt, part in ((20e-6, -100e-6, 1.0), (30e-6, 250e-6, 50.0 / 80.0)):
        at = np.array([[place, tilt]])
        end = Start(move_pins(narrow, ideal.position, pins, at), ideal.velocity)
        assert slides(narrow, end.position) == pytest.approx(at, rel=1e-9)
        start = bifurcation.continued(wide, narrow, end, ideal)
        wanted = 2.0 * part * at
        assert slides(wide, start.position) == pytest.approx(wanted, rel=2e-4)
        assert slides(narrow, ideal.position) == pytest.approx(0.0, abs=1e-12)
        run = InHouse().for_cycle(1.0).simulate(wide, start, Plan(1e-4, 1))
        assert run.status == "completed"
        assert all(run.recorder.stored_contacts(k).size == 0 for k in range(4))


def test_unit_of_the_user_is_that_of_the_axis():
    parse = bifurcation.Parameter.parse
    for text, unit, factor in (
        ("speed=100:200:3 rpm", "rpm", 30.0 / np.pi),
        ("speed=2pi:12pi:3 rad/s", "rad/s", 1.0),
        ("speed=4pi rad/s,8pi rad/s", "rad/s", 1.0),
        ("clearance=10um:50um:3", "µm", 1e6),
        ("clearance=1e-5:2e-5:3 m", "m", 1.0),
        ("B.friction=0:0.1:2", "", 1.0),
    ):
        shown_factor, shown_unit = parse(text, SCENE).factor_and_unit
        assert shown_factor == pytest.approx(factor)
        assert shown_unit == unit


def test_numbers_of_each_cycle_are_those_of_a_run(tmp_path):
    """The first value starts as a run does, so that its cycles are those of that run."""
    parameter = bifurcation.Parameter.parse("clearance=0.01:0.02:2 mm", SCENE)
    diagram = bifurcation.compute(SCENE, parameter, CYCLES, tmp_path, start_of, 1)
    scene = changed(SCENE, {"clearance": 1e-5})
    plan = Plan(scene.mechanism.period, CYCLES.total, 1, sections=bifurcation.PHASES)
    recorder = bifurcation.ENGINE.simulate(scene.linkage(), start_of(scene), plan)
    each_cycle = recorder.recorder.each_cycle
    last = slice(-CYCLES.stored, None)
    for name, numbers in (
        ("B.force_max", each_cycle("force_max", 0)),
        ("bottom_height", each_cycle("bottom_height")),
    ):
        assert_array_equal(diagram.numbers(name, "up")[0], numbers[last])
    drive = recorder.recorder.cycles[last, -2]
    assert_array_equal(diagram.numbers("crank.torque_peak", "up")[0], drive)
    with refused(r"did you mean B\.force_max"):
        diagram.numbers("B.force", "up")
    frame = pw.load_diagram(tmp_path).to_pandas()
    assert len(frame) == 2 * 2 * CYCLES.stored
    assert frame.attrs["units"]["crank_torque_peak"] == "N m"
    assert set(frame.attrs["units"]) == set(frame.columns)
    rows = frame[(frame.clearance == 1e-5) & (frame.is_decreasing == 0.0)]
    assert_array_equal(rows.B_force_max, each_cycle("force_max", 0)[last])
    assert rows.cycle.tolist() == [7.0, 8.0, 9.0, 10.0, 11.0, 12.0]


def test_a_folder_of_a_diagram_is_reported_and_exported(tmp_path, command, monkeypatch):
    monkeypatch.chdir(tmp_path)
    over = "--over 'speed=1000:1100:2 rpm' --cycles 12 --stored 5 --exponent 0 --out d"
    assert "presswear report d" in command(f"dynamics slider-crank {over}")
    assert "report in d/report.html" in command("report d --figures bottom_height")
    page = (tmp_path / "d/report.html").read_text()
    assert "2 of 2 values with increasing speed" in page
    assert "speed (rpm)" in page
    files = {file.name for file in (tmp_path / "d/figures").iterdir()}
    names = {"diagram.svg", "diagram-B.force_max.svg", "diagram-bottom_height.svg"}
    assert files == names
    command("report d --figures B.force", 2)
    command("report d --format pdf", 2)
    assert "20 rows of " in command("export d d.csv")
    text = (tmp_path / "d.csv").read_text()
    assert "speed rad/s" in text.splitlines()[1]
    rows = np.genfromtxt(tmp_path / "d.csv", names=True, delimiter=",")
    assert_allclose(np.unique(rows["speed"]), np.pi / 30 * np.array([1000.0, 1100.0]))
    assert "20 rows of " in command("export d d.mat")
    command("export d e.csv --cycles", 2)
    with refused(r"pw\.load_diagram reads it|which pw\.load"):
        pw.load("d")
