"""Touches found between steps, step lengths, and a pin that bounces on one line."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from two_bodies import JOINT, Pair

from presswear.clearance import contact_of, joint_load
from presswear.compiled import Records
from presswear.laws import delivered_restitution
from presswear.linkage import GROUND, Attachment, ClearanceJoint
from presswear.touch import (
    LANDING,
    OVERSHOOT,
    STEPS,
    TALLY,
    TOUCH,
    contact_step,
    crossing,
    hermite,
    late_touch,
    next_step,
    settle,
)

Array = NDArray[np.float64]

NO_TOUCH = 2.0
MASS = 0.1
PARTS = 50.0
FREE = 1e-4


def _cubic(a: float, b: float, c: float, d: float, s: float) -> tuple[float, float]:
    """Value and slope of a + b s + c s^2 + d s^3."""
    return a + s * (b + s * (c + s * d)), b + s * (2.0 * c + s * 3.0 * d)


coefficients = st.floats(-10.0, 10.0)


@given(
    coefficients,
    coefficients,
    coefficients,
    coefficients,
    st.floats(1e-3, 10.0),
    st.floats(0.0, 1.0),
)
def test_hermite_reproduces_any_cubic(
    a: float, b: float, c: float, d: float, h: float, s: float
) -> None:
    p0, slope0 = _cubic(a, b, c, d, 0.0)
    p1, slope1 = _cubic(a, b, c, d, 1.0)
    value, rate = hermite(p0, slope0 / h, p1, slope1 / h, h, s)
    exact, slope = _cubic(a, b, c, d, s)
    assert value == pytest.approx(exact, abs=1e-13)
    assert rate == pytest.approx(slope / h, abs=1e-12 / h)


@given(st.floats(0.01, 0.99), st.floats(0.1, 5.0), st.floats(0.0, 5.0), st.floats(1e-7, 1e-3))
def test_crossing_finds_the_root_of_a_rising_cubic(
    root: float, slope: float, bend: float, h: float
) -> None:
    # (s - r)(k + w (s - r)^2) rises throughout and is zero at r alone.
    def value(s: float) -> tuple[float, float]:
        x = s - root
        return 1e-6 * x * (slope + bend * x * x), 1e-6 * (slope + 3.0 * bend * x * x)

    (p0, slope0), (p1, slope1) = value(0.0), value(1.0)
    assert crossing(p0, slope0 / h, p1, slope1 / h, h) == pytest.approx(root, abs=1e-14)


@given(st.floats(0.05, 0.9), st.floats(0.02, 0.5), st.floats(-1.0, 3.0))
def test_crossing_finds_touch_and_go(root: float, length: float, lean: float) -> None:
    leaves = root + length
    if leaves >= 0.999:
        return

    # Positive between the two roots only: the third factor keeps its sign.
    def value(s: float) -> tuple[float, float]:
        third = 1.5 + 0.25 * lean * s
        p = (s - root) * (leaves - s)
        return p * third, (leaves + root - 2.0 * s) * third + p * 0.25 * lean

    (p0, r0), (p1, r1) = value(0.0), value(1.0)
    assert p0 < 0.0
    assert p1 < 0.0
    assert crossing(p0, r0, p1, r1, 1.0) == pytest.approx(root, abs=1e-12)


@pytest.mark.parametrize(
    ("p0", "r0", "p1", "r1"),
    [
        (-1.0, 0.5, -0.5, 0.5),  # still approaching
        (-1.0, -1.0, -2.0, -1.0),  # leaving
        (-1.0, 1.0, -1.0, -1.0),  # comes to 3/4 of the way and turns
        (-1.0, -1.0, -1.0, 1.0),  # turns away from it
        (-1.0, 0.0, -1.0, 0.0),
    ],
)
def test_no_crossing(p0: float, r0: float, p1: float, r1: float) -> None:
    assert crossing(p0, r0, p1, r1, 1.0) == NO_TOUCH


def test_crossing_at_the_end_of_a_step_is_in_the_step() -> None:
    assert crossing(-1.0, 1.0, 1e-300, 1.0, 1.0) == pytest.approx(1.0, abs=1e-15)
    assert crossing(0.0, 1.0, 1.0, 1.0, 1.0) == pytest.approx(0.0, abs=1e-15)


def test_crossing_of_three_roots_is_the_first() -> None:
    # (s - 0.1)(s - 0.5)(s - 0.7): touches at 0.1, opens at 0.5, touches again at 0.7.
    a, b, c, d = -0.035, 0.47, -1.3, 1.0
    (p0, r0), (p1, r1) = _cubic(a, b, c, d, 0.0), _cubic(a, b, c, d, 1.0)
    assert crossing(p0, r0, p1, r1, 1.0) == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize("speed", [1e-4, 0.01, 0.3, 5.0])
def test_contact_step_divides_a_hertz_impact(speed: float) -> None:
    stiffness = 1.25e10
    deepest = (5.0 * MASS * speed**2 / (4.0 * stiffness)) ** 0.4
    duration = 2.9432751843 * deepest / speed
    step = contact_step(stiffness, 1.5, MASS, 0.0, speed, PARTS)
    # Half a period at the deepest point's tangent stiffness: pi sqrt(8 / 15) against 2.943.
    assert step * PARTS / duration == pytest.approx(
        math.pi * math.sqrt(8.0 / 15.0) / 2.9432751843, rel=1e-9
    )
    assert 0.75 < step * PARTS / duration <= 1.0


def test_contact_step_of_a_linear_spring_is_exact() -> None:
    half_period = math.pi * math.sqrt(MASS / 1e6)
    for depth, rate in ((0.0, 0.3), (1e-4, 0.0), (5e-5, -0.1)):
        step = contact_step(1e6, 1.0, MASS, depth, rate, PARTS)
        assert step == pytest.approx(half_period / PARTS, rel=1e-12)


@given(st.floats(1e-9, 1e-5), st.floats(-1.0, 1.0), st.floats(1.0, 2.5))
def test_contact_step_depends_on_energy_alone(depth: float, rate: float, exponent: float) -> None:
    stiffness = 1e10
    energy = 0.5 * MASS * rate**2 + stiffness * depth ** (exponent + 1.0) / (exponent + 1.0)
    deepest = ((exponent + 1.0) * energy / stiffness) ** (1.0 / (exponent + 1.0))
    here = contact_step(stiffness, exponent, MASS, depth, rate, PARTS)
    turned = contact_step(stiffness, exponent, MASS, deepest, 0.0, PARTS)
    assert here == pytest.approx(turned, rel=1e-9)


def test_contact_step_without_energy_sets_no_limit() -> None:
    assert contact_step(1e10, 1.5, MASS, 0.0, 0.0, PARTS) == math.inf
    assert contact_step(1e10, 1.5, MASS, -1e-3, 0.0, PARTS) == math.inf


@pytest.mark.parametrize("rate", [0.0, 0.3])
def test_contact_step_of_a_body_that_does_not_give_way_is_no_limit(rate: float) -> None:
    """Two driven bodies meet with infinite mass; a step that is no number helps nobody."""
    assert contact_step(1e10, 1.5, math.inf, 1e-6, rate, PARTS) > 0.0


LINE = replace(
    JOINT,
    bearing=Attachment(GROUND, 0.0, 0.0),
    pin=Attachment("pin", 0.0, 0.0),
)


@dataclass
class _Line:
    """A pin on the x axis inside a bearing on the frame, pushed by a constant force."""

    push: float = 0.0
    joint: ClearanceJoint = LINE
    q: Array = field(default_factory=lambda: np.zeros(3))
    v: Array = field(default_factory=lambda: np.zeros(3))
    time: float = 0.0

    def __post_init__(self) -> None:
        pair = Pair(self.joint, self.q, self.v)
        self.joints: Records = pair.joints
        self.surfaces = pair.surfaces
        self.onset = np.zeros(1)
        self.touch = np.zeros(1, TOUCH)
        self.touch["effective_mass"] = MASS
        self.tally = np.zeros(1, TALLY)
        self.tally["fewest_steps"] = np.iinfo(np.int64).max
        self.steps = np.zeros(1, STEPS)
        self.steps["free"], self.steps["per_contact"] = FREE, PARTS
        self.steps["sustained"], self.steps["least"] = 10.0, 1e-9
        self.episodes = np.zeros((1, 20, 6))
        self.settle()

    def start(self, x: float, speed: float) -> "_Line":
        """From a place and a speed, as after an accepted step."""
        self.q[0], self.v[0] = x, speed
        self.settle()
        return self

    def settle(self) -> None:
        settle(
            self.joints,
            self.onset,
            self.touch,
            self.tally,
            self.episodes,
            self.surfaces,
            self.time,
            self.q,
            self.v,
        )

    def acceleration(self, x: float, speed: float, onset: float) -> float:
        q, v = np.array([x, 0.0, 0.0]), np.array([speed, 0.0, 0.0])
        load = joint_load(self.joints, 0, np.array([onset]), self.surfaces, q, v)
        return self.push + load.x / MASS

    def wanted(self) -> float:
        """Next step from the settled state."""
        now = self.acceleration(self.q[0], self.v[0], self.onset[0])
        a = np.array([now, 0.0, 0.0])
        return next_step(
            self.joints, self.onset, self.touch, self.steps, self.surfaces, self.q, self.v, a
        )

    def moved(self, h: float) -> tuple[float, float]:
        """Place and speed a step later (Runge-Kutta, exact in free flight)."""

        def rate(x: float, speed: float) -> tuple[float, float]:
            return speed, self.acceleration(x, speed, self.onset[0])

        x, speed = float(self.q[0]), float(self.v[0])
        a1, b1 = rate(x, speed)
        a2, b2 = rate(x + 0.5 * h * a1, speed + 0.5 * h * b1)
        a3, b3 = rate(x + 0.5 * h * a2, speed + 0.5 * h * b2)
        a4, b4 = rate(x + h * a3, speed + h * b3)
        return x + h / 6.0 * (a1 + 2 * a2 + 2 * a3 + a4), speed + h / 6.0 * (
            b1 + 2 * b2 + 2 * b3 + b4
        )

    def flown(self, h: float) -> tuple[float, float]:
        """Place and speed a step later without contact."""
        return self.q[0] + h * (self.v[0] + 0.5 * h * self.push), self.v[0] + h * self.push

    def late(self, h: float, x: float, speed: float) -> float:
        """What ``late_touch`` says to a trial state."""
        q, v = np.array([x, 0.0, 0.0]), np.array([speed, 0.0, 0.0])
        return late_touch(
            self.joints, self.onset, self.touch, self.steps, self.surfaces, self.time + h, q, v
        )

    def accept(self, h: float, x: float, speed: float) -> None:
        self.time += h
        self.q[0], self.v[0] = x, speed
        self.settle()


@pytest.mark.parametrize("push", [-2000.0, 0.0, 2000.0])
@pytest.mark.parametrize("speed", [0.5, 3.0])
@pytest.mark.parametrize("gap", [1e-9, 1e-6, 2e-5])
def test_step_lands_just_behind_a_touch(gap: float, speed: float, push: float) -> None:
    line = _Line(push).start(LINE.clearance - gap, speed)
    h = line.wanted()
    x, after = line.flown(h)
    closing = math.sqrt(speed**2 + 2.0 * push * gap)
    part = contact_step(LINE.normal.stiffness, 1.5, MASS, 0.0, closing, PARTS)
    landed = (x - LINE.clearance) / closing
    assert landed == pytest.approx(LANDING * part, rel=0.01)
    assert line.late(h, x, after) == -1.0


def test_free_flight_away_from_the_bearing_takes_the_longest_step() -> None:
    assert _Line().start(0.0, 0.0).wanted() == FREE
    assert _Line().start(0.5e-3, 1.0).wanted() == FREE
    assert _Line().start(LINE.clearance - 1e-6, -1.0).wanted() == FREE
    # Turned back before it arrives.
    assert _Line(-1e6).start(LINE.clearance - 1e-6, 1.0).wanted() == FREE
    # Departing, but pulled back within the step.
    pulled = _Line(1e5).start(LINE.clearance - 1e-7, -0.1)
    arrival = (0.1 + math.sqrt(0.01 + 2e5 * 1e-7)) / 1e5
    assert arrival < pulled.wanted() < 1.2 * arrival


def test_late_touch_sends_a_step_back_to_the_touch() -> None:
    speed, gap, push = 1.0, 2e-5, 500.0
    line = _Line(push).start(LINE.clearance - gap, speed)
    touch = (math.sqrt(speed**2 + 2.0 * push * gap) - speed) / push
    shorter = line.late(FREE, *line.flown(FREE))
    closing = speed + push * touch
    part = contact_step(LINE.normal.stiffness, 1.5, MASS, 0.0, closing, PARTS)
    # Free flight is a parabola: the cubic is exact.
    assert shorter == pytest.approx(touch + LANDING * part, rel=1e-9)
    assert line.late(shorter, *line.flown(shorter)) == -1.0


def test_a_slight_overshoot_is_accepted_a_larger_one_is_not() -> None:
    speed, gap = 1.0, 2e-5
    line = _Line().start(LINE.clearance - gap, speed)
    part = contact_step(LINE.normal.stiffness, 1.5, MASS, 0.0, speed, PARTS)
    for share, accepted in ((0.9 * OVERSHOOT, True), (1.1 * OVERSHOOT, False)):
        h = gap / speed + share * part
        assert (line.late(h, *line.flown(h)) < 0.0) == accepted


def test_late_touch_sees_touch_and_go() -> None:
    push = -4e4
    gap = 1e-5
    # Rises to 1.25e-6 m beyond the bearing's surface and falls back within the step.
    speed = math.sqrt(2.0 * -push * 1.125 * gap)
    line = _Line(push).start(LINE.clearance - gap, speed)
    h = 2.0 * speed / -push
    x, after = line.flown(h)
    assert x < LINE.clearance
    shorter = line.late(h, x, after)
    touch = (speed - math.sqrt(speed**2 - 2.0 * -push * gap)) / -push
    assert touch < shorter < 1.1 * touch
    assert line.flown(shorter)[0] > LINE.clearance


@pytest.mark.parametrize(("push", "closing"), [(-1e4, 1e-2), (-1e4, 1e-4), (-100.0, 1e-6)])
def test_a_step_is_not_sent_back_to_the_same_place_again(push: float, closing: float) -> None:
    """A graze may be over before the landing behind its touch."""
    gap = 1e-5
    speed = math.sqrt(closing**2 - 2.0 * push * gap)
    line = _Line(push).start(LINE.clearance - gap, speed)
    first = 1.5 * speed / -push
    second = line.late(first, *line.flown(first))
    assert 0.0 < second < first
    third = line.late(second, *line.flown(second))
    assert third < 0.0 or third < 0.9 * second


def test_late_touch_leaves_closed_joints_and_open_flight_alone() -> None:
    line = _Line().start(0.0, 1.0)
    assert line.late(FREE, *line.flown(FREE)) == -1.0
    line = _Line().start(LINE.clearance - 1e-6, 1.0)
    line.onset[0] = 1.0
    assert line.late(FREE, *line.flown(FREE)) == -1.0


@pytest.mark.parametrize("speed", [0.05, 1.0])
def test_a_pin_that_bounces_is_counted_timed_and_loses_what_the_law_says(speed: float) -> None:
    line = _Line().start(0.0, speed)
    sent_back = 0
    h = line.wanted()
    while line.tally["contacts"][0] < 3:
        x, after = line.moved(h)
        shorter = line.late(h, x, after)
        if shorter > 0.0:
            assert shorter < h
            sent_back += 1
            h = shorter
            continue
        line.accept(h, x, after)
        h = line.wanted()
        assert h > 0.0
        assert line.time < 10.0 * LINE.clearance / speed * 3.0
    rows = line.episodes[0, :3]
    delivered = delivered_restitution(LINE.normal.damping)
    closing = speed * delivered ** np.arange(3)
    # RK4 with some 60 steps an impact; the landing is followed without force for 1/2500 of it.
    np.testing.assert_allclose(rows[:, 2], closing, rtol=1e-5)
    np.testing.assert_allclose(-rows[:, 3], closing * delivered, rtol=1e-5)
    # The first touch ends a flight of one clearance at constant speed.
    assert rows[0, 0] == pytest.approx(LINE.clearance / speed, rel=1e-6)
    np.testing.assert_allclose(rows[1:, 0] - rows[:-1, 1], 2 * LINE.clearance / closing[1:], rtol=0.01)
    assert np.all(rows[:, 5] >= 0.9 * PARTS)
    assert np.all(rows[:, 5] <= 1.6 * PARTS)
    assert line.tally["unresolved"][0] == 0
    assert line.tally["fewest_steps"][0] == rows[:, 5].min()
    assert line.tally["episodes"][0] == 3
    assert sent_back <= 3


def test_a_run_that_starts_closed_counts_no_contact() -> None:
    line = _Line()
    line.touch["penetration"] = 1e-6
    line.start(LINE.clearance + 1e-6, -0.1)
    assert bool(line.touch["started_closed"][0])
    assert line.onset[0] > 0.0
    line.accept(1e-4, LINE.clearance - 1e-6, -0.1)
    assert line.onset[0] == 0.0
    assert line.tally["contacts"][0] == 0


def test_settle_takes_the_speed_at_the_touch_not_at_the_step() -> None:
    push, gap, speed = -3e4, 1e-6, 0.5
    line = _Line(push).start(LINE.clearance - gap, speed)
    closing = math.sqrt(speed**2 + 2.0 * push * gap)
    h = 1.5 * (speed - closing) / -push
    line.accept(h, *line.flown(h))
    assert line.onset[0] == pytest.approx(closing, rel=1e-9)
    assert line.touch["onset_time"][0] == pytest.approx((speed - closing) / -push, rel=1e-9)
    contact = contact_of(line.joints, 0, line.surfaces, line.q, line.v)[0]
    assert abs(contact.rate - closing) > 1e-3
