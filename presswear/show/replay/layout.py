"""Places of press, enlarged joints, words and the bar of time in the picture."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_HEAD, _FOOT = 0.11, 0.09
"""Parts of the height for words above and the bar of time below."""
_MARGIN = 0.02


@dataclass(frozen=True)
class Panel:
    """The place of one reel in the picture; positions in m, in the picture's own plane.

    Attributes
    ----------
    offset : ndarray, shape (2,)
        Where the mechanism's origin is drawn.
    title : ndarray, shape (2,)
        Where words begin.
    joints : tuple of ndarray, shape (2,)
        Centres of the enlarged joints.
    radius : float
        Radius of an enlarged joint.
    """

    offset: Array
    title: Array
    joints: tuple[Array, ...]
    radius: float


@dataclass(frozen=True)
class Layout:
    """The whole picture, with its centre at the origin.

    Attributes
    ----------
    height : float
        Height that the window shows, m.
    panels : tuple of Panel
    bar : tuple of ndarray, shape (2,)
        Both ends of the bar of time.
    """

    height: float
    panels: tuple[Panel, ...]
    bar: tuple[Array, Array]


def layout_of(boxes: Sequence[tuple[Array, Array]], joints: Sequence[int], aspect: float) -> Layout:
    """Put one reel, or several side by side, into a picture.

    Parameters
    ----------
    boxes : sequence of (least, greatest)
        Corners of the box in which each mechanism moves, m.
    joints : sequence of int
        Number of clearance joints of each.
    aspect : float
        Width over height of the window.
    """
    # All lengths but those of the boxes are parts of the picture's height.
    width = aspect / len(boxes)
    inside, usable = width - 2.0 * _MARGIN, 1.0 - _HEAD - _FOOT
    most = max(joints)
    beside = len(boxes) == 1  # joints beside the mechanism, else below it
    if most == 0:
        room, radius = np.array([inside, usable]), 0.0
    elif beside:
        radius = min(0.34 * usable / most, 0.15 * width)
        room = np.array([inside - 3.4 * radius, usable])
    else:
        radius = min(0.13 * usable * 1.6, 0.36 * inside / most)
        room = np.array([inside, usable - 3.1 * radius])
    height = max(float(((greatest - least) / room).max()) for least, greatest in boxes)

    def panel(index: int) -> Panel:
        left, top = -0.5 * aspect + index * width, 0.5 - _HEAD
        least, greatest = boxes[index]
        count = joints[index]
        steps = (np.arange(count) + 0.5) / max(count, 1)
        if beside:
            column = np.full(count, left + width - _MARGIN - 1.65 * radius)
            places = np.column_stack([column, top - usable * steps])
        else:
            row = np.full(count, -0.5 + _FOOT + 1.35 * radius)
            places = np.column_stack([left + _MARGIN + inside * steps, row])
        middle = np.array([left + _MARGIN, top]) + 0.5 * room * (1.0, -1.0)
        return Panel(
            offset=height * middle - 0.5 * (least + greatest),
            title=height * np.array([left + _MARGIN, 0.5 - 0.045]),
            joints=tuple(height * places),
            radius=height * radius,
        )

    end = height * np.array([0.5 * aspect - 2.0 * _MARGIN, -0.5 + 0.4 * _FOOT])
    return Layout(height, tuple(map(panel, range(len(boxes)))), (end * (-1.0, 1.0), end))
