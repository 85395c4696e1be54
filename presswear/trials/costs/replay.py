"""Compiled loops over the recorded calls of a run of the open tree, whole or in part.

A kernel's part takes the difference between a loop with it and one without: so much shorter
than a call from Python that it could not be timed from there.
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

STAGE_PARTS = ("bodies placed", "contacts", "whole")
"""Parts of the force function, each with those before; the last is the kernel itself."""
STEP_PARTS = (
    "nothing",
    "doses and energies",
    "bodies and drives",
    "contact state",
    "series, peaks and maps",
    "choice of the next step",
    "whole",
)
"""Parts of the end of a step, each with those before; the last is the kernel itself."""


class StageCalls(NamedTuple):
    """Arguments of the force function, call by call.

    Attributes
    ----------
    time, noted : ndarray, shape (n,)
        Times of the stage, and of the state whose contacts were noted before it, s.
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
    """Arguments of the end of a step, call by call.

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


@compiled
def replay_stages(system: TreeSystem, book: Book, calls: StageCalls, out: Array, part: int) -> None:
    """Repeat the calls of the force function.

    Parameters
    ----------
    out : ndarray, shape (links,)
        The forces on the tree.
    part : int
        Place in ``STAGE_PARTS`` up to which they are run.
    """
    q, v, a, force, axes = system.state
    rates = system.stages[0, 1:]
    pace = system.pace[0]
    for i in range(calls.time.shape[0]):
        t, x, u = calls.time[i], calls.x[i], calls.u[i]
        pace.evaluations = calls.number[i]
        pace.noted = calls.noted[i]
        for k in range(calls.expected.shape[1]):
            system.expected[k] = calls.expected[i, k]
        if part == 2:
            stage_forces(system, book.packed, book.contacts, t, x, u, out)
            continue
        place_cranks(system.cranks, t, q, v, a, axes)
        place_links(system.links, x, u, q, v, axes)
        if part == 1:
            # As in ``stage_forces``.
            if pace.evaluations % STAGES > 0 or t != pace.noted:
                note_contacts(book.packed, book.contacts, q, v)
            add_contacts(book.packed.joints, system.expected, book.contacts, force, rates)


@compiled
def replay_steps(system: TreeSystem, book: Book, calls: StepCalls, part: int, doses: bool) -> None:
    """Repeat the ends of steps, from the start of a run on.

    Parameters
    ----------
    part : int
        Place in ``STEP_PARTS`` up to which they are run.
    doses : bool
        False leaves the doses out, so that nothing wears.
    """
    q, v, a, _, _ = system.state
    last = 0.0
    events = 0
    for i in range(calls.time.shape[0]):
        t, x, u, u_t = calls.time[i], calls.x[i], calls.u[i], calls.u_t[i]
        system.pace[0].noted = calls.noted[i]
        for j in range(calls.stages.shape[1]):
            for c in range(calls.stages.shape[2]):
                system.stages[j, c] = calls.stages[i, j, c]
        for k in range(calls.contacts.shape[1]):
            book.contacts[k] = calls.contacts[i, k]
        if part == 6:
            accept_tree_step(system, book, t, x, u, u_t)
            continue
        if part > 0 and doses:
            sum_stages(book, system, t - last)
        if part > 1:
            tree_state(system, book, t, x, u, u_t)
        if part > 2:
            events = settle_state(book, t, LEAST_STEPS)
        if part > 3:
            observe(book, t, t - last, q, v, a)
        if part > 4:
            next_tree_step(book, system, t, t - last, events)
        last = t
