"""The state of something as named arrays, all that is needed to go on from it.

Arrays may be views of what is only ever added to, so that it costs little; whoever
writes one down does so, or copies it, before the owner of the arrays is gone.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

State = Mapping[str, NDArray[Any]]
"""Arrays of numbers or of records by name."""


def named(prefix: str, state: State) -> dict[str, NDArray[Any]]:
    """A state as a part of a larger one, under a name."""
    return {f"{prefix}/{name}": array for name, array in state.items()}


def part(state: State, prefix: str) -> dict[str, NDArray[Any]]:
    """What ``named`` put into a larger state; empty where it is not there."""
    start = f"{prefix}/"
    return {
        name.removeprefix(start): array for name, array in state.items() if name.startswith(start)
    }


def numbers(values: Mapping[str, float]) -> NDArray[np.float64]:
    """Numbers by name as one array, in the order of their names."""
    return np.array([values[name] for name in sorted(values)], dtype=np.float64)


def set_numbers(values: dict[str, float], stored: NDArray[Any]) -> None:
    """Set numbers by name as ``numbers`` stored them."""
    values.update(zip(sorted(values), map(float, stored), strict=True))
