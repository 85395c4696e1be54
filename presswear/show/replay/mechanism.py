"""Drawing of a planar linkage: bodies, frame, and enlarged joints with clearance.

In an enlarged joint, clearance and wear have the same scale, much larger than that of the radius,
so that pin and bearing touch in the drawing when they touch in the run. The wear depth is drawn
again, with a larger scale, as a band behind each surface.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Attachment, ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import bin_centres
from presswear.show.replay.clip import NORMAL, TANGENTIAL, X, Y, points_of
from presswear.show.replay.shapes import (
    Colour,
    Shape,
    arrow,
    band,
    circle,
    colour,
    filled,
    graphics,
    line,
    mix,
    rectangle,
    ring,
    rounded_hull,
    strokes,
    text,
)

Array = NDArray[np.float64]
Layer = Callable[[int], float]

# Palette of Okabe and Ito, distinguishable with every common colour blindness.
BODY_COLOURS = ("#D55E00", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9")
JOINT_COLOURS = tuple(colour(code) for code in ("#0072B2", "#D55E00", "#009E73", "#CC79A7"))
INK, PAPER, STEEL = colour("#1a1a1a"), colour("#ffffff"), colour("#c9ced6")
WORN, FORCE, PIN = colour("#E69F00"), colour("#c1121f"), colour("#9aa5b1")
MARK = mix(STEEL, INK, 0.6)
LAYER_STEP = 1e-3  # distance of two layers over the size of the mechanism
PIN_SHARE, PLAY_SHARE, BAND_SHARE = 0.34, 0.36, 0.13  # of the radius of an enlarged joint
ARROW_SHARE = 0.55  # length of the arrow of the largest force over that radius
DRAWN_BINS = 180  # of a wear map
BODIES_PER_JOINT = 4  # bearing, pin, and a mark on each


@dataclass(frozen=True)
class Scale:
    """Diagonal of the box in which the mechanism moves, m, and height of letters, pixels."""

    size: float
    font: float

    @property
    def bar(self) -> float:
        """Half width of a bar, m."""
        return 0.017 * self.size

    def layer(self, number: int) -> float:
        """Return the height of a layer, m."""
        return number * LAYER_STEP * self.size


def attachments(linkage: Linkage, body: str) -> list[tuple[str, Attachment]]:
    """Return joint names and points at which a body, or the ground, is connected."""
    pairs = chain(
        ((joint.name, joint.first, joint.second) for joint in linkage.revolutes),
        ((joint.name, joint.bearing, joint.pin) for joint in linkage.clearances),
        ((spring.name, *spring.ends) for spring in linkage.springs),
    )
    return [(name, end) for name, *ends in pairs for end in ends if end.body == body]


def bounding_box(linkage: Linkage, positions: Array) -> tuple[Array, Array]:
    """Return the lowest and highest x, y, m, of a moving linkage with a margin."""
    names = [GROUND, *(body.name for body in linkage.bodies)]
    ends = [point for name in names for _, point in attachments(linkage, name)]
    points = np.vstack([points_of(linkage, positions, point)[:, :2] for point in ends])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.09 * float(np.hypot(*(high - low)))
    return low - margin, high + margin


def body_graphics(linkage: Linkage, body: str, scale: Scale) -> list[dict[str, Any]]:
    """Return a body in its own frame with its holes, mass centre and joint names."""
    number, bar, layer = linkage.index(body), scale.bar, scale.layer
    fill = colour(BODY_COLOURS[number % len(BODY_COLOURS)])
    edge = mix(fill, INK, 0.55)
    points = np.array([[end.x, end.y] for _, end in attachments(linkage, body)])
    # A block in a guide, otherwise a bar or a plate.
    guide = next((guide for guide in linkage.guides if guide.body == body), None)
    shapes = [filled(circle((0.0, 0.0), 0.16 * bar, 12), layer(39), edge)]
    for inset, z, paint in ((0.0, 4, edge), (0.22 * bar, 5, fill)):
        if guide is None:
            outline = rounded_hull(points, bar - inset)
        else:
            size = (5.6 * bar - 2.0 * inset, 4.4 * bar - 2.0 * inset)
            outline = rectangle(size, guide.direction - guide.angle)
        shapes.append(filled(outline, layer(3 * number + z), paint))
    labels = []
    bearings = {joint.bearing: k for k, joint in enumerate(linkage.clearances)}
    for name, end in attachments(linkage, body):
        centre = (end.x, end.y)
        shapes.append(filled(circle(centre, 0.55 * bar, 24), layer(40), INK))
        shapes.append(filled(circle(centre, 0.35 * bar, 24), layer(41), PAPER))
        if end in bearings:
            paint = JOINT_COLOURS[bearings[end] % len(JOINT_COLOURS)]
            shapes.append(ring(centre, 1.35 * bar, 0.5 * bar, layer(3 * number + 6), paint))
            label = text(centre, name, layer(60), 1.4 * scale.font, INK)
            labels.append({**label, "offset": [0.8, 0.5]})
    return [graphics(shapes), *labels]


def frame_graphics(linkage: Linkage, positions: Array, scale: Scale) -> list[dict[str, Any]]:
    """Return the pedestals of the ground joints and the guides along the path of their bodies."""
    shapes: list[Shape] = []
    bar = scale.bar
    for _, point in attachments(linkage, GROUND):
        centre = np.array([point.x, point.y])
        foot, side = centre - [0.0, 3.4 * bar], np.array([2.2 * bar, 0.0])
        shapes.append(filled(np.array([centre, foot - side, foot + side]), scale.layer(1), STEEL))
        shapes.append(filled(circle(centre, 1.3 * bar), scale.layer(2), STEEL))
        shapes += _hatched(foot - 1.3 * side, foot + 1.3 * side, -1.0, scale)
    for guide in linkage.guides:
        direction = np.array([math.cos(guide.direction), math.sin(guide.direction)])
        normal, base = np.array([-direction[1], direction[0]]), np.array([guide.x, guide.y])
        centre = points_of(linkage, positions, Attachment(guide.body, 0.0, 0.0))[:, :2]
        travel = (centre - base) @ direction
        ends = np.outer([travel.min() - 4.0 * bar, travel.max() + 4.0 * bar], direction)
        for sign in (-1.0, 1.0):
            start, end = base + sign * 2.35 * bar * normal + ends
            shapes += _hatched(start, end, sign, scale)
    return [graphics(shapes)] if shapes else []


def _hatched(start: Array, end: Array, side: float, scale: Scale) -> list[Shape]:
    """Return a fixed edge, hatched on the left for side = 1 and on the right for -1."""
    width, z = 0.22 * scale.bar, scale.layer(1)
    vector = end - start
    length = float(np.hypot(*vector))
    direction = vector / length
    slant = 0.9 * scale.bar * (side * np.array([-direction[1], direction[0]]) - direction)
    marks = np.linspace(0.0, 1.0, max(int(length / (0.9 * scale.bar)), 2))
    feet = start + np.outer(marks, vector)
    lines = [line(foot, foot + slant, 0.6 * width, z, INK) for foot in feet]
    return [line(start, end, width, z, INK), *lines]


@dataclass(frozen=True)
class EnlargedJoint:
    """Joint with clearance, enlarged; its scale factors are rounded down to two digits.

    Attributes
    ----------
    max_depth : float
        Largest wear depth that the drawing must hold, m.
    max_force : float
        Force, N, whose arrow has the length ``ARROW_SHARE`` of the radius. Lengths scale with the
        square root of the force, so that the force of a resting pin is visible beside an impact.
    centre, radius : ndarray, shape (2,), and float
        m.
    paint : Colour
        Colour of path and text.
    """

    joint: ClearanceJoint
    max_depth: float
    max_force: float
    centre: Array
    radius: float
    paint: Colour

    @property
    def pin_factor(self) -> float:
        """Factor of the radius of the pin."""
        return _two_digits(PIN_SHARE * self.radius / self.joint.pin_radius)

    @property
    def gap_factor(self) -> float:
        """Factor of clearance, wear and motion of the pin."""
        gap = self.joint.clearance + 2.0 * self.max_depth
        return _two_digits(PLAY_SHARE * self.radius / gap)

    @property
    def band_factor(self) -> float:
        """Factor of the band that shows the wear depth again; 0 without wear."""
        if self.max_depth == 0.0:
            return 0.0
        return _two_digits(BAND_SHARE * self.radius / self.max_depth)

    @property
    def _pin_radius(self) -> float:
        return self.pin_factor * self.joint.pin_radius

    def labels(self) -> tuple[str, ...]:
        """Return the factors as text."""
        band = (f"orange: wear depth x{self.band_factor:.0f}",) if self.band_factor > 0.0 else ()
        return (
            f"clearance, wear x{self.gap_factor:.4g}; pin x{self.pin_factor:.3g}",
            *band,
            f"arrow: square root of F, up to {self.max_force:.0f} N",
        )

    def bodies(self, layer: Layer) -> list[list[Shape]]:
        """Return bearing, its mark, pin and its mark, each about its own centre."""
        edge, pin_radius = 0.012 * self.radius, self._pin_radius
        depth = _resampled(self.joint.bearing_surface.depth)
        inner = pin_radius + self.gap_factor * (self.joint.clearance + depth)
        outer = np.full(len(depth), self.radius)
        bearing = [
            band(_polar(inner), _polar(outer), layer(70), STEEL),
            band(_polar(inner), _polar(inner + edge), layer(72), INK),
            ring((0.0, 0.0), self.radius, edge, layer(72), INK),
        ]
        if depth.max() > 0.0:
            worn = np.minimum(inner + self.band_factor * depth, outer)
            bearing.append(band(_polar(inner), _polar(worn), layer(71), WORN))
        depth = _resampled(self.joint.pin_surface.depth)
        outer = pin_radius - self.gap_factor * depth
        pin = [
            filled(_polar(outer), layer(75), PIN),
            band(_polar(outer - edge), _polar(outer), layer(77), INK),
        ]
        if depth.max() > 0.0:
            worn = np.maximum(outer - self.band_factor * depth, 0.0)
            pin.append(band(_polar(worn), _polar(outer), layer(76), WORN))
        marks = [
            [line((0.55 * radius, 0.0), (0.9 * radius, 0.0), 0.02 * self.radius, z, MARK)]
            for radius, z in ((self.radius, layer(73)), (pin_radius, layer(78)))
        ]
        return [bearing, marks[0], pin, marks[1]]

    def coordinates(self, bearing: Array, pin: Array) -> list[Array]:
        """Return the coordinates of ``bodies`` from the poses of bearing and pin, shape (3,)."""
        offset = self.gap_factor * (pin - bearing)[:2]
        return [
            np.array([*point, angle])
            for point, pose in ((np.zeros(2), bearing), (offset, pin))
            for angle in (self._map_angle(pose), pose[2])
        ]

    def _map_angle(self, pose: Array) -> float:
        """Return the angle of the wear map of a body, rad; a map fixed in space does not turn."""
        return float(pose[2]) if self.joint.map_frame == "body" else 0.0

    def moving(self, bearing: Array, pin: Array, row: Array, layer: Layer) -> list[Shape]:
        """Return clearance circle, path of the pin, contact and force.

        Poses of bearing and pin have shape (n, 3); the row has the columns ``FILM_JOINT``.
        """
        eccentricity = (pin - bearing)[:, :2]
        play = self.gap_factor * self.joint.clearance
        shapes = [ring(self.centre, play, 0.008 * self.radius, layer(85), mix(STEEL, INK, 0.4))]
        if len(eccentricity) > 1:  # the path fades towards the past
            z, count = layer(86), len(eccentricity) - 1
            points = self.centre + self.gap_factor * eccentricity
            shares = 0.85 * (1.0 - np.arange(1, count + 1) / count)
            paints = [mix(self.paint, PAPER, share) for share in shares.tolist()]
            shapes += strokes(points, 0.016 * self.radius, z, paints)
            shapes.append(filled(circle(points[-1], 0.03 * self.radius, 16), z, self.paint))
        return shapes + self.contact(eccentricity[-1], self._map_angle(pin[-1]), row, layer(88))

    def contact(self, eccentricity: Array, map_angle: float, row: Array, z: float) -> list[Shape]:
        """Return contact point and force on the bearing; nothing without contact.

        ``map_angle`` is the angle of the wear map of the pin, rad.
        """
        if row[NORMAL] <= 0.0:
            return []
        normal = row[[X, Y]]
        depth = self.joint.pin_surface(np.array(math.atan2(row[Y], row[X]) - map_angle))
        arm = self._pin_radius - self.gap_factor * float(depth)
        point = self.centre + self.gap_factor * eccentricity + arm * normal
        size = math.hypot(row[NORMAL], row[TANGENTIAL])
        length = ARROW_SHARE * self.radius * math.sqrt(size / self.max_force)
        # The force on the pin is -F_n n + F_t t, with t a quarter turn ahead of n.
        force = row[NORMAL] * normal - row[TANGENTIAL] * np.array([-normal[1], normal[0]])
        return [
            filled(circle(point, 0.045 * self.radius, 20), z, FORCE),
            *arrow(point, length / size * force, 0.035 * self.radius, z, FORCE),
        ]


def _two_digits(value: float) -> float:
    unit: float = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / unit) * unit


def _polar(radius: Array) -> Array:
    """Return points at the bin centres of a map, shape (m, 2)."""
    angle = bin_centres(len(radius))
    return radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def _resampled(depth: Array) -> Array:
    """Return a map with about ``DRAWN_BINS`` bins: means over neighbours, or repeated bins."""
    if not depth.size:
        return np.zeros(DRAWN_BINS)
    bins = len(depth) // DRAWN_BINS
    if bins < 2:
        return np.repeat(depth, math.ceil(DRAWN_BINS / len(depth)))
    return np.array([part.mean() for part in np.array_split(depth, len(depth) // bins)])
