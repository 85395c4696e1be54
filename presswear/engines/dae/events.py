"""Events of a trial step, located: touchdowns, separations, corners of friction, changes of the
laws of loads.

A step that holds one is repeated until it ends there, so that no step ever crosses a change
of law.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.engines.dae.dynamics import System, accelerate, place
from presswear.engines.dae.runge_kutta import Integration, classical_step, embedded_step
from presswear.engines.dormand_prince import Tableau
from presswear.physics.friction_and_normal import corner_ahead
from presswear.physics.loads import Loads, count_transitions, transition_at_start, transition_value
from presswear.physics.touchdown import crossing, separate, touch_down
from presswear.recording.observe import RecorderState
from presswear.tools.compile import Records, compiled, inlined

Array = NDArray[np.float64]

CONTROL = np.dtype(
    [
        ("time", np.float64),
        ("step", np.float64),  # next, s
        ("due", np.float64),  # time at which an equal step that was cut is to end, s; or 0
        ("longest", np.float64),  # s
        ("shortest", np.float64),  # s
        ("tolerance", np.float64),
        ("projected", np.bool_),
        ("has_started", np.bool_),  # the initial state is recorded
        ("has_slope", np.bool_),  # the slopes of the state are evaluated
        ("past_corners", np.bool_),  # the next step does not end where friction has a corner
        ("steps", np.int64),
        ("rejected", np.int64),
        ("events", np.int64),
        ("evaluations", np.int64),  # of the accelerations
        ("position_error", np.float64),  # greatest |Phi|
        ("velocity_error", np.float64),  # greatest |dPhi/dt|
    ]
)
"""State of an integration."""

# Most repetitions that locate an event; four do, halving helps where Newton strays.
NEWTON_STEPS = 60
SHORTEST_MOVE = 1e-15  # change of a step, s, below which Newton's method stands still
EVENT_DEPTH = 1e-17  # penetration at which an event is located, m
DEPTH_TOL = 1e-12  # penetration up to which a place that round-off keeps from it is one, m
MIN_SEPARATION = 1e-14  # s; a later event differs from the one on which the last step ended
# Closing speed of a joint whose touchdown ends a step: up to there no step feels a contact.
HELD_OPEN = -1.0
CLASSICAL_STAGES = 4  # evaluations in a step of the classical method
# A step that ends on a change of a load's law goes so far behind it, m, rad, m/s or rad/s.
BEHIND = 1e-13
MAX_BEHIND = 1e-9  # ... and so far where round-off keeps it from ending sooner


@compiled
def reach_end(
    system: System, tableau: Tableau | None, motion: Integration, t: float, h: float
) -> None:
    """Fill the state of all bodies at the end of a trial step, with accelerations."""
    # An embedded method evaluates its last slopes there.
    if tableau is None:
        place(system, t + h, motion.trial)
    accelerate(system, motion.slopes[last_slope(tableau)])


@compiled
def event_value(
    system: System,
    tableau: Tableau | None,
    records: RecorderState,
    motion: Integration,
    k: int,
    t: float,
    h: float,
) -> tuple[float, float]:
    """Switching function of event ``k`` at the end of a trial step, and its rate.

    Events are those of the joints, for which slopes were evaluated last in that state, then the
    ways out of the modes of the loads, then the corners of friction: of each joint the next one
    upwards and the next one downwards.
    """
    joints = system.contacts.shape[0]
    if k < joints:
        depth, rate = system.contacts[k].penetration, system.contacts[k].rate
        return (-depth, -rate) if records.onset[k] > 0.0 else (depth, rate)
    reach_end(system, tableau, motion, t, h)
    q, v, a, _, _ = system.state
    corners = first_of_corners(system)
    if k < corners:
        return transition_value(system.packed.loads, k - joints, q, v, a)
    sense = 1.0 - 2.0 * ((k - corners) & 1)
    k = (k - corners) >> 1
    start, end = records.contacts[k].sliding, system.contacts[k].sliding
    corner = corner_ahead(start, sense, system.packed.joints[k].friction)
    # The mean rate over the step: sliding bends little in one.
    return sense * (end - corner), sense * (end - start) / h


@inlined
def first_of_corners(system: System) -> int:
    """The first event that is a corner of friction; see ``event_value``."""
    return system.contacts.shape[0] + count_transitions(system.packed.loads)


@compiled
def first_corner(
    system: System, records: RecorderState, first: int, excluded: int | np.int64, joints: int
) -> tuple[int, float]:
    """Corner of friction that a closed joint slides past first in a trial step; or -1.

    Parameters
    ----------
    first : int
        The first event that is one.
    joints : int
        Number of joints whose events are located, from the first.
    """
    event = -1
    part = 2.0
    for k in range(joints):
        start, end = records.contacts[k].sliding, system.contacts[k].sliding
        for down in range(2):
            sense = 1.0 - 2.0 * down
            number = first + 2 * k + down
            if records.onset[k] <= 0.0 or number == excluded:
                continue
            ahead = sense * (corner_ahead(start, sense, system.packed.joints[k].friction) - start)
            way = sense * (end - start)
            if way > ahead + 2.0 * BEHIND and ahead < part * way:
                event, part = number, ahead / way
    return event, part


@compiled
def first_change(
    loads: Loads | None,
    system: System,
    tableau: Tableau | None,
    motion: Integration,
    t: float,
    h: float,
    excluded: int | np.int64,
) -> tuple[int, float]:
    """Change of a load's law that comes first in a trial step, and at which part; or -1.

    Where there are loads the state of all bodies is that at the end of the step afterwards.

    Parameters
    ----------
    excluded : int
        Event that is ignored.
    """
    event = -1
    part = 2.0
    if loads is None:
        return event, part
    reach_end(system, tableau, motion, t, h)
    q, v, a, _, _ = system.state
    joints = system.contacts.shape[0]
    for k in range(joints, joints + count_transitions(loads)):
        value, rate = transition_value(loads, k - joints, q, v, a)
        if k == excluded or value == -math.inf:
            continue
        start, first_rate, _, _ = transition_at_start(loads, k - joints, 0.0)
        # What goes no further behind is round-off, or comes with that on which the step ends.
        reach = 2.0 * BEHIND
        s = crossing(min(start, 0.0) - reach, first_rate, value - reach, rate, h)
        comes_back = first_rate > 0.0 or value - reach > MAX_BEHIND
        if s < part and (s * h > MIN_SEPARATION or comes_back):
            event, part = k, s
    return event, part


@compiled
def first_event(
    system: System,
    tableau: Tableau | None,
    records: RecorderState,
    control: Records,
    motion: Integration,
    t: float,
    h: float,
    excluded: int | np.int64,
    joints: int,
) -> tuple[int, float]:
    """Joint that touches down or separates first in a trial step, and at which part; or -1.

    Slopes were last evaluated at the end of the step.

    Where a load's law changes sooner, or friction's, it is that event; see ``first_change`` and
    ``first_corner``.

    Parameters
    ----------
    joints : int
        Number of joints whose events are located, from the first.
    """
    event = -1
    part = 2.0
    for k in range(joints):
        if k == excluded:
            continue
        memory = records.memory[k]
        depth, rate = system.contacts[k].penetration, system.contacts[k].rate
        sign = -1.0 if records.onset[k] > 0.0 else 1.0
        start = min(sign * memory.penetration, 0.0)
        s = crossing(start, sign * memory.rate, sign * depth, sign * rate, h)
        # A state that was just placed on an event moves away from it and does not repeat it, but
        # where it is drawn back at once.
        comes_back = sign * memory.rate > 0.0 or sign * depth > DEPTH_TOL
        if s < part and (s * h > MIN_SEPARATION or comes_back):
            event, part = k, s
    k, s = first_change(system.packed.loads, system, tableau, motion, t, h, excluded)
    if s < part:
        event, part = k, s
    if tableau is not None and tableau.ends_at_corners and not control[0].past_corners:
        k, s = first_corner(system, records, first_of_corners(system), excluded, joints)
        if s < part:
            event, part = k, s
    return event, part


@compiled
def trial_step(
    system: System,
    tableau: Tableau | None,
    records: RecorderState,
    control: Records,
    motion: Integration,
    t: float,
    h: float,
) -> float:
    """Make one trial step, without a tableau a classical one; returns its error, 1 is allowed."""
    # The compiler leaves out the branch that is not taken.
    if tableau is None:
        control[0].evaluations += CLASSICAL_STAGES
        classical_step(system, records.onset, motion, t, h)
        return 0.0
    control[0].evaluations += tableau.b.shape[0]
    return embedded_step(system, tableau, records.onset, motion, t, h)


@compiled
def locate(
    system: System,
    tableau: Tableau | None,
    records: RecorderState,
    control: Records,
    motion: Integration,
    t: float,
    k: int,
    h: float,
    part: float,
) -> tuple[float, bool]:
    """Find the length of the step that ends on event ``k``, if any.

    A joint then has zero penetration, a load is just behind the change of its law.

    Newton's method, held between the ends of a step of length ``h``: where the surface is
    steep it would stray to lengths whose error nobody has looked at.

    Parameters
    ----------
    part : float
        Part of the step to look at first.
    """
    aim, near, accepted = 0.0, EVENT_DEPTH, DEPTH_TOL
    if k >= system.contacts.shape[0]:
        aim, near, accepted = BEHIND, 0.5 * BEHIND, MAX_BEHIND
    low, high = 0.0, h
    following = part * h
    further = SHORTEST_MOVE
    is_last = False
    for _ in range(NEWTON_STEPS):
        # The state is that of the length tried last, however the search ends.
        length = following
        trial_step(system, tableau, records, control, motion, t, length)
        value, rate = event_value(system, tableau, records, motion, k, t, length)
        value -= aim
        if abs(value) <= near or is_last:
            break
        if value > 0.0:
            high = length
        else:
            low = length
        following = length - value / rate if rate != 0.0 else -1.0
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - length) <= SHORTEST_MOVE:
            if aim == 0.0 or value > 0.0:
                break
            # Round-off keeps it from ending just behind: the nearest that is behind.
            following = min(length + further, high)
            further *= 4.0
            is_last = following == high
    if aim > 0.0:
        return length, -near <= value <= accepted
    return length, abs(value) <= accepted


@compiled
def last_slope(tableau: Tableau | None) -> int:
    """Return the index of the slope at the end of a step."""
    if tableau is None:
        return CLASSICAL_STAGES - 1
    return tableau.b.shape[0]


@compiled
def end_on_event(
    system: System,
    tableau: Tableau | None,
    records: RecorderState,
    control: Records,
    motion: Integration,
    t: float,
    h: float,
    k: int,
    part: float,
    joints: int,
) -> tuple[int, float, bool]:
    """Find the step that ends on the first event of a trial step of length ``h``.

    Parameters
    ----------
    k, part, joints : int, float, int
        The event as returned by ``first_event``, and the joints that are looked at.

    Returns
    -------
    tuple
        The event, the length of the step, s, and whether it was located.
    """
    located, is_located, earlier = h, True, k
    # The cubics may see events of two joints in the wrong order.
    for _ in range(1 + first_of_corners(system) + 2 * system.contacts.shape[0]):
        if earlier < 0:
            break
        k = earlier
        located, is_located = locate(system, tableau, records, control, motion, t, k, located, part)
        if not is_located:
            break
        earlier, part = first_event(
            system, tableau, records, control, motion, t, located, k, joints
        )
    return k, located, is_located


@compiled
def switch(system: System, records: RecorderState, k: int, t: float) -> float:
    """Open or close joint ``k`` in the state on its event; returns its closing speed, m/s."""
    rate = system.contacts[k].rate
    if records.onset[k] > 0.0:
        separate(
            records.memory[k],
            records.counters[k],
            records.stored_contacts[k],
            records.onset[k],
            t,
            rate,
            0,
        )
        records.onset[k] = HELD_OPEN
    else:
        records.onset[k] = max(rate, 1e-300)
        touch_down(records.memory[k], t, False)
    return rate
