"""Generalized forces on the coordinates of an open tree, by virtual work.

They are the forces on all bodies times their Jacobian, J^T f. A branch that hangs from
a prescribed body moves in axes that translate with its hinge. The motion of the hinge
enters as a force -m a on each body of the branch, and is exact.
"""

from dataclasses import dataclass

from presswear.physics.equations.bodies import hinge_acceleration
from presswear.physics.equations.chain import Chain, Link
from presswear.physics.equations.text import Text, Vector, difference, total


@dataclass
class _Transmitted:
    """Forces that a body and all that hangs from it bear, about its mass centre."""

    forces: list[Vector]
    moments: list[str]


def write_generalized_forces(text: Text, chain: Chain, first: int) -> None:
    """Write the forces on the coordinates of a tree, from a place in ``out``."""
    text.comment("forces on the coordinates")
    # by body, acceleration of the hinge from which its branch hangs
    hinges: dict[str, Vector] = {}
    transmitted: dict[str, _Transmitted] = {}
    for link in chain.free:
        acceleration = _branch_acceleration(text, link, hinges)
        hinges[link.prefix] = acceleration
        transmitted[link.prefix] = _Transmitted([*link.forces], [*link.moments])
        if acceleration != Vector():
            mass = text.parameter(f"{link.prefix}_mass", link.body.mass)
            transmitted[link.prefix].forces.append(acceleration.times(f"-{mass}"))
    for link in reversed(chain.free):
        _write_force(text, link, transmitted, first + link.coordinate)


def _branch_acceleration(text: Text, link: Link, hinges: dict[str, Vector]) -> Vector:
    """Write the acceleration of the hinge from which the branch of a body hangs."""
    parent = link.parent
    if parent is None or parent.index < 0:
        return Vector()
    if not parent.is_prescribed:
        return hinges[parent.prefix]
    return hinge_acceleration(text, link)


def _write_force(
    text: Text, link: Link, transmitted: dict[str, _Transmitted], place: int
) -> None:
    """Write the forces on the coordinates of a body, and pass them on to what it hangs from."""
    prefix = link.prefix
    parent = link.parent
    force = text.let_vector(
        f"{prefix}_transmitted", Vector().plus(*transmitted[prefix].forces)
    )
    moment = text.let(
        f"{prefix}_transmitted_moment", total(*transmitted[prefix].moments)
    )
    if link.is_guided:
        text.write(f"out[{place}] = {link.guide.dot(force)}")
        if parent is not None and parent.prefix in transmitted:
            transmitted[parent.prefix].forces.append(force)
            transmitted[parent.prefix].moments += link.from_parent.cross(force), moment
        return
    if link.is_loose:
        text.write(f"out[{place}] = {force.x}")
        text.write(f"out[{place + 1}] = {force.y}")
        text.write(f"out[{place + 2}] = {moment}")
        return
    arm = link.arm(text, link.branch.end, link.joint)
    about_hinge = text.let(
        f"{prefix}_about_{link.joint}", difference(moment, arm.cross(force))
    )
    text.write(f"out[{place}] = {about_hinge}")
    if parent is not None and parent.prefix in transmitted:
        hinge = parent.arm(text, link.branch.before, link.joint)
        transmitted[parent.prefix].forces.append(force)
        # The coordinate is the angle relative to the parent: the parent turns the body, too.
        transmitted[parent.prefix].moments += hinge.cross(force), about_hinge
