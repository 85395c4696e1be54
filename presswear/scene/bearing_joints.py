"""Joints of a mechanism that have a bearing, with clearance or rigid."""

from collections.abc import Mapping
from typing import Any

from presswear.linkage.guide_corner import CORNERS
from presswear.linkage.joints import Guide
from presswear.scene.bearing import Bearing
from presswear.scene.mechanism_kinds import AnyMechanism
from presswear.tools.choices import Choice


class BearingJoints:
    """Joints of a mechanism that have a bearing, with clearance or rigid."""

    mechanism: AnyMechanism
    joints: Any  # names of the joints with a bearing, as a user writes them
    bearings: Bearing | Any  # bearing of all joints that are not in ``joint_bearings``
    joint_bearings: Mapping[str, Bearing]

    @property
    def bearing_joints(self) -> tuple[str, ...]:
        """Names of the joints with a bearing, which has clearance or only friction."""
        words = self.joint_choice.split(self.joints)
        return tuple(name for name in self.mechanism.allowed_joints if name in words)

    def bearing(self, joint: str) -> Bearing:
        """Return the bearing of a joint; the corner of a slide has the bearing of its guide."""
        for guide in self.loose_guides:
            if joint.removeprefix(f"{guide.name} ") in CORNERS:
                joint = guide.name
        return self.joint_bearings.get(joint, self.bearings)

    @property
    def loose_pins(self) -> tuple[str, ...]:
        """Names of the pin joints with clearance."""
        guides = [guide.name for guide in self.loose_guides]
        names = []
        for name in self.bearing_joints:
            if name not in guides and self.bearing(name).clearance > 0.0:
                names.append(name)
        return tuple(names)

    @property
    def loose_guides(self) -> tuple[Guide, ...]:
        """Guides with clearance."""
        names = self.bearing_joints
        guides = self.mechanism.linkage().guides
        return tuple(guide for guide in guides if guide.name in names)

    @property
    def clearance_joints(self) -> tuple[str, ...]:
        """Names of the joints with clearance; a guide has the names of its four corners."""
        names = [*self.loose_pins]
        for guide in self.loose_guides:
            names += [f"{guide.name} {corner}" for corner in CORNERS]
        return tuple(names)

    @property
    def all_loose_joints(self) -> tuple[str, ...]:
        """Names of the pins and the guides with clearance."""
        return (*self.loose_pins, *(guide.name for guide in self.loose_guides))

    @property
    def worn_guides(self) -> tuple[Guide, ...]:
        """Guides with clearance whose walls wear, with maps along the ideal motion."""
        if not self.mechanism.linkage().drives:
            return ()
        guides = []
        for guide in self.loose_guides:
            if self.bearing(guide.name).materials.wear_coefficient > 0.0:
                guides.append(guide)
        return tuple(guides)

    @property
    def wearing_joints(self) -> tuple[str, ...]:
        """Names of the pins with clearance and of the guides whose walls wear."""
        return (*self.loose_pins, *(guide.name for guide in self.worn_guides))

    @property
    def rigid_bearings(self) -> tuple[str, ...]:
        """Names of the joints that have a bearing without clearance."""
        joints = self.bearing_joints
        return tuple(name for name in joints if self.bearing(name).clearance == 0.0)

    @property
    def dry_pins(self) -> tuple[str, ...]:
        """Names of the pin joints with clearance whose contacts begin and end in the run."""
        return tuple(pin for pin in self.loose_pins if not self.bearing(pin).has_film)

    @property
    def joint_choice(self) -> Choice:
        """Names of joints that ``joints`` can have."""
        return Choice((*self.mechanism.allowed_joints, "none"), several=True)

    @property
    def bearings_of_pins(self) -> dict[str, Bearing]:
        """Bearings of single pins by their names, and the common bearing by an empty name."""
        guides = {guide.name for guide in self.loose_guides}
        bearings = {"": self.bearings, **self.joint_bearings}
        # With guides, the common bearing may be that of no pin.
        if guides and guides | self.joint_bearings.keys() >= set(self.bearing_joints):
            del bearings[""]
        for guide in guides:
            bearings.pop(guide, None)
        return bearings
