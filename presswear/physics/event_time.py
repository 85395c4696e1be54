"""Times of events from values and rates: cubics, predictions and step lengths."""

import math

from presswear.tools.compile import Records, compiled

POSITION_NOISE = 1e-14  # several times the round-off of a penetration, m
BISECTIONS = 55  # halve a step to its round-off


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
        value = p1
        if high != 1.0:
            value, _ = hermite(p0, r0, p1, r1, h, high)
        if value > 0.0:
            break
        low = high
    else:
        return 2.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        value, _ = hermite(p0, r0, p1, r1, h, middle)
        if value > 0.0:
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
    ex = contact.eccentricity_x
    ey = contact.eccentricity_y
    vx = contact.velocity_x
    vy = contact.velocity_y
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
