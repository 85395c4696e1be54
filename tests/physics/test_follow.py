"""Points that follow curves: closed forms, the seven-bar press, and what cannot be followed."""

import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.linkage.drives import RISES, Drive, Follow, Rise
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import Press, SliderCrank
from presswear.physics import ideal
from presswear.physics.assembly import closed
from presswear.physics.drive_motion import motions_of
from presswear.physics.ideal import FOLLOWED, followed, ideal_motion, motion_of
from presswear.scene.files import scene_from
from presswear.scene.scene import Scene
from presswear.tools.errors import AssemblyError

Array = NDArray[np.float64]
TURN = 2.0 * math.pi
PRESS = Press().linkage()
W = Press().speed
PERIOD = TURN / W


def curve_of(linkage: Linkage, count: int = 128) -> Any:
    """What a linkage watches over its cycle, with derivatives, as a table of a curve."""
    phase = TURN * np.arange(count) / count
    place, velocity, acceleration = motion_of(linkage).at(phase / W).output(linkage).T
    rows = np.column_stack([phase, place - place[0], velocity / W, acceleration / W**2])
    return [list(map(float, row)) for row in rows]


def servo(drive: Drive) -> Linkage:
    """The press with crank 2 at constant speed and a servo on crank 7."""
    return PRESS.changed(drives=[PRESS.drives[0], drive])


ANGLE = PRESS.drives[1].angle


def test_the_press_gets_back_the_motion_of_its_servo() -> None:
    """Crank 7 rocks; the slider's own motion is then followed, and gives the rocking back."""
    given = Drive("crank 7", 0.0, ANGLE, W, [(0.0, 0.3), (0.02, 0.0)])
    linkage = servo(given)
    follow = Follow("slider 6.centre", table=curve_of(linkage))
    found = followed(servo(Drive("crank 7", 0.0, ANGLE, W, follow=follow))).drives[1]
    time = np.linspace(0.0, 2.0 * PERIOD, 701)
    for k, (one, other) in enumerate(zip(found.motion(time), given.motion(time), strict=True)):
        assert np.abs(one - other).max() < (1e-11, 1e-8, 1e-5)[k]


def test_a_servo_without_a_task_stands_still() -> None:
    """The slider follows what crank 2 alone does to it: crank 7 keeps its angle, at speed 0."""
    alone = servo(Drive("crank 7", angle=ANGLE))
    follow = Follow("slider 6.centre", table=curve_of(alone))
    found = followed(servo(Drive("crank 7", 0.0, ANGLE, W, follow=follow))).drives[1]
    angle, speed, _ = found.motion(np.linspace(0.0, PERIOD, 200))
    assert np.abs(angle - ANGLE).max() < 1e-11
    assert np.abs(speed).max() < 1e-8


def dwelling(law: str = "modified-sine", by: float = 0.09) -> Linkage:
    """The press whose slider dwells at the bottom for 40 degrees of crank 2."""
    low, top, end = map(math.radians, (150, 285, 470))
    rises = [Rise(low, top, by, law), Rise(top, end, -by, law)]
    start = math.radians(-20.0)
    follow = Follow("slider 6.centre", rises=rises)
    linkage = servo(Drive("crank 7", 0.0, start, W, follow=follow))
    return linkage.changed(guess=turned_to(start))


@cache
def turned_to(angle: float) -> dict[str, float]:
    """Angles of rods and plate with crank 7 turned to an angle, crank 2 where it starts."""
    way = (angle - ANGLE) % TURN
    drives = [replace(PRESS.drives[0], speed=0.0), Drive("crank 7", 0.0, ANGLE, 1.0, [(-0.5, 0.0)])]
    # It turns by ``way`` in half a cycle and back in the other.
    drives[1] = replace(drives[1], harmonics=[(-0.5 * way, 0.0)])
    half = ideal_motion(PRESS.changed(drives=drives), TURN).at(np.array([0.5 * TURN]))
    names = [body.name for body in PRESS.bodies]
    return {
        name: float(half.position[0, 3 * names.index(name) + 2])
        for name in ("rod 3", "plate 4", "rod 5")
    }


@pytest.mark.parametrize("law", RISES)
def test_the_slider_dwells_at_the_bottom(law: str) -> None:
    """The found motion of the servo makes the slider stand still, and run its law besides."""
    linkage = followed(dwelling(law))
    period = linkage.period
    curve = dwelling(law).drives[1].follow
    assert curve is not None
    time = np.linspace(0.0, period, 2000)
    slider = motion_of(linkage).at(time).output(linkage)
    place, slope, _ = curve.pieces.at(W * time)
    assert np.abs(slider[:, 0] - slider[0, 0] - place).max() < FOLLOWED * 0.09
    assert np.abs(slider[:, 1] - W * slope).max() < 1e-6 * W * 0.09
    low = (W * time > math.radians(112)) & (W * time < math.radians(148))
    assert np.ptp(slider[low, 0]) < 2.0 * FOLLOWED * 0.09
    assert slider[low, 0].max() < slider[:, 0].min() + 2.0 * FOLLOWED * 0.09


CRANK = SliderCrank().linkage()
R, ROD = SliderCrank().crank_length, SliderCrank().rod_length
amplitudes = st.floats(-0.25, 0.25)


@settings(max_examples=20)
@given(st.lists(st.tuples(amplitudes, amplitudes), min_size=1, max_size=3), st.integers(0, 2))
def test_the_crank_is_turned_as_the_law_of_cosines_says(
    waves: list[tuple[float, float]], run_up: int
) -> None:
    """cos a = (x^2 + r^2 - l^2) / (2 r x) for a slider at x that swings about a = 90 deg."""
    scale = 0.3 * R
    harmonics = [(scale * a / (k + 1), scale * b / (k + 1)) for k, (a, b) in enumerate(waves)]
    drive = Drive("crank", 0.0, 0.5 * math.pi, 20.0, follow=Follow("slider.centre", 0.0, harmonics))
    linkage = CRANK.changed(drives=[drive], run_up=run_up, guess={"rod": -math.asin(R / ROD)})
    found = followed(linkage)
    time = np.linspace(0.0, linkage.period, 300)
    x = np.full_like(time, math.sqrt(ROD**2 - R**2))
    for k, (a, b) in enumerate(harmonics, start=1):
        x += a * (np.cos(20.0 * k * time) - 1.0) + b * np.sin(20.0 * k * time)
    exact = np.arccos((x**2 + R**2 - ROD**2) / (2.0 * R * x))
    assert np.abs(found.drives[0].motion(time)[0] - exact).max() < 1e-8
    assert found.run_up == run_up


def test_the_press_gets_back_the_constant_speed_of_its_servo() -> None:
    """Twice in a turn crank 7 does not move the slider: the curve leads through both places."""
    follow = Follow("slider 6.centre", table=curve_of(PRESS))
    linkage = servo(Drive("crank 7", W, ANGLE, follow=follow))
    time = np.linspace(0.0, 2.0 * PERIOD, 701)
    found, given = (own.drives[1].motion(time) for own in (followed(linkage), PRESS))
    for k, (one, other) in enumerate(zip(found, given, strict=True)):
        assert np.abs(one - other).max() < (1e-11, 1e-8, 1e-5)[k]


def test_at_a_dead_point_the_motion_is_kept_that_goes_on_smoothly() -> None:
    """Two motions of the servo meet there; begun 1.6 degrees later, a step ends close behind."""
    uneven = replace(PRESS.drives[1], harmonics=[(0.0, 0.0), (0.0, 0.0), (0.0, 0.08)])
    later = math.radians(1.6) / W
    phase, time = TURN * np.arange(250) / 250, np.linspace(0.0, PERIOD, 500)
    motion, given = motion_of(servo(uneven)), uneven.motion(time + later)[0]
    there = motion.at(np.array([later])).position[0].reshape(-1, 3)
    angles = {body.name: float(there[k, 2]) for k, body in enumerate(PRESS.bodies)}
    place, velocity, acceleration = motion.at(later + phase / W).output(PRESS).T
    rows = np.column_stack([phase, place - place[0], velocity / W, acceleration / W**2]).tolist()
    follow = Follow("slider 6.centre", table=rows)
    linkage = PRESS.changed(
        guess={name: angles[name] for name in ("rod 3", "plate 4", "rod 5")},
        drives=[
            replace(PRESS.drives[0], angle=angles["crank 2"]),
            Drive("crank 7", W, float(given[0]), follow=follow),
        ],
    )
    assert np.abs(followed(linkage).drives[1].motion(time)[0] - given).max() < 1e-7


def test_a_dead_point_that_is_in_the_way_is_told_with_its_place() -> None:
    """A curve higher by a ten thousandth leads past what the servo can reach there."""
    curve: Any = [[phase, *(1.0001 * own for own in rest)] for phase, *rest in curve_of(PRESS)]
    drive = Drive("crank 7", W, ANGLE, follow=Follow("slider 6.centre", table=curve))
    told = "drive of crank 7 cannot make its point follow the curve: at crank angle "
    with pytest.raises(AssemblyError, match=told) as refusal:
        followed(servo(drive))
    found = re.search(r"angle ([\d.]+) deg \(([\d.]+) s", str(refusal.value))
    assert found is not None
    angle, instant = map(float, found.groups())
    assert angle == pytest.approx(360.0 * instant / PERIOD, abs=0.1)
    # There, and not a few degrees off, the slider hardly moves with crank 7.
    moved = []
    for turn in (-1e-4, 1e-4):
        own = servo(replace(PRESS.drives[1], angle=ANGLE + turn))
        times = instant + np.array([0.0, -PERIOD / 36.0, PERIOD / 36.0])
        moved.append(motion_of(own).at(times).output(own)[:, 0])
    influence = np.abs(moved[1] - moved[0]) / 2e-4
    assert influence[0] < 0.1 * influence[1:].min()


@pytest.mark.parametrize(
    ("linkage", "told"),
    [
        (
            dwelling(by=0.2),
            r"drive of crank 7 cannot make its point follow the curve: at crank angle \d+\.\d deg "
            r"\(0\.\d+ s after the start\) the point is out of reach",
        ),
        (
            dwelling().changed(drives=[PRESS.drives[0], replace(dwelling().drives[1], speed=W)]),
            r"speed of crank 7 = 10\.9956 rad/s: to follow its curve it turns at a mean speed of 0",
        ),
    ],
    ids=["out of reach", "mean speed"],
)
def test_what_cannot_be_followed_is_told(linkage: Linkage, told: str) -> None:
    with pytest.raises(AssemblyError, match=told):
        followed(linkage)


def test_a_curve_of_too_many_pieces_is_refused() -> None:
    """Three hundred rows, run through twice in a cycle of the linkage."""
    rows = [(TURN * k / 300, 1e-4 * math.sin(TURN * k / 300)) for k in range(300)]
    drive = Drive("crank", 0.0, 1.5, 20.0, follow=Follow("slider.centre", table=rows))
    linkage = CRANK.changed(drives=[drive], cycle=2.0 * TURN / 20.0, guess={"rod": -0.2})
    with pytest.raises(AssemblyError, match="drive of crank: the curve has 600 pieces in the cyc"):
        followed(linkage)


def test_nothing_runs_before_the_motion_is_found() -> None:
    with pytest.raises(ValueError, match="drive of crank 7 follows a curve"):
        motions_of(dwelling())
    with pytest.raises(ValueError, match="drive of crank 7 follows a curve"):
        dwelling().drives[1].motion(np.zeros(1))
    assert followed(PRESS) == PRESS


def test_a_scene_holds_the_curve_and_runs_the_motion() -> None:
    scene = Scene(mechanism=dwelling(), joints="A,C", wear_updates=0)
    again = Scene.from_dict(scene.as_dict())
    assert again == scene
    follow = dwelling().as_plain()["drives"][1]["follow"]
    assert (follow["point"], len(follow["rises"])) == ("slider 6.centre", 2)
    assert all(drive.follow is None for drive in scene.linkage().drives)
    assert scene.linkage().drives == followed(dwelling()).drives


TOML = """
[mechanism]
output = "slider.centre"
guess = {{ rod = "-0.2 rad" }}
[[mechanism.bodies]]
name = "crank"
length = "100 mm"
mass = "1 kg"
[[mechanism.bodies]]
name = "rod"
length = "400 mm"
mass = "1 kg"
[[mechanism.bodies]]
name = "slider"
mass = "1 kg"
inertia = "1 kg m^2"
[[mechanism.joints]]
name = "O"
first = ["0 m", "0 m"]
second = "crank.tail"
[[mechanism.joints]]
name = "A"
first = "crank.head"
second = "rod.tail"
[[mechanism.joints]]
name = "B"
first = "rod.head"
second = "slider.centre"
[[mechanism.joints]]
name = "guide"
body = "slider"
[[mechanism.drives]]
body = "crank"
angle = "90 deg"
frequency = "60 rpm"
follow = {{ point = "slider.centre", {curve} }}
"""


def test_a_curve_is_followed_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    rows = '[["0 deg", 0], ["90 deg", "20 mm"], ["180 deg", 0], ["270 deg", "-20 mm"]]'
    file.write_text(TOML.format(curve=f"table = {rows}"))
    scene = scene_from(file)
    place = scene.ideal_slider(np.array([0.25, 0.5, 0.75, 1.0]))[:, 0]
    np.testing.assert_allclose(place, [0.02, 0.0, -0.02, 0.0], atol=4e-11)
    for curve, told in (
        ('table = [["0 deg", 3], ["1 rad", 0]]', r"table\[0\]\[1\] = '3' has no unit"),
        (
            'table = [["0 deg", "3 deg"]]',
            r"table\[0\]\[1\] = '3 deg': unknown unit 'deg'",
        ),
        ("table = 3", r"table = .3.: a list"),
        ('tabel = [["0 deg", 0]]', "'tabel'; did you mean table"),
        ('rises = [{ start = "0 deg", end = "9 deg" }]', "by is missing"),
        (
            'rises = [{ start = "0 deg", end = "9 deg", by = "1 mm", law = "3-4-6" }]',
            "law = '3-4-6': .*did you mean 3-4-5",
        ),
        ('harmonics = [["0 mm", "300 mm"]]', "drive of crank cannot make its point follow"),
    ):
        file.write_text(TOML.format(curve=curve))
        with pytest.raises(ValueError, match=told) as refusal:
            scene_from(file)
        assert re.fullmatch(rf"{re.escape(str(file))}: [^\n]*", str(refusal.value))


@pytest.mark.parametrize(
    ("rises", "most"),
    [
        # A short rise in one interval of the cycle.
        ([Rise(3.01, 3.011, 0.3), Rise(5.01, 5.011, -0.3)], 1700),
        # 40 turns in a cycle, of which 36 instants tell nothing.
        ([Rise(1.0, 6.0, 40 * TURN)], 3500),
    ],
)
def test_a_fast_motion_takes_few_steps(
    rises: list[Rise], most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Steps are long again behind a fast part; the slider is where the closed form has it."""
    steps = []

    def counted(*given: Any) -> Any:
        steps.append(given)
        return closed(*given)

    monkeypatch.setattr(ideal, "closed", counted)
    drive = Drive("crank", 0.0, 0.0, 30.0, rises=rises)
    motion = ideal_motion(CRANK.changed(drives=[drive]), TURN / 30.0)
    time = np.linspace(0.0, TURN / 30.0, 500)
    slider = motion.at(time).position[:, 3 * CRANK.index("slider")]
    angle = drive.motion(time)[0]
    exact = R * np.cos(angle) + np.sqrt(ROD**2 - (R * np.sin(angle)) ** 2)
    assert np.abs(slider - exact).max() < 1e-14
    assert len(steps) < most
