"""State of all bodies: coordinates, rates, accelerations, and the forces on them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.closed_loops import place_prescribed
from presswear.physics.equations.function import Model, Written, fill
from presswear.physics.equations.layout import Layout
from presswear.physics.prescribed import Prescribed
from presswear.recording.observe import StepObserver
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, copy_to, inlined

Indices = NDArray[np.int64]


class Friction(NamedTuple):
    """Friction in rigid joints: joint forces from Exudyn, friction moments to Exudyn."""

    joints: Records  # dtype RUBBING
    rows: Indices  # index of the first of the two multipliers of each joint
    # indices of bearing and pin in the connector forces, (joints, 2); -1 for the ground
    slots: Indices
    multipliers: Array  # live multipliers of Exudyn


class BodyState(NamedTuple):
    """State of all bodies, and the coordinates for which Exudyn solves.

    If Exudyn solves for all coordinates, ``q``, ``v`` and ``a`` are its live arrays,
    and ``solved_indices`` is empty.
    """

    solved_q: Array  # Exudyn's live coordinates, rates and accelerations
    solved_v: Array
    solved_a: Array
    solved_indices: Indices  # index in q of each coordinate that Exudyn solves for
    prescribed: Prescribed  # bodies that are not in Exudyn's model
    q: Array  # (3 bodies,)
    v: Array
    a: Array
    axes: Array
    # function for the forces of contacts, springs and loads on all bodies
    forces: Written
    observer: StepObserver
    model: Model  # arguments of this function, with the contacts of trial states
    y: Array  # its state vector
    rates: Array  # rates of this state vector
    layout: Layout
    scales: Array  # smallest changes that matter of states of interactions, (states,)
    # clearance joint whose touchdown changes the rate of each state; -1: none
    state_joints: Indices
    # states of interactions, see STEP_START, (6, states)
    states: Array
    friction: Friction  # friction in rigid joints


@compiled
def refresh(body_state: BodyState, t: float) -> None:
    """Fill the coordinates of all bodies from Exudyn's present state."""
    if body_state.solved_indices.shape[0] == 0:
        return
    for i in range(body_state.solved_indices.shape[0]):
        index = body_state.solved_indices[i]
        body_state.q[index] = body_state.solved_q[i]
        body_state.v[index] = body_state.solved_v[i]
        body_state.a[index] = body_state.solved_a[i]
    place_prescribed(
        body_state.prescribed,
        t,
        body_state.q,
        body_state.v,
        body_state.a,
        body_state.axes,
    )


@inlined
def fill_forces(body_state: BodyState, t: float, level: int) -> None:
    """Fill the forces on all bodies, and at level END the contacts, in the present state."""
    n = body_state.q.shape[0]
    copy_to(body_state.y[:n], body_state.q)
    copy_to(body_state.y[n : 2 * n], body_state.v)
    fill(body_state.forces, t, body_state.y, body_state.rates, level)
