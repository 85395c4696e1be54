"""States of interactions over a step, such as bristle deflections."""

import math

from presswear.engines.exudyn_joints.body_state import BodyState, fill_forces
from presswear.physics.equations.function import ACCELERATIONS, END
from presswear.physics.touchdown import joint_crossing
from presswear.recording.recorder_state import RecorderState
from presswear.tools.compile import compiled

# First of the three rows of ``BodyState.states`` at the start and at the end of a step:
# value, rate, and derivative of the rate by the value
STEP_START = 0
STEP_END = 3
# Rate and derivative, counted from the first row
RATE = 1
SLOPE = 2


@compiled
def exponential_step(value: float, rate: float, slope: float, h: float) -> float:
    """Return the solution z(h) of z' = rate + slope (z - value) with z(0) = value."""
    return value + rate * (math.expm1(slope * h) / slope if slope != 0.0 else h)


@compiled
def next_state(
    body_state: BodyState, records: RecorderState, i: int, t: float
) -> float:
    """Return state ``i`` at the end of a step, from the rates at both ends of the step.

    The rate is linear in the state. The exponential step does not oscillate for a stiff
    state, as the trapezoidal rule would. A step in which the pin touches down or
    separates is divided at this event.
    """
    joint = body_state.state_joints[i]
    contacts = body_state.model.contact_records
    start, start_rate, start_slope, end, end_rate, end_slope = body_state.states[:, i]
    h = t - records.output[0].now
    fraction = 2.0
    if joint >= 0:
        last = records.memory[joint]
        is_closed = last.penetration > 0.0
        fraction = joint_crossing(last, contacts[joint], is_closed, h)[0]
    if fraction < 1.0:
        value = exponential_step(start, start_rate, start_slope, fraction * h)
        rate = end_rate + end_slope * (value - end)
        return exponential_step(value, rate, end_slope, (1.0 - fraction) * h)
    mean_rate = 0.5 * (start_rate + end_rate + end_slope * (start - end))
    mean_slope = 0.5 * (start_slope + end_slope)
    return exponential_step(start, mean_rate, mean_slope, h)


@compiled
def linearise_states(body_state: BodyState, t: float, row: int) -> None:
    """Fill states, rates and derivatives of the rates into three rows, from ``row`` on.

    The forces must be filled before the call. They are those of changed states
    afterwards, because the derivatives are finite differences.
    """
    first = body_state.layout.first_state
    states = body_state.states
    for i in range(body_state.scales.shape[0]):
        states[row, i] = body_state.y[first + i]
        states[row + RATE, i] = body_state.rates[first + i]
        body_state.y[first + i] += body_state.scales[i]
    fill_forces(body_state, t, ACCELERATIONS)
    for i in range(body_state.scales.shape[0]):
        change = body_state.rates[first + i] - states[row + RATE, i]
        states[row + SLOPE, i] = change / body_state.scales[i]
        body_state.y[first + i] = states[row, i]


@compiled
def fill_end_forces(
    body_state: BodyState, records: RecorderState, t: float, level: int
) -> None:
    """Fill the forces at the end of a step, with the states of interactions at that time."""
    count = body_state.scales.shape[0]
    if count > 0:
        fill_forces(body_state, t, END)
        linearise_states(body_state, t, STEP_END)
        first = body_state.layout.first_state
        for i in range(count):
            body_state.y[first + i] = next_state(body_state, records, i, t)
    fill_forces(body_state, t, level)


@compiled
def start_states(body_state: BodyState, t: float) -> None:
    """Store the states of interactions at the start of a step; forces were filled at level END."""
    if body_state.scales.shape[0] > 0:
        linearise_states(body_state, t, STEP_START)
        fill_forces(body_state, t, END)
