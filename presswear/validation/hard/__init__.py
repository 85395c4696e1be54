"""Hard cases: where a run could hang, break, or be wrong without a word."""

from collections.abc import Iterator

from presswear.validation.hard.bodies import body_cases
from presswear.validation.hard.case import HardCase
from presswear.validation.hard.scenes import scene_cases


def hard_cases() -> Iterator[HardCase]:
    """Every hard case, long ones included."""
    yield from body_cases()
    yield from scene_cases()
