"""Springs with dampers between two points."""

import math
from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.joints import ends_of
from presswear.linkage.linkage import Linkage
from presswear.linkage.point_position import point_position
from presswear.linkage.spring import Spring
from presswear.physics.equations.text import ONE, Vector
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.packed import Packed, effective_mass
from presswear.tools.arrays import Array
from presswear.tools.compile import inlined
from presswear.tools.errors import InputError
from presswear.tools.quantities import written

# Distance of the ends over the length, up to which a spring has no direction
ENDS_MEET = 1e-9


@inlined
def spring_pull(
    dx: float,
    dy: float,
    dvx: float,
    dvy: float,
    stiffness: float,
    damping: float,
    length: float,
) -> tuple[float, float, float]:
    """Return the force on the first end of a spring, N, and the power of its damper, W.

    ``dx`` and ``dy`` are the position of the second end relative to the first, m;
    ``dvx`` and ``dvy`` are its velocity, m/s. A spring of length 0 is linear: its force
    is zero if the ends meet. The force of any other spring is not finite if the ends
    meet, because it has no direction.
    """
    distance = math.sqrt(dx * dx + dy * dy)
    elastic = stiffness * (distance - length)
    if distance == 0.0 and length == 0.0:
        # The direction of ends that meet is that of their relative velocity.
        dx = dvx
        dy = dvy
        speed = math.sqrt(dvx * dvx + dvy * dvy)
        distance = speed if speed > 0.0 else 1.0
    rate = (dx * dvx + dy * dvy) / distance
    pull = elastic + damping * rate
    return pull * dx / distance, pull * dy / distance, -damping * rate * rate


@dataclass(frozen=True)
class SpringAndDamper:
    """Spring with damper that writes itself into the equations."""

    spring: Spring

    kernels: ClassVar[Kernels] = (spring_pull,)

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all springs of a linkage."""
        return [cls(spring) for spring in _springs_along(linkage)]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies of both ends."""
        first, second = self.spring.ends
        return first.body, second.body

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return the elastic energy of all springs, J."""
        energy = 0.0
        for spring in _springs_along(linkage):
            stretch = _distance(linkage, spring, position) - spring.length
            energy += 0.5 * spring.stiffness * stretch * stretch
        return energy

    def write(self, page: Page) -> None:
        """Write the forces on both bodies, and the power of the damper."""
        text = page.text
        spring = self.spring
        prefix = text.prefix(spring.name)
        first_end, second_end = spring.ends
        first = page.chain.of(first_end.body)
        second = page.chain.of(second_end.body)
        text.comment(
            f"{spring.name}: spring between {first.body.name} and {second.body.name}"
        )
        position, velocity = page.chain.relative_motion(text, spring.ends, prefix)
        stiffness = text.parameter(f"{prefix}_stiffness", spring.stiffness)
        damping = text.parameter(f"{prefix}_damping", spring.damping)
        length = text.parameter(f"{prefix}_length", spring.length)
        force = Vector(f"{prefix}_force_x", f"{prefix}_force_y")
        arguments = ", ".join((*position, *velocity, stiffness, damping, length))
        text.write(f"{force.x}, {force.y}, {prefix}_power = spring_pull({arguments})")
        if spring.damping != 0.0:
            page.add_power("load_work", f"{prefix}_power")
        first.add_force(first.arm(text, first_end, prefix), force)
        second.add_force(second.arm(text, second_end, prefix), force.times(f"-{ONE}"))


# Kinds of ``linkage.spring.AnySpring``
SPRING_KINDS = (SpringAndDamper,)


def _springs_along(linkage: Linkage) -> list[Spring]:
    """Return the springs that act along the line between their ends."""
    return [spring for spring in linkage.springs if isinstance(spring, Spring)]


def _distance(linkage: Linkage, spring: Spring, position: Array) -> float:
    """Return the distance of the ends of a spring, m."""
    first, second = (
        point_position(linkage, end, position.tolist()) for end in spring.ends
    )
    return math.dist(first, second)


def check_springs(linkage: Linkage, position: Array) -> None:
    """Raise InputError for a spring whose ends meet in a position, unless its length is 0."""
    for spring in _springs_along(linkage):
        distance = _distance(linkage, spring, position)
        if distance <= ENDS_MEET * spring.length and spring.length > 0.0:
            raise InputError(
                f"spring {spring.name}: its ends meet at the start, where a spring of length = "
                f"{written(spring.length, 'm')} has no direction; allowed is length = 0, a linear "
                "spring without force there, or ends that lie apart"
            )


def spring_period(linkage: Linkage) -> float:
    """Return the shortest period of a body on a spring, elastic joint or servo, s.

    It is 2 pi sqrt(m / k), or 2 pi sqrt(I / k) with the inertia of a servo's body.
    """
    bodies = {body.name: body for body in linkage.bodies}
    shortest = math.inf
    for drive in linkage.drives:
        if drive.motor and drive.motor.stiffness and not linkage.prescribes(drive):
            inertia = bodies[drive.body].effective_inertia
            ratio = inertia / drive.motor.stiffness
            shortest = min(shortest, 2.0 * math.pi * math.sqrt(ratio))
    springs = [(spring.ends, spring.stiffness) for spring in _springs_along(linkage)]
    for joint in linkage.elastic_joints:
        springs.append((ends_of(joint), joint.stiffness or 0.0))
    for ends, stiffness in springs:
        if stiffness > 0.0:
            mass = effective_mass(linkage, ends)
            shortest = min(shortest, 2.0 * math.pi * math.sqrt(mass / stiffness))
    return shortest
