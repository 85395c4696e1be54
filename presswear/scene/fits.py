"""ISO fits of pins in bearings: least and largest clearance of a fit such as 110 H8/f7.

The tables of ISO 286-1:2010 are in ``fits.toml``.
"""

import re
import tomllib
from bisect import bisect_left
from importlib.resources import files
from typing import NamedTuple

from presswear.tools.errors import InputError
from presswear.tools.quantities import written

_TABLES = tomllib.loads(
    files("presswear.scene").joinpath("fits.toml").read_text("utf-8")
)
_SIZES = _TABLES["sizes"]  # upper ends of the ranges of nominal sizes, mm
# by grade, um for each range
_TOLERANCES = {int(grade): row for grade, row in _TABLES["tolerances"].items()}
# Deviations by the letter of a shaft, um for each range
_DEVIATIONS = _TABLES["deviations"]
_FIT = re.compile(
    r"\s*(?:[Øø⌀]?\s*(\d+(?:\.\d+)?)(?:\s*mm)?\s*)?([A-Z]{1,2})(\d{1,2})\s*/\s*([a-z]{1,2})(\d{1,2})\s*"
)
_NEAR = 0.01  # greatest difference of the diameter of a bearing from that of its fit, relative


class Fit(NamedTuple):
    """Fit of a pin in a bearing: nominal diameter, m (None: not stated), and tolerance classes."""

    text: str
    diameter: float | None
    hole: str
    hole_grade: int
    shaft: str
    shaft_grade: int


def fit_of(text: object) -> Fit | None:
    """Return the fit that a text states; None for anything else.

    Raises
    ------
    InputError
        For a tolerance class whose clearance is not in the tables.
    """
    match = _FIT.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        return None
    size, hole, hole_grade, shaft, shaft_grade = match.groups()
    grades = int(hole_grade), int(shaft_grade)
    is_known = hole.lower() in _DEVIATIONS and shaft in _DEVIATIONS
    if not is_known or not set(grades) <= set(_TOLERANCES):
        raise InputError(
            f"fit {match[0].strip()}: allowed are holes D to H and pins d to h, which have "
            "clearance, of the grades 6 to 11, such as 110 H8/f7"
        )
    diameter = None if size is None else 1e-3 * float(size)
    return Fit(match[0].strip(), diameter, hole, grades[0], shaft, grades[1])


def clearances_of(fit: Fit, diameter: float) -> tuple[float, float]:
    """Return the least and the largest radial clearance of a fit, m.

    Parameters
    ----------
    diameter : float
        Diameter of the bearing, m.

    Raises
    ------
    InputError
        If the diameter is not that of the fit, or larger than the tables.
    """
    nominal = diameter if fit.diameter is None else fit.diameter
    if abs(nominal - diameter) > _NEAR * nominal:
        raise InputError(
            f"fit {fit.text}: the bearing has a diameter of {written(diameter, 'm')}; set "
            f"diameter = {written(nominal, 'm')}, or the fit without a diameter, "
            f"{fit.hole}{fit.hole_grade}/{fit.shaft}{fit.shaft_grade}"
        )
    place = bisect_left(_SIZES, round(1e3 * nominal, 9))
    if place == len(_SIZES):
        raise InputError(f"fit {fit.text}: allowed are diameters up to {_SIZES[-1]} mm")
    least = _DEVIATIONS[fit.hole.lower()][place] + _DEVIATIONS[fit.shaft][place]
    room = _TOLERANCES[fit.hole_grade][place] + _TOLERANCES[fit.shaft_grade][place]
    return 0.5e-6 * least, 0.5e-6 * (least + room)


def middle_of(fit: Fit, diameter: float) -> float:
    """Return the radial clearance in the middle of a fit, m; see ``clearances_of``."""
    return 0.5 * sum(clearances_of(fit, diameter))
