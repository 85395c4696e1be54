"""Margins of a grid of panels."""

import math
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.layout_engine import LayoutEngine

_EDGE = 0.05  # margin at the edge of a sheet, inches
_LINE = 0.15  # height of a line of text, inches
_LETTER = 0.07  # width of a digit, inches
# Gap between a panel and the numbers of its axis, and around a label, inches
_TICK = 0.09


class _Room(NamedTuple):
    """Space beside a panel, inches."""

    left: float
    right: float
    above: float
    below: float


class Margins(LayoutEngine):
    """Margins of a grid of panels, from the number of lines and letters beside each panel.

    Matplotlib's constrained layout measures each text, which takes a third of the time
    of a figure. Colour bars, and legends beside a panel, need it.
    """

    _adjust_compatible = True
    _colorbar_gridspec = True

    def execute(self, fig: Any) -> None:
        """Set the margins of a sheet, matplotlib's ``Figure``, before it is drawn."""
        right = above = outer_left = inner_left = outer_below = inner_below = 0.0
        for axes in fig.axes:
            if not axes.axison:
                continue
            place = axes.get_subplotspec()
            room = _room_around(axes)
            right = max(right, room.right)
            above = max(above, room.above)
            if place.is_first_col():
                outer_left = max(outer_left, room.left)
            else:
                inner_left = max(inner_left, room.left)
            if place.is_last_row():
                outer_below = max(outer_below, room.below)
            else:
                inner_below = max(inner_below, room.below)
        grid = fig.axes[0].get_subplotspec().get_gridspec()
        width, height = fig.get_size_inches()
        column_gap = right + inner_left
        row_gap = above + inner_below
        top = height - _EDGE - sum(map(_height_of, fig.legends)) - above
        gaps = (grid.ncols - 1) * column_gap
        panel_width = (width - outer_left - right - gaps) / grid.ncols
        gaps = (grid.nrows - 1) * row_gap
        panel_height = (top - outer_below - gaps) / grid.nrows
        fig.subplots_adjust(
            left=outer_left / width,
            right=1.0 - right / width,
            bottom=outer_below / height,
            top=top / height,
            wspace=column_gap / panel_width,
            hspace=row_gap / panel_height,
        )


def _room_around(axes: Axes) -> _Room:
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
    return _Room(left, right, above, below)


def _numbers_of(axis: Axis) -> list[str]:
    """Return the numbers of an axis; none if they are not shown."""
    side = "labelleft" if axis is axis.axes.yaxis else "labelbottom"
    if not axis.get_tick_params()[side]:
        return []
    low, high = sorted(axis.get_view_interval())
    result = []
    for ticks, formatter in (
        (axis.get_minorticklocs(), axis.get_minor_formatter()),
        (axis.get_majorticklocs(), axis.get_major_formatter()),
    ):
        texts = formatter.format_ticks(list(map(float, ticks)))
        for tick, text in zip(ticks, texts, strict=True):
            if low <= tick <= high:
                result.append(text)
    return result


def _lines_of(text: str) -> int:
    return text.count("\n") + 1 if text else 0


def _letters_of(text: str) -> int:
    return max(map(len, text.split("\n")))


def _height_of(legend: Any) -> float:
    """Return the height of a legend above the panels, inches."""
    rows = math.ceil(len(legend.get_texts()) / legend._ncols)
    return float(rows * 1.2 * _LINE + _TICK)
