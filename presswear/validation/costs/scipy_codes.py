"""The press by hand in the codes of scipy's ``solve_ivp``, which end their steps on touches."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from presswear.tools.compiled import Records, specialised
from presswear.tools.errors import RunFailed
from presswear.validation.costs.by_hand import OPEN, SIZE, evaluate
from presswear.validation.costs.outcome import Found, Outcome, measured

Array = NDArray[np.float64]

METHODS = {"LSODA": 7, "DOP853": 7, "Radau": 3}
"""How many of the tolerances each is run at: Radau, with a Jacobian by differences, takes long."""
STOOD = 10
"""Touches and partings one after another without any time between them: there will be more."""


def solve(
    press: Records, start: Array, end: float, method: str, tolerance: float, longest: float
) -> Outcome:
    """Integrate with one of METHODS at a relative and absolute tolerance and a longest step, s."""
    onset, out, gaps = np.full(2, OPEN), np.zeros(12), np.zeros((2, 2))
    kernel = specialised(evaluate, press, 0.0, start, onset, out, gaps)

    def slopes(t: float, y: Array) -> Array:
        # Radau hands over columns of a matrix.
        kernel(press, t, np.ascontiguousarray(y), onset, out, gaps)
        return out[:SIZE].copy()

    def depth(k: int) -> Callable[[float, Array], float]:
        def event(t: float, y: Array) -> float:
            kernel(press, t, y, onset, out, gaps)
            return float(gaps[k, 0])

        vars(event)["terminal"] = True
        return event

    def run() -> Found:
        t, y, steps, evaluations, stood = 0.0, start.copy(), 0, 0, 0
        touches = []
        onset[:] = OPEN
        while t < end:
            for k, event in enumerate(events):
                vars(event)["direction"] = -1.0 if onset[k] >= 0.0 else 1.0
            found = solve_ivp(
                *(slopes, (t, end), y, method),
                **{"rtol": tolerance, "atol": tolerance, "max_step": longest, "events": events},
            )
            if found.status < 0:
                raise RunFailed(f"{method} at {tolerance:g}: {found.message}")
            stood = 0 if found.t[-1] > t else stood + 1
            if stood > STOOD:
                raise RunFailed(f"{method} at {tolerance:g}: touches at {t:g} s without end")
            t, y = float(found.t[-1]), found.y[:, -1].copy()
            steps, evaluations = steps + len(found.t) - 1, evaluations + found.nfev
            kernel(press, t, y, onset, out, gaps)
            for k in (k for k in (0, 1) if found.t_events[k].size):
                if onset[k] >= 0.0:
                    onset[k] = OPEN
                else:
                    onset[k] = max(gaps[k, 1], 0.0)
                    touches.append((k, t))
        return y, touches, steps, evaluations

    events = [depth(0), depth(1)]
    return measured(run)
