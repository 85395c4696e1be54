"""ISO fits of pins in bearings: least and largest clearance of a fit such as 110 H8/f7.

Source of the tables: ISO 286-1:2010 (standard tolerance grades, fundamental deviations),
from which the limit deviations of ISO 286-2:2010 follow.
"""

import re
from bisect import bisect_left
from typing import NamedTuple

from presswear.tools.errors import InputError
from presswear.tools.quantities import written

# Columns of a table are ranges of nominal sizes.
# fmt: off
# Upper ends of the ranges, mm; a range contains its upper end
_SIZES = (
    3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000
)
# Standard tolerances, um, by grade IT6 to IT11
_TOLERANCES = {
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40, 44, 50, 56, 66, 78, 92),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63, 70, 80, 90, 105, 125, 150),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97, 110, 125, 140, 165, 195, 230),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155, 175, 200, 230, 260, 310, 370),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250, 280, 320, 360, 420, 500, 600),
    11: (
        60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400, 440, 500, 560, 660, 780, 920
    ),
}
# Distances of pins and bores from the nominal size, um, by the letter of a shaft; those of a
# hole of the same letter, in capitals, are equal on the other side
_DEVIATIONS = {
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230, 260, 290, 320, 350, 390, 430),
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135, 145, 160, 170, 195, 220, 240),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68, 76, 80, 86, 98, 110, 120),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20, 22, 24, 26, 28, 30, 32),
    "h": (0,) * len(_SIZES),
}
# fmt: on
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
