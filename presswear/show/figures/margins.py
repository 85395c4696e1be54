"""Margins of a grid of panels."""

import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.layout_engine import LayoutEngine

_EDGE = 0.05  # margin at the edge of a sheet, inches
_LINE = 0.15  # height of a line of text, inches
_LETTER = 0.07  # width of a digit, inches
# Gap between a panel and the numbers of its axis, and around a label, inches
_TICK = 0.09

# Space left of, right of, above and below a panel, inches
Room = tuple[float, float, float, float]


class Margins(LayoutEngine):
    """Margins of a grid of panels, from the number of lines and letters beside each panel.

    Matplotlib's constrained layout measures each text, which takes a third of the time
    of a figure. Colour bars, and legends beside a panel, need it.
    """

    _adjust_compatible = True
    _colorbar_gridspec = True

    def execute(self, fig: Any) -> None:
        """Set the margins of a sheet, matplotlib's ``Figure``, before it is drawn."""
        rooms = [
            (axes.get_subplotspec(), _room_around(axes))
            for axes in fig.axes
            if axes.axison
        ]
        grid = fig.axes[0].get_subplotspec().get_gridspec()
        width, height = fig.get_size_inches()
        right, above = (max(room[side] for _, room in rooms) for side in (1, 2))
        outer = max(room[0] for place, room in rooms if place.is_first_col())
        below = max(room[3] for place, room in rooms if place.is_last_row())
        beside = right + max(
            (r[0] for place, r in rooms if not place.is_first_col()), default=0.0
        )
        between = above + max(
            (r[3] for place, r in rooms if not place.is_last_row()), default=0.0
        )
        top = height - _EDGE - sum(map(_height_of, fig.legends)) - above
        wide = (width - outer - right - (grid.ncols - 1) * beside) / grid.ncols
        tall = (top - below - (grid.nrows - 1) * between) / grid.nrows
        fig.subplots_adjust(
            left=outer / width,
            right=1.0 - right / width,
            bottom=below / height,
            top=top / height,
            wspace=beside / wide,
            hspace=between / tall,
        )


def _room_around(axes: Axes) -> Room:
    """Return the room that numbers, labels and titles of a panel need."""
    left = _EDGE
    right = _EDGE
    above = _EDGE
    below = _EDGE
    titles = [axes.get_title(loc=place) for place in ("left", "center", "right")]
    if lines := max(map(_lines_of, titles)):
        above += _TICK + lines * _LINE
    if numbers := _numbers_of(axes.xaxis):
        below += _TICK + _LINE * max(map(_lines_of, numbers))
        right += 0.5 * _LETTER * _letters_of(numbers[-1])
    if numbers := _numbers_of(axes.yaxis):
        left += _TICK + _LETTER * max(map(_letters_of, numbers))
    if lines := _lines_of(axes.get_xlabel()):
        below += _TICK + lines * _LINE
    if lines := _lines_of(axes.get_ylabel()):
        left += _TICK + lines * _LINE
    return left, right, above, below


def _numbers_of(axis: Axis) -> list[str]:
    """Return the numbers of an axis; none if they are not shown."""
    side = "labelleft" if axis is axis.axes.yaxis else "labelbottom"
    if not axis.get_tick_params()[side]:
        return []
    low, high = sorted(axis.get_view_interval())
    result = []
    for places, formatter in (
        (axis.get_minorticklocs(), axis.get_minor_formatter()),
        (axis.get_majorticklocs(), axis.get_major_formatter()),
    ):
        texts = zip(
            places, formatter.format_ticks(list(map(float, places))), strict=True
        )
        result += [text for place, text in texts if low <= place <= high]
    return result


def _lines_of(text: str) -> int:
    return text.count("\n") + 1 if text else 0


def _letters_of(text: str) -> int:
    return max(map(len, text.split("\n")))


def _height_of(legend: Any) -> float:
    """Return the height of a legend above the panels, inches."""
    rows = math.ceil(len(legend.get_texts()) / legend._ncols)
    return float(rows * 1.2 * _LINE + _TICK)
