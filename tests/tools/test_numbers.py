"""Texts of numbers in reports and on a terminal."""

import pytest

from presswear.tools.numbers import (
    duration_text,
    large,
    percent,
    readable,
    short_number,
    whole,
    with_interval,
)


@pytest.mark.parametrize(
    ("function", "texts"),
    [
        (
            duration_text,
            {
                0.04: "0.04 s",
                59.0: "59 s",
                90.0: "1.5 minutes",
                5400.0: "1.5 hours",
                1e6: "11.6 days",
            },
        ),
        (
            readable,
            {
                0.0: "0",
                1369.2: "1\u202f370",
                -0.9448: "−0.945",
                999.9: "1\u202f000",
                None: "–",
                2.5e-9: "2.50·10⁻⁹",
                12.34e6: "12.3·10⁶",
                float("nan"): "–",
            },
        ),
        (
            large,
            {
                4.5e6: "4.5 million",
                999999.0: "1 million",
                1.234e9: "1.23 billion",
                0.0: "0",
            },
        ),
        (
            percent,
            {
                0.0: "0 %",
                3.7e-6: "less than 0.01 %",
                -1e-3: "−0.100 %",
                0.126: "12.6 %",
            },
        ),
        (whole, {258195: "258\u202f195", None: "–"}),
        (short_number, {2e11: "2·10¹¹", 0.0243: "0.0243"}),
    ],
)
def test_numbers(function, texts):
    assert {value: function(value) for value in texts} == texts


def test_ranges_and_intervals_are_rounded_together():
    assert large(8.70e6, 9.54e6, digits=2) == "8.7 to 9.5 million"
    assert duration_text(312.0, 1250.0) == "5.2 to 21 minutes"
    assert duration_text(20.4, 81.6) == "20 to 82 s"
    assert large(4.0, 1.739e6) == "0 to 1.74 million"
    assert large(123456.0, digits=2) == "120\u202f000"
    assert with_interval(107.1912, 0.2693) == "107.19\u00a0± 0.27"
    assert with_interval(730.59, 1393.5) == "700\u00a0± 1\u202f400"
    assert with_interval(3.0, None) == "3.00 (too few cycles)"
    assert with_interval(None, None) == "–"
    assert with_interval(5.0, 0.0) == "5.000"
