"""Switching functions of the events in a step, and the first event in a trial step.

Events have numbers. First come the touchdowns and separations of the joints, then the
changes of the laws of loads, then the corners of friction: of each joint the next one
upwards and the next one downwards. The last is the end of a section of a cycle that
ends at an angle.
"""

from presswear.engines.dae.runge_kutta import SPARE, rates
from presswear.physics.dormand_prince import Tableau
from presswear.physics.friction_and_normal import corner_ahead
from presswear.physics.load_transitions import (
    count_transitions,
    transition_of,
    transition_value,
)
from presswear.physics.touchdown import (
    is_reversed,
    joint_crossing,
    load_crossing,
    seen_from_opposite,
)
from presswear.recording.nominal_time import section_crossing, section_value
from presswear.tools.compile import Records, compiled, inlined
from presswear.tools.packing import PackedArguments, unpack

# Time after which an event is not the one on which the last step ended, s
MIN_SEPARATION = 1e-14
# A step that ends on a transition of a load, or at the end of a section, passes it by
# this distance, m, rad, m/s or rad/s
BEHIND = 1e-13
MAX_BEHIND = 1e-9  # largest such distance, if round-off allows no smaller one
NEVER = 2.0  # fraction of a step before an event that does not happen in it


@compiled
def reach_end(
    address: PackedArguments, classical: int | None, t: float, h: float
) -> None:
    """Fill the state of all bodies at the end of a trial step, with accelerations."""
    # An embedded method evaluates its last slopes there.
    if classical is not None:
        (run,) = unpack(address)
        rates(address, t + h, run.motion.trial, SPARE)


@compiled
def event_value(
    address: PackedArguments, classical: int | None, event: int, t: float, h: float
) -> tuple[float, float]:
    """Return the switching function of an event at the end of a trial step, and its rate.

    The slopes must have been evaluated in that state last.
    """
    (run,) = unpack(address)
    system = run.system
    joints = system.contacts.shape[0]
    transitions = count_transitions(system.packed.loads)
    first_corner = joints + transitions
    if event < joints:
        return joint_value(address, event)
    if event < first_corner:
        reach_end(address, classical, t, h)
        q = system.q
        v = system.v
        a = system.a
        i, transition = transition_of(event - joints)
        loads = system.packed.loads
        return transition_value(loads.records[i], loads.modes[i], transition, q, v, a)
    if event == first_corner + 2 * joints:
        reach_end(address, classical, t, h)
        q = system.q
        v = system.v
        return section_value(run.records.nominal, q, v)
    return corner_value(address, event - first_corner, h)


@compiled
def joint_value(address: PackedArguments, joint: int) -> tuple[float, float]:
    """Return the distance of a joint past its touchdown or separation, m, and its rate."""
    (run,) = unpack(address)
    contact = run.system.contacts[joint]
    if run.records.onset[joint] <= 0.0:
        return contact.penetration, contact.rate
    if is_reversed(run.records.memory[joint], contact):
        opposite = seen_from_opposite(contact.penetration, contact.eccentricity)
        return -opposite, contact.rate
    return -contact.penetration, -contact.rate


@inlined
def corner_of(corner: int) -> tuple[int, float]:
    """Return joint and sense, 1 upwards and -1 downwards, of a corner of friction."""
    return corner // 2, 1.0 if corner % 2 == 0 else -1.0


@compiled
def corner_value(
    address: PackedArguments, corner: int, h: float
) -> tuple[float, float]:
    """Return the sliding past a corner of friction, m/s, and its mean rate over the step."""
    (run,) = unpack(address)
    joint, sense = corner_of(corner)
    start = run.records.contacts[joint].sliding
    end = run.system.contacts[joint].sliding
    speed = corner_ahead(start, sense, run.system.packed.joints[joint].friction)
    # The sliding speed is nearly linear in a step.
    return sense * (end - speed), sense * (end - start) / h


@compiled
def is_repeated(
    last: Records,
    is_closed: bool,
    after: float,
    value: float,
    rate: float,
    resolution: float,
) -> bool:
    """Return whether a crossing is the event on which the last step ended, seen once more.

    A joint moves away from the event on which the last step ended. Only round-off makes
    it cross the event again, by less than ``resolution``, the round-off of the
    coordinates, m. ``value`` and ``rate`` are those of ``joint_crossing``; ``after`` is
    the time from the start of the step, s.
    """
    if rate > 0.0:
        return False
    if value <= 0.0:
        return after <= MIN_SEPARATION
    start = -last.penetration if is_closed else last.penetration
    return value <= max(start, 0.0) + resolution


@compiled
def first_event(
    address: PackedArguments,
    tableau: Tableau | None,
    t: float,
    h: float,
    excluded: int,
    joints: int,
) -> tuple[int, float]:
    """Return the first event in a trial step, or -1, and the fraction of the step before it.

    The slopes must have been evaluated at the end of the step. Only the first
    ``joints`` joints are searched.  ``excluded`` is the event on which the step ends.
    """
    (run,) = unpack(address)
    loads = run.system.packed.loads
    event, fraction = first_of_joints(address, h, excluded, joints)
    has_leader = run.records.nominal[0].column >= 0
    if count_transitions(loads) > 0 or has_leader:
        reach_end(address, run.classical, t, h)
        earlier, fraction = first_of_loads(address, h, excluded, fraction)
        if earlier >= 0:
            event = earlier
    if tableau is None or not tableau.ends_at_corners:
        return event, fraction
    if not run.control[0].ignores_corners:
        earlier, fraction = first_of_corners(address, excluded, joints, fraction)
        if earlier >= 0:
            event = earlier
    return event, fraction


@compiled
def first_of_joints(
    address: PackedArguments, h: float, excluded: int, joints: int
) -> tuple[int, float]:
    """Return the first touchdown or separation in a trial step; see ``first_event``."""
    (run,) = unpack(address)
    system = run.system
    records = run.records
    resolution = run.control[0].resolution
    event = -1
    fraction = NEVER
    for k in range(joints):
        if k == excluded or system.packed.joints[k].always_closed:
            continue
        last = records.memory[k]
        is_closed = records.onset[k] > 0.0
        s, value, rate, _ = joint_crossing(last, system.contacts[k], is_closed, h)
        if s < fraction and not is_repeated(
            last, is_closed, s * h, value, rate, resolution
        ):
            event = k
            fraction = s
    return event, fraction


@compiled
def first_of_loads(
    address: PackedArguments, h: float, excluded: int, latest: float
) -> tuple[int, float]:
    """Return the first end of a section, or change of a load's law, before a fraction of the step.

    Without one, returns -1 and the fraction ``latest``.
    """
    (run,) = unpack(address)
    system = run.system
    nominal = run.records.nominal
    loads = system.packed.loads
    joints = system.contacts.shape[0]
    transitions = count_transitions(loads)
    section = joints + transitions + 2 * joints
    q = system.q
    v = system.v
    a = system.a
    event = -1
    fraction = latest
    if nominal[0].column >= 0 and excluded != section:
        s = section_crossing(nominal, q, v, h, 2.0 * BEHIND)
        if s < fraction:
            event = section
            fraction = s
    for k in range(transitions):
        if joints + k == excluded:
            continue
        # A smaller value is round-off, or belongs to the event on which the step ends.
        i, transition = transition_of(k)
        load = loads.records[i]
        mode = loads.modes[i]
        s, value, rate = load_crossing(load, mode, transition, q, v, a, h, 2.0 * BEHIND)
        is_new = s * h > MIN_SEPARATION or rate > 0.0 or value > MAX_BEHIND
        if s < fraction and is_new:
            event = joints + k
            fraction = s
    return event, fraction


@compiled
def first_of_corners(
    address: PackedArguments, excluded: int, joints: int, latest: float
) -> tuple[int, float]:
    """Return the first corner of friction in closed joints before a fraction of the step.

    Without one, returns -1 and the fraction ``latest``.
    """
    (run,) = unpack(address)
    system = run.system
    records = run.records
    first_corner = system.contacts.shape[0] + count_transitions(system.packed.loads)
    event = -1
    fraction = latest
    for k in range(2 * joints):
        joint, sense = corner_of(k)
        if records.onset[joint] <= 0.0 or first_corner + k == excluded:
            continue
        start = records.contacts[joint].sliding
        end = system.contacts[joint].sliding
        speed = corner_ahead(start, sense, system.packed.joints[joint].friction)
        to_corner = sense * (speed - start)
        to_end = sense * (end - start)
        if to_end > to_corner + 2.0 * BEHIND and to_corner < fraction * to_end:
            event = first_corner + k
            fraction = to_corner / to_end
    return event, fraction
