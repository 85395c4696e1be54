"""Maximum of the normal force inside a step."""

from presswear.physics.contact import CONTACT, MEMORY
from presswear.physics.event_time import hermite
from presswear.physics.friction_and_normal import elastic_at, normal_force
from presswear.physics.packed import JOINT
from presswear.tools.compile import Records, compiled, lazily_compiled

FORCE_SLOPE = 1e-3  # difference for the slope of the force, as a fraction of a step
# Slope at which a maximum of the force is located, relative to the change of the slope
# over the step: to 2e-4 of the step, and the force to 1e-8 of its value
PEAK_TOL = 2e-4
MAX_PEAK_STEPS = 12  # regula falsi needs three or four
# Largest ratio of a peak to the larger force at the ends of its step; the largest that
# was measured is 1.02.
MAX_PEAK_RATIO = 1.05


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
) -> tuple[float, float, float]:
    """Return the larger normal force at the ends of a step, N; -1 without a maximum inside.

    There is a maximum inside if the force rises at the beginning of the step and falls
    at its end. Also return by how much, N, over the fraction FORCE_SLOPE of the step.
    """
    largest = 0.0
    rise = 0.0
    fall = 0.0
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
            fall = force_within(joint, onset, last, contact, h, 0.0, s) - force
            change = fall
        else:
            force = normal_force(
                joint.normal, last.elastic, last.penetration, last.closing, onset
            )
            s = FORCE_SLOPE
            rise = force_within(joint, onset, last, contact, h, 0.0, s) - force
            change = rise
        if change <= 0.0:
            return -1.0, 0.0, 0.0
        largest = max(largest, force)
    return largest, rise, fall


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
    rise: float,
    fall: float,
) -> float:
    """Return the maximum of the normal force inside a step, N.

    The root of its slope is found by regula falsi in the Illinois form. ``rise`` and
    ``fall`` are those of ``end_force``.
    """
    low = 0.0
    high = 1.0 - FORCE_SLOPE
    tolerance = PEAK_TOL * (rise + fall)
    before = 0.0
    force = 0.0
    for _ in range(MAX_PEAK_STEPS):
        s = low + (high - low) * rise / (rise + fall)
        force = force_within(joint, onset, last, contact, h, quartic, s)
        later = force_within(joint, onset, last, contact, h, quartic, s + FORCE_SLOPE)
        slope = later - force
        if abs(slope) <= tolerance:
            break
        if slope > 0.0:
            low = s
            rise = slope
            fall *= 0.5 if before > 0.0 else 1.0
        else:
            high = s
            fall = -slope
            rise *= 0.5 if before < 0.0 else 1.0
        before = slope
    return force


@lazily_compiled(0, JOINT, 0, MEMORY, CONTACT, 0)
def force_maximum(
    joint: Records, onset_speed: float, last: Records, contact: Records, h: float
) -> float:
    """Return the maximum of the normal force inside a step, N; 0 without one.

    On a foundation, a maximum far above the forces at both ends is an error of the
    extrapolated powers.
    """
    onset = max(onset_speed, joint.onset_floor)
    largest, rise, fall = end_force(joint, onset, last, contact, h)
    if largest < 0.0:
        return 0.0
    quartic = quartic_of(last, contact, h)
    force = maximum_force(joint, onset, last, contact, h, quartic, rise, fall)
    is_foundation = joint.foundation > 0.0 and joint.surface_bins > 0
    return 0.0 if is_foundation and force > MAX_PEAK_RATIO * largest else force


@compiled
def peak_within(
    joint: Records, onset_speed: float, last: Records, contact: Records, h: float
) -> float:
    """Return the maximum of the normal force inside a step of a contact, N; 0 without one."""
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
    return force_maximum(joint, onset_speed, last, contact, h)
