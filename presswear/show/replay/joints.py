"""A clearance joint enlarged: bearing, pin, worn surfaces, contact, force, path of the pin.

Clearance and wear are enlarged alike, much more than the radius, so that pin and bearing
meet in the picture where they meet in the run.  The depth of wear is drawn once more, much
larger still, as a band behind each surface.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.record.film import FILM_JOINT
from presswear.show.replay.bodies import INK, PAPER, STEEL
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
"""Of a map as it is drawn: enough to look round."""
WORN = colour("#E69F00")
FORCE = colour("#c1121f")
_STEEL_PIN = colour("#9aa5b1")
_NORMAL, _TANGENTIAL, _X, _Y = (
    FILM_JOINT.index(name) for name in ("normal", "tangential", "direction_x", "direction_y")
)


@dataclass(frozen=True)
class Enlargement:
    """By what a joint is enlarged.

    Attributes
    ----------
    radius : float
        Of the view, m.
    body, gap, band : float
        Factors of the pin's radius, of clearance, wear and motion of the pin, and of the
        band that shows the wear once more.
    force : float
        The force whose arrow has the length ``_ARROW`` of the radius, N; others are as long
        as the root of their part of it, so that a resting pin's is seen beside an impact's.
    """

    radius: float
    body: float
    gap: float
    band: float
    force: float

    @staticmethod
    def of(joint: ClearanceJoint, deepest: float, largest: float, radius: float) -> "Enlargement":
        """Factors, rounded down to two digits, that fill a view.

        Parameters
        ----------
        deepest : float
            Greatest depth of wear that is to be shown, m.
        largest : float
            Largest force that is to be shown, N.
        """
        return Enlargement(
            radius=radius,
            body=_two_digits(_PIN * radius / joint.pin_radius),
            gap=_two_digits(_PLAY * radius / (joint.clearance + 2.0 * deepest)),
            band=_two_digits(_BAND * radius / deepest) if deepest > 0.0 else 0.0,
            force=largest,
        )

    def words(self) -> tuple[str, ...]:
        """The factors, to be written beside the view."""
        band = (f"orange: wear once more, x{self.band:.0f}",) if self.band > 0.0 else ()
        return (
            f"clearance, wear x{self.gap:.4g}; pin x{self.body:.3g}",
            *band,
            f"arrow: root of F, most {self.force:.0f} N",
        )


def _two_digits(value: float) -> float:
    """Rounded down to two significant digits."""
    unit: float = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / unit) * unit


def _polar(radius: Array) -> Array:
    """Points at the bin centres of a map, shape (m, 2)."""
    angle = (np.arange(len(radius)) + 0.5) * 2.0 * math.pi / len(radius)
    return radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def _drawn(depth: Array) -> Array:
    """A map with about _BINS bins: means over neighbours, or each bin several times."""
    parts = len(depth) // _BINS
    if parts < 2:
        return np.repeat(depth, math.ceil(_BINS / len(depth)))
    return np.array([part.mean() for part in np.array_split(depth, len(depth) // parts)])


def bearing_shapes(
    joint: ClearanceJoint, depth: Array, factor: Enlargement, layers: Sequence[float]
) -> list[Shape]:
    """The bearing about its centre, in the frame of its map."""
    depth = _drawn(depth)
    inner = factor.body * joint.pin_radius + factor.gap * (joint.clearance + depth)
    outer = np.full(len(depth), factor.radius)
    shapes = [
        band(_polar(inner), _polar(outer), layers[0], STEEL),
        band(_polar(inner), _polar(inner + 0.012 * factor.radius), layers[2], INK),
        ring((0.0, 0.0), factor.radius, 0.012 * factor.radius, layers[2], INK),
    ]
    if depth.max() > 0.0:
        worn = np.minimum(inner + factor.band * depth, outer)
        shapes.append(band(_polar(inner), _polar(worn), layers[1], WORN))
    return shapes


def pin_shapes(
    joint: ClearanceJoint, depth: Array, factor: Enlargement, layers: Sequence[float]
) -> list[Shape]:
    """The pin about its centre, in the frame of its map."""
    depth = _drawn(depth)
    outer = factor.body * joint.pin_radius - factor.gap * depth
    shapes = [
        filled(_polar(outer), layers[0], _STEEL_PIN),
        band(_polar(outer - 0.012 * factor.radius), _polar(outer), layers[2], INK),
    ]
    if depth.max() > 0.0:
        worn = np.maximum(outer - factor.band * depth, 0.0)
        shapes.append(band(_polar(worn), _polar(outer), layers[1], WORN))
    return shapes


def mark_shapes(radius: float, width: float, z: float) -> list[Shape]:
    """A line on a body that shows how it turns."""
    return [line((0.55 * radius, 0.0), (0.9 * radius, 0.0), width, z, mixed(STEEL, INK, 0.6))]


def play_shapes(centre: Array, joint: ClearanceJoint, factor: Enlargement, z: float) -> list[Shape]:
    """The circle that the centre of a pin can reach where nothing is worn."""
    width = 0.008 * factor.radius
    return [
        ring((centre[0], centre[1]), factor.gap * joint.clearance, width, z, mixed(STEEL, INK, 0.4))
    ]


def path_shapes(
    centre: Array, eccentricity: Array, factor: Enlargement, z: float, paint: Colour
) -> list[Shape]:
    """The way of the pin's centre, fading backwards in time.

    Parameters
    ----------
    eccentricity : ndarray, shape (n, 2)
        In the order of time, the present last, m.
    """
    if len(eccentricity) < 2:
        return []
    points = centre + factor.gap * eccentricity
    pieces = len(points) - 1
    paints = [mixed(paint, PAPER, 0.85 * (1.0 - (i + 1) / pieces)) for i in range(pieces)]
    shapes = strokes(points, 0.016 * factor.radius, z, paints)
    return [*shapes, filled(circle(points[-1], 0.03 * factor.radius, 16), z, paint)]


def contact_shapes(
    centre: Array,
    joint: ClearanceJoint,
    worn: Array,
    turned: float,
    eccentricity: Array,
    row: Array,
    factor: Enlargement,
    z: float,
) -> list[Shape]:
    """Contact point and the force of the pin on the bearing; nothing where they are apart.

    Parameters
    ----------
    worn, turned : ndarray, shape (m,), and float
        Depth of the pin's wear, m, and angle by which its map is turned, rad.
    eccentricity : ndarray, shape (2,)
        m.
    row : ndarray, shape (6,)
        Columns FILM_JOINT.
    """
    if row[_NORMAL] <= 0.0:
        return []
    normal = row[[_X, _Y]]
    depth = worn[bin_at(math.atan2(row[_Y], row[_X]) - turned, len(worn))]
    arm = factor.body * joint.pin_radius - factor.gap * depth
    point = centre + factor.gap * eccentricity + arm * normal
    size = math.hypot(row[_NORMAL], row[_TANGENTIAL])
    length = _ARROW * factor.radius * math.sqrt(size / factor.force)
    # The pin gets -F_n n + F_t t with t a quarter turn ahead of n, the bearing the opposite.
    force = row[_NORMAL] * normal - row[_TANGENTIAL] * np.array([-normal[1], normal[0]])
    return [
        filled(circle(point, 0.045 * factor.radius, 20), z, FORCE),
        *arrow(point, length / size * force, 0.035 * factor.radius, z, FORCE),
    ]


def map_angle(joint: ClearanceJoint, angle: float) -> float:
    """Angle of a wear map in the picture: maps that are fixed in direction do not turn, rad."""
    return angle if joint.map_frame == "body" else 0.0


def bin_at(angle: float, count: int) -> int:
    """The bin of a map of so many bins that holds an angle, rad."""
    return math.floor(angle * count / (2.0 * math.pi)) % count


def joint_words(name: str, row: Array, peak: float) -> str:
    """The line beside a view that changes with time."""
    return f"{name}: force {math.hypot(row[_NORMAL], row[_TANGENTIAL]):.0f} N, peak {peak:.0f} N"
