"""Torques and forces of drives, their power and the integrals of both."""

from presswear.linkage.drives import GearedDrive, LinearDrive
from presswear.physics.equations.articulated import Articulated
from presswear.physics.equations.chain import Chain, Link
from presswear.physics.equations.text import (
    ZERO,
    Text,
    Vector,
    difference,
    product,
    total,
)
from presswear.physics.interactions.page import Page, write_torque


def write_drives(page: Page, bodies: dict[str, Articulated]) -> None:
    """Write torques and power of drives that prescribe a motion, and rates of their integrals."""
    text = page.text
    chain = page.chain
    layout = page.layout
    text.comment("torques and power of the drives")
    _add_forces_of_free_bodies(text, chain, bodies)
    torques = [ZERO] * len(chain.linkage.drives)
    if chain.has_loops:
        torques = _torques_of_loops(text, chain)
    else:
        for link in reversed(chain.prescribed):
            torques[link.drive or 0] = _torque(text, link)
    for link in chain.free:
        if link.drive is not None:
            torques[link.drive] = bodies[link.prefix].torque()
    for gear in chain.linkage.gears:
        number = chain.linkage.number_of_drive(gear.body)
        prefix = chain.of(gear.body).prefix
        torques[number] = text.let(f"{prefix}_gear_torque", torques[number])
        ratio = text.parameter(f"{prefix}_ratio", gear.ratio)
        leader = chain.linkage.number_of_drive(gear.leader)
        torques[leader] = total(torques[leader], product(ratio, torques[number]))
    powers = []
    for k, drive in enumerate(chain.linkage.drives):
        if not chain.linkage.prescribes(drive):
            continue
        link = chain.of(drive.body)
        torque = text.let(f"{link.prefix}_torque", torques[k])
        if isinstance(drive, GearedDrive):
            rate = ZERO  # its power is that of its leader
        elif isinstance(drive, LinearDrive):
            rate = link.speed
        else:
            rate = link.omega
        power = text.let(f"{link.prefix}_power", product(torque, rate))
        powers.append(power)
        write_torque(text, layout, k, torque, power)
    power = text.let("drive_power", total(*powers))
    page.add_power("drive_work", power)
    page.add_power("drive_exchange", f"abs({power})")


def _add_forces_of_free_bodies(
    text: Text, chain: Chain, bodies: dict[str, Articulated]
) -> None:
    """Write the forces of free bodies, and add them to their prescribed parents."""
    for link in chain.free:
        parent = link.parent
        if parent is not None and parent.is_prescribed and parent is not chain.frame:
            force = text.let_vector(
                f"{link.prefix}_{link.joint}", bodies[link.prefix].reaction()
            )
            if link.is_on_moving_guide:
                parent.add_force(link.from_parent, force)
                parent.moments.append(bodies[link.prefix].guide_moment())
                continue
            parent.add_force(parent.arm(text, link.branch.before, link.joint), force)


def _torque(text: Text, link: Link) -> str:
    """Write the torque of the drive of a prescribed body about its hinge.

    The force in the hinge is added to the parent.
    """
    prefix = link.prefix
    body = link.body
    if link.is_guided:
        return _force_along(text, link)
    arm = link.arm(text, link.branch.end, link.joint)
    force = text.let_vector(f"{prefix}_force", Vector().plus(*link.forces))
    moment = difference(total(*link.moments), arm.cross(force))
    if link.parent is None or link.parent.index < 0:
        radius = link.branch.end.x**2 + link.branch.end.y**2
        about_hinge = body.effective_inertia + body.mass * radius
        inertia = text.parameter(f"{prefix}_inertia_about_{link.joint}", about_hinge)
        return difference(product(inertia, link.alpha), moment)
    mass = text.parameter(f"{prefix}_mass", body.mass)
    inertia_force = text.let_vector(f"{prefix}_needed", link.acceleration.times(mass))
    hinge = link.parent.arm(text, link.branch.before, link.joint)
    on_parent = text.let_vector(f"{prefix}_{link.joint}", force.minus(inertia_force))
    link.parent.add_force(hinge, on_parent)
    inertia = text.parameter(f"{prefix}_inertia", body.effective_inertia)
    turning = difference(product(inertia, link.alpha), arm.cross(inertia_force))
    return difference(turning, moment)


def _force_along(text: Text, link: Link) -> str:
    """Write the force of a drive along the guide of its body."""
    mass = text.parameter(f"{link.prefix}_mass", link.body.mass)
    force = text.let_vector(f"{link.prefix}_force", Vector().plus(*link.forces))
    return difference(product(mass, link.acceleration_along), link.guide.dot(force))


def _torques_of_loops(text: Text, chain: Chain) -> list[str]:
    """Write the torques of drives in closed loops, by virtual work."""
    for link in chain.prescribed:
        force = Vector().plus(*link.forces)
        for i, expression in enumerate((force.x, force.y, total(*link.moments))):
            text.write(f"force[{link.index + i}] = {expression}")
    text.write("subtract_inertia(data.prescribed.parts, a, force)")
    text.write("drive_torques(data.prescribed, q, axes, force, data.torque)")
    return [f"data.torque[{k}]" for k in range(len(chain.linkage.drives))]
