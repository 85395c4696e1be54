"""Length of steps: towards a touchdown, in contact, and over worn surfaces.

In contact a step is a fixed fraction of the expected duration of the contact. An engine
of fixed order predicts the next touchdown and repeats a step that missed it; see
``touchdown.py``. In this module ``records`` is the ``RecorderState`` of a run.
"""

import math
from typing import Any

import numpy as np

from presswear.physics.contact import acceleration_in_gap
from presswear.physics.event_time import step_to_event, time_across, time_to_event
from presswear.physics.load_transitions import count_transitions, transition_of
from presswear.physics.touchdown import LEAST_STEPS, joint_crossing, load_crossing
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

# Time between a predicted touchdown and the end of the step, in steps of the contact
LANDING = 0.02
# Number of steps in which an open pin close to a worn surface crosses a bin of its map
FLIGHT_STEPS_PER_BIN = 4.0
# Least number of steps in which a pin would cross the clearance from rest
STEPS_PER_FLIGHT = 20.0
# Fewest steps of an error-controlled method in a free impact of a corner, whose force is
# proportional to the penetration, over those of a pin. At a tolerance of 1e-7, 10 give
# the peaks and the motion as exactly as 15.
CORNER_STEPS = 2.0 / 3.0
# Least number of steps of an error-controlled method in which a pin crosses a bin
SKIM_STEPS = 2.0
# Distance that the pin moves after a separation until the step ends, over the clearance
BORE_FRACTION = 0.5
# Largest time between a touchdown and the end of the step, in steps of the contact; a
# longer trial step is repeated
OVERSHOOT = 0.2
# Value of a switching function of a load up to which a trial step is accepted, SI units
EVENT_TOL = 1e-9
# Least penetration over clearance for which the step of an oiled joint is computed
OILED_DEPTH = 0.05
# Time between a change of a load's law and the end of the step, in shortest steps
EVENT_MARGIN = 2.0


@inlined
def bin_time(joint: Records, last: Records) -> float:
    """Return the time in which a pin crosses a bin of a worn surface, s; infinite far from it."""
    is_near = last.penetration > -joint.relief
    if joint.surface_bins > 0 and last.sweep > 0.0 and is_near:
        return 2.0 * math.pi / joint.surface_bins / last.sweep
    return math.inf


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
    last: Records, steps: Records, impact_step: float, acceleration: float
) -> float:
    """Return the next step, s, while a joint is closed.

    A free impact is divided into equal steps, ``impact_step``. The steps of a pin at
    rest grow until half a period has ``sustained`` steps, as long as their error is at
    most that of the steps of an impact, relative to the penetration. The error of the
    trapezoidal rule is h^2 / 12 times the change of the acceleration.
    """
    parts = steps.per_contact
    if last.steps <= 1:
        # If the other forces pull the pin back, the contact may be far shorter than a
        # free impact.
        if last.rate > 0.0 and acceleration < 0.0:
            last.longest_step = min(
                last.longest_step, 2.0 * last.rate / -acceleration / parts
            )
    elif last.steps > parts:
        last.longest_step *= 1.2
        error = last.step * last.step / 12.0 * abs(acceleration - last.acceleration)
        allowed = last.penetration * (math.pi / parts) ** 3 / 12.0
        growth = 0.9 * (allowed / error) ** (1.0 / 3.0) if error > 0.0 else 1.3
        grown = last.step * min(max(growth, 0.5), 1.3)
        largest = impact_step * max(parts / steps.sustained, 1.0)
        impact_step = min(max(grown, impact_step), largest)
    return min(impact_step, last.longest_step)


@compiled
def late_touchdown(
    joint: Records, last: Records, steps: Records, contact: Records, h: float
) -> float:
    """Return the step, s, that ends just after a touchdown which the trial step has missed.

    Infinite if the trial step is accepted. If the force jumps at touchdown, a short
    step of its own passes the touchdown.
    """
    s, _, _, closing = joint_crossing(last, contact, False, h)
    if s > 1.0:
        return math.inf
    impact_step = contact_step(joint, 0.0, closing, steps.per_contact)
    behind = min(LANDING * impact_step, 0.1 * h)
    if joint.normal.abrupt:
        near = LANDING * impact_step
        if h <= 4.0 * near:
            return math.inf
        return max(s * h - near if s * h > 2.0 * near else s * h + near, steps.least)
    if contact.penetration > 0.0:
        if (1.0 - s) * h <= OVERSHOOT * impact_step:
            return math.inf
    elif contact.rate < 0.0:
        # The contact has ended within the trial step. The new step ends long before
        # the deepest point of the pin.
        behind = min(behind, 0.1 * (1.0 - s) * h * closing / (closing - contact.rate))
    return max(s * h + behind, steps.least)


@compiled
def early_separation(
    last: Records, steps: Records, contact: Records, clearance: float, h: float
) -> float:
    """Return the step, s, that gives a contact enough steps if the trial step has ended it.

    Infinite if the trial step is accepted. The contact of a pin with a bump can be
    shorter than expected from the state at its touchdown. The shorter step is the
    longest one for the rest of the contact.
    """
    missing = LEAST_STEPS - last.steps
    s, value, _, leaving = joint_crossing(last, contact, True, h)
    if contact.penetration > 0.0 and value > 0.0:
        # The pin has crossed the bore and is closed on the other side: end the step inside
        # the bore.
        return max(min(s, 1.0) * h + BORE_FRACTION * clearance / leaving, steps.least)
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
    """Return the step, s, that replaces a trial step of length ``h``; -1 if it is accepted.

    ``contacts`` are those of the trial state.
    """
    packed = records.packed
    least = steps[0].least
    shortest = math.inf
    for k in range(contacts.shape[0] if h > least else 0):
        last = records.memory[k]
        contact = contacts[k]
        if packed.joints[k].always_closed:
            continue
        if records.onset[k] > 0.0:
            wanted = early_separation(
                last, steps[0], contact, packed.joints[k].clearance, h
            )
        else:
            wanted = late_touchdown(packed.joints[k], last, steps[0], contact, h)
        shortest = min(shortest, wanted)
    for k in range(count_transitions(packed.loads)):
        i, transition = transition_of(k)
        load = packed.loads.records[i]
        mode = packed.loads.modes[i]
        s = load_crossing(load, mode, transition, q, v, a, h, EVENT_TOL)[0]
        if s <= 1.0 and (1.0 - s) * h > 2.0 * EVENT_MARGIN * least:
            shortest = min(shortest, s * h + EVENT_MARGIN * least)
    return shortest if shortest < math.inf else -1.0


@inlined
def is_linear_corner(joint: Records) -> bool:
    """Return whether a joint is a corner with a force proportional to the penetration."""
    return bool(joint.is_flat and joint.normal.estimated_exponent == 1.0)


@compiled
def longest_step(records: Any, longest: float, parts: float) -> float:
    """Return the longest step, s, of an error-controlled method in contact and on worn surfaces.

    A free impact has at least ``parts`` steps. A shorter contact limits the step by its
    ``longest_step``. On a worn surface the step is limited by the time to cross a bin,
    because the estimate of the error only contains a bump if a stage falls on it.
    """
    for k in range(records.memory.shape[0]):
        joint = records.packed.joints[k]
        last = records.memory[k]
        if joint.always_closed:
            continue
        needed = CORNER_STEPS * parts if is_linear_corner(joint) else parts
        if records.onset[k] > 0.0 and last.steps < 2.0 * needed:
            impact_step = contact_step(joint, 0.0, records.onset[k], needed)
            longest = min(longest, impact_step, last.longest_step)
        longest = min(longest, bin_time(joint, last) / SKIM_STEPS)
    return longest


@compiled
def next_step(records: Any, steps: Records, a: Array) -> float:
    """Return the next step, s, after the state of contact has been settled."""
    chosen = steps[0].free
    for k in range(records.memory.shape[0]):
        joint = records.packed.joints[k]
        last = records.memory[k]
        if joint.always_closed:
            # A force that passes through zero can grow again within the step.
            depth = max(last.penetration, OILED_DEPTH * joint.clearance)
            wanted = contact_step(joint, depth, 0.0, steps[0].sustained)
        else:
            surfaces = records.packed.surfaces[k]
            contact = records.contacts[k]
            acceleration = acceleration_in_gap(joint, surfaces, contact, a)
            if records.onset[k] > 0.0:
                wanted = step_while_closed(joint, last, steps, acceleration)
            else:
                longest = chosen
                wanted = step_while_open(
                    joint, last, contact, steps, acceleration, longest
                )
        chosen = min(chosen, max(wanted, steps[0].least))
    return chosen


@compiled
def step_while_closed(
    joint: Records, last: Records, steps: Records, acceleration: float
) -> float:
    """Return the next step, s, of a closed joint."""
    depth = last.penetration
    rate = last.rate
    parts = steps[0].per_contact
    # A bump of the profile acts like an impact and has as many steps.
    wanted = bin_time(joint, last) / (0.5 * parts)
    impact_step = contact_step(joint, depth, rate, parts)
    contact_limit = step_in_contact(last, steps[0], impact_step, acceleration)
    wanted = min(wanted, contact_limit)
    last.acceleration = acceleration
    # After a separation a step ends inside the bore, before the pin is closed on the
    # opposite side.
    departure, leaving, _ = time_to_event(-depth, -rate, -acceleration, 0.0)
    if departure < math.inf:
        flight = BORE_FRACTION * joint.clearance / leaving
        wanted = min(wanted, departure + flight)
    return wanted


@compiled
def step_while_open(
    joint: Records,
    last: Records,
    contact: Records,
    steps: Records,
    acceleration: float,
    longest: float,
) -> float:
    """Return the next step, s, of an open joint; ``longest`` limits the search of a touchdown.

    Limits are a fraction of the time in which the pin would cross the clearance from
    rest, and the time of the next touchdown.
    """
    parts = steps[0].per_contact
    wanted = bin_time(joint, last) / FLIGHT_STEPS_PER_BIN
    if acceleration != 0.0:
        flight = math.sqrt(2.0 * joint.clearance / abs(acceleration))
        wanted = min(wanted, flight / STEPS_PER_FLIGHT)
    arrival, closing, uncertainty = time_to_event(
        last.penetration, last.rate, acceleration, 0.0
    )
    if not joint.is_flat:
        across, speed_across = time_across(contact, joint.clearance)
        if across < arrival:
            arrival = across
            closing = speed_across
    if arrival < min(longest, max(wanted, steps[0].least)):
        margin = LANDING * contact_step(joint, 0.0, closing, parts)
        margin = min(margin, steps[0].free)
        landing = step_to_event(arrival, uncertainty, True, margin, joint.normal.abrupt)
        wanted = min(wanted, landing)
    return wanted
