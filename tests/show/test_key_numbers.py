"""Key numbers and warnings of made-up results."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import re
from dataclasses import replace

import made_up_result as made
import numpy as np
import pytest
from made_up_result import altered, lived, made_up

import presswear as pw
from presswear.recording.settling import Settling
from presswear.recording.statistics import Estimate, spread
from presswear.results.rigid_joints import ideal_drives, rubbing_drives
from presswear.show.drive_numbers import IDEAL, RUBBING
from presswear.show.key_number import measured
from presswear.show.key_numbers import key_numbers
from presswear.show.page import FirstScreen, KeyNumber, render_page
from presswear.show.report import first_screen
from presswear.show.warnings import warnings
from presswear.tools.numbers import quantity_text


@pytest.mark.parametrize(
    ("estimate", "value", "interval", "note"),
    [
        (Estimate.symmetric(225e3, 0.0, 30), "225 kN", "", ""),
        (Estimate.symmetric(150.0, 260.0, 30).positive, "150 N", "27 to 850 N", ""),
        (Estimate(150.0, samples=40), "150 N", "interval unknown", "scatters too much"),
        (
            Estimate(150.0, samples=1),
            "150 N",
            "interval unknown",
            "from 1 stroke, too few",
        ),
        # the standard deviation of two cycles in each of two runs
        (
            Estimate(150.0, 1e-20, 1e20, 4),
            "150 N",
            "interval unknown",
            "from 4 strokes, too few",
        ),
        (
            Estimate.symmetric(150.0, 3.0, 19),
            "150 N",
            "147 to 153 N",
            "from 19 strokes",
        ),
        (Estimate.symmetric(-150.0, 100.0, 20), "−150 N", "−250 to −50 N", ""),
    ],
)
def test_a_number_of_few_strokes_is_shown_with_their_count(
    estimate, value, interval, note
):
    number = measured("force", estimate, "N", "")
    assert (number.value, number.interval, number.note) == (value, interval, note)
    text = render_page("a title", FirstScreen(key_numbers=[number]))
    assert ('class="value few"' in text) == bool(note)
    assert value in text
    assert note in text


def test_an_interval_of_a_positive_number_is_that_of_its_logarithm():
    wide = Estimate.symmetric(2.0, 1.0, 5).positive
    assert wide.low * wide.high == pytest.approx(4.0)
    assert wide.high == pytest.approx(2.0 * 1.6487, rel=1e-4)
    assert Estimate.symmetric(1.0, 3.0, 2).positive == Estimate(1.0, samples=2)


def test_a_pin_pressure_that_no_bush_bears_is_a_warning():
    """With a limit from the file, the limit decides."""
    for limit, count in ((None, 1), (1e5, 0)):
        bearing = pw.Bearing(
            bearing_radius=1e-3, clearance=1e-4, width=1e-4, pressure_limit=limit
        )
        lines = warnings(made_up(replace(made.BOTH, bearings=bearing), 2))
        found = [
            line for line in lines if "the pin pressure of joints A and C is" in line
        ]
        assert len(found) == count


def test_numbers_of_several_stages_have_their_surfaces():
    """A life, the stroke and a flywheel are those of all stages."""
    result = made_up(made.BOTH, 2)
    statistics = result.stages[1].statistics
    joints = {
        name: replace(joint, wear_peaks={}) for name, joint in statistics.joints.items()
    }
    result = altered(result, 1, statistics=replace(statistics, joints=joints))
    stages = {number.name: number.stage for number in key_numbers(result)}
    worn = "after 2 million strokes"
    for name in ("Repeatability", "Peak joint force", "Improve first"):
        assert stages[name] == worn
    assert stages["Wear per million strokes"] == "on new surfaces"
    assert stages["Stroke"] == stages["Strokes a minute"] == ""
    screen = first_screen(result)
    assert screen.limits_stage == worn
    text = render_page("a title", screen)
    assert f'Peak joint force<span class="quiet">, {worn}</span>' in text
    assert f'Limits <span class="quiet">{worn}</span>' in text
    single = first_screen(made_up(made.BOTH, 1))
    assert not single.limits_stage
    assert not any(number.stage for number in single.key_numbers)
    by_life = {
        number.name: number.stage
        for number in key_numbers(lived(made_up(made.BODY, 3)))
    }
    assert by_life["Service life"] == by_life["Improve first"] == ""
    assert by_life["Peak joint force"] == "after 4 million strokes"


def test_round_off_is_no_mean_power():
    scene = pw.changed(pw.scenes.slider_crank(), {"friction": 0.0})
    numbers = {number.name: number for number in key_numbers(made_up(scene, 2))}
    meaning = numbers["Peak drive power"].meaning
    assert "at crank; mean 0 W. Computed with rigid joints without friction;" in meaning


@pytest.mark.parametrize("torques", ["on", "off"])
def test_drives_are_compared_to_rigid_joints_with_and_without_friction(torques):
    """What friction needs is not the work of clearance."""
    scene = replace(made.BOTH, drive_torque=torques)
    scene = pw.changed(scene, {"friction": 0.1})
    numbers = {number.name: number for number in key_numbers(made_up(scene, 2))}
    for name, unit in (("torque", "N m"), ("power", "W")):
        number = numbers[f"Peak drive {name}"]
        compared = dict(number.compared)
        for words, duties in (
            (RUBBING, rubbing_drives(scene)),
            (IDEAL, ideal_drives(scene)),
        ):
            peak, body = max(
                (abs(getattr(duty, name).peak), body) for body, duty in duties.items()
            )
            place = "" if f" at {body};" in number.meaning else f" at {body}"
            assert compared[words] == quantity_text(peak, unit) + place
    frictionless = pw.changed(scene, {"friction": 0.0})
    (row,) = {
        number.compared
        for number in key_numbers(made_up(frictionless, 2))
        if "torque" in number.name
    }
    assert [words for words, _ in row] == [IDEAL]


def test_powers_of_drives_are_added():
    """A drive may brake while the other one drives, and a motor with a flywheel turns both."""
    result = made_up(replace(made.BOTH, drive_torque="on"), 2)
    meanings = {number.name: number.meaning for number in key_numbers(result)}
    total = sum(drive.duty.power.mean for drive in result.drives(1).values())
    meaning = meanings["Peak drive power"]
    assert f"mean of all drives together {quantity_text(total, 'W')}." in meaning
    # Drives that brake together need no motor.
    assert ("A motor with a flywheel delivers this mean" in meaning) == (total > 0.0)


def test_a_life_comes_first_and_names_its_joint():
    first, *_, last = key_numbers(lived(made_up(made.BODY, 3)))
    assert (first.name, first.value) == ("Service life", "5 million strokes")
    assert first.interval == "3 to 8.3 million strokes"
    assert (last.value, last.meaning) == ("joint C", "It ends the service life.")


@pytest.mark.parametrize(
    ("volume", "half", "first"),
    [(0.5, 0.1, "C"), (0.5, 0.6, "A or C"), (0.95, 0.01, "A or C")],
)
def test_joints_that_hardly_differ_are_both_named(volume, half, first):
    result = made_up(made.BOTH, 2)
    statistics = result.stages[1].statistics
    volumes = {
        "A": Estimate.symmetric(volume, half),
        "C": Estimate.symmetric(1.0, 0.02),
    }
    joints = {
        name: replace(joint, wear_volume=volumes[name])
        for name, joint in statistics.joints.items()
    }
    worn = altered(result, 1, statistics=replace(statistics, joints=joints))
    found = key_numbers(worn)[-1]
    assert (found.name, found.value) == ("Improve first", f"joint {first}")


def test_energy_made_by_contacts_is_a_warning():
    result = made_up(made.BOTH, 2)
    statistics = replace(result.stages[1].statistics, energy_made_fraction=0.12)
    lines = warnings(altered(result, 1, statistics=statistics))
    expected = "First wear: contact forces create 12 % of the energy"
    assert any(line.startswith(expected) for line in lines)
    assert any("--set contact=foundation, or contact = " in line for line in lines)
    assert not any("create" in line for line in warnings(result))
    (few,) = [
        line
        for line in lines
        if line.startswith("Few strokes: peak forces are means of 2")
    ]
    assert few.endswith("Run more: cycles = 12 or more.")


def test_one_number_of_cycles_is_recommended():
    """Of 2 at the start, then 10 each for the settling, and 20 together for the forces.

    The warning says it once. With enough strokes of many replicates the peak force does.
    """
    for replicates, cycles in ((1, 22), (2, 12), (4, 12)):
        scene = replace(made.BODY, replicates=replicates)
        result = made_up(scene, 1)
        settling = Settling(watched=5, starts=(None,) * replicates, motions=())
        statistics = replace(result.stages[0].statistics, settling=settling)
        result = altered(result, 0, statistics=statistics)
        meanings = [number.meaning for number in key_numbers(result)]
        text = " ".join([*meanings, *warnings(result)])
        assert re.findall(r"cycles = (\d+)", text) == [f"{cycles}"]
        assert text.count("too few to see whether the motion settles") == 1
    enough = replace(Estimate.symmetric(80.0, 12.0), samples=20)
    joints = {
        name: replace(joint, peak_force_per_cycle=enough)
        for name, joint in statistics.joints.items()
    }
    result = altered(result, 0, statistics=replace(statistics, joints=joints))
    text = " ".join(number.meaning for number in key_numbers(result))
    assert (
        "5 strokes are too few to see whether the motion settles; cycles = 12" in text
    )
    assert not any("cycles =" in line for line in warnings(result))


def wear_of(result: pw.Result) -> KeyNumber:
    numbers = {number.name: number for number in key_numbers(result)}
    return numbers["Wear per million strokes"]


def test_wear_depth_is_that_of_the_last_update_with_a_depth():
    known = replace(Estimate.symmetric(4e-6, 1e-7), samples=40)
    result = made_up(made.BOTH, 2)
    last = wear_of(result)
    assert (
        "2 million strokes on worn surfaces, with wear_coefficient = " in last.meaning
    )
    statistics = result.stages[1].statistics
    started = altered(result, 1, statistics=replace(statistics, cycles=4))
    last = wear_of(started)
    assert last.note == "from 2 strokes, too few"  # without those of the start-up
    joint = statistics.joints["A"]
    peak = replace(joint.wear_peaks["both"], depth=known)
    worn = replace(joint, wear_peaks=dict.fromkeys(joint.wear_peaks, peak))
    joints = dict.fromkeys("AC", worn)
    deep = altered(result, 1, statistics=replace(statistics, joints=joints))
    last = wear_of(deep)
    assert last[1:3] == ("2.00 µm", "1.95 to 2.05 µm")
    assert last.meaning.endswith("Other joints: C 2.00 µm.")
    joints = dict.fromkeys("AC", replace(joint, wear_peaks={}))
    jump = altered(result, 1, statistics=replace(statistics, joints=joints))
    first = wear_of(jump)
    assert "strokes on new surfaces, with" in first.meaning
    bearings = pw.Bearing(clearance=5e-5, viscosity=0.1)
    oiled = replace(result, scene=replace(made.BOTH, bearings=bearings))
    first = wear_of(oiled)
    assert "that of dry contact: an upper bound where oil carries." in first.meaning


@pytest.mark.parametrize(
    ("engine", "advice"),
    [
        ("dae", "a smaller integration_tolerance"),
        ("exudyn-tree", "a smaller tree_tolerance"),
        ("exudyn-joints", "more steps_per_contact"),
    ],
)
def test_a_step_error_is_a_warning_with_the_setting_of_the_engine(engine, advice):
    result = made_up(replace(made.BOTH, engine=engine), 1)
    statistics = replace(result.stages[0].statistics, peak_force_step_error=0.3)
    lines = warnings(altered(result, 0, statistics=statistics))
    assert f"Finer time steps change peak forces by 30 %: use {advice}." in lines


def test_a_motor_with_a_flywheel_gives_a_part_of_the_torque():
    """The torque of the motor is not that of gear and crank, which the flywheel gives, too."""
    motor = {"motor.torque": "1 N m", "motor.inertia": "0.1 kg m^2"}
    scene = pw.changed(pw.scenes.slider_crank(drive_torque="on"), motor)
    result = pw.run(
        pw.changed(scene, {"cycles": 3, "replicates": 1, "wear_updates": 0})
    )
    numbers = {number.name: number for number in key_numbers(result)}
    assert "Peak drive torque" not in numbers
    assert "delivers this mean" not in numbers["Peak motor power"].meaning
    assert "gear and crank bear" in numbers["Peak motor torque"].meaning


@pytest.mark.parametrize(
    ("strokes", "reason"),
    [(4, "from 4 strokes, too few"), (30, "single strokes decide it")],
)
def test_a_repeatability_without_an_interval_has_a_reason(strokes, reason):
    """The jackknife has no interval if the variance is that of a single stroke."""
    heights = np.append(np.zeros(strokes + 1), 1e-4)  # after a start-up of two
    scatter = spread([heights])
    assert not scatter.has_interval
    result = made_up(made.ONE, 1)
    bdc = replace(result.stages[0].bdc, strokes=strokes, standard_deviation=scatter)
    statistics = replace(result.stages[0].statistics, bdc=bdc)
    numbers = {
        number.name: number
        for number in key_numbers(altered(result, 0, statistics=statistics))
    }
    number = numbers["Repeatability"]
    assert (number.interval, number.note) == ("interval unknown", reason)
