"""Kernels of the open tree: forces of a stage, and accepted steps.

Exudyn's DOPRI5 evaluates seven stages in a step, the last at the end of the step. Each
stage fills a row of rates. Work, losses, torques and wear are the sums of these rows
with the weights of the method, and have its order. Steps end at changes of a law of
force: predicted touchdowns, separations, and changes of the laws of loads.
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.physics.contact import acceleration_in_gap
from presswear.physics.dormand_prince import DOPRI5
from presswear.physics.drive_motion import step_to_break
from presswear.physics.equations.function import (
    ACCELERATIONS,
    END,
    RATES,
    Written,
    fill,
)
from presswear.physics.equations.layout import (
    POWER,
    POWER_SQUARE,
    PRESSURE,
    TORQUE,
    TORQUE_INTEGRALS,
    TORQUE_SQUARE,
    WEAR_INTEGRAL_COUNT,
    WORK,
    Layout,
)
from presswear.physics.event_time import step_to_event, time_across, time_to_event
from presswear.physics.load_transitions import (
    count_transitions,
    next_break,
    settle_loads,
    transition_at_start,
    transition_of,
)
from presswear.physics.packed import Packed
from presswear.physics.step_length import contact_step, longest_step
from presswear.physics.touchdown import settle
from presswear.recording.nominal_time import section_at_start
from presswear.recording.observe import StepObserver, observe
from presswear.recording.recorder_state import RecorderState
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, all_finite, compiled, copy_to, inlined
from presswear.tools.packing import PackedArguments, unpack

WEIGHTS = np.append(DOPRI5.b, 0.0)  # weights of the seven stages of DOPRI5
STAGES = WEIGHTS.size
GROWTH = 5.0  # largest ratio of a step to the previous one
# Least number of steps of a resolved contact, over the steps of a free impact. The peak
# of a contact with fewer steps could be missed. It is below 1 because a bump of a worn
# surface can shorten a contact, which the error control then resolves.
RESOLVED = 1.0 / 3.0
# Change of the penetration between a touchdown or separation and the end of the step, m;
# change of a switching function of a load, m, rad, m/s or rad/s
LANDING_DEPTH = 1e-11
# Largest time from a touchdown to the end of the step, over the duration of the contact
LANDING_FRACTION = 1e-3
# Uncertainty of a predicted time, as a fraction of it, while the change of acceleration
# is unknown
PREDICTION_TOL = 0.05

# State of the choice of steps
PACE = np.dtype(
    [
        ("longest", np.float64),  # step, s
        ("shortest", np.float64),  # step, s
        ("parts", np.float64),  # least number of steps in a free impact
        ("reach", np.float64),  # last step that no event has shortened, s
        ("limit", np.float64),  # upper limit of the present step, s
        ("cut", np.bool_),  # the limit is that of an event
        ("to_break", np.bool_),  # the limit is a break in the motion of a drive
        ("smooth", np.bool_),  # no event was in the last step
        ("evaluations", np.int64),
        ("accepted", np.int64),  # evaluations up to the last accepted step
        ("events", np.int64),
        ("deepest_touch", np.float64),  # penetration of the first state in a contact, m
    ]
)


class TreeSystem(NamedTuple):
    """Open tree for the kernels, with Exudyn's live state and working space."""

    equations: Written  # with the forces on the coordinates
    observer: StepObserver
    # live arrays of Exudyn, each (coordinates,)
    x: Array  # coordinates
    u: Array  # rates
    u_t: Array  # accelerations
    states: Array  # live states of interactions, m, (states,)
    force: Array  # forces for Exudyn, (coordinates,)
    # closing speeds at touchdown in the next step, m/s; predicted for open joints
    expected: Array
    pace: Records  # one of PACE
    q: Array  # coordinates, rates and accelerations of all bodies, (3 bodies,)
    v: Array
    a: Array
    y: Array  # state vector of the equations, (m,)
    # rates of the state vector in the stages, then forces on the coordinates, (7, m +
    # coordinates)
    stages: Array
    out: Array  # the same in one state that is no stage
    start: Array  # coordinates and rates at the start of a step, (2, coordinates)
    start_states: Array  # states of interactions at the start of a step, m, (states,)
    layout: Layout  # layout of y


@inlined
def fill_state(y: Array, x: Array, u: Array, states: Array) -> None:
    """Fill the state vector of the equations."""
    n = x.shape[0]
    copy_to(y[:n], x)
    copy_to(y[n : 2 * n], u)
    copy_to(y[2 * n : 2 * n + states.shape[0]], states)


@compiled
def stage_forces(address: PackedArguments, t: float) -> int:
    """Fill the forces on the coordinates of the tree in a stage, without those of inertia.

    ``address`` packs TreeSystem and RecorderState.

    Returns the number of stages since the last accepted step.
    """
    system, _ = unpack(address)
    pace = system.pace[0]
    stage = pace.evaluations % STAGES
    row = system.stages[stage]
    level = RATES if WEIGHTS[stage] != 0.0 else ACCELERATIONS
    pace.evaluations += 1
    fill_state(system.y, system.x, system.u, system.states)
    fill(system.equations, t, system.y, row, level)
    copy_to(system.force, row[system.y.shape[0] :])
    return pace.evaluations - pace.accepted


@compiled
def stage_states(address: PackedArguments, t: float) -> None:
    """Fill the rates of the states of interactions in a stage, m/s.

    ``address`` packs TreeSystem and these rates, shape (states,).
    """
    system, rates = unpack(address)
    fill_state(system.y, system.x, system.u, system.states)
    fill(system.equations, t, system.y, system.out, ACCELERATIONS)
    copy_to(rates, system.out[system.layout.first_state : system.layout.first_energy])


@compiled
def step_to_changes(packed: Packed, smooth: bool, t: float, h: float) -> float:
    """Return the step, s, no longer than ``h``, that ends on the next change of a load's law."""
    h = min(h, next_break(packed.loads) - t)
    for k in range(count_transitions(packed.loads)):
        i, transition = transition_of(k)
        load = packed.loads.records[i]
        mode = packed.loads.modes[i]
        change = 1.0 if smooth else 0.0
        p, r, a, j = transition_at_start(load, mode, transition, change)
        if p != -math.inf:
            h = step_behind(min(p, 0.0), (r, a, j), smooth, h)
    return h


@compiled
def step_behind(
    value: float, derivatives: tuple[float, float, float], smooth: bool, h: float
) -> float:
    """Return the step, s, no longer than ``h``, that ends where a quantity below 0 reaches it.

    It ends just after that instant, because a smaller change is round-off. While the
    prediction is uncertain it ends earlier.
    """
    r, a, j = derivatives
    arrival, speed, uncertainty = time_to_event(value - LANDING_DEPTH, r, a, j)
    if arrival <= h and speed > 0.0:
        if not smooth:
            uncertainty = max(uncertainty, PREDICTION_TOL * arrival)
        is_near = uncertainty * speed <= 0.5 * LANDING_DEPTH
        h = min(h, step_to_event(arrival, uncertainty, is_near, 0.0, False))
    return h


@compiled
def step_to_section(records: RecorderState, smooth: bool, h: float) -> float:
    """Return the step, s, no longer than ``h``, that ends with a section that ends at an angle."""
    p, r, a, j = section_at_start(records.nominal, smooth)
    # A section that has ended is left by the engine.
    return step_behind(p, (r, a, j), smooth, h) if -math.inf < p < 0.0 else h


@compiled
def step_to_contacts(records: RecorderState, system: TreeSystem, h: float) -> float:
    """Return the step, s, no longer than ``h``, that ends on the next touchdown or separation.

    Fills ``expected`` with the closing speeds that the stages of this step use.
    """
    for k in range(records.memory.shape[0]):
        h = step_to_contact(records, system, k, h)
    return max(h, system.pace[0].shortest)


@inlined
def step_to_contact(
    records: RecorderState, system: TreeSystem, k: int, h: float
) -> float:
    """Return the step, s, no longer than ``h``, that ends on the next event of joint ``k``."""
    pace = system.pace[0]
    joint = records.packed.joints[k]
    last = records.memory[k]
    contact = records.contacts[k]
    is_closed = records.onset[k] > 0.0
    system.expected[k] = records.onset[k]
    if joint.always_closed:
        return h
    acceleration = acceleration_in_gap(
        joint, records.packed.surfaces[k], contact, system.a
    )
    jerk = 0.0
    if last.step > 0.0 and pace.smooth:
        jerk = (acceleration - last.acceleration) / last.step
    last.acceleration = acceleration
    if is_closed and last.steps == 1 and last.rate > 0.0 and acceleration < 0.0:
        last.longest_step = 2.0 * last.rate / -acceleration / pace.parts
        h = min(h, last.longest_step)
    sign = -1.0 if is_closed else 1.0
    if sign * last.penetration >= 0.0:
        return h
    arrival, speed, uncertainty = time_to_event(
        sign * last.penetration, sign * last.rate, sign * acceleration, sign * jerk
    )
    if not (is_closed or joint.is_flat):
        across, closing = time_across(contact, joint.clearance)
        if across < arrival:
            arrival = across
            speed = closing
            uncertainty = PREDICTION_TOL * across
    if arrival < 2.0 * h and not is_closed:
        system.expected[k] = max(speed, 0.0)
    if arrival > h or speed <= 0.0:
        return h
    if not pace.smooth:
        uncertainty = max(uncertainty, PREDICTION_TOL * arrival)
    is_near = uncertainty * speed <= LANDING_DEPTH
    duration = contact_step(joint, 0.0, speed, 1.0)
    margin = min(LANDING_DEPTH / speed, LANDING_FRACTION * duration)
    is_abrupt = joint.normal.abrupt and not is_closed
    return min(h, step_to_event(arrival, uncertainty, is_near, margin, is_abrupt))


@compiled
def next_tree_step(
    records: RecorderState, system: TreeSystem, t: float, h: float, events: int
) -> float:
    """Return the upper limit of the next step, s, after a step of length ``h`` to time ``t``.

    The error control of Exudyn may choose a shorter step.
    """
    pace = system.pace[0]
    if not (pace.cut and h >= 0.999 * pace.limit):
        # A step that an event has shortened does not limit the growth of the next one.
        pace.reach = max(h, pace.shortest)
    for k in range(records.memory.shape[0]):
        if records.onset[k] > 0.0 and records.memory[k].steps == 1:
            pace.deepest_touch = max(pace.deepest_touch, records.memory[k].penetration)
    pace.events += events
    # A break changes the third derivatives by which events are foreseen.
    pace.smooth = events == 0 and not (pace.to_break and h >= 0.999 * pace.limit)
    limit = longest_step(records, min(GROWTH * pace.reach, pace.longest), pace.parts)
    to_break = step_to_break(records.motions, t, limit)
    to_change = step_to_changes(records.packed, pace.smooth, t, to_break)
    to_change = step_to_section(records, pace.smooth, to_change)
    pace.limit = step_to_contacts(records, system, to_change)
    pace.cut = pace.limit < limit
    pace.to_break = to_break < limit and pace.limit == to_break
    return pace.limit


@compiled
def sum_stages(system: TreeSystem, records: RecorderState, h: float) -> None:
    """Integrate energies, wear and torques over a step of length ``h``, s, from its stages."""
    for k in range(records.memory.shape[0]):
        records.wear_integrals[k].work = records.wear_integrals[k].pressure = 0.0
    for k in range(records.drives.shape[0]):
        drive = records.drives[k]
        drive.torque_integral = drive.torque_square_integral = 0.0
        drive.work = drive.power_square_integral = 0.0
    for stage in range(STAGES):
        add_rates(system, records, system.stages[stage], h * WEIGHTS[stage])
    for k in range(records.memory.shape[0]):
        # The sum may be negative for a step at the end of a contact, because one weight
        # is negative.
        integrals = records.wear_integrals[k]
        integrals.work = max(integrals.work, 0.0)
        integrals.pressure = max(integrals.pressure, 0.0)


@compiled
def add_rates(
    system: TreeSystem, records: RecorderState, rates: Array, weight: float
) -> None:
    """Add the rates of a stage, times a weight, s, to energies, wear and torques of the step."""
    layout = system.layout
    for k in range(records.energies.shape[0]):
        records.energies[k] += weight * rates[layout.first_energy + k]
    i = layout.first_wear_integral
    for k in range(records.memory.shape[0]):
        records.wear_integrals[k].work += weight * rates[i + WORK]
        records.wear_integrals[k].pressure += weight * rates[i + PRESSURE]
        i += WEAR_INTEGRAL_COUNT
    for k in range(records.drives.shape[0]):
        drive = records.drives[k]
        drive.torque_integral += weight * rates[i + TORQUE]
        drive.torque_square_integral += weight * rates[i + TORQUE_SQUARE]
        drive.work += weight * rates[i + POWER]
        drive.power_square_integral += weight * rates[i + POWER_SQUARE]
        i += TORQUE_INTEGRALS


@compiled
def fill_motion(
    system: TreeSystem,
    records: RecorderState,
    t: float,
    x: Array,
    u: Array,
    states: Array,
) -> None:
    """Fill motion of all bodies, contacts and torques in a state of the tree."""
    fill_state(system.y, x, u, states)
    fill(system.equations, t, system.y, system.out, END)
    for k in range(records.torque.shape[0]):
        first = system.layout.first_torque + TORQUE_INTEGRALS * k
        records.torque[k] = system.out[first + TORQUE]


@compiled
def fill_start(address: PackedArguments, t: float) -> None:
    """Fill motion, contacts and torques in the state at the start of the present step.

    ``address`` packs TreeSystem and RecorderState.
    """
    system, records = unpack(address)
    x = system.start[0]
    u = system.start[1]
    fill_motion(system, records, t, x, u, system.start_states)


@compiled
def accept_tree_step(address: PackedArguments, t: float) -> float:
    """Record an accepted step and return the limit of the next, s; NaN if not finite.

    ``address`` packs TreeSystem and RecorderState.
    """
    system, records = unpack(address)
    system.pace[0].accepted = system.pace[0].evaluations
    x = system.x
    u = system.u
    if not all_finite(x, u) or not all_finite(u, system.u_t):
        return math.nan
    h = t - records.output[0].now
    if h > 0.0:
        sum_stages(system, records, h)
    fill_motion(system, records, t, x, u, system.states)
    copy_to(system.start[0], x)
    copy_to(system.start[1], u)
    copy_to(system.start_states, system.states)
    q = system.q
    v = system.v
    a = system.a
    events = settle(records, t, int(RESOLVED * system.pace[0].parts + 0.5))
    if events > 0:
        copy_to(system.expected, records.onset)
        fill_motion(system, records, t, x, u, system.states)
    events += settle_loads(records.packed.loads, t, q, v, a)
    observe(system.observer, t, h)
    return next_tree_step(records, system, t, h, events)
