"""Linkage of a mechanism with its bearings and the force of its process, and its ideal motion."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import OverPosition
from presswear.linkage.loads import Force
from presswear.linkage.points import Attachment
from presswear.linkage.process import Process, laws_of
from presswear.linkage.surface import Surface
from presswear.physics.curve_following import followed
from presswear.physics.dead_centre import bottom_of
from presswear.physics.ideal import IdealMotion, ideal_motion
from presswear.scene.bearing_joints import BearingJoints
from presswear.scene.clearance_linkage import with_bearings, with_wall_maps
from presswear.scene.conventions import Conventions
from presswear.tools.arrays import Array
from presswear.tools.type_check import check_type


class LoadedLinkage(BearingJoints):
    """Linkage of a mechanism with its bearings and the force of its process."""

    conventions: Conventions
    surfaces: Any  # initial surfaces by joint
    process: Process | None

    def linkage(
        self, worn: Mapping[str, tuple[Surface, Surface]] | None = None
    ) -> Linkage:
        """Return the linkage on worn surfaces, or on initial ones; see ``surfaces``."""
        if worn is None:
            return self._initial_linkage
        check_type("worn", worn, Mapping[str, tuple[Surface, Surface]])
        return self._linkage_on(worn) if worn else self._initial_linkage

    @cached_property
    def _initial_linkage(self) -> Linkage:
        return self._linkage_on({})

    def _linkage_on(self, worn: Mapping[str, tuple[Surface, Surface]]) -> Linkage:
        bearings = {name: self.bearing(name) for name in self.bearing_joints}
        surfaces = {**self.surfaces, **worn}
        linkage = with_bearings(self.loaded, bearings, self.conventions, surfaces)
        # Without a drive the range of a slide, and thus the length of a map, is unknown.
        if not (linkage.corners and linkage.drives):
            return linkage
        return with_wall_maps(linkage, self.ideal, bearings)

    @property
    def has_deviations(self) -> bool:
        """True if clearance or an elastic joint lets the output leave its ideal motion."""
        return bool(self.clearance_joints or self.linkage().elastic_joints)

    @property
    def base_linkage(self) -> Linkage:
        """Linkage of the mechanism, with the output direction away from the work.

        With this direction bottom dead centre is the lowest position in every scene.
        """
        linkage = self.mechanism.linkage()
        if self.process is None or self.process.bottom == "lowest":
            return linkage
        opposite = math.remainder(linkage.output.direction + math.pi, 2.0 * math.pi)
        return replace(linkage, output=replace(linkage.output, direction=opposite))

    @property
    def loaded(self) -> Linkage:
        """Ideal linkage under the forces of the process."""
        ideal = followed(self.base_linkage)
        if self.process is None:
            return ideal
        point = self._point_of_work(ideal)
        direction = ideal.output.direction
        laws = self.process_laws.items()
        forces = (Force(point, direction, law, name) for name, law in laws)
        return replace(ideal, loads=(*ideal.loads, *forces))

    def _point_of_work(self, ideal: Linkage) -> Attachment:
        """Return the point of the process force: the output point, or a point beside it."""
        point = ideal.output.attachment
        guides = [guide for guide in ideal.guides if guide.body == point.body]
        if self.process is None or self.process.offset == 0.0 or not guides:
            return point
        # Output direction, away from the work, in the axes of the slide
        angle = ideal.output.direction - guides[0].angle
        # The offset is to the right of this direction.
        x = point.x + self.process.offset * math.sin(angle)
        y = point.y - self.process.offset * math.cos(angle)
        return Attachment(point.body, x, y)

    @property
    def process_laws(self) -> dict[str, OverPosition]:
        """Laws of the process forces over the output coordinate, by name."""
        if self.process is None:
            return {}
        return laws_of(self.process, self.bottom + self.process.height, self.lift)

    @property
    def lift(self) -> float:
        """Height above the touch of the work at which a stroke is over, m.

        It is half of the distance from the touch to top dead centre; 0 without a process.
        """
        if self.process is None:
            return 0.0
        return 0.5 * (self.stroke - self.process.height)

    @property
    def ideal(self) -> IdealMotion:
        """Motion of the mechanism with all joints closed."""
        return ideal_motion(followed(self.base_linkage), self.mechanism.period)

    @property
    def stroke(self) -> float:
        """Distance between the extremes of the output coordinate in the ideal motion, m."""
        dead_centre = bottom_of(self.ideal)
        return 0.0 if dead_centre is None else dead_centre.stroke

    @property
    def bottom(self) -> float:
        """Output coordinate of bottom dead centre in the ideal motion, m."""
        dead_centre = bottom_of(self.ideal)
        if dead_centre is None:
            return float(self.ideal.at(np.zeros(1)).output(self.base_linkage)[0, 0])
        return dead_centre.height

    def ideal_slider(self, time: Array, closed: bool = True) -> Array:
        """Return displacement from the start, velocity and acceleration of the ideal output.

        Shape (n, 3) at times of shape (n,), s; m, m/s, m/s^2. See ``IdealMotion.at``
        for ``closed``.
        """
        slider = self.ideal.at(np.append(0.0, time), closed).output(self.base_linkage)
        slider[:, 0] -= slider[0, 0]
        return slider[1:]

    @property
    def run_up(self) -> float:
        """Time in which the mechanism runs up from rest, s; cycles are counted after it."""
        return self.mechanism.linkage().run_up_time

    @property
    def output(self) -> str:
        """Name of the body of the output point in a sentence: ``the slider``, ``link 7``."""
        body = self.mechanism.linkage().output.body
        name = "slider" if body.startswith("slider") else body
        # A name with a number or a capital letter at its end has no article.
        return f"the {name}" if name[-1].islower() else name
