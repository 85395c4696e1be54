"""Counterparts of the paper's figures 8 to 25, from the runs of a study."""

from collections.abc import Callable, Iterator

import matplotlib

from presswear.show.figures.style import SETTINGS, Drawing
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.figures.forces import contact_forces
from presswear.studies.paper.figures.lines import FRICTIONS, SPEEDS, WEARS, Line
from presswear.studies.paper.figures.motion import responses
from presswear.studies.paper.figures.paths import centre_paths
from presswear.studies.paper.figures.surfaces import surfaces
from presswear.studies.paper.figures.wear import depths

__all__ = ["paper_drawings"]

_Drawer = Callable[[Evidence, int, tuple[Line, ...]], Drawing | None]

# In the paper's order: section 5.3, then 5.4.
_FIGURES: tuple[tuple[int, _Drawer, tuple[Line, ...]], ...] = (
    (8, depths, WEARS),
    (9, surfaces("A"), WEARS),
    (10, surfaces("C"), WEARS),
    (11, depths, FRICTIONS),
    (12, surfaces("A"), FRICTIONS),
    (13, surfaces("C"), FRICTIONS),
    (14, depths, SPEEDS),
    (15, surfaces("A"), SPEEDS),
    (16, surfaces("C"), SPEEDS),
    (17, responses, WEARS),
    (18, contact_forces, WEARS),
    (19, centre_paths, WEARS),
    (20, responses, FRICTIONS),
    (21, contact_forces, FRICTIONS),
    (22, centre_paths, FRICTIONS),
    (23, responses, SPEEDS),
    (24, contact_forces, SPEEDS),
    (25, centre_paths, SPEEDS),
)


def paper_drawings(evidence: Evidence) -> Iterator[Drawing]:
    """Draw the figures for which there are runs, by their numbers in the paper."""
    for number, draw, lines in _FIGURES:
        with matplotlib.rc_context(SETTINGS):
            drawing = draw(evidence, number, lines)
        if drawing is not None:
            yield drawing
