"""Compiled part of the model with bodies and joints: connector forces, accepted steps."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.contact import note_contacts
from presswear.physics.energy import loss_powers
from presswear.physics.forces import add_contacts, load_of
from presswear.physics.motion import drive_motion, step_to_break
from presswear.physics.packed import Packed
from presswear.physics.prescribed import drive_torque, place_cranks
from presswear.physics.touchdown import LEAST_STEPS, next_step, shorter_step
from presswear.physics.wear import dose_rates
from presswear.record.observe import Book, observe, settle_state
from presswear.tools.compiled import Records, all_finite, compiled, copy_to

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Frame(NamedTuple):
    """Coordinates of all bodies from those that Exudyn solves for.

    Where every body is one of Exudyn's, ``q``, ``v`` and ``a`` are its own live arrays
    and nothing has to be copied: ``places`` and ``cranks`` are empty.

    Attributes
    ----------
    solved_q, solved_v, solved_a : ndarray
        Exudyn's live coordinates, rates and accelerations.
    places : ndarray of int
        Where each of them belongs in q.
    cranks : records of CRANK
        Driven bodies that are left out.
    q, v, a, axes : ndarray, shape (3 bodies,)
    contacts : records of CONTACT
        Working space of states on trial.
    """

    solved_q: Array
    solved_v: Array
    solved_a: Array
    places: Indices
    cranks: Records
    q: Array
    v: Array
    a: Array
    axes: Array
    contacts: Records


@compiled
def refresh(frame: Frame, t: float) -> None:
    """Bring the coordinates of all bodies up to Exudyn's present state."""
    if frame.places.shape[0] == 0:
        return
    for i in range(frame.places.shape[0]):
        place = frame.places[i]
        frame.q[place] = frame.solved_q[i]
        frame.v[place] = frame.solved_v[i]
        frame.a[place] = frame.solved_a[i]
    place_cranks(frame.cranks, t, frame.q, frame.v, frame.a, frame.axes)


@compiled
def connector_forces(
    frame: Frame,
    packed: Packed,
    slots: Indices,
    onset: Array,
    t: float,
    out: Array,
) -> None:
    """Fill the generalized forces of all clearance joints on the bodies of the connector.

    Parameters
    ----------
    slots : ndarray of int, shape (joints, 2)
        Where the forces on bearing and pin belong in ``out``; -1 for a body that Exudyn
        does not solve for.
    out : ndarray, shape (3 bodies of the connector,)
    """
    refresh(frame, t)
    for i in range(out.shape[0]):
        out[i] = 0.0
    note_contacts(packed, frame.contacts, frame.q, frame.v)
    for k in range(slots.shape[0]):
        load = load_of(packed.joints[k], onset[k], frame.contacts[k])
        if load.normal == 0.0:
            continue
        i = slots[k, 0]
        if i >= 0:
            out[i] -= load.x
            out[i + 1] -= load.y
            out[i + 2] += load.bearing_moment
        i = slots[k, 1]
        if i >= 0:
            out[i] += load.x
            out[i + 1] += load.y
            out[i + 2] += load.pin_moment


class Drives(NamedTuple):
    """Sources of the torques of the drives.

    Attributes
    ----------
    multiplier : ndarray of int, shape (drives,)
        Index of each drive's Lagrange multiplier; -1 for a crank that is left out.
    multipliers : ndarray
        Exudyn's live multipliers; the torque of a drive is minus its own.
    force : ndarray, shape (3 bodies,)
        Working space.
    rates : ndarray, shape (JOINT_RATES joints,)
        Working space.
    """

    multiplier: Indices
    multipliers: Array
    force: Array
    rates: Array


@compiled
def drive_power(frame: Frame, drives: Drives, book: Book, t: float) -> float:
    """Fill the torques of the drives, with contacts noted; returns their power, W."""
    if frame.cranks.shape[0] > 0:
        copy_to(drives.force, book.packed.weight)
        add_contacts(book.packed.joints, book.onset, book.contacts, drives.force, drives.rates)
    power = 0.0
    crank = 0
    for i in range(book.motions.shape[0]):
        if drives.multiplier[i] >= 0:
            torque = -drives.multipliers[drives.multiplier[i]]
        else:
            own = frame.cranks[crank]
            torque = drive_torque(own, frame.q, drives.force)
            torque += own.inertia * frame.a[own.body + 2]
            crank += 1
        book.torque[i] = torque
        power += torque * drive_motion(book.motions[i], t)[1]
    return power


@compiled
def sum_step(book: Book, drive_power: float, t: float, h: float) -> None:
    """Fill the doses of wear of a step, and add to the ledger of energy.

    Doses are taken from the state at the step's end: over a whole contact that is the
    trapezoidal rule, since the force is zero at both ends.  A step that began open
    carries force only since its touchdown.  Powers are summed by the trapezoidal rule.
    """
    contact_power = 0.0
    friction_power = 0.0
    made_power = 0.0
    for k in range(book.memory.shape[0]):
        contact = book.contacts[k]
        work, pressure = dose_rates(book.packed.joints[k], contact, contact.normal)
        duration = min(h, t - book.memory[k].touchdown_time)
        book.doses[k].work = work * duration
        book.doses[k].pressure = pressure * duration
        lost, rubbed, made = loss_powers(contact, contact.normal, contact.tangential)
        contact_power += lost
        friction_power += rubbed
        made_power += made
    ledger = book.ledger[0]
    half = 0.5 * h
    ledger.drive_work += half * (ledger.drive_power + drive_power)
    ledger.drive_exchange += half * (abs(ledger.drive_power) + abs(drive_power))
    ledger.contact_loss += half * (ledger.contact_power + contact_power)
    ledger.friction_loss += half * (ledger.friction_power + friction_power)
    ledger.made += half * (ledger.made_power + made_power)
    ledger.drive_power = drive_power
    ledger.contact_power = contact_power
    ledger.friction_power = friction_power
    ledger.made_power = made_power


@compiled
def accept_joint_step(
    frame: Frame, drives: Drives, book: Book, steps: Records, t: float, h: float
) -> float:
    """Settle contact, account for an accepted step and choose the next; NaN if it is broken."""
    refresh(frame, t)
    note_contacts(book.packed, book.contacts, frame.q, frame.v)
    power = drive_power(frame, drives, book, t)
    if not all_finite(frame.q, frame.v):
        return math.nan
    settle_state(book, t, LEAST_STEPS)
    sum_step(book, power, t, h)
    observe(book, t, h, frame.q, frame.v, frame.a)
    following = next_step(book.packed, book.onset, book.memory, steps, book.contacts, frame.a)
    return step_to_break(book.motions, t, following)


@compiled
def shorter_joint_step(frame: Frame, book: Book, steps: Records, t: float) -> float:
    """Step with which a trial step has to be repeated; see ``shorter_step``."""
    refresh(frame, t)
    return shorter_step(
        book.packed, book.onset, book.memory, steps, frame.contacts, t, frame.q, frame.v
    )
