"""The press and the slider-crank: values of the paper, travel, engines, and bad input."""

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from presswear.campaign.runs import run
from presswear.linkage.mechanisms import FourBar, SixBar, SliderCrank, TwoPoint
from presswear.linkage.press import GEOMETRIES, Geometry, Press
from presswear.linkage.process import Blanking, Coining, Drawing
from presswear.linkage.servos import Dwell, Forming, Pendulum
from presswear.physics.curve_following import motion_of
from presswear.physics.dead_centre import bottom_of
from presswear.physics.statics import deflection
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.tools.fields import meaning_of
from presswear.tools.quantities import Quantity

SHORT = (
    r"rod_length = \S+ mm: with crank_length = 50 mm allowed is 50\.005 mm to 10000 mm"
)


PARTS = [
    Press(),
    SliderCrank(),
    FourBar(),
    SixBar(),
    TwoPoint(),
    Blanking(),
    Drawing(),
    Coining(),
    Dwell(),
]
PARTS += [Forming(), Pendulum()]


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.kind)
def test_every_quantity_is_checked(part):
    quantities = {item.name: meaning_of(item) for item in fields(part)}
    others = {name for name, own in quantities.items() if not isinstance(own, Quantity)}
    assert others <= {"geometry", "motor", "servo", "side", "bottom", "law"}
    for name in quantities.keys() - others:
        meaning: Any = quantities[name]
        for value in (meaning.low - 1.0, meaning.high + 1.0, math.nan, "x"):
            with pytest.raises(InputError, match=f"^{name} = .*allowed is"):
                replace(part, **{name: value})


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: Press(length_3=0.05),
            r"at crank angle \S+ deg joint \S+ does not close",
        ),
        (
            lambda: Press(length_3=2.0),
            r"at crank angle \S+ deg joint \S+ does not close",
        ),
        (
            lambda: Press(geometry=Geometry(hx=5.0)),
            r"at crank angle \S+ deg joint \S+ does not",
        ),
        (lambda: Press(length_5=0.02), "joint (C|E) does not close"),
        *(
            (lambda rod=rod: SliderCrank(rod_length=rod), SHORT)
            for rod in (0.01, 0.05, 0.0500001)
        ),
        (
            lambda: Press(geometry=Geometry(side_bd=0.5)),
            r"plate 4 is not a triangle.* 500 mm",
        ),
        # Half a side assembles into links of another length.
        (lambda: Press(geometry=Geometry(side_b=0.5)), "side_b"),
        (lambda: Press(geometry=Geometry(side_c=0.0)), "side_c"),
        (lambda: Press(geometry=Geometry(slider_side=2.0)), "slider_side"),
    ],
)
def test_a_mechanism_that_does_not_assemble_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        motion_of(make())


@pytest.mark.parametrize(
    ("name", "low", "high", "start", "fastest"),
    [
        ("standard", -0.5871, -0.4800, -0.5862, 0.966),
        ("swapped", -0.5772, -0.4678, -0.5744, 0.955),
        ("lifted", 0.0785, 0.1856, 0.1695, 0.983),
    ],
)
def test_press_geometry(name, low, high, start, fastest):
    press = Press(geometry=GEOMETRIES[name], speed=3.5 * math.pi)
    motion = motion_of(press).at(np.linspace(0.0, press.period, 4001))
    i = 3 * Press().linkage().index("slider 6") + 1
    height, velocity, acceleration = (
        level[:, i] for level in (motion.position, motion.velocity, motion.acceleration)
    )
    # Four decimals.
    assert height.min() == pytest.approx(low, abs=5.1e-5)
    assert height.max() == pytest.approx(high, abs=5.1e-5)
    assert height[0] == pytest.approx(start, abs=5.1e-5)
    assert velocity.max() == pytest.approx(fastest, abs=5.1e-4)
    if name == "standard":
        assert velocity.min() == pytest.approx(-0.889, abs=5e-4)
        assert acceleration.min() == pytest.approx(-20.0, abs=0.05)
        assert acceleration.max() == pytest.approx(12.4, abs=0.05)


def test_the_press_is_the_papers():
    linkage = Press().linkage()
    masses = [body.mass for body in linkage.bodies]
    assert masses == [0.0243, 0.1085, 0.4503, 0.1272, 0.0288, 0.0243]
    inertias = [body.inertia for body in linkage.bodies if body.name != "slider 6"]
    assert inertias == [5.396e-4, 1.1e-3, 3.779e-3, 1.771e-3, 5.396e-4]
    drives = {drive.body: (drive.angle, drive.speed) for drive in linkage.drives}
    speed = Press().speed
    # Equation 14; crank 2 points from A to its hinge.
    starts = math.radians(-119.27), math.radians(-51.18)
    assert drives == {"crank 2": (starts[0], -speed), "crank 7": (starts[1], speed)}
    # Rod 3 carries the hole at A, rod 5 that at C.
    holes = {
        joint.name: (joint.first.body, joint.second.body) for joint in linkage.revolutes
    }
    assert (holes["A"], holes["C"]) == (("rod 3", "crank 2"), ("rod 5", "plate 4"))


def dead_centres(crank: float, rod: float, ground: float, rocker: float) -> list[float]:
    """Angle between frame and rocker where the crank is in line with the rod, rad.

    Law of cosines for the triangle of frame, rocker and rod less, or plus, crank.
    """
    return [
        math.acos((ground**2 + rocker**2 - reach**2) / (2.0 * ground * rocker))
        for reach in (rod - crank, rod + crank)
    ]


@pytest.mark.parametrize("side", ["above", "below"])
def test_the_four_bar_swings_between_its_dead_centres(side):
    bar = FourBar(side=side)
    angles = dead_centres(
        bar.crank_length, bar.coupler_length, bar.frame_length, bar.rocker_length
    )
    low, high = (
        bar.frame_length - bar.rocker_length * math.cos(angle) for angle in angles
    )
    bottom = bottom_of(motion_of(bar))
    assert bottom is not None
    assert (bottom.height, bottom.stroke) == pytest.approx((low, high - low), abs=1e-12)
    centre = (
        motion_of(bar)
        .at(np.zeros(1))
        .position[0, 3 * bar.linkage().index("rocker") + 1]
    )
    assert (centre > 0.0) == (side == "above")


def test_the_six_bar_straightens_its_links_at_bottom_dead_centre():
    bar = SixBar()
    frame = math.hypot(bar.crank_x, bar.crank_y)
    heights = []
    for angle in dead_centres(
        bar.crank_length, bar.rod_length, frame, bar.upper_length
    ):
        upper = math.atan2(bar.crank_y, bar.crank_x) + angle
        x = bar.upper_length * math.cos(upper)
        y = bar.upper_length * math.sin(upper)
        heights.append(y - math.sqrt(bar.lower_length**2 - x**2))
    bottom = bottom_of(motion_of(bar))
    assert bottom is not None
    top, low = heights
    assert (bottom.height, bottom.stroke) == pytest.approx((low, top - low), abs=1e-12)
    mirrored = bottom_of(motion_of(replace(bar, crank_x=-bar.crank_x)))
    assert mirrored is not None
    assert (mirrored.height, mirrored.stroke) == pytest.approx(
        (low, top - low), abs=1e-12
    )


@pytest.mark.parametrize("kind", [Press, SliderCrank, FourBar, SixBar, TwoPoint])
def test_slow_presses_are_allowed(kind):
    assert kind(speed="0.1 rpm").period == pytest.approx(600.0)
    with pytest.raises(InputError, match=r"speed = 0\.09 rpm"):
        kind(speed="0.09 rpm")


def test_a_press_runs_at_six_strokes_a_minute():
    """B carries the slider and holds the weights of slider and rod aside; clearance is 0.5 %."""
    mechanism = SliderCrank(speed=6.0 * math.pi / 30.0, slide_angle=-0.5 * math.pi)
    scene = Scene(mechanism, joints="B", engine="dae", wear_updates=0, cycles=2)
    result = run(scene)
    assert result.status == "completed"
    stage = result.stages[0]
    aside = math.tan(math.asin(mechanism.crank_length / mechanism.rod_length))
    aside *= mechanism.slider_mass + 0.5 * mechanism.rod_mass
    expected = 9.81 * math.hypot(mechanism.slider_mass, aside)
    force = stage.joints["B"].force[stage.time > mechanism.period, 0]
    assert force.max() == pytest.approx(expected, rel=8e-3)


@pytest.mark.parametrize("kind", [Press, SliderCrank, FourBar, SixBar])
def test_an_elastic_frame_stretches_along_the_output(
    kind: type[Press | SliderCrank | FourBar | SixBar],
):
    """Under a static force at bottom dead centre, all drives held."""
    rigid = Scene(kind(), joints="none")
    frame = {"frame_mass": "50 kg", "frame_stiffness": "10 kN/mm", "frame_damping": 0.1}
    elastic = changed(rigid, frame)
    (guide,) = elastic.linkage().elastic_guides
    assert (guide.stiffness, guide.damping, guide.body) == (1e7, 0.1, "crown")
    assert elastic.bottom == pytest.approx(rigid.bottom, abs=1e-12)
    assert deflection(elastic.linkage(), 1000.0) == pytest.approx(1e-4, rel=1e-6)
    assert Scene.from_dict(elastic.as_dict()) == elastic


def test_a_frame_has_mass_and_stiffness():
    with pytest.raises(InputError, match="frame_stiffness = 1 N/m: allowed is 1000"):
        changed(Scene(), {"frame_mass": "50 kg", "frame_stiffness": "1 N/m"})
    with pytest.raises(InputError, match="frame_stiffness = 0 N/m: allowed is 1000"):
        changed(Scene(), {"frame_mass": "50 kg", "frame_stiffness": "0 N/m"})
    with pytest.raises(InputError, match="it needs a frame_mass"):
        changed(Scene(), {"frame_stiffness": "1 GN/m"})
    assert not changed(Scene(), {"frame_mass": "50 kg"}).linkage().elastic_guides
