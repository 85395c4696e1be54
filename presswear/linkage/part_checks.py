"""Checks of the parts of a linkage against each other; messages name the part."""

import math
from collections.abc import Mapping, Sequence
from itertools import chain, permutations

from presswear.linkage.bodies import MIN_INERTIA, Body
from presswear.linkage.drives import Drive, GearedDrive, LinearDrive, leader_of
from presswear.linkage.joints import Guide, Joint, closing_guides, ends_of
from presswear.linkage.points import GROUND, Attachment
from presswear.tools.errors import InputError
from presswear.tools.quantities import written

# distance of the points of a joint in the drawing, relative to its size
DRAWING_TOL = 1e-6
_SIGNS = set(".,:;=/\\'\"")  # signs that separate points, lists and files
_FORMULA = tuple("+-@＋－＠＝")  # first characters of formulas in a spreadsheet


def check_names(names: Mapping[str, Sequence[str]]) -> None:
    """Raise InputError for names by kind of part that stand twice or cannot be written."""
    for kind, row in names.items():
        for name in row:
            _check_name(kind, name)
            if row.count(name) > 1:
                raise InputError(f"{kind} {name}: the name is used twice")


def _check_name(kind: str, name: str) -> None:
    is_clean = name.isprintable() and name == name.strip() and not set(name) & _SIGNS
    if not (name and is_clean):
        signs = " ".join(sorted(_SIGNS))
        raise InputError(
            f"name of a {kind} = {name!r}: a text without {signs} is expected"
        )
    if name.startswith(_FORMULA):
        raise InputError(
            f"name of a {kind} = {name!r}: must not begin with + - or @, which begin "
            "formulas in a spreadsheet"
        )


def check_joint_names(joints: Sequence[str]) -> None:
    """Raise InputError where a name begins with that of another joint and ``_``."""
    for joint, longer in permutations(joints, 2):
        if longer.startswith(f"{joint}_"):
            raise InputError(
                f"name of a joint = {longer!r}: must not begin with {joint}_, because {joint} is "
                "a joint too"
            )


def check_parts(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    drives: Sequence[Drive],
    guess: Mapping[str, float],
) -> None:
    """Raise InputError where motors, guides, inertias or points do not fit each other."""
    guides = [joint for joint in joints if isinstance(joint, Guide)]
    _check_motors(drives)
    _check_guides(guides)
    check_inertias(bodies, guides, drives)
    _check_drawing(bodies, joints, start_angles(guides, drives, guess))


def check_inertias(
    bodies: Sequence[Body], guides: Sequence[Guide], drives: Sequence[Drive]
) -> None:
    """Raise InputError for a body without inertia that can turn."""
    fixed = {GROUND}  # bodies that cannot turn
    for drive in drives:
        is_at_rest = drive.is_at_rest and drive.motor is None
        if is_at_rest and not isinstance(drive, LinearDrive):
            fixed.add(drive.body)
    for _ in guides:  # a body in a guide on a body that cannot turn cannot turn either
        fixed |= {guide.body for guide in guides if guide.on in fixed}
    for body in bodies:
        needs_none = body.inertia == 0.0 and body.name in fixed
        if needs_none or body.inertia >= MIN_INERTIA:
            continue
        raise InputError(
            f"inertia of {body.name} = {body.inertia:g} kg m^2: must be {MIN_INERTIA:g} kg m^2 "
            "or more; 0 is allowed for a body that a guide without clearance, or a drive at rest, "
            "keeps from turning"
        )


def _check_motors(drives: Sequence[Drive]) -> None:
    """Raise InputError for a prescribed motion beside a motor, and a leader without a speed."""
    leader = leader_of(drives)
    timed = [drive for drive in drives if not isinstance(drive, GearedDrive)]
    moving = [drive for drive in timed if drive.motor is None and not drive.is_at_rest]
    if leader is None:
        servos = [drive for drive in drives if drive.motor is not None]
        if servos and moving:
            raise InputError(
                f"motor of {servos[0].body}: a servo follows the angle of a motor, and "
                f"{moving[0].body} has none; give it one, motor = {{torque, inertia}}, or leave "
                f"out the servo, and {servos[0].body} follows its motion exactly"
            )
        return
    if leader.speed == 0.0:
        raise InputError(
            f"speed of {leader.body} = 0 rad/s: cycles are counted by the angle of this drive, the "
            "first with a motor; a nominal speed is needed"
        )
    if moving:
        raise InputError(
            f"{moving[0].name}: its motion follows the time, but the motor of {leader.body} does "
            "not; give it a servo, motor = {stiffness, damping}, which follows the angle of "
            f"{leader.body}"
        )


def _check_guides(guides: Sequence[Guide]) -> None:
    """Raise InputError where guides that close a loop do not agree on the angles of bodies."""
    closing = closing_guides(guides)
    for guide in guides:
        angle = closing.get(guide.name, guide.angle)
        if abs(math.remainder(guide.angle - angle, 2.0 * math.pi)) > DRAWING_TOL:
            text, allowed = (
                f"{math.degrees(value):.6g} deg" for value in (guide.angle, angle)
            )
            raise InputError(
                f"guide {guide.name}: angle = {text}: other guides hold {guide.body} at {allowed} "
                f"on {guide.on}; allowed is {allowed}"
            )


def start_angles(
    guides: Sequence[Guide], drives: Sequence[Drive], guess: Mapping[str, float]
) -> dict[str, float]:
    """Return the approximate angles of bodies at the start, rad.

    They are those of drives, of guides, or of the guess of the user. A guide on a body
    passes the angle on, from this body or to it.
    """
    fixed = {guide.body: guide.angle for guide in guides if not guide.is_moving}
    turning = (drive for drive in drives if not isinstance(drive, LinearDrive))
    fixed |= {drive.body: drive.angle for drive in turning}
    angles = {**guess, **fixed}
    moving = [guide for guide in guides if guide.is_moving]
    while moving:
        # Guides that pass an angle to their body, and from it
        forward = [g for g in moving if g.on in angles and g.body not in fixed]
        backward = [g for g in moving if g.body in angles]
        guide = (*forward, *backward, *moving)[0]
        moving.remove(guide)
        if forward or not backward:
            angles[guide.body] = angles.get(guide.on, 0.0) + guide.angle
        else:
            angles[guide.on] = angles[guide.body] - guide.angle
    return angles


def _check_drawing(
    bodies: Sequence[Body], joints: Sequence[Joint], angles: Mapping[str, float]
) -> None:
    """Raise InputError where points of a joint do not coincide in the drawing.

    ``angles`` are those of the bodies at the start, rad. A body that has one is drawn
    in a frame of its own.
    """
    places = {GROUND: (0.0, 0.0)}
    for body in bodies:
        if body.drawn_at is not None and not angles.get(body.name):
            places[body.name] = body.drawn_at
    ends = [ends_of(joint) for joint in joints]
    points = chain.from_iterable(ends)
    size = max((math.hypot(point.x, point.y) for point in points), default=0.0)
    for joint, (first, second) in zip(joints, ends, strict=True):
        if first.body in places and second.body in places:
            start = _drawn(first, places)
            end = _drawn(second, places)
            _check_distance(joint, start, end, DRAWING_TOL * size)


def _drawn(
    point: Attachment, places: Mapping[str, tuple[float, float]]
) -> tuple[float, float]:
    """Return the place of a point in the drawing, m."""
    x, y = places[point.body]
    return x + point.x, y + point.y


def _check_distance(
    joint: Joint, start: tuple[float, float], end: tuple[float, float], allowed: float
) -> None:
    """Raise InputError where the points of a joint are further apart than allowed, m."""
    x = end[0] - start[0]
    y = end[1] - start[1]
    distance = math.hypot(x, y)
    if isinstance(joint, Guide):  # along the line any place is allowed
        distance = abs(y * math.cos(joint.direction) - x * math.sin(joint.direction))
    if distance <= allowed:
        return
    labels = [end_of_joint.body for end_of_joint in ends_of(joint)]
    if isinstance(joint, Guide):
        labels[0] = f"the line on {joint.on}" if joint.is_moving else "the line"
    places = [
        f"{label} ({1e3 * x:.6g}, {1e3 * y:.6g}) mm"
        for label, (x, y) in zip(labels, (start, end), strict=True)
    ]
    raise InputError(
        f"joint {joint.name}: its points lie {written(distance, 'm')} apart in the "
        f"drawing, {places[0]} and {places[1]}; allowed is {written(allowed, 'm')}. "
        "Without centre, points are counted from the mass centre of their body"
    )
