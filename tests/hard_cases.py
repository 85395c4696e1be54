"""Hard cases, in which a run could hang, fail, or be wrong without a message."""

from collections.abc import Iterator

from hard_case import HardCase
from hard_impacts import impact_cases
from hard_press import (
    law_cases,
    long_cases,
    profile_cases,
    refusal_cases,
    state_cases,
)


def hard_cases() -> Iterator[HardCase]:
    """Yield every hard case, long ones included."""
    makers = (
        impact_cases,
        law_cases,
        profile_cases,
        state_cases,
        refusal_cases,
        long_cases,
    )
    for make in makers:
        yield from make()
