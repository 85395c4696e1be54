"""The ideal press and slider-crank in closed form: figures, constraints, derivatives, refusals."""

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.engines.settings import InHouse
from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import (
    CRANK_2_START,
    CRANK_7_START,
    GEOMETRIES,
    Geometry,
    Mechanism,
    Press,
    SliderCrank,
)
from presswear.physics.constraints import constraints_of
from presswear.physics.ideal import Motion, motion_of
from presswear.scene.catalog import slider_crank
from presswear.scene.scene import Scene
from presswear.tools.errors import AssemblyError, InputError
from presswear.tools.quantities import Quantity, meaning_of

Array = NDArray[np.float64]

CRANK = SliderCrank()
ROD, SLIDER = 3, 6
"""Where the x of these bodies of the slider-crank is."""
PRESSES = [Press(geometry=geometry) for geometry in GEOMETRIES.values()]
each_press = pytest.mark.parametrize("press", PRESSES, ids=list(GEOMETRIES))
mechanisms: st.SearchStrategy[Mechanism] = st.one_of(
    st.builds(
        lambda press, speed: replace(press, speed=speed),
        st.sampled_from(PRESSES),
        st.floats(0.1 * math.pi, 40.0 * math.pi),
    ),
    st.builds(
        lambda crank, ratio, speed: SliderCrank(crank, ratio * crank, speed=speed),
        st.floats(0.001, 1.0),
        st.floats(1.01, 10.0),
        st.floats(1.0, 5000.0),
    ),
)


def _cycle(mechanism: Mechanism, count: int) -> Motion:
    return motion_of(mechanism).at(np.linspace(0.0, mechanism.period, count))


def _scale(position: Array) -> float:
    """Size of a linkage, at least 1 m."""
    return max(1.0, float(np.abs(np.delete(position, np.s_[2::3], axis=1)).max()))


def _violations(linkage: Linkage, motion: Motion, speed: float) -> Array:
    """Greatest violation of Phi = 0, its first and its second derivative, shape (3,).

    Drives are among the constraints.  Relative to the size of the linkage and to the speed.
    """
    constraints = constraints_of(linkage)
    worst = np.zeros(3)
    for k, t in enumerate(motion.time):
        q, v, a = motion.position[k], motion.velocity[k], motion.acceleration[k]
        phi, phi_t, gamma, jacobian = constraints.evaluate(float(t), q, v)
        found = [np.abs(phi).max(), np.abs(phi_t).max(), np.abs(jacobian @ a - gamma).max()]
        worst = np.maximum(worst, found)
    return np.asarray(worst / _scale(motion.position) / speed ** np.arange(3))


@given(mechanisms)
def test_every_constraint_holds_at_all_three_levels(mechanism: Mechanism) -> None:
    found = _violations(mechanism.linkage(), _cycle(mechanism, 37), mechanism.speed)
    assert np.all(found < [1e-14, 1e-12, 1e-11])


@given(mechanisms, st.floats(0.0, 1.0))
def test_velocity_and_acceleration_are_derivatives(mechanism: Mechanism, part: float) -> None:
    step = 1e-4 / mechanism.speed
    time = part * mechanism.period + np.linspace(-2.0 * step, 2.0 * step, 5)
    motion = motion_of(mechanism).at(time)
    # Fourth-order differences: truncation some (1e-4)^4, round-off 1e-16 / 1e-4, both
    # relative to the size of the linkage per radian of crank.
    stencil = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * step)
    bound = (1e-10 if isinstance(mechanism, Press) else 1e-9) * _scale(motion.position)
    for level, (value, rate) in enumerate(
        ((motion.position, motion.velocity), (motion.velocity, motion.acceleration)), start=1
    ):
        atol = bound * mechanism.speed**level
        np.testing.assert_allclose(rate[2], stencil @ value, atol=atol)


@pytest.mark.parametrize("mechanism", [Press(), CRANK], ids=["press", "slider-crank"])
def test_every_quantity_is_checked_by_name(mechanism: Any) -> None:
    for item in fields(mechanism):
        meaning = meaning_of(item)
        if not isinstance(meaning, Quantity):
            assert item.name in ("geometry", "servo")
            continue
        for value in (meaning.low - 1.0, meaning.high + 1.0, math.nan, "x"):
            with pytest.raises(InputError, match=f"^{item.name} = .*allowed is"):
                replace(mechanism, **{item.name: value})


SHORT_ROD = r"rod_length = \S+ m: with crank_length = 0\.05 m allowed is 0\.050005 m to 10 m"


@pytest.mark.parametrize(
    ("mechanism", "says"),
    [
        (Press(length_3=0.05), r"at crank angle \S+ deg joint \S+ does not close"),
        (Press(length_3=2.0), r"at crank angle \S+ deg joint \S+ does not close"),
        (Press(geometry=Geometry(hx=5.0)), r"at crank angle \S+ deg joint \S+ does not close"),
        (Press(length_5=0.02), "joint (C|E) does not close"),
    ],
)
def test_what_does_not_assemble_is_refused_by_name(mechanism: Any, says: str) -> None:
    with pytest.raises(AssemblyError, match=says) as refusal:
        motion_of(mechanism)
    assert "\n" not in str(refusal.value)
    with pytest.raises(AssemblyError, match=says):
        Scene(mechanism=mechanism, joints=mechanism.openable[0]).check()


@pytest.mark.parametrize("rod", [0.01, 0.05, 0.0500001])
def test_a_rod_that_stands_upright_is_refused(rod: float) -> None:
    with pytest.raises(InputError, match=SHORT_ROD):
        SliderCrank(rod_length=rod)


def _joint(press: Press, name: str, time: float = 0.0) -> Array:
    """Global place of a joint."""
    linkage = press.linkage()
    end: Attachment = next(joint.first for joint in linkage.revolutes if joint.name == name)
    if end.body == GROUND:
        return np.array([end.x, end.y])
    i = 3 * linkage.index(end.body)
    x, y, turn = motion_of(press).at(np.array([time])).position[0, i : i + 3]
    c, s = math.cos(turn), math.sin(turn)
    return np.array([x + c * end.x - s * end.y, y + s * end.x + c * end.y])


def test_equation_14_at_any_time() -> None:
    press = Press()
    for time in (0.0, 0.1, 0.37):
        theta_2 = math.radians(-119.27) - press.speed * time
        theta_7 = math.radians(-51.18) + press.speed * time
        a = np.array([0.24, 0.1345]) - 0.07 * np.array([math.cos(theta_2), math.sin(theta_2)])
        d = 0.07 * np.array([math.cos(theta_7), math.sin(theta_7)])
        np.testing.assert_allclose(_joint(press, "A", time), a, atol=1e-15)
        np.testing.assert_allclose(_joint(press, "D", time), d, atol=1e-15)


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
    motion = _cycle(Press(geometry=GEOMETRIES[name], speed=3.5 * math.pi), 20_001)
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


@each_press
def test_assembly_is_on_the_sides_asked_for(press: Press) -> None:
    def left_of(p: Array, q: Array, r: Array) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    for time in np.linspace(0.0, press.period, 12):
        a, b, c, d, e = (_joint(press, joint, float(time)) for joint in "ABCDE")
        assert left_of(d, a, b) * press.geometry.side_b > 0.0
        assert left_of(d, b, c) * press.geometry.side_c > 0.0
        assert (e[1] - c[1]) * press.geometry.slider_side > 0.0


def test_the_press_is_the_papers() -> None:
    linkage = Press().linkage()
    masses = [body.mass for body in linkage.bodies]
    assert masses == [0.0243, 0.1085, 0.4503, 0.1272, 0.0288, 0.0243]
    inertias = [body.inertia for body in linkage.bodies if body.name != "slider 6"]
    assert inertias == [5.396e-4, 1.1e-3, 3.779e-3, 1.771e-3, 5.396e-4]
    drives = {drive.body: (drive.angle, drive.speed) for drive in linkage.drives}
    speed = Press().speed
    assert drives == {"crank 2": (CRANK_2_START, -speed), "crank 7": (CRANK_7_START, speed)}
    # Rod 3 carries the hole at A, rod 5 that at C.
    holes = {joint.name: (joint.first.body, joint.second.body) for joint in linkage.revolutes}
    assert (holes["A"], holes["C"]) == (("rod 3", "crank 2"), ("rod 5", "plate 4"))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"side_bd": 0.5}, r"plate 4 is no triangle.*0\.5 m"),
        # Half a side assembles into links of another length.
        ({"side_b": 0.5}, "side_b"),
        ({"side_c": 0.0}, "side_c"),
        ({"slider_side": 2.0}, "slider_side"),
    ],
)
def test_a_geometry_that_is_none_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        Press(geometry=replace(Geometry(), **changes))


def test_the_slider_moves_as_in_the_textbook() -> None:
    """x = r cos a + sqrt(l^2 - r^2 sin^2 a), written out here on its own."""
    motion = _cycle(CRANK, 3601)
    r, rod, turn = 0.05, 0.12, CRANK.speed * motion.time
    expected = r * np.cos(turn) + np.sqrt(rod**2 - (r * np.sin(turn)) ** 2)
    np.testing.assert_allclose(motion.position[:, SLIDER], expected, atol=1e-15)
    start = [0.025, 0, 0, 0.11, 0, 0, 0.17, 0, 0]
    np.testing.assert_allclose(motion.position[0], start, atol=1e-16)
    # At the ends the acceleration is r w^2 (1 + r / rod) and r w^2 (1 - r / rod).
    outer, inner = motion.acceleration[[0, 1800], SLIDER] / (r * CRANK.speed**2)
    assert outer == pytest.approx(-(1.0 + r / rod), rel=1e-12)
    assert inner == pytest.approx(1.0 - r / rod, rel=1e-9)
    swing = motion.position[:, ROD + 2]
    assert (swing.max(), swing.min()) == pytest.approx((math.asin(r / rod), -math.asin(r / rod)))


@pytest.mark.parametrize("engine", ["dae", "exudyn-joints"])
def test_engines_follow_the_closed_form(engine: str) -> None:
    """Displacement, velocity and acceleration of the slider over two turns."""
    scene = replace(slider_crank(), joints="none", engine=engine)
    run = scene.solver.for_cycle(CRANK.period).simulate(
        scene.linkage(), start_of(scene), Plan(CRANK.period, 2)
    )
    assert run.status == "completed"
    rows = run.recorder.rows
    assert len(rows) > 100

    def errors(mechanism: SliderCrank) -> Array:
        exact = motion_of(mechanism).at(rows[:, 0])
        levels = (exact.position, exact.velocity, exact.acceleration)
        slider = np.column_stack([level[:, SLIDER] for level in levels])
        slider[:, 0] -= slider[0, 0]
        return np.asarray(np.abs(rows[:, 1:4] - slider).max(axis=0))

    in_house = isinstance(scene.solver, InHouse)
    assert np.all(errors(CRANK) < ([1e-12, 1e-10, 1e-7] if in_house else [1e-8, 1e-6, 1e-2]))
    assert np.all(errors(replace(CRANK, rod_length=0.1201)) > 100.0 * errors(CRANK))
    if in_house:
        end = motion_of(CRANK).at(np.array([run.time]))
        assert np.abs(run.end.position - end.position[0]).max() < 1e-9
