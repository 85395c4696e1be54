"""Constraint rows that the joints, guides and drives of a linkage make."""

import math
from typing import NamedTuple

from presswear.linkage.drives import Drive, GearedDrive, LinearDrive
from presswear.linkage.joints import Guide, Revolute, closing_guides, ends_of
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment, OutputPoint


class Row(NamedTuple):
    """Constraint row: a distance along a direction, or an angle, and its value."""

    name: str  # name of the joint, guide or drive
    first: Attachment
    second: Attachment
    direction: tuple[float, float] = (0.0, 0.0)
    # 1: the row is the angle of the first body less ``ratio`` times that of the second
    turn: float = 0.0
    target: float = 0.0  # value that is held, m or rad
    ratio: float = 1.0
    is_turning: bool = False  # the direction turns with the second body
    is_following: bool = False  # the first point follows the curve of a drive


def rows_of(linkage: Linkage) -> list[Row]:
    """Return the constraint rows of a linkage.

    They are two for each pin joint, two for each guide, a third for a guide with a
    spring, one for a guide that closes a loop of guides, and one for each drive that
    prescribes a motion.
    """
    rows = []
    for joint in linkage.revolutes:
        rows += _rows_of_pin(joint)
    closing = closing_guides(linkage.guides)
    for guide in linkage.guides:
        rows += _rows_of_guide(guide, guide.name not in closing)
    for drive in linkage.prescribed_drives:
        rows.append(_row_of_drive(linkage, drive))
    return rows


def _rows_of_pin(joint: Revolute) -> list[Row]:
    """Return the rows of the distance of both ends along x and along y."""
    return [
        Row(joint.name, joint.first, joint.second, (1.0, 0.0)),
        Row(joint.name, joint.first, joint.second, (0.0, 1.0)),
    ]


def _rows_of_guide(guide: Guide, holds_angle: bool) -> list[Row]:
    """Return the rows of the distance from the line, of the angle and of a spring."""
    point, centre = ends_of(guide)
    cosine = math.cos(guide.direction)
    sine = math.sin(guide.direction)
    carrier = Attachment(guide.on, 0.0, 0.0)
    across = (-sine, cosine)
    rows = [Row(guide.name, centre, point, across, is_turning=guide.is_moving)]
    if holds_angle:
        rows.append(Row(guide.name, centre, carrier, turn=1.0, target=guide.angle))
    if guide.stiffness is not None:
        rows.append(Row(guide.name, centre, point, (cosine, sine)))
    return rows


def _row_of_drive(linkage: Linkage, drive: Drive) -> Row:
    """Return the row of a drive: a point on a curve, a place along a guide, or an angle."""
    centre = Attachment(drive.body, 0.0, 0.0)
    frame = Attachment(GROUND, 0.0, 0.0)
    if drive.follow is not None:
        output = drive.follow.point
        assert isinstance(output, OutputPoint), "assemble converts names of points"
        along = math.cos(output.direction), math.sin(output.direction)
        return Row(drive.name, output.attachment, frame, along, is_following=True)
    if isinstance(drive, LinearDrive):
        guide = linkage.guide_of(drive)
        point, _ = ends_of(guide)
        along = math.cos(guide.direction), math.sin(guide.direction)
        return Row(drive.name, centre, point, along, is_turning=guide.is_moving)
    if isinstance(drive, GearedDrive):
        return _row_of_gears(linkage, drive)
    return Row(drive.name, centre, frame, turn=1.0)


def _row_of_gears(linkage: Linkage, gears: GearedDrive) -> Row:
    """Return the row that couples the angles of two cranks."""
    leader = linkage.drives[linkage.number_of_drive(gears.leader)]
    return Row(
        gears.name,
        Attachment(gears.body, 0.0, 0.0),
        Attachment(gears.leader, 0.0, 0.0),
        turn=1.0,
        target=gears.angle - gears.ratio * leader.angle,
        ratio=gears.ratio,
    )
