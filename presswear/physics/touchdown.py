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

from presswear.physics.friction_and_normal import elastic_at, normal_force
from presswear.physics.load_transitions import transition_at_start, transition_value
from presswear.physics.loads import Loads
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, floats, inlined

# Memory of a joint between accepted steps: its last state and its present contact
MEMORY = np.dtype(
    [
        ("time", np.float64),  # of the last accepted state, s
        ("step", np.float64),  # length of the last accepted step, s
        ("penetration", np.float64),  # m
        ("earlier_penetration", np.float64),  # in the state before the last, m
        ("rate", np.float64),  # of the penetration, m/s
        ("acceleration", np.float64),  # of the penetration, m/s^2
        ("closing", np.float64),  # rate that enters the damping, m/s
        ("elastic", np.float64),  # elastic force, N
        ("energy", np.float64),  # elastic energy, J
        # maximum of the normal force inside the last step, N; 0: no maximum inside
        ("step_peak", np.float64),
        # speed of the contact over the wear maps, rad/s
        ("sweep", np.float64),
        *floats("eccentricity_x", "eccentricity_y"),  # of the last accepted state, m
        ("touchdown_time", np.float64),  # of the present contact, s
        ("separation_time", np.float64),  # of the previous contact, s
        ("started_closed", np.bool_),  # the run began inside the present contact
        ("steps", np.int64),  # accepted in the present contact
        ("longest_step", np.float64),  # for the expected duration of the contact, s
        ("peak_force", np.float64),  # of the present contact, N
    ]
)

# Counts of one joint
COUNTERS = np.dtype(
    [
        ("contacts", np.int64),  # that have ended
        ("contacts_before", np.int64),  # that had ended before the present cycle
        ("rows", np.int64),  # stored contacts
        ("full", np.bool_),  # no more contacts are stored
        ("unresolved", np.int64),  # contacts with too few steps
        ("fewest_steps", np.int64),  # of any contact
        ("peak_force", np.float64),  # of the run so far, N
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
POSITION_NOISE = 1e-14  # several times the round-off of a penetration, m
FORCE_SLOPE = 1e-3  # difference for the slope of the force, as a fraction of a step
# Bisections for a maximum of the force. They locate it to 2e-4 of a step, and the force
# to 1e-8 of its value.
PEAK_HALVINGS = 12
# Largest ratio of a peak to the larger force at the ends of its step; the largest that
# was measured is 1.02.
MAX_PEAK_RATIO = 1.05
# Least number of steps in a contact. A contact that is shorter than this number of
# shortest steps has fewer.
LEAST_STEPS = 20


@compiled
def hermite(
    p0: float, r0: float, p1: float, r1: float, h: float, s: float
) -> tuple[float, float]:
    """Return value and time derivative of the cubic through two states.

    The states have values ``p0`` and ``p1`` and rates ``r0`` and ``r1``, at the ends of
    a step of length ``h``, s. ``s`` is the fraction of the step, from 0 to 1.
    """
    a = r0 * h
    b = r1 * h
    rise = p1 - p0
    curve = 3.0 * rise - 2.0 * a - b
    twist = a + b - 2.0 * rise
    value = p0 + s * (a + s * (curve + s * twist))
    # Six times the difference between the rise and that of a parabola with these rates.
    # Over a very short step it is only the round-off of the positions.
    curvature = 6.0 * rise - 3.0 * (a + b)
    if abs(curvature) < POSITION_NOISE:
        curvature = 0.0
    return value, r0 + s * (r1 - r0) + s * (1.0 - s) * curvature / h


@compiled
def crossing(p0: float, r0: float, p1: float, r1: float, h: float) -> float:
    """Return the fraction of a step after which the penetration becomes positive; 2 if never.

    The arguments are those of ``hermite``. A contact that begins and ends within the
    step is found if the cubic becomes positive.
    """
    a = r0 * h
    b = r1 * h
    rise = p1 - p0
    # A cubic exceeds the values at its ends by at most 4/27 of its slopes at the ends.
    if max(p0, p1) + 4.0 / 27.0 * (abs(a) + abs(b)) < 0.0:
        return 2.0
    quadratic = 3.0 * (a + b - 2.0 * rise)
    linear = 2.0 * (3.0 * rise - 2.0 * a - b)
    # Between its turning points (roots of quadratic s^2 + linear s + a) the cubic is
    # monotone. The touchdown lies in the first of these pieces that ends above zero.
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
    """Return the time, s, after which a negative quantity reaches zero; infinite if never.

    Also return the rate at that time, and the change of the time by the third
    derivative, s, which serves as its uncertainty. ``p`` is the present value; ``r``,
    ``a`` and ``j`` are its first three derivatives.
    """
    root = r * r - 2.0 * a * p
    denominator = r + math.sqrt(root) if root >= 0.0 else 0.0
    if denominator <= 0.0:
        return math.inf, 0.0, 0.0
    first = -2.0 * p / denominator
    arrival = first
    uncertainty = 0.0
    for _ in range(2):
        slope = r + arrival * (a + 0.5 * j * arrival)
        if slope <= 0.0:
            arrival = first
            uncertainty = first
            break
        change = -(p + arrival * (r + arrival * (0.5 * a + j * arrival / 6.0))) / slope
        arrival = min(max(arrival + change, 0.5 * first), 2.0 * first)
        uncertainty = abs(arrival - first)
    rate = r + arrival * (a + 0.5 * j * arrival)
    return arrival, rate, uncertainty


@compiled
def time_across(contact: Records, clearance: float) -> tuple[float, float]:
    """Return the time to the opposite wall, s, and the closing speed at that wall, m/s.

    The flight of the pin is taken as straight and the bore as round. Derivatives of the
    penetration cannot predict this event, because the penetration has a kink at the
    centre. The time is infinite if the pin rests or moves outwards.
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
    arrival: float, uncertainty: float, is_near: bool, behind: float, is_abrupt: bool
) -> float:
    """Return the step, s, that ends the time ``behind`` after a predicted event.

    If the event is not near, the step ends earlier by twice the uncertainty of the
    prediction. If the force jumps at touchdown, the step ends before the event, so that
    a short step of its own passes the touchdown.
    """
    if not is_near:
        return max(arrival - 2.0 * uncertainty, 0.5 * arrival)
    if is_abrupt and arrival > 2.0 * behind:
        return arrival - behind
    return arrival + behind


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


@compiled
def load_crossing(
    loads: Loads | None, k: int, q: Array, v: Array, a: Array, h: float, behind: float
) -> tuple[float, float, float]:
    """Return the fraction of a step after which a load is past its transition ``k``; 2 if never.

    Also return the value of the transition at the end of the step, and its rate at the
    start. A load is past the transition if the value exceeds ``behind``.
    """
    value, rate = transition_value(loads, k, q, v, a)
    start, start_rate, _, _ = transition_at_start(loads, k, 0.0)
    if value == -math.inf:
        return 2.0, value, start_rate
    value -= behind
    s = crossing(min(start, 0.0) - behind, start_rate, value, rate, h)
    return s, value, start_rate


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
    """Return the normal force, N, at the fraction ``s`` of a step between two closed states.

    The penetration is the cubic through both penetrations and rates, plus ``quartic``
    times s^2 (1 - s)^2. On a foundation the elastic force is extrapolated from each
    state as a power of the penetration: if F = c delta^n, the energy is F delta / (n + 1).
    """
    start = last.penetration
    end = contact.penetration
    depth, rate = hermite(start, last.rate, end, contact.rate, h, s)
    product = s * (1.0 - s)
    depth += quartic * product * product
    rate += 2.0 * quartic * product * (1.0 - 2.0 * s) / h
    if depth <= 0.0:
        return 0.0
    start_difference = last.closing - last.rate
    end_difference = contact.closing - contact.rate
    rate += (1.0 - s) * start_difference + s * end_difference
    if joint.foundation > 0.0 and joint.surface_bins > 0:
        start_exponent = last.elastic * start / last.energy - 1.0
        from_start = last.elastic * (depth / start) ** start_exponent
        end_exponent = contact.elastic * end / contact.energy - 1.0
        from_end = contact.elastic * (depth / end) ** end_exponent
        elastic = (1.0 - s) * from_start + s * from_end
    else:
        elastic = elastic_at(joint.normal, depth)
    return normal_force(joint.normal, elastic, depth, rate, onset)


@compiled
def end_force(
    joint: Records, onset: float, last: Records, contact: Records, h: float
) -> float:
    """Return the larger normal force at the ends of a step, N; -1 without a maximum inside.

    There is a maximum inside if the force rises at the beginning of the step and falls
    at its end.
    """
    largest = 0.0
    for i in range(2):
        # While the pin goes deeper the force mostly rises until the end of the step.
        # The end is then tested first, because this test decides.
        if (i == 0) == (last.rate > 0.0):
            s = 1.0 - FORCE_SLOPE
            force = normal_force(
                joint.normal,
                contact.elastic,
                contact.penetration,
                contact.closing,
                onset,
            )
        else:
            s = FORCE_SLOPE
            force = normal_force(
                joint.normal, last.elastic, last.penetration, last.closing, onset
            )
        if force_within(joint, onset, last, contact, h, 0.0, s) <= force:
            return -1.0
        largest = max(largest, force)
    return largest


@compiled
def quartic_of(last: Records, contact: Records, h: float) -> float:
    """Return the factor of s^2 (1 - s)^2 with which the penetration passes the earlier state.

    Zero if that state was open. Also zero after a short step, because the round-off of
    the penetrations would be magnified.
    """
    if not (last.earlier_penetration > 0.0 and last.step > 0.5 * h):
        return 0.0
    s = -last.step / h
    cubic = hermite(
        last.penetration, last.rate, contact.penetration, contact.rate, h, s
    )[0]
    return (last.earlier_penetration - cubic) / (s * (1.0 - s)) ** 2


@compiled
def maximum_force(
    joint: Records,
    onset: float,
    last: Records,
    contact: Records,
    h: float,
    quartic: float,
) -> float:
    """Return the maximum of the normal force inside a step by bisection of its slope, N."""
    low = 0.0
    high = 1.0 - FORCE_SLOPE
    force = 0.0
    for _ in range(PEAK_HALVINGS):
        s = 0.5 * (low + high)
        force = force_within(joint, onset, last, contact, h, quartic, s)
        later = force_within(joint, onset, last, contact, h, quartic, s + FORCE_SLOPE)
        if later > force:
            low = s
        else:
            high = s
    return force


@compiled
def peak_within(
    joint: Records, onset_speed: float, last: Records, contact: Records, h: float
) -> float:
    """Return the maximum of the normal force inside a step of a contact, N; 0 without one.

    On a foundation, a maximum far above the forces at both ends is an error of the
    extrapolated powers.
    """
    if joint.always_closed:
        return 0.0
    is_foundation = joint.foundation > 0.0 and joint.surface_bins > 0
    start = last.penetration
    end = contact.penetration
    if not (onset_speed > 0.0 and h > 0.0 and start > 0.0 and end > 0.0):
        return 0.0
    # In a very short step round-off of the penetrations bends the cubic more than the
    # motion does.
    deviation = end - start - 0.5 * h * (last.rate + contact.rate)
    if abs(deviation) > h * abs(contact.rate - last.rate):
        return 0.0
    # A power that holds near a state does not hold at a penetration far from it.
    if is_foundation and max(start, end) > 2.0 * min(start, end):
        return 0.0
    onset = max(onset_speed, joint.onset_floor)
    largest = end_force(joint, onset, last, contact, h)
    if largest < 0.0:
        return 0.0
    quartic = quartic_of(last, contact, h)
    force = maximum_force(joint, onset, last, contact, h, quartic)
    return 0.0 if is_foundation and force > MAX_PEAK_RATIO * largest else force


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
    over_bearing = contact.turning - joint.map_turns * contact.bearing_spin
    over_pin = contact.turning - joint.map_turns * contact.pin_spin
    last.sweep = max(abs(over_bearing), abs(over_pin))


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
