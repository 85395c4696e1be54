"""Joint with clearance drawn beside the mechanism, its clearance enlarged."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.surface import bin_centres
from presswear.show.replay.clip import NORMAL, TANGENTIAL, X, Y
from presswear.show.replay.shapes import (
    ARROW_SHARE,
    BAND_SHARE,
    DRAWN_BINS,
    FORCE,
    INK,
    PAPER,
    PIN,
    PIN_SHARE,
    PLAY_SHARE,
    STEEL,
    WORN,
    Colour,
    Shape,
    across,
    arrow,
    band,
    circle,
    filled,
    line,
    mix,
    moved,
    ring,
    segments,
    two_digits,
)
from presswear.tools.arrays import Array
from presswear.tools.errors import NARROW
from presswear.tools.numbers import quantity_text


def force_text(force: float) -> str:
    """Return a force, N, in letters that Exudyn's renderer draws."""
    return quantity_text(force, "N").replace(NARROW, " ")


@dataclass(frozen=True)
class EnlargedJoint:
    """Joint with clearance, enlarged; its scale factors are rounded down to two digits.

    Lengths of arrows scale with the square root of the force, so that the force of a
    resting pin is visible beside an impact.
    """

    joint: ClearanceJoint
    max_depth: float  # largest wear depth that the drawing must hold, m
    # force whose arrow has the length ``ARROW_SHARE`` times ``radius``, N
    max_force: float
    centre: Array  # centre of the drawing, shape (2,), m
    radius: float  # radius of the drawing, m
    paint: Colour  # colour of path and text

    @property
    def pin_factor(self) -> float:
        """Factor of the radius of the pin."""
        return two_digits(PIN_SHARE * self.radius / self.joint.pin_radius)

    @property
    def gap_factor(self) -> float:
        """Factor of clearance, wear and motion of the pin."""
        gap = self.joint.clearance + 2.0 * self.max_depth
        return two_digits(PLAY_SHARE * self.radius / gap)

    @property
    def band_factor(self) -> float:
        """Factor of the band that shows the wear depth again; 0 without wear."""
        depth = self.max_depth
        return two_digits(BAND_SHARE * self.radius / depth) if depth > 0.0 else 0.0

    def labels(self) -> tuple[str, ...]:
        """Return the factors as text."""
        labels = [f"clearance, wear x{self.gap_factor:.4g}; pin x{self.pin_factor:.3g}"]
        if self.band_factor > 0.0:
            labels.append(f"orange: wear depth x{self.band_factor:.0f}")
        labels.append(f"arrow: sqrt(F), up to {force_text(self.max_force)}")
        return tuple(labels)

    def bodies(self) -> list[list[Shape]]:
        """Return bearing, its mark, pin and its mark, each about its own centre."""
        pin_radius = self.pin_factor * self.joint.pin_radius
        edge = 0.012 * self.radius
        gap = pin_radius + self.gap_factor * self.joint.clearance
        sides = (
            (self.joint.bearing_surface, 1.0, gap, self.radius, STEEL, 70),
            (self.joint.pin_surface, -1.0, pin_radius, 0.0, PIN, 75),
        )
        bodies = []
        for surface, outwards, radius, far, paint, z in sides:
            depth = surface(bin_centres(DRAWN_BINS))
            worn = radius + outwards * self.gap_factor * depth
            drawn = [
                band(_polar(worn), _polar(np.full(DRAWN_BINS, far)), z, paint),
                band(_polar(worn), _polar(worn + outwards * edge), z + 2, INK),
            ]
            if depth.max() > 0.0:
                reach = outwards * np.minimum(
                    self.band_factor * depth, np.abs(far - worn)
                )
                drawn.append(band(_polar(worn), _polar(worn + reach), z + 1, WORN))
            size = self.radius if far else pin_radius
            ends = (0.55 * size, 0.0), (0.9 * size, 0.0)
            mark = line(*ends, 0.02 * self.radius, z + 3, mix(STEEL, INK, 0.6))
            bodies += [drawn, [mark]]
        bodies[0].append(ring((0.0, 0.0), self.radius, edge, 72, INK))
        return bodies

    def shapes(
        self, bodies: Sequence[list[Shape]], bearing: Array, pin: Array, row: Array
    ) -> list[Shape]:
        """Return the shapes of ``bodies`` in their poses, and those of ``moving``."""
        drawn: list[Shape] = []
        poses = self.coordinates(bearing[-1], pin[-1])
        for body, pose in zip(bodies, poses, strict=True):
            drawn += [moved(shape, pose) for shape in body]
        return drawn + self.moving(bearing, pin, row)

    def coordinates(self, bearing: Array, pin: Array) -> list[Array]:
        """Return the coordinates of ``bodies`` from the poses of bearing and pin, shape (3,)."""
        pin_place = self.centre + self.gap_factor * (pin - bearing)[:2]
        return [
            np.append(self.centre, self._map_angle(bearing)),
            np.append(self.centre, bearing[2]),
            np.append(pin_place, self._map_angle(pin)),
            np.append(pin_place, pin[2]),
        ]

    def _map_angle(self, pose: Array) -> float:
        """Return the angle of the wear map of a body, rad; a map fixed in space does not turn."""
        return float(pose[2]) if self.joint.map_frame == "body" else 0.0

    def moving(self, bearing: Array, pin: Array, row: Array) -> list[Shape]:
        """Return clearance circle, path of the pin, contact and force.

        Poses of bearing and pin have shape (n, 3); the row has the columns
        ``FILM_JOINT``.
        """
        eccentricity = (pin - bearing)[:, :2]
        play = self.gap_factor * self.joint.clearance
        drawn = [ring(self.centre, play, 0.008 * self.radius, 85, mix(STEEL, INK, 0.4))]
        count = len(eccentricity) - 1
        if count > 0:  # the path fades towards the past
            points = self.centre + self.gap_factor * eccentricity
            shares = 0.85 * (1.0 - np.arange(1, count + 1) / count)
            paints = [mix(self.paint, PAPER, share) for share in shares.tolist()]
            drawn += segments(points, 0.016 * self.radius, 86, paints)
            drawn.append(
                filled(circle(points[-1], 0.03 * self.radius, 16), 86, self.paint)
            )
        return drawn + self.contact(eccentricity[-1], self._map_angle(pin[-1]), row)

    def contact(self, eccentricity: Array, map_angle: float, row: Array) -> list[Shape]:
        """Return contact point and force on the bearing; nothing without contact.

        ``map_angle`` is the angle of the wear map of the pin, rad.
        """
        if row[NORMAL] <= 0.0:
            return []
        normal = row[[X, Y]]
        depth = self.joint.pin_surface(np.array(math.atan2(row[Y], row[X]) - map_angle))
        arm = self.pin_factor * self.joint.pin_radius - self.gap_factor * float(depth)
        point = self.centre + self.gap_factor * eccentricity + arm * normal
        size = math.hypot(row[NORMAL], row[TANGENTIAL])
        length = ARROW_SHARE * self.radius * math.sqrt(size / self.max_force)
        # The force on the pin is -F_n n + F_t t, with t a quarter turn ahead of n.
        force = row[NORMAL] * normal - row[TANGENTIAL] * across(normal)
        return [
            filled(circle(point, 0.045 * self.radius, 20), 88, FORCE),
            *arrow(point, length / size * force, 0.035 * self.radius, 88, FORCE),
        ]


def _polar(radius: Array) -> Array:
    """Return points at the bin centres of a map, shape (m, 2)."""
    angle = bin_centres(len(radius))
    return radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
