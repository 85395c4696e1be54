"""Touchdown and separation of pins: the state of contact between accepted steps.

The force law needs the closing speed at touchdown.  Taken from the first penetrated
state it is wrong by parts in a thousand; here the penetration between two accepted
states is the cubic through both values and both rates, and its root is the moment of
touchdown.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.laws import (
    ONSET_SPEED_FLOOR,
    bristle_in_contact,
    bristle_in_flight,
    elastic_at,
    normal_force,
)
from presswear.tools.compile import Records, compiled, inlined

Array = NDArray[np.float64]

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
        ("step_peak", np.float64),  # normal force at a maximum within the last step, N; else 0
        ("sweep", np.float64),  # speed at which the contact runs over the wear maps, rad/s
        ("touchdown_time", np.float64),  # of the present contact, s
        ("started_closed", np.bool_),  # the run began inside the present contact
        ("steps", np.int64),  # accepted in the present contact
        ("longest_step", np.float64),  # allowed by the expected duration of the contact
        ("peak_force", np.float64),  # of the present contact, N
        ("bristle", np.float64),  # deflection of the bristles of its friction, m
        ("sliding", np.float64),  # m/s, where its friction has bristles
    ]
)
"""Memory of a joint between accepted steps: its last state and its present contact."""

TALLY = np.dtype(
    [
        ("contacts", np.int64),  # that have ended
        ("contacts_before", np.int64),  # ... before the present cycle
        ("rows", np.int64),  # of them kept
        ("full", np.bool_),  # no further ones are kept
        ("unresolved", np.int64),  # of too few steps
        ("fewest_steps", np.int64),
        ("peak_force", np.float64),  # of the run so far, N
        ("deepest", np.float64),  # penetration of the run so far, m
        ("closed_time", np.float64),  # s
    ]
)
"""Counts of one joint."""

PAST_CONTACT = np.dtype(
    [
        ("touchdown", np.float64),  # s
        ("separation", np.float64),  # s
        ("closing_speed", np.float64),  # rate of penetration at touchdown, m/s
        ("release_speed", np.float64),  # and at separation, below zero
        ("peak_force", np.float64),  # N
        ("steps", np.float64),
    ]
)
"""A contact that has ended."""
CONTACT_COLUMNS: tuple[str, ...] = PAST_CONTACT.names or ()
"""Its numbers, where they are stored as columns."""

POSITION_NOISE = 1e-14
"""Round-off of a penetration, some times over, m."""

FORCE_SLOPE = 1e-3
"""Part of a step over which the slope of the force is taken."""

PEAK_HALVINGS = 12
"""Halvings that locate a maximum of the force to 2e-4 of a step: 1e-8 of the force."""

LEAST_STEPS = 20
"""Steps that every contact gets, unless it is shorter than so many shortest steps."""


@compiled
def hermite(p0: float, r0: float, p1: float, r1: float, h: float, s: float) -> tuple[float, float]:
    """Value and time derivative at s in 0 .. 1 of the cubic through two states."""
    a = r0 * h
    b = r1 * h
    rise = p1 - p0
    curve = 3.0 * rise - 2.0 * a - b
    twist = a + b - 2.0 * rise
    value = p0 + s * (a + s * (curve + s * twist))
    # By how much the mean rate differs from that of a parabola; over a very short step
    # nothing but the round-off of the positions.
    bend = 6.0 * rise - 3.0 * (a + b)
    if abs(bend) < POSITION_NOISE:
        bend = 0.0
    return value, r0 + s * (r1 - r0) + s * (1.0 - s) * bend / h


@compiled
def crossing(p0: float, r0: float, p1: float, r1: float, h: float) -> float:
    """Part s of a step at which the penetration first becomes positive; 2 if it does not.

    A contact that has ended again within the step is found where the cubic shows it.
    """
    a = r0 * h
    b = r1 * h
    rise = p1 - p0
    quadratic = 3.0 * (a + b - 2.0 * rise)
    linear = 2.0 * (3.0 * rise - 2.0 * a - b)
    # Between its turning points (roots of quadratic s^2 + linear s + a) the cubic is
    # monotone: the first piece that rises from open to closed holds the touchdown.
    first = second = 1.0
    discriminant = linear * linear - 4.0 * quadratic * a
    if discriminant >= 0.0:
        half = -0.5 * (linear + math.copysign(math.sqrt(discriminant), linear))
        one = half / quadratic if quadratic != 0.0 else 1.0
        other = a / half if half != 0.0 else 1.0
        first = min(max(min(one, other), 0.0), 1.0)
        second = min(max(max(one, other), 0.0), 1.0)
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
def touch_down(last: Records, t: float, started_closed: bool) -> None:
    """Begin a contact."""
    last.touchdown_time = t
    last.started_closed = started_closed
    last.steps = 0
    last.peak_force = 0.0
    last.longest_step = math.inf


@compiled
def separate(
    last: Records,
    tally: Records,
    past: Records,
    onset_speed: float,
    t: float,
    rate: float,
    needed: int,
) -> None:
    """End a contact and file it; one of fewer than ``needed`` steps counts as unresolved.

    A contact in which the run began is not whole and is not counted.
    """
    if last.started_closed:
        return
    tally.contacts += 1
    tally.fewest_steps = min(tally.fewest_steps, last.steps)
    if last.steps < needed:
        tally.unresolved += 1
    if tally.rows < past.shape[0] and not tally.full:
        row = past[tally.rows]
        row.touchdown = last.touchdown_time
        row.separation = t
        row.closing_speed = onset_speed
        row.release_speed = rate
        row.peak_force = last.peak_force
        row.steps = last.steps
        tally.rows += 1


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

    The law is evaluated on a polynomial through both penetrations and rates.  On a foundation the
    elastic force follows the power of the penetration that force and energy of each state give.

    Parameters
    ----------
    last, contact : records of MEMORY and CONTACT
        The states at the beginning and at the end of the step of length ``h``, s.
    quartic : float
        Factor of s^2 (1 - s)^2, which is added to the cubic, m.
    """
    start, end = last.penetration, contact.penetration
    depth, rate = hermite(start, last.rate, end, contact.rate, h, s)
    product = s * (1.0 - s)
    depth += quartic * product * product
    rate += 2.0 * quartic * product * (1.0 - 2.0 * s) / h
    if depth <= 0.0:
        return 0.0
    rate += (1.0 - s) * (last.closing - last.rate) + s * (contact.closing - contact.rate)
    if joint.foundation > 0.0 and joint.surface_bins > 0:
        first = last.elastic * (depth / start) ** (last.elastic * start / last.energy - 1.0)
        second = contact.elastic * (depth / end) ** (contact.elastic * end / contact.energy - 1.0)
        elastic = (1.0 - s) * first + s * second
    else:
        elastic = elastic_at(joint.normal, depth)
    return normal_force(joint.normal, elastic, depth, rate, onset)


@compiled
def peak_within(
    joint: Records, onset_speed: float, last: Records, contact: Records, h: float
) -> float:
    """Return the maximum of the normal force, N, within a step of a contact; 0 if there is none.

    There is one if the force rises at the beginning of the step and falls at its end.  The
    polynomial of ``force_within`` also passes through the state before, if that was closed.
    """
    start, end = last.penetration, contact.penetration
    if not (onset_speed > 0.0 and h > 0.0 and start > 0.0 and end > 0.0):
        return 0.0
    # A power that holds near a state says little about a penetration far from it.
    if joint.foundation > 0.0 and max(start, end) > 2.0 * min(start, end):
        return 0.0
    onset = max(onset_speed, ONSET_SPEED_FLOOR)
    low, high = 0.0, 1.0 - FORCE_SLOPE
    for i in range(2):
        # While the pin goes deeper the force mostly rises up to the end, which is tested first.
        if (i == 0) == (last.rate > 0.0):
            force = normal_force(joint.normal, contact.elastic, end, contact.closing, onset)
            near = force_within(joint, onset, last, contact, h, 0.0, high)
        else:
            force = normal_force(joint.normal, last.elastic, start, last.closing, onset)
            near = force_within(joint, onset, last, contact, h, 0.0, FORCE_SLOPE)
        if near <= force:
            return 0.0
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
        if force_within(joint, onset, last, contact, h, quartic, s + FORCE_SLOPE) > force:
            low = s
        else:
            high = s
    return force


@inlined
def remember(last: Records, joint: Records, onset_speed: float, contact: Records, t: float) -> None:
    """Keep what the next step needs of an accepted state, and the peak of the step to it.

    A state that is noted again at the same time leaves the peak as it is.
    """
    turns = joint.map_turns
    h = t - last.time
    if h > 0.0:
        last.step_peak = peak_within(joint, onset_speed, last, contact, h)
        last.earlier_penetration = last.penetration
    last.step = h
    last.time = t
    last.penetration = contact.penetration
    last.rate = contact.rate
    last.closing = contact.closing
    last.elastic = contact.elastic
    last.energy = contact.energy
    if joint.friction.bristle_stiffness > 0.0:
        last.bristle = contact.bristle
        last.sliding = contact.sliding
    last.sweep = max(
        abs(contact.turning - turns * contact.bearing_spin),
        abs(contact.turning - turns * contact.pin_spin),
    )


@compiled
def advance_bristles(joints: Records, memory: Records, contacts: Records, t: float) -> None:
    """Fill in the bristles at ``t``, s, the end of a step of the trapezoidal rule.

    A step in which the pin touches down or separates is divided there: the bristles bend in
    contact only.
    """
    for k in range(joints.shape[0]):
        law = joints[k].friction
        if law.bristle_stiffness > 0.0:
            last = memory[k]
            contact = contacts[k]
            h = t - last.time
            p0, r0 = last.penetration, last.rate
            p1, r1 = contact.penetration, contact.rate
            bristle, started = last.bristle, last.sliding
            if p0 <= 0.0 < p1:
                flight = min(crossing(p0, r0, p1, r1, h), 1.0) * h
                bristle = bristle_in_flight(bristle, flight, law)
                # Only the part behind the touchdown slides in contact, at nearly the final speed.
                h, started = h - flight, contact.sliding
            if p1 > 0.0:
                bristle = bristle_in_contact(bristle, started, contact.sliding, h, law)
            elif p0 > 0.0:
                closed = min(crossing(-p0, -r0, -p1, -r1, h), 1.0) * h
                bristle = bristle_in_contact(bristle, started, contact.sliding, closed, law)
                bristle = bristle_in_flight(bristle, h - closed, law)
            else:
                bristle = bristle_in_flight(bristle, h, law)
            contact.bristle = bristle


@compiled
def settle(
    joints: Records,
    onset: Array,
    memory: Records,
    tally: Records,
    past: Records,
    contacts: Records,
    t: float,
    needed: int = LEAST_STEPS,
) -> int:
    """Bring memory up to an accepted state: latch closing speeds, file contacts that ended.

    Returns the number of joints that have touched down or separated.

    Parameters
    ----------
    onset : ndarray, shape (joints,)
        Latched closing speeds, m/s; 0 where open.
    past : records of PAST_CONTACT, shape (joints, rows)
    needed : int
        A contact of fewer steps counts as unresolved.
    """
    events = 0
    for k in range(joints.shape[0]):
        last = memory[k]
        contact = contacts[k]
        if onset[k] == 0.0 and contact.penetration > 0.0:
            h = t - last.time
            started_closed = last.penetration > 0.0 or h <= 0.0
            touchdown, closing = t, contact.rate
            if not started_closed:
                s = crossing(last.penetration, last.rate, contact.penetration, contact.rate, h)
                touchdown = last.time + s * h
                closing = hermite(
                    last.penetration, last.rate, contact.penetration, contact.rate, h, s
                )[1]
            # A joint counts as closed while its onset speed is not zero.
            onset[k] = max(closing, 1e-300)
            touch_down(last, touchdown, started_closed)
            events += 1
        elif onset[k] > 0.0 and contact.penetration <= 0.0:
            separate(last, tally[k], past[k], onset[k], t, contact.rate, needed)
            onset[k] = 0.0
            events += 1
        if onset[k] > 0.0:
            last.steps += 1
        remember(last, joints[k], onset[k], contact, t)
    return events
