"""Numbers as people read them."""

import math


def _decimals(value: float, digits: int) -> int:
    """Decimals that leave a number its significant digits; negative left of the point."""
    return digits - 1 - math.floor(math.log10(abs(value)))


def readable(value: float | None, digits: int = 3) -> str:
    """A number with some significant digits, as powers of a thousand where very large or small."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    rounded = round(value, _decimals(value, digits))
    if 1e-2 <= abs(rounded) < 1e6:
        return f"{rounded:,.{max(_decimals(rounded, digits), 0)}f}".replace(",", "\u202f")
    power = 3 * math.floor(math.log10(abs(rounded)) / 3.0)
    superscript = str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{readable(rounded / 10.0**power, digits)}·10{superscript}"


def whole(value: float | None) -> str:
    """A count, its thousands set apart."""
    return "–" if value is None else f"{round(value):,}".replace(",", "\u202f")


def with_interval(mean: float | None, half_width: float | None) -> str:
    """A mean with the half width of its interval, to two digits of the latter."""
    if mean is None or not math.isfinite(mean):
        return "–"
    if half_width is None or not math.isfinite(half_width):
        return f"{readable(mean)} (too few cycles)"
    if half_width == 0.0 or abs(half_width) < 1e-9 * abs(mean):
        return f"{readable(mean, 4)} ± {readable(half_width, 2)}"
    decimals = _decimals(half_width, 2)
    if decimals > 6:
        return f"{readable(mean)} ± {readable(half_width, 2)}"
    places = max(decimals, 0)
    pair = f"{round(mean, decimals):,.{places}f} ± {round(half_width, decimals):,.{places}f}"
    return pair.replace(",", "\u202f")
