"""Maximum of the normal force inside a step."""

from presswear.physics.contact import CONTACT, MEMORY
from presswear.physics.event_time import hermite
from presswear.physics.friction_and_normal import elastic_at, normal_force
from presswear.physics.packed import JOINT
from presswear.tools.compile import Records, compiled, lazily_compiled

FORCE_SLOPE = 1e-3  # difference for the slope of the force, as a fraction of a step
# Bisections for a maximum of the force. They locate it to 2e-4 of a step, and the force
# to 1e-8 of its value.
PEAK_HALVINGS = 12
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


@lazily_compiled(0, JOINT, 0, MEMORY, CONTACT, 0)
def force_maximum(
    joint: Records, onset_speed: float, last: Records, contact: Records, h: float
) -> float:
    """Return the maximum of the normal force inside a step, N; 0 without one.

    On a foundation, a maximum far above the forces at both ends is an error of the
    extrapolated powers.
    """
    onset = max(onset_speed, joint.onset_floor)
    largest = end_force(joint, onset, last, contact, h)
    if largest < 0.0:
        return 0.0
    quartic = quartic_of(last, contact, h)
    force = maximum_force(joint, onset, last, contact, h, quartic)
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
