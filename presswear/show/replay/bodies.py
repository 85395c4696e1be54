"""The bodies of any planar linkage as shapes: bars, plates, blocks, and the frame."""

import math
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import Guide
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.show.replay.reel import points_of
from presswear.show.replay.shapes import (
    Shape,
    around,
    box,
    circle,
    colour,
    filled,
    graphics,
    line,
    mixed,
    ring,
    text,
)

Array = NDArray[np.float64]

# The palette of Okabe and Ito, told apart with every common colour blindness.
_BODIES = ("#D55E00", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9")
INK = colour("#1a1a1a")
PAPER = colour("#ffffff")
STEEL = colour("#c9ced6")
JOINTS = tuple(colour(code) for code in ("#0072B2", "#D55E00", "#009E73", "#CC79A7"))
"""Colours of the first, second, ... clearance joint."""

_LAYER = 1e-3
"""Distance between two layers, part of the size of the picture."""


@dataclass(frozen=True)
class Scale:
    """Sizes that follow the size of the mechanism.

    Attributes
    ----------
    size : float
        Diagonal of all that moves, m.
    font : float
        Height of letters, pixels.
    """

    size: float
    font: float

    @property
    def bar(self) -> float:
        """Half width of a bar, m."""
        return 0.017 * self.size

    def layer(self, number: int) -> float:
        """Height of a layer, m."""
        return number * _LAYER * self.size


def attachments(linkage: Linkage, body: str) -> list[tuple[str, Attachment]]:
    """The points at which a body, or the frame, is joined to others, with the joints' names."""
    pairs = chain(
        ((joint.name, joint.first, joint.second) for joint in linkage.revolutes),
        ((joint.name, joint.bearing, joint.pin) for joint in linkage.clearances),
        ((spring.name, *spring.ends) for spring in linkage.springs),
    )
    return [(name, end) for name, *ends in pairs for end in ends if end.body == body]


def extent(linkage: Linkage, position: Array) -> tuple[Array, Array]:
    """Least and greatest x, y, m, of the box, with a margin, in which a linkage moves."""
    every = np.vstack(
        [
            points_of(linkage, position, point)[:, :2]
            for name in (GROUND, *(body.name for body in linkage.bodies))
            for _, point in attachments(linkage, name)
        ]
    )
    low, high = every.min(axis=0), every.max(axis=0)
    margin = 0.09 * float(np.hypot(*(high - low)))
    return low - margin, high + margin


def body_graphics(linkage: Linkage, body: str, scale: Scale) -> list[dict[str, Any]]:
    """A body in its own frame: joints, mass centre, names of its clearance joints."""
    ends = attachments(linkage, body)
    number = linkage.index(body)
    fill = colour(_BODIES[number % len(_BODIES)])
    edge = mixed(fill, INK, 0.55)
    low, high, top = (scale.layer(3 * number + i) for i in (4, 5, 6))
    own = [
        filled(_outline(linkage, body, scale, 0.0), low, edge),
        filled(_outline(linkage, body, scale, 0.22 * scale.bar), high, fill),
        filled(circle((0.0, 0.0), 0.16 * scale.bar, 12), scale.layer(39), edge),
    ]
    words = []
    bearings = {joint.bearing: k for k, joint in enumerate(linkage.clearances)}
    for name, end in ends:
        own += _pin_hole(end, scale, scale.layer(40))
        k = bearings.get(end)
        if k is not None:
            paint = JOINTS[k % len(JOINTS)]
            own.append(ring((end.x, end.y), 1.35 * scale.bar, 0.5 * scale.bar, top, paint))
            label = text((end.x, end.y), name, scale.layer(60), 1.4 * scale.font, INK)
            words.append({**label, "offset": [0.8, 0.5]})
    return [graphics(own), *words]


def _outline(linkage: Linkage, body: str, scale: Scale, inset: float) -> Array:
    """The edge of a body, moved inwards by a length, m: a block in a guide, else a bar or plate."""
    for guide in linkage.guides:
        if guide.body == body:
            size = (5.6 * scale.bar - 2.0 * inset, 4.4 * scale.bar - 2.0 * inset)
            return box((0.0, 0.0), size, guide.direction - guide.angle)
    points = np.array([[end.x, end.y] for _, end in attachments(linkage, body)])
    return around(points, scale.bar - inset)


def _pin_hole(end: Attachment, scale: Scale, z: float) -> list[Shape]:
    return [
        filled(circle((end.x, end.y), 0.55 * scale.bar, 24), z, INK),
        filled(circle((end.x, end.y), 0.35 * scale.bar, 24), z + scale.layer(1), PAPER),
    ]


def frame_graphics(linkage: Linkage, position: Array, scale: Scale) -> list[dict[str, Any]]:
    """The frame: pedestals of its joints, and the guides with the way of their sliders."""
    shapes: list[Shape] = []
    for _, point in attachments(linkage, GROUND):
        shapes += _pedestal(np.array([point.x, point.y]), scale)
    for guide in linkage.guides:
        shapes += _rails(guide, linkage, position, scale)
    return [graphics(shapes)] if shapes else []


def _pedestal(place: Array, scale: Scale) -> list[Shape]:
    half, depth = 2.2 * scale.bar, 3.4 * scale.bar
    foot, side = place - [0.0, depth], np.array([half, 0.0])
    shapes = [
        filled(np.array([place, foot - side, foot + side]), scale.layer(1), STEEL),
        filled(circle(place, 1.3 * scale.bar), scale.layer(2), STEEL),
    ]
    return shapes + _hatched(foot - 1.3 * side, foot + 1.3 * side, -1.0, scale)


def _hatched(start: Array, end: Array, side: float, scale: Scale) -> list[Shape]:
    """The edge of something fixed, hatched on one side: left for 1, right for -1."""
    width, z = 0.22 * scale.bar, scale.layer(1)
    along = end - start
    length = float(np.hypot(*along))
    ahead = along / length
    slant = 0.9 * scale.bar * (side * np.array([-ahead[1], ahead[0]]) - ahead)
    marks = np.linspace(0.0, 1.0, max(int(length / (0.9 * scale.bar)), 2))
    return [
        line(start, end, width, z, INK),
        *(line(start + s * along, start + s * along + slant, 0.6 * width, z, INK) for s in marks),
    ]


def _rails(guide: Guide, linkage: Linkage, position: Array, scale: Scale) -> list[Shape]:
    along = np.array([math.cos(guide.direction), math.sin(guide.direction)])
    across = np.array([-along[1], along[0]])
    base = np.array([guide.x, guide.y])
    centre = points_of(linkage, position, Attachment(guide.body, 0.0, 0.0))[:, :2]
    way = (centre - base) @ along
    first, last = way.min() - 4.0 * scale.bar, way.max() + 4.0 * scale.bar
    shapes: list[Shape] = []
    for side in (-1.0, 1.0):
        edge = base + side * 2.35 * scale.bar * across
        shapes += _hatched(edge + first * along, edge + last * along, side, scale)
    return shapes
