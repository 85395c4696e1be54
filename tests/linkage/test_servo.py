"""Servo laws of crank 7: what can be reached, what the slider does, and what is refused."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import presswear as pw
from presswear.physics.ideal import motion_of
from presswear.scene.files import scene_from
from presswear.scene.settings import changed, settings_of
from presswear.tools.errors import InputError

IDEAL = pw.scenes.ideal()
W = pw.Press().speed

SOME = settings(max_examples=8, deadline=None, phases=[Phase.explicit, Phase.generate])


@SOME
@given(
    st.floats(0.02, 0.12),
    st.floats(0.075, 0.09),
    st.floats(115.0, 125.0),
    st.sampled_from(["cycloidal", "modified-sine", "3-4-5"]),
)
def test_the_slider_dwells_for_its_part_of_the_cycle(
    part: float, stroke: float, bottom: float, law: str
) -> None:
    dwell = pw.Dwell(part=part, stroke=stroke, bottom=math.radians(bottom), law=law)
    press = pw.Press(servo=dwell)
    time = (dwell.bottom + math.pi * part * np.linspace(-1.0, 1.0, 101)) / W
    ideal = motion_of(press)
    place, speed, _ = ideal.at(time).output(press.linkage()).T
    assert np.ptp(place) < 2e-9 * stroke
    assert np.abs(speed).max() < 1e-6 * W * stroke
    whole = ideal.at(ideal.times).output(press.linkage())[:, 0]
    assert whole.min() > place.min() - 2e-9 * stroke
    assert np.ptp(whole) == pytest.approx(stroke, rel=1e-4)
    crank = ideal.at(ideal.times).position[:, 3 * press.linkage().index("crank 7") + 2]
    assert np.ptp(crank) < math.pi


@SOME
@given(st.floats(0.05, 0.12), st.floats(4e-3, 7e-3), st.floats(0.3e-3, 1e-3))
def test_the_speed_is_constant_in_the_work(speed: float, height: float, end: float) -> None:
    """Near 0.04 m/s some of these curves are out of reach of the press."""
    forming = pw.Forming(speed=speed, height=height, end=end)
    press = pw.Press(servo=forming)
    ideal = motion_of(press)
    slowing = forming.bottom / W - 2.0 * end / speed
    time = slowing - (height - end) / speed * np.linspace(0.0, 1.0, 101)
    place, velocity, _ = ideal.at(time).output(press.linkage()).T
    assert np.abs(velocity + speed).max() < 1e-6 * speed
    whole = ideal.at(ideal.times).output(press.linkage())
    assert place[0] - whole[:, 0].min() == pytest.approx(end, abs=1e-8)
    # One way down, one way up.
    moving = np.sign(whole[:-1, 1][np.abs(whole[:-1, 1]) > 1e-6])
    assert np.count_nonzero(moving != np.roll(moving, 1)) == 2


def test_one_servo_from_python_settings_and_files(tmp_path: Path) -> None:
    press = pw.Press(servo=pw.Dwell(part=0.1, stroke=0.08))
    texts = {"servo": "dwell", "servo.part": "0.1", "servo.stroke": "80mm"}
    assert changed(IDEAL, texts).mechanism == press
    file = tmp_path / "servo.toml"
    file.write_text(
        'mechanism = "press"\n[servo]\nkind = "dwell"\npart = 0.1\nstroke = "80 mm"\n'
        "[settings]\ncycles = 1\n"
    )
    assert scene_from(file).mechanism == press
    scene = replace(IDEAL, mechanism=press)
    assert pw.Scene.from_dict(scene.as_dict()) == scene
    assert changed(scene, {"servo": "none"}).mechanism == pw.Press()
    assert changed(scene, {"servo": "pendulum"}).mechanism == pw.Press(servo=pw.Pendulum())
    # The same kind keeps what was set.
    kept = changed(scene, {"servo.angle": "-10deg"}).mechanism
    assert kept == pw.Press(servo=pw.Dwell(0.1, 0.08, angle=math.radians(-10.0)))
    texts = {setting.key: setting.described() for setting in settings_of(scene)}
    assert texts["servo"].startswith("dwell  (none | dwell | forming | pendulum)")
    assert texts["servo.stroke"].startswith("0.08 m  (0.001 to 10 m; chosen)")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"servo": "dwel"}, "servo = 'dwel': .*did you mean dwell"),
        (
            {"servo.part": "0.1"},
            r"servo\.part: servo = none; it needs servo = dwell, forming, pend",
        ),
        ({"servo": "dwell", "servo.stroke": "80"}, r"servo\.stroke = '80' has no unit"),
        (
            {"servo": "dwell", "servo.part": "0.6"},
            r"servo\.part = 0\.6: allowed is above 0 up to 0\.5",
        ),
        (
            {"servo": "dwell", "servo.stroke": "0.2m"},
            r"drive of crank 7 cannot make its point follow the curve: at crank angle \S+ deg",
        ),
        (
            {"servo": "forming", "servo.speed": "1mm/s"},
            r"servo\.speed = 0\.001 m/s: with these heights, stroke and cycle allowed is 0\.03266",
        ),
        (
            {"servo": "forming", "servo.end": "7mm"},
            r"servo\.height = 0\.006 m: must lie between end = 0\.007 m and stroke = 0\.09 m",
        ),
        (
            {"servo": "dwell", "process": "blanking", "torque_limit": "5 N m"},
            r"torque_limit of crank \d = 5 N m: the ideal motion needs",
        ),
    ],
)
def test_a_servo_that_is_not_possible_is_refused(values: dict[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message) as refusal:
        changed(IDEAL, values).check()
    assert len(str(refusal.value).splitlines()) == 1
