"""Units: their sizes, and the units in which engineers write a value."""

import math

_DEGREE = math.pi / 180.0
_PER_MINUTE = dict.fromkeys(
    ("rpm", "spm", "1/min", "/min", "rev/min", "r/min"), math.pi / 30.0
)
_PER_SECOND = dict.fromkeys(("rps", "rev/s", "r/s", "Hz"), 2.0 * math.pi)
# Sizes of units by the SI unit
UNITS: dict[str, dict[str, float]] = {
    "": {"": 1.0, "%": 0.01, "percent": 0.01},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "in": 0.0254},
    "rad/s": {"rad/s": 1.0, "deg/s": _DEGREE, **_PER_MINUTE, **_PER_SECOND},
    "rad": {"rad": 1.0, "deg": _DEGREE, "°": _DEGREE},
    "m/m": {"m/m": 1.0, "mm/m": 1e-3, "um/m": 1e-6, "µm/m": 1e-6},
    "kg": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "kg m^2": {
        "kg m^2": 1.0,
        "kgm^2": 1.0,
        "kg cm^2": 1e-4,
        "kg mm^2": 1e-6,
        "g mm^2": 1e-9,
    },
    "Pa": {
        "Pa": 1.0,
        "kPa": 1e3,
        "MPa": 1e6,
        "GPa": 1e9,
        "bar": 1e5,
        "N/m^2": 1.0,
        "N/mm^2": 1e6,
    },
    "W/m^2": {
        "W/m^2": 1.0,
        "Pa m/s": 1.0,
        **dict.fromkeys(("MPa m/s", "N/mm^2 m/s"), 1e6),
    },
    "1/Pa": {
        **dict.fromkeys(("1/Pa", "/Pa", "m^2/N"), 1.0),
        **dict.fromkeys(("1/MPa", "/MPa", "mm^2/N"), 1e-6),
        **dict.fromkeys(("mm^3/Nm", "mm^3/N m", "mm^3/(N m)"), 1e-9),
    },
    "Pa s": {"Pa s": 1.0, "Pas": 1.0, "mPa s": 1e-3, "mPas": 1e-3, "cP": 1e-3},
    "m^3": {"m^3": 1.0, "cm^3": 1e-6, "mm^3": 1e-9},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "m/min": 1.0 / 60.0},
    "m/s^2": {"m/s^2": 1.0, "mm/s^2": 1e-3},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0},
    "N/m": {
        "N/m": 1.0,
        "kN/m": 1e3,
        "N/mm": 1e3,
        "MN/m": 1e6,
        "kN/mm": 1e6,
        "MN/mm": 1e9,
        "GN/m": 1e9,
    },
    "N/m^n": dict.fromkeys(("N/m^n", "N/m^1.5", "N/m1.5", "N/m"), 1.0),
    "N": {"N": 1.0, "kN": 1e3, "MN": 1e6, "tf": 9806.65},
    "N m": {"N m": 1.0, "Nm": 1.0, "N mm": 1e-3, "Nmm": 1e-3, "kN m": 1e3, "kNm": 1e3},
    "N m/rad": {
        **dict.fromkeys(("N m/rad", "Nm/rad"), 1.0),
        **dict.fromkeys(("kN m/rad", "kNm/rad"), 1e3),
        **dict.fromkeys(("MN m/rad", "MNm/rad"), 1e6),
    },
    "N m s/rad": {
        **dict.fromkeys(("N m s/rad", "Nms/rad"), 1.0),
        **dict.fromkeys(("kN m s/rad", "kNms/rad"), 1e3),
    },
    "1/m": {"1/m": 1.0, "/m": 1.0, "1/mm": 1e3, "/mm": 1e3},
    "s/m": {"s/m": 1.0, "s/mm": 1e3},
    "N s/m": {"N s/m": 1.0, "Ns/m": 1.0, "N s/mm": 1e3, "Ns/mm": 1e3},
}
# Units in which engineers write a value, the largest first
WRITTEN_IN: dict[str, tuple[str, ...]] = {
    "m": ("mm",),
    "rad": ("deg",),
    "m/m": ("um/m",),
    "rad/s": ("rpm",),
    "W/m^2": ("MPa m/s",),
    "Pa": ("GPa", "MPa"),
    "N": ("kN", "N"),
    "N m": ("kN m", "N m"),
    "kg": ("kg", "g"),
    "kg m^2": ("kg m^2", "kg mm^2"),
    "1/Pa": ("mm^3/(N m)",),
    "m/s": ("m/s", "mm/s"),
    "s": ("s", "ms"),
    "N/m": ("kN/mm", "N/mm"),
}
