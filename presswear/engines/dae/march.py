"""The run loops: error-controlled with located events, and with equal steps.

Events are touchdowns, separations, corners of friction laws and transitions of loads. A
trial step that contains an event is repeated with shorter lengths until it ends at the
event, so that no step crosses a change of the equations. Equal steps are cut in two at
a transition of a load; contacts change between equal steps only.
"""

from presswear.engines.dae.accepted_step import (
    finish_step,
    hold_open,
    keep_constraints,
    settle_joints,
    start_march,
)
from presswear.engines.dae.dynamics import evaluate_forces
from presswear.engines.dae.event_search import search_event, start_search
from presswear.engines.dae.runge_kutta import (
    SPARE,
    START,
    classical_step,
    embedded_step,
    rates,
)
from presswear.physics.contact import copy_contacts
from presswear.physics.dormand_prince import Tableau
from presswear.physics.drive_motion import step_to_break
from presswear.physics.equations.function import END
from presswear.physics.load_transitions import (
    count_transitions,
    next_break,
    settle_loads,
)
from presswear.physics.step_length import longest_step
from presswear.physics.touchdown import LEAST_STEPS, settle
from presswear.recording.nominal_time import time_left
from presswear.tools.compile import Records, compiled, copy_to
from presswear.tools.packing import PackedArguments, unpack

RUNNING, DONE, BROKEN, STUCK, TRYING = range(5)

# Next step over the step with the allowed error
SAFETY = 0.9
# Limits of the next step over the last step
MIN_FACTOR = 0.2
MAX_FACTOR = 5.0
MAX_FINITE = 1e30  # larger numbers of a state or an error count as infinite
MIN_PART = 1e-9  # a shorter part of an equal step up to the end is round-off


@compiled
def march_controlled(address: PackedArguments, end: float) -> int:
    """Integrate towards ``end``, s, for at most ``control.most`` steps; return the status."""
    (run,) = unpack(address)
    tableau = run.tableau
    classical = run.classical
    state = run.control[0]
    start_march(address)
    hold_open(run.records.onset)
    for _ in range(state.most):
        if not propose_step(address, end):
            return DONE
        status = TRYING
        while status == TRYING:
            error = embedded_step(address, tableau, state.time, state.length)
            status = judge_step(address, tableau, classical, error, end)
        if status != RUNNING:
            return status
    return RUNNING


@compiled
def propose_step(address: PackedArguments, end: float) -> bool:
    """Choose the next trial step towards ``end``; return False at the end."""
    (run,) = unpack(address)
    records = run.records
    state = run.control[0]
    t = state.time
    remaining = time_left(records.nominal, t, end)
    if remaining <= 0.0:
        return False
    longest = longest_step(records, state.longest, state.parts)
    h = step_to_break(records.motions, t, min(state.step, longest))
    h = min(h, remaining)
    h = min(h, next_break(run.system.packed.loads) - t)
    state.reaches_end = h >= remaining
    start_search(run.control, h)
    return True


@compiled
def judge_step(
    address: PackedArguments,
    tableau: Tableau,
    classical: int | None,
    error: float,
    end: float,
) -> int:
    """Accept a trial step, shorten it, or search for the event that ends it.

    Returns TRYING if the step is to be repeated with another length, and RUNNING if a
    new one is to be proposed.
    """
    (run,) = unpack(address)
    joints = run.system.contacts.shape[0]
    state = run.control[0]
    state.evaluations += run.last
    if state.searches == 0:
        if not error <= 1.0:
            return reject_step(run.control, tableau, error)
        factor = MAX_FACTOR
        if error != 0.0:
            factor = SAFETY * error**tableau.exponent
        state.step = state.whole * min(max(factor, MIN_FACTOR), MAX_FACTOR)
    if search_event(address, tableau, classical, state.time, joints):
        return TRYING
    if not state.is_located:
        first_corner = joints + count_transitions(run.system.packed.loads)
        return reject_event(run.control, first_corner, joints)
    accept_step(address, end)
    return RUNNING


@compiled
def reject_step(control: Records, tableau: Tableau, error: float) -> int:
    """Shorten a step whose error is too large; return the status."""
    state = control[0]
    state.rejected += 1
    factor = MIN_FACTOR
    is_finite = error < MAX_FINITE
    if is_finite:
        factor = max(MIN_FACTOR, SAFETY * error**tableau.exponent)
    state.step = state.whole * factor
    if state.step > state.shortest:
        return RUNNING
    return STUCK if is_finite else BROKEN


@compiled
def reject_event(control: Records, first_corner: int, joints: int) -> int:
    """Shorten a step if the event of its cubic interpolant is not found; return the status.

    The interpolant of a shorter step is more accurate. If the event is a corner of
    friction, the step keeps its length and corners are ignored in it, because the
    sliding speed of a pin that hardly presses on a worn arc is round-off.
    """
    state = control[0]
    state.ignores_corners = first_corner <= state.event < first_corner + 2 * joints
    state.rejected += 1
    state.step = state.whole if state.ignores_corners else 0.5 * state.whole
    return RUNNING if state.step > state.shortest else STUCK


@compiled
def accept_step(address: PackedArguments, end: float) -> None:
    """Accept the state at the end of a trial step, and settle loads and contacts."""
    (run,) = unpack(address)
    system = run.system
    motion = run.motion
    state = run.control[0]
    event = state.event
    h = state.length
    if event >= 0:
        state.events += 1
    state.ignores_corners = False
    t = end if state.reaches_end and event < 0 else state.time + h
    copy_to(motion.y, motion.trial)
    q = system.q
    v = system.v
    a = system.a
    changes = settle_loads(system.packed.loads, t, q, v, a)
    changes += settle_joints(address, event, t)
    if state.projected or event >= 0 or changes > 0:
        keep_constraints(system.constraints, state.projected, t, motion.y)
        rates(address, t, motion.y, START)
        state.evaluations += 1
    else:
        copy_to(motion.slopes[0], motion.slopes[run.last])
    finish_step(address, system.constraints, t, h)


@compiled
def march_fixed(address: PackedArguments, end: float) -> int:
    """Integrate with equal steps of order 4; contact state changes between steps only."""
    (run,) = unpack(address)
    motion = run.motion
    n = run.system.layout.coordinates
    state = run.control[0]
    start_march(address)
    for _ in range(state.most):
        t = state.time
        remaining = time_left(run.records.nominal, t, end)
        if remaining <= MIN_PART * state.step:
            return DONE
        length = state.step
        if state.due > t:  # the last step was cut
            length = state.due - t
        length = min(length, remaining)
        h = fixed_step(address, t, length)
        for i in range(2 * n):
            if not abs(motion.trial[i]) < MAX_FINITE:
                return BROKEN
        copy_to(motion.y, motion.trial)
        # The next step ends where a step that was cut would have ended.
        state.due = t + length if h < length else 0.0
        step_end = end if h >= remaining else t + h
        accept_fixed_step(address, step_end, h)
    return RUNNING


@compiled
def fixed_step(address: PackedArguments, t: float, longest: float) -> float:
    """Make a trial step up to the first change of a load's law; return its length, s."""
    (run,) = unpack(address)
    state = run.control[0]
    h = step_to_break(run.records.motions, t, longest)
    h = min(h, next_break(run.system.packed.loads) - t)
    classical_step(address, t, h)
    start_search(run.control, h)
    while search_event(address, run.tableau, run.classical, t, 0):
        classical_step(address, t, state.length)
    if not state.is_located:
        classical_step(address, t, h)
    elif state.event >= 0:
        h = state.length
        state.events += 1
    return h


@compiled
def accept_fixed_step(address: PackedArguments, t: float, h: float) -> None:
    """Settle loads and contacts in the state ``motion.y`` at the end of a step of length ``h``."""
    (run,) = unpack(address)
    system = run.system
    records = run.records
    motion = run.motion
    q = system.q
    v = system.v
    a = system.a
    if system.constraints is None:
        rates(address, t, motion.y, SPARE)
    else:
        # The accelerations are those of the last stage, because multipliers take long.
        evaluate_forces(system, t, motion.y, motion.slopes[SPARE], END)
    settle_loads(system.packed.loads, t, q, v, a)
    copy_contacts(records.contacts, system.contacts)
    settle(records, t, LEAST_STEPS)
    keep_constraints(system.constraints, run.control[0].projected, t, motion.y)
    rates(address, t, motion.y, START)
    finish_step(address, system.constraints, t, h)
