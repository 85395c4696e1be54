"""Linkage of a scene: bearings in the joints of the ideal linkage."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from presswear.linkage.bodies import Body
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner, slide_inertia
from presswear.linkage.joints import Guide, Joint
from presswear.linkage.linkage import Linkage
from presswear.linkage.part_checks import check_inertias
from presswear.linkage.surface import Surface
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import Conventions
from presswear.scene.guide_clearance import corners_of
from presswear.scene.pin_joints import clearance_joint, rigid_joint


def with_bearings(
    ideal: Linkage,
    bearings: Mapping[str, Bearing],
    conventions: Conventions,
    surfaces: Mapping[str, tuple[Surface, Surface]],
) -> Linkage:
    """Return a linkage with the bearings of its joints.

    Parameters
    ----------
    ideal : Linkage
        Linkage with ideal joints.
    bearings : mapping of str to Bearing
        Bearings by joint. A pin with a clearance of 0 stays rigid, with friction.
    conventions : Conventions
    surfaces : mapping of str to pair of Surface
        Worn surfaces of bearing and pin by joint, of the left and the right wall by
        guide; the other ones are round, or flat.

    Raises
    ------
    InputError
        A body that a guide with clearance lets turn has no inertia.
    """
    round_surfaces = Surface(), Surface()
    joints: list[Joint] = []
    loose_pins: list[ClearanceJoint] = []
    loose_guides: list[Guide] = []
    corners: list[GuideCorner] = []
    for joint in ideal.joints:
        bearing = bearings.get(joint.name)
        worn = surfaces.get(joint.name, round_surfaces)
        if bearing is None:
            joints.append(joint)
        elif isinstance(joint, Guide):
            loose_guides.append(joint)
            corners += corners_of(bearing, joint, worn)
        elif bearing.clearance > 0.0:
            loose_pins.append(clearance_joint(bearing, joint, conventions, worn))
        else:
            joints.append(rigid_joint(bearing, joint))
    bodies = tuple(_with_inertia(body, loose_guides) for body in ideal.bodies)
    if loose_guides:
        tight = [joint for joint in joints if isinstance(joint, Guide)]
        check_inertias(bodies, tight, ideal.drives)
    clearances = (*ideal.clearances, *loose_pins, *corners)
    loosened = replace(
        ideal, bodies=bodies, joints=tuple(joints), clearances=clearances
    )
    return loosened.released


def _with_inertia(body: Body, loose_guides: Sequence[Guide]) -> Body:
    """Return a body; a slide that can tilt has by default the inertia of a block."""
    for guide in loose_guides:
        if guide.body == body.name and body.inertia == 0.0:
            return replace(body, inertia=slide_inertia(body.mass, guide))
    return body
