"""Parts that all pictures share: looks of families, marks, scales, sheets of panels."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axis import Axis
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from matplotlib.transforms import ScaledTranslation

from presswear.show.figures.style import LINES, REFERENCE, WIDTH, Axes, LineStyle, Sheet
from presswear.validation.precision.methods import Method


@dataclass(frozen=True)
class Look:
    """Colour, dashes and marker of a family; each alone tells it from the others."""

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


def _mark(marker: str, size: float, width: float, **others: Any) -> dict[str, Any]:
    """Look of a mark that stands alone."""
    own = {"marker": marker, "markersize": size, "markeredgewidth": width}
    return {"linestyle": "none", **own, **others}


RING = _mark("o", 10.0, 0.9, markeredgecolor=REFERENCE, markerfacecolor="none")
"""Around what scenes take by themselves."""
STAR = _mark("*", 10.0, 1.0, markeredgecolor=REFERENCE, markerfacecolor="white")
"""The paper's own setting."""
FAILED = _mark("x", 5.0, 1.4)
"""A method that failed."""
PAPER = "paper, RK4 at 1e-4 s"


def look_of(family: str) -> Look:
    """The look that a family has in all pictures."""
    return LOOKS[_KNOWN.index(family)] if family in _KNOWN else LOOKS[-1]


def panels(count: int, extra: float, height: float, **others: Any) -> tuple[Sheet, list[Axes]]:
    """A sheet with panels in two columns; what is left over of them is blank.

    Parameters
    ----------
    extra, height : float
        Heights of what is not panels, and of a row of them, inches.
    """
    rows = math.ceil(count / 2)
    sheet = Sheet(figsize=(WIDTH, extra + height * rows), layout="constrained")
    found = list(sheet.subplots(rows, 2, squeeze=False, **others).ravel())
    for axes in found[count:]:
        axes.set_axis_off()
    return sheet, found[:count]


def legend_above(
    sheet: Sheet,
    families: Iterable[str],
    methods: Iterable[Method],
    failed: bool,
    others: Sequence[Line2D] = (),
) -> None:
    """A legend over all panels: families, the marks that some methods need, and others."""
    known = list(methods)
    handles = [Line2D([], [], label=name, **look_of(name).line()) for name in families]
    if any(method.is_default for method in known):
        handles.append(Line2D([], [], label="taken by default", **RING))
    if any(method.is_paper for method in known):
        handles.append(Line2D([], [], label=PAPER, **STAR))
    if failed:
        handles.append(Line2D([], [], color=REFERENCE, label="failed", **FAILED))
    sheet.legend(handles=[*handles, *others], loc="outside upper left", ncols=2)


def plain_labels(axis: Axis) -> None:
    """Write the labels of a logarithmic axis without powers of ten."""
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def log_labels(axis: Axis) -> None:
    """Label a logarithmic axis at 1, 2 and 5 where it spans too little for powers of ten."""
    low, high = sorted(axis.get_view_interval())
    axis.set_minor_formatter(NullFormatter())
    if high / low < 30.0:
        subs = (1.0, 2.0, 5.0) if high / low > 4.0 else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
        axis.set_major_locator(LogLocator(subs=subs))
        plain_labels(axis)


def pad_y(axes: Axes) -> None:
    """Leave room above and below the curves."""
    low, high = axes.get_ylim()
    axes.set_ylim(low / 2.0, high * 2.0)


_STRIP, _FIRST, _NEXT = 1.0, 34.0, 9.0
"""Height of the strip over a panel, part of the panel, and places of its marks, points."""


def failed_strip(axes: Axes, methods: Iterable[Method]) -> None:
    """Mark what failed in a strip over a panel: it has neither error nor time."""
    # The paper's own first, then family by family.
    failed = sorted(methods, key=lambda method: not method.is_paper)
    if not failed:
        return

    def over(right: float) -> dict[str, Any]:
        """Place over the upper left corner, so many points to the right."""
        moved = ScaledTranslation(right / 72.0, 7.0 / 72.0, axes.figure.dpi_scale_trans)
        return {"transform": axes.transAxes + moved, "clip_on": False}

    axes.text(0.0, _STRIP, "failed:", va="center", **over(0.0))
    for place, method in enumerate(failed):
        at = over(_FIRST + _NEXT * place)
        if method.is_paper:
            axes.plot(0.0, _STRIP, zorder=4.0, gid="paper", **STAR, **at)
        else:
            colour = look_of(method.family).colour
            axes.plot(0.0, _STRIP, color=colour, gid="failed", **FAILED, **at)
