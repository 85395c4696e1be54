"""Counterparts of the paper's figures 8 to 25, from the runs of a study."""

from collections.abc import Callable
from functools import partial

import matplotlib

from presswear.paper.evidence import Evidence
from presswear.paper.figures.lines import FRICTIONS, SPEEDS, WEARS, Drawn, Lines
from presswear.paper.figures.response import centre_paths, contact_forces, responses
from presswear.paper.figures.wear import depths, surfaces
from presswear.paper.variants import BASE, variant_key
from presswear.paper.variants import SETTINGS as RUN_SETTINGS
from presswear.show.figures.style import SETTINGS, Drawing
from presswear.show.page import Drawer

_Figure = Callable[[Evidence, int, Lines], Drawn]
"""Draws a figure of the paper, given by its number, from its lines."""

_AT_A: _Figure = partial(surfaces, "A")
_AT_C: _Figure = partial(surfaces, "C")
_FIGURES: dict[int, tuple[_Figure, Lines, str]] = {
    8: (depths, WEARS, "Wear depth after the first and the second wear"),
    9: (_AT_A, WEARS, "Worn surfaces at A after the first and the second wear"),
    10: (_AT_C, WEARS, "Worn surfaces at C after the first and the second wear"),
    11: (depths, FRICTIONS, "Wear depth after the first wear at two friction coefficients"),
    12: (_AT_A, FRICTIONS, "Worn surfaces at A after the first wear at two friction coefficients"),
    13: (_AT_C, FRICTIONS, "Worn surfaces at C after the first wear at two friction coefficients"),
    14: (depths, SPEEDS, "Wear depth after the first wear at two speeds"),
    15: (_AT_A, SPEEDS, "Worn surfaces at A after the first wear at two speeds"),
    16: (_AT_C, SPEEDS, "Worn surfaces at C after the first wear at two speeds"),
    17: (responses, WEARS, "Motion of the slider with the wears"),
    18: (contact_forces, WEARS, "Contact force with the wears"),
    19: (centre_paths, WEARS, "Path of the pin centre with the wears"),
    20: (responses, FRICTIONS, "Motion of the slider at two friction coefficients"),
    21: (contact_forces, FRICTIONS, "Contact force at two friction coefficients"),
    22: (centre_paths, FRICTIONS, "Path of the pin centre at two friction coefficients"),
    23: (responses, SPEEDS, "Motion of the slider at two speeds"),
    24: (contact_forces, SPEEDS, "Contact force at two speeds"),
    25: (centre_paths, SPEEDS, "Path of the pin centre at two speeds"),
}
"""Drawer, lines and title by the number in the paper."""


def drawers(evidence: Evidence) -> list[Drawer]:
    """What draws the figures, by their numbers in the paper; it holds the runs that they show."""
    keys = [variant_key(BASE, setting) for setting in RUN_SETTINGS]
    shown = Evidence({key: evidence.results[key] for key in keys if key in evidence.results})
    return [partial(_drawn, shown, number) for number in _FIGURES]


def _drawn(evidence: Evidence, number: int) -> list[Drawing]:
    """Draw a figure; nothing where there are no runs for it."""
    draw, lines, title = _FIGURES[number]
    with matplotlib.rc_context(SETTINGS):
        drawn = draw(evidence, number, lines)
    if drawn is None:
        return []
    return [Drawing(f"fig-{number:02d}.png", f"Fig. {number} {title}", *drawn)]
