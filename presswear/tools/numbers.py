"""Texts of numbers."""

import math

from presswear.tools.errors import NARROW

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Factor from m^3 in a cycle to mm^3 in a million cycles
MM3_PER_MILLION = 1e15
# A mean with more decimals is not written to the digits of its interval
_MAX_DECIMALS = 6
_NO_SCATTER = 1e-6  # largest half width of equal samples, relative to the mean
# Smallest magnitude that is not printed as 0: its power of ten is a normal float
_MIN_VALUE = 1e-300
_LEAST_SHARE = 1e-4  # smallest share that is printed with digits

# By display unit: SI unit, factor from it, and smallest SI value that ``unit_scale`` shows in
# the display unit; inf: ``unit_scale`` does not use the display unit
DISPLAY_UNITS: dict[str, tuple[str, float, float]] = {
    "m": ("m", 1.0, 1.0),
    "mm": ("m", 1e3, 1e-3),
    "µm": ("m", 1e6, 1e-6),
    "nm": ("m", 1e9, 1e-9),
    "pm": ("m", 1e12, 0.0),
    "mm³": ("m^3", 1e9, 1e-12),
    "µm³": ("m^3", 1e18, 0.0),
    "kN": ("N", 1e-3, 1e4),
    "N": ("N", 1.0, 0.0),
    "kN m": ("N m", 1e-3, 1e4),
    "N m": ("N m", 1.0, 0.0),
    "kW": ("W", 1e-3, 1e3),
    "W": ("W", 1.0, 0.0),
    "MPa": ("Pa", 1e-6, 1e5),
    "kPa": ("Pa", 1e-3, 0.0),
    "MPa m/s": ("W/m^2", 1e-6, 1e5),
    "kPa m/s": ("W/m^2", 1e-3, 0.0),
    "ms": ("s", 1e3, math.inf),
    "µs": ("s", 1e6, math.inf),
    "kJ": ("J", 1e-3, 1e4),
    "J": ("J", 1.0, 1.0),
    "mJ": ("J", 1e3, 1e-3),
    "µJ": ("J", 1e6, 0.0),
    "degrees": ("rad", 180.0 / math.pi, math.inf),
    "°": ("rad", 180.0 / math.pi, math.inf),
    "µm/m": ("m/m", 1e6, 0.0),
    "%": ("", 100.0, math.inf),
    "million": ("", 1e-6, math.inf),
}
# Smallest magnitudes by SI unit that are more than round-off
_LEAST_VALUES = {"m": 1e-15, "m^3": 1e-24, "N m": 1e-15}


def _decimals(value: float, digits: int) -> int:
    """Return the number of decimals with which a value has ``digits`` significant digits.

    It is negative if the last digit is left of the decimal point.
    """
    return digits - 1 - math.floor(math.log10(abs(value)))


def _written(number: str, power: int = 0) -> str:
    """Return the text of a number with narrow spaces, a minus sign and a power of ten."""
    text = number.replace(",", NARROW).replace("-", "−")
    return f"{text}·10{str(power).translate(SUPERSCRIPT)}" if power else text


def readable(value: float | None, digits: int = 3) -> str:
    """Return a number with significant digits, with a power of a thousand where large or small."""
    if value is None or not math.isfinite(value):
        return "–"
    if abs(value) < _MIN_VALUE:
        return "0"
    rounded = round(value, _decimals(value, digits))
    power = 0
    if not 1e-2 <= abs(rounded) < 1e6:
        power = 3 * math.floor(math.log10(abs(rounded)) / 3.0)
        rounded /= 10.0**power
    return _written(f"{rounded:,.{max(_decimals(rounded, digits), 0)}f}", power)


def percent(share: float, digits: int = 3) -> str:
    """Return a share in per cent, without digits below 0.01 %."""
    if 0.0 < abs(share) < _LEAST_SHARE:
        return f"less than {100.0 * _LEAST_SHARE:g} %"
    return f"{readable(100.0 * share, digits)} %"


def duration_text(*seconds: float) -> str:
    """Return a time in words, or two as a range in two digits: ``5.2 to 21 minutes``."""
    digits = 2 if len(seconds) > 1 else 3
    for size, unit in ((86400.0, "days"), (3600.0, "hours"), (60.0, "minutes")):
        if max(seconds) >= 1.5 * size:
            return f"{' to '.join(f'{s / size:.{digits}g}' for s in seconds)} {unit}"
    return f"{' to '.join(f'{s:.2g}' for s in seconds)} s"


def count_scale(largest: float) -> tuple[float, str]:
    """Return factor and word of a large count; no word below a million."""
    for factor, word in ((1e-9, "billion"), (1e-6, "million")):
        if largest * factor >= 1.0:
            return factor, word
    return 1.0, ""


def large(*values: float, digits: int = 3) -> str:
    """Return counts in words, several as a range: ``8.7 to 9.5 million``."""
    largest = max(values)
    if largest <= 0.0:
        return "0"
    largest = round(largest, _decimals(largest, digits))
    factor, word = count_scale(largest)
    decimals = _decimals(factor * largest, digits)
    texts = []
    for value in values:
        text = f"{round(factor * value, decimals):,.{max(decimals, 0)}f}"
        if "." in text:
            text = text.rstrip("0").rstrip(".")
        texts.append(_written(text))
    return f"{' to '.join(texts)} {word}".rstrip()


def short_number(value: float) -> str:
    """Return a number in at most six digits, without trailing zeros."""
    mantissa, _, power = f"{value:.6g}".partition("e")
    return _written(mantissa, int(power or 0))


def whole(value: float | None) -> str:
    """Return a count with its thousands separated."""
    return "–" if value is None else _written(f"{round(value):,}")


def counted(count: int, word: str) -> str:
    """Return a count with its noun, in the plural unless it is one."""
    return f"{whole(count)} {word}" + ("" if count == 1 else "s")


def with_interval(mean: float | None, half_width: float | None) -> str:
    """Return a mean with the half width of its interval, to two digits of the latter."""
    if mean is None or not math.isfinite(mean):
        return "–"
    if half_width is None or not math.isfinite(half_width):
        return f"{readable(mean)} (too few cycles)"
    if half_width <= _NO_SCATTER * abs(mean):
        return readable(mean, 4)
    decimals = _decimals(half_width, 2)
    if decimals > _MAX_DECIMALS:
        return f"{readable(mean, 4)}\u00a0± {readable(half_width, 2)}"
    pair = (f"{round(n, decimals):,.{max(decimals, 0)}f}" for n in (mean, half_width))
    return "\u00a0± ".join(map(_written, pair))


def is_resolved(value: float, unit: str) -> bool:
    """Return whether an SI value, shown in a display unit, is more than round-off."""
    si_unit = DISPLAY_UNITS.get(unit, (unit, 1.0, 0.0))[0]
    return not abs(value) < _LEAST_VALUES.get(si_unit, 0.0)


def unit_factor(unit: str) -> float:
    """Return the factor from the SI value to a display unit; 1 for any SI unit."""
    return DISPLAY_UNITS.get(unit, (unit, 1.0, 0.0))[1]


def unit_scale(unit: str, largest: float) -> tuple[float, str]:
    """Return factor and display unit in which values of an SI unit up to the largest read well."""
    for display, (si, factor, smallest) in DISPLAY_UNITS.items():
        if si == unit and largest >= smallest:
            return factor, display
    return 1.0, unit


def quantity_text(value: float, unit: str) -> str:
    """Return a value of an SI unit with the display unit in which it reads well."""
    factor, display = unit_scale(unit, abs(value))
    return f"{readable(factor * value)} {display}".rstrip()
