"""The watch for energy that contacts make."""

import math

import pytest

from presswear.linkage.mechanisms import FOUR_BAR
from presswear.physics.energy import made_energy
from presswear.physics.packed import pack


@pytest.mark.parametrize(
    ("loss", "exchange", "wrong"),
    [
        (0.1, 1.0, False),
        (-0.4, 1.0, False),
        (-0.6, 1.0, True),
        (-1.0, 0.0, False),
        (math.nan, 1.0, False),
        (-3.0, math.nan, False),
    ],
)
def test_only_what_exceeds_half_of_the_exchange_is_wrong(
    loss: float, exchange: float, wrong: bool
) -> None:
    warning = made_energy(pack(FOUR_BAR), loss, exchange)
    expected = ["created 0.6 J", "steps are too coarse"] if wrong else []
    assert bool(warning) == wrong
    assert all(words in warning for words in expected)
