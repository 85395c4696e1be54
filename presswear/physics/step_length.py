"""Length of steps: towards a touchdown, in contact, and over worn surfaces.

In contact a step is a set part of the expected duration of the contact. An engine of
fixed order predicts the next touchdown and repeats a step that missed it; see
``touchdown.py``. In this module ``records`` is the ``RecorderState`` of a run.
"""

import math
from typing import Any

import numpy as np

from presswear.physics.contact import (
    corner_acceleration,
    penetration_acceleration,
)
from presswear.physics.loads import count_transitions
from presswear.physics.touchdown import (
    LEAST_STEPS,
    joint_crossing,
    load_crossing,
    step_to_event,
    time_across,
    time_to_event,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined

# Step lengths of a fixed-order integrator
STEPS = np.dtype(
    [
        ("free", np.float64),  # longest step in free flight, s
        ("per_contact", np.float64),  # steps in one free impact
        # steps in half a period of a pin at rest on its bearing
        ("sustained", np.float64),
        ("least", np.float64),  # shortest step, s
    ]
)

LANDING = 0.02  # a step towards a touchdown ends this part of a contact step behind it
# in which a pin that skims a worn surface crosses one bin of its map
FLIGHT_STEPS_PER_BIN = 4.0
STEPS_PER_FLIGHT = 20.0  # at least, in which a pin would cross the clearance from rest
# Fewest steps of an error-controlled method in a free impact of a corner, whose force is
# proportional to the penetration, over those of a pin. At a tolerance of 1e-7, 10 give
# the peaks and the motion as exactly as 15.
CORNER_STEPS = 2.0 / 3.0
# of an error-controlled method, at least, in which a pin crosses one bin
SKIM_STEPS = 2.0
# a step that ends behind a separation goes on for this part of the clearance
BORE_PART = 0.5
OVERSHOOT = 0.2  # a step that ends more than this part of a contact step late is redone
# what passes a change of a load's law no further is not sent back; SI units
EVENT_TOL = 1e-9
# penetration over the clearance for which the steps of an oiled joint are short enough
OILED_DEPTH = 0.05
EVENT_MARGIN = 2.0  # a step ends so many shortest steps behind a change of a load's law


@compiled
def contact_step(
    joint: Records, penetration: float, rate: float, parts: float
) -> float:
    """Return the step, s, that divides a contact into equal parts.

    The duration is half a period of the oscillation at the deepest penetration
    that the present energy allows: pi sqrt(8/15) = 2.29 delta_max / v at the touchdown
    of an elastic Hertz impact, which lasts 2.94 delta_max / v.
    """
    mass = joint.effective_mass
    depth = max(penetration, 0.0)
    if math.isinf(mass):
        return math.inf
    stiffness = joint.normal.estimated_stiffness
    exponent = joint.normal.estimated_exponent
    if exponent == 1.0:
        # The same at any speed.
        is_moving = depth > 0.0 or rate != 0.0
        return math.pi * math.sqrt(mass / stiffness) / parts if is_moving else math.inf
    energy = 0.5 * mass * rate * rate + stiffness * depth ** (exponent + 1.0) / (
        exponent + 1.0
    )
    reach = ((exponent + 1.0) * energy / stiffness) ** (1.0 / (exponent + 1.0))
    if reach <= 0.0:
        return math.inf
    tangent = exponent * stiffness * reach ** (exponent - 1.0)
    return math.pi * math.sqrt(mass / tangent) / parts


@compiled
def step_in_contact(
    last: Records, steps: Records, part: float, acceleration: float
) -> float:
    """Return the next step, s, while a joint is closed.

    A free impact is divided into equal parts. The steps of a pin at rest grow up to
    ``sustained`` parts, while their error, h^2 / 12 times the change of acceleration
    for the trapezoidal rule, is the part of the penetration that the equal parts of a
    free impact would make.
    """
    parts = steps.per_contact
    if last.steps <= 1:
        # A contact that the surrounding motion pulls open again may be far shorter
        # than a free impact.
        if last.rate > 0.0 and acceleration < 0.0:
            last.longest_step = min(
                last.longest_step, 2.0 * last.rate / -acceleration / parts
            )
    elif last.steps > parts:
        last.longest_step *= 1.2
        error = last.step * last.step / 12.0 * abs(acceleration - last.acceleration)
        allowed = last.penetration * (math.pi / parts) ** 3 / 12.0
        growth = 0.9 * (allowed / error) ** (1.0 / 3.0) if error > 0.0 else 1.3
        calm = last.step * min(max(growth, 0.5), 1.3)
        part = min(max(calm, part), part * max(parts / steps.sustained, 1.0))
    return min(part, last.longest_step)


@compiled
def late_touchdown(
    joint: Records, last: Records, steps: Records, contact: Records, h: float
) -> float:
    """Return the step, s, that ends just after a touchdown that was overshot; or infinity.

    Where the law begins with a jump, the touchdown is put into a short step of its own.
    """
    s, _, _, closing = joint_crossing(last, contact, False, h)
    if s > 1.0:
        return math.inf
    part = contact_step(joint, 0.0, closing, steps.per_contact)
    behind = min(LANDING * part, 0.1 * h)
    if joint.normal.abrupt:
        near = LANDING * part
        if h <= 4.0 * near:
            return math.inf
        return max(s * h - near if s * h > 2.0 * near else s * h + near, steps.least)
    if contact.penetration > 0.0:
        if (1.0 - s) * h <= OVERSHOOT * part:
            return math.inf
    elif contact.rate < 0.0:
        # Touched and gone: land while the pin is still in, well before its deepest
        # point.
        behind = min(behind, 0.1 * (1.0 - s) * h * closing / (closing - contact.rate))
    return max(s * h + behind, steps.least)


@compiled
def early_separation(
    last: Records, steps: Records, contact: Records, clearance: float, h: float
) -> float:
    """Return the step, s, that divides a contact which the trial state has ended; or infinity.

    A pin that skims a bump can leave sooner than the state at its touchdown let expect.
    The shorter step holds for the rest of the contact.
    """
    missing = LEAST_STEPS - last.steps
    s, value, _, leaving = joint_crossing(last, contact, True, h)
    if contact.penetration > 0.0 and value > 0.0:
        # Through the bore and closed on the other side: the step ends inside the bore.
        return max(min(s, 1.0) * h + BORE_PART * clearance / leaving, steps.least)
    if contact.penetration > 0.0 or missing <= 0:
        return math.inf
    wanted = max(min(s, 1.0) * h / (missing + 1), steps.least)
    if wanted > 0.7 * h:
        return math.inf
    last.longest_step = wanted
    return wanted


@compiled
def shorter_step(
    records: Any,
    steps: Records,
    contacts: Records,
    h: float,
    q: Array,
    v: Array,
    a: Array,
) -> float:
    """Return the step, s, with which a trial step of length ``h`` has to be repeated; -1 if none.

    ``contacts`` are those of the trial state.
    """
    packed = records.packed
    least = steps[0].least
    shortest = math.inf
    for k in range(contacts.shape[0] if h > least else 0):
        last = records.memory[k]
        contact = contacts[k]
        if packed.joints[k].oiled:
            continue
        if records.onset[k] > 0.0:
            wanted = early_separation(
                last, steps[0], contact, packed.joints[k].clearance, h
            )
        else:
            wanted = late_touchdown(packed.joints[k], last, steps[0], contact, h)
        shortest = min(shortest, wanted)
    for k in range(count_transitions(packed.loads)):
        s = load_crossing(packed.loads, k, q, v, a, h, EVENT_TOL)[0]
        if s <= 1.0 and (1.0 - s) * h > 2.0 * EVENT_MARGIN * least:
            shortest = min(shortest, s * h + EVENT_MARGIN * least)
    return shortest if shortest < math.inf else -1.0


@inlined
def is_linear_corner(joint: Records) -> bool:
    """Return whether a joint is a corner with a force proportional to the penetration."""
    return bool(joint.is_flat and joint.normal.estimated_exponent == 1.0)


@compiled
def longest_step(records: Any, longest: float, parts: float) -> float:
    """Limit the step, s, of an error-controlled method by contacts just begun and worn surfaces.

    A free impact gets at least ``parts`` steps. A contact that the surrounding motion
    pulls open again may be far shorter; its ``longest_step`` tells how short. The error
    estimate sees a bump that a pin runs over only where a stage happens to fall on it.
    """
    for k in range(records.memory.shape[0]):
        joint = records.packed.joints[k]
        last = records.memory[k]
        if joint.oiled:
            continue
        needed = CORNER_STEPS * parts if is_linear_corner(joint) else parts
        if records.onset[k] > 0.0 and last.steps < 2.0 * needed:
            part = contact_step(joint, 0.0, records.onset[k], needed)
            longest = min(longest, part, last.longest_step)
        if (
            joint.surface_bins > 0
            and last.sweep > 0.0
            and last.penetration > -joint.relief
        ):
            bins = 2.0 * math.pi / joint.surface_bins / last.sweep
            longest = min(longest, bins / SKIM_STEPS)
    return longest


@compiled
def next_step(records: Any, steps: Records, a: Array) -> float:
    """Return the length of the next step, s, from the state just settled."""
    packed = records.packed
    free = steps[0].free
    parts = steps[0].per_contact
    chosen = free
    for k in range(records.memory.shape[0]):
        joint = packed.joints[k]
        last = records.memory[k]
        is_closed = records.onset[k] > 0.0
        depth = last.penetration
        rate = last.rate
        if joint.oiled:
            # A force that passes through zero comes back within the step.
            depth = max(depth, OILED_DEPTH * joint.clearance)
            wanted = contact_step(joint, depth, 0.0, steps[0].sustained)
            chosen = min(chosen, max(wanted, steps[0].least))
            continue
        if joint.is_flat:
            acceleration = corner_acceleration(joint, records.contacts[k], a)
        else:
            acceleration = penetration_acceleration(
                joint, packed.surfaces[k], records.contacts[k], a
            )
        wanted = math.inf
        if joint.surface_bins > 0 and last.sweep > 0.0 and depth > -joint.relief:
            # A bump of the profile is a contact of its own and gets as many steps.
            bins = 2.0 * math.pi / joint.surface_bins / last.sweep
            wanted = bins / (0.5 * parts if is_closed else FLIGHT_STEPS_PER_BIN)
        if is_closed:
            part = contact_step(joint, depth, rate, parts)
            wanted = min(wanted, step_in_contact(last, steps[0], part, acceleration))
            last.acceleration = acceleration
            # A pin that leaves is seen inside its bore before it is closed on the other
            # side.
            departure, leaving, _ = time_to_event(-depth, -rate, -acceleration, 0.0)
            if departure < math.inf:
                wanted = min(wanted, departure + BORE_PART * joint.clearance / leaving)
        else:
            # Part of the time in which the present acceleration crosses the clearance,
            # and the time at which the present motion closes the gap.
            if acceleration != 0.0:
                flight = math.sqrt(2.0 * joint.clearance / abs(acceleration))
                wanted = min(wanted, flight / STEPS_PER_FLIGHT)
            arrival, closing, uncertainty = time_to_event(
                depth, rate, acceleration, 0.0
            )
            if not joint.is_flat:
                across, speed_across = time_across(records.contacts[k], joint.clearance)
                if across < arrival:
                    arrival = across
                    closing = speed_across
            if arrival < min(chosen, max(wanted, steps[0].least)):
                behind = min(LANDING * contact_step(joint, 0.0, closing, parts), free)
                landing = step_to_event(
                    arrival, uncertainty, True, behind, joint.normal.abrupt
                )
                wanted = min(wanted, landing)
        chosen = min(chosen, max(wanted, steps[0].least))
    return chosen
