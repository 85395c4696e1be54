"""One compiled call per accepted step of a fixed-order integrator."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.energy import loss_powers
from presswear.physics.touchdown import LEAST_STEPS, next_step
from presswear.physics.wear import dose_rates
from presswear.record.observe import Book, observe, settle_state
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]


@compiled
def all_finite(q: Array, v: Array) -> bool:
    """True where a state holds no infinity and no NaN."""
    total = 0.0
    for i in range(q.shape[0]):
        total += q[i] - q[i] + (v[i] - v[i])
    return total == 0.0


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
def accept_step(
    book: Book,
    steps: Records,
    power: float,
    t: float,
    h: float,
    q: Array,
    v: Array,
    a: Array,
) -> float:
    """Settle contact, account for the step and choose the next; NaN for a broken state.

    The contacts of the state are noted in the book.

    Parameters
    ----------
    power : float
        Of the drives in the state, W; their torques are in the book.
    """
    if not all_finite(q, v):
        return math.nan
    settle_state(book, t, LEAST_STEPS)
    sum_step(book, power, t, h)
    observe(book, t, h, q, v, a)
    return next_step(book.packed, book.onset, book.memory, steps, book.contacts, a)
