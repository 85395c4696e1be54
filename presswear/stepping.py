"""One compiled call per accepted step of a fixed-order integrator."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.compiled import Records, compiled
from presswear.observe import observe
from presswear.touch import next_step, settle

Array = NDArray[np.float64]


@compiled
def all_finite(q: Array, v: Array) -> bool:
    """Whether a state holds no infinity and no NaN."""
    total = 0.0
    for i in range(q.shape[0]):
        total += q[i] - q[i] + (v[i] - v[i])
    return total == 0.0


@compiled
def accept_step(
    t: float,
    h: float,
    q: Array,
    v: Array,
    a: Array,
    joints: Records,
    wear: Records,
    onset: Array,
    touch: Records,
    tally: Records,
    record: Records,
    steps: Records,
    series: Array,
    episodes: Array,
    cycle: Array,
    depth: Array,
    pressure: Array,
    surfaces: Array,
) -> float:
    """Settle contact, account for the step and choose the next; NaN for a broken state.

    Arguments as in ``settle``, ``observe`` and ``next_step``.
    """
    if not all_finite(q, v):
        return math.nan
    settle(joints, onset, touch, tally, episodes, surfaces, t, q, v)
    observe(
        joints,
        wear,
        onset,
        touch,
        tally,
        record,
        series,
        cycle,
        depth,
        pressure,
        surfaces,
        t,
        h,
        q,
        v,
        a,
    )
    return next_step(joints, onset, touch, steps, surfaces, q, v, a)
