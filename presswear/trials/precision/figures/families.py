"""How a family of methods looks in every picture: colour, dashes and marker."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from matplotlib.lines import Line2D

from presswear.show.figures.style import LINES, REFERENCE, LineStyle, Sheet
from presswear.trials.precision.points import Method


@dataclass(frozen=True)
class Look:
    """Of a family; each alone tells it from the others."""

    colour: str
    dashes: LineStyle
    marker: str

    def line(self, **others: Any) -> dict[str, Any]:
        """Arguments of a curve."""
        return {
            "color": self.colour,
            "linestyle": self.dashes,
            "marker": self.marker,
            "markersize": 4.5,
            "markeredgewidth": 0.8,
            **others,
        }


_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_SKY = ("#56B4E9", (0.0, (4.0, 1.0, 1.0, 1.0, 1.0, 1.0)))
_GREY = ("0.35", (0.0, (1.0, 2.2)))
_STYLES: tuple[tuple[str, LineStyle], ...] = (*LINES, _SKY, _GREY)
LOOKS = tuple(Look(*style, marker) for style, marker in zip(_STYLES, _MARKERS, strict=True))
_KNOWN = (
    "exudyn-tree, DOPRI5",
    "dae, DOP853",
    "dae, DOPRI5",
    "dae, RK4",
    "exudyn-joints, trapezoidal rule",
    "exudyn-joints, trapezoidal rule, equal steps",
)


def look_of(family: str) -> Look:
    """The same in all pictures."""
    return LOOKS[_KNOWN.index(family)] if family in _KNOWN else LOOKS[-1]


RING: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 10.0,
    "markerfacecolor": "none",
    "markeredgecolor": REFERENCE,
    "markeredgewidth": 0.9,
}
"""Around what scenes take by themselves."""
STAR: dict[str, Any] = {
    "linestyle": "none",
    "marker": "*",
    "markersize": 10.0,
    "markerfacecolor": "white",
    "markeredgecolor": REFERENCE,
    "markeredgewidth": 1.0,
}
"""The paper's own setting."""
FAILED: dict[str, Any] = {
    "linestyle": "none",
    "marker": "x",
    "markersize": 5.0,
    "markeredgewidth": 1.4,
}
"""A method that failed."""
PAPER = "paper, RK4 at 1e-4 s"


def family_handles(families: Iterable[str]) -> list[Line2D]:
    """Families in a legend."""
    return [Line2D([], [], label=name, **look_of(name).line()) for name in families]


def mark_handles(methods: Iterable[Method], failed: bool) -> list[Line2D]:
    """What the other marks mean, of those that some methods need."""
    known = list(methods)
    handles = []
    if any(method.is_default for method in known):
        handles.append(Line2D([], [], label="taken by default", **RING))
    if any(method.is_paper for method in known):
        handles.append(Line2D([], [], label=PAPER, **STAR))
    if failed:
        handles.append(Line2D([], [], color=REFERENCE, label="failed", **FAILED))
    return handles


def legend_above(sheet: Sheet, handles: list[Line2D], columns: int) -> None:
    """A legend over all panels."""
    sheet.legend(handles=handles, loc="outside upper left", ncols=columns)
