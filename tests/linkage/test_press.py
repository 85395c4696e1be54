"""The ideal press in closed form: figures of the three geometries, closure, derivatives."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Attachment, Linkage
from presswear.linkage.press import CRANK_2_START, CRANK_7_START, GEOMETRIES, Geometry, Press
from presswear.tools.errors import AssemblyError, InputError

Array = NDArray[np.float64]

names = pytest.mark.parametrize("name", list(GEOMETRIES))
presses = st.builds(
    lambda name, speed: Press(geometry=GEOMETRIES[name], speed=speed),
    st.sampled_from(list(GEOMETRIES)),
    st.floats(0.1 * math.pi, 40.0 * math.pi),
)


def _ends(linkage: Linkage, end: Attachment, position: Array) -> Array:
    """Global place of an attachment over time, shape (n, 2)."""
    if end.body == GROUND:
        return np.tile([end.x, end.y], (len(position), 1))
    i = 3 * linkage.index(end.body)
    c, s = np.cos(position[:, i + 2]), np.sin(position[:, i + 2])
    return position[:, i : i + 2] + np.column_stack([c * end.x - s * end.y, s * end.x + c * end.y])


def _joint(press: Press, name: str, time: float = 0.0) -> Array:
    linkage = press.linkage()
    joint = next(j for j in linkage.revolutes if j.name == name)
    position = press.ideal_motion(np.array([time])).position
    return np.asarray(_ends(linkage, joint.first, position)[0])


def _slider(press: Press, count: int = 20_001) -> tuple[Array, Array, Array]:
    """Height, velocity and acceleration of the slider over one cycle."""
    motion = press.ideal_motion(np.linspace(0.0, press.period, count))
    i = 3 * press.linkage().index("slider 6") + 1
    return motion.position[:, i], motion.velocity[:, i], motion.acceleration[:, i]


@pytest.mark.parametrize(
    ("joint", "place"),
    [
        ("O7", (0.0, 0.0)),
        ("O2", (0.24, 0.1345)),
        ("A", (0.27422, 0.19556)),
        ("B", (0.43041, -0.10644)),
        ("C", (0.23614, -0.18617)),
        ("D", (0.04388, -0.05454)),
        ("E", (0.240, -0.58615)),
    ],
)
def test_standard_press_at_the_start(joint: str, place: tuple[float, float]) -> None:
    # Given to five decimals.
    np.testing.assert_allclose(_joint(Press(), joint), place, atol=5.1e-6)


def test_equation_14_at_any_time() -> None:
    press = Press()
    for time in (0.0, 0.1, 0.37):
        theta_2 = math.radians(-119.27) - press.speed * time
        theta_7 = math.radians(-51.18) + press.speed * time
        a = np.array([0.24, 0.1345]) - 0.07 * np.array([math.cos(theta_2), math.sin(theta_2)])
        d = 0.07 * np.array([math.cos(theta_7), math.sin(theta_7)])
        np.testing.assert_allclose(_joint(press, "A", time), a, atol=1e-15)
        np.testing.assert_allclose(_joint(press, "D", time), d, atol=1e-15)


def test_stroke_velocity_and_acceleration_of_the_standard_press() -> None:
    height, velocity, acceleration = _slider(Press(speed=3.5 * math.pi))
    assert np.ptp(height) == pytest.approx(0.1070, abs=5e-5)
    assert height.max() - height[0] == pytest.approx(0.1061, abs=5e-5)
    assert velocity.min() == pytest.approx(-0.889, abs=5e-4)
    assert velocity.max() == pytest.approx(0.966, abs=5e-4)
    assert acceleration.min() == pytest.approx(-20.0, abs=0.05)
    assert acceleration.max() == pytest.approx(12.4, abs=0.05)


@pytest.mark.parametrize(
    ("name", "low", "high", "start", "fastest"),
    [
        ("standard", -0.5871, -0.4800, -0.5862, 0.966),
        ("swapped", -0.5772, -0.4678, -0.5744, 0.955),
        ("lifted", 0.0785, 0.1856, 0.1695, 0.983),
    ],
)
def test_travel_of_each_geometry(
    name: str, low: float, high: float, start: float, fastest: float
) -> None:
    height, velocity, _ = _slider(Press(geometry=GEOMETRIES[name], speed=3.5 * math.pi))
    # Four decimals.
    assert height.min() == pytest.approx(low, abs=5.1e-5)
    assert height.max() == pytest.approx(high, abs=5.1e-5)
    assert height[0] == pytest.approx(start, abs=5.1e-5)
    assert velocity.max() == pytest.approx(fastest, abs=5.1e-4)


@given(presses)
def test_every_joint_stays_closed(press: Press) -> None:
    linkage = press.linkage()
    position = press.ideal_motion(np.linspace(0.0, press.period, 91)).position
    for joint in linkage.revolutes:
        gap = _ends(linkage, joint.first, position) - _ends(linkage, joint.second, position)
        assert np.max(np.abs(gap)) < 1e-14, joint.name
    for guide in linkage.guides:
        i = 3 * linkage.index(guide.body)
        away = position[:, i : i + 2] - [guide.x, guide.y]
        across = away @ [-math.sin(guide.direction), math.cos(guide.direction)]
        assert np.max(np.abs(across)) < 1e-14
        assert np.max(np.abs(position[:, i + 2] - guide.angle)) < 1e-14


@given(presses, st.floats(0.0, 1.0))
def test_velocity_and_acceleration_are_derivatives(press: Press, part: float) -> None:
    step = 1e-4 / press.speed
    time = part * press.period + np.linspace(-2.0 * step, 2.0 * step, 5)
    motion = press.ideal_motion(time)
    # Fourth-order differences: truncation some (1e-4)^4, round-off 1e-16 / 1e-4, both
    # relative to a length of 1 m per radian of crank.
    stencil = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * step)
    np.testing.assert_allclose(
        motion.velocity[2], stencil @ motion.position, atol=1e-10 * press.speed
    )
    np.testing.assert_allclose(
        motion.acceleration[2], stencil @ motion.velocity, atol=1e-10 * press.speed**2
    )


@names
def test_motion_scales_with_speed_and_repeats(name: str) -> None:
    slow = Press(geometry=GEOMETRIES[name], speed=math.pi)
    fast = Press(geometry=GEOMETRIES[name], speed=4.0 * math.pi)
    turn = np.linspace(0.0, 1.0, 37)
    one, other = slow.ideal_motion(turn * slow.period), fast.ideal_motion(turn * fast.period)
    np.testing.assert_allclose(one.position, other.position, atol=1e-13)
    np.testing.assert_allclose(16.0 * one.acceleration, other.acceleration, atol=1e-9)
    moved = one.position[-1] - one.position[0]
    turns = np.zeros(18)
    turns[2], turns[17] = -2.0 * math.pi, 2.0 * math.pi
    np.testing.assert_allclose(moved, turns, atol=1e-13)


@names
def test_plate_is_the_triangle_asked_for(name: str) -> None:
    press = Press(geometry=GEOMETRIES[name])
    corner = {key: np.array([at.x, at.y]) for key, at in press.plate_corners().items()}
    geometry = press.geometry
    for ends, side in (
        ("BD", geometry.side_bd),
        ("BC", geometry.side_bc),
        ("CD", geometry.side_cd),
    ):
        assert np.hypot(*(corner[ends[0]] - corner[ends[1]])) == pytest.approx(side, rel=1e-14)
    # The mass centre is the centroid.
    np.testing.assert_allclose(sum(corner.values()), [0.0, 0.0], atol=1e-16)


@names
def test_assembly_is_on_the_sides_asked_for(name: str) -> None:
    press = Press(geometry=GEOMETRIES[name])
    for time in np.linspace(0.0, press.period, 12):
        a, b, c, d, e = (_joint(press, joint, float(time)) for joint in "ABCDE")

        def left_of(p: Array, q: Array, r: Array) -> float:
            return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

        assert left_of(d, a, b) * press.geometry.side_b > 0.0
        assert left_of(d, b, c) * press.geometry.side_c > 0.0
        assert (e[1] - c[1]) * press.geometry.slider_side > 0.0


def test_linkage_is_the_papers() -> None:
    linkage = Press().linkage()
    masses = [body.mass for body in linkage.bodies]
    assert masses == [0.0243, 0.1085, 0.4503, 0.1272, 0.0288, 0.0243]
    inertias = [body.inertia for body in linkage.bodies if body.name != "slider 6"]
    assert inertias == [5.396e-4, 1.1e-3, 3.779e-3, 1.771e-3, 5.396e-4]
    # Two degrees of freedom, both driven.
    freedoms = 3 * len(linkage.bodies) - 2 * len(linkage.revolutes) - 2 * len(linkage.guides)
    assert freedoms == len(linkage.drives) == 2
    drives = {drive.body: drive for drive in linkage.drives}
    assert (drives["crank 2"].angle, drives["crank 7"].angle) == (CRANK_2_START, CRANK_7_START)
    speed = Press().speed
    assert (drives["crank 2"].angle, drives["crank 2"].speed) == (CRANK_2_START, -speed)
    assert (drives["crank 7"].angle, drives["crank 7"].speed) == (CRANK_7_START, speed)
    # Rod 3 carries the hole at A, rod 5 that at C.
    holes = {joint.name: (joint.first.body, joint.second.body) for joint in linkage.revolutes}
    assert holes["A"] == ("rod 3", "crank 2")
    assert holes["C"] == ("rod 5", "plate 4")


@pytest.mark.parametrize(
    ("press", "joint"),
    [
        (Press(length_3=0.05), "B"),
        (Press(length_3=2.0), "B"),
        (Press(geometry=Geometry(hx=5.0)), "B"),
        (Press(length_5=0.02), "E"),
    ],
)
def test_refuses_what_does_not_assemble_by_name(press: Press, joint: str) -> None:
    with pytest.raises(AssemblyError, match=f"joint {joint} does not close") as refusal:
        press.check_assembly()
    assert "\n" not in str(refusal.value)


def test_refuses_a_plate_that_is_no_triangle() -> None:
    with pytest.raises(InputError, match=r"plate 4 is no triangle.*0\.5 m"):
        Press(geometry=Geometry(side_bd=0.5))


@pytest.mark.filterwarnings("error")
def test_cranks_that_meet_are_refused_quietly() -> None:
    """A on D leaves the direction of B open; that is no reason for a numerical warning."""
    theta_2, theta_7 = CRANK_2_START, CRANK_7_START
    o2 = 0.07 * np.array(
        [math.cos(theta_2) + math.cos(theta_7), math.sin(theta_2) + math.sin(theta_7)]
    )
    with pytest.raises(AssemblyError, match="joint B does not close"):
        Press(geometry=Geometry(hx=float(o2[0]), hy=float(o2[1]))).check_assembly()


def test_a_gap_between_two_samples_is_found() -> None:
    """A linkage that opens for a fraction of a degree does not pass."""
    press = Press()
    low, high = 0.05, 0.30
    for _ in range(60):
        middle = 0.5 * (low + high)
        try:
            replace(press, length_3=middle).check_assembly()
            high = middle
        except AssemblyError:
            low = middle
    # The shortest rod that passes must close at every time, not only where it was sampled.
    shortest = replace(press, length_3=high)
    shortest.ideal_motion(np.linspace(0.0, press.period, 200_001))


@names
def test_geometries_keep_their_names(name: str) -> None:
    assert GEOMETRIES[name].name == name
    assert name in Press(geometry=GEOMETRIES[name]).linkage().name


@pytest.mark.parametrize(
    ("geometry", "field"),
    [
        (replace(Geometry(), side_b=0.5), "side_b"),
        (replace(Geometry(), side_c=0.0), "side_c"),
        (replace(Geometry(), slider_side=2.0), "slider_side"),
    ],
)
def test_a_side_is_one_of_two(geometry: Geometry, field: str) -> None:
    """Half a side assembles into links of another length."""
    with pytest.raises(InputError, match=field):
        Press(geometry=geometry)
