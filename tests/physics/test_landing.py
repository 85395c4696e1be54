"""A pin that flies and bounces on one line: landing behind touches, contacts counted."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from numpy.typing import NDArray
from two_bodies import JOINT, Pair, joint_load

from presswear.linkage.elements import GROUND, Attachment, ClearanceJoint
from presswear.linkage.laws import delivered_restitution
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.touchdown import (
    LANDING,
    OVERSHOOT,
    STEPS,
    TALLY,
    TOUCH,
    contact_step,
    next_step,
    settle,
    shorter_step,
)
from presswear.tools.compiled import Records

Array = NDArray[np.float64]

MASS = 0.1
PARTS = 50.0
FREE = 1e-4

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
        self.packed = pair.packed
        self.joints: Records = self.packed.joints
        self.onset = np.zeros(1)
        self.touch = np.zeros(1, TOUCH)
        self.tally = np.zeros(1, TALLY)
        self.tally["fewest_steps"] = np.iinfo(np.int64).max
        self.steps = np.zeros(1, STEPS)
        self.steps["free"], self.steps["per_contact"] = FREE, PARTS
        self.steps["sustained"], self.steps["least"] = 10.0, 1e-9
        self.episodes = np.zeros((1, 20, 6))
        self.contacts = np.zeros(1, CONTACT)
        self.settle()

    def start(self, x: float, speed: float) -> "_Line":
        """From a place and a speed, as after an accepted step."""
        self.q[0], self.v[0] = x, speed
        self.settle()
        return self

    def settle(self) -> None:
        note_contacts(self.packed, self.contacts, self.q, self.v)
        settle(
            self.joints,
            self.onset,
            self.touch,
            self.tally,
            self.episodes,
            self.contacts,
            self.time,
        )

    def acceleration(self, x: float, speed: float, onset: float) -> float:
        q, v = np.array([x, 0.0, 0.0]), np.array([speed, 0.0, 0.0])
        load = joint_load(self.packed, onset, q, v)
        return self.push + load.x / MASS

    def wanted(self) -> float:
        """Next step from the settled state."""
        now = self.acceleration(self.q[0], self.v[0], self.onset[0])
        a = np.array([now, 0.0, 0.0])
        return next_step(
            self.packed,
            self.onset,
            self.touch,
            self.steps,
            self.contacts,
            a,
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
        """What ``shorter_step`` says to a trial state."""
        q, v = np.array([x, 0.0, 0.0]), np.array([speed, 0.0, 0.0])
        return shorter_step(
            self.packed,
            self.onset,
            self.touch,
            self.steps,
            np.zeros(1, CONTACT),
            self.time + h,
            q,
            v,
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
    part = contact_step(line.joints[0], 0.0, closing, PARTS)
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
    part = contact_step(line.joints[0], 0.0, closing, PARTS)
    # Free flight is a parabola: the cubic is exact.
    assert shorter == pytest.approx(touch + LANDING * part, rel=1e-9)
    assert line.late(shorter, *line.flown(shorter)) == -1.0


def test_a_slight_overshoot_is_accepted_a_larger_one_is_not() -> None:
    speed, gap = 1.0, 2e-5
    line = _Line().start(LINE.clearance - gap, speed)
    part = contact_step(line.joints[0], 0.0, speed, PARTS)
    for share, accepted in ((0.97 * OVERSHOOT, True), (1.03 * OVERSHOOT, False)):
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
    np.testing.assert_allclose(
        rows[1:, 0] - rows[:-1, 1], 2 * LINE.clearance / closing[1:], rtol=0.01
    )
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
    assert abs(line.contacts["rate"][0] - closing) > 1e-3
