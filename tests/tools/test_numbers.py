"""Numbers as people read them."""

import pytest

from presswear.tools.numbers import large, lasting, readable, short_number, whole, with_interval


def test_times_are_told_as_people_say_them() -> None:
    told = [lasting(own) for own in (0.04, 59.0, 90.0, 5400.0, 1e6)]
    assert told == ["0.04 s", "59 s", "1.5 minutes", "1.5 hours", "11.6 days"]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1369.2, "1\u202f370"),
        (-0.9448, "−0.945"),
        (999.9, "1\u202f000"),
        (2.5e-9, "2.50·10⁻⁹"),
        (12.34e6, "12.3·10⁶"),
        (None, "–"),
        (float("nan"), "–"),
    ],
)
def test_readable(value: float | None, text: str) -> None:
    assert readable(value) == text


@pytest.mark.parametrize(
    ("values", "digits", "text"),
    [
        ([4.5e6], 3, "4.5 million"),
        ([8.70e6, 9.54e6], 2, "8.7 to 9.5 million"),
        ([4.0, 1.739e6], 3, "0 to 1.74 million"),
        ([123456.0], 2, "120\u202f000"),
        ([999999.0], 3, "1 million"),
        ([1.234e9], 3, "1.23 billion"),
        ([0.0], 3, "0"),
    ],
)
def test_large_counts_are_said(values: list[float], digits: int, text: str) -> None:
    assert large(*values, digits=digits) == text


def test_numbers_with_company() -> None:
    assert with_interval(107.1912, 0.2693) == "107.19\u00a0± 0.27"
    assert with_interval(730.59, 1393.5) == "700\u00a0± 1\u202f400"
    assert with_interval(3.0, None) == "3.00 (too few cycles)"
    assert with_interval(None, None) == "–"
    assert with_interval(5.0, 0.0) == "5.000\u00a0± 0"
    assert (whole(258195), whole(None)) == ("258\u202f195", "–")
    assert (short_number(2e11), short_number(0.0243)) == ("2·10¹¹", "0.0243")
