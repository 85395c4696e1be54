"""Contact of a corner of a slide with a wall of its guide.

The normal n points into the wall: it is the direction d of the guide, rotated by +90
degrees for the left wall and by -90 degrees for the right one. The point r_0 is half
the width of the slide beside the middle of the guide. The corner has the position r, the
eccentricity e = ((r - r_0) . n) n, and with the clearance c the penetration delta = |e| - c.
With four corners the slide can tilt.

A worn wall has the depth h(s) at the position s = (r - r_0) . d along the guide, and the
penetration is delta = |e| - c - h(s). The force is the gradient of the elastic energy,
parallel to n - (dh/ds) d, so that a worn wall creates no energy.

If a body carries the wall, r_0, n and d are fixed in this body. The rate of delta is
v . n, with the velocity v of the corner relative to the point of the body at the corner.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.linkage import Linkage
from presswear.physics.equations.text import (
    ONE,
    ZERO,
    Vector,
    difference,
    negative,
    rotated,
)
from presswear.physics.interactions.clearance import ContactText
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.packed import Packed, onset_floor
from presswear.physics.wall_wear import wall_profile
from presswear.tools.arrays import Array
from presswear.tools.compile import Records


@dataclass(frozen=True)
class CornerContact:
    """Contact of a corner, for which the writer makes equations."""

    joint: GuideCorner
    record: Records  # dtype JOINT
    number: int  # index among the clearance joints

    # The kernels of ``ClearanceContact`` are called, too.
    kernels: ClassVar[Kernels] = (wall_profile,)

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all corners of the slides of a linkage."""
        pairs = zip(linkage.clearances, packed.joints, strict=True)
        return [
            cls(joint, record, k)
            for k, (joint, record) in enumerate(pairs)
            if isinstance(joint, GuideCorner)
        ]

    @property
    def bodies(self) -> tuple[str, ...]:
        """The frame, or the body with the walls, and the slide."""
        return self.joint.bearing.body, self.joint.pin.body

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return 0, because records of the joints hold the elastic energies of contacts."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the contact, its forces on the slide, and its powers."""
        _CornerText(page, self.joint, self.record, self.number).write()


class _CornerText(ContactText):
    """Writer of the equations of a corner on a flat wall."""

    joint: GuideCorner

    @property
    def uses_kernel(self) -> bool:
        """False: the penetration of a worn wall is written as a formula."""
        return False

    @property
    def has_profile(self) -> bool:
        """True if the wall is worn, or wears during the run."""
        return bool(self.record["surface_bins"] > 0)

    @property
    def onset_floor(self) -> str:
        """Name of the lower limit of the closing speed in the damping law."""
        return self.parameter("speed_floor", onset_floor(self.joint))

    @property
    def title(self) -> str:
        """Comment with the name of the corner and its body."""
        wall = f"a wall of {self.joint.bearing.body}" if self.is_moving else "a wall"
        return f"{self.joint.name}: corner of {self.joint.pin.body} on {wall}"

    @property
    def is_moving(self) -> bool:
        """True if a body carries the wall, and not the frame."""
        return self.bearing.index >= 0

    @property
    def wears_by_pressure(self) -> bool:
        """False: the wear of a wall is by the load distance alone."""
        return False

    @cached_property
    def _wall_arm(self) -> Vector:
        """Vector from the mass centre of the body with the wall to the corner."""
        corner = self.pin.position.plus(self.pin_arm)
        if not self.is_moving:
            return corner
        arm = corner.minus(self.bearing.position)
        return self.let_vector("wall_arm", arm)

    def _from_wall(self) -> Vector:
        """Return r - r_0."""
        return self._wall_arm.minus(self.bearing_arm)

    def _fixed_normal(self) -> Vector:
        """Return n, the direction into the wall, in the frame of the body with the wall."""
        direction = self.joint.guide.direction
        side = self.joint.side
        name = self.name("fixed_normal" if self.is_moving else "normal")
        return Vector(
            self.text.direction(f"{name}_x", -side * math.sin(direction)),
            self.text.direction(f"{name}_y", side * math.cos(direction)),
        )

    @cached_property
    def _wall_normal(self) -> Vector:
        """Direction n into the wall."""
        normal = self._fixed_normal()
        if not self.is_moving:
            return normal
        normal = rotated(normal, *self.bearing.axis)
        return self.let_vector("normal", normal)

    def write_motion(self) -> None:
        """Write distance and velocity of the corner along the normal of the wall."""
        slide = self.pin
        arm = self.pin_arm
        normal = self._wall_normal
        self.set_fields("normal", normal)
        # Component of the eccentricity along n
        across = self.let("across", normal.dot(self._from_wall()))
        velocity = slide.velocity_at(arm)
        if self.is_moving:
            wall = self.bearing
            velocity = velocity.minus(wall.velocity_at(self._wall_arm))
            self.fields |= {"bearing_angle": wall.angle, "bearing_spin": wall.omega}
            self.set_fields("bearing_lever", self._wall_arm)
        velocity = self.let_vector("velocity", velocity)
        name = "rate_across" if self.has_profile else "rate"
        rate = self.let(name, normal.dot(velocity))
        # ``across`` and ``rate_across`` are no fields of CONTACT: ``_write_record`` uses them.
        self.fields |= {"across": across, "rate_across": rate}
        # A worn wall replaces this rate of the penetration in ``_write_profile``.
        self.fields["rate"] = rate
        self.fields["is_flat"] = ONE
        self.fields |= {"pin_angle": slide.angle, "pin_spin": slide.omega}
        self.set_fields("pin_lever", arm)
        self.set_fields("velocity", velocity)

    def _write_penetration(self) -> None:
        """Write the penetration, and the contact point at half of the penetration."""
        clearance = self.parameter("clearance", self.joint.clearance)
        penetration = difference(self.value("across"), clearance)
        if self.has_profile:
            penetration = difference(penetration, self._write_profile())
        penetration = self.let("penetration", penetration)
        self.fields["penetration"] = penetration
        arm = self.let("pin_arm", f"-0.5 * max({penetration}, {ZERO})")
        self.fields["pin_arm"] = arm
        if self.is_moving:
            self.fields["bearing_arm"] = arm
        rate = self.value("rate")
        self.fields["approach"] = rate
        self.fields["closing"] = rate
        self.fields["elastic"] = self.name("elastic_force")
        self.text.write(f"{self.name('elastic_force')} = {ZERO}")

    def _write_profile(self) -> str:
        """Write gradient and rate of the penetration; return the wear depth h of the wall."""
        self._write_place()
        depth = self.name("wall_depth")
        slope = self.name("wall_slope")
        k = self.number
        place = self.value("place")
        call = f"wall_profile(data.joints[{k}], data.surfaces[{k}], {place})"
        self.text.write(f"{depth}, {slope}, _ = {call}")
        gradient = self._wall_normal.minus(self._guide_direction().times(slope))
        gradient = self.let_vector("gradient", gradient)
        self.set_fields("normal", gradient)
        rate = gradient.dot(self.vector("velocity"))
        self.fields["rate"] = self.let("rate", rate)
        return depth

    def turning(self) -> str:
        """Return zero: the normal does not turn in the frame of the wall."""
        return ZERO

    def _bearing_point(self, radius: Vector) -> Vector:
        """Return the vector from the mass centre of the body with the wall to the contact."""
        return self._wall_arm.plus(radius)

    def _guide_direction(self) -> Vector:
        """Return d, the direction of the guide."""
        normal = self._wall_normal
        rotated_normal = Vector(normal.y, negative(normal.x))  # by -90 degrees
        return rotated_normal.times(ONE if self.joint.side > 0.0 else f"-{ONE}")

    def _write_place(self) -> None:
        """Write the position s of the corner along the guide."""
        along = self._guide_direction().dot(self._from_wall())
        self.fields["place"] = self.let("along", along)

    def _write_record(self) -> None:
        """Write the contact for the recorder.

        Eccentricity and velocity are recorded in the frame of the body with the wall.
        """
        if self.wears and not self.has_profile:
            self._write_place()
        across = self.fields.pop("across")
        rate = self.fields.pop("rate_across")
        normal = self._fixed_normal()
        self.fields["eccentricity"] = self.let("eccentricity", f"abs({across})")
        self.set_fields("eccentricity", normal.times(across))
        self.set_fields("velocity", normal.times(rate))
        super()._write_record()
