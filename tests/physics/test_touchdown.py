"""Touchdowns between two states, steps that end just after them, and steps of contacts."""

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from two_bodies import JOINT, Pair, contacts_in

from presswear.linkage.bodies import Body
from presswear.linkage.drives import Drive
from presswear.linkage.joints import Revolute
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.linkage.surface import Surface
from presswear.physics.contact import CONTACT, MEMORY
from presswear.physics.force_peak import peak_within
from presswear.physics.friction_and_normal import elastic_at, normal_force
from presswear.physics.packed import pack
from presswear.physics.step_length import (
    LANDING,
    OILED_DEPTH,
    STEPS,
    contact_step,
    next_step,
    shorter_step,
)
from presswear.physics.touchdown import (
    COUNTERS,
    LEAST_STEPS,
    STORED_CONTACT,
    settle,
)
from presswear.recording.recorder_state import RecorderState
from presswear.tools.arrays import Array

MASS = 0.1  # of the body with the pin, kg
STEPS_PER_CONTACT = 50.0
FREE_STEP = 1e-4  # s
LEAST_STEP = 1e-9  # s

# A pin at the mass centre: its bearing meets the whole mass of the body.
LINE = replace(
    JOINT, bearing=Attachment(GROUND, 0.0, 0.0), pin=Attachment("pin", 0.0, 0.0)
)


@given(
    st.floats(0.0, 1e-5),
    st.floats(1e-4, 5.0),
    st.sampled_from([-1.0, 1.0]),
    st.floats(1.0, 2.5),
)
def test_contact_step_divides_half_a_period_at_the_deepest_point(
    depth, speed, sign, exponent
):
    """The step depends on the energy alone.

    It is exact for a spring, and 1.5 % longer than that of an impact by Hertz's law.
    """
    stiffness = 1e10
    n = exponent + 1.0
    energy = 0.5 * MASS * speed**2 + stiffness * depth**n / n
    deepest = (n * energy / stiffness) ** (1.0 / n)
    tangent = exponent * stiffness * deepest ** (exponent - 1.0)
    half_period = math.pi * math.sqrt(MASS / tangent)
    law = replace(LINE.normal, stiffness=stiffness, exponent=exponent)
    joint = Pair(replace(LINE, normal=law), np.zeros(3), np.zeros(3)).packed.joints[0]
    assert joint["effective_mass"] == MASS
    step = contact_step(joint, depth, sign * speed, STEPS_PER_CONTACT)
    assert step == pytest.approx(half_period / STEPS_PER_CONTACT, rel=1e-9)


def test_effective_mass_has_the_coordinates_that_are_free():
    """A driven body cannot turn, and a prescribed body cannot move."""

    def mobility(linkage: Linkage) -> float:
        return float(1.0 / pack(linkage).joints[0]["effective_mass"])

    free = replace(
        Pair(JOINT, np.zeros(6), np.zeros(6)).linkage,
        bodies=(Body("bearing", 0.2, 3e-3), Body("pin", 0.1, 1e-3)),
    )
    bearing_turns = (
        0.17**2 + 0.03**2
    ) / 3e-3  # distance squared over the inertia, 1/kg
    pin = 1.0 / 0.1 + (0.11**2 + 0.05**2) / 1e-3
    assert mobility(free) == pytest.approx(1.0 / 0.2 + bearing_turns + pin, rel=1e-14)
    driven = replace(free, drives=(Drive("bearing", 1.0),))
    assert mobility(driven) == pytest.approx(1.0 / 0.2 + pin, rel=1e-14)
    pivot = Revolute(
        "pivot", Attachment(GROUND, 0.0, 0.0), Attachment("bearing", 0.0, 0.0)
    )
    prescribed = replace(driven, joints=(*driven.joints, pivot))
    assert mobility(prescribed) == pytest.approx(pin, rel=1e-14)


@dataclass
class _Line:
    """A pin on the x axis inside a bearing on the frame, with a constant acceleration."""

    push: float = 0.0  # acceleration, m/s^2
    q: Array = field(default_factory=lambda: np.zeros(3))
    v: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        pair = Pair(LINE, self.q, self.v)
        self.linkage = pair.linkage
        self.packed = pair.packed
        self.onset = np.zeros(1)
        self.memory = np.zeros(1, MEMORY)
        self.counters = np.zeros(1, COUNTERS)
        self.counters["fewest_steps"] = np.iinfo(np.int64).max
        self.steps = np.zeros(1, STEPS)
        self.steps["free"] = FREE_STEP
        self.steps["per_contact"] = STEPS_PER_CONTACT
        self.steps["sustained"] = 10.0
        self.steps["least"] = LEAST_STEP
        self.stored = np.zeros((1, 20), STORED_CONTACT)
        self.contacts = np.zeros(1, CONTACT)
        # A named tuple of the package, because stored kernels for a type that a test
        # defines could not be read in other modules
        used = {
            "packed": self.packed,
            "contacts": self.contacts,
            "onset": self.onset,
            "memory": self.memory,
            "counters": self.counters,
            "stored_contacts": self.stored,
        }
        unused: dict[str, Any] = dict.fromkeys(RecorderState._fields)
        self.records = RecorderState(**(unused | used))
        self.settle()

    def start(self, x: float, speed: float) -> "_Line":
        """Set position and speed as after an accepted step."""
        self.q[0] = x
        self.v[0] = speed
        self.settle()
        return self

    def settle(self) -> None:
        self.contacts[:] = contacts_in(self.linkage, self.packed, self.q, self.v)
        settle(self.records, 0.0, LEAST_STEPS)

    def next_step(self) -> float:
        """Next step from an open state."""
        return next_step(self.records, self.steps, np.array([self.push, 0.0, 0.0]))

    def free_flight(self, h: float) -> tuple[float, float]:
        """Position and speed a step later without contact."""
        x = self.q[0] + h * (self.v[0] + 0.5 * h * self.push)
        return x, self.v[0] + h * self.push

    def shorter_step(self, h: float, x: float, speed: float) -> float:
        """Step that replaces a trial step ``h`` that ended in a state, or -1."""
        q = np.array([x, 0.0, 0.0])
        v = np.array([speed, 0.0, 0.0])
        contacts = contacts_in(self.linkage, self.packed, q, v).view(CONTACT)
        return shorter_step(self.records, self.steps, contacts, h, q, v, v)


@pytest.mark.parametrize("push", [-2000.0, 0.0, 2000.0])
@pytest.mark.parametrize("speed", [0.5, 3.0])
@pytest.mark.parametrize("gap", [1e-9, 1e-6, 2e-5])
def test_step_ends_just_after_a_touchdown(gap, speed, push):
    line = _Line(push).start(LINE.clearance - gap, speed)
    h = line.next_step()
    x, end_speed = line.free_flight(h)
    closing = math.sqrt(speed**2 + 2.0 * push * gap)
    in_contact = contact_step(line.packed.joints[0], 0.0, closing, STEPS_PER_CONTACT)
    since_touchdown = (x - LINE.clearance) / closing
    assert since_touchdown == pytest.approx(LANDING * in_contact, rel=0.01)
    assert line.shorter_step(h, x, end_speed) == -1.0


def test_a_step_over_a_whole_contact_is_repeated_into_it():
    deceleration = 4e4
    gap = 1e-5
    # The pin goes 1.25e-6 m beyond the surface of the bearing and back within the step.
    speed = math.sqrt(2.0 * deceleration * 1.125 * gap)
    line = _Line(-deceleration).start(LINE.clearance - gap, speed)
    h = 2.0 * speed / deceleration
    x, end_speed = line.free_flight(h)
    assert x < LINE.clearance
    shorter = line.shorter_step(h, x, end_speed)
    closing = math.sqrt(speed**2 - 2.0 * deceleration * gap)
    touchdown = (speed - closing) / deceleration
    assert touchdown < shorter < 1.1 * touchdown
    assert line.free_flight(shorter)[0] > LINE.clearance


@pytest.mark.parametrize(
    ("push", "closing"), [(-1e4, 1e-2), (-1e4, 1e-4), (-100.0, 1e-6)]
)
def test_a_step_is_not_repeated_up_to_the_same_time_again(push, closing):
    """A slow contact may end before the time after its touchdown at which the step ends."""
    gap = 1e-5
    speed = math.sqrt(closing**2 - 2.0 * push * gap)
    line = _Line(push).start(LINE.clearance - gap, speed)
    first = 1.5 * speed / -push
    second = line.shorter_step(first, *line.free_flight(first))
    assert 0.0 < second < first
    third = line.shorter_step(second, *line.free_flight(second))
    assert third < 0.0 or third < 0.9 * second


@pytest.mark.parametrize(
    ("h", "steps", "started_closed", "accepted"),
    [
        (1e-5, 3, False, False),
        (1e-5, LEAST_STEPS - 1, False, False),
        (1e-5, LEAST_STEPS, False, True),
        (1e-5, 3, True, False),
        (1.2 * LEAST_STEP, 3, False, True),  # hardly longer than the shortest step
    ],
)
def test_a_contact_that_ends_after_a_few_steps_is_divided(
    h, steps, started_closed, accepted
):
    """A pin that leaves at constant speed and is open after half a step."""
    line = _Line().start(LINE.clearance + 0.5 * h * 0.1, -0.1)
    line.memory["steps"] = steps
    line.memory["started_closed"] = started_closed
    line.memory["longest_step"] = math.inf
    shorter = line.shorter_step(h, *line.free_flight(h))
    if accepted:
        assert shorter == -1.0
    else:
        assert shorter == pytest.approx(0.5 * h / (LEAST_STEPS - steps + 1), rel=1e-6)
        assert line.memory["longest_step"][0] == shorter


def test_step_of_an_oiled_joint_stays_short_where_its_force_is_zero():
    line = _Line().start(0.0, 0.0)
    line.packed.joints["always_closed"] = True
    line.steps["free"] = 1.0
    line.memory["penetration"] = 0.0
    without_force = line.next_step()
    line.memory["penetration"] = OILED_DEPTH * LINE.clearance
    assert line.next_step() == without_force
    assert without_force < 1e-3


@pytest.mark.parametrize("h", [1e-6, 1e-9, 1e-12])
def test_round_off_of_a_position_makes_no_peak(h):
    """The pin turns back within a step; far from the origin a position is off by 1e-13 m."""
    joint = _Line().packed.joints[0]
    last = np.zeros(1, MEMORY)
    contact = np.zeros(1, CONTACT)
    largest = 0.0
    for state, rate, error in ((last[0], 5e3 * h, 0.0), (contact[0], -5e3 * h, 1e-13)):
        depth = 1e-6 + error
        state["penetration"] = depth
        state["rate"] = rate
        state["closing"] = rate
        state["elastic"] = elastic_at(joint["normal"], depth)
        force = normal_force(joint["normal"], state["elastic"], depth, rate, 0.1)
        largest = max(largest, force)
    # Within the step it goes deeper by 1250 m/s^2 h^2, a thousandth at most.
    assert peak_within(joint, 0.1, last[0], contact[0], h) <= 1.003 * largest


@pytest.mark.parametrize(("power", "is_found"), [(1.5, True), (12.0, False)])
def test_a_peak_on_a_foundation_is_not_extrapolated_far(power, is_found):
    """Penetrations that rise and fall again within a step, under forces of a steep power."""
    worn = replace(LINE, pin_surface=Surface(np.full(90, 1e-6)), contact="foundation")
    joint = Pair(worn, np.zeros(3), np.zeros(3)).packed.joints[0]
    last = np.zeros(1, MEMORY)
    contact = np.zeros(1, CONTACT)
    for state, rate in ((last, 0.01), (contact, -0.01)):
        state["penetration"] = 1e-6
        state["rate"] = rate
        state["closing"] = rate
        state["elastic"] = 100.0
        state["energy"] = 100.0 * 1e-6 / (power + 1.0)
    peak = peak_within(joint, 1.0, last[0], contact[0], 1e-5)
    assert (peak > 0.0) == is_found
    assert peak < 105.0
