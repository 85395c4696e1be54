"""Compiled loops over the recorded calls of a run of the open tree, whole or in part.

What a kernel's part takes is the difference between a loop with it and one without: so
much shorter than a call from Python that it could not be timed from there.
"""

import numpy as np
from numpy.typing import NDArray

from presswear.compiled import compiled
from presswear.contacts import add_contacts
from presswear.engines.tree_kernels import (
    LEAST_STEPS,
    TreeSystem,
    accept_tree_step,
    stage_forces,
    sum_stages,
    tree_state,
)
from presswear.observe import Book, observe
from presswear.prescribed import place_cranks
from presswear.touch import settle
from presswear.tree import place_links

Array = NDArray[np.float64]


@compiled
def replay_stages(
    system: TreeSystem,
    book: Book,
    times: Array,
    x: Array,
    u: Array,
    expected: Array,
    out: Array,
    forces: bool,
    contacts: bool,
) -> None:
    """Calls of the force function: ``forces`` whole, else bodies placed, with contacts or not.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s.
    x, u : ndarray, shape (n, links)
    expected : ndarray, shape (n, joints)
        Closing speeds that the stages used, m/s.
    out : ndarray, shape (links,)
    """
    q, v, a, force, axes = system.state
    rates = system.stages[0, 1:]
    for i in range(times.shape[0]):
        for k in range(expected.shape[1]):
            system.expected[k] = expected[i, k]
        if forces:
            stage_forces(system, book.joints, book.wear, book.surfaces, times[i], x[i], u[i], out)
            continue
        place_cranks(system.cranks, times[i], q, v, a, axes)
        place_links(system.links, x[i], u[i], q, v, axes)
        if contacts:
            add_contacts(book.joints, book.wear, system.expected, book.surfaces, q, v, force, rates)


@compiled
def replay_steps(
    system: TreeSystem,
    book: Book,
    times: Array,
    x: Array,
    u: Array,
    u_t: Array,
    stages: Array,
    sums: bool,
    bodies: bool,
    contact: bool,
    series: bool,
    whole: bool,
) -> None:
    """Ends of steps, from the start of a run on: ``whole``, else the parts that are named.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s.
    x, u, u_t : ndarray, shape (n, links)
    stages : ndarray, shape (n, STAGES, columns)
        Powers that the stages of each step had left.
    """
    q, v, a, _, _ = system.state
    last = 0.0
    for i in range(times.shape[0]):
        t = times[i]
        for j in range(stages.shape[1]):
            for c in range(stages.shape[2]):
                system.stages[j, c] = stages[i, j, c]
        if whole:
            accept_tree_step(system, book, t, x[i], u[i], u_t[i])
            continue
        if sums:
            sum_stages(book, system, t - last)
        if bodies:
            tree_state(system, book, t, x[i], u[i], u_t[i])
        if contact:
            settle(
                book.joints,
                book.onset,
                book.touch,
                book.tally,
                book.episodes,
                book.surfaces,
                t,
                q,
                v,
                LEAST_STEPS,
            )
        if series:
            observe(book, t, t - last, q, v, a)
        last = t
