"""Points that follow curves: closed forms, the seven-bar press, and what cannot be followed."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from presswear.linkage.drives import Drive, Follow
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.press import Press
from presswear.linkage.servos import Dwell
from presswear.physics.curve_following import followed, motion_of
from presswear.physics.drive_motion import motions_of
from presswear.scene.scene import Scene
from presswear.tools.errors import AssemblyError

TURN = 2.0 * math.pi
PRESS = Press().linkage()
W = Press().speed
PERIOD = TURN / W


def curve_of(linkage: Linkage, count: int = 128, later: float = 0.0) -> Any:
    """What a linkage watches over its cycle, with derivatives, as a table of a curve."""
    phase = TURN * np.arange(count) / count
    place, velocity, acceleration = (
        motion_of(linkage).at(later + phase / W).output(linkage).T
    )
    rows = [phase, place - place[0], velocity / W, acceleration / W**2]
    return np.column_stack(rows).tolist()


def servo(drive: Drive) -> Linkage:
    """The press with crank 2 at constant speed and a servo on crank 7."""
    return PRESS.changed(drives=[PRESS.drives[0], drive])


ANGLE = PRESS.drives[1].angle


@pytest.mark.parametrize(
    ("drive", "speed"),
    [
        # Crank 7 rocks.
        (Drive("crank 7", 0.0, ANGLE, W, [(0.0, 0.3), (0.02, 0.0)]), 0.0),
        # Twice in a turn crank 7 does not move the slider: the curve leads through both
        # places.
        (PRESS.drives[1], W),
    ],
    ids=["rocking", "turning"],
)
def test_the_press_recovers_the_motion_of_its_servo(drive: Drive, speed):
    """The slider's motion is followed, and returns the motion of crank 7."""
    follow = Follow("slider 6.centre", table=curve_of(servo(drive)))
    result = followed(servo(Drive("crank 7", speed, ANGLE, W, follow=follow))).drives[1]
    time = np.linspace(0.0, 2.0 * PERIOD, 701)
    for k, (one, exact) in enumerate(
        zip(result.motion(time), drive.motion(time), strict=True)
    ):
        assert np.abs(one - exact).max() < (1e-11, 1e-8, 1e-5)[k]


DWELL = Press(servo=Dwell()).linkage()
CRANK = SliderCrank(slide_angle=0.0).linkage()


def test_at_a_dead_point_the_motion_is_kept_that_goes_on_smoothly():
    """Two motions of the servo meet there; begun 1.6 degrees later, a step ends close behind."""
    uneven = replace(PRESS.drives[1], harmonics=[(0.0, 0.0), (0.0, 0.0), (0.0, 0.08)])
    later = math.radians(1.6) / W
    time = np.linspace(0.0, PERIOD, 500)
    expected = uneven.motion(time + later)[0]
    there = motion_of(servo(uneven)).at(np.array([later])).position[0, 2::3].tolist()
    angles = dict(zip((body.name for body in PRESS.bodies), there, strict=True))
    follow = Follow("slider 6.centre", table=curve_of(servo(uneven), 250, later))
    linkage = PRESS.changed(
        guess={name: angles[name] for name in ("rod 3", "plate 4", "rod 5")},
        drives=[
            replace(PRESS.drives[0], angle=angles["crank 2"]),
            Drive("crank 7", W, float(expected[0]), follow=follow),
        ],
    )
    assert np.abs(followed(linkage).drives[1].motion(time)[0] - expected).max() < 1e-7


ROWS = [(TURN * k / 300, 1e-4 * math.sin(TURN * k / 300)) for k in range(300)]
SERVO = Drive("crank", 0.0, 1.5, 20.0, follow=Follow("slider.centre", table=ROWS))
REFUSED = {
    r"drive of crank 7 cannot make its point follow the curve: at crank angle \d+\.\d deg "
    r"\(0\.\d+ s after the start\) the point is out of reach": (
        Press(servo=Dwell(stroke=0.2)).linkage()
    ),
    r"speed of crank 7 = 10\.9956 rad/s: to follow its curve it turns at a mean speed of 0": (
        servo(replace(DWELL.drives[1], speed=W))
    ),
    # Run through twice in a cycle of the linkage
    "drive of crank: the curve has 600 pieces in the cyc": (
        CRANK.changed(drives=[SERVO], cycle=2.0 * TURN / 20.0, guess={"rod": -0.2})
    ),
}


@pytest.mark.parametrize(
    "message", REFUSED, ids=["out of reach", "mean speed", "pieces"]
)
def test_a_curve_that_cannot_be_followed_is_refused(message):
    with pytest.raises(AssemblyError, match=message):
        followed(REFUSED[message])


def test_nothing_runs_before_the_motion_is_found():
    with pytest.raises(ValueError, match="drive of crank 7 follows a curve"):
        motions_of(DWELL)
    assert followed(PRESS) == PRESS


def test_a_scene_holds_the_curve_and_runs_the_motion():
    scene = Scene(mechanism=DWELL, joints="A,C", wear_updates=0)
    again = Scene.from_dict(scene.as_dict())
    assert again == scene
    follow = DWELL.as_plain()["drives"][1]["follow"]
    assert (follow["point"], len(follow["rises"])) == ("slider 6.centre", 2)
    assert all(drive.follow is None for drive in scene.linkage().drives)
    assert scene.linkage().drives == followed(DWELL).drives
