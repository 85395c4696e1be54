"""Typed values: units, ranges and what is refused."""

import math
import re
from dataclasses import replace

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from presswear.tools.errors import InputError
from presswear.tools.quantities import (
    Quantity,
    parse_quantity,
)

UNITS = ["m", "rad/s", "rad", "kg", "kg m^2", "Pa", "1/Pa", "m/s", "m/s^2", "s"]


def _any(unit: str) -> Quantity:
    return Quantity(unit, -math.inf, math.inf, "", "")


def _read(text: str, unit: str, *, whole: bool = False) -> float:
    return parse_quantity("key", text, replace(_any(unit), whole=whole))


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("0.8mm", "m", 0.8e-3),
        ("  .8mm ", "m", 0.8e-3),
        ("800um", "m", 8e-4),
        ("800 µm", "m", 8e-4),
        ("1E3 m", "m", 1e3),
        ("3.5pi rad/s", "rad/s", 3.5 * math.pi),
        ("3.5*pi rad/s", "rad/s", 3.5 * math.pi),
        ("60rpm", "rad/s", 2.0 * math.pi),
        ("180deg/s", "rad/s", math.pi),
        ("30deg", "rad", math.pi / 6.0),
        ("200GPa", "Pa", 200e9),
        ("1.2e-15/Pa", "1/Pa", 1.2e-15),
        ("24.3g", "kg", 0.0243),
        ("1e-3 kg*m^2", "kg m^2", 1e-3),
        ("1e-3 kgm2", "kg m^2", 1e-3),
        ("9.81m/s2", "m/s^2", 9.81),
        ("3 us", "s", 3e-6),
        ("800 μm", "m", 8e-4),  # a Greek letter
        ("210 1/min", "rad/s", 7.0 * math.pi),
        ("2Hz", "rad/s", 4.0 * math.pi),
        ("210 N/mm²", "Pa", 210e6),
        # Per pressure, m^2/N: what a pin loses in volume for each force and way.
        ("1.2e-9 mm^2/N", "1/Pa", 1.2e-15),
        ("1.2e-6 mm^3/(N m)", "1/Pa", 1.2e-15),
        ("1.2e-6 mm³/N·m", "1/Pa", 1.2e-15),
        ("3 N mm", "N m", 3e-3),
        ("300 spm", "rad/s", 10.0 * math.pi),
        ("5 %", "", 0.05),
        ("-1e-3", "", -1e-3),
    ],
)
def test_reads(text: str, unit: str, value: float) -> None:
    assert _read(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("unit", UNITS)
def test_a_number_without_a_known_unit_is_refused_with_what_works(unit: str) -> None:
    with pytest.raises(InputError, match="has no unit") as refusal:
        _read("1.5", unit)
    example_text = str(refusal.value).split("for instance '")[1].split("'")[0]
    assert math.isfinite(_read(example_text, unit))
    with pytest.raises(
        InputError, match=f"unknown unit 'furlong'; known are (.*, )?{re.escape(unit)}"
    ):
        _read("1.5 furlong", unit)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("1 kg", "m"),
        ("1 Mm", "m"),
        ("3pi", "rad/s"),
        ("1,5mm", "m"),
        ("1.5", "m"),
        ("nan", ""),
        ("1e999", ""),
        ("", "m"),
        ("1 2", ""),
        ("1mm\n2mm", "m"),
        ("0.3m", ""),
        ("0_8mm", "m"),
        ("0.8m m", "m"),  # not 0.8 mm
        ("٣m", "m"),
    ],
)
def test_refuses(text: str, unit: str) -> None:
    with pytest.raises(InputError, match=r"^key = ") as refusal:
        _read(text, unit)
    assert "\n" not in str(refusal.value)


def test_whole_numbers() -> None:
    for text in ("3", "3.0", "3e0", " 3 "):
        value = _read(text, "", whole=True)
        assert value == 3
        assert isinstance(value, int)
    for text in ("3.5", "1e999", "-1e-9"):
        with pytest.raises(InputError, match="a whole number is expected"):
            _read(text, "", whole=True)


@pytest.mark.parametrize(
    ("meaning", "inside", "outside", "said"),
    [
        (Quantity("m", 0.0, 1.0, "", ""), ["0m", "1m"], ["-1um", "1.1m"], "0 to 1 m"),
        (Quantity("m", 0.0, 1.0, "", "", True), ["1e-9m", "1m"], ["0m", "2m"], "above 0 up to 1 m"),
        (Quantity("", 2.0, math.inf, "", ""), ["2", "1e300"], ["1.999"], "at least 2"),
        (Quantity("s", 0.0, math.inf, "", "", True), ["1us"], ["0s"], "above 0 s"),
    ],
)
def test_ranges(meaning: Quantity, inside: list[str], outside: list[str], said: str) -> None:
    for text in inside:
        parse_quantity("key", text, meaning)
    for text in outside:
        with pytest.raises(InputError, match=f"allowed is {said}"):
            parse_quantity("key", text, meaning)


@pytest.mark.parametrize(
    ("meaning", "value", "says"),
    [
        # What is outside by a hair is not told as one inside.
        (
            Quantity("", 0.0, 0.8, "", ""),
            math.nextafter(0.8, 1.0),
            r"0\.80000000000000\d+: allowed is 0 to 0\.8",
        ),
        (Quantity("", 1, 5, "", "", whole=True), True, "True: a whole number is expected"),
        *((_any("m"), value, ".*any finite number") for value in (math.nan, math.inf, -math.inf)),
    ],
)
def test_a_value_out_of_range_is_told_as_it_is(meaning: Quantity, value: float, says: str) -> None:
    with pytest.raises(InputError, match=f"^key = {says}"):
        meaning.check("key", value)


texts = st.text(max_size=30) | st.from_regex(
    r"[+-]?[0-9]{0,5}(\.[0-9]*)?(e[+-]?[0-9]{1,4})? ?(mm|m|pi|rad/s|kg|%|\s)?", fullmatch=True
)


@given(texts, st.sampled_from(["", *UNITS]), st.booleans())
@example("٣m", "m", False)
@example("1\u2028m", "m", False)
@example("1e400m", "m", True)
@example("9" * 400, "", True)
@example("1m\n", "m", False)
@example("²", "", False)
def test_any_text_is_read_or_refused_in_one_line(text: str, unit: str, whole: bool) -> None:
    meaning = Quantity(unit, -1e3, 1e9, "", "")
    refusal = ""
    try:
        value = parse_quantity("key", text, replace(meaning, whole=whole))
    except InputError as error:
        refusal = str(error)
    if refusal:
        assert refusal.startswith("key = ")
        assert len(refusal.splitlines()) == 1
    else:
        assert -1e3 <= value <= 1e9
        assert isinstance(value, int) == whole


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(UNITS))
def test_a_number_as_python_prints_it_is_read_exactly(value: float, unit: str) -> None:
    plain = "/Pa" if unit == "1/Pa" else unit
    assert _read(f"{value!r} {plain}", unit) == value


def test_a_unit_that_nothing_else_has_is_known_by_itself() -> None:
    force = Quantity("N m/rad", 0.0, 1e9, "chosen", "stiffness")
    assert parse_quantity("stiffness", "3e4 N m/rad", force) == 3e4
    with pytest.raises(InputError, match=r"unknown unit 'N/m'; .*known are N m/rad"):
        parse_quantity("stiffness", "3 N/m", force)
    with pytest.raises(InputError, match="for instance '1N m/rad'"):
        parse_quantity("stiffness", "3", force)
