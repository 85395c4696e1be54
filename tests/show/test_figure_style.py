"""Scales of figures."""

import numpy as np
import pytest
from made_up_result import grown

from presswear.show.figures.style import between, round_down


@pytest.mark.parametrize(
    ("value", "expected"), [(1.0, 1.0), (1.99, 1.0), (4.9, 2.0), (0.07, 0.05), (730.0, 500.0)]
)
def test_round_down(value: float, expected: float) -> None:
    assert round_down(value) == pytest.approx(expected)


def test_all_series_are_cut_to_the_same_rows() -> None:
    stage = grown().stage(0)
    rows = len(stage.time)
    cut = between(stage, stage.time[rows // 4], stage.time[rows // 2])
    left = rows // 2 - rows // 4 + 1
    np.testing.assert_array_equal(cut.time, stage.time[rows // 4 : rows // 2 + 1])
    series = {name for name, array in stage.arrays.items() if len(array) == rows}
    assert {name for name, array in cut.arrays.items() if len(array) == left} == series
    for joint in cut.joints.values():
        assert len(joint.sliding) == len(joint.penetration) == len(joint.force) == left
