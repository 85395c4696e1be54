"""Assembly, ideal motion and bottom dead centre: closed forms, and what must be refused."""

import math
from typing import Any

import numpy as np
import pytest
from closed_form import press_motion, slider_crank_motion
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from presswear.linkage.drives import Drive
from presswear.linkage.elements import Bar, OutputPoint, Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.press import GEOMETRIES, Press
from presswear.physics.assembly import Rows, assembled
from presswear.physics.constraints import constraints_of
from presswear.physics.ideal import Motion, bottom_of, ideal_motion, motion_of
from presswear.tools.errors import AssemblyError

PERIOD = 2.0 * math.pi / 30.0


def four_bar(
    crank: float = 0.05, coupler: float = 0.20, rocker: float = 0.12, base: float = 0.18
) -> Linkage:
    return assemble(
        bodies=[
            Bar("crank", crank, 0.3),
            Bar("coupler", coupler, 0.3),
            Bar("rocker", rocker, 0.3),
        ],
        joints=[
            Pin("O", (0.0, 0.0), "crank.tail"),
            Pin("A", "crank.head", "coupler.tail"),
            Pin("B", "coupler.head", "rocker.head"),
            Pin("P", (base, 0.0), "rocker.tail"),
        ],
        drives=[Drive("crank", 30.0, 0.3)],
        guess={"coupler": 0.6, "rocker": 1.4},
        output=OutputPoint("rocker", 0.0),
    )


def agree(result: Motion, exact: Motion, speed: float) -> None:
    """To 1e-12 m and rad, and accelerations to 1e-10 of their greatest."""
    np.testing.assert_allclose(result.position, exact.position, atol=1e-12)
    np.testing.assert_allclose(
        result.velocity / speed, exact.velocity / speed, atol=1e-11
    )
    most = np.abs(exact.acceleration).max()
    np.testing.assert_allclose(
        result.acceleration, exact.acceleration, atol=1e-10 * most
    )


@given(
    st.sampled_from(sorted(GEOMETRIES)),
    st.floats(0.1 * math.pi, 40.0 * math.pi),
    st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=50),
)
def test_the_press_moves_as_in_closed_form(
    name: str, speed: float, cycles: list[float]
) -> None:
    press = Press(geometry=GEOMETRIES[name], speed=speed)
    time = press.period * np.array(cycles)
    exact = press_motion(press, np.append(0.0, time))
    result = motion_of(press).at(np.append(0.0, time))
    # The closed form makes angles continuous from one instant to the next, whatever
    # lies between.
    turns = np.round((exact.position - result.position)[:, 2::3] / (2.0 * math.pi))
    exact.position[:, 2::3] -= 2.0 * math.pi * turns
    agree(result, exact, speed)


@given(st.floats(0.001, 1.0), st.floats(1.01, 10.0), st.floats(1.0, 5000.0))
def test_the_slider_crank_moves_as_in_closed_form(
    crank: float, ratio: float, speed: float
) -> None:
    mechanism = SliderCrank(
        crank, min(ratio * crank, 10.0), slide_angle=0.0, speed=speed
    )
    time = np.linspace(0.0, 2.0 * mechanism.period, 97)
    agree(motion_of(mechanism).at(time), slider_crank_motion(mechanism, time), speed)


def test_the_four_bar_moves_as_in_the_textbook() -> None:
    """Freudenstein's equation for the rocker, and the coupler between their ends."""
    time = np.linspace(0.0, PERIOD, 361)
    crank = 0.3 + 30.0 * time
    _, coupler, rocker = ideal_motion(four_bar(), PERIOD).at(time).position[:, 2::3].T
    a = 0.05
    b = 0.20
    c = 0.12
    d = 0.18
    k1 = d / a
    k2 = d / c
    k3 = (a * a - b * b + c * c + d * d) / (2.0 * a * c)
    # K1 cos(rocker) - K2 cos(crank) + K3 = cos(crank - rocker), angles from the frame's
    # line.
    left = k1 * np.cos(rocker) - k2 * np.cos(crank) + k3
    np.testing.assert_allclose(left, np.cos(crank - rocker), atol=1e-12)
    tip = a * np.exp(1j * crank) + b * np.exp(1j * coupler)
    np.testing.assert_allclose(tip, d + c * np.exp(1j * rocker), atol=1e-13)


def test_rows_are_those_of_the_engines() -> None:
    """Phi, its derivatives and its Jacobian, far from any assembled position."""
    generator = np.random.default_rng(2)
    for linkage in (
        Press().linkage(),
        SliderCrank(slide_angle=0.0).linkage(),
        four_bar(),
    ):
        rows = Rows(linkage)
        constraints = constraints_of(linkage)
        assert rows.names == constraints.names
        shape = 5, rows.bodies, 3
        q, v, a = generator.normal(size=(3, *shape))
        time = generator.uniform(0.0, 1.0, 5)
        errors = rows.errors(time, q, v, a)
        jacobian = rows.jacobian(q)
        for k, t in enumerate(time):
            phi, phi_t, gamma, dense = constraints.evaluate(
                float(t), q[k].ravel(), v[k].ravel()
            )
            np.testing.assert_allclose(errors[0][k], phi, atol=1e-12)
            np.testing.assert_allclose(errors[1][k], phi_t, atol=1e-12)
            np.testing.assert_allclose(
                errors[2][k], dense @ a[k].ravel() - gamma, atol=1e-12
            )
            np.testing.assert_allclose(jacobian[k], dense, atol=1e-15)


def test_a_chain_of_four_bars_moves_with_the_first_group_by_group() -> None:
    """The rockers after the first are turned by parallelograms, so all of them turn alike."""
    first = four_bar()
    bodies = []
    joints = []
    guess = {"coupler": 0.6, "rocker": 1.4}
    for k in range(1, 13):
        bodies += [Bar(f"coupler {k}", 0.18, 0.3), Bar(f"rocker {k}", 0.12, 0.3)]
        before = f"rocker {k - 1}" if k > 1 else "rocker"
        joints += [
            Pin(f"A{k}", f"{before}.head", f"coupler {k}.tail"),
            Pin(f"B{k}", f"coupler {k}.head", f"rocker {k}.head"),
            Pin(f"P{k}", (0.18 + 0.18 * k, 0.0), f"rocker {k}.tail"),
        ]
        guess |= {f"coupler {k}": 0.0, f"rocker {k}": 1.4}
    chain = first.changed(
        bodies=[*bodies, *first.bodies],
        joints=[*joints, *first.joints],
        guess=guess,
        output=OutputPoint("rocker 12", 0.0),
    )
    ideal = ideal_motion(chain, PERIOD)
    time = np.linspace(0.0, PERIOD, 100)
    expected = ideal_motion(four_bar(), PERIOD).at(time).position[:, 8]
    position = ideal.at(time).position
    for k in range(12):
        np.testing.assert_allclose(position[:, 6 * k + 5], expected, atol=1e-12)
    sizes = [len(rows) for rows, _ in ideal.rows.groups]
    assert sum(sizes) == 81
    assert max(sizes) < 40
    q = position.reshape(len(time), -1, 3)
    right = np.random.default_rng(1).normal(size=(len(time), 81))
    whole = np.linalg.solve(ideal.rows.jacobian(q), right[..., np.newaxis])[..., 0]
    result = ideal.rows.solve(q, right).reshape(len(time), -1)
    np.testing.assert_allclose(result, whole, atol=1e-9 * np.abs(whole).max())


def test_the_guess_says_which_way_it_is_put_together() -> None:
    down = four_bar().changed(guess={"coupler": -0.8, "rocker": -1.9})
    for linkage, side in ((four_bar(), 1.0), (down, -1.0)):
        crank, _, rocker = assembled(linkage)[:, 2]
        assert crank == 0.3
        tip = 0.05 * np.exp(0.3j)
        coupler = 0.18 + 0.12 * np.exp(1j * rocker) - tip
        assert abs(coupler) == pytest.approx(0.20, rel=1e-13)
        assert side * (coupler / (0.18 - tip)).imag > 0.0


TWICE = [Drive("crank", 30.0, 0.3), Drive("rocker", 1.0)]
PARALLELOGRAM = four_bar(0.1, 0.2, 0.1, 0.2)
REFUSED = {
    "free to move: .* hold 8; add joints, guides or drives that hold 1 more$": four_bar().changed(
        drives=[]
    ),
    "overconstrained: .* 1 too many": four_bar().changed(drives=TWICE),
    # The crank is too long to turn all around: the links stretch at B on the way.
    r"at crank angle \S+ deg joint [ABP] does not close or is at a": four_bar(
        crank=0.15
    ),
    # The rods never meet.
    "joint [ABOP] does not close or is at a dead point$": four_bar(coupler=0.02),
    "joint . does not close .*; guess has no angle of coupler, rocker": four_bar(
        0.02, 0.1
    ).changed(guess={}),
    "guess of coupler = 149 deg: .* right angle": four_bar().changed(
        guess={"coupler": 2.6, "rocker": 1.4}
    ),
    "does not come back: after a cycle of 0.20944 s crank is elsewhere": four_bar().changed(
        drives=[Drive("crank", 12.0, 0.3)]
    ),
    # It folds.
    r"at crank angle 162\.\d deg joint . does not close or is at a dead point": (
        PARALLELOGRAM.changed(guess={"coupler": 0.0, "rocker": 0.3})
    ),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("message", REFUSED)
def test_a_linkage_without_motion_is_refused_by_name(message: str) -> None:
    with pytest.raises(AssemblyError, match=message) as refusal:
        ideal_motion(REFUSED[message], PERIOD)
    assert "\n" not in str(refusal.value)


def test_a_truss_stands_still_or_is_refused() -> None:
    """Two bars between two points of the frame: nothing drives them, and nothing has to."""

    def truss(base: float) -> Linkage:
        return assemble(
            bodies=[Bar("left", 0.2, 1.0), Bar("right", 0.2, 1.0)],
            joints=[
                Pin("O", (0.0, 0.0), "left.tail"),
                Pin("M", "left.head", "right.tail"),
                Pin("P", (base, 0.0), "right.head"),
            ],
            guess={"left": 1.0, "right": -1.0},
            cycle=1.0,
        )

    motion = motion_of(truss(0.2)).at(np.linspace(0.0, 2.0, 7))
    np.testing.assert_allclose(motion.position[:, 2], math.pi / 3.0, rtol=1e-13)
    assert not motion.velocity.any()
    for base in (0.4, 0.5):
        with pytest.raises(
            AssemblyError, match=r"over the cycle: joint \S does not close"
        ):
            motion_of(truss(base))


def bar(angle: float = 0.0, **changes: Any) -> Linkage:
    """A bar that turns about its tail; its head is watched upright."""
    return assemble(
        bodies=[Bar("bar", length=0.2, mass=1.0)],
        joints=[Pin("O", (0.0, 0.0), "bar.tail")],
        drives=[Drive("bar", speed=10.0, angle=angle)],
        output=OutputPoint("bar", 0.5 * math.pi, x=0.1),
        **changes,
    )


@pytest.mark.parametrize("geometry", list(GEOMETRIES))
def test_press_is_lowest_where_the_closed_form_stands(geometry: str) -> None:
    press = Press(geometry=GEOMETRIES[geometry])
    linkage = press.linkage()
    result = bottom_of(motion_of(press))
    assert result is not None

    def level(time: float, which: int) -> float:
        return float(press_motion(press, np.array([time])).output(linkage)[0, which])

    time = brentq(level, result.time - 0.02, result.time + 0.02, args=(1,), xtol=1e-16)
    assert result.time == pytest.approx(time, abs=1e-14)
    assert result.height == pytest.approx(level(time, 0), abs=1e-15)
    everywhere = np.linspace(0.0, press.period, 20_001)
    height, speed, _ = press_motion(press, everywhere).output(linkage).T
    assert result.height <= height.min() + 1e-15
    assert result.stroke == pytest.approx(float(np.ptp(height)), rel=1e-5)
    begin, end = result.window
    assert begin < result.time < end <= press.period
    # The window is the lower half of the stroke, to within a node of 1440.
    half = height.min() + 0.5 * np.ptp(height)
    for edge in (begin, end):
        assert abs(level(edge, 0) - half) < np.abs(speed).max() * press.period / 1440


@pytest.mark.parametrize(
    ("direction", "part", "sign"), [(0.0, 0.5, 1.0), (math.pi, 0.0, -1.0)]
)
def test_slider_crank_is_lowest_in_line(
    direction: float, part: float, sign: float
) -> None:
    """In the opposite direction the bottom falls on the boundary of two cycles."""
    mechanism = SliderCrank(slide_angle=0.0)
    linkage = mechanism.linkage().changed(output=OutputPoint("slider", direction))
    bottom = bottom_of(motion_of(linkage))
    assert bottom is not None
    assert bottom.time == pytest.approx(
        part * mechanism.period, abs=1e-12 * mechanism.period
    )
    height = sign * mechanism.rod_length - mechanism.crank_length
    assert bottom.height == pytest.approx(height, abs=1e-15)
    # The window lies on both sides.
    begin, end = bottom.window
    assert min(end - bottom.time, bottom.time - begin) > 0.1 * mechanism.period


@pytest.mark.parametrize(
    ("angle", "place"), [(0.0, 0.75), (0.4, 0.75 - 0.4 / math.tau)]
)
@pytest.mark.parametrize("run_up", [0, 2])
def test_bar_is_lowest_at_three_quarters(
    angle: float, place: float, run_up: int
) -> None:
    linkage = bar(angle, run_up=run_up)
    result = bottom_of(motion_of(linkage))
    assert result is not None
    back = 1.0 if place + 0.25 > 1.0 else 0.0
    assert result.time == pytest.approx((place - back) * linkage.period, abs=1e-13)
    assert result.height == pytest.approx(-0.2, abs=1e-15)
    assert result.first == int(back)
    late = result.delay(
        linkage.run_up_time + linkage.period * np.array([place, 7.0 + place, 0.9])
    )
    assert late[:2] == pytest.approx(0.0, abs=1e-13)
    assert late[2] == pytest.approx((0.9 - place) * linkage.period, abs=1e-13)


def test_what_stands_has_none() -> None:
    linkage = bar().changed(output=OutputPoint("bar", 0.5 * math.pi, x=-0.1))
    assert bottom_of(motion_of(linkage)) is None
