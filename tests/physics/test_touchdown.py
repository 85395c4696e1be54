"""Touchdowns between two states, steps that land behind them, contacts that are counted."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from two_bodies import JOINT, Pair, joint_load

from presswear.linkage.drives import Drive
from presswear.linkage.elements import GROUND, Attachment, Body
from presswear.linkage.laws import delivered_restitution
from presswear.linkage.surface import Surface
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.packed import pack
from presswear.physics.touchdown import (
    COUNTERS,
    LANDING,
    LEAST_STEPS,
    MEMORY,
    OVERSHOOT,
    STEPS,
    STORED_CONTACT,
    contact_step,
    crossing,
    hermite,
    next_step,
    peak_within,
    settle,
    shorter_step,
)
from presswear.tools.compile import Records

Array = NDArray[np.float64]

NO_CROSSING = 2.0
MASS = 0.1
PARTS = 50.0
FREE = 1e-4
LEAST = 1e-9

LINE = replace(JOINT, bearing=Attachment(GROUND, 0.0, 0.0), pin=Attachment("pin", 0.0, 0.0))
"""A pin that meets its bearing with the whole mass of its body."""


def _cubic(a: float, b: float, c: float, d: float, s: float) -> tuple[float, float]:
    """Value and slope of a + b s + c s^2 + d s^3."""
    return a + s * (b + s * (c + s * d)), b + s * (2.0 * c + s * 3.0 * d)


coefficients = st.floats(-10.0, 10.0)


@given(
    st.tuples(coefficients, coefficients, coefficients, coefficients),
    st.floats(1e-3, 10.0),
    st.floats(0.0, 1.0),
)
def test_hermite_reproduces_any_cubic(
    cubic: tuple[float, float, float, float], h: float, s: float
) -> None:
    (p0, slope0), (p1, slope1) = _cubic(*cubic, 0.0), _cubic(*cubic, 1.0)
    value, rate = hermite(p0, slope0 / h, p1, slope1 / h, h, s)
    exact, slope = _cubic(*cubic, s)
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
    # The two states are rounded numbers: some ulp of their size over the slope at the root.
    rounding = 32.0 * np.finfo(float).eps * (slope + 3.0 * bend) / slope
    assert crossing(p0, slope0 / h, p1, slope1 / h, h) == pytest.approx(root, abs=rounding)


@given(st.floats(0.05, 0.9), st.floats(0.02, 0.09), st.floats(-1.0, 3.0))
def test_crossing_finds_a_contact_that_ends_within_the_step(
    root: float, length: float, lean: float
) -> None:
    leaves = root + length

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
    ("p0", "r0", "p1", "r1", "found"),
    [
        (-1.0, 0.5, -0.5, 0.5, NO_CROSSING),  # still approaching
        (-1.0, -1.0, -2.0, -1.0, NO_CROSSING),  # leaving
        (-1.0, 1.0, -1.0, -1.0, NO_CROSSING),  # comes to 3/4 of the way and turns
        (-1.0, -1.0, -1.0, 1.0, NO_CROSSING),  # turns away from it
        (-1.0, 0.0, -1.0, 0.0, NO_CROSSING),
        (-1.0, 1.0, 1e-300, 1.0, 1.0),  # at the end of the step
        (0.0, 1.0, 1.0, 1.0, 0.0),  # at its start
        # (s - 0.1)(s - 0.5)(s - 0.7) closes at 0.1, opens at 0.5 and closes again at 0.7.
        (-0.035, 0.47, 0.135, 0.87, 0.1),
    ],
)
def test_crossing_is_the_first_or_none(
    p0: float, r0: float, p1: float, r1: float, found: float
) -> None:
    assert crossing(p0, r0, p1, r1, 1.0) == pytest.approx(found, rel=0.0, abs=1e-15)


def _meeting(stiffness: float, exponent: float = 1.5) -> Records:
    """A joint whose pin has a body of its own mass."""
    law = replace(LINE.normal, stiffness=stiffness, exponent=exponent)
    joint = Pair(replace(LINE, normal=law), np.zeros(3), np.zeros(3)).packed.joints[0]
    assert joint["effective_mass"] == MASS
    return joint


@given(
    st.floats(0.0, 1e-5), st.floats(1e-4, 5.0), st.sampled_from([-1.0, 1.0]), st.floats(1.0, 2.5)
)
def test_contact_step_divides_half_a_period_at_the_deepest_point(
    depth: float, speed: float, sign: float, exponent: float
) -> None:
    """It depends on the energy alone; 1.5 % longer than a Hertz impact, exact for a spring."""
    stiffness = 1e10
    energy = 0.5 * MASS * speed**2 + stiffness * depth ** (exponent + 1.0) / (exponent + 1.0)
    deepest = ((exponent + 1.0) * energy / stiffness) ** (1.0 / (exponent + 1.0))
    tangent = exponent * stiffness * deepest ** (exponent - 1.0)
    step = contact_step(_meeting(stiffness, exponent), depth, sign * speed, PARTS)
    assert step == pytest.approx(math.pi * math.sqrt(MASS / tangent) / PARTS, rel=1e-9)


def test_contact_step_without_energy_or_give_sets_no_limit() -> None:
    assert contact_step(_meeting(1e10), 0.0, 0.0, PARTS) == math.inf
    assert contact_step(_meeting(1e10), -1e-3, 0.0, PARTS) == math.inf
    # Two driven bodies meet with infinite mass; a step that is no number helps nobody.
    pair = Pair(JOINT, np.zeros(6), np.zeros(6)).linkage
    drives = tuple(Drive(body.name, 1.0) for body in pair.bodies)
    driven = pack(replace(pair, drives=drives)).joints[0]
    for rate in (0.0, 0.3):
        assert contact_step(driven, 1e-6, rate, PARTS) == math.inf


def test_the_mass_that_meets_is_that_of_two_free_bodies() -> None:
    pair = replace(
        Pair(JOINT, np.zeros(6), np.zeros(6)).linkage,
        bodies=(Body("bearing", 0.2, 3e-3), Body("pin", 0.1, 1e-3)),
    )
    bearing, pin = 1 / 0.2 + (0.17**2 + 0.03**2) / 3e-3, 1 / 0.1 + (0.11**2 + 0.05**2) / 1e-3
    assert pack(pair).joints[0]["effective_mass"] == pytest.approx(1 / (bearing + pin), rel=1e-14)
    held = replace(pair, drives=(Drive("bearing", 1.0),))
    assert pack(held).joints[0]["effective_mass"] == pytest.approx(1.0 / pin, rel=1e-14)


@dataclass
class _Line:
    """A pin on the x axis inside a bearing on the frame, pushed by a constant force."""

    push: float = 0.0
    q: Array = field(default_factory=lambda: np.zeros(3))
    v: Array = field(default_factory=lambda: np.zeros(3))
    time: float = 0.0

    def __post_init__(self) -> None:
        self.packed = Pair(LINE, self.q, self.v).packed
        self.onset = np.zeros(1)
        self.memory = np.zeros(1, MEMORY)
        self.counters = np.zeros(1, COUNTERS)
        self.counters["fewest_steps"] = np.iinfo(np.int64).max
        self.steps = np.zeros(1, STEPS)
        self.steps["free"], self.steps["per_contact"] = FREE, PARTS
        self.steps["sustained"], self.steps["least"] = 10.0, LEAST
        self.past = np.zeros((1, 20), STORED_CONTACT)
        self.contacts = np.zeros(1, CONTACT)
        self.settle()

    def start(self, x: float, speed: float) -> "_Line":
        """From a place and a speed, as after an accepted step."""
        self.q[0], self.v[0] = x, speed
        self.settle()
        return self

    def settle(self) -> None:
        note_contacts(self.packed, self.contacts, self.q, self.v)
        states = self.memory, self.counters, self.past, self.contacts
        settle(self.packed.joints, self.onset, *states, self.time)

    def acceleration(self, x: float, speed: float) -> float:
        q, v = np.array([x, 0.0, 0.0]), np.array([speed, 0.0, 0.0])
        return self.push + joint_load(self.packed, self.onset[0], q, v).x / MASS

    def wanted(self) -> float:
        """Next step from the settled state."""
        a = np.array([self.acceleration(self.q[0], self.v[0]), 0.0, 0.0])
        return next_step(self.packed, self.onset, self.memory, self.steps, self.contacts, a)

    def moved(self, h: float) -> tuple[float, float]:
        """Place and speed a step later (Runge-Kutta, exact in free flight)."""

        def rate(x: float, speed: float) -> tuple[float, float]:
            return speed, self.acceleration(x, speed)

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

    def shorter(self, h: float, x: float, speed: float) -> float:
        """Step with which a step that ended in a state has to be repeated; or -1."""
        q, v = np.array([x, 0.0, 0.0]), np.array([speed, 0.0, 0.0])
        states = self.memory, self.steps, np.zeros(1, CONTACT)
        return shorter_step(self.packed, self.onset, *states, h, q, v, v)

    def accept(self, h: float, x: float, speed: float) -> None:
        self.time += h
        self.start(x, speed)


@pytest.mark.parametrize("push", [-2000.0, 0.0, 2000.0])
@pytest.mark.parametrize("speed", [0.5, 3.0])
@pytest.mark.parametrize("gap", [1e-9, 1e-6, 2e-5])
def test_step_lands_just_behind_a_touchdown(gap: float, speed: float, push: float) -> None:
    line = _Line(push).start(LINE.clearance - gap, speed)
    h = line.wanted()
    x, after = line.flown(h)
    closing = math.sqrt(speed**2 + 2.0 * push * gap)
    part = contact_step(line.packed.joints[0], 0.0, closing, PARTS)
    landed = (x - LINE.clearance) / closing
    assert landed == pytest.approx(LANDING * part, rel=0.01)
    assert line.shorter(h, x, after) == -1.0


def test_free_flight_away_from_the_bearing_takes_the_longest_step() -> None:
    assert _Line().start(0.0, 0.0).wanted() == FREE
    assert _Line().start(0.5e-3, 1.0).wanted() == FREE
    assert _Line().start(LINE.clearance - 1e-6, -1.0).wanted() == FREE
    # Turned back before it arrives.
    assert _Line(-100.0).start(LINE.clearance - 1e-4, 0.1).wanted() == FREE
    # A large acceleration: twenty steps in the time in which it crosses the clearance from rest.
    flight = math.sqrt(2.0 * LINE.clearance / 1e6)
    assert _Line(-1e6).start(LINE.clearance - 1e-6, 1.0).wanted() == pytest.approx(flight / 20.0)
    # Departing, but pulled back within the step.
    pulled = _Line(1e5).start(LINE.clearance - 1e-7, -0.1)
    arrival = (0.1 + math.sqrt(0.01 + 2e5 * 1e-7)) / 1e5
    assert arrival < pulled.wanted() < 1.2 * arrival


def test_a_step_past_a_touchdown_is_sent_back_to_it() -> None:
    speed, gap, push = 1.0, 2e-5, 500.0
    line = _Line(push).start(LINE.clearance - gap, speed)
    touchdown = (math.sqrt(speed**2 + 2.0 * push * gap) - speed) / push
    shorter = line.shorter(FREE, *line.flown(FREE))
    part = contact_step(line.packed.joints[0], 0.0, speed + push * touchdown, PARTS)
    # Free flight is a parabola: the cubic is exact.
    assert shorter == pytest.approx(touchdown + LANDING * part, rel=1e-9)
    assert line.shorter(shorter, *line.flown(shorter)) == -1.0


def test_a_slight_overshoot_is_accepted_a_larger_one_is_not() -> None:
    speed, gap = 1.0, 2e-5
    line = _Line().start(LINE.clearance - gap, speed)
    part = contact_step(line.packed.joints[0], 0.0, speed, PARTS)
    for share, accepted in ((0.97 * OVERSHOOT, True), (1.03 * OVERSHOOT, False)):
        h = gap / speed + share * part
        assert (line.shorter(h, *line.flown(h)) < 0.0) == accepted


def test_a_step_over_a_whole_contact_is_sent_back_into_it() -> None:
    push, gap = -4e4, 1e-5
    # Rises to 1.25e-6 m beyond the bearing's surface and falls back within the step.
    speed = math.sqrt(2.0 * -push * 1.125 * gap)
    line = _Line(push).start(LINE.clearance - gap, speed)
    h = 2.0 * speed / -push
    x, after = line.flown(h)
    assert x < LINE.clearance
    shorter = line.shorter(h, x, after)
    touchdown = (speed - math.sqrt(speed**2 - 2.0 * -push * gap)) / -push
    assert touchdown < shorter < 1.1 * touchdown
    assert line.flown(shorter)[0] > LINE.clearance


@pytest.mark.parametrize(("push", "closing"), [(-1e4, 1e-2), (-1e4, 1e-4), (-100.0, 1e-6)])
def test_a_step_is_not_sent_back_to_the_same_place_again(push: float, closing: float) -> None:
    """A graze may be over before the landing behind its touchdown."""
    gap = 1e-5
    speed = math.sqrt(closing**2 - 2.0 * push * gap)
    line = _Line(push).start(LINE.clearance - gap, speed)
    first = 1.5 * speed / -push
    second = line.shorter(first, *line.flown(first))
    assert 0.0 < second < first
    third = line.shorter(second, *line.flown(second))
    assert third < 0.0 or third < 0.9 * second


def test_free_flight_and_a_contact_that_goes_on_are_left_alone() -> None:
    line = _Line().start(0.0, 1.0)
    assert line.shorter(FREE, *line.flown(FREE)) == -1.0
    line = _Line().start(LINE.clearance - 1e-6, 1.0)
    line.onset[0] = 1.0
    assert line.shorter(FREE, *line.flown(FREE)) == -1.0
    assert line.memory["longest_step"][0] == 0.0


def _leaving(h: float, taken: int) -> _Line:
    """A pin that leaves at constant speed and is open after half a step, so many steps on."""
    line = _Line().start(LINE.clearance + 0.5 * h * 0.1, -0.1)
    line.memory["steps"], line.memory["started_closed"] = taken, False
    line.memory["longest_step"] = math.inf
    return line


def test_a_contact_that_ends_after_a_few_steps_is_divided() -> None:
    h = 1e-5
    line = _leaving(h, 3)
    wanted = line.shorter(h, *line.flown(h))
    assert wanted == pytest.approx(0.5 * h / (LEAST_STEPS - 3 + 1), rel=1e-6)
    assert line.memory["longest_step"][0] == wanted


@pytest.mark.parametrize(("power", "is_found"), [(1.5, True), (12.0, False)])
def test_a_peak_on_a_foundation_is_not_extrapolated_far(power: float, is_found: bool) -> None:
    """Penetrations that rise and fall again within a step, under forces of a steep power."""
    worn = replace(LINE, pin_surface=Surface(np.full(90, 1e-6)), contact="foundation")
    joint = Pair(worn, np.zeros(3), np.zeros(3)).packed.joints[0]
    last, contact = np.zeros(1, MEMORY), np.zeros(1, CONTACT)
    for state, rate in ((last, 0.01), (contact, -0.01)):
        state["penetration"], state["rate"], state["closing"] = 1e-6, rate, rate
        state["elastic"], state["energy"] = 100.0, 100.0 * 1e-6 / (power + 1.0)
    peak = peak_within(joint, 1.0, last[0], contact[0], 1e-5)
    assert (peak > 0.0) == is_found
    assert peak < 105.0


def test_a_contact_of_enough_steps_may_end() -> None:
    h = 1e-5
    for taken, accepted in ((LEAST_STEPS - 1, False), (LEAST_STEPS, True), (60, True)):
        line = _leaving(h, taken)
        assert (line.shorter(h, *line.flown(h)) < 0.0) == accepted
    begun_inside = _leaving(h, 3)
    begun_inside.memory["started_closed"] = True
    assert begun_inside.shorter(h, *begun_inside.flown(h)) == -1.0
    # Nor is a step divided that is hardly longer than the shortest.
    line = _leaving(1.2 * LEAST, 3)
    assert line.shorter(1.2 * LEAST, *line.flown(1.2 * LEAST)) == -1.0


@pytest.mark.parametrize("speed", [0.05, 1.0])
def test_a_pin_that_bounces_is_counted_timed_and_loses_what_the_law_says(speed: float) -> None:
    line = _Line().start(0.0, speed)
    sent_back = 0
    h = line.wanted()
    while line.counters["contacts"][0] < 3:
        x, after = line.moved(h)
        shorter = line.shorter(h, x, after)
        if shorter > 0.0:
            assert shorter < h
            sent_back += 1
            h = shorter
            continue
        line.accept(h, x, after)
        h = line.wanted()
        assert h > 0.0
        assert line.time < 10.0 * LINE.clearance / speed * 3.0
    rows = line.past[0, :3]
    delivered = delivered_restitution(LINE.normal.damping)
    closing = speed * delivered ** np.arange(3)
    # RK4 with some 60 steps an impact; the landing is followed without force for 1/2500 of it.
    np.testing.assert_allclose(rows["closing_speed"], closing, rtol=1e-5)
    np.testing.assert_allclose(-rows["release_speed"], closing * delivered, rtol=1e-5)
    # The first touchdown ends a flight of one clearance at constant speed.
    assert rows["touchdown"][0] == pytest.approx(LINE.clearance / speed, rel=1e-6)
    flights = rows["touchdown"][1:] - rows["separation"][:-1]
    np.testing.assert_allclose(flights, 2 * LINE.clearance / closing[1:], rtol=0.01)
    assert np.all(rows["steps"] >= 0.9 * PARTS)
    assert np.all(rows["steps"] <= 1.6 * PARTS)
    assert line.counters["unresolved"][0] == 0
    assert line.counters["fewest_steps"][0] == rows["steps"].min()
    assert line.counters["rows"][0] == 3
    assert sent_back <= 3


def test_a_run_that_starts_closed_counts_no_contact() -> None:
    line = _Line()
    line.memory["penetration"] = 1e-6
    line.start(LINE.clearance + 1e-6, -0.1)
    assert bool(line.memory["started_closed"][0])
    assert line.onset[0] > 0.0
    line.accept(1e-4, LINE.clearance - 1e-6, -0.1)
    assert line.onset[0] == 0.0
    assert line.counters["contacts"][0] == 0


def test_settle_takes_the_speed_at_touchdown_not_at_the_step() -> None:
    push, gap, speed = -3e4, 1e-6, 0.5
    line = _Line(push).start(LINE.clearance - gap, speed)
    closing = math.sqrt(speed**2 + 2.0 * push * gap)
    touchdown = (speed - closing) / -push
    line.accept(1.5 * touchdown, *line.flown(1.5 * touchdown))
    assert line.onset[0] == pytest.approx(closing, rel=1e-9)
    assert line.memory["touchdown_time"][0] == pytest.approx(touchdown, rel=1e-9)
    assert abs(line.contacts["rate"][0] - closing) > 1e-3


@pytest.mark.parametrize("shift", [0.05, 0.35, 0.65, 0.95])
def test_peak_between_fifteen_steps_of_a_contact(shift: float) -> None:
    """A contact of half a sine; the greatest force of the law along it, by scipy."""
    line, depth, duration = _Line(), 1e-5, 1e-4
    line.packed.joints["normal"]["damping"] = chi = 0.5
    stiffness = LINE.normal.stiffness

    def motion(t: float) -> tuple[float, float]:
        phase = math.pi * t / duration
        return depth * math.sin(phase), depth * math.pi / duration * math.cos(phase)

    def force(t: float) -> float:
        penetration, rate = motion(t)
        return float(stiffness * penetration**1.5 * (1.0 + chi * rate / line.onset[0]))

    h = duration / 15.0
    accepted = found = 0.0
    for i in range(16):
        penetration, rate = motion((i - shift) * h)
        line.accept(h, LINE.clearance + penetration, rate)
        found = max(found, float(line.memory["step_peak"][0]))
        if penetration > 0.0:
            accepted = max(accepted, force((i - shift) * h))
    assert line.onset[0] > 0.0
    top = minimize_scalar(
        lambda part: -force(part * duration), bounds=(0.2, 0.7), options={"xatol": 1e-9}
    )
    assert found == pytest.approx(-float(top.fun), rel=1e-5)
    assert found > accepted * (1.0 - 1e-8)
    # Open at its end: no peak is left of the contact.
    line.accept(h, LINE.clearance - 1e-6, -1.0)
    assert line.memory["step_peak"][0] == 0.0


def test_a_contact_of_one_state_has_no_peak_between_steps() -> None:
    line = _Line().start(LINE.clearance - 1e-6, 0.5)
    for x, speed in ((1e-6, 0.4), (-1e-6, -0.4), (-2e-6, -0.4)):
        line.accept(4e-6, LINE.clearance + x, speed)
        assert line.memory["step_peak"][0] == 0.0
    assert line.counters["contacts"][0] == 1
