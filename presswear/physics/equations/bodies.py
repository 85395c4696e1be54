"""Positions and velocities of all bodies, and accelerations of bodies with prescribed motion."""

import math

from presswear.linkage.drives import Drive, LinearDrive
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.physics.drive_motion import is_steady
from presswear.physics.equations.chain import Chain, Link
from presswear.physics.equations.text import (
    Text,
    Vector,
    product,
    rotated,
    square,
    total,
)


def place_bodies(text: Text, chain: Chain) -> None:
    """Write positions and velocities of all bodies, and accelerations of prescribed ones."""
    if chain.has_loops:
        _read_loops(text, chain)
    for link in chain.links:
        if not (link.is_prescribed and chain.has_loops):
            text.comment(_title(link))
            _turn(text, chain, link)
            _place(text, chain, link)
        if link.is_prescribed and not chain.has_loops:
            _accelerate(text, link)


def _title(link: Link) -> str:
    """Return a comment on the joint that holds a body."""
    name = link.body.name
    joint = link.branch.joint
    if joint is None or link.parent is None:
        return f"{name}: held by no ideal joint"
    if link.is_guided:
        title = f"{name}: slides along {joint.name}"
        return f"{title}, driven" if link.drive is not None else title
    title = f"{name}: turns about {joint.name} on {link.parent.body.name}"
    return f"{title}, driven" if link.drive is not None else title


def _read_loops(text: Text, chain: Chain) -> None:
    """Write the motion of prescribed bodies in closed loops, from Newton's method."""
    text.comment("bodies that drives move in closed loops")
    text.write("q, v, a, force, axes = data.bodies")
    text.write("place_prescribed(data.prescribed, t, q, v, a, axes)")
    for link in chain.prescribed:
        x = link.index
        y = link.index + 1
        turn = link.index + 2
        prefix = link.prefix
        link.position = text.let_vector(prefix, Vector(f"q[{x}]", f"q[{y}]"))
        link.velocity = text.let_vector(f"{prefix}_v", Vector(f"v[{x}]", f"v[{y}]"))
        link.acceleration = text.let_vector(f"{prefix}_a", Vector(f"a[{x}]", f"a[{y}]"))
        link.angle = text.let(f"{prefix}_angle", f"q[{turn}]")
        link.omega = text.let(f"{prefix}_omega", f"v[{turn}]")
        link.alpha = text.let(f"{prefix}_alpha", f"a[{turn}]")
        if isinstance(_drive_of(chain, link), LinearDrive):
            link.speed = f"{prefix}_speed"
            motion = f"uneven_motion(data.motions[{link.drive}], t)"
            text.write(f"_, {link.speed}, _ = {motion}")
        link.axis = text.let_vector(
            f"{prefix}_axis", Vector(f"axes[{x}]", f"axes[{y}]")
        )


def _drive_of(chain: Chain, link: Link) -> Drive | None:
    """Return the drive that prescribes a coordinate of a body, or None."""
    return None if link.drive is None else chain.linkage.drives[link.drive]


def _turn(text: Text, chain: Chain, link: Link) -> None:
    """Write angle and angular velocity of a body, and the angular acceleration if prescribed."""
    prefix = link.prefix
    if link.is_on_moving_guide:
        _turn_with_parent(text, link)
        return
    if isinstance(link.branch.joint, Guide):
        fixed = link.branch.joint.angle
        link.angle = text.parameter(f"{prefix}_angle", fixed)
        link.axis = Vector(
            text.direction(f"{prefix}_cos", math.cos(fixed)),
            text.direction(f"{prefix}_sin", math.sin(fixed)),
        )
        return
    if link.drive is not None:
        _drive(text, chain.linkage, link, chain.linkage.drives[link.drive])
    else:
        # A loose body has the coordinates x, y and angle.
        coordinate = link.coordinate + (2 if link.is_loose else 0)
        angle = f"y[{coordinate}]"
        omega = f"y[{chain.size + coordinate}]"
        # The coordinate of a body on a free body is the relative angle.
        if link.parent is not None and not link.parent.is_prescribed:
            angle = total(link.parent.angle, angle)
            omega = total(link.parent.omega, omega)
        link.angle = text.let(f"{prefix}_angle", angle)
        link.omega = text.let(f"{prefix}_omega", omega)
    link.axis = Vector(f"{prefix}_cos", f"{prefix}_sin")
    text.write(f"{link.axis.x}, {link.axis.y} = cos_sin({link.angle})")


def _turn_with_parent(text: Text, link: Link) -> None:
    """Write the rotation of a body on a moving guide, which is that of the guide."""
    prefix = link.prefix
    parent = link.parent
    assert parent is not None
    turn = link.branch.turn
    fixed = text.parameter(f"{prefix}_angle_on_{parent.prefix}", turn)
    link.angle = text.let(f"{prefix}_angle", total(parent.angle, fixed))
    link.omega = parent.omega
    if link.is_prescribed:
        link.alpha = parent.alpha
    cosine = text.direction(f"{prefix}_cos_on_{parent.prefix}", math.cos(turn))
    sine = text.direction(f"{prefix}_sin_on_{parent.prefix}", math.sin(turn))
    axis = rotated(parent.axis, cosine, sine)
    link.axis = text.let_vector(f"{prefix}_axis", axis)


def _drive_along(text: Text, link: Link, start: float) -> None:
    """Write the motion along the guide of a body that a drive prescribes."""
    prefix = link.prefix
    link.speed = f"{prefix}_speed"
    link.acceleration_along = f"{prefix}_acceleration"
    names = f"{prefix}_way, {link.speed}, {link.acceleration_along}"
    text.write(f"{names} = uneven_motion(data.motions[{link.drive}], t)")
    position = text.parameter(f"{prefix}_position", start)
    text.write(f"{prefix}_distance = {total(position, f'{prefix}_way')}")


def _drive(text: Text, linkage: Linkage, link: Link, drive: Drive) -> None:
    """Write the motion that a drive prescribes."""
    prefix = link.prefix
    start = text.parameter(f"{prefix}_start_angle", drive.angle)
    if is_steady(linkage, drive):
        link.omega = text.parameter(f"{prefix}_omega", drive.mean_speed)
        rotation = product(link.omega, "t")
    else:
        rotation = f"{prefix}_rotation"
        link.omega = f"{prefix}_omega"
        link.alpha = f"{prefix}_alpha"
        motion = f"uneven_motion(data.motions[{link.drive}], t)"
        text.write(f"{rotation}, {link.omega}, {link.alpha} = {motion}")
    link.angle = text.let(f"{prefix}_angle", total(start, rotation))


def _place(text: Text, chain: Chain, link: Link) -> None:
    """Write the position and velocity of the mass centre of a body."""
    prefix = link.prefix
    joint = link.branch.joint
    coordinate = link.coordinate
    rate = chain.size + coordinate
    if link.parent is None:
        position = Vector(f"y[{coordinate}]", f"y[{coordinate + 1}]")
        velocity = Vector(f"y[{rate}]", f"y[{rate + 1}]")
    elif link.is_on_moving_guide:
        position, velocity = _slide(text, chain, link)
    elif isinstance(joint, Guide):
        _set_guide(text, link, joint)
        start = link.parent.arm(text, link.branch.before, link.joint)
        if link.drive is None:
            text.let(f"{prefix}_distance", f"y[{coordinate}]")
            link.speed = text.let(f"{prefix}_speed", f"y[{rate}]")
        else:
            _drive_along(text, link, chain.linkage.drives[link.drive].start)
        position = start.plus(link.guide.times(f"{prefix}_distance"))
        velocity = link.guide.times(link.speed)
    else:
        hinge = link.parent.arm(text, link.branch.before, link.joint)
        arm = link.arm(text, link.branch.end, link.joint)
        position = link.parent.position.plus(hinge).minus(arm)
        velocity = link.parent.velocity_at(hinge).minus(arm.rotated_at(link.omega))
    link.position = text.let_vector(prefix, position)
    link.velocity = text.let_vector(f"{prefix}_v", velocity)


def _set_guide(text: Text, link: Link, guide: Guide) -> None:
    """Set the direction of a guide on the frame."""
    link.guide = Vector(
        text.direction(f"{link.prefix}_guide_x", math.cos(guide.direction)),
        text.direction(f"{link.prefix}_guide_y", math.sin(guide.direction)),
    )


def _slide(text: Text, chain: Chain, link: Link) -> tuple[Vector, Vector]:
    """Write the motion of a body along a guide on its parent; return position and velocity."""
    prefix = link.prefix
    parent = link.parent
    assert parent is not None
    cosine = text.direction(f"{prefix}_guide_xi", math.cos(link.branch.slope))
    sine = text.direction(f"{prefix}_guide_eta", math.sin(link.branch.slope))
    line = rotated(parent.axis, cosine, sine)
    link.guide = text.let_vector(f"{prefix}_guide", line)
    distance = text.let(f"{prefix}_distance", f"y[{link.coordinate}]")
    speed = text.let(f"{prefix}_speed", f"y[{chain.size + link.coordinate}]")
    start = parent.arm(text, link.branch.before, link.joint)
    end = link.arm(text, link.branch.end, link.joint)
    reach = start.plus(link.guide.times(distance)).minus(end)
    link.from_parent = text.let_vector(f"{prefix}_from_{parent.prefix}", reach)
    position = parent.position.plus(link.from_parent)
    return position, parent.velocity_at(link.from_parent).plus(link.guide.times(speed))


def sliding_acceleration(text: Text, size: int, link: Link) -> Vector:
    """Write the centripetal and Coriolis acceleration of a body on a moving guide.

    ``size`` is the number of coordinates of the tree.
    """
    parent = link.parent
    assert parent is not None
    speed = f"y[{size + link.coordinate}]"
    sideways = link.guide.rotated_at(parent.omega).times(product("2.0", speed))
    inwards = link.from_parent.times(square(parent.omega))
    return text.let_vector(f"{link.prefix}_a_at_rest", sideways.minus(inwards))


def hinge_acceleration(text: Text, link: Link) -> Vector:
    """Write the acceleration of the hinge of a body, as a point of the parent."""
    parent = link.parent
    assert parent is not None
    hinge = parent.arm(text, link.branch.before, link.joint)
    turning = hinge.rotated_at(parent.alpha).minus(hinge.times(square(parent.omega)))
    return text.let_vector(
        f"{parent.prefix}_{link.joint}_a", parent.acceleration.plus(turning)
    )


def centripetal(link: Link, arm: Vector) -> Vector:
    """Return the centripetal acceleration of a mass centre that turns about its hinge."""
    return arm.times(square(link.omega))


def _accelerate(text: Text, link: Link) -> None:
    """Write the acceleration of a mass centre from that of the hinge and the rotation."""
    if link.is_guided:
        link.acceleration = link.guide.times(link.acceleration_along)
        return
    arm = link.arm(text, link.branch.end, link.joint)
    turning = centripetal(link, arm).minus(arm.rotated_at(link.alpha))
    acceleration = hinge_acceleration(text, link).plus(turning)
    link.acceleration = text.let_vector(f"{link.prefix}_a", acceleration)
