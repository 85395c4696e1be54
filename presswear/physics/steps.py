"""Lengths of steps about touches: chosen before they are made.

In free flight the time to the next touchdown is predicted and the step ends just behind it; in
contact a step is a set part of the time that the contact will last.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.contact import note_contact, penetration_acceleration
from presswear.physics.packed import Packed
from presswear.physics.touchdown import LEAST_STEPS, crossing, hermite
from presswear.tools.compile import Records, compiled

Array = NDArray[np.float64]

STEPS = np.dtype(
    [
        ("free", np.float64),  # longest step in free flight, s
        ("per_contact", np.float64),  # steps in one free impact
        ("sustained", np.float64),  # steps in half a period of a pin at rest on its bearing
        ("least", np.float64),  # shortest step, s
    ]
)
"""Step lengths of a fixed-order integrator."""

LANDING = 0.02
"""A step towards a touchdown ends this part of a contact step behind it."""

FLIGHT_STEPS_PER_BIN = 4.0
"""Steps in which a pin that skims a worn surface crosses one bin of its map."""

LEAST_PARTS = 15
"""Steps of an error-controlled method in a free impact, at least: enough to show its peak."""

STEPS_PER_FLIGHT = 20.0
"""Steps in the time in which a pin would cross the clearance from rest, at least."""

SKIM_STEPS = 2.0
"""Steps of an error-controlled method in which a pin crosses one bin of a worn map, at least."""

OVERSHOOT = 0.2
"""A step that ends more than this part of a contact step behind a touchdown is redone."""


@compiled
def contact_step(joint: Records, penetration: float, rate: float, parts: float) -> float:
    """Step, s, that divides a contact into equal parts.

    The duration is half a period of the oscillation at the deepest penetration
    that the present energy allows: pi sqrt(8/15) = 2.29 delta_max / v at the touchdown
    of an elastic Hertz impact, which lasts 2.94 delta_max / v.
    """
    mass = joint.effective_mass
    stiffness = joint.normal.estimated_stiffness
    exponent = joint.normal.estimated_exponent
    if math.isinf(mass):
        return math.inf
    depth = max(penetration, 0.0)
    energy = 0.5 * mass * rate * rate + stiffness * depth ** (exponent + 1.0) / (exponent + 1.0)
    reach = ((exponent + 1.0) * energy / stiffness) ** (1.0 / (exponent + 1.0))
    if reach <= 0.0:
        return math.inf
    tangent = exponent * stiffness * reach ** (exponent - 1.0)
    return math.pi * math.sqrt(mass / tangent) / parts


@compiled
def step_in_contact(last: Records, steps: Records, part: float, acceleration: float) -> float:
    """Next step, s, while a joint is closed.

    A free impact is divided into equal parts.  A pin that has come to rest on its
    bearing oscillates less than the deepest possible penetration suggests: there
    the step grows until its error, h^2 / 12 times the change of acceleration for
    the trapezoidal rule, is the part of the penetration that the equal parts of
    a free impact would make, but no further than ``sustained`` parts.
    """
    parts = steps.per_contact
    if last.steps <= 1:
        # A contact that the surrounding motion pulls open again may be far shorter
        # than a free impact.
        if last.rate > 0.0 and acceleration < 0.0:
            last.longest_step = min(last.longest_step, 2.0 * last.rate / -acceleration / parts)
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
    """Step, s, that ends just behind a touchdown too far before the trial state; else -1.

    Where the law begins with a jump, the touchdown is put into a short step of its own.
    """
    s = crossing(last.penetration, last.rate, contact.penetration, contact.rate, h)
    if s > 1.0:
        return -1.0
    closing = hermite(last.penetration, last.rate, contact.penetration, contact.rate, h, s)[1]
    part = contact_step(joint, 0.0, closing, steps.per_contact)
    behind = min(LANDING * part, 0.1 * h)
    if joint.normal.abrupt:
        near = LANDING * part
        if h <= 4.0 * near:
            return -1.0
        return max(s * h - near if s * h > 2.0 * near else s * h + near, steps.least)
    if contact.penetration > 0.0:
        if (1.0 - s) * h <= OVERSHOOT * part:
            return -1.0
    elif contact.rate < 0.0:
        # Touched and gone: land while the pin is still in, well before its deepest point.
        behind = min(behind, 0.1 * (1.0 - s) * h * closing / (closing - contact.rate))
    return max(s * h + behind, steps.least)


@compiled
def early_separation(last: Records, steps: Records, contact: Records, h: float) -> float:
    """Step, s, that still divides a contact finely which the trial state has ended; else -1.

    A pin that skims a bump can leave sooner than the state at its touchdown let expect.
    The shorter step holds for the rest of the contact.
    """
    missing = LEAST_STEPS - last.steps
    if contact.penetration > 0.0 or missing <= 0 or last.started_closed:
        return -1.0
    s = crossing(-last.penetration, -last.rate, -contact.penetration, -contact.rate, h)
    wanted = max(min(s, 1.0) * h / (missing + 1), steps.least)
    if wanted > 0.7 * h:
        return -1.0
    last.longest_step = wanted
    return wanted


@compiled
def shorter_step(
    packed: Packed,
    onset: Array,
    memory: Records,
    steps: Records,
    contacts: Records,
    t: float,
    q: Array,
    v: Array,
) -> float:
    """Step, s, with which a trial step has to be repeated; -1 if it is acceptable.

    ``contacts`` is working space.
    """
    joints = packed.joints
    shortest = -1.0
    for k in range(joints.shape[0]):
        last = memory[k]
        h = t - last.time
        if h <= steps[0].least:
            continue
        contact = contacts[k]
        note_contact(packed, k, q, v, contact)
        if onset[k] > 0.0:
            wanted = early_separation(last, steps[0], contact, h)
        else:
            wanted = late_touchdown(joints[k], last, steps[0], contact, h)
        if wanted > 0.0 and (shortest < 0.0 or wanted < shortest):
            shortest = wanted
    return shortest


@compiled
def step_after_touchdown(joints: Records, onset: Array, memory: Records, longest: float) -> float:
    """Step limit, s, of an error-controlled method where a pin has touched down a moment ago.

    A contact that the surrounding motion pulls open again may be far shorter than a free
    impact; its ``longest_step`` tells how short.
    """
    for k in range(joints.shape[0]):
        if onset[k] > 0.0 and memory[k].steps < 2 * LEAST_PARTS:
            part = contact_step(joints[k], 0.0, onset[k], LEAST_PARTS)
            longest = min(longest, part, memory[k].longest_step)
    return longest


@compiled
def skim_step(packed: Packed, memory: Records, longest: float) -> float:
    """Step limit, s, of an error-controlled method from the bumps that a pin runs over.

    Its error estimate sees a bump only where a stage happens to fall on it.
    """
    if packed.surfaces.shape[2] == 0:
        return longest
    for k in range(memory.shape[0]):
        last = memory[k]
        joint = packed.joints[k]
        worn = joint.surface_bins > 0
        if worn and last.sweep > 0.0 and last.penetration > -joint.relief:
            bins = 2.0 * math.pi / joint.surface_bins / last.sweep
            longest = min(longest, bins / SKIM_STEPS)
    return longest


@compiled
def next_step(
    packed: Packed,
    onset: Array,
    memory: Records,
    steps: Records,
    contacts: Records,
    a: Array,
) -> float:
    """Length of the next step, s, from the state just settled."""
    chosen = steps[0].free
    for k in range(memory.shape[0]):
        joint = packed.joints[k]
        last = memory[k]
        depth = last.penetration
        rate = last.rate
        part = contact_step(joint, depth, rate, steps[0].per_contact)
        acceleration = penetration_acceleration(
            joint, packed.surfaces[k, :, : joint.surface_bins], contacts[k], a
        )
        if joint.surface_bins > 0 and last.sweep > 0.0 and depth > -joint.relief:
            # A bump of the profile is a contact of its own and gets as many steps.
            bins = 2.0 * math.pi / joint.surface_bins / last.sweep
            share = 0.5 * steps[0].per_contact if onset[k] > 0.0 else FLIGHT_STEPS_PER_BIN
            chosen = min(chosen, max(bins / share, steps[0].least))
        if onset[k] > 0.0:
            wanted = step_in_contact(last, steps[0], part, acceleration)
            chosen = min(chosen, max(wanted, steps[0].least))
            last.acceleration = acceleration
            continue
        # Free flight: part of the time in which the present acceleration crosses the clearance,
        # and the time at which the present motion closes the gap.
        if acceleration != 0.0:
            flight = math.sqrt(2.0 * joint.clearance / abs(acceleration))
            chosen = min(chosen, max(flight / STEPS_PER_FLIGHT, steps[0].least))
        root = rate * rate - 2.0 * acceleration * depth
        if root >= 0.0:
            denominator = rate + math.sqrt(root)
            arrival = -2.0 * depth / denominator if denominator > 0.0 else -1.0
            if 0.0 <= arrival < chosen:
                closing = rate + acceleration * arrival
                part = contact_step(joint, 0.0, closing, steps[0].per_contact)
                behind = min(LANDING * part, steps[0].free)
                if joint.normal.abrupt and arrival > 2.0 * behind:
                    behind = -behind
                chosen = min(chosen, max(arrival + behind, steps[0].least))
    return chosen
