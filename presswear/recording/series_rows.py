"""Rows of the series: when they are due, and what they hold."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.constraints import lever
from presswear.physics.load_transitions import last_change
from presswear.recording.columns import (
    ACCELERATION,
    DISPLACEMENT,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    JOINT_SERIES_COUNT,
    LEADER_SERIES_COUNT,
    NORMAL,
    PENETRATION,
    SERIES_COUNT,
    SLIDING,
    TANGENTIAL,
    TIME,
    VELOCITY,
)
from presswear.recording.recorder_state import RecorderState
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined

ROWS_AT_LEAST = 2000  # series rows in a cycle without contact
ROWS_AT_MOST = 40_000  # room for series rows, per recorded cycle
ROWS_IN_ALL = 4_000_000  # room for series rows, of all recorded cycles
CONTACTS_AT_MOST = 5000  # room for single contacts, per joint and recorded cycle
# Change of a force after which a row is written, as a fraction of its peak so far
FORCE_STEP = 0.02
FRAME_ROWS = 40  # smallest number of rows in a period of an elastic frame


@inlined
def is_row_due(records: RecorderState, t: float) -> bool:
    """Return whether the present state is a row of the series.

    A row is due if the longest time between two rows has passed, if a force has changed
    sufficiently since the last row, or if the law of a load has changed.
    """
    state = records.output[0]
    series = records.series
    row = state.rows
    if row >= min(state.room, series.shape[0]):
        return False
    if row == 0 or t - state.last_time >= state.interval:
        return True
    for k in range(records.contacts.shape[0]):
        written = series[row - 1, SERIES_COUNT + JOINT_SERIES_COUNT * k + NORMAL]
        change = abs(records.contacts[k].normal - written)
        if change > state.force_step * records.counters[k].peak_force:
            return True
    return last_change(records.packed.loads) == t


@compiled
def write_row(records: RecorderState) -> None:
    """Write the present state as a row of the series."""
    state = records.output[0]
    series = records.series
    contacts = records.contacts
    row = series[state.rows]
    row[TIME] = state.now
    row[DISPLACEMENT] = state.place - state.start
    row[VELOCITY] = state.velocity
    row[ACCELERATION] = state.acceleration
    for k in range(contacts.shape[0]):
        contact = contacts[k]
        joint = row[SERIES_COUNT + JOINT_SERIES_COUNT * k :]
        joint[ECCENTRICITY_X] = contact.eccentricity_x
        joint[ECCENTRICITY_Y] = contact.eccentricity_y
        joint[PENETRATION] = contact.penetration
        joint[NORMAL] = contact.normal
        joint[TANGENTIAL] = contact.tangential
        joint[SLIDING] = contact.sliding
    first = SERIES_COUNT + JOINT_SERIES_COUNT * contacts.shape[0]
    last = row.shape[0]
    if records.nominal[0].column >= 0:
        last -= LEADER_SERIES_COUNT
        row[last] = records.nominal[0].now
        row[last + 1] = records.nominal[0].rate
    for column in range(first, last):
        row[column] = records.torque[column - first]
    state.rows += 1
    state.last_time = state.now


@compiled
def note_stretches(
    guides: Records, pins: Records, stretches: Array, row: int, q: Array
) -> None:
    """Write the stretches of guides with a spring and of elastic pins into a row."""
    for k in range(guides.shape[0]):
        guide = guides[k]
        i = guide.index
        stretches[row, k] = guide.cos * q[i] + guide.sin * q[i + 1] - guide.point
    first = guides.shape[0]
    for k in range(pins.shape[0]):
        pin = pins[k]
        x, y = place_in(pin.second, pin.second_x, pin.second_y, q)
        bearing_x, bearing_y = place_in(pin.first, pin.first_x, pin.first_y, q)
        stretches[row, first + k] = math.hypot(x - bearing_x, y - bearing_y)


@inlined
def place_in(body: int, x: float, y: float, q: Array) -> tuple[float, float]:
    """Return the place of a point of a body, m; ``body`` is the place of its x in q."""
    dx, dy = lever(body, x, y, q)
    if body < 0:
        return dx, dy
    return q[body] + dx, q[body + 1] + dy


@compiled
def note_turns(
    angle_indices: NDArray[np.int64], turns: Array, row: int, q: Array, v: Array
) -> None:
    """Write angles and speeds of the drives of a linkage with a motor into a row."""
    for k in range(angle_indices.shape[0]):
        turns[row, 0, k] = q[angle_indices[k]]
        turns[row, 1, k] = v[angle_indices[k]]
