"""A clearance joint enlarged: bearing, pin, worn surfaces, contact, force, path of the pin.

Clearance and wear are enlarged alike, much more than the radius, so that pin and bearing
meet in the picture where they meet in the run.  The depth of wear is drawn once more, much
larger still, as a band behind each surface.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.surface import bin_centres
from presswear.show.replay.bodies import INK, PAPER, STEEL
from presswear.show.replay.reel import NORMAL, TANGENTIAL, X, Y
from presswear.show.replay.shapes import (
    Colour,
    Shape,
    arrow,
    band,
    circle,
    colour,
    filled,
    line,
    mixed,
    ring,
    strokes,
)

Array = NDArray[np.float64]

# Parts of the radius of the view: pin, play of the pin, band of wear; the rest is bearing.
_PIN, _PLAY, _BAND = 0.34, 0.36, 0.13
_ARROW = 0.55
"""Length of the arrow of the largest force, part of the radius of the view."""
_BINS = 180
"""Bins of a map as it is drawn: enough to look round."""
BODIES = 4
"""Bodies of the picture that a joint is: bearing, pin, and a mark on each."""
WORN = colour("#E69F00")
FORCE = colour("#c1121f")
_STEEL_PIN = colour("#9aa5b1")
_MARK = mixed(STEEL, INK, 0.6)


@dataclass(frozen=True)
class EnlargedJoint:
    """A clearance joint as it is drawn; its factors are rounded down to two digits.

    Attributes
    ----------
    joint : ClearanceJoint
        The joint with its surfaces.
    deepest : float
        Greatest depth of wear for which there is room, m.
    largest : float
        The force whose arrow has the length ``_ARROW`` of the radius, N; others are as long
        as the root of their part of it, so that a resting pin's is seen beside an impact's.
    centre : ndarray, shape (2,)
        Middle of the view, m.
    radius : float
        Radius of the view, m.
    paint : Colour
        Colour of the path and the words.
    """

    joint: ClearanceJoint
    deepest: float
    largest: float
    centre: Array
    radius: float
    paint: Colour

    @property
    def body(self) -> float:
        """Factor of the pin's radius."""
        return _two_digits(_PIN * self.radius / self.joint.pin_radius)

    @property
    def gap(self) -> float:
        """Factor of clearance, wear and motion of the pin."""
        return _two_digits(_PLAY * self.radius / (self.joint.clearance + 2.0 * self.deepest))

    @property
    def band(self) -> float:
        """Factor of the band that shows the wear once more."""
        return _two_digits(_BAND * self.radius / self.deepest) if self.deepest > 0.0 else 0.0

    def words(self) -> tuple[str, ...]:
        """The factors, to be written beside the view."""
        band = (f"orange: wear once more, x{self.band:.0f}",) if self.band > 0.0 else ()
        return (
            f"clearance, wear x{self.gap:.4g}; pin x{self.body:.3g}",
            *band,
            f"arrow: root of F, most {self.largest:.0f} N",
        )

    def bodies(self, layer: Callable[[int], float]) -> list[list[Shape]]:
        """Bearing, its mark, pin and its mark, each about its own centre.

        Parameters
        ----------
        layer : callable
            Height of a layer, m, from its number.
        """
        marks = [
            line((0.55 * radius, 0.0), (0.9 * radius, 0.0), 0.02 * self.radius, z, _MARK)
            for radius, z in (
                (self.radius, layer(73)),
                (self.body * self.joint.pin_radius, layer(78)),
            )
        ]
        return [self._bearing(layer), marks[:1], self._pin(layer), marks[1:]]

    def _bearing(self, layer: Callable[[int], float]) -> list[Shape]:
        """The bearing in the frame of its map."""
        depth = _drawn(self.joint.bearing_surface.depth)
        inner = self.body * self.joint.pin_radius + self.gap * (self.joint.clearance + depth)
        outer = np.full(len(depth), self.radius)
        edge = 0.012 * self.radius
        shapes = [
            band(_polar(inner), _polar(outer), layer(70), STEEL),
            band(_polar(inner), _polar(inner + edge), layer(72), INK),
            ring((0.0, 0.0), self.radius, edge, layer(72), INK),
        ]
        if depth.max() > 0.0:
            worn = np.minimum(inner + self.band * depth, outer)
            shapes.append(band(_polar(inner), _polar(worn), layer(71), WORN))
        return shapes

    def _pin(self, layer: Callable[[int], float]) -> list[Shape]:
        """The pin in the frame of its map."""
        depth = _drawn(self.joint.pin_surface.depth)
        outer = self.body * self.joint.pin_radius - self.gap * depth
        shapes = [
            filled(_polar(outer), layer(75), _STEEL_PIN),
            band(_polar(outer - 0.012 * self.radius), _polar(outer), layer(77), INK),
        ]
        if depth.max() > 0.0:
            worn = np.maximum(outer - self.band * depth, 0.0)
            shapes.append(band(_polar(worn), _polar(outer), layer(76), WORN))
        return shapes

    def coordinates(self, bearing: Array, pin: Array) -> list[Array]:
        """Coordinates of bearing, its mark, pin and its mark, from both poses, shape (3,)."""
        offset = self.gap * (pin - bearing)[:2]
        return [
            np.array([*place, angle])
            for place, pose in ((np.zeros(2), bearing), (offset, pin))
            for angle in (self._map_angle(pose), pose[2])
        ]

    def _map_angle(self, pose: Array) -> float:
        """Angle of a body's wear map, rad: a map that is fixed in direction does not turn."""
        return float(pose[2]) if self.joint.map_frame == "body" else 0.0

    def moving(
        self, bearing: Array, pin: Array, row: Array, layer: Callable[[int], float]
    ) -> list[Shape]:
        """Play and path of the pin, contact and force, from the last poses, shape (n, 3) each.

        Parameters
        ----------
        row : ndarray, shape (6,)
            Columns FILM_JOINT.
        layer : callable
            Height of a layer, m, from its number.
        """
        eccentricity = (pin - bearing)[:, :2]
        play = self.gap * self.joint.clearance
        return [
            ring(self.centre, play, 0.008 * self.radius, layer(85), mixed(STEEL, INK, 0.4)),
            *self._path(eccentricity, layer(86)),
            *self.contact(eccentricity[-1], self._map_angle(pin[-1]), row, layer(88)),
        ]

    def _path(self, eccentricity: Array, z: float) -> list[Shape]:
        """The way of the pin's centre, shape (n, 2), m, fading backwards in time."""
        if len(eccentricity) < 2:
            return []
        points = self.centre + self.gap * eccentricity
        pieces = len(points) - 1
        paints = [mixed(self.paint, PAPER, 0.85 * (1.0 - (i + 1) / pieces)) for i in range(pieces)]
        shapes = strokes(points, 0.016 * self.radius, z, paints)
        return [*shapes, filled(circle(points[-1], 0.03 * self.radius, 16), z, self.paint)]

    def contact(self, eccentricity: Array, turned: float, row: Array, z: float) -> list[Shape]:
        """Contact point and the force of the pin on the bearing; nothing where they are apart.

        Parameters
        ----------
        eccentricity : ndarray, shape (2,)
            m.
        turned : float
            Angle by which the pin's map is turned, rad.
        """
        if row[NORMAL] <= 0.0:
            return []
        normal = row[[X, Y]]
        depth = self.joint.pin_surface(np.array(math.atan2(row[Y], row[X]) - turned))
        arm = self.body * self.joint.pin_radius - self.gap * float(depth)
        point = self.centre + self.gap * eccentricity + arm * normal
        size = math.hypot(row[NORMAL], row[TANGENTIAL])
        length = _ARROW * self.radius * math.sqrt(size / self.largest)
        # The pin gets -F_n n + F_t t with t a quarter turn ahead of n, the bearing the opposite.
        force = row[NORMAL] * normal - row[TANGENTIAL] * np.array([-normal[1], normal[0]])
        return [
            filled(circle(point, 0.045 * self.radius, 20), z, FORCE),
            *arrow(point, length / size * force, 0.035 * self.radius, z, FORCE),
        ]


def _two_digits(value: float) -> float:
    """A number rounded down to two significant digits."""
    unit: float = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / unit) * unit


def _polar(radius: Array) -> Array:
    """Points at the bin centres of a map, shape (m, 2)."""
    angle = bin_centres(len(radius))
    return radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def _drawn(depth: Array) -> Array:
    """A map with about _BINS bins: means over neighbours, or each bin several times."""
    if not depth.size:
        return np.zeros(_BINS)
    parts = len(depth) // _BINS
    if parts < 2:
        return np.repeat(depth, math.ceil(_BINS / len(depth)))
    return np.array([part.mean() for part in np.array_split(depth, len(depth) // parts)])
