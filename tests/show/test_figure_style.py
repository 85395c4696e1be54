"""Scales of figures."""

import pytest

from presswear.show.figures.style import length_scale, round_down


@pytest.mark.parametrize(
    ("value", "expected"), [(1.0, 1.0), (1.99, 1.0), (4.9, 2.0), (0.07, 0.05), (730.0, 500.0)]
)
def test_round_down(value: float, expected: float) -> None:
    assert round_down(value) == pytest.approx(expected)


def test_length_scale_reads_naturally() -> None:
    assert length_scale(1.2e-5) == (1e6, "µm")
    assert length_scale(0.0015) == (1e3, "mm")
    assert length_scale(0.0)[1] == "pm"
