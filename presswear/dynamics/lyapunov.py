"""The largest Lyapunov exponent, from twins that are brought together again and again.

Benettin, Galgani and Strelcyn, Phys. Rev. A 14 (1976) 2338; Wolf, Swift, Swinney and Vastano,
Physica D 16 (1985) 285.  Only the map of a state over a time is asked for, so that jumps of the
motion, as at an impact, need no derivative.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from presswear.recording.sampling import batched, half_width
from presswear.tools.errors import InputError

Array = NDArray[np.float64]
Carried = TypeVar("Carried")

SETTLE = 0.1
"""Part of the restarts at the beginning in which twins turn to the direction that grows most."""


@dataclass(frozen=True)
class Exponent:
    """A largest Lyapunov exponent, per unit of the time between two restarts.

    Attributes
    ----------
    value : float
    half_width : float or None
        Of its 95 % interval, from batches of cycles; None: too few.
    restarts : int
        Restarts that it is the mean of.
    """

    value: float
    half_width: float | None
    restarts: int

    @property
    def is_chaotic(self) -> bool:
        """True where the whole interval lies above 0."""
        return self.half_width is not None and self.value - self.half_width > 0.0


def growths(
    step: Callable[[Array, Carried], tuple[Array, Carried]],
    state: Array,
    carried: Carried,
    restarts: int,
    apart: Array,
) -> Array:
    """Logarithms of the growth of a small distance between two restarts, shape (restarts,).

    The twin is put beside its brother again after each step, in the direction in which it left.

    Parameters
    ----------
    step : callable
        The state, and what is carried with it, after the time between two restarts; it changes
        neither of its arguments.
    state : ndarray, shape (d,)
        A number is NaN while the motion does not depend on it.  Twins have no distance in a number
        that is NaN in either of them.
    carried
        What belongs to a state and is not moved, such as time and which contacts have begun.  The
        twin takes it from the other motion at each restart.
    apart : ndarray, shape (d,)
        Distance of each number at a restart, in its own unit; also the scale in which distances
        are measured.
    """
    if restarts < 1:
        raise InputError(f"restarts = {restarts}: a number from 1 is expected")
    if not np.all(apart > 0.0):
        raise InputError(f"apart = {apart.tolist()}: numbers above 0 are expected")

    def difference(twin: Array) -> Array:
        return np.nan_to_num((twin - state) / apart, nan=0.0, posinf=math.inf, neginf=-math.inf)

    direction = np.full(state.size, 1.0 / math.sqrt(state.size))
    found = np.empty(restarts)
    for k in range(restarts):
        twin = state + apart * direction
        # Of what was asked for, round-off leaves another distance.
        before = float(np.linalg.norm(difference(twin)))
        moved, _ = step(twin, carried)
        state, carried = step(state, carried)
        direction = difference(moved)
        distance = float(np.linalg.norm(direction))
        if not 0.0 < distance < math.inf:
            raise InputError(
                f"restart {k}: twins {distance:g} times as far apart as asked for have no growth; "
                "a larger distance, or a shorter time between restarts, may help"
            )
        found[k] = math.log(distance / before)
        direction /= distance
    return found


def exponent_of(logarithms: Array, duration: float, parts: int = 1) -> Exponent:
    """Return the exponent, and its interval, from ``growths``.

    Parameters
    ----------
    logarithms : ndarray, shape (restarts,)
    duration : float
        Between two restarts; the exponent is per unit of it.
    parts : int
        Restarts in a cycle of what drives the motion.  The interval is of means over whole cycles,
        because growth varies within a cycle.
    """
    rates = logarithms[math.ceil(SETTLE * len(logarithms)) :] / duration
    if not rates.size:
        return Exponent(math.nan, None, 0)
    parts = min(parts, rates.size)
    rates = rates[rates.size % parts :]
    half = half_width(batched(rates.reshape(-1, parts).mean(axis=1)))
    return Exponent(float(rates.mean()), half, rates.size)
