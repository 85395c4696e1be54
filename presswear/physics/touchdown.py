"""Touchdown and separation of pins: the state of contact between steps.

The force law needs the closing speed at touchdown. Taken from the first penetrated
state it is wrong by parts in a thousand. One rule holds in all engines: an event is
predicted from value and derivatives in the last state (``time_to_event``), a step ends
just behind it, and its moment is the root of the cubic through values and rates at both
ends of the step (``joint_crossing``, ``load_crossing``). An engine that can repeat a
step does so where the prediction was missed; the in-house solver repeats until the step
ends on the event. In this module ``records`` is the ``RecorderState`` of a run.
"""

import math
from typing import Any

import numpy as np

from presswear.physics.friction_and_normal import (
    elastic_at,
    normal_force,
)
from presswear.physics.loads import Loads, transition_at_start, transition_value
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, floats, inlined

# Memory of a joint between accepted steps: its last state and its present contact
MEMORY = np.dtype(
    [
        ("time", np.float64),  # of the last accepted state, s
        ("step", np.float64),  # that led to it, s
        ("penetration", np.float64),
        ("earlier_penetration", np.float64),  # of the state before the last, m
        ("rate", np.float64),
        ("acceleration", np.float64),  # of the penetration, m/s^2
        ("closing", np.float64),  # rate that damps the elastic force, m/s
        ("elastic", np.float64),  # force, N
        ("energy", np.float64),  # elastic, J
        # normal force at a maximum within the last step, N; else 0
        ("step_peak", np.float64),
        # speed at which the contact runs over the wear maps, rad/s
        ("sweep", np.float64),
        *floats("eccentricity_x", "eccentricity_y"),  # of the last accepted state, m
        ("touchdown_time", np.float64),  # of the present contact, s
        ("separation_time", np.float64),  # of the contact before, s
        ("started_closed", np.bool_),  # the run began inside the present contact
        ("steps", np.int64),  # accepted in the present contact
        ("longest_step", np.float64),  # allowed by the expected duration of the contact
        ("peak_force", np.float64),  # of the present contact, N
    ]
)

# Counts of one joint
COUNTERS = np.dtype(
    [
        ("contacts", np.int64),  # that have ended
        ("contacts_before", np.int64),  # ... before the present cycle
        ("rows", np.int64),  # of them kept
        ("full", np.bool_),  # no further ones are kept
        ("unresolved", np.int64),  # of too few steps
        ("fewest_steps", np.int64),
        ("peak_force", np.float64),  # of the run so far, N
        ("deepest", np.float64),  # penetration of the run so far, m
    ]
)

# A contact that has ended
STORED_CONTACT = np.dtype(
    [
        ("touchdown", np.float64),  # s
        ("separation", np.float64),  # s
        ("closing_speed", np.float64),  # rate of penetration at touchdown, m/s
        ("release_speed", np.float64),  # and at separation, below zero
        ("peak_force", np.float64),  # N
        ("steps", np.float64),
    ]
)
# where they are stored as columns
CONTACT_COLUMNS: tuple[str, ...] = STORED_CONTACT.names or ()

# Closing speed of a joint that bears no force until its touchdown is located
HELD_OPEN = -1.0
POSITION_NOISE = 1e-14  # round-off of a penetration, some times over, m
FORCE_SLOPE = 1e-3  # part of a step over which the slope of the force is taken
# that locate a maximum of the force to 2e-4 of a step: 1e-8 of the force
PEAK_HALVINGS = 12
# of a peak and the larger force at the ends of its step; 1.02 was found
MAX_PEAK_RATIO = 1.05
# steps that every contact gets, unless it is shorter than so many shortest steps
LEAST_STEPS = 20


@compiled
def hermite(
    p0: float, r0: float, p1: float, r1: float, h: float, s: float
) -> tuple[float, float]:
    """Return the value and time derivative at s in 0 .. 1 of the cubic through two states."""
    a = r0 * h
    b = r1 * h
    rise = p1 - p0
    curve = 3.0 * rise - 2.0 * a - b
    twist = a + b - 2.0 * rise
    value = p0 + s * (a + s * (curve + s * twist))
    # By how much the mean rate differs from that of a parabola; over a very short step
    # nothing but the round-off of the positions.
    curvature = 6.0 * rise - 3.0 * (a + b)
    if abs(curvature) < POSITION_NOISE:
        curvature = 0.0
    return value, r0 + s * (r1 - r0) + s * (1.0 - s) * curvature / h


@compiled
def crossing(p0: float, r0: float, p1: float, r1: float, h: float) -> float:
    """Return the part of a step at which the penetration becomes positive; 2 if it does not.

    A contact that has ended again within the step is found where the cubic shows it.
    """
    a = r0 * h
    b = r1 * h
    rise = p1 - p0
    # Above both ends a cubic is by 4/27 of its slopes there at most.
    if max(p0, p1) + 4.0 / 27.0 * (abs(a) + abs(b)) < 0.0:
        return 2.0
    quadratic = 3.0 * (a + b - 2.0 * rise)
    linear = 2.0 * (3.0 * rise - 2.0 * a - b)
    # Between its turning points (roots of quadratic s^2 + linear s + a) the cubic is
    # monotone: the first piece that rises from open to closed holds the touchdown.
    first = second = 1.0
    discriminant = linear * linear - 4.0 * quadratic * a
    if discriminant >= 0.0:
        half = -0.5 * (linear + math.copysign(math.sqrt(discriminant), linear))
        root = half / quadratic if quadratic != 0.0 else 1.0
        second_root = a / half if half != 0.0 else 1.0
        first = min(max(min(root, second_root), 0.0), 1.0)
        second = min(max(max(root, second_root), 0.0), 1.0)
    low = 0.0
    for high in (first, second, 1.0):
        value = p1 if high == 1.0 else hermite(p0, r0, p1, r1, h, high)[0]
        if value > 0.0:
            break
        low = high
    else:
        return 2.0
    for _ in range(55):
        middle = 0.5 * (low + high)
        if hermite(p0, r0, p1, r1, h, middle)[0] > 0.0:
            high = middle
        else:
            low = middle
    return high


@compiled
def time_to_event(p: float, r: float, a: float, j: float) -> tuple[float, float, float]:
    """Return when a quantity below zero reaches it, by its value and three derivatives, s.

    Infinite if never.  Also the rate then, and what the third derivative changes of the
    time.
    """
    root = r * r - 2.0 * a * p
    denominator = r + math.sqrt(root) if root >= 0.0 else 0.0
    if denominator <= 0.0:
        return math.inf, 0.0, 0.0
    first = -2.0 * p / denominator
    arrival = first
    doubt = 0.0
    for _ in range(2):
        slope = r + arrival * (a + 0.5 * j * arrival)
        if slope <= 0.0:
            arrival = doubt = first
            break
        change = -(p + arrival * (r + arrival * (0.5 * a + j * arrival / 6.0))) / slope
        arrival = min(max(arrival + change, 0.5 * first), 2.0 * first)
        doubt = abs(arrival - first)
    return arrival, r + arrival * (a + 0.5 * j * arrival), doubt


@compiled
def time_across(contact: Records, clearance: float) -> tuple[float, float]:
    """Return when a pin that flies inwards meets the opposite wall, s, and its speed there, m/s.

    The flight is straight and the bore round. The distance from the wall has a kink in
    the centre, beyond which its derivatives say nothing. Infinite where the pin rests
    or flies outwards. A corner touches one wall only.
    """
    ex, ey = contact.eccentricity_x, contact.eccentricity_y
    vx, vy = contact.velocity_x, contact.velocity_y
    outwards = ex * vx + ey * vy
    square = vx * vx + vy * vy
    root = outwards * outwards + square * (clearance * clearance - ex * ex - ey * ey)
    if square == 0.0 or outwards > 0.0 or root <= 0.0:
        return math.inf, 0.0
    return (math.sqrt(root) - outwards) / square, math.sqrt(root) / clearance


@compiled
def step_to_event(
    arrival: float, doubt: float, is_near: bool, behind: float, is_abrupt: bool
) -> float:
    """Return the step, s, that ends just ``behind`` a predicted event, or as near as it is trusted.

    Where the law begins with a jump the touchdown gets a short step of its own.
    """
    if not is_near:
        return max(arrival - 2.0 * doubt, 0.5 * arrival)
    return (
        arrival - behind if is_abrupt and arrival > 2.0 * behind else arrival + behind
    )


@compiled
def is_reversed(last: Records, contact: Records) -> bool:
    """Return whether a pin has passed the centre of its bore since its last accepted state.

    A corner touches one wall only.
    """
    if contact.is_flat > 0.0:
        return False
    along = last.eccentricity_x * contact.eccentricity_x
    return along + last.eccentricity_y * contact.eccentricity_y < 0.0


@compiled
def seen_from_opposite(penetration: float, eccentricity: float) -> float:
    """Return the penetration of a pin into the wall beyond the centre of its bore, m.

    The pin is farther from that wall than the centre, by its eccentricity. The rate
    changes sign.
    """
    return penetration - 2.0 * eccentricity


@compiled
def joint_crossing(
    last: Records, contact: Records, is_closed: bool, h: float
) -> tuple[float, float, float, float]:
    """Return the part of a step at which a joint touches down or separates; 2 if it does not.

    Also the penetration at the end of the step, m, its rate at the start and at the
    event, m/s, all with the sign in which they grow towards the event. All are those of
    the wall that the pin leaves, or on which it lands: a pin that runs through the
    centre of its bore is closed on both sides of it, and open between them.
    """
    start, end = last.penetration, contact.penetration
    first = last.rate
    final = contact.rate
    if is_reversed(last, contact):
        if is_closed:
            end = seen_from_opposite(end, contact.eccentricity)
            final = -final
        else:
            start = seen_from_opposite(
                start, math.hypot(last.eccentricity_x, last.eccentricity_y)
            )
            first = -first
    if is_closed:
        start = -start
        end = -end
        first = -first
        final = -final
    s = crossing(min(start, 0.0), first, end, final, h)
    return s, end, first, hermite(start, first, end, final, h, s)[1]


@compiled
def load_crossing(
    loads: Loads | None, k: int, q: Array, v: Array, a: Array, h: float, behind: float
) -> tuple[float, float, float]:
    """Return what ``joint_crossing`` does, of a load that goes so far behind transition ``k``."""
    value, rate = transition_value(loads, k, q, v, a)
    start, first_rate, _, _ = transition_at_start(loads, k, 0.0)
    if value == -math.inf:
        return 2.0, value, first_rate
    value -= behind
    s = crossing(min(start, 0.0) - behind, first_rate, value, rate, h)
    return s, value, first_rate


@compiled
def touch_down(
    records: Any, k: int, t: float, closing: float, started_closed: bool
) -> None:
    """Begin a contact: a joint counts as closed while its onset speed is not zero."""
    records.onset[k] = max(closing, 1e-300)
    last = records.memory[k]
    last.touchdown_time = t
    last.started_closed = started_closed
    last.steps = 0
    last.peak_force = 0.0
    last.longest_step = math.inf


@compiled
def separate(records: Any, k: int, t: float, rate: float, needed: int) -> None:
    """End a contact and file it; one of fewer than ``needed`` steps counts as unresolved.

    A contact in which the run began is not whole and is not counted.
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


@compiled
def force_within(
    joint: Records,
    onset: float,
    last: Records,
    contact: Records,
    h: float,
    quartic: float,
    s: float,
) -> float:
    """Return the normal force, N, at the part ``s`` of a step between two closed states.

    The law is evaluated on the cubic through both penetrations and rates, plus
    ``quartic`` times s^2 (1 - s)^2. On a foundation the elastic force follows the power
    of the penetration that force and energy of each state give.
    """
    start, end = last.penetration, contact.penetration
    depth, rate = hermite(start, last.rate, end, contact.rate, h, s)
    product = s * (1.0 - s)
    depth += quartic * product * product
    rate += 2.0 * quartic * product * (1.0 - 2.0 * s) / h
    if depth <= 0.0:
        return 0.0
    rate += (1.0 - s) * (last.closing - last.rate) + s * (
        contact.closing - contact.rate
    )
    if joint.foundation > 0.0 and joint.surface_bins > 0:
        first = last.elastic * (depth / start) ** (
            last.elastic * start / last.energy - 1.0
        )
        second = contact.elastic * (depth / end) ** (
            contact.elastic * end / contact.energy - 1.0
        )
        elastic = (1.0 - s) * first + s * second
    else:
        elastic = elastic_at(joint.normal, depth)
    return normal_force(joint.normal, elastic, depth, rate, onset)


@compiled
def peak_within(
    joint: Records, onset_speed: float, last: Records, contact: Records, h: float
) -> float:
    """Return the maximum of the normal force, N, within a step of a contact; 0 if there is none.

    There is one if the force rises at the beginning of the step and falls at its end.
    The quartic also passes through the state before, if that was closed. On a
    foundation, a maximum far above both ends is an error of the extrapolated powers.
    """
    if joint.oiled:
        return 0.0
    is_foundation = joint.foundation > 0.0 and joint.surface_bins > 0
    start, end = last.penetration, contact.penetration
    if not (onset_speed > 0.0 and h > 0.0 and start > 0.0 and end > 0.0):
        return 0.0
    # In a very short step round-off of the penetrations bends the cubic more than the
    # motion does.
    deviation = end - start - 0.5 * h * (last.rate + contact.rate)
    if abs(deviation) > h * abs(contact.rate - last.rate):
        return 0.0
    # A power that holds near a state says little about a penetration far from it.
    if is_foundation and max(start, end) > 2.0 * min(start, end):
        return 0.0
    onset = max(onset_speed, joint.onset_floor)
    low, high = 0.0, 1.0 - FORCE_SLOPE
    largest = 0.0
    for i in range(2):
        # While the pin goes deeper the force mostly rises up to the end, which is
        # tested first.
        if (i == 0) == (last.rate > 0.0):
            force = normal_force(
                joint.normal, contact.elastic, end, contact.closing, onset
            )
            s = high
        else:
            force = normal_force(joint.normal, last.elastic, start, last.closing, onset)
            s = FORCE_SLOPE
        if force_within(joint, onset, last, contact, h, 0.0, s) <= force:
            return 0.0
        largest = max(largest, force)
    quartic = 0.0
    # Behind a short step the round-off of the penetrations would be magnified.
    if last.earlier_penetration > 0.0 and last.step > 0.5 * h:
        s = -last.step / h
        cubic = hermite(start, last.rate, end, contact.rate, h, s)[0]
        quartic = (last.earlier_penetration - cubic) / (s * (1.0 - s)) ** 2
    force = 0.0
    for _ in range(PEAK_HALVINGS):
        s = 0.5 * (low + high)
        force = force_within(joint, onset, last, contact, h, quartic, s)
        if (
            force_within(joint, onset, last, contact, h, quartic, s + FORCE_SLOPE)
            > force
        ):
            low = s
        else:
            high = s
    return 0.0 if is_foundation and force > MAX_PEAK_RATIO * largest else force


@inlined
def remember(
    last: Records, joint: Records, onset_speed: float, contact: Records, t: float
) -> None:
    """Store what the next step needs of an accepted state; count the step, and find its peak.

    A state that is stored again at the same time changes neither count nor peak.
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
    over_bearing = contact.turning - joint.map_turns * contact.bearing_spin
    over_pin = contact.turning - joint.map_turns * contact.pin_spin
    last.sweep = max(abs(over_bearing), abs(over_pin))


@compiled
def settle(records: Any, t: float, needed: int) -> int:
    """Bring the state of contact up to an accepted state.

    Latches closing speeds and files contacts that ended, those of fewer than ``needed``
    steps as unresolved. Returns the number of joints that have touched down or
    separated; forces of an open joint that is closed now, or of a closed one that is
    open, have to be filled again.
    """
    joints = records.packed.joints
    onset = records.onset
    events = 0
    for k in range(joints.shape[0]):
        last = records.memory[k]
        contact = records.contacts[k]
        if joints[k].oiled:
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
            # Behind the separation no contact force changes the rate any more.
            leaving = -contact.rate if is_reversed(last, contact) else contact.rate
            separate(records, k, last.time + s * h, leaving, needed)
            onset[k] = 0.0
            events += 1
        remember(last, joints[k], onset[k], contact, t)
    return events
