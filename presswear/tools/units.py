"""Units that people type, and numbers with a unit behind them."""

import math
import re

_UNITS: dict[str, tuple[str, dict[str, float]]] = {
    "m": ("0.8mm", {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "in": 0.0254}),
    "rad/s": (
        "3.5pi rad/s",
        {
            "rad/s": 1.0,
            "deg/s": math.pi / 180.0,
            **dict.fromkeys(("rpm", "1/min", "/min"), math.pi / 30.0),
            "Hz": 2.0 * math.pi,
        },
    ),
    "rad": ("30deg", {"rad": 1.0, "deg": math.pi / 180.0}),
    "kg": ("0.1kg", {"kg": 1.0, "g": 1e-3}),
    "kg m^2": ("1e-3kg m^2", dict.fromkeys(("kg m^2", "kgm^2"), 1.0)),
    "Pa": (
        "200GPa",
        {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5, "N/m^2": 1.0, "N/mm^2": 1e6},
    ),
    "1/Pa": (
        "1.2e-15/Pa",
        {
            **dict.fromkeys(("1/Pa", "/Pa", "m^2/N"), 1.0),
            **dict.fromkeys(("1/MPa", "/MPa", "mm^2/N"), 1e-6),
            **dict.fromkeys(("mm^3/Nm", "mm^3/N m", "mm^3/(N m)"), 1e-9),
        },
    ),
    "m^3": ("2mm^3", {"m^3": 1.0, "cm^3": 1e-6, "mm^3": 1e-9}),
    "m/s": ("1mm/s", {"m/s": 1.0, "mm/s": 1e-3, "m/min": 1.0 / 60.0}),
    "m/s^2": ("9.81m/s^2", {"m/s^2": 1.0, "mm/s^2": 1e-3}),
    "s": ("1ms", {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0}),
    "N/m": ("1e6N/m", {"N/m": 1.0, "kN/m": 1e3, "N/mm": 1e3, "kN/mm": 1e6}),
    "N/m^n": ("1e10N/m^1.5", dict.fromkeys(("N/m^n", "N/m^1.5", "N/m1.5", "N/m"), 1.0)),
    "N": ("500N", {"N": 1.0, "kN": 1e3, "MN": 1e6}),
    "N m": (
        "20N m",
        {"N m": 1.0, "Nm": 1.0, "N mm": 1e-3, "Nmm": 1e-3, "kN m": 1e3, "kNm": 1e3},
    ),
    "1/m": ("1e5/m", {"1/m": 1.0, "/m": 1.0, "1/mm": 1e3, "/mm": 1e3}),
    "s/m": ("10s/m", {"s/m": 1.0, "s/mm": 1e3}),
    "N s/m": ("100N s/m", {"N s/m": 1.0, "Ns/m": 1.0, "N s/mm": 1e3, "Ns/mm": 1e3}),
}
"""An example and the known units of each dimension, by its SI unit, and their sizes in it."""

_SIGNS = str.maketrans({"²": "^2", "³": "^3", "μ": "µ", "·": " ", "*": " ", "_": " "})
"""Signs of units in the one form in which units are known."""
_POWER = re.compile(r"(?<=[a-z])(?=[23]\b)")
"""Where a power has no sign, as in mm2."""
_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*)$")


def units_of(unit: str) -> tuple[str, dict[str, float]]:
    """An example of a dimension, by its SI unit, and its units; of a rare one that unit alone."""
    return _UNITS.get(unit, (f"1{unit}", {unit: 1.0}))


def apart(text: str) -> tuple[float, str] | None:
    """A number and the unit behind it, written as units are known; None without a number."""
    match = _NUMBER.match(text)
    if match is None:
        return None
    rest = _POWER.sub("^", match[2].translate(_SIGNS))
    return float(match[1]), re.sub(r"\s+", " ", rest).strip()


def in_si(value: float, written: str, unit: str) -> float | None:
    """A value with the unit that is written behind it, in the SI unit; None for no unit of it."""
    if written.startswith("pi") and unit in ("rad", "rad/s"):
        value, written = value * math.pi, written[2:].strip()
    size = units_of(unit)[1].get(written)
    return None if size is None else value * size
