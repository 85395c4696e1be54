"""Accelerations of a tree under forces, from articulated bodies.

The recursion from the leaves inwards gives for each body two quantities at the hinge to
its parent. One is a matrix of two by two, the articulated mass, which resists an
acceleration of the hinge. The other is the force without such an acceleration. The
recursion outwards gives the accelerations (Featherstone, Rigid Body Dynamics Algorithms,
2008, 7.3). The angle of each body counts from the frame, because a hinge transmits a
force and no moment. A guide on a moving body transmits a moment, too. There the
quantities are mass, coupling and inertia, a force and a moment.
"""

from typing import NamedTuple

from presswear.physics.equations.bodies import (
    centripetal,
    hinge_acceleration,
    sliding_acceleration,
)
from presswear.physics.equations.chain import Chain, Link
from presswear.physics.equations.text import (
    ONE,
    ZERO,
    Text,
    Vector,
    difference,
    negative,
    product,
    quotient,
    square,
    total,
)


class Mass(NamedTuple):
    """Symmetric matrix of two by two, whose entries are expressions."""

    xx: str = ZERO
    xy: str = ZERO
    yy: str = ZERO

    def plus(self, *masses: "Mass") -> "Mass":
        """Return the sum of matrices."""
        return Mass(*(total(*terms) for terms in zip(self, *masses, strict=True)))

    def times(self, vector: Vector) -> Vector:
        """Return the product with a vector."""
        return Vector(
            total(product(self.xx, vector.x), product(self.xy, vector.y)),
            total(product(self.xy, vector.x), product(self.yy, vector.y)),
        )

    def named(self, text: Text, name: str) -> "Mass":
        """Assign the entries to names."""
        return Mass(
            *(
                text.let(f"{name}_{entry}", getattr(self, entry))
                for entry in self._fields
            )
        )


class Sliding(NamedTuple):
    """Articulated body with its children, as it acts at a guide on another body.

    Let the body be at rest relative to the guide. An acceleration a of its mass centre and
    an angular acceleration alpha then need the force mass a + coupling alpha - ``force``
    and the moment coupling . a + inertia alpha - ``moment``.
    """

    link: Link
    mass: Mass
    coupling: Vector
    inertia: str
    force: Vector
    moment: str


def _outer(share: Vector, momentum: Vector) -> Mass:
    """Return minus the product of two parallel vectors, a symmetric matrix."""
    return Mass(
        negative(product(share.x, momentum.x)),
        negative(product(share.x, momentum.y)),
        negative(product(share.y, momentum.y)),
    )


class Articulated:
    """Free body with its children, about its mass centre.

    An acceleration a of the mass centre and an angular acceleration alpha need the
    force mass a + coupling alpha and the moment coupling . a + inertia alpha.
    """

    def __init__(self, text: Text, link: Link) -> None:
        self.text = text
        self.link = link
        self.prefix = link.prefix
        mass = text.parameter(f"{link.prefix}_mass", link.body.mass)
        self.mass = Mass(mass, ZERO, mass)
        self.coupling = Vector()
        self.inertia = text.parameter(
            f"{link.prefix}_inertia", link.body.effective_inertia
        )
        self.is_leaf = True
        # Velocity and momentum at rate 1 of the coordinate of the body
        self.partial_velocity = link.guide
        self.momentum = Vector()
        self.force = Vector()
        self.moment = ZERO
        # Angular momentum at this rate, of a body on a moving guide
        self.turning_momentum = ZERO
        # Acceleration of a body at rest relative to its moving guide
        self.acceleration_at_rest = Vector()
        self.generalized_force = ZERO  # on the coordinate
        self.mobility = ZERO  # one over the inertia along the coordinate

    def add(self, child: Link, mass: Mass, force: Vector) -> None:
        """Add the articulated mass and the force of a child at its hinge."""
        arm = self.link.arm(self.text, child.branch.before, child.joint)
        force = force.plus(mass.times(arm).times(square(self.link.omega)))
        self.link.add_force(
            arm, self.text.let_vector(f"{child.prefix}_on_{self.prefix}", force)
        )
        self.mass = self.mass.plus(mass)
        self.is_leaf = False
        if not self.link.is_guided or self.link.is_on_moving_guide:
            coupling = mass.times(arm.rotated_at(ONE))
            coupling = self.text.let_vector(
                f"{child.prefix}_coupling_on_{self.prefix}", coupling
            )
            self.coupling = self.coupling.plus(coupling)
            self.inertia = total(self.inertia, arm.cross(coupling))

    def add_sliding(self, child: "Sliding") -> None:
        """Add mass, inertia, force and moment of a body that slides on this body."""
        link = self.link
        slide = child.link
        arm = slide.from_parent
        link.add_force(arm, child.force)
        link.moments.append(child.moment)
        self.mass = self.mass.plus(child.mass)
        self.is_leaf = False
        if link.is_guided and not link.is_on_moving_guide:
            return
        swept = arm.rotated_at(ONE)
        coupling = child.mass.times(swept).plus(child.coupling)
        name = f"{slide.prefix}_coupling_on_{self.prefix}"
        coupling = self.text.let_vector(name, coupling)
        self.coupling = self.coupling.plus(coupling)
        turning = total(arm.cross(coupling), child.coupling.dot(swept), child.inertia)
        self.inertia = total(self.inertia, turning)

    def sum_up(self, size: int) -> None:
        """Write forces and inertia of the body, which include those of all children.

        ``size`` is the number of coordinates of the tree.
        """
        text = self.text
        prefix = self.prefix
        link = self.link
        text.comment(f"{link.body.name}: forces and inertia")
        self.force = text.let_vector(f"{prefix}_force", Vector().plus(*link.forces))
        self.moment = text.let(f"{prefix}_moment", total(*link.moments))
        self.mass = self.mass.named(text, f"{prefix}_mass")
        self.coupling = text.let_vector(f"{prefix}_coupling", self.coupling)
        self.inertia = text.let(f"{prefix}_total_inertia", self.inertia)
        if link.is_guided:
            self.momentum = self.mass.times(self.partial_velocity)
            self.generalized_force = text.let(
                f"{prefix}_generalized_force", self.partial_velocity.dot(self.force)
            )
            self._set_mobility(link.body.mass, self.partial_velocity.dot(self.momentum))
            if link.is_on_moving_guide:
                turning = self.partial_velocity.dot(self.coupling)
                self.turning_momentum = text.let(f"{prefix}_turning_momentum", turning)
                self.acceleration_at_rest = sliding_acceleration(text, size, link)
        elif not link.is_loose:
            self._sum_about_hinge()

    def _sum_about_hinge(self) -> None:
        """Write moment and inertia about the hinge."""
        text = self.text
        prefix = self.prefix
        link = self.link
        arm = link.arm(text, link.branch.end, link.joint)
        self.partial_velocity = Vector(arm.y, negative(arm.x))
        momentum = self.mass.times(self.partial_velocity).plus(self.coupling)
        self.momentum = text.let_vector(f"{prefix}_momentum", momentum)
        moment = total(self.moment, self.partial_velocity.dot(self.force))
        self.generalized_force = text.let(f"{prefix}_{link.joint}_moment", moment)
        square_of_radius = link.branch.end.x**2 + link.branch.end.y**2
        momentum = self.momentum.plus(self.coupling)
        inertia = total(self.partial_velocity.dot(momentum), self.inertia)
        leaf_inertia = link.body.effective_inertia + link.body.mass * square_of_radius
        self._set_mobility(leaf_inertia, inertia)

    def _set_mobility(self, leaf_inertia: float, inertia: str) -> None:
        """Write one over the inertia along the coordinate.

        ``leaf_inertia`` is the constant inertia of a body without children.
        """
        name = f"{self.prefix}_mobility"
        if self.link.drive is not None:
            return
        if self.is_leaf:
            self.mobility = self.text.parameter(name, 1.0 / leaf_inertia)
        else:
            self.mobility = self.text.let(name, quotient(ONE, inertia))

    def add_to(self, parent: "Articulated") -> None:
        """Write mass and force at the hinge, and add them to the parent."""
        text = self.text
        prefix = self.prefix
        link = self.link
        if link.is_on_moving_guide:
            parent.add_sliding(self._sliding())
            return
        circle = centripetal(link, link.arm(text, link.branch.end, link.joint))
        circle = text.let_vector(f"{prefix}_centripetal", circle)
        mass = self.mass
        # Inertia force of the motion of the coordinate
        inertia_force = self.momentum.times(link.alpha)
        if link.drive is None:
            share = text.let_vector(
                f"{prefix}_share", self.momentum.times(self.mobility)
            )
            inertia_force = share.times(self.generalized_force)
            correction = _outer(share, self.momentum)
            mass = mass.plus(correction).named(text, f"{prefix}_hinge_mass")
        force = self.force.minus(inertia_force).minus(mass.times(circle))
        parent.add(link, mass, text.let_vector(f"{prefix}_hinge_force", force))

    def _sliding(self) -> "Sliding":
        """Write the quantities at a moving guide, without the motion along the guide."""
        text = self.text
        prefix = self.prefix
        share = text.let_vector(f"{prefix}_share", self.momentum.times(self.mobility))
        turning = text.let(
            f"{prefix}_turning_share", product(self.mobility, self.turning_momentum)
        )
        mass = self.mass.plus(_outer(share, self.momentum))
        mass = mass.named(text, f"{prefix}_guide_mass")
        coupling = self.coupling.minus(self.momentum.times(turning))
        coupling = text.let_vector(f"{prefix}_guide_coupling", coupling)
        inertia = difference(self.inertia, product(turning, self.turning_momentum))
        inertia_force = share.times(self.generalized_force)
        at_rest = self.acceleration_at_rest
        force = self.force.minus(inertia_force).minus(mass.times(at_rest))
        moment = difference(self.moment, product(turning, self.generalized_force))
        moment = difference(moment, coupling.dot(at_rest))
        return Sliding(
            self.link,
            mass,
            coupling,
            text.let(f"{prefix}_guide_inertia", inertia),
            text.let_vector(f"{prefix}_guide_force", force),
            text.let(f"{prefix}_guide_moment", moment),
        )

    def write_acceleration(self, size: int) -> None:
        """Write the accelerations of the body and of its coordinates.

        ``size`` is the number of coordinates of the tree.
        """
        text = self.text
        prefix = self.prefix
        link = self.link
        text.comment(f"{link.body.name}: acceleration")
        rate = size + link.coordinate
        if link.is_loose:
            self._accelerate_loose()
            accelerations = [*link.acceleration, link.alpha]
        elif link.is_on_moving_guide:
            accelerations = [self._accelerate_on_guide()]
        elif link.is_guided:
            along = product(self.mobility, self.generalized_force)
            along = text.let(f"{prefix}_acceleration", along)
            acceleration = self.partial_velocity.times(along)
            link.acceleration = text.let_vector(f"{prefix}_a", acceleration)
            accelerations = [along]
        else:
            self._accelerate_hinged()
            is_relative = link.parent is not None and not link.parent.is_prescribed
            before = link.parent.alpha if link.parent and is_relative else ZERO
            accelerations = [difference(link.alpha, before)]
        for k in range(link.size):
            text.write(f"out[{link.coordinate + k}] = y[{rate + k}]")
            text.write(f"out[{rate + k}] = {accelerations[k]}")

    def _accelerate_on_guide(self) -> str:
        """Write the acceleration of a body on a moving guide; return that along the guide."""
        text = self.text
        prefix = self.prefix
        link = self.link
        parent = link.parent
        assert parent is not None
        carried = parent.acceleration.plus(link.from_parent.rotated_at(parent.alpha))
        carried = text.let_vector(
            f"{prefix}_carried", carried.plus(self.acceleration_at_rest)
        )
        driving = difference(self.generalized_force, self.momentum.dot(carried))
        driving = difference(driving, product(self.turning_momentum, parent.alpha))
        along = text.let(f"{prefix}_acceleration", product(self.mobility, driving))
        link.alpha = parent.alpha
        link.acceleration = text.let_vector(
            f"{prefix}_a", carried.plus(link.guide.times(along))
        )
        return along

    def _accelerate_hinged(self) -> None:
        """Write the angular acceleration of a body on a hinge, and that of its mass centre."""
        text = self.text
        prefix = self.prefix
        link = self.link
        carried = hinge_acceleration(text, link)
        carried = carried.plus(
            centripetal(link, link.arm(text, link.branch.end, link.joint))
        )
        carried = text.let_vector(f"{prefix}_carried", carried)
        if link.drive is None:
            driving = difference(self.generalized_force, self.momentum.dot(carried))
            link.alpha = text.let(f"{prefix}_alpha", product(self.mobility, driving))
        tangential = self.partial_velocity.times(link.alpha)
        link.acceleration = text.let_vector(f"{prefix}_a", carried.plus(tangential))

    def _accelerate_loose(self) -> None:
        """Write the accelerations of a body that no ideal joint holds.

        The two equations of its translation are solved first, without its rotation,
        because its children never make them singular.
        """
        text = self.text
        prefix = self.prefix
        link = self.link
        mass = self.mass
        if self.is_leaf:
            ax = quotient(self.force.x, mass.xx)
            ay = quotient(self.force.y, mass.xx)
            link.acceleration = text.let_vector(f"{prefix}_a", Vector(ax, ay))
            if link.drive is None:
                link.alpha = text.let(
                    f"{prefix}_alpha", quotient(self.moment, self.inertia)
                )
            return
        determinant = difference(product(mass.xx, mass.yy), square(mass.xy))
        factor = text.let(f"{prefix}_factor", quotient(ONE, determinant))
        inverse = Mass(
            product(factor, mass.yy),
            negative(product(factor, mass.xy)),
            product(factor, mass.xx),
        )
        inverse = inverse.named(text, f"{prefix}_mobility")
        free = text.let_vector(f"{prefix}_free", inverse.times(self.force))
        turn = text.let_vector(f"{prefix}_turn", inverse.times(self.coupling))
        if link.drive is None:
            moment = difference(self.moment, self.coupling.dot(free))
            inertia = difference(self.inertia, self.coupling.dot(turn))
            link.alpha = text.let(f"{prefix}_alpha", f"({moment}) / ({inertia})")
        link.acceleration = text.let_vector(
            f"{prefix}_a", free.minus(turn.times(link.alpha))
        )

    def reaction(self) -> Vector:
        """Return the force on the parent at the hinge."""
        return self.force.minus(self._inertia_force())

    def guide_moment(self) -> str:
        """Return the moment about the mass centre on the body that carries the guide."""
        return difference(self.moment, self._inertia_moment())

    def _inertia_moment(self) -> str:
        """Return the moment about the mass centre that the accelerations need."""
        link = self.link
        return total(
            self.coupling.dot(link.acceleration), product(self.inertia, link.alpha)
        )

    def _inertia_force(self) -> Vector:
        """Return the force that the accelerations need, with that of the children."""
        link = self.link
        return self.mass.times(link.acceleration).plus(self.coupling.times(link.alpha))

    def torque(self) -> str:
        """Return the torque of the drive of the body."""
        link = self.link
        moment = self._inertia_moment()
        if link.is_loose:
            return difference(moment, self.moment)
        moment = total(moment, self.partial_velocity.dot(self._inertia_force()))
        return difference(moment, self.generalized_force)


def solve_tree(text: Text, chain: Chain) -> dict[str, Articulated]:
    """Write the accelerations of all free bodies; return them by the names of their variables."""
    bodies = {link.prefix: Articulated(text, link) for link in chain.free}
    for link in reversed(chain.free):
        bodies[link.prefix].sum_up(chain.size)
        if link.parent is not None and not link.parent.is_prescribed:
            bodies[link.prefix].add_to(bodies[link.parent.prefix])
    for link in chain.free:
        bodies[link.prefix].write_acceleration(chain.size)
    return bodies
