"""Report page of small made-up results."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import re
from dataclasses import replace

import made_up_result as made
import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from made_up_result import altered, grown, made_up
from PIL import Image
from refusals import refused
from test_page import Page

import presswear as pw
from presswear.physics.statics import total_clearance
from presswear.results.stage_statistics import StageStatistics, WearPeak
from presswear.scene.catalog import wear_times
from presswear.scene.pin_joints import normal_law_of
from presswear.scene.setting_list import used_settings_of
from presswear.show.figures import drawings
from presswear.show.page import illustrated
from presswear.show.report import render_report, write_report
from presswear.show.scene_tables import setting_tables
from presswear.show.stage_tables import stage_tables


def page_of(result: pw.Result) -> Page:
    return Page(render_report(result))


def test_one_file_without_references(tmp_path):
    result = replace(made_up(made.ONE, 2), path=tmp_path)
    path = write_report(result)
    assert path == tmp_path / "report.html"
    text = path.read_text()
    page = Page(text)
    links = [link for link in page.links if not link.startswith("#")]
    assert page.tags.count("svg") == len(list((tmp_path / "figures").iterdir())) == 9
    assert all(link.startswith("data:image/png;base64,") for link in links)
    text = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", text)
    assert not re.search(r"https?:|url\((?!#)|@import|<script\b[^>]|<link", text)
    assert page.tags.count("script") == 1
    with refused("ran in memory"):
        write_report(replace(result, path=None))


def test_a_short_report_states_the_command_that_draws_the_other_figures(tmp_path):
    """Figures of the report before it are removed, files of the user stay."""
    folder = tmp_path / "two words"
    folder.mkdir()
    result = replace(made_up(made.BOTH, 2), path=folder)
    assert "adds the others" not in page_of(result).text
    figures = folder / "figures"
    illustrated(drawings(result, ["bottom", "phase"]), figures)
    kept = {"photograph.png", "notes.png", "sketch.svg"}
    for name in kept:
        (figures / name).write_bytes(b"not drawn by the program")
    Image.new("RGB", (2, 2)).save(figures / "photograph.png")
    page = Page(write_report(result, has_all_figures=False).read_text())
    assert f"This command adds the others: presswear report '{folder}'" in page.text
    assert page.row("first wear")
    names = {path.name for path in figures.iterdir()}
    assert {"mechanism.svg", *kept} < names
    assert len(names) == 4 + len(kept)


def test_sections_and_spectra_are_drawn_on_request_from_ten_cycles_on(tmp_path):
    result = replace(made_up(made.BOTH, 1), path=tmp_path)
    with refused("poincare needs 10 recorded cycles, and the"):
        write_report(result, extra_figures=["poincare"])
    with refused("unknown figure of many cycles 'force'"):
        write_report(result, extra_figures=["force"])
    time = 5.5 * result.stages[0].time
    many = altered(result, 0, arrays={**result.stages[0].arrays, "time": time})
    assert (
        "Poincaré section"
        in write_report(
            many, extra_figures=["poincare"], has_all_figures=False
        ).read_text()
    )
    assert (
        "Poincaré section" not in write_report(many, has_all_figures=False).read_text()
    )


def test_tables_whose_series_an_earlier_version_did_not_record_are_left_out():
    result = made_up(made.BOTH, 2)
    assert "Recorded cycles after the start-up" in page_of(result).text
    for stage in result.stages:
        del stage.arrays["A_sliding"]  # type: ignore[attr-defined]
    text = page_of(result).text
    assert (
        "A table is left out. joint A: its sliding was not stored; run the scene again"
        in text
    )
    assert "presswear 0.1.0 wrote the result." in text
    assert "Recorded cycles after the start-up" not in text


def test_stages_are_columns():
    result = made_up(made.ONE, 3)
    page = page_of(result)
    assert ["no wear", "first wear", "second wear"] in page.rows
    for label, numbers in {
        "error of bottom dead centre (µm)": [f"−{k}60\u00a0± 30" for k in (7, 8, 9)],
        "change since the first stage (µm)": ["–", "−100\u00a0± 42", "−200\u00a0± 42"],
        "repeatability (µm)": ["40\u00a0(30\u00a0to\u00a060)"] * 3,
        "largest normal force (N)": ["100", "101", "102"],
    }.items():
        assert page.numbers(label, 3) == numbers
    clearance = page.numbers("total clearance at the slider (µm)", 3)
    origin = "(10 times the weight of all bodies, at least 100 N)"
    assert f"under 100 N up and down {origin}" in page.text
    scenes = [replace(made.ONE, surfaces=stage.surfaces) for stage in result.stages]
    expected = [1e6 * total_clearance(scene.linkage()) for scene in scenes]
    values = [float(text.replace("\u202f", "")) for text in clearance]
    assert values == pytest.approx(expected, rel=1e-3)
    assert expected[0] < expected[1] < expected[2]


@pytest.mark.parametrize(
    ("degrees", "text"),
    [
        ((355.5, 350.0, 365.0), "355.5 (350.0 to 5.0)"),
        # half of the samples are deepest in the opposite groove
        ((182.0, -156.0, 182.0), "182 (no single place)"),
        ((92.5,), "92.5 (too few cycles)"),
    ],
)
def test_angles_stay_within_a_turn(degrees, text):
    result = made_up(made.BOTH, 2)
    statistics = result.stages[0].statistics
    peak = WearPeak(
        pw.statistics.Estimate(1e-5),
        pw.statistics.Estimate(*np.radians(degrees).tolist()),
    )
    joint = replace(statistics.joints["A"], wear_peaks={"both": peak})
    result = altered(
        result, 0, statistics=replace(statistics, joints={"A": joint, "C": joint})
    )
    row = page_of(result).row(
        "next wear update: angle of the deepest, bearing + pin (degrees)"
    )
    assert row[1].replace("\u00a0", " ") == text


def test_key_numbers_and_means():
    page = page_of(made_up(made.BOTH, 3))
    for label, numbers in {
        "deepest wear at the start, bearing + pin (µm)": ["0", "10.0", "20.0"],
        "angle of deepest wear, bearing + pin (degrees)": ["–", "92.50", "92.50"],
        "next wear update: volume (mm³)": ["3.00 (too few cycles)"] * 3,
        "next wear update: deepest, bearing + pin (µm)": ["5.00 (too few cycles)"] * 3,
        "delay as crank angle (degrees)": ["−1.8\u00a0± 1.0"] * 3,
    }.items():
        assert page.numbers(label, 3) == numbers
    remark = "bins of 1°; twice as many bins halve it"
    assert page.row("next wear update: volume (mm³)")[1] == remark
    assert page.numbers("delay (ms)", 3) == ["−3.00 (too few cycles)"] * 3
    growth = page_of(grown())
    assert growth.row("cycles represented")[1:] == ["3.00·10⁶"] * 2
    assert growth.row("deepest wear of the bearing afterwards (µm)")[1:] == [
        "3.00",
        "6.00",
    ]
    turning = page_of(made_up(made.BODY, 2))
    assert turning.row("deepest wear at the start, pin (µm)")[1:] == ["0", "5.00"]


def test_failed_stages():
    message = "stage 1: Newton's method found no solution <at all>"
    failed = made_up(made.BOTH, 2, "failed", message)
    page = page_of(failed)
    assert f"Failed: {message}" in page.words
    assert page.row("first wear")[1] == f"failed: {message}"
    assert "The stage “first wear” failed and is not shown here." in page.text
    empty = page_of(altered(failed, 1, statistics=StageStatistics(cycles=0)))
    assert empty.row("largest acceleration (m/s²)")[1:] == ["1\u202f220"]
    assert empty.row("largest normal force (N)")[1:] == ["100"]
    alone = page_of(made_up(made.BOTH, 1, "failed", "no step"))
    assert "No stage ran far enough for a number." in alone.text
    assert (
        "Unfinished: 1 of 3 stages are stored;"
        in page_of(made_up(made.BOTH, 1, "running")).text
    )


OWN_FOUR_BAR = pw.Scene(
    FOUR_BAR, bearings={"B": pw.Bearing(clearance=0.3e-3)}, wear_updates=0
)
RADIAL = "Contact on worn surfaces is radial"
OWN = "sampled cycles of 4 replicates, and after a wear update the replicates, each on surfaces of"


@pytest.mark.parametrize(
    ("scene", "stages", "present", "absent"),
    [
        (made.BOTH, 2, f"{RADIAL} & {OWN}", "presses on work"),
        (made.BODY, 2, "axis of the body (thin arrow", RADIAL),
        (made.IDEAL, 1, "No joint has clearance", "no two strokes are equal"),
        (
            OWN_FOUR_BAR,
            1,
            "positions of the rocker are 111 mm apart & 300 µm at B & "
            "guides (O, A, P) have no friction, so torque",
            "slider",
        ),
        (
            wear_times(running_in=30, pressure_exponent=0.65, wear_coefficient=2e-16),
            1,
            "with K_d = 2·10⁻⁷ mm³/(N m) (set by the user); rho = 30 (set by the user); "
            "h_0 = 0.0003 mm (the roughness); m = 0.65 (set by the user); "
            "p_ref = 10 MPa (assumed). & New surfaces wear 30 times as fast. & "
            "to the power of 0.65, and the coefficient is that at 10 MPa.",
            "constant over the strokes",
        ),
    ],
)
def test_sentences_fit_the_scene(scene, stages, present, absent):
    text = page_of(made_up(scene, stages)).text
    assert all(words in text for words in present.split(" & "))
    assert absent not in text


def test_a_four_bar_has_no_strokes_and_no_dead_centre():
    text = page_of(made_up(OWN_FOUR_BAR, 2)).text.partition("Completed")[2]
    assert "The number of cycles is 286 per minute." in text
    assert "error of the lowest position (µm)" in text
    assert not re.search(r"(?i)\bstrokes?\b|dead centre", text)
    captions = " ".join(
        f"{drawing.title} {drawing.caption}"
        for drawing in drawings(made_up(OWN_FOUR_BAR, 2))
    )
    assert "Lowest position" in captions
    assert not re.search(r"(?i)\bstrokes?\b|dead centre", captions)


def test_settings_changes_and_provenance():
    page = page_of(made_up(made.BOTH, 1))
    listed = {(row[0], row[-1]) for row in page.rows if row}
    settings = used_settings_of(made.BOTH)
    assert {(setting.key, setting.meaning.text) for setting in settings} <= listed
    assert page.row("clearance")[1:3] == ["0.8 mm", "paper, per study"]
    assert page.row("source revision")[1] == "0123456789ab"
    changed = page_of(made_up(wear_times(clearance="0.5 mm", wear_updates=1), 1))
    title = f"{wear_times().title}, changed: clearance 0.5 mm, wear updates 1"
    assert changed.words.count(title) == 2
    assert changed.row("clearance")[:4] == ["clearance", "0.5", "0.8", "mm"]


OWN_BEARINGS = """
[mechanism]
kind = "slider-crank"

[bearings]
joints = "O, A"
materials = "304L-304L"

[bearings.O]
clearance = "0.1 mm"
friction = 0.1

[bearings.A]
clearance = "0.2 mm"
"""


def origins(scene: pw.Scene) -> dict[str, tuple[str, str]]:
    """Return value and origin of each setting that the report lists."""
    table = setting_tables(made_up(scene, 1))["parameters"]
    return {
        key: (value, origin)
        for _, lines in table.groups
        for key, value, origin, _ in lines
    }


def test_values_of_single_bearings_are_those_of_the_user(tmp_path):
    """Values that no joint or law uses are left out."""
    file = tmp_path / "mine.toml"
    file.write_text(OWN_BEARINGS)
    rows = origins(pw.scene_from(file))
    in_file = "set by the user, in the file"
    assert rows["O.clearance"] == ("0.1 mm", in_file)
    assert rows["A.clearance"] == ("0.2 mm", in_file)
    assert rows["O.friction"] == ("0.1", in_file)
    assert rows["friction"] == ("0.02", "default")  # of A
    assert rows["materials"] == ("304L-304L", in_file)
    assert rows["wear_coefficient"][1] == "set by the user"  # by the materials
    assert "bearing_radius" in rows
    assert not rows.keys() & {
        "clearance",
        "stribeck_speed",
        "roughness",
        "tree_tolerance",
    }
    bearings = {
        "O": pw.Bearing(clearance=1e-4),
        "A": pw.Bearing(clearance=2e-4, friction=0.1),
    }
    rows = origins(pw.Scene(pw.SliderCrank(rod_length=0.2), bearings=bearings))
    assert rows["clearance"] == ("0.1 mm", "set by the user")
    assert rows["A.friction"] == ("0.1", "set by the user")
    assert rows["rod_length"] == ("200 mm", "set by the user")
    assert rows["crank_length"] == ("50 mm", "default")


def test_bodies_joints_and_contacts_are_listed():
    page = page_of(made_up(OWN_FOUR_BAR, 1))
    inertia = OWN_FOUR_BAR.linkage().bodies[1].inertia
    assert page.row("coupler")[1:3] == ["500 g", f"{1e6 * inertia:.6g} kg mm²"]
    x, y, angle = OWN_FOUR_BAR.ideal.at(np.zeros(1)).position[0, 3:6]
    shown = [float(text) for text in page.row("coupler")[3:6]]
    assert shown == pytest.approx([1e3 * x, 1e3 * y, np.degrees(angle)], rel=1e-4)
    assert page.row("crank")[-1] == f"{30 * 30 / np.pi:.3f} rpm"
    bearing = OWN_FOUR_BAR.bearing("B")
    stiffness = normal_law_of(bearing, OWN_FOUR_BAR.conventions).stiffness
    places = ["coupler: 100, 0", "rocker: 60, 0"]
    contact = ["14.700", f"{1e-9 * stiffness:.4g}·10⁹", f"{0.75 * (1.0 - 0.9**2):.4f}"]
    assert page.row("B")[1:] == places + contact
    assert page.row("P")[1:] == ["frame: 180, 0", "rocker: −60, 0", "–", "–", "–"]
    press = page_of(made_up(made.ONE, 1))
    assert press.row("guide, along 90°")[1:3] == ["frame: 240, 0", "slider 6: 0, 0"]
    assert press.row("slider 6")[1:3] == ["28.8 g", "–"]  # the guide holds its angle


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree", "exudyn-joints"])
def test_every_number_of_a_solver_has_a_name_and_a_unit(engine):
    steps = {"steps_per_contact": "20", "free_steps": "1000"}  # of exudyn-joints
    scene = pw.changed(OWN_FOUR_BAR, {"engine": engine, **steps})
    result = pw.run(replace(scene, cycles=1, replicates=1))
    diagnostics = stage_tables(result)["diagnostics"]
    ((_, lines),) = diagnostics.groups
    names = [line[0] for line in lines]
    # One diagnostic, the model, is a sentence outside of the table.
    assert len(names) == len(result.stages[0].diagnostics) - 1
    assert any(re.fullmatch(r"energy residual \([µm]?J\)", name) for name in names)
    assert not any(re.search(r" (J|m|s|m/s)$", name) for name in names)
    packages = page_of(result).row("packages")[1]
    assert re.search("; exudyn [0-9.]+, module (fast|safe); numpy", packages)


GUIDED = pw.Press(guide_length=0.4, guide_width=0.3)
PLAY = pw.Bearing(clearance=5e-5)
OF_PINS = {"contact-force.png", "centre-trajectory.png", "modes.png", "wear-depth.png"}


def test_a_guide_with_clearance_is_stated_and_its_corners_are_no_pins():
    scene = pw.Scene(GUIDED, bearings={"A": pw.Bearing(), "guide": PLAY}, cycles=2)
    result = made_up(scene, 1)
    text = page_of(result).text
    assert "50.0 µm between slider 6 and each of two walls" in text
    assert "left front" not in text
    assert "greatest tilt in a stroke (µm/m)" in text
    assert "600 kg mm²" in text  # 28.8 g (0.4^2 + 0.3^2) / 12
    assert "96.0" in str(result)  # mm^3: 1.2e-15 1/Pa times 80 N m, a million times
    assert {drawing.file for drawing in drawings(result)} >= OF_PINS


def test_a_printed_result_has_the_mean_peak_force_with_its_interval():
    result = made_up(pw.scenes.wear_times(), 0)
    head, first = str(result).splitlines()[1:3]
    joint = result.stages[0].statistics.joints["A"]
    assert "mean peak force (N)" in head
    assert f"  {joint.peak_force_per_cycle}  " in first
    assert joint.peak_force_per_cycle.has_interval


def test_a_rigid_run_has_no_columns_of_joints_and_tables_no_empty_heads():
    result = made_up(made.IDEAL, 1)
    head, row = str(result).splitlines()[1:3]
    assert head.split() == ["stage", "cycles", "ended"]
    assert row.split()[-1] == "completed"
    for texts in page_of(result).rows:
        assert any(texts), "a row without a text"


def test_a_guide_alone_has_no_figures_of_pins():
    scene = pw.Scene(GUIDED, bearings={"guide": PLAY}, cycles=2)
    result = made_up(scene, 1)
    text = page_of(result).text
    assert "Joints with clearance" not in text
    assert "Peak joint force" not in text
    keys = {setting.key for setting in used_settings_of(scene)}
    assert not {"bearing_radius", "running_in", "angles"} & keys
    assert {"friction", "clearance", "width", "wear_coefficient"} <= keys
    files = {drawing.file for drawing in drawings(result)}
    assert not OF_PINS & files
    assert {"response.png", "phase.png"} <= files
