"""Limits on responses of a sweep, such as ``life>=2e6``."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswear.sweeps.parameters import Column
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, parse_quantity


@dataclass(frozen=True)
class ResponseLimit:
    """Lower or upper limit on a response, in SI units."""

    value: float
    is_lower: bool

    def violated(self, values: Array) -> Any:
        """Return whether each value violates the limit."""
        return values < self.value if self.is_lower else values > self.value

    def count(self, values: Array, censored: Any) -> tuple[int, int]:
        """Return the least and the largest number of violations among values with lower bounds."""
        violated = self.violated(values)
        undecided = censored & (violated == self.is_lower)
        least = int(np.count_nonzero(violated & ~undecided))
        return least, least + int(np.count_nonzero(undecided))


def parse_limits(
    texts: Sequence[str], responses: Sequence[Column]
) -> dict[str, ResponseLimit]:
    """Read limits such as ``life>=2e6`` or ``A.force_max<=15kN`` by response."""
    limits: dict[str, ResponseLimit] = {}
    columns = {column.key: column for column in responses}
    for text in texts:
        sign = ">=" if ">=" in text else "<="
        key, _, value = map(str.strip, text.partition(sign))
        if not value:
            example = "RESPONSE>=VALUE or RESPONSE<=VALUE, such as life>=2e6"
            raise InputError(f"limit {text}: expected {example}")
        if key not in columns:
            raise unknown("response", key, columns)
        if key in limits:
            raise InputError(f"limit {text}: {key} already has a limit")
        number = parse_quantity(key, value, Quantity(columns[key].unit))
        limits[key] = ResponseLimit(float(number), sign == ">=")
    return limits
