"""Typed values: units, ranges and what is refused."""

import math
import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity, parse_quantity

UNITS = ["m", "rad/s", "rad", "kg", "kg m^2", "Pa", "1/Pa", "m/s", "m/s^2", "s"]


def _read(text: str, unit: str) -> float:
    return parse_quantity("key", text, Quantity(unit))


@pytest.mark.parametrize(
    ("unit", "value", "texts"),
    [
        (
            "m",
            0.8e-3,
            ["0.8mm", "0.8 mm", "  .8mm ", "+8.e-4 m", "800um", "800 µm", "800 μm"],
        ),
        ("rad/s", 3.5 * math.pi, ["3.5pi rad/s", "3.5 pi rad/s", "3.5*pi rad/s"]),
        (
            "rad/s",
            2.0 * math.pi,
            ["60rpm", "1Hz", "60/min", "60 spm", "1 rev/s", "1rps"],
        ),
        ("rad", 0.5 * math.pi, ["90deg", "0.5pi rad"]),
        ("Pa", 200e9, ["200GPa", "2e5 N/mm^2", "2e5 N/mm²"]),
        ("Pa", 3e5, ["0.3 MPa", "3e5Pa", "3 bar"]),
        # Per pressure, m^2/N: volume that a pin loses for each force and distance.
        (
            "1/Pa",
            1.2e-15,
            ["1.2e-15/Pa", "1.2e-15 1/Pa", "1.2e-9 mm^2/N", "1.2e-9 mm2/N"],
        ),
        ("1/Pa", 1.2e-15, ["1.2e-9/MPa", "1.2e-6 mm^3/(N m)", "1.2e-6 mm³/N·m"]),
        ("kg", 0.0243, ["24.3g", "0.0243 kg"]),
        (
            "kg m^2",
            1e-3,
            ["1e-3kg m^2", "1e-3 kg*m^2", "1e-3 kgm2", "1000 kg mm²", "10 kg cm2"],
        ),
        ("N/m", 1e9, ["1 MN/mm", "1000kN/mm", "1GN/m"]),
        ("m/s", 0.1, ["100mm/s", "6 m/min"]),
        ("m/s^2", 9.81, ["9.81 m/s^2", "9.81m/s2"]),
        ("s", 3e-3, ["3ms", "3000 us"]),
        ("N m", 2e3, ["2kNm", "2e6 N mm"]),
        ("", 0.05, ["5 %", "0.05", "5 percent"]),
        ("N m", 0.0, ["0", "0.0", "-0", "0 kN m"]),
    ],
)
def test_a_text_with_its_unit_is_read(unit, value, texts):
    assert [_read(text, unit) for text in texts] == pytest.approx(
        [value] * len(texts), rel=4e-16
    )


@pytest.mark.parametrize("unit", [*UNITS, "N m/rad"])
def test_a_number_without_a_known_unit_is_refused_with_what_works(unit):
    """A unit that the table lacks is read as it is written."""
    assert _read(f"3e4 {unit}", unit) == 3e4
    known = f"known are (.*, )?{re.escape(unit)}"
    for text, fault in (
        ("1.5", "has no unit"),
        ("1.5 furlong", ": unknown unit 'furlong'"),
    ):
        with pytest.raises(InputError, match=f"key = '{text}'.*{fault}.*{known}"):
            _read(text, unit)


@pytest.mark.parametrize(
    ("unit", "texts"),
    [
        (
            "m",
            ["1 kg", "1 Mm", "1,5mm", "1.5", "", "1mm\n2mm", "0_8mm", "0.8m m", "٣m"],
        ),
        ("rad/s", ["3pi"]),
        ("", ["nan", "1e999", "1 2", "0.3m"]),
    ],
)
def test_a_text_that_is_no_quantity_is_refused(unit, texts):
    for text in texts:
        message = r"use a decimal point, '1\.5mm'" if "," in text else ""
        message += "a pure number, or one in %, is expected" * (text == "0.3m")
        with pytest.raises(InputError, match=r"^key = .*" + message):
            _read(text, unit)


@pytest.mark.parametrize(
    ("text", "suggested"),
    [
        ("400,000 N", ["400000 N", "400.000 N"]),
        ("400'000 N", ["400000 N"]),
        ("1,250.5 kN", ["1250.5 kN"]),
        ("1.250,5 kN", ["1250.5 kN"]),
        ("-1,250,000N", ["-1250000N"]),
        ("5,,5 N", []),
    ],
)
def test_a_number_with_commas_is_answered_with_numbers(text, suggested):
    with pytest.raises(InputError) as error:
        _read(text, "N")
    assert re.findall(r", '([^,']+)'", f"{error.value}") == suggested
    assert all(isinstance(_read(number, "N"), float) for number in suggested)


WHOLE = Quantity("", whole=True)


@pytest.mark.parametrize(
    ("meaning", "inside", "outside", "message"),
    [
        (Quantity("m", 0.0, 1.0), ["0m", "1m", 1], ["-1m", 1.1], "allowed is 0 to 1 m"),
        # In the unit of the text
        (
            Quantity("m", 0.0, 1.0),
            [],
            ["-1mm", "1100 mm"],
            "mm: allowed is 0 to 1000 mm",
        ),
        (
            Quantity("m", 0.0, 1.0, open_low=True),
            ["1e-9m"],
            ["0m", 2.0],
            "is above 0 up to 1 m",
        ),
        (Quantity("", 2.0), ["2", "1e300"], ["1.999"], "allowed is at least 2"),
        (Quantity("s", 0.0, open_low=True), ["1us"], ["0s"], "allowed is above 0 s"),
        (
            WHOLE,
            ["3", "3.0", " 3 "],
            ["3.5", "1e999", "-1e-9", True],
            "a whole number is expected",
        ),
        (Quantity("m"), [], [math.nan, math.inf, -math.inf], "any finite number in m"),
        # A value just outside is not rounded to one inside.
        (
            Quantity("", 0.0, 0.8),
            [],
            [math.nextafter(0.8, 1.0)],
            r"0\.8000000000000\d+: all",
        ),
    ],
)
def test_ranges(meaning: Quantity, inside, outside, message):
    for value in inside:
        assert isinstance(meaning.convert("key", value), int) == meaning.whole
    for value in outside:
        with pytest.raises(InputError, match=f"^key = .*{message}"):
            meaning.convert("key", value)


texts = st.text(max_size=30) | st.from_regex(
    r"[+-]?[0-9]{0,5}(\.[0-9]*)?(e[+-]?[0-9]{1,4})? ?(mm|m|pi|rad/s|kg|%|\s)?",
    fullmatch=True,
)


@given(texts, st.sampled_from(["", *UNITS]), st.booleans())
@example("٣m", "m", False)
@example("1\u2028m", "m", False)
@example("1e400m", "m", True)
@example("9" * 400, "", True)
@example("1m\n", "m", False)
@example("²", "", False)
def test_any_text_is_read_or_refused_in_one_line(text, unit, whole):
    refusal = ""
    try:
        value = parse_quantity("key", text, Quantity(unit, -1e3, 1e9, whole=whole))
    except InputError as error:
        refusal = str(error)
    if refusal:
        assert refusal.startswith("key = ")
        assert len(refusal.splitlines()) == 1
    else:
        assert -1e3 <= value <= 1e9
        assert isinstance(value, int) == whole


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(UNITS))
def test_a_number_as_python_prints_it_is_read_exactly(value, unit):
    plain = "/Pa" if unit == "1/Pa" else unit
    assert _read(f"{value!r} {plain}", unit) == value


def test_a_unit_of_another_quantity_is_answered_with_the_units_of_this_one():
    for unit in ("N", "mmm", "inch"):
        with pytest.raises(
            InputError, match=f"unit '{unit}'; known are m, cm, mm, um, µm, in$"
        ):
            _read(f"5 {unit}", "m")
