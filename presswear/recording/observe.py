"""Recording of an accepted step: numbers of the cycle, wear maps and series.

Memory does not grow with the number of cycles: series and single contacts are recorded
in the first cycles only; everything else is one row per cycle or a running sum.
"""

import math
from typing import NamedTuple

from presswear.physics.packed import drive_rate
from presswear.physics.pressure_wear import deposit_by_pressure
from presswear.physics.user_wear import deposit_by_law
from presswear.physics.wall_wear import deposit_on_wall
from presswear.physics.wear import deposit_in_bins, deposit_over_arc
from presswear.recording.columns import (
    CLOSED_TIME,
    CONTACTS,
    CYCLE_COUNT,
    DRIVE_CYCLE_COUNT,
    FILM_LOSS,
    FORCE_MAX,
    GIVEN,
    JOINT_CYCLE_COUNT,
    LEAST_FILM,
    LOAD_DISTANCE,
    POWER_PEAK,
    POWER_SQUARE,
    RETURNED,
    SLIDING_DISTANCE,
    TORQUE,
    TORQUE_PEAK,
    TORQUE_SQUARE,
)
from presswear.recording.film import take_frame
from presswear.recording.output_point import note_output
from presswear.recording.recorder_state import RecorderState
from presswear.recording.series_rows import (
    is_row_due,
    note_stretches,
    note_turns,
    write_row,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import call_entry, compiled, entry_of, inlined
from presswear.tools.packing import PackedArguments, pack_arguments, unpack


@compiled
def sum_drives(records: RecorderState, t: float, h: float, v: Array) -> None:
    """Integrate torque and power of the drives over a step by the trapezoidal rule."""
    half = 0.5 * h
    for k in range(records.drives.shape[0]):
        drive = records.drives[k]
        torque = records.torque[k]
        power = torque * drive_rate(records.packed.driven, records.motions, k, t, v)
        drive.torque_integral = half * (drive.torque + torque)
        drive.torque_square_integral = half * (drive.torque**2 + torque**2)
        drive.work = half * (drive.power + power)
        drive.power_square_integral = half * (drive.power**2 + power**2)


@compiled
def note_drives(records: RecorderState, t: float, h: float, v: Array) -> None:
    """Add the integrals of a step of length ``h``, s, to the cycle, and update the peaks.

    If the power changes sign in the step, the smaller of given and returned work is that
    of a power which is linear over the step. The difference of given and returned work
    is the work of the step.
    """
    first = records.cycle.shape[0] - DRIVE_CYCLE_COUNT * records.drives.shape[0]
    for k in range(records.drives.shape[0]):
        drive = records.drives[k]
        cycle = records.cycle[first + DRIVE_CYCLE_COUNT * k :]
        torque = records.torque[k]
        power = torque * drive_rate(records.packed.driven, records.motions, k, t, v)
        smaller = 0.0
        if power * drive.power < 0.0:
            least = min(abs(power), abs(drive.power))
            smaller = 0.5 * h * least * least / abs(power - drive.power)
        cycle[TORQUE] += drive.torque_integral
        cycle[TORQUE_SQUARE] += drive.torque_square_integral
        cycle[POWER_SQUARE] += drive.power_square_integral
        cycle[GIVEN] += max(drive.work, 0.0) + smaller
        cycle[RETURNED] += max(-drive.work, 0.0) + smaller
        if abs(torque) > abs(cycle[TORQUE_PEAK]):
            cycle[TORQUE_PEAK] = torque
        if abs(power) > abs(cycle[POWER_PEAK]):
            cycle[POWER_PEAK] = power
        drive.torque = torque
        drive.power = power


@inlined
def mean_size(first: float, last: float) -> float:
    """Return the mean of the absolute value of a number that changes linearly."""
    if first * last >= 0.0:
        return 0.5 * (abs(first) + abs(last))
    return 0.5 * (first * first + last * last) / abs(last - first)


@inlined
def note_joint(records: RecorderState, k: int, t: float, h: float) -> None:
    """Add the force, load and sliding distance and contacts of a joint in a step to the cycle."""
    contact = records.contacts[k]
    counts = records.counters[k]
    memory = records.memory[k]
    last = records.last[k]
    row = records.cycle[CYCLE_COUNT + JOINT_CYCLE_COUNT * k :]
    peak = max(contact.normal, memory.step_peak)
    if peak > 0.0:
        counts.peak_force = max(counts.peak_force, peak)
        memory.peak_force = max(memory.peak_force, peak)
        row[FORCE_MAX] = max(row[FORCE_MAX], peak)
    if contact.normal > 0.0:
        counts.deepest = max(counts.deepest, contact.penetration)
    closed_until = t if records.onset[k] > 0.0 else memory.separation_time
    closed_from = max(memory.touchdown_time, t - h)
    closed = max(closed_until - closed_from, 0.0)
    row[CLOSED_TIME] += closed
    row[SLIDING_DISTANCE] += closed * mean_size(last.sliding, contact.sliding)
    last.sliding = contact.sliding
    row[LOAD_DISTANCE] += records.wear_integrals[k].work
    row[CONTACTS] = counts.contacts - counts.contacts_before


@inlined
def note_film(records: RecorderState, k: int, h: float) -> None:
    """Add the film of a joint in a step of length ``h``, s, to the cycle.

    The loss is integrated by the trapezoidal rule.
    """
    column = records.film_columns[k]
    if column < 0:
        return
    contact = records.contacts[k]
    last = records.last[k]
    row = records.cycle[column:]
    place = math.hypot(contact.eccentricity_x, contact.eccentricity_y)
    row[LEAST_FILM] = min(row[LEAST_FILM], records.packed.joints[k].clearance - place)
    row[FILM_LOSS] += 0.5 * h * (last.film_loss + contact.film_loss)
    last.film_loss = contact.film_loss


@inlined
def note_wear(records: RecorderState, k: int, h: float) -> None:
    """Add the wear of a joint in a step to the maps of the cycle."""
    integrals = records.wear_integrals[k]
    joint = records.packed.joints[k]
    if not integrals.work > 0.0:
        return
    if joint.is_flat:
        depths = records.depth[:, :, : joint.map_bins]
        deposit_on_wall(depths, k, joint, records.contacts[k], integrals.work, h)
        return
    depth = records.depth[k, :, : joint.map_bins]
    contact = records.contacts[k]
    if not joint.over_arc:
        deposit_in_bins(depth, joint, contact, integrals.pressure, h)
        return
    surfaces = records.packed.surfaces[k]
    shares = records.shares[:2, : joint.map_bins]
    if joint.wear_address != 0:
        deposit_by_law(
            depth,
            joint,
            surfaces,
            contact,
            integrals.work,
            integrals.pressure,
            shares,
            records.shares[2:, : joint.map_bins],
        )
    elif joint.pressure_exponent != 1.0:
        deposit_by_pressure(depth, joint, surfaces, contact, integrals.pressure, shares)
    else:
        deposit_over_arc(depth, joint, surfaces, contact, integrals.work, shares)


@compiled
def record_step(address: PackedArguments, t: float, h: float) -> None:
    """Record one accepted step of length ``h``, s, whose contacts and loads are settled.

    ``address`` packs RecorderState, and q, v and a of all bodies.
    """
    records, q, v, a = unpack(address)
    note_output(records, t, h, q, v, a)
    note_drives(records, t, h, v)
    for k in range(records.contacts.shape[0]):
        note_joint(records, k, t, h)
        note_film(records, k, h)
        note_wear(records, k, h)
    time = records.nominal[0].now
    take_frame(records.film, records.sampler, records.contacts, records.memory, time, q)
    if is_row_due(records, t):
        row = records.output[0].rows
        note_stretches(records.guides, records.pins, records.stretches, row, q)
        note_turns(records.angle_indices, records.turns, row, q, v)
        write_row(records)


class StepObserver(NamedTuple):
    """Compiled ``record_step`` and its arguments, as kernels call it."""

    entry: int  # see ``tools.compile.call_entry``
    arguments: int  # their address


def step_observer(records: RecorderState, q: Array, v: Array, a: Array) -> StepObserver:
    """Return the observer of the steps of a run; ``q``, ``v`` and ``a`` are live arrays.

    It is called by its address, so that engines are not compiled again for a recorded
    number.
    """
    packed = pack_arguments(records, q, v, a)
    return StepObserver(entry_of(record_step, packed, 0.0, 0.0), packed)


@inlined
def observe(observer: StepObserver, t: float, h: float) -> None:
    """Record one accepted step of length ``h``, s."""
    call_entry(observer.entry, (observer.arguments, t, h))
