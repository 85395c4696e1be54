"""Texts in the tables of a stage."""

import math

import pytest

from presswear.recording.statistics import Estimate
from presswear.show.stage_tables import direction_text


@pytest.mark.parametrize(
    ("mean", "low", "high", "text"),
    [
        (182.0, 170.0, 194.0, "182 (170 to 194)"),
        (2.0, -10.0, 14.0, "2 (350 to 14)"),
        # half of the samples are deepest in the opposite groove
        (182.0, -156.0, 182.0, "182 (no single place)"),
    ],
)
def test_interval_of_an_angle_is_one_range_of_less_than_half_a_turn(
    mean, low, high, text
):
    angle = Estimate(math.radians(mean), math.radians(low), math.radians(high), 8)
    assert direction_text(angle) == text
