"""One evaluation of the press written by hand, for integrators of other programs."""

import time as clock
from collections.abc import Callable

from by_hand.equations import accelerations, cranks

from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled

Outcome = tuple[Array, float]  # final state, and CPU time of the integration alone, s


@compiled
def evaluate(
    press: Records, t: float, y: Array, onset: Array, out: Array, gaps: Array
) -> None:
    """Fill rates and generalized contact forces, shape (12,), and the gaps, shape (2, 2)."""
    x = (y[0], y[1], y[2], y[3])
    u = (y[4], y[5], y[6], y[7])
    a, forces, one, two, _ = accelerations(press, cranks(press, t), onset, x, u)
    for i in range(4):
        out[i], out[4 + i], out[8 + i] = u[i], a[i], forces[i]
    gaps[0, 0] = one.depth
    gaps[0, 1] = one.rate
    gaps[1, 0] = two.depth
    gaps[1, 1] = two.rate


def measured(run: Callable[[], Array]) -> Outcome:
    started = clock.process_time()
    return run(), clock.process_time() - started
