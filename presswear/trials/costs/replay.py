"""Compiled loops over the recorded calls of a run of the open tree, whole or in part.

What a kernel's part takes is the difference between a loop with it and one without: so
much shorter than a call from Python that it could not be timed from there.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.engines.exudyn_tree.kernels import (
    LEAST_STEPS,
    STAGES,
    TreeSystem,
    accept_tree_step,
    next_tree_step,
    stage_forces,
    sum_stages,
    tree_state,
)
from presswear.physics.contact import note_contacts
from presswear.physics.forces import add_contacts
from presswear.physics.prescribed import place_cranks
from presswear.physics.tree import place_links
from presswear.record.observe import Book, observe, settle_state
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]


class StageCalls(NamedTuple):
    """What the force function was given, call by call.

    Attributes
    ----------
    time, noted : ndarray, shape (n,)
        Of the stage, and of the state whose contacts were noted before it, s.
    number : ndarray of int, shape (n,)
        How many calls came before.
    x, u : ndarray, shape (n, links)
    expected : ndarray, shape (n, joints)
        Closing speeds that the stage used, m/s.
    """

    time: Array
    noted: Array
    number: NDArray[np.int64]
    x: Array
    u: Array
    expected: Array


class StepCalls(NamedTuple):
    """What the end of a step was given, call by call.

    Attributes
    ----------
    time, noted : ndarray, shape (n,)
        As in ``StageCalls``.
    x, u, u_t : ndarray, shape (n, links)
    stages : ndarray, shape (n, STAGES, columns)
        Powers that the stages of the step had left.
    contacts : records of CONTACT, shape (n, joints)
        Contacts as they were noted.
    """

    time: Array
    noted: Array
    x: Array
    u: Array
    u_t: Array
    stages: Array
    contacts: Records


class StepParts(NamedTuple):
    """Which parts of the end of a step are run, each after those before; or the ``whole``."""

    sums: bool
    bodies: bool
    contact: bool
    series: bool
    following: bool
    whole: bool


@compiled
def replay_stages(
    system: TreeSystem, book: Book, calls: StageCalls, out: Array, forces: bool, contacts: bool
) -> None:
    """Calls of the force function: ``forces`` whole, else bodies placed, with contacts or not.

    Parameters
    ----------
    out : ndarray, shape (links,)
        The forces on the tree.
    """
    q, v, a, force, axes = system.state
    rates = system.stages[0, 1:]
    pace = system.pace[0]
    for i in range(calls.time.shape[0]):
        t = calls.time[i]
        pace.evaluations = calls.number[i]
        pace.noted = calls.noted[i]
        for k in range(calls.expected.shape[1]):
            system.expected[k] = calls.expected[i, k]
        if forces:
            stage_forces(
                system,
                book.packed,
                book.contacts,
                t,
                calls.x[i],
                calls.u[i],
                out,
            )
            continue
        place_cranks(system.cranks, t, q, v, a, axes)
        place_links(system.links, calls.x[i], calls.u[i], q, v, axes)
        if contacts:
            # As in ``stage_forces``.
            if pace.evaluations % STAGES > 0 or t != pace.noted:
                note_contacts(book.packed, book.contacts, q, v)
            add_contacts(book.packed.joints, system.expected, book.contacts, force, rates)


@compiled
def replay_steps(system: TreeSystem, book: Book, calls: StepCalls, parts: StepParts) -> None:
    """Ends of steps, from the start of a run on."""
    q, v, a, _, _ = system.state
    last = 0.0
    events = 0
    for i in range(calls.time.shape[0]):
        t = calls.time[i]
        system.pace[0].noted = calls.noted[i]
        for j in range(calls.stages.shape[1]):
            for c in range(calls.stages.shape[2]):
                system.stages[j, c] = calls.stages[i, j, c]
        for k in range(calls.contacts.shape[1]):
            book.contacts[k] = calls.contacts[i, k]
        if parts.whole:
            accept_tree_step(system, book, t, calls.x[i], calls.u[i], calls.u_t[i])
            continue
        if parts.sums:
            sum_stages(book, system, t - last)
        if parts.bodies:
            tree_state(system, book, t, calls.x[i], calls.u[i], calls.u_t[i])
        if parts.contact:
            events = settle_state(book, t, LEAST_STEPS)
        if parts.series:
            observe(book, t, t - last, q, v, a)
        if parts.following:
            next_tree_step(book, system, t - last, events)
        last = t
