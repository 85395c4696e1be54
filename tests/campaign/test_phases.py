"""Running-in, steady and accelerated wear of made-up joints."""

import numpy as np
import pytest

from presswear.campaign.service_life import ACCELERATED, RUNNING_IN, STEADY, LoadBlock, wear_phases


def blocks(rates: list[float], noise: float, seed: int = 1) -> list[LoadBlock]:
    """Blocks of a thousand strokes with rates of wear, after a first one of four strokes."""
    draw, found = np.random.default_rng(seed), []
    volume, strokes = np.zeros(8), 0.0
    for k, rate in enumerate([rates[0], *rates]):
        more = 1e3 if k else 4.0
        volume = volume + more * rate * (1.0 + noise * draw.standard_normal(8))
        strokes += more
        found.append(LoadBlock(strokes, 4, 0, {"A.wear_volume": volume}, {}, 0.0, np.zeros(0)))
    return found


@pytest.mark.parametrize(
    ("rates", "names", "ends"),
    [
        ([1.0] * 12, [STEADY], [12e3]),
        ([3.0] * 4 + [1.0] * 8, [RUNNING_IN, STEADY], [4e3, 12e3]),
        ([1.0] * 8 + [2.0] * 4, [STEADY, ACCELERATED], [8e3, 12e3]),
        ([3.0] * 4 + [1.0] * 8 + [2.0] * 4, [RUNNING_IN, STEADY, ACCELERATED], [4e3, 12e3, 16e3]),
    ],
)
def test_phases_are_told_apart(rates: list[float], names: list[str], ends: list[float]) -> None:
    found = wear_phases(blocks(rates, 0.1), "A")
    assert [own.name for own in found] == names
    assert [own.until for own in found] == pytest.approx([end + 4.0 for end in ends])
    for own in found:
        right = rates[int((own.since + own.until) / 2e3)]
        assert abs(own.rate - right) <= 2.0 * own.half_width


def test_noise_is_no_phase() -> None:
    """In few of many joints that wear steadily, and noisily, a change is seen."""
    found = [wear_phases(blocks([1.0] * 16, 0.5, seed), "A") for seed in range(50)]
    assert sum(len(own) > 1 for own in found) <= 10
