"""Touchdown and separation of pins: the state of contact between steps.

The force law needs the closing speed at touchdown. The rate in the first penetrated
state differs from it by some 0.1 %. All engines follow one rule. They predict an event
from its value and derivatives in the last state (``time_to_event``) and end a step just
after it. The instant of the event is the root of the cubic through values and rates at
both ends of the step (``joint_crossing``, ``load_crossing``). An engine that can repeat
a step does so if the prediction was wrong. The in-house solver repeats the step until
it ends on the event. In this module ``records`` is the ``RecorderState`` of a run.
"""

import math
from typing import Any

import numpy as np

from presswear.physics.event_time import crossing, hermite
from presswear.physics.force_peak import peak_within
from presswear.physics.load_transitions import transition_at_start, transition_value
from presswear.physics.loads import LOAD, MODE
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

# Counts of one joint
COUNTERS = np.dtype(
    [
        ("contacts", np.int64),  # contacts that have ended
        ("contacts_before", np.int64),  # contacts that had ended before the cycle
        ("rows", np.int64),  # stored contacts
        ("full", np.bool_),  # no more contacts are stored
        ("unresolved", np.int64),  # contacts with too few steps
        ("fewest_steps", np.int64),  # fewest steps of any contact
        ("peak_force", np.float64),  # largest normal force of the run so far, N
        ("deepest", np.float64),  # largest penetration of the run so far, m
    ]
)

# A contact that has ended
STORED_CONTACT = np.dtype(
    [
        ("touchdown", np.float64),  # s
        ("separation", np.float64),  # s
        ("closing_speed", np.float64),  # rate of penetration at touchdown, m/s
        ("release_speed", np.float64),  # rate at separation, below zero, m/s
        ("peak_force", np.float64),  # N
        ("steps", np.float64),
    ]
)
# the same quantities as columns of a result
CONTACT_COLUMNS: tuple[str, ...] = STORED_CONTACT.names or ()

# Onset speed that marks a joint as open, without force, until its touchdown is located
HELD_OPEN = -1.0
# Least number of steps in a contact. A contact that is shorter than this number of
# shortest steps has fewer.
LEAST_STEPS = 20


@compiled
def is_reversed(last: Records, contact: Records) -> bool:
    """Return whether a pin has passed the centre of its bore since its last accepted state.

    It has if the two eccentricities point to opposite sides. The corner of a guide
    cannot, because it has one wall.
    """
    if contact.is_flat > 0.0:
        return False
    dot = last.eccentricity_x * contact.eccentricity_x
    return dot + last.eccentricity_y * contact.eccentricity_y < 0.0


@compiled
def seen_from_opposite(penetration: float, eccentricity: float) -> float:
    """Return the penetration of a pin into the wall opposite to its eccentricity, m.

    Along the line through the centre, the distances to the two walls differ by twice
    the eccentricity. The rate is that of the other wall with the opposite sign.
    """
    return penetration - 2.0 * eccentricity


@compiled
def joint_crossing(
    last: Records, contact: Records, is_closed: bool, h: float
) -> tuple[float, float, float, float]:
    """Return the fraction of a step after which a joint touches down or separates; 2 if never.

    Also return the penetration at the end of the step, m, and its rates at the start
    and at the event, m/s. For a separation all three have the opposite sign, so that
    they grow towards the event. They refer to one wall: the wall that the pin leaves at
    a separation, or meets at a touchdown. A pin that crosses the bore can be in contact
    at both ends of the step, with opposite walls, and open in between.
    """
    start = last.penetration
    end = contact.penetration
    start_rate = last.rate
    end_rate = contact.rate
    if is_reversed(last, contact):
        if is_closed:
            end = seen_from_opposite(end, contact.eccentricity)
            end_rate = -end_rate
        else:
            eccentricity = math.hypot(last.eccentricity_x, last.eccentricity_y)
            start = seen_from_opposite(start, eccentricity)
            start_rate = -start_rate
    if is_closed:
        start = -start
        end = -end
        start_rate = -start_rate
        end_rate = -end_rate
    s = crossing(min(start, 0.0), start_rate, end, end_rate, h)
    event_rate = hermite(start, start_rate, end, end_rate, h, s)[1]
    return s, end, start_rate, event_rate


@lazily_compiled((0.0, 0.0, 0.0), LOAD, MODE, np.int64(0), 1, 1, 1, 0, 0)
def load_crossing(
    load: Records,
    mode: Records,
    transition: int,
    q: Array,
    v: Array,
    a: Array,
    h: float,
    behind: float,
) -> tuple[float, float, float]:
    """Return the fraction of a step after which a load is past a transition; 2 if never.

    Also return the value of the transition at the end of the step, and its rate at the
    start. A load is past the transition if the value exceeds ``behind``.
    """
    value, rate = transition_value(load, mode, transition, q, v, a)
    start, start_rate, _, _ = transition_at_start(load, mode, transition, 0.0)
    if value == -math.inf:
        return 2.0, value, start_rate
    value -= behind
    s = crossing(min(start, 0.0) - behind, start_rate, value, rate, h)
    return s, value, start_rate


@compiled
def touch_down(
    records: Any, k: int, t: float, closing: float, started_closed: bool
) -> None:
    """Begin a contact."""
    # A joint counts as closed while its onset speed is not zero.
    records.onset[k] = max(closing, 1e-300)
    last = records.memory[k]
    last.touchdown_time = t
    last.started_closed = started_closed
    last.steps = 0
    last.peak_force = 0.0
    last.longest_step = math.inf


@compiled
def separate(records: Any, k: int, t: float, rate: float, needed: int) -> None:
    """End a contact and store it.

    A contact with fewer than ``needed`` steps counts as unresolved. A contact in which
    the run began is not complete: it is neither counted nor stored.
    """
    last = records.memory[k]
    counters = records.counters[k]
    last.separation_time = t
    if last.started_closed:
        return
    counters.contacts += 1
    counters.fewest_steps = min(counters.fewest_steps, last.steps)
    if last.steps < needed:
        counters.unresolved += 1
    if counters.rows < records.stored_contacts.shape[1] and not counters.full:
        row = records.stored_contacts[k, counters.rows]
        row.touchdown = last.touchdown_time
        row.separation = t
        row.closing_speed = records.onset[k]
        row.release_speed = rate
        row.peak_force = last.peak_force
        row.steps = last.steps
        counters.rows += 1


@inlined
def remember(
    last: Records, joint: Records, onset_speed: float, contact: Records, t: float
) -> None:
    """Store an accepted state for the next step; count the step and find its peak force.

    A state at the time of the last one replaces it and changes neither count nor peak.
    """
    h = t - last.time
    if h > 0.0:
        if onset_speed > 0.0:
            last.steps += 1
        last.step_peak = peak_within(joint, onset_speed, last, contact, h)
        last.earlier_penetration = last.penetration
    last.step = h
    last.time = t
    last.penetration = contact.penetration
    last.rate = contact.rate
    last.closing = contact.closing
    last.elastic = contact.elastic
    last.energy = contact.energy
    last.eccentricity_x = contact.eccentricity_x
    last.eccentricity_y = contact.eccentricity_y
    # Angular speeds at which the place of contact moves over the maps of the surfaces
    on_bearing = contact.turning - joint.map_turns * contact.bearing_spin
    on_pin = contact.turning - joint.map_turns * contact.pin_spin
    last.sweep = max(abs(on_bearing), abs(on_pin))


@compiled
def settle(records: Any, t: float, needed: int) -> int:
    """Update the state of contact of all joints after an accepted step.

    Stores the closing speed of each touchdown, and each contact that has ended. A
    contact with fewer than ``needed`` steps counts as unresolved. Returns the number of
    joints that have touched down or separated; their forces must be computed again.
    """
    joints = records.packed.joints
    onset = records.onset
    events = 0
    for k in range(joints.shape[0]):
        last = records.memory[k]
        contact = records.contacts[k]
        if joints[k].always_closed:
            if onset[k] == 0.0:
                touch_down(records, k, t, 1.0, True)
        elif onset[k] == 0.0 and contact.penetration > 0.0:
            h = t - last.time
            started_closed = last.penetration > 0.0 or h <= 0.0
            touchdown = t
            closing = contact.rate
            if not started_closed:
                s, _, _, closing = joint_crossing(last, contact, False, h)
                touchdown = last.time + s * h
            touch_down(records, k, touchdown, closing, started_closed)
            events += 1
        elif onset[k] > 0.0 and contact.penetration <= 0.0:
            h = t - last.time
            s = min(joint_crossing(last, contact, True, h)[0], 1.0)
            # After the separation no contact force changes the rate, so that the rate
            # at the end of the step is that at the separation.
            rate = -contact.rate if is_reversed(last, contact) else contact.rate
            separate(records, k, last.time + s * h, rate, needed)
            onset[k] = 0.0
            events += 1
        remember(last, joints[k], onset[k], contact, t)
    return events
