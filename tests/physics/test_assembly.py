"""Assembly and ideal motion: closed forms, and linkages that are refused."""

import math

import numpy as np
import pytest
from closed_form import press_motion, slider_crank_motion
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from presswear.linkage.bodies import Bar
from presswear.linkage.drives import Drive
from presswear.linkage.joints import Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.points import OutputPoint
from presswear.linkage.press import GEOMETRIES, Press
from presswear.physics.assembly import assembled
from presswear.physics.curve_following import motion_of
from presswear.physics.ideal import Motion, ideal_motion
from presswear.tools.errors import AssemblyError

SPEED = 30.0  # of the crank, rad/s
START = 0.3  # angle of the crank, rad
PERIOD = 2.0 * math.pi / SPEED
# Lengths of the four-bar, m
CRANK = 0.05
COUPLER = 0.20
ROCKER = 0.12
BASE = 0.18


def four_bar(
    crank: float = CRANK,
    coupler: float = COUPLER,
    rocker: float = ROCKER,
    base: float = BASE,
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
        drives=[Drive("crank", SPEED, START)],
        guess={"coupler": 0.6, "rocker": 1.4},
        output=OutputPoint("rocker", 0.0),
    )


def assert_equal_motions(result: Motion, exact: Motion, speed: float) -> None:
    """Compare two motions of a mechanism with a crank speed, rad/s."""
    largest = np.abs(exact.acceleration).max()
    assert_allclose(result.position, exact.position, atol=1e-12)
    assert_allclose(result.velocity / speed, exact.velocity / speed, atol=1e-11)
    assert_allclose(result.acceleration, exact.acceleration, atol=1e-10 * largest)


@settings(max_examples=8)  # an example takes 0.2 s
@given(
    st.sampled_from(sorted(GEOMETRIES)),
    st.floats(0.1 * math.pi, 40.0 * math.pi),
    st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=50),
)
def test_the_press_moves_as_in_closed_form(name, speed, cycles):
    press = Press(geometry=GEOMETRIES[name], speed=speed)
    time = press.period * np.append(0.0, cycles)
    exact = press_motion(press, time)
    result = motion_of(press).at(time)
    # The closed form has the nearest angle to that of the instant before, which may be
    # several turns off.
    turns = np.round((exact.position - result.position)[:, 2::3] / (2.0 * math.pi))
    exact.position[:, 2::3] -= 2.0 * math.pi * turns
    assert_equal_motions(result, exact, speed)


@settings(max_examples=6)  # an example takes 0.4 s
@given(st.floats(0.001, 1.0), st.floats(1.01, 10.0), st.floats(1.0, 5000.0))
def test_the_slider_crank_moves_as_in_closed_form(crank, ratio, speed):
    rod = min(ratio * crank, 10.0)
    mechanism = SliderCrank(crank, rod, slide_angle=0.0, speed=speed)
    time = np.linspace(0.0, 2.0 * mechanism.period, 97)
    exact = slider_crank_motion(mechanism, time)
    assert_equal_motions(motion_of(mechanism).at(time), exact, speed)


def test_the_four_bar_moves_as_in_the_textbook():
    """Freudenstein's equation for the rocker, and the coupler between crank and rocker.

    K1 cos(rocker) - K2 cos(crank) + K3 = cos(crank - rocker), with angles from the base.
    """
    time = np.linspace(0.0, PERIOD, 361)
    crank = START + SPEED * time
    _, coupler, rocker = ideal_motion(four_bar(), PERIOD).at(time).position[:, 2::3].T
    k1 = BASE / CRANK
    k2 = BASE / ROCKER
    k3 = (CRANK**2 - COUPLER**2 + ROCKER**2 + BASE**2) / (2.0 * CRANK * ROCKER)
    left = k1 * np.cos(rocker) - k2 * np.cos(crank) + k3
    assert_allclose(left, np.cos(crank - rocker), atol=1e-12)
    tip = CRANK * np.exp(1j * crank) + COUPLER * np.exp(1j * coupler)
    assert_allclose(tip, BASE + ROCKER * np.exp(1j * rocker), atol=1e-13)


def test_a_chain_of_four_bars_moves_with_the_first_group_by_group():
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
        assert_allclose(position[:, 6 * k + 5], expected, atol=1e-12)
    sizes = [len(rows) for rows, _ in ideal.rows.groups]
    assert sum(sizes) == 81
    assert max(sizes) < 40


def test_the_guess_selects_the_assembly_branch():
    lower = four_bar().changed(guess={"coupler": -0.8, "rocker": -1.9})
    for linkage, side in ((four_bar(), 1.0), (lower, -1.0)):
        crank, _, rocker = assembled(linkage)[:, 2]
        assert crank == START
        tip = CRANK * np.exp(1j * START)
        coupler = BASE + ROCKER * np.exp(1j * rocker) - tip
        assert abs(coupler) == pytest.approx(COUPLER, rel=1e-13)
        assert side * (coupler / (BASE - tip)).imag > 0.0


TWICE = [Drive("crank", SPEED, START), Drive("rocker", 1.0)]
PARALLELOGRAM = four_bar(0.1, 0.2, 0.1, 0.2)
REFUSED = {
    "free to move: .* hold 8; add joints, guides or drives that hold 1 more$": four_bar().changed(
        drives=[]
    ),
    "overconstrained: .* 1 too many": four_bar().changed(drives=TWICE),
    # The crank is too long for a full turn: coupler and rocker are in line before.
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
    # All links are in line at 180 degrees.
    r"at crank angle 162\.\d deg joint . does not close or is at a dead point": (
        PARALLELOGRAM.changed(guess={"coupler": 0.0, "rocker": 0.3})
    ),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("message", REFUSED)
def test_a_linkage_without_motion_is_refused_by_name(message):
    with pytest.raises(AssemblyError, match=message) as refusal:
        ideal_motion(REFUSED[message], PERIOD)
    assert "\n" not in str(refusal.value)


def test_a_truss_stands_still_or_is_refused():
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
    assert_allclose(motion.position[:, 2], math.pi / 3.0, rtol=1e-13)
    assert not motion.velocity.any()
    for base in (0.4, 0.5):
        with pytest.raises(
            AssemblyError, match=r"over the cycle: joint \S does not close"
        ):
            motion_of(truss(base))
