"""Where press, enlarged joints, words and the bar of time are in the picture."""

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
        From the mechanism's origin to where that is drawn.
    title : ndarray, shape (2,)
        Where words begin.
    joints : tuple of ndarray, shape (2,)
        Centres of the enlarged joints.
    radius : float
        Of an enlarged joint.
    """

    offset: Array
    title: Array
    joints: tuple[Array, ...]
    radius: float


@dataclass(frozen=True)
class Layout:
    """The whole picture.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        m.
    height : float
        What the window shows, m.
    panels : tuple of Panel
    bar : tuple of ndarray, shape (2,)
        Both ends of the bar of time.
    """

    centre: Array
    height: float
    panels: tuple[Panel, ...]
    bar: tuple[Array, Array]


def layout_of(boxes: Sequence[tuple[Array, Array]], joints: Sequence[int], aspect: float) -> Layout:
    """Put one reel, or several side by side, into a picture.

    Parameters
    ----------
    boxes : sequence of (least, greatest)
        What each mechanism reaches, m.
    joints : sequence of int
        Clearance joints of each.
    aspect : float
        Width over height of the window.
    """
    count = len(boxes)
    width = aspect / count
    usable = 1.0 - _HEAD - _FOOT
    beside = count == 1  # joints beside the mechanism, else below it
    most = max(joints)
    if most == 0:
        room, radius = (width - 2.0 * _MARGIN, usable), 0.0
    elif beside:
        radius = min(0.34 * usable / most, 0.15 * width)
        room = (width - 2.0 * _MARGIN - 3.4 * radius, usable)
    else:
        radius = min(0.13 * usable * 1.6, 0.36 * (width - 2.0 * _MARGIN) / most)
        room = (width - 2.0 * _MARGIN, usable - 3.1 * radius)
    sizes = [greatest - least for least, greatest in boxes]
    height = max(max(size[0] / room[0], size[1] / room[1]) for size in sizes)
    return Layout(
        centre=np.zeros(2),
        height=float(height),
        panels=tuple(
            _panel(box, number, i, (aspect, width), room, radius, float(height))
            for i, (box, number) in enumerate(zip(boxes, joints, strict=True))
        ),
        bar=(
            height * np.array([-0.5 * aspect + 2.0 * _MARGIN, -0.5 + 0.4 * _FOOT]),
            height * np.array([0.5 * aspect - 2.0 * _MARGIN, -0.5 + 0.4 * _FOOT]),
        ),
    )


def _panel(
    box: tuple[Array, Array],
    joints: int,
    index: int,
    widths: tuple[float, float],
    room: tuple[float, float],
    radius: float,
    height: float,
) -> Panel:
    """A panel from its measures in parts of the picture's height."""
    aspect, width = widths
    left, top = -0.5 * aspect + index * width, 0.5 - _HEAD
    beside = width == aspect
    middle = np.array([left + _MARGIN + 0.5 * room[0], top - 0.5 * room[1]])
    if beside:
        column = left + width - _MARGIN - 1.65 * radius
        step = (1.0 - _HEAD - _FOOT) / max(joints, 1)
        places = [np.array([column, top - (k + 0.5) * step]) for k in range(joints)]
    else:
        step = (width - 2.0 * _MARGIN) / max(joints, 1)
        row = -0.5 + _FOOT + 1.35 * radius
        places = [np.array([left + _MARGIN + (k + 0.5) * step, row]) for k in range(joints)]
    return Panel(
        offset=height * middle - 0.5 * (box[0] + box[1]),
        title=height * np.array([left + _MARGIN, 0.5 - 0.045]),
        joints=tuple(height * place for place in places),
        radius=height * radius,
    )
